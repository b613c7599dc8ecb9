// Fit of dropped files in steps; the result of each step is shown as soon as it is available.

import { signal } from "@preact/signals";
import { Lab, Latest } from "../wasm/lab.ts";
import type { Advice, AssessmentDocument, TracksOutput } from "../contracts.ts";
import { type EvidenceOutput, type FitOutput, type FitReply, type NuisanceOutput, withFigures } from "./outputs.ts";
import { sample } from "./sample.ts";

const lab = new Lab("robot");

export const tracks = signal<readonly { name: string; holds: TracksOutput }[]>([]);
export const fit = signal<FitOutput | null>(null);
export const evidence = signal<EvidenceOutput | null>(null);
export const assessment = signal<AssessmentDocument | null>(null);
export const advice = signal<Advice | null>(null);
/** Selected words of `--fit-also`, and the result: a fit or an error message. */
export const also = signal<readonly string[]>([]);
export const further = signal<NuisanceOutput | null>(null);
export const noFurther = signal("");
/** Present computation and its duration in seconds. */
export const doing = signal<{ what: string; seconds: number } | null>(null);
export const problem = signal("");

setInterval(() => {
  if (doing.value) doing.value = { ...doing.value, seconds: doing.value.seconds + 1 };
}, 1000);
const begin = (what: string) => (doing.value = { what, seconds: 0 });

/** Stops the computation; existing results stay. */
export const stop = () => lab.stop(STOPPED);
const STOPPED = "stopped; drop a file or open one to begin again";

let dropped = new Map<string, Uint8Array>();
/** Names of the files that are here. */
export const received = signal<readonly string[]>([]);

/** Files in the format of the module: length of the list, the list, the files. */
function packed(files: readonly (readonly [string, Uint8Array])[]): Uint8Array {
  const list = new TextEncoder().encode(JSON.stringify(files.map(([name, { length }]) => ({ name, length }))));
  const bytes = new Uint8Array(4 + list.length + files.reduce((sum, [, file]) => sum + file.length, 0));
  new DataView(bytes.buffer).setUint32(0, list.length, true);
  bytes.set(list, 4);
  let at = 4 + list.length;
  for (const [, file] of files) {
    bytes.set(file, at);
    at += file.length;
  }
  return bytes;
}

const reason = (error: unknown) => (error instanceof Error ? error.message : String(error));

/** While a campaign is fitted, the fit of additional parameters waits. */
let opening = false;

/** Adds files; if a campaign is among them, fits it. */
export async function open(files: readonly File[]): Promise<void> {
  problem.value = "";
  opening = true;
  // Fits of additional parameters to the previous files are repeated at the end.
  [further.value, noFurther.value] = [null, ""];
  begin("reading the files");
  const unread: string[] = [];
  const come: [string, Uint8Array][] = [];
  for (const file of files) {
    try {
      come.push([file.name, new Uint8Array(await file.arrayBuffer())]);
    } catch (error) {
      // A folder, or a file that no longer exists.
      unread.push(`${file.name}: ${reason(error)}`);
    }
  }
  // A new campaign replaces the previous one.
  if (come.some(isCampaign)) dropped = new Map([...dropped].filter((file) => !isCampaign(file)));
  for (const [name, bytes] of come) dropped.set(name, bytes);
  try {
    unread.push(...(await survey(new Set(come.map(([name]) => name)))));
    if ([...dropped].some(isCampaign)) await calibrate();
  } catch (error) {
    unread.push(reason(error));
  }
  received.value = [...dropped.keys()];
  problem.value = unread.join("; ");
  opening = false;
  doing.value = null;
  if (also.value.length > 0) fitting.give(also.value);
}

/** Opens the campaign of a simulated robot. */
export async function trySample(): Promise<void> {
  clear();
  begin("simulating the sample's tracks");
  try {
    await open(await sample());
  } catch (error) {
    [problem.value, doing.value] = [reason(error), null];
  }
}

/** Selects a word of `--fit-also` or removes the selection. */
export function choose(word: string): void {
  also.value = also.value.includes(word) ? also.value.filter((other) => other !== word) : [...also.value, word];
  [further.value, noFurther.value] = [null, ""];
  if (!opening) fitting.give(also.value);
}

const fitting = new Latest<readonly string[]>(async (words) => {
  if (!fit.value || words.length === 0) return;
  begin("fitting more parameters");
  // Results of a removed selection are hidden.
  const isChosen = () => also.value === words;
  try {
    const answer = await lab.json<NuisanceOutput>("calibrate further", { number: fit.value.number, also: words });
    if (isChosen()) further.value = answer;
  } catch (error) {
    if (isChosen()) noFurther.value = reason(error);
  }
  doing.value = null;
});

export function clear(): void {
  dropped = new Map();
  [tracks.value, received.value, problem.value] = [[], [], ""];
  forget();
}

function forget(): void {
  [fit.value, evidence.value, assessment.value, advice.value, further.value, noFurther.value] = [null, null, null, null, null, ""];
}

const isCampaign = ([name, bytes]: [string, Uint8Array]) => name.endsWith(".toml") && new TextDecoder().decode(bytes).includes("[[run]]");

/** Reads the tracking files among `come`. One that cannot be read is let go, so that it stands in the way of no other; returns why. */
async function survey(come: ReadonlySet<string>): Promise<string[]> {
  const unread: string[] = [];
  for (const [name, bytes] of dropped) {
    if (/\.(toml|txt|gait|mcap)$/.test(name) || !come.has(name)) continue;
    tracks.value = tracks.value.filter((track) => track.name !== name);
    begin(`reading ${name}`);
    try {
      const holds = await lab.json<TracksOutput>("tracks", packed([[name, bytes]]));
      tracks.value = [...tracks.value, { name, holds }];
    } catch (error) {
      if (reason(error) === STOPPED) throw error;
      dropped.delete(name);
      unread.push(reason(error).includes(name) ? reason(error) : `${name}: ${reason(error)}`);
    }
  }
  return unread;
}

async function calibrate(): Promise<void> {
  if (fit.value) await lab.json("calibrate close", { number: fit.value.number });
  forget();
  begin("fitting rₛ and χ");
  const fitted = withFigures(await lab.json<FitReply>("calibrate", packed([...dropped])));
  fit.value = fitted;
  const { number } = fitted;
  begin("weighing the evidence: likelihood, bootstrap, fits without each run");
  try {
    evidence.value = await lab.json<EvidenceOutput>("calibrate evidence", { number });
  } catch (error) {
    // A fit can be assessed without it.
    if (reason(error) === STOPPED) throw error;
    fit.value = { ...fitted, warnings: [...fitted.warnings, `no estimate by likelihood: ${reason(error)}`] };
  }
  begin("assessing the fit");
  assessment.value = await lab.json<AssessmentDocument>("calibrate assessment", { number });
  begin("weighing what to measure next");
  advice.value = await lab.json<Advice>("calibrate advice", { number });
}
