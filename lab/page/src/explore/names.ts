// Names and symbols of the field, in one place.

import { signal } from "@preact/signals";
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
export function figure(value: number | null, digits: number): string {
  if (value === null) return "–";
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text.replace("-", "−");
}

/** Formats a length [m] in a suitable unit. */
export function length(metres: number): string {
  return Math.abs(metres) < 1 ? `${figure(metres * 1000, 2)} mm` : `${figure(metres, 4)} m`;
}

/** Unit of every angle on the page. */
export const unit = signal<"°" | "rad">("°");

/** An angle [rad] as a number in the chosen unit. */
export const inUnit = (radians: number) => (unit.value === "°" ? (radians * 180) / Math.PI : radians);

export function angle(radians: number): string {
  return unit.value === "°" ? `${figure(inUnit(radians), 2)}°` : `${figure(radians, 4)} rad`;
}

/** Formats an angular rate [rad/s]. */
export function rate(radians: number): string {
  return unit.value === "°" ? `${figure(inUnit(radians), 1)}°/s` : `${figure(radians, 2)} rad/s`;
}

/** Conditions of a certificate in words; their keys are those of `swimmer certify`. */
const CONDITIONS: Record<string, string> = {
  arc_off_its_bound_rad: "arcs lie on their bound",
  arcs_swum_again: "arcs agree with a second integration",
  ascent_directions: "no direction in which the gait improves",
  ascent_directions_without_symmetry: "none without the symmetries either",
  bound_multiplier_least: "the bound pushes outwards",
  bound_overstepped_rad: "no joint beyond its bound",
  contact_multiplier_least: "touching links push apart",
  corner_rad: "no corners",
  displacement_off_momentum: "displacement agrees with the momentum",
  displacement_stepped_again: "displacement agrees with smaller steps",
  displacement_swum_again: "displacement agrees with a second integration",
  double_switches: "both joints never switch at once",
  efficiency_swum_again: "efficiency agrees with a second integration",
  ends_not_square_rad: "quarters meet at right angles",
  final_lambda4: "costate vanishes at the free end",
  h_u: "Hamiltonian is stationary in the joint rates",
  hamiltonian: "Hamiltonian is zero",
  hamiltonian_variation: "Hamiltonian is constant",
  legendre_clebsch_least: "singular arcs are maxima (Legendre–Clebsch)",
  legendre_least: "rates are maxima (Legendre)",
  momentum_off_scale: "momentum has the scale of the displacement",
  net_lateral: "no sideways displacement",
  net_rotation_rad: "no net rotation",
  off_exit_condition_rad: "arcs leave the bound where they should",
  off_full_rate: "a joint always turns at full rate",
  off_singular_condition_rad: "singular arcs keep their condition",
  open_rad: "the curve closes",
  other_start_better: "no other start is better",
  power_variation: "power is constant",
  sampling_pose_error: "samples give the pose",
  sampling_slope_error: "samples give the slope",
  second_variation_least: "second variation is negative",
  self_crossings: "the curve does not cross itself",
  shooting_residual: "shooting conditions hold",
  switch_to_switch_integrals: "switching integrals vanish",
  switching_function_least: "the switching function keeps its sign",
  turning_number_off_one: "the curve goes round once",
};

export const condition = (key: string) => CONDITIONS[key] ?? key.replaceAll("_", " ");
