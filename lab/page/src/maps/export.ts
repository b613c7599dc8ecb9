// Reader of the export of `swimmer sweep map --export FILE.json`, with a message for each error.

import type { Named } from "./words.ts";

export interface Quantity extends Named {
  /** Rows along the second axis, columns along the first; null for designs without a gait. */
  values: (number | null)[][];
}

export interface SweepMap {
  plan: string;
  objective: string;
  axes: [Axis, Axis];
  quantities: Quantity[];
  structure: (string | null)[][];
  status: string[][];
  folds: [number, number][][];
  pareto: FrontPoint[];
  /** Axes of the whole plan; empty in an export of an older version. */
  plan_axes: Named[];
}

/** Design of the Pareto front. */
export interface FrontPoint {
  key: number;
  speed: number;
  efficiency: number;
  /** Values of the plan's axes; missing in an export of an older version. */
  design?: number[];
}

export interface Axis extends Named {
  values: number[];
}

const FORMAT = "swimmer-sweep-map 1";

/** Reads an export; throws an error message of one sentence. */
export function readMap(text: string): SweepMap {
  let parsed: unknown;
  try {
    parsed = JSON.parse(text);
  } catch {
    throw new Error("this is no JSON; open what `swimmer sweep map --export` wrote");
  }
  const from = parsed as Partial<SweepMap> & { format?: unknown };
  if (from?.format !== FORMAT) throw new Error(`its format is ${JSON.stringify(from?.format)}, and this page reads "${FORMAT}"`);
  const { axes, quantities } = from;
  if (!Array.isArray(axes) || axes.length !== 2 || !axes.every((axis) => Array.isArray(axis?.values) && axis.values.length > 0)) {
    throw new Error("it has no two axes with values");
  }
  if (!Array.isArray(quantities) || quantities.length === 0) throw new Error("it has no quantities");
  const [columns, rows] = axes.map((axis) => axis.values.length) as [number, number];
  for (const { name, values } of quantities) {
    const size = [values?.length, values?.[0]?.length];
    if (size[0] === rows && size[1] === columns) continue;
    if (size[0] === columns && size[1] === rows) continue;
    throw new Error(`its quantity ${name} is ${size.join(" × ")}, and its axes are ${columns} × ${rows}`);
  }
  return {
    plan: String(from.plan ?? ""),
    objective: String(from.objective ?? ""),
    axes: axes as [Axis, Axis],
    quantities,
    structure: from.structure ?? [],
    status: from.status ?? [],
    folds: from.folds ?? [],
    pareto: from.pareto ?? [],
    plan_axes: from.plan_axes ?? [],
  };
}
