// The swimmer in its tank, to scale: body, predicted path of a play, the robot's own path, and the true one of the robot in the page.

import { computed, signal } from "@preact/signals";
import { shown } from "../explore/document.ts";
import { path as line } from "../explore/map.tsx";
import { swimmer } from "../explore/model.ts";
import { figure, length } from "../explore/names.ts";
import { compose, MIDDLE, outline, type Place, type Pose } from "./body.ts";
import { cyclesToDraw } from "./controls.tsx";
import { forecast } from "./gait.ts";
import { replay } from "./recordings.ts";
import { base, link, monitor, path, putBack, stands, start, telemetry, tracked, trackedPath, truth } from "./robot.ts";

/** A path in the tank. */
interface Path {
  name: string;
  /** Class of its line. */
  kind: string;
  /** Pieces between which the robot was not seen. */
  pieces: readonly (readonly Place[])[];
}

/** Pieces of a path between its gaps. */
function pieces(points: readonly (Place | null)[]): Place[][] {
  const all: Place[][] = [[]];
  for (const point of points) {
    if (point) all.at(-1)?.push(point);
    else if (all.at(-1)?.length) all.push([]);
  }
  return all;
}

/** Body that is drawn: of the replay, of the robot in the page, by the cameras, or by the robot's own model. */
const body = computed((): { pose: Pose; joints: Place } => {
  const past = replay.value;
  if (past) return { pose: past.sample.pose, joints: past.sample.phi_rad };
  if (stands.value) return { pose: stands.value.pose, joints: stands.value.angles };
  const latest = telemetry.value;
  if (!latest) return { pose: MIDDLE, joints: [0, 0] };
  const { x, y, theta } = latest.pose;
  if (tracked.value) return { pose: tracked.value, joints: [latest.setpoint[0] * 1e-4, latest.setpoint[1] * 1e-4] };
  return { pose: compose(base.value, [x, y, theta]), joints: [latest.setpoint[0] * 1e-4, latest.setpoint[1] * 1e-4] };
});

/** Prediction of a whole play from its start, and the first cycle in which the body would leave the tank. */
const predicted = computed((): { points: Place[]; wall: number | null; distance: number } => {
  const cycle = forecast.value?.result?.path ?? [];
  const links = swimmer.value;
  const [long, wide] = shown.value.tank;
  const points: Place[] = [];
  let wall: number | null = null;
  let began = start.value;
  const end = cycle.at(-1);
  if (!links || !end) return { points, wall, distance: 0 };
  const leaves = ([x, y]: Place) => Math.abs(x) > long / 2 || Math.abs(y) > wide / 2;
  for (let k = 0; k < cyclesToDraw.value && wall === null; k++) {
    for (const [x, y, theta, front, back] of cycle) {
      const pose = compose(began, [x, y, theta]);
      points.push([pose[0], pose[1]]);
      if (outline(links, pose, [front, back]).some(leaves)) wall ??= k + 1;
    }
    began = compose(began, [end[0], end[1], end[2]]);
  }
  return { points, wall, distance: Math.hypot(began[0] - start.value[0], began[1] - start.value[1]) };
});

/** Drawn paths, in the order of the legend. */
const paths = computed((): readonly Path[] => {
  const past = replay.value;
  if (past) return [{ name: "recorded, by the robot’s own model", kind: "own", pieces: [past.before.map(({ pose: [x, y] }) => [x, y] as const)] }];
  return [
    { name: "predicted", kind: "predicted", pieces: [predicted.value.points] },
    { name: "by the robot’s own model", kind: "own", pieces: [path.value] },
    { name: "true, in the virtual tank", kind: "true", pieces: [truth.value] },
    { name: "tracked by the cameras", kind: "tracked", pieces: pieces(trackedPath.value) },
  ].filter(({ pieces }) => pieces.some((points) => points.length > 1));
});

const near = signal(false);

/** The part of the tank that is drawn [m], with a margin for the walls. */
function frame(pose: Pose, reach: number, [long, wide]: readonly [number, number]): { left: number; bottom: number; width: number; height: number } {
  if (!near.value) {
    const margin = 0.02 * long;
    return { left: -long / 2 - margin, bottom: -wide / 2 - margin, width: long + 2 * margin, height: wide + 2 * margin };
  }
  const all = [...paths.value.flatMap(({ pieces }) => pieces.flat()), [pose[0], pose[1]] as const];
  const xs = all.map(([x]) => x);
  const ys = all.map(([, y]) => y);
  const [x0, x1] = [Math.min(...xs) - reach, Math.max(...xs) + reach];
  const [y0, y1] = [Math.min(...ys) - reach, Math.max(...ys) + reach];
  return { left: x0, bottom: y0, width: x1 - x0, height: y1 - y0 };
}

export function Tank() {
  const links = swimmer.value;
  if (!links) return null;
  const size = shown.value.tank;
  const { pose, joints } = body.value;
  const reach = 0.7 * links.total_length_m;
  const view = frame(pose, reach, size);
  const corners = outline(links, pose, joints);
  const tip = corners[3] ?? [0, 0];
  const unit = view.width / 100;
  return (
    <figure class="card way" aria-label="The swimmer in its tank">
      <figcaption class="bar-of-buttons">
        <h2>Tank, {size[0]} × {size[1]} m</h2>
        <span class="soft">{WHERE[replay.value ? "replay" : stands.value ? "twin" : tracked.value === undefined ? "robot" : tracked.value ? "seen" : "unseen"]}</span>
        <button class="small" aria-pressed={near.value} onClick={() => (near.value = !near.value)}>Near view</button>
        {!stands.value && !tracked.value && link.value.state !== "closed" && <button class="small" onClick={putBack} title="The robot was put back into the middle">To the middle</button>}
      </figcaption>
      <svg
        id="tank"
        class={near.value ? "near" : ""}
        viewBox={`${view.left} ${-view.bottom - view.height} ${view.width} ${view.height}`}
        preserveAspectRatio="xMidYMid meet"
        role="img"
        aria-label={`The swimmer from above, ${figure(pose[0] * 1000, 0)} mm along and ${figure(pose[1] * 1000, 0)} mm across from the middle of the tank`}
      >
        <rect class="walls" x={-size[0] / 2} y={-size[1] / 2} width={size[0]} height={size[1]} />
        {paths.value.map(({ kind, pieces }) => <path key={kind} class={`tank-path ${kind}`} d={pieces.map((points) => line(points, false)).join("")} />)}
        {links.sphere_radius_m > 0 && <circle class="sphere" cx={pose[0]} cy={-pose[1]} r={links.sphere_radius_m} />}
        <path class="body" d={line(corners, false)} />
        <circle class="tip" cx={tip[0]} cy={-tip[1]} r={Math.max(0.006, unit * 0.6)} />
        <ScaleBar view={view} unit={unit} />
      </svg>
      <ul class="key-of-paths">
        {paths.value.map(({ name, kind }) => (
          <li key={kind}><svg viewBox="0 0 24 8" aria-hidden="true"><path class={`tank-path ${kind}`} d="M0 4h24" /></svg>{name}</li>
        ))}
      </ul>
      <Numbers />
      <Monitor />
    </figure>
  );
}

const WHERE = {
  replay: "a recording, from the middle of the tank",
  twin: "the virtual tank",
  robot: "as if it had begun in the middle; no camera is connected",
  seen: "where the cameras see it",
  unseen: "the cameras do not see it",
};

/** Bar of a round length, about a fifth of the width. */
function ScaleBar({ view, unit }: { view: ReturnType<typeof frame>; unit: number }) {
  const power = 10 ** Math.floor(Math.log10(view.width * 0.25));
  const long = ([5, 2, 1].find((digit) => digit * power <= view.width * 0.25) ?? 1) * power;
  const [x, y] = [view.left + 4 * unit, -view.bottom - 4 * unit];
  return (
    <g class="scale-bar" font-size={3.6 * unit} aria-hidden="true">
      <path d={`M${x} ${y}h${long}`} />
      <text x={x} y={y - 1.4 * unit}>{long < 1 ? `${Math.round(long * 1000)} mm` : `${long} m`}</text>
    </g>
  );
}

function Numbers() {
  if (replay.value || link.value.state === "closed") return null;
  const { points, wall, distance } = predicted.value;
  const cycles = cyclesToDraw.value;
  const latest = telemetry.value;
  const own = latest?.state === "Playing" || latest?.state === "Paused" ? latest.pose : null;
  return (
    <p class="soft" id="way">
      {points.length > 0 && `Predicted: ${length(distance)} in ${cycles} ${cycles === 1 ? "cycle" : "cycles"}. `}
      {own && `By the robot’s own model in this play: ${figure(own.x * 1000, 1)} mm along, ${figure(own.y * 1000, 1)} mm across. `}
      {wall !== null && <strong class="error">In cycle {wall} it meets a wall of the tank.</strong>}
    </p>
  );
}

/** Comparison of each tracked cycle with its prediction, by the server. */
function Monitor() {
  if (replay.value || monitor.value.length === 0) return null;
  return (
    <ul class="monitor" aria-label="Tracked cycles" aria-live="polite">
      {monitor.value.map(({ text, warns }, k) => <li key={k} class={warns ? "warning" : ""}>{text}</li>)}
    </ul>
  );
}
