// Outputs of the module: documents of the command, and data for the figures.

import type { CalibrateOutput, EvidenceDocument, ExcludedPart, NuisanceFit, Pair, RunOutput } from "../contracts.ts";

/** Data of one run for the figures. */
export interface RunFigures {
  amplitude_rad: number | null;
  clockwise: boolean;
  each: [number, number][];
  path: [number, number][];
}

export type Run = RunOutput & RunFigures;

/** Document of the command without the assessment, which is a later step, and further data of the page. */
export interface FitOutput extends Omit<CalibrateOutput, "runs" | "excluded"> {
  number: number;
  runs: Run[];
  excluded: ExcludedPart[];
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

/** The command's `evidence.json`, and data for the figures. */
export interface EvidenceOutput extends EvidenceDocument {
  draws: Pair[];
  start_curve: CurvePoint[];
  fitted_curve: CurvePoint[];
}

/** Fit with additional parameters, and the swimmer file with the values for which it has keys. */
export interface NuisanceOutput extends NuisanceFit {
  swimmer: string;
}
