// Sequential colour scale with uniformly decreasing lightness, suitable for all kinds of colour vision.

import { dark } from "../shell/theme.tsx";

const STOPS = [[253, 246, 227], [244, 190, 120], [222, 120, 62], [160, 58, 90], [74, 24, 110]] as const;

/** Colour of a fraction in 0 … 1. */
export function rampColour(share: number): string {
  const clamped = Math.max(0, Math.min(1, dark.value ? 1 - share : share)) * (STOPS.length - 1);
  const k = Math.min(STOPS.length - 2, Math.floor(clamped));
  const [a, b] = [STOPS[k] ?? STOPS[0], STOPS[k + 1] ?? STOPS[0]];
  const mixed = [0, 1, 2].map((c) => Math.round((a[c] ?? 0) + ((b[c] ?? 0) - (a[c] ?? 0)) * (clamped - k)));
  return `rgb(${mixed.join(" ")})`;
}

/** Least and largest of the existing values. */
export function range(values: readonly (readonly (number | null)[])[]): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const row of values) {
    for (const value of row) {
      if (value === null) continue;
      [low, high] = [Math.min(low, value), Math.max(high, value)];
    }
  }
  return low <= high ? [low, high] : [0, 1];
}
