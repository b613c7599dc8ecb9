// Diverging colour scale of heights: blue below zero, red above, paper colour between; suitable for all kinds of colour vision.

import palette from "../style/palette.json";

/** Red, green, blue of a value in −1 … 1. */
export function diverging(value: number, dark: boolean): [number, number, number] {
  return between(dark ? palette.diverging_dark : palette.diverging, (1 + value) / 2);
}

/** Colour at a share of a palette's range, between its stops. */
export function between(stops: readonly number[][], share: number): [number, number, number] {
  const place = Math.max(0, Math.min(1, share)) * (stops.length - 1);
  const below = Math.min(stops.length - 2, Math.floor(place));
  const [low, high] = [stops[below] ?? [], stops[below + 1] ?? []];
  const mixed = (k: number) => Math.round((low[k] ?? 0) + ((high[k] ?? 0) - (low[k] ?? 0)) * (place - below));
  return [mixed(0), mixed(1), mixed(2)];
}

/** Height of the full colour: the 98th percentile of the absolute heights. */
export function fullScale(heights: Float64Array): number {
  const sorted = Float64Array.from(heights, Math.abs).sort();
  return sorted[Math.floor(sorted.length * 0.98)] || 1;
}

/** Paints heights (φ₁ fastest, from −D up) as an image, φ₂ upwards. */
export function painted(heights: Float64Array, count: number, full: number, dark: boolean): ImageData {
  const image = new ImageData(count, count);
  const steps = 256;
  const table = Array.from({ length: 2 * steps + 1 }, (_, k) => diverging(k / steps - 1, dark));
  for (let j = 0; j < count; j++) {
    for (let i = 0; i < count; i++) {
      const value = Math.max(-1, Math.min(1, (heights[j * count + i] ?? 0) / full));
      const colour = table[Math.round((value + 1) * steps)] ?? [0, 0, 0];
      const place = 4 * ((count - 1 - j) * count + i);
      image.data.set([...colour, 255], place);
    }
  }
  return image;
}
