// Joints of the robot, or of a replay, on the height map with the gait.

import { useEffect, useRef } from "preact/hooks";
import { activeGait, shown } from "../explore/document.ts";
import { painted, fullScale } from "../explore/colours.ts";
import { path as line } from "../explore/map.tsx";
import { curveOf, curveOfText, curves, map } from "../explore/model.ts";
import { pairs } from "../explore/spline.ts";
import { dark } from "../shell/theme.tsx";
import { comparison, robotGait } from "./gait.ts";
import { replay } from "./recordings.ts";
import { telemetry } from "./robot.ts";

export function Follow() {
  const d = shown.value.halfWidth;
  const latest = telemetry.value;
  const past = replay.value;
  const joints = past ? past.sample.phi_rad : latest && [latest.setpoint[0] * 1e-4, latest.setpoint[1] * 1e-4];
  const there = comparison.value.is === "other" ? robotGait.value : null;
  const differs = comparison.value.is === "other";
  return (
    <figure class="map" aria-label="Joints of the robot on the height map">
      <figcaption class="soft" id="legend">
        <LegendLine dashed={differs} /> {LEGEND[comparison.value.is]}
        {past && <> · <span class="recorded-key">— recording</span></>}
        {differs && (there ? <> · <LegendLine /> the robot’s gait</> : " · the robot’s gait came from elsewhere and is not drawn")}
      </figcaption>
      <div class="plane">
        <Heights />
        <svg viewBox={`${-d} ${-d} ${2 * d} ${2 * d}`} role="img" aria-label="The joints’ set-point over the gait">
          {curves.value?.zero_curves.map(({ vertices, closed }, k) => <path key={k} class="zero" d={line(vertices, closed)} />)}
          {there && <path id="gait-there" class="gait first" d={line(typeof there === "string" ? curveOfText(there) : pairs(there), true)} />}
          <path id="gait-shown" class={`gait first ${differs ? "not-there" : ""}`} d={line(curveOf(activeGait(shown.value)), true)} />
          {past && <path class="recorded" d={line(past.before.map(({ phi_rad }) => phi_rad), false)} />}
          {joints && <circle id="setpoint" class="joints" cx={joints[0]} cy={-(joints[1] ?? 0)} r={d * 0.025} />}
        </svg>
      </div>
    </figure>
  );
}

const LEGEND = {
  unknown: "gait shown",
  none: "gait shown; the robot holds none",
  same: "gait shown, and on the robot",
  other: "gait shown, not on the robot",
};

function LegendLine({ dashed = false }: { dashed?: boolean }) {
  return <svg class="legend-line" viewBox="0 0 24 8" aria-hidden="true"><path class={`gait first ${dashed ? "not-there" : ""}`} d="M0 4h24" /></svg>;
}

function Heights() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [seen, isDark] = [map.value, dark.value];
  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (!context || !seen) return;
    context.canvas.width = context.canvas.height = seen.count;
    context.putImageData(painted(seen.heights, seen.count, fullScale(seen.heights), isDark), 0, 0);
  }, [seen, isDark]);
  return <canvas ref={canvas} aria-hidden="true" />;
}
