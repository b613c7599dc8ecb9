// Comparison of the shown gait with the robot's gait, by the checksums of their tables.

import { computed, effect, signal } from "@preact/signals";
import { activeGait, shown } from "../explore/document.ts";
import { gaitSource, swimmer } from "../explore/model.ts";
import { configuration, requestForecast, hello, latestForecast, link, sent, table } from "./robot.ts";

const question = computed(() => {
  const gait = gaitSource(activeGait(shown.value));
  if (!gait || !swimmer.value || link.value.state !== "open") return null;
  const robot = hello.value && configuration.value ? { hello: hello.value, configuration: configuration.value } : null;
  return { swimmer: swimmer.value.toml, gait, period_s: shown.value.period, robot };
});
/** Number of the latest request; replies to earlier requests are not about the shown gait. */
const number = signal(0);
let pause: ReturnType<typeof setTimeout> | undefined;
effect(() => {
  const about = question.value;
  const of = number.peek() + 1;
  number.value = of;
  clearTimeout(pause);
  // Waits until dragging pauses.
  if (about) pause = setTimeout(() => requestForecast(about, of), 150);
});

/** Forecast of the shown gait; null until it is known. */
export const forecast = computed(() => (latestForecast.value?.of === number.value ? latestForecast.value : null));

export type Comparison =
  /** `true` if it is not known yet. */
  | { is: "unknown" }
  | { is: "none" }
  | { is: "same"; crc32: number }
  | { is: "other"; crc32: number; shown: number };

/** Relation of the robot's gait to the shown one. */
export const comparison = computed((): Comparison => {
  if (link.value.state !== "open") return { is: "unknown" };
  if (table.value === null) return { is: "none" };
  const shownCrc = forecast.value?.result?.crc32;
  if (shownCrc === undefined) return { is: "unknown" };
  const { crc32 } = table.value;
  return crc32 === shownCrc ? { is: "same", crc32 } : { is: "other", crc32, shown: shownCrc };
});

/** Gait of the robot, if this page has sent it. */
export const robotGait = computed(() => (table.value ? (sent.value.get(table.value.crc32) ?? null) : null));

export const inHex = (crc32: number) => crc32.toString(16).padStart(8, "0");
