// Controls: upload, arm, play; forecast of the shown gait before it is sent.

import { computed, signal } from "@preact/signals";
import { activeGait, edit, shown } from "../explore/document.ts";
import { gaitSource } from "../explore/model.ts";
import { figure, length } from "../explore/names.ts";
import { comparison, forecast, inHex } from "./gait.ts";
import { busy, cancelUpload, held, link, progress, request, said, stop, table, telemetry, upload } from "./robot.ts";

const STANDARD_CYCLES = 3;
const cycles = signal(STANDARD_CYCLES);
/** Cycles of a play without end, which ends with the link or by a stop; only on request. */
const endless = signal(false);
const MOST_DRAWN = 50;
/** Cycles whose predicted path is drawn. */
export const cyclesToDraw = computed(() => (endless.value ? MOST_DRAWN : Math.min(MOST_DRAWN, cycles.value)));

export function Controls() {
  if (link.value.state !== "open") return null;
  const state = telemetry.value?.state;
  const rest = state === "Stopped";
  const period = shown.value.period;
  const gait = gaitSource(activeGait(shown.value));
  const mayPlay = state === "Holding" && comparison.value.is === "same";
  const play = { cycles: endless.value ? 0 : cycles.value, period_us: Math.round(period * 1e6), detached: false, checked: { table_crc32: table.value?.crc32 ?? 0, settings_crc32: held.value?.settings_crc32 ?? 0 } };
  return (
    <section class="card" aria-label="Controls">
      <h2>Gait of Explore, on this robot</h2>
      <Which />
      <Preflight />
      <div class="fields">
        <label>period [s] <input type="number" min={0.1} max={4000} step={0.1} value={period} onChange={(event) => event.currentTarget.valueAsNumber > 0 && edit({ period: event.currentTarget.valueAsNumber })} /></label>
        <label>cycles <input type="number" id="cycles" min={1} step={1} value={cycles.value} disabled={endless.value} onChange={(event) => (cycles.value = Math.max(1, Math.round(event.currentTarget.valueAsNumber || STANDARD_CYCLES)))} /></label>
        <label class="check"><input type="checkbox" id="endless" checked={endless.value} onChange={(event) => (endless.value = event.currentTarget.checked)} /> until stopped</label>
      </div>
      <div class="bar-of-buttons">
        <button id="upload" onClick={() => gait && upload(gait)} disabled={!gait || busy.value !== ""}>Upload</button>
        {progress.value && <button onClick={cancelUpload}>Break off</button>}
        <button id="arm" onClick={() => request("Arm", "arm")} disabled={!rest || busy.value !== ""}>Arm</button>
        <button id="play" class="first" title={mayPlay ? "" : WHY_NOT[comparison.value.is]} onClick={() => request({ Play: play }, "play")} disabled={!mayPlay}>Play</button>
        <button id="pause" onClick={() => request({ Pause: { detached: false } }, "pause")} disabled={state !== "Playing"}>Pause</button>
        <button id="resume" onClick={() => request("Resume", "resume")} disabled={state !== "Paused"}>Resume</button>
        <button id="stop" onClick={stop}>Stop</button>
        {state === "EStopped" && <button id="clear" disabled={!held.value} onClick={() => held.value && request({ ClearEStop: { count: held.value.estops } }, "end of the e-stop")}>End the e-stop</button>}
      </div>
      {progress.value && <progress max={progress.value.total} value={progress.value.done} aria-label="Upload" />}
      <p class={said.value.failed ? "error" : "soft"} role="status" id="said">{busy.value ? `${busy.value} …` : said.value.text}</p>
    </section>
  );
}

const WHY_NOT = {
  unknown: "It is not known yet which gait the robot holds.",
  none: "The robot holds no gait: upload one.",
  same: "Arm the robot first.",
  other: "The robot holds another gait than the one shown: upload it first.",
};

/** Names both gaits, and the remedy if they differ. */
function Which() {
  const it = comparison.value;
  const text = {
    unknown: "Comparing the gait shown with the robot’s …",
    none: "The robot holds no gait: upload the one shown.",
    same: "The gait is on the robot",
    other: "The robot holds another gait than the one shown",
  }[it.is];
  return (
    <p id="held" data-held={it.is} class={it.is === "other" ? "warning" : it.is === "same" ? "good" : "soft"} role="status">
      {text}
      {it.is === "same" && ` (CRC ${inHex(it.crc32)}).`}
      {it.is === "other" && ` (there CRC ${inHex(it.crc32)}, here ${inHex(it.shown)}). Upload sends the one shown; until then Play is off.`}
    </p>
  );
}

function Preflight() {
  const answer = forecast.value;
  if (!answer) return <p class="soft">Predicting …</p>;
  const { result, reason } = answer;
  if (!result) return <p class="error">{reason}</p>;
  const displacement = result.displacement_m ? Math.hypot(...result.displacement_m) : 0;
  return (
    <div class="preflight" id="preflight">
      <p class={result.refused ? "error" : "good"}>{result.refused ? `The robot must not play it: ${result.refused}.` : "The robot will play it."}</p>
      <p class="soft">
        {length(displacement)} a cycle, {figure((result.loss_share ?? 0) * 100, 2)} % less than designed; shortest period {figure(result.min_period_s, 2)} s
        {result.servo_assumed ? "; the servos’ dead band is assumed" : ""}.
      </p>
      {result.configured_as === false && <p class="error">The robot is configured as another swimmer than Explore’s: the forecast is not for it.</p>}
      {result.warnings.filter((warning) => !result.refused || !warning.endsWith(result.refused)).map((warning) => <p key={warning} class="soft">{warning}.</p>)}
    </div>
  );
}
