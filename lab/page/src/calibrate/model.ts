// Dropped files to a fit, step by step; each step is shown when it is there.

import { signal } from "@preact/signals";
import { Lab } from "../wasm/lab.ts";
import type { AssessmentAnswer, EvidenceAnswer, FitAnswer, Holdings } from "./answers.ts";

const lab = new Lab("calibrate");

export const tracks = signal<readonly { name: string; holds: Holdings }[]>([]);
export const fit = signal<FitAnswer | null>(null);
export const evidence = signal<EvidenceAnswer | null>(null);
export const assessment = signal<AssessmentAnswer | null>(null);
/** What is computed now, and for how many seconds. */
export const doing = signal<{ what: string; seconds: number } | null>(null);
export const problem = signal("");

setInterval(() => {
  if (doing.value) doing.value = { ...doing.value, seconds: doing.value.seconds + 1 };
}, 1000);
const begin = (what: string) => (doing.value = { what, seconds: 0 });

/** Ends what is computed; what is there already stays. */
export const stop = () => lab.stop("stopped; drop a file or open one to begin again");

let dropped = new Map<string, Uint8Array>();

/** Files as the module takes them: the list's length, the list, the files. */
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

/** Adds files to what is there; with a campaign among them, fits. */
export async function open(files: readonly File[]): Promise<void> {
  problem.value = "";
  for (const file of files) dropped.set(file.name, new Uint8Array(await file.arrayBuffer()));
  try {
    await survey();
    const isCampaign = ([name, bytes]: [string, Uint8Array]) => name.endsWith(".toml") && new TextDecoder().decode(bytes).includes("[[run]]");
    if ([...dropped].some(isCampaign)) await calibrate();
  } catch (error) {
    problem.value = error instanceof Error ? error.message : String(error);
  }
  doing.value = null;
}

export function clear(): void {
  dropped = new Map();
  [tracks.value, fit.value, evidence.value, assessment.value, problem.value] = [[], null, null, null, ""];
}

async function survey(): Promise<void> {
  const known = new Set(tracks.value.map(({ name }) => name));
  for (const [name, bytes] of dropped) {
    if (/\.(toml|txt|gait)$/.test(name) || known.has(name)) continue;
    begin(`reading ${name}`);
    const holds = await lab.json<Holdings>("tracks", packed([[name, bytes]]));
    tracks.value = [...tracks.value, { name, holds }];
  }
}

async function calibrate(): Promise<void> {
  if (fit.value) await lab.json("calibrate close", { number: fit.value.number });
  [fit.value, evidence.value, assessment.value] = [null, null, null];
  begin("fitting rₛ and χ");
  const fitted = await lab.json<FitAnswer>("calibrate", packed([...dropped]));
  fit.value = fitted;
  const { number } = fitted;
  begin("weighing the evidence: likelihood, bootstrap, fits without each run");
  evidence.value = await lab.json<EvidenceAnswer>("calibrate evidence", { number });
  begin("assessing the fit");
  assessment.value = await lab.json<AssessmentAnswer>("calibrate assessment", { number });
}
