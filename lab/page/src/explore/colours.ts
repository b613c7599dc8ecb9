// Diverging colour scale of heights: blue below zero, orange above, paper colour between; suitable for all kinds of colour vision.

const LIGHT = { below: [27, 92, 161], none: [250, 250, 249], above: [186, 84, 8] } as const;
const DARK = { below: [92, 167, 236], none: [24, 30, 35], above: [238, 148, 72] } as const;

/** Red, green, blue of a value in −1 … 1. */
export function diverging(value: number, dark: boolean): [number, number, number] {
  const scale = dark ? DARK : LIGHT;
  const share = Math.min(1, Math.abs(value)) ** 0.75;
  const end = value < 0 ? scale.below : scale.above;
  const mix = (k: 0 | 1 | 2) => Math.round(scale.none[k] + (end[k] - scale.none[k]) * share * 0.9);
  return [mix(0), mix(1), mix(2)];
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
