// Sequential colour scale of a map, and the range of its values.

import { between } from "../explore/colours.ts";
import palette from "../style/palette.json";

/** Colour of a fraction in 0 … 1. */
export const rampColour = (share: number) => `rgb(${between(palette.sequential, share).join(" ")})`;

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
