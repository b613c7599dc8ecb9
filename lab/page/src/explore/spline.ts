// Closed curves through control points: a periodic cubic spline, twice continuously differentiable, and the paper's symmetries.

import type { Point } from "./document.ts";

/** Number of samples of a dragged gait, small enough for one frame. */
export const SAMPLES = 192;

/** Spline in equal steps of its parameter, φ₁ and φ₂ in turn, without the last sample, which equals the first. */
export function sampled(points: readonly Point[], count = SAMPLES): number[] {
  const bends = [0, 1].map((axis) => curvatures(points.map((point) => point[axis as 0 | 1])));
  const n = points.length;
  const samples: number[] = [];
  for (let k = 0; k < count; k++) {
    const at = (k * n) / count;
    const i = Math.floor(at);
    const t = at - i;
    const s = 1 - t;
    for (const axis of [0, 1] as const) {
      const bend = bends[axis] ?? [];
      const [a, b] = [points[i % n]?.[axis] ?? 0, points[(i + 1) % n]?.[axis] ?? 0];
      const [p, q] = [bend[i % n] ?? 0, bend[(i + 1) % n] ?? 0];
      samples.push(s * a + t * b + ((s * s * s - s) * p + (t * t * t - t) * q) / 6);
    }
  }
  return samples;
}

/** Second derivatives at the knots: the cyclic system (1, 4, 1) m = 6 Δ²y, solved by Gauss–Seidel iteration. */
function curvatures(y: readonly number[]): number[] {
  const n = y.length;
  const at = (values: readonly number[], i: number) => values[(i + n) % n] ?? 0;
  const right = y.map((_, i) => 6 * (at(y, i + 1) - 2 * at(y, i) + at(y, i - 1)));
  const m = new Array<number>(n).fill(0);
  // Each sweep reduces the error by more than a factor of four, so forty reach double precision.
  for (let sweep = 0; sweep < 40; sweep++) {
    for (let i = 0; i < n; i++) m[i] = ((right[i] ?? 0) - at(m, i - 1) - at(m, i + 1)) / 4;
  }
  return m;
}

/** Moves a control point. With the paper's symmetries its mirror images move too, and points on a diagonal stay on it. */
export function moved(points: readonly Point[], index: number, to: Point, symmetric: boolean): Point[] {
  const n = points.length;
  const after = [...points];
  if (!symmetric || n % 4 !== 0) {
    after[index] = to;
    return after;
  }
  const place = index % (n / 2);
  let [a, b] = to;
  if (place === 0) a = b = (a + b) / 2;
  if (place === n / 4) [a, b] = [(a - b) / 2, (b - a) / 2];
  const put = (k: number, point: Point) => (after[((k % n) + n) % n] = point);
  put(index, [a, b]);
  put(-index, [b, a]);
  put(n / 2 - index, [-b, -a]);
  put(n / 2 + index, [-a, -b]);
  return after;
}

/** Nearest symmetric curve with the same number of points, beginning on the diagonal. */
export function symmetrised(points: readonly Point[]): Point[] {
  const n = 4 * Math.max(2, Math.round(points.length / 4));
  const evenly = points.length === n ? points : resampled(points, n);
  const images = (k: number): Point[] => {
    const at = (i: number) => evenly[((i % n) + n) % n] ?? [0, 0];
    const [p, q, r, s] = [at(k), at(-k), at(n / 2 - k), at(n / 2 + k)];
    return [p, [q[1], q[0]], [-r[1], -r[0]], [-s[0], -s[1]]];
  };
  return evenly.map((_, k) => {
    const all = images(k);
    return [0, 1].map((axis) => all.reduce((sum, point) => sum + (point[axis as 0 | 1] ?? 0), 0) / 4) as unknown as Point;
  });
}

/** Control points in equal steps of the curve's parameter. */
export function resampled(points: readonly Point[], count: number): Point[] {
  return pairs(sampled(points, count));
}

/** φ₁ and φ₂ in turn, as points. */
export function pairs(flat: ArrayLike<number>): Point[] {
  return Array.from({ length: flat.length / 2 }, (_, k) => [flat[2 * k] ?? 0, flat[2 * k + 1] ?? 0] as const);
}
