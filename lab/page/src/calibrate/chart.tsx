// A chart in a card: scales, axes, lines.

import type { ComponentChildren } from "preact";

export const [WIDTH, HEIGHT] = [420, 300];
export const MARGIN = { left: 64, right: 12, top: 10, bottom: 40 };

/** Scales from values to picture coordinates, and round numbers along both axes. */
export interface Scale {
  x(value: number): number;
  y(value: number): number;
  ticks: [number[], number[]];
}

/** Round numbers that divide a range into about five. */
function rounded(low: number, high: number): number[] {
  const raw = (high - low) / 5 || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find((digit) => digit * power >= raw) ?? 10);
  const first = Math.ceil(low / step);
  return Array.from({ length: Math.floor(high / step) - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(6)));
}

/** Scale that contains all these values, with margins at both ends. */
export function scale(xs: readonly number[], ys: readonly number[], room = 0.05): Scale {
  const ends = (values: readonly number[]): [number, number] => {
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const more = (high - low || Math.abs(high) || 1) * room;
    return [low - more, high + more];
  };
  const [[x0, x1], [y0, y1]] = [ends(xs), ends(ys)];
  return {
    x: (value) => MARGIN.left + ((value - x0) / (x1 - x0)) * (WIDTH - MARGIN.left - MARGIN.right),
    y: (value) => HEIGHT - MARGIN.bottom - ((value - y0) / (y1 - y0)) * (HEIGHT - MARGIN.top - MARGIN.bottom),
    ticks: [rounded(x0, x1), rounded(y0, y1)],
  };
}

/** Chart with axes, in a card. */
export function Chart({ title, names, to, children }: { title: string; names: [string, string]; to: Scale; children: ComponentChildren }) {
  const [bottom, left] = [HEIGHT - MARGIN.bottom, MARGIN.left];
  return (
    <section class="card" aria-label={title}>
      <h2>{title}</h2>
      <svg class="chart" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={title}>
        {to.ticks[0].map((tick) => (
          <g key={tick}><path class="grid" d={`M${to.x(tick)} ${MARGIN.top}V${bottom}`} /><text x={to.x(tick)} y={bottom + 14} text-anchor="middle">{tick}</text></g>
        ))}
        {to.ticks[1].map((tick) => (
          <g key={tick}><path class="grid" d={`M${left} ${to.y(tick)}H${WIDTH - MARGIN.right}`} /><text x={left - 5} y={to.y(tick) + 4} text-anchor="end">{tick}</text></g>
        ))}
        <text x={(left + WIDTH - MARGIN.right) / 2} y={HEIGHT - 6} text-anchor="middle">{names[0]}</text>
        <text transform={`translate(11 ${(MARGIN.top + bottom) / 2}) rotate(-90)`} text-anchor="middle">{names[1]}</text>
        {children}
      </svg>
    </section>
  );
}

/** A path through points. */
export const line = (points: readonly (readonly [number, number])[], to: Scale) =>
  points.map(([x, y], k) => `${k ? "L" : "M"}${to.x(x).toFixed(1)} ${to.y(y).toFixed(1)}`).join("");

export const degrees = (radians: number) => (radians * 180) / Math.PI;

type Point = readonly [number, number];

/** Points of one kind, each with a description. */
export function Dots({ of, to, kind, radius = 3.5 }: { of: readonly (readonly [Point, string])[]; to: Scale; kind: string; radius?: number }) {
  return (
    <g class={kind}>
      {of.map(([[x, y], what], k) => <circle key={k} cx={to.x(x)} cy={to.y(y)} r={radius}><title>{what}</title></circle>)}
    </g>
  );
}
