// Present state of the robot: its joints on the height map with the gait, and its predicted path from above.

import { useEffect, useRef } from "preact/hooks";
import { activeGait, shown } from "../explore/document.ts";
import { painted, fullScale } from "../explore/colours.ts";
import { path as line } from "../explore/map.tsx";
import { curveOf, curveOfText, curves, map } from "../explore/model.ts";
import { pairs } from "../explore/spline.ts";
import { dark } from "../shell/theme.tsx";
import { comparison, robotGait } from "./gait.ts";
import { path, stands, telemetry } from "./robot.ts";

export function Follow() {
  const d = shown.value.halfWidth;
  const latest = telemetry.value;
  const [phi1, phi2] = latest ? [latest.setpoint[0] * 1e-4, latest.setpoint[1] * 1e-4] : [0, 0];
  const there = comparison.value.is === "other" ? robotGait.value : null;
  const differs = comparison.value.is === "other";
  return (
    <>
      <figure class="map" aria-label="Joints of the robot on the height map">
        <figcaption class="soft" id="legend">
          <LegendLine dashed={differs} /> {LEGEND[comparison.value.is]}
          {differs && (there ? <> · <LegendLine /> the robot’s gait</> : " · the robot’s gait came from elsewhere and is not drawn")}
        </figcaption>
        <div class="plane">
          <Heights />
          <svg viewBox={`${-d} ${-d} ${2 * d} ${2 * d}`} role="img" aria-label="The joints’ set-point over the gait">
            {curves.value?.zero_curves.map(({ vertices, closed }, k) => <path key={k} class="zero" d={line(vertices, closed)} />)}
            {there && <path id="gait-there" class="gait first" d={line(typeof there === "string" ? curveOfText(there) : pairs(there), true)} />}
            <path id="gait-shown" class={`gait first ${differs ? "not-there" : ""}`} d={line(curveOf(activeGait(shown.value)), true)} />
            {latest && <circle id="setpoint" class="joints" cx={phi1} cy={-phi2} r={d * 0.025} />}
          </svg>
        </div>
      </figure>
      <Way />
    </>
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

/** Predicted path, and for the robot in the page its true position in the tank. */
function Way() {
  const points = path.value;
  const truth = stands.value;
  const xs = points.map(([x]) => x);
  const ys = points.map(([, y]) => y);
  const [x0, x1] = [Math.min(0, ...xs), Math.max(0.05, ...xs)];
  const [y0, y1] = [Math.min(-0.02, ...ys), Math.max(0.02, ...ys)];
  const room = 0.08 * (x1 - x0);
  const box = `${x0 - room} ${-y1 - room} ${x1 - x0 + 2 * room} ${y1 - y0 + 2 * room}`;
  const last = points.at(-1);
  return (
    <figure class="card way" aria-label="Predicted path">
      <figcaption class="soft">
        Path by the robot’s own model{last ? `: ${(last[0] * 1000).toFixed(1)} mm along, ${(last[1] * 1000).toFixed(1)} mm across` : ""}
        {truth ? `; in the virtual tank at ${(truth.pose[0] * 1000).toFixed(0)}, ${(truth.pose[1] * 1000).toFixed(0)} mm` : ""}
      </figcaption>
      <svg viewBox={box} preserveAspectRatio="xMidYMid meet" role="img" aria-label="Path from above">
        <path class="trail" d={line(points, false)} />
        {last && <circle class="joints" cx={last[0]} cy={-last[1]} r={0.012 * (x1 - x0 + y1 - y0)} />}
      </svg>
    </figure>
  );
}
