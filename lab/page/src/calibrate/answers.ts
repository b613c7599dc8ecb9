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
  path: [number, number][];
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

export interface EvidenceAnswer {
  sphere_radius_m: number;
  chi: number;
  intervals: Intervals;
  correlation: number;
  profiles: [Profile, Profile];
  /** Borders of joint regions: rₛ [m] and χ, once round. */
  ridge: { level: number; corners: [number, number][] }[];
  start_curve: CurvePoint[];
  fitted_curve: CurvePoint[];
}

export interface Profile {
  points: [number, number][];
  threshold: number;
  interval: [number | null, number | null];
}

export interface AssessmentAnswer {
  verdict: "trust" | "caution" | "do not use";
  reasons: string[];
  reduced_chi2: number | null;
  systematics: { sphere_radius_m: number; chi: number; intervals: Intervals } | null;
  budget: { name: string; by: number; unit: string; sphere_radius_m: number; chi: number; width: number | null; stated: boolean }[];
  explanations: { name: string; gain: number; estimate: { sphere_radius_m: number; chi: number } }[];
}
