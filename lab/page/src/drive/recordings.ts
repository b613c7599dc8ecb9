// Recorded plays of this page and of opened link logs, and the replay of one of them.

import { computed, signal } from "@preact/signals";
import type { RecordedPlay, RecordedSample } from "./words.ts";

export interface Recording extends RecordedPlay {
  id: number;
  name: string;
  /** Link log with the frames of the play; `null` for a play of an opened log, which is on the disk already. */
  log: ArrayBuffer | null;
}

export const recordings = signal<readonly Recording[]>([]);
/** Reason why the last opened log is not replayed. */
export const unreadable = signal("");

/** Replayed recording, and the time in it [s]. */
export const replayed = signal<Recording | null>(null);
export const replayTime = signal(0);
export const replayRuns = signal(false);

/** Number of recordings kept; a play of an hour has about ten megabytes. */
const KEPT = 20;
let last = 0;

const named = ({ began_s }: RecordedPlay, name: string) => name || `Play of ${new Date(began_s * 1000).toLocaleTimeString()}`;

/** Adds the plays of a log. `name` is the file that was opened, and empty for a play of this page. */
export function addRecordings(plays: readonly RecordedPlay[], name: string, log: ArrayBuffer | null): void {
  const added = plays.map((play, k) => {
    last += 1;
    return { ...play, id: last, log, name: named(play, name && (plays.length > 1 ? `${name}, play ${k + 1}` : name)) };
  });
  recordings.value = [...added.reverse(), ...recordings.peek()].slice(0, KEPT);
  unreadable.value = plays.length === 0 ? `${name || "The log"} holds no play.` : "";
}

export const duration = ({ samples }: RecordedPlay) => samples.at(-1)?.t_s ?? 0;

/** Telemetry of the replay at its time, and the samples up to it. */
export const replay = computed((): { sample: RecordedSample; before: readonly RecordedSample[] } | null => {
  const { samples } = replayed.value ?? { samples: [] };
  let [low, high] = [0, samples.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((samples[middle]?.t_s ?? 0) <= replayTime.value) low = middle + 1;
    else high = middle;
  }
  const sample = samples[Math.max(0, low - 1)];
  return sample ? { sample, before: samples.slice(0, low) } : null;
});

export function startReplay(recording: Recording): void {
  replayed.value = recording;
  replayTime.value = 0;
  replayRuns.value = true;
}

export function endReplay(): void {
  replayed.value = null;
  replayRuns.value = false;
}
