// What is asked of the robot, and what it will make of the gait, told before it is sent.

import { computed, effect, signal } from "@preact/signals";
import { activeGait, edit, shown } from "../explore/document.ts";
import { asked, swimmer } from "../explore/model.ts";
import { figure, length } from "../explore/names.ts";
import { busy, cancelUpload, configuration, foretell, foretold, held, hello, link, progress, request, said, stop, table, telemetry, upload } from "./robot.ts";

/** 0 plays until told otherwise. */
const cycles = signal(0);

const question = computed(() => {
  const gait = asked(activeGait(shown.value));
  if (!gait || !swimmer.value || link.value.state !== "open") return null;
  const robot = hello.value && configuration.value ? { hello: hello.value, configuration: configuration.value } : null;
  return { swimmer: swimmer.value.toml, gait, period_s: shown.value.period, robot };
});
let pause: ReturnType<typeof setTimeout> | undefined;
effect(() => {
  const about = question.value;
  clearTimeout(pause);
  // A hand that drags is let come to rest.
  if (about) pause = setTimeout(() => foretell(about), 150);
});

export function Controls() {
  if (link.value.state !== "open") return null;
  const state = telemetry.value?.state;
  const rest = state === "Stopped";
  const period = shown.value.period;
  const gait = asked(activeGait(shown.value));
  return (
    <section class="card" aria-label="Controls">
      <h2>Gait of Explore, on this robot</h2>
      <Preflight />
      <div class="fields">
        <label>period [s] <input type="number" min={0.1} max={4000} step={0.1} value={period} onChange={(event) => event.currentTarget.valueAsNumber > 0 && edit({ period: event.currentTarget.valueAsNumber })} /></label>
        <label>cycles <input type="number" min={0} step={1} value={cycles.value} aria-describedby="endless" onChange={(event) => (cycles.value = Math.max(0, Math.round(event.currentTarget.valueAsNumber || 0)))} /></label>
        <span class="soft" id="endless">0: until stopped</span>
      </div>
      <div class="bar-of-buttons">
        <button id="upload" onClick={() => gait && upload(gait)} disabled={!gait || busy.value !== ""}>Upload</button>
        {progress.value && <button onClick={cancelUpload}>Break off</button>}
        <button id="arm" onClick={() => request("Arm", "arm")} disabled={!rest || busy.value !== ""}>Arm</button>
        <button id="play" class="first" onClick={() => request({ Play: { cycles: cycles.value, period_us: Math.round(period * 1e6), detached: false, checked: { table_crc32: table.value?.crc32 ?? 0, settings_crc32: held.value?.settings_crc32 ?? 0 } } }, "play")} disabled={state !== "Holding" || table.value === null}>Play</button>
        <button id="pause" onClick={() => request({ Pause: { detached: false } }, "pause")} disabled={state !== "Playing"}>Pause</button>
        <button id="resume" onClick={() => request("Resume", "resume")} disabled={state !== "Paused"}>Resume</button>
        <button id="stop" onClick={stop}>Stop</button>
        {state === "EStopped" && <button id="clear" onClick={() => request({ ClearEStop: { count: held.value?.estops ?? 0 } }, "end of the e-stop")}>End the e-stop</button>}
      </div>
      {progress.value && <progress max={progress.value.total} value={progress.value.done} aria-label="Upload" />}
      <p class={said.value.failed ? "error" : "soft"} role="status" id="said">{busy.value ? `${busy.value} …` : said.value.text}</p>
    </section>
  );
}

function Preflight() {
  const answer = foretold.value;
  if (!answer) return <p class="soft">Foretelling …</p>;
  const { told, reason } = answer;
  if (!told) return <p class="error">{reason}</p>;
  const displacement = told.displacement_m ? Math.hypot(...told.displacement_m) : 0;
  return (
    <div class="preflight" id="preflight">
      <p class={told.refused ? "error" : "good"}>{told.refused ? `The robot must not play it: ${told.refused}.` : "The robot will play it."}</p>
      <p class="soft">
        {length(displacement)} a cycle, {figure((told.loss_share ?? 0) * 100, 2)} % less than designed; shortest period {figure(told.min_period_s, 2)} s
        {told.servo_assumed ? "; the servos’ dead band is assumed" : ""}.
      </p>
      {told.configured_as === false && <p class="error">The robot is configured as another swimmer than Explore’s: what is foretold is not for it.</p>}
      {told.warnings.filter((warning) => !told.refused || !warning.endsWith(told.refused)).map((warning) => <p key={warning} class="soft">{warning}.</p>)}
    </div>
  );
}
