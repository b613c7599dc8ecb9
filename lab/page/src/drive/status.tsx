// Last telemetry of the robot, grey if it is old. The state is in the bar of every tab.

import { figure } from "../explore/names.ts";
import { inHex } from "./gait.ts";
import { downloadLog, health, hello, link, stale, table, telemetry } from "./robot.ts";
import type { Hello, StateName } from "./words.ts";

export const STATES: Record<StateName, string> = {
  Stopped: "Stopped: pulses are off",
  EStopped: "E-stopped: pulses are off, latched",
  Holding: "Holding: pulses are on",
  Starting: "Starting softly",
  Playing: "Playing",
  Paused: "Paused: pulses are on",
  Stopping: "Stopping: ramp to neutral",
  Settling: "Settling at neutral",
};

/** Flags that are shown, by their bits in link-protocol's `Flags`. */
const FLAGS: readonly (readonly [number, string])[] = [
  [1, "battery low"],
  [2, "reset loop: arming is refused"],
  [4, "link silent"],
  [8, "goes on without a link"],
  [16, "a new gait waits for the cycle’s end"],
  [128, "storage failed"],
];

const version = ({ firmware: { major, minor, patch } }: Hello) => `${major}.${minor}.${patch}`;
const degrees = (unit: number) => `${figure((unit * 1e-4 * 180) / Math.PI, 1)}°`;

export function Status() {
  const latest = telemetry.value;
  if (link.value.state === "closed") return null;
  if (!latest) return <section class="card" aria-label="State"><p class="soft">The robot has reported nothing yet.</p></section>;
  const flags = FLAGS.filter(([bit]) => latest.flags & bit).map(([, name]) => name);
  const trip = health.value?.round_trip_s;
  return (
    <section class="card state" aria-label="State">
      <h2>Telemetry{stale.value ? " (old)" : ""}</h2>
      {flags.length > 0 && <p class="error">{flags.join(" · ")}</p>}
      <table class="readout">
        <tbody>
          <Row name="cycle">{latest.cycle}{latest.cycles ? ` of ${latest.cycles}` : ""}, {Math.round((latest.phase / 65536) * 100)} %</Row>
          <Row name="joints">{degrees(latest.setpoint[0])}, {degrees(latest.setpoint[1])}</Row>
          <Row name="pulses">{latest.pulse_ns[0] ? latest.pulse_ns.map((ns) => `${figure(ns / 1000, 1)} µs`).join(", ") : "off"}</Row>
          <Row name="predicted pose">{figure(latest.pose.x * 1000, 1)}, {figure(latest.pose.y * 1000, 1)} mm, {figure((latest.pose.theta * 180) / Math.PI, 1)}°</Row>
          <Row name="battery">{latest.battery_mv === null ? "not measured" : `${figure(latest.battery_mv / 1000, 2)} V`}</Row>
          <Row name="link">{trip == null ? "–" : `${figure(trip * 1000, 1)} ms round trip`}{health.value ? `, ${health.value.counters.retransmissions} repeats` : ""}</Row>
          <Row name="gait there">{table.value ? `CRC ${inHex(table.value.crc32)}, ${table.value.knots} knots, at least ${figure(table.value.min_period_us * 1e-6, 2)} s` : "none"}</Row>
          <Row name="robot">{hello.value ? `${hello.value.board}, firmware ${version(hello.value)}` : "another page’s"}</Row>
        </tbody>
      </table>
      {link.value.state === "open" && (
        <div class="bar-of-buttons">
          <button id="log" onClick={downloadLog}>Save the log (MCAP)</button>
          <span class="soft">{health.value?.frames ?? 0} frames{health.value?.forgotten ? `, ${health.value.forgotten} older ones forgotten` : ""}</span>
        </div>
      )}
    </section>
  );
}

function Row({ name, children }: { name: string; children: preact.ComponentChildren }) {
  return (
    <tr>
      <th scope="row">{name}</th>
      <td>{children}</td>
    </tr>
  );
}
