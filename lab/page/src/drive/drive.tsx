// Drive tab: connect, upload, arm, play, stop; live telemetry.

import "./drive.css";
import { Connect } from "./connect.tsx";
import { Controls } from "./controls.tsx";
import { Follow } from "./follow.tsx";
import { Plots } from "./plots.tsx";
import { Recordings } from "./recordings-card.tsx";
import { link, stale } from "./robot.ts";
import { Status } from "./status.tsx";
import { Tank } from "./tank.tsx";

export function Drive() {
  const connected = link.value.state !== "closed";
  return (
    <div class={`drive ${connected && stale.value ? "stale-data" : ""}`}>
      <div class="column">
        <Connect />
        <Controls />
        <Recordings />
      </div>
      <div class="column">
        <Tank />
        <Follow />
      </div>
      <div class="column">
        <Status />
        <Plots />
      </div>
    </div>
  );
}
