// Bar of every tab: state of the connected robot, and the e-stop.

import { opened, openRoom } from "../shell/open.ts";
import { estop, link, stale, telemetry } from "./robot.ts";
import { STATES } from "./status.tsx";

/** State of the robot, in the head of the page. */
export function RobotBar() {
  if (link.value.state === "closed") return null;
  const latest = telemetry.value;
  const plays = latest && (latest.state === "Playing" || latest.state === "Paused" || latest.state === "Starting");
  return (
    <div class={`robot-bar ${latest ? `state-${latest.state}` : ""} ${stale.value ? "old" : ""}`} aria-label="Robot">
      <strong id="state" data-state={latest?.state ?? ""} role="status">
        {latest ? STATES[latest.state] : "Nothing heard of the robot yet"}
        {latest && stale.value ? " (old)" : ""}
      </strong>
      {plays && (
        <span id="playing">
          cycle {latest.cycle + 1}
          {latest.cycles ? ` of ${latest.cycles}` : ", until stopped"}, {Math.round((latest.phase / 65536) * 100)} %
        </span>
      )}
      {link.value.state !== "open" && <span>{LINK[link.value.state]}</span>}
      {opened.value !== "drive" && <button class="small" onClick={() => openRoom("drive")}>To Drive</button>}
    </div>
  );
}

const LINK = { opening: "opening the link", greeting: "greeting", watching: "watching: another page drives", gone: "link lost" };

/** Sends the e-stop at once, without a confirmation. */
export function EStop() {
  if (link.value.state === "closed") return null;
  const latched = telemetry.value?.state === "EStopped";
  return (
    <button class="estop" id="estop" onClick={estop} aria-keyshortcuts="Space">
      <strong>E-STOP</strong>
      <span>{latched ? "latched: pulses are off" : "pulses off at once · space bar"}</span>
    </button>
  );
}
