// Outputs of the module: documents of the command, and further numbers of the page.

import type { NetMotion, OptimizeOutput } from "../contracts.ts";

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
export interface Net extends NetMotion {
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

type Keys<Union> = Union extends unknown ? keyof Union : never;
type Value<Union, Key> = Union extends unknown ? (Key extends keyof Union ? Union[Key] : undefined) : never;

/** Output of `swimmer optimize`, whose keys depend on the objective, with the text of the gait file as `gait`. */
export type OptimizeReply = { [Key in Exclude<Keys<OptimizeOutput>, "gait">]: Value<OptimizeOutput, Key> } & { gait: string };
