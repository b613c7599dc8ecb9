// What the module answers, under the keys of `swimmer tracks --json` and `swimmer calibrate --json`, and what pictures need.

export interface Holdings {
  format: string;
  rate_hz: number | null;
  unit: string;
  frames: number;
  points: { name: string; present: number; gaps: number; longest_gap: number }[];
  warnings: string[];
}

export interface Intervals {
  sphere_radius_m: [number, number];
  chi: [number, number];
  level: number;
}

export interface Run {
  file: string;
  gait: string;
  amplitude_rad: number | null;
  clockwise: boolean;
  cycles: number | null;
  x_m: number;
  x_sd_m: number | null;
  delta_y_m: number;
  delta_y_sd_m: number | null;
  delta_theta_rad: number;
  delta_theta_sd_rad: number | null;
  period_s: number;
  each: [number, number][];
  left_out: { what: string; reason: string }[];
  /** Front and back, where reflectors on the side links showed them. */
  servos: [Servo, Servo] | null;
  path: [number, number][];
  diagnoses: string[];
  warnings: string[];
}

export interface FitAnswer {
  number: number;
  runs: Run[];
  sphere_radius_m: number;
  chi: number;
  rmse: number;
  intervals: Intervals;
  correlation: number;
  c_t_form: string;
  servos: [Servo, Servo] | null;
  excluded: { what: string; reason: string }[];
  warnings: string[];
  swimmer: string;
}

export interface CurvePoint {
  amplitude_rad: number;
  x_m: number;
  delta_y_m: number;
  delta_theta_rad: number;
}

export interface Pair {
  sphere_radius_m: number;
  chi: number;
}

/** What is left of a quantity of a run; null where it was not measured. */
export interface RunError {
  measured: number | null;
  predicted: number | null;
  standard_error: number | null;
  standardised: number | null;
}

/** The command's `evidence.json`, and what pictures need beside it. */
export interface EvidenceAnswer {
  likelihood: { estimate: Pair; intervals: Intervals; correlation: number };
  run_errors: { file: string; x_m: RunError; delta_y_m: RunError; delta_theta_rad: RunError }[];
  profiles: { sphere_radius_m: Profile; chi: Profile };
  /** The ln of the likelihood over its largest value, a row for each χ; borders of joint regions (rₛ [m], χ), once round. */
  ridge: { sphere_radius_m: number[]; chi: number[]; log_ratio: (number | null)[][]; contours: { level: number; corners: [number, number][] }[] };
  /** Null of fewer than five runs. */
  bootstrap: { draws: number; at_border: number; intervals: Intervals } | null;
  without_run: { file: string; paper: Pair; likelihood: Pair | null }[];
  outliers: { file: string; quantity: string; standard_errors: number }[];
  draws: Pair[];
  start_curve: CurvePoint[];
  fitted_curve: CurvePoint[];
}

export interface Profile {
  points: [number, number][];
  threshold: number;
  interval: [number | null, number | null];
}

/** What a servo made of its command; the error is null where nothing tells it. */
export interface Servo {
  gain: Measured;
  dead_band_rad: Measured;
  offset_rad: Measured;
  lag_s: Measured | null;
}

export interface Measured {
  value: number;
  error: number | null;
}

/** What was fitted also: the command's `further`, and the swimmer's file with all that it can hold of it. */
export interface FurtherAnswer {
  parameters: { name: string; unit: string; before: number; value: number; interval: [number, number]; bounds: [number, number] }[];
  level: number;
  correlations: number[][];
  condition: number;
  log_likelihood_gain: number;
  warnings: string[];
  swimmer: string;
}

/** What to measure next, the most telling first: the command's `advice`. Widths with one run of it more, over those now. */
export interface AdviceAnswer {
  period_s: number;
  candidates: { gait: string; sphere_radius_width: number; chi_width: number; both: number }[];
}

/** A value with its standard error. */
type WithError = [number | null, number | null];

/** What one run says by itself; null where it was not measured. */
export interface RunGoodness {
  file: string;
  y_over_x: WithError;
  y_chance: number | null;
  turn_rad: WithError;
  turn_chance: number | null;
  drift_m_per_s: WithError;
  scale: [number, number] | null;
}

/** What is known by halves: as the files say and as the runs make it, each with its deviation. */
export interface Nuisance {
  name: string;
  unit: string;
  known: [number, number];
  stated: boolean;
  found: [number, number];
  pull: number;
}

/** The command's answer under the same keys. */
export interface AssessmentAnswer {
  verdict: "trust" | "caution" | "do not use";
  reasons: string[];
  reduced_chi2: number | null;
  /** Left out where the runs are too few. */
  intervals_with_systematics?: Intervals;
  headline: { by: "paper" | "systematics" } & Pair;
  goodness: {
    freedom: number;
    reduced_chi2_with_systematics: number | null;
    signs: { quantity: string; signs: number[]; stretches: number; chance: number }[];
    runs: RunGoodness[];
  };
  systematics?: Pair & { parameters: Nuisance[] };
  budget: { name: string; by: number; unit: string; sphere_radius_m: number; chi: number; width: number | null; stated: boolean }[];
  explanations: { name: string; gain: number; estimate: { sphere_radius_m: number; chi: number } }[];
}
