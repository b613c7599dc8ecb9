// Outputs of the module, with the keys of `swimmer … --json`.

export interface SwimmerOutput {
  name: string;
  toml: string;
  hash: string;
  total_length_m: number;
  middle_m: number;
  front_m: number;
  back_m: number;
  chi: number;
  sphere_radius_m: number;
  max_angle_rad: number;
  max_rate_rad_s: number;
  doubts: string[];
}

/** Numbers that are updated during a drag. */
export interface Net {
  displacement_over_length: number;
  displacement_m: number;
  lateral_over_length: number;
  rotation_rad: number;
  delta_y_over_length: number;
  delta_theta_rad: number;
  efficiency: number;
  efficiency_constant_power: number;
  speed_m_per_s: number;
  speed_over_length_per_s: number;
}

export interface SimulateOutput extends Net {
  links_cross: number;
  peak_rates_rad_s: [number, number];
  reach_rad: number;
  shortest_period_s: number | null;
}

export interface TankOutput {
  cycles: number | null;
  part: string | null;
}

export interface Check {
  name: string;
  value: number;
  tolerance: number;
  pass: boolean;
}

export interface Evidence {
  pass: boolean;
  verdict: "pass" | "fail" | "undecided";
  checks: Check[];
}

/** Output of `swimmer optimize`, whose keys depend on the objective, with the text of the gait file as `gait`. */
export interface OptimizeOutput {
  displacement_over_length: number;
  lateral_over_length?: number;
  rotation_rad?: number;
  efficiency?: number;
  speed_over_length_per_s?: number;
  certificate: Evidence;
  gait: string;
}

export interface Mapped {
  max_angle_rad: number;
  at_origin_over_length: number;
  zero_on_diagonal: number | null;
  zero_on_antidiagonal: number | null;
  zero_curves: { closed: boolean; vertices: [number, number][] }[];
}
