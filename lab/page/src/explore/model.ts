// Computation of the results for the document: each effect sends a request to a worker; only the latest request is completed.

import { batch, computed, effect, signal } from "@preact/signals";
import { Lab, Latest } from "../wasm/lab.ts";
import type { CertifyOutput, HeightMapOutput } from "../contracts.ts";
import type { Net, OptimizeReply, SimulateOutput, SwimmerOutput, TankOutput } from "./outputs.ts";
import { type Document, type Gait, type Optimum, activeGait, shown } from "./document.ts";
import { pairs, sampled } from "./spline.ts";

/** Workers: for results during a drag, for slower results, and for searches. */
export const quick = new Lab();
const slow = new Lab();
const search = new Lab();

export const swimmer = signal<SwimmerOutput | null>(null);
/** Time of the first results, ms since the page was opened. */
export const firstNumbers = signal<number | null>(null);
export const trouble = signal("");
export const swum = signal<readonly [SimulateOutput | null, SimulateOutput | null]>([null, null]);
export const tank = signal<readonly [TankOutput | null, TankOutput | null]>([null, null]);
export const evidence = signal<{ of: string; output: CertifyOutput } | null>(null);
export const motions = signal<readonly [Float64Array | null, Float64Array | null]>([null, null]);
export const map = signal<{ heights: Float64Array; count: number; row: string; halfWidth: number } | null>(null);
export const curves = signal<HeightMapOutput | null>(null);
export type FoundOptimum = { of: string } & ({ output: OptimizeReply } | { reason: string });
export const optima = signal<ReadonlyMap<Optimum, FoundOptimum>>(new Map());

export const INTERVALS = 240;

/** Gait in the format of the module; null while it is being searched for. */
export function gaitSource(gait: Gait | null): string | number[] | null {
  if (!gait) return null;
  if (gait.kind === "drawn") return sampled(gait.points);
  if (gait.kind === "text") return gait.text;
  const found = optima.value.get(gait.what);
  return found && "output" in found ? found.output.gait : null;
}

/** The curve of a gait, for the map. */
export function curveOf(gait: Gait | null): readonly (readonly [number, number])[] {
  const question = gaitSource(gait);
  if (!question) return [];
  return typeof question === "string" ? curveOfText(question) : pairs(question);
}

/** The samples of a gait file: lines of u, φ₁, φ₂. */
export function curveOfText(text: string): [number, number][] {
  return text
    .split("\n")
    .map((line) => line.split(",").map(Number))
    .filter((line) => line.length === 3 && line.every(Number.isFinite))
    .map(([, one, two]) => [one ?? 0, two ?? 0]);
}

const bounds = ({ maxAngle, noOverlap }: Document) => ({
  ...(maxAngle === null ? {} : { max_angle: maxAngle }),
  no_overlap: noOverlap,
});

function showError(error: unknown): void {
  trouble.value = error instanceof Error ? error.message : String(error);
}

const latestSwimmer = new Latest(async (question: object) => {
  try {
    const answer = await quick.json<SwimmerOutput>("swimmer", question);
    if (answer.toml !== swimmer.value?.toml) swimmer.value = answer;
    trouble.value = answer.doubts[0] ?? "";
  } catch (error) {
    showError(error);
  }
});
const swimmerAsked = computed(() => JSON.stringify({ swimmer: shown.value.swimmer, with: shown.value.with }));
effect(() => latestSwimmer.give(JSON.parse(swimmerAsked.value)));

/** `true` once the first results exist; less urgent computations wait for them, so that the page opens quickly. */
const begun = signal(false);
const afterFirst = <T>(question: T | null): T | null =>
  begun.value || shown.value.gaits[0].kind === "optimum" ? question : null;

/** `true` if a search takes so long that dependent results are computed from the present gait meanwhile. */
const overdue = signal(false);
const PATIENCE_MS = 200;
/** Replaces a request about an optimum that is about to change: the shown results stay, and no worker delays the search. */
const HELD = "";
const isHeld = (gait: Gait | null) => gait?.kind === "optimum" && !isCurrent(gait.what) && !overdue.value;

type Slot = 0 | 1;
const at = <T>(pair: readonly [T, T], slot: Slot, value: T): readonly [T, T] =>
  slot === 0 ? [value, pair[1]] : [pair[0], value];

for (const slot of [0, 1] as const) {
  const question = computed(() => {
    if (isHeld(shown.value.gaits[slot])) return HELD;
    const gait = gaitSource(shown.value.gaits[slot]);
    return swimmer.value && gait && JSON.stringify({ swimmer: swimmer.value.toml, gait, period: shown.value.period });
  });
  // Results during a drag come first, and requests for outdated curves are dropped.
  const latest = new Latest(async (text: string) => {
    const overtaken = () => question.peek() !== text;
    try {
      const before = swum.peek()[slot];
      if (before) {
        const net = await quick.json<Net>("net", text);
        swum.value = at(swum.peek(), slot, { ...before, ...net });
      }
      if (overtaken()) return;
      const bytes = await quick.bytes("motion", { ...JSON.parse(text), intervals: INTERVALS });
      motions.value = at(motions.peek(), slot, new Float64Array(bytes));
      if (overtaken() && before) return;
      const whole = await quick.json<SimulateOutput>("simulate", text);
      swum.value = at(swum.peek(), slot, whole);
    } catch (error) {
      showError(error);
    }
    begun.value = true;
    firstNumbers.value ??= performance.now();
  });
  effect(() => {
    if (question.value) latest.give(question.value);
    else if (question.value !== HELD) {
      swum.value = at(swum.peek(), slot, null);
      motions.value = at(motions.peek(), slot, null);
    }
  });
  const tankAsked = computed(() => {
    if (isHeld(shown.value.gaits[slot])) return HELD;
    const gait = gaitSource(shown.value.gaits[slot]);
    const [length_m, width_m] = shown.value.tank;
    return afterFirst(swimmer.value) && gait && JSON.stringify({ swimmer: swimmer.value?.toml, gait, length_m, width_m });
  });
  const latestTank = new Latest(async (text: string) => {
    const output = await slow.json<TankOutput>("tank", text).catch(() => null);
    tank.value = at(tank.peek(), slot, output);
  });
  effect(() => {
    if (tankAsked.value) latestTank.give(tankAsked.value);
    else if (tankAsked.value !== HELD) tank.value = at(tank.peek(), slot, null);
  });
}

const certifyAsked = computed(() => {
  if (isHeld(activeGait(shown.value))) return HELD;
  const gait = gaitSource(activeGait(shown.value));
  if (!afterFirst(swimmer.value) || !swimmer.value || !gait) return null;
  const { objective } = shown.value;
  const own = typeof gait === "string" && gait.includes("\n");
  const question = { swimmer: swimmer.value.toml, gait };
  // A gait file names its objective and its bounds.
  return JSON.stringify(own && /^# objective: (?!unspecified)/m.test(gait) ? question : { ...question, objective, bounds: bounds(shown.value) });
});
const latestEvidence = new Latest(async (text: string) => {
  try {
    evidence.value = { of: text, output: await slow.json<CertifyOutput>("certify", text) };
  } catch {
    evidence.value = null;
  }
});
effect(() => {
  if (certifyAsked.value) latestEvidence.give(certifyAsked.value);
});
/** `true` if the shown certificate belongs to an older curve. */
export const evidenceIsStale = computed(() => evidence.value?.of !== certifyAsked.value);

const mapAsked = computed(() =>
  afterFirst(swimmer.value) && swimmer.value
    ? JSON.stringify({ swimmer: swimmer.value.toml, row: shown.value.row, max_angle: shown.value.halfWidth })
    : null,
);
/** Grid nodes along each axis: coarse at first, then fine. */
const COARSE = 41;
const FINE = 161;
const mapLab = new Lab();
const latestMap = new Latest(async (text: string) => {
  const question = JSON.parse(text) as { row: string; max_angle: number };
  try {
    for (const count of [COARSE, FINE]) {
      const bytes = await mapLab.bytes("height-grid", { ...question, count });
      map.value = { heights: new Float64Array(bytes), count, row: question.row, halfWidth: question.max_angle };
      // Replaced by a newer request, which starts coarse again.
      if (mapAsked.peek() !== text) return;
    }
    curves.value = await mapLab.json<HeightMapOutput>("height-map", question);
    void warmUp();
  } catch (error) {
    showError(error);
  }
});
effect(() => {
  if (mapAsked.value) latestMap.give(mapAsked.value);
});

/** Optima that are in use. */
const wanted = computed(() => {
  const { overlaid, gaits } = shown.value;
  const taken = gaits.flatMap((gait) => (gait?.kind === "optimum" ? [gait.what] : []));
  return [...new Set([...overlaid, ...taken])];
});
/** Requests of the command `swimmer optimize`, by gait. */
const OPTIMIZE: Record<Optimum, object> = {
  displacement: { objective: "displacement" },
  "efficiency-small": { objective: "efficiency", optimum: "small" },
  "efficiency-large": { objective: "efficiency", optimum: "large" },
  turning: { objective: "turning" },
  sideways: { objective: "sideways" },
  speed: { objective: "speed" },
};
const optimumAsked = (what: Optimum) => {
  const rates = what === "speed" && swimmer.value ? { max_rate: [swimmer.value.max_rate_rad_s] } : {};
  return JSON.stringify({ ...OPTIMIZE[what], ...rates, swimmer: swimmer.value?.toml, bounds: bounds(shown.value) });
};
/** Present search and its duration in seconds. */
export const searching = signal<{ what: Optimum; seconds: number } | null>(null);
/** Reason of a search that was stopped. */
export const STOPPED = "stopped";
/** Stops the present search. */
export const stopSearch = () => search.stop(STOPPED);
/** Allows a stopped search to start again. */
export function forgetStopped(what: Optimum): void {
  const found = optima.peek().get(what);
  if (!found || !("reason" in found) || found.reason !== STOPPED) return;
  const others = new Map(optima.peek());
  others.delete(what);
  optima.value = others;
}

const latestOptima = new Latest(async (_: number) => {
  for (;;) {
    const what = wanted.peek().find((what) => optima.peek().get(what)?.of !== optimumAsked(what));
    if (!what) return;
    const of = optimumAsked(what);
    searching.value = { what, seconds: 0 };
    const late = setTimeout(() => (overdue.value = true), PATIENCE_MS);
    const counting = setInterval(() => (searching.value = { what, seconds: (searching.peek()?.seconds ?? 0) + 1 }), 1000);
    const found = await search
      .json<OptimizeReply>("optimize", of)
      .then((output) => ({ of, output }), (error: Error) => ({ of, reason: error.message }));
    clearTimeout(late);
    clearInterval(counting);
    batch(() => {
      searching.value = null;
      optima.value = new Map(optima.value).set(what, found);
      overdue.value = false;
    });
  }
});
let warm = false;
/** Additional bounds for the warm-up, since searches along a bound run other code. */
const WARM_BOUNDS = [2, 2.4, 1.8, 2.1, 2.5];
/** Warm-up: browsers optimise code only after it has run for a while, so the first searches run in the background. Their results for
* the shown swimmer are kept. A request by the user waits for at most one of them. */
async function warmUp(): Promise<void> {
  if (warm) return;
  warm = true;
  for (const what of ["displacement", "efficiency-small"] as const) {
    const of = optimumAsked(what);
    const output = await search.json<OptimizeReply>("optimize", of).catch(() => null);
    if (output && !optima.peek().has(what)) optima.value = new Map(optima.peek()).set(what, { of, output });
    for (const max_angle of WARM_BOUNDS) await search.ask("optimize", { ...JSON.parse(of), bounds: { max_angle } }).catch(() => null);
  }
}

let turn = 0;
effect(() => {
  if (swimmer.value && wanted.value.map(optimumAsked).length) latestOptima.give(++turn);
});
/** Returns `true` if an optimum belongs to the present swimmer and bounds. */
export const isCurrent = (what: Optimum) => optima.value.get(what)?.of === optimumAsked(what);
