// Outputs of the module, with the keys of `swimmer tracks --json` and `swimmer calibrate --json`, and data for the figures.

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

/** Cycles of one run, as in the command's output. */
export interface RunOutput {
  file: string;
  gait: string;
  cycles: number | null;
  x_m: number;
  x_sd_m: number | null;
  delta_y_m: number;
  delta_y_sd_m: number | null;
  delta_theta_rad: number;
  delta_theta_sd_rad: number | null;
  period_s: number;
  left_out: { start_s: number; reason: string }[];
  diagnoses: string[];
}

/** Data of one run for the figures. */
export interface RunFigures {
  amplitude_rad: number | null;
  clockwise: boolean;
  each: [number, number][];
  path: [number, number][];
}

export type Run = RunOutput & RunFigures;

/** Output of the command, and further data of the page. */
export interface FitOutput {
  number: number;
  runs: Run[];
  sphere_radius_m: number;
  chi: number;
  rmse: number;
  intervals: Intervals;
  correlation: number;
  c_t_form: string;
  /** Servos, if reflectors on the side links show them. */
  joints?: { front: Servo; back: Servo };
  excluded: { file: string; reason: string }[];
  warnings: string[];
  swimmer: string;
}

/** Output of the module, with the data for the figures in a list of their own. */
export type FitReply = Omit<FitOutput, "runs"> & { runs: RunOutput[]; figures: RunFigures[] };

/** Adds to each run its data for the figures. */
export function withFigures({ figures, runs, ...fit }: FitReply): FitOutput {
  return { ...fit, runs: figures.flatMap((figure, k) => runs.slice(k, k + 1).map((run) => ({ ...run, ...figure }))) };
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

/** Residual of a quantity of a run; null if it was not measured. */
export interface RunError {
  measured: number | null;
  predicted: number | null;
  standard_error: number | null;
  standardised: number | null;
}

/** The command's `evidence.json`, and data for the figures. */
export interface EvidenceOutput {
  likelihood: { estimate: Pair; intervals: Intervals; correlation: number };
  run_errors: { file: string; x_m: RunError; delta_y_m: RunError; delta_theta_rad: RunError }[];
  profiles: { sphere_radius_m: Profile; chi: Profile };
  /** ln of the likelihood relative to its maximum, one row per χ; boundaries of joint regions (rₛ [m], χ) as closed curves. */
  ridge: { sphere_radius_m: number[]; chi: number[]; log_ratio: (number | null)[][]; contours: { level: number; corners: [number, number][] }[] };
  /** Null for fewer than five runs. */
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

/** Measured behaviour of a servo; the error is null if it is unknown. */
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

/** Fit with additional parameters: the command's `further`, and the swimmer file with the values for which it has keys. */
export interface NuisanceOutput {
  parameters: { name: string; unit: string; before: number; value: number; interval: [number, number]; bounds: [number, number] }[];
  level: number;
  correlations: number[][];
  condition: number;
  log_likelihood_gain: number;
  warnings: string[];
  swimmer: string;
}

/** Possible next measurements, the most useful first: the command's `advice`. Ratios of widths with one more run to the present ones. */
export interface AdviceOutput {
  period_s: number;
  candidates: { gait: string; sphere_radius_width: number; chi_width: number; both: number }[];
}

/** A value with its standard error. */
type WithError = [number | null, number | null];

/** Statistics of one run; null if they were not measured. */
export interface RunGoodness {
  file: string;
  y_over_x: WithError;
  y_chance: number | null;
  turn_rad: WithError;
  turn_chance: number | null;
  drift_m_per_s: WithError;
  scale: [number, number] | null;
}

/** Nuisance parameters: prior and fitted values, each with its standard deviation. */
export interface Nuisance {
  name: string;
  unit: string;
  known: [number, number];
  stated: boolean;
  found: [number, number];
  pull: number;
}

/** Output of the command with the same keys. */
export interface AssessmentOutput {
  verdict: "trust" | "caution" | "do not use";
  reasons: string[];
  reduced_chi2: number | null;
  /** Missing if there are too few runs. */
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
