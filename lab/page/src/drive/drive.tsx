// Drive: connect, upload, arm, play, stop; what the robot tells, as it tells it.

import "./drive.css";
import { Connect } from "./connect.tsx";
import { Controls } from "./controls.tsx";
import { Follow } from "./follow.tsx";
import { Plots } from "./plots.tsx";
import { estop, link, stale, telemetry } from "./robot.ts";
import { Status } from "./status.tsx";

export function Drive() {
  const connected = link.value.state !== "closed";
  return (
    <div class={`drive ${connected && stale.value ? "stale-data" : ""}`}>
      <div class="column">
        <Connect />
        <Controls />
      </div>
      <div class="column">
        <Follow />
      </div>
      <div class="column">
        <Status />
        <Plots />
      </div>
      {connected && <EStop />}
    </div>
  );
}

/** It asks nothing and waits for nothing. */
function EStop() {
  const latched = telemetry.value?.state === "EStopped";
  return (
    <button class="estop" id="estop" onClick={estop} aria-keyshortcuts="Space">
      <strong>E-STOP</strong>
      <span>{latched ? "latched: pulses are off" : "pulses off at once · space bar"}</span>
    </button>
  );
}
