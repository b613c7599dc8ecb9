// The field's names and symbols, once.

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

/** A number with so many digits that change with a hand's width, a real minus, and no minus before zero. */
export function figure(value: number, digits: number): string {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text.replace("-", "−");
}

/** A length [m] in the unit that a reader would take. */
export function length(metres: number): string {
  return Math.abs(metres) < 1 ? `${figure(metres * 1000, 2)} mm` : `${figure(metres, 4)} m`;
}

export function angle(radians: number): string {
  return `${figure((radians * 180) / Math.PI, 2)}°`;
}
