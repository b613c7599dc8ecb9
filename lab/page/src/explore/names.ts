// Names and symbols of the field, in one place.

import type { Optimum, Row } from "./document.ts";

export const NAMES: Record<Optimum, string> = {
  displacement: "Displacement",
  "efficiency-small": "Efficiency, small",
  "efficiency-large": "Efficiency, large",
  turning: "Turning",
  sideways: "Sideways",
  speed: "Fastest",
};

export const SYMBOLS: Record<Row, string> = { x: "Hₓ", y: "H_y", theta: "H_θ" };

export const ROW_NAMES: Record<Row, string> = { x: "x, along", y: "y, across", theta: "θ, turning" };

/** Formats a number with significant digits, a typographic minus, and no minus before zero. */
export function figure(value: number, digits: number): string {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text.replace("-", "−");
}

/** Formats a length [m] in a suitable unit. */
export function length(metres: number): string {
  return Math.abs(metres) < 1 ? `${figure(metres * 1000, 2)} mm` : `${figure(metres, 4)} m`;
}

export function angle(radians: number): string {
  return `${figure((radians * 180) / Math.PI, 2)}°`;
}
