// Gaits: the dragged gait and its class, optimal gaits to show or to edit, and a second gait for comparison.

import { activeGait, CIRCLE, edit, editGait, type Gait, OPTIMA, type Optimum, shown } from "./document.ts";
import { FEWEST, withPoints } from "./handles.tsx";
import { curveOf, forgetStopped, isCurrent, optima, searching, STOPPED, stopSearch } from "./model.ts";
import { angle, figure, NAMES } from "./names.ts";
import type { OptimizeReply } from "./outputs.ts";
import { symmetrised } from "./spline.ts";
import { path } from "./map.tsx";
import shapes from "./thumbnails.json";

/** Largest number of control points of a dragged gait. */
const MOST = 32;

export function Gaits() {
  const { gaits, active } = shown.value;
  const gait = activeGait(shown.value);
  return (
    <section class="card" aria-label="Gaits">
      <div class="bar-of-buttons">
        <h2>Gait {gaits[1] ? (active ? "B" : "A") : ""}</h2>
        <span class="soft">{named(gait)}</span>
        {gaits[1] === null ? (
          <button onClick={() => edit({ gaits: [gaits[0], gaits[0]], active: 1 })} title="A second gait beside the first">Compare</button>
        ) : (
          <button onClick={() => edit({ gaits: [activeGait(shown.value), null], active: 0 })} title="Keep only the active gait">One gait</button>
        )}
      </div>
      <Drawn gait={gait} />
      <table class="optima">
        <caption class="soft">Optimiser’s gaits: lay over, or take</caption>
        <tbody>{OPTIMA.map((what) => <OptimumRow key={what} what={what} />)}</tbody>
      </table>
    </section>
  );
}

function named(gait: Gait): string {
  if (gait.kind === "drawn") return `drawn, ${gait.points.length} points`;
  return gait.kind === "optimum" ? NAMES[gait.what] : gait.name;
}

function Drawn({ gait }: { gait: Gait }) {
  if (gait.kind !== "drawn") {
    return (
      <div class="bar-of-buttons">
        <button onClick={() => editGait(draggable(gait))} disabled={curveOf(gait).length === 0}>Make it draggable</button>
        <button onClick={() => editGait(CIRCLE)}>Circle</button>
      </div>
    );
  }
  const { points, symmetric } = gait;
  // Each point has four images under the symmetries.
  const step = symmetric ? 4 : 1;
  const fewest = symmetric ? 8 : FEWEST;
  return (
    <div class="bar-of-buttons">
      <button
        aria-pressed={symmetric}
        title="Both symmetries of the paper: a point’s images move with it"
        onClick={() => editGait(symmetric ? { ...gait, symmetric: false } : { ...gait, symmetric: true, points: symmetrised(points) })}
      >
        Symmetric
      </button>
      <button aria-label="Fewer control points" disabled={points.length - step < fewest} onClick={() => withPoints(gait, points.length - step)}>−</button>
      <button aria-label="More control points" disabled={points.length + step > MOST} onClick={() => withPoints(gait, points.length + step)}>+</button>
      <button onClick={() => editGait(CIRCLE)} title="Start again from a circle of 1.2 rad">Circle</button>
      <button onClick={() => editGait({ ...gait, points: [points[0] ?? [0, 0], ...points.slice(1).reverse()] })} title="The same curve the other way round">Reverse</button>
    </div>
  );
}

/** Control points at equal distances along a curve. */
function draggable(gait: Gait): Gait {
  const curve = curveOf(gait);
  const lengths = [0];
  for (let k = 1; k < curve.length; k++) {
    const [a, b] = [curve[k - 1] ?? [0, 0], curve[k] ?? [0, 0]];
    lengths.push((lengths[k - 1] ?? 0) + Math.hypot(b[0] - a[0], b[1] - a[1]));
  }
  const whole = lengths.at(-1) ?? 0;
  const count = 16;
  const points = Array.from({ length: count }, (_, k) => curve[lengths.findIndex((length) => length >= (whole * k) / count)] ?? ([0, 0] as const));
  return { kind: "drawn", points, symmetric: false };
}

function OptimumRow({ what }: { what: Optimum }) {
  const { overlaid } = shown.value;
  const laid = overlaid.includes(what);
  const found = optima.value.get(what);
  const wanted = laid || shown.value.gaits.some((gait) => gait?.kind === "optimum" && gait.what === what);
  const toggle = () => {
    forgetStopped(what);
    const others = shown.value.overlaid.filter((other) => other !== what);
    edit({ overlaid: others.length < shown.value.overlaid.length ? others : [...others, what] });
  };
  const take = () => {
    forgetStopped(what);
    editGait({ kind: "optimum", what });
  };
  const reason = wanted && searching.value?.what !== what && found && "reason" in found && found.reason !== STOPPED ? found.reason : "";
  return (
    <>
      <tr class={wanted && !isCurrent(what) ? "stale" : ""}>
        <th scope="row">
          <label>
            <input type="checkbox" checked={laid} onChange={toggle} />
            <Thumbnail what={what} />
            {NAMES[what]}
          </label>
        </th>
        <td data-optimum={what}>
          {!wanted ? "" : searching.value?.what === what ? <Searching seconds={searching.value.seconds} /> : !found ? "…" : "reason" in found ? (found.reason === STOPPED ? STOPPED : "none") : brief(what, found.output)}
        </td>
        <td>
          <button class="small" onClick={take} aria-label={`Take ${NAMES[what]}`}>Take</button>
        </td>
      </tr>
      {reason && <tr><td class="error reason" colSpan={3}>{reason}</td></tr>}
    </>
  );
}

/** Gait of an objective in the plane of the joint angles: the one that was found, or before that the robot's within 2.3 rad. */
function Thumbnail({ what }: { what: Optimum }) {
  const found = curveOf({ kind: "optimum", what });
  const points = found.length > 0 ? found.filter((_, k) => k % Math.ceil(found.length / 60) === 0) : shapes[what].map(([x, y]) => [x ?? 0, y ?? 0] as const);
  const reach = 1.12 * Math.max(...points.flatMap(([x, y]) => [Math.abs(x), Math.abs(y)]));
  return (
    <svg class="thumbnail" viewBox={`${-reach} ${-reach} ${2 * reach} ${2 * reach}`} aria-hidden="true">
      <path class="cross" d={`M${-reach} 0H${reach}M0 ${-reach}V${reach}`} />
      <path class={`overlaid of-${OPTIMA.indexOf(what)}`} d={path(points, true)} />
    </svg>
  );
}

/** Seconds of a long search, with a button that stops it. */
function Searching({ seconds }: { seconds: number }) {
  if (seconds === 0) return <>…</>;
  return (
    <>
      <span role="status">searching, {seconds} s </span>
      <button class="small" onClick={stopSearch}>Stop</button>
    </>
  );
}

function brief(what: Optimum, result: OptimizeReply): string {
  const mark = result.certificate.pass ? "✓ " : "";
  if (what === "turning") return `${mark}θ ${angle(result.rotation_rad ?? 0)}`;
  if (what === "sideways") return `${mark}Y/L ${figure(result.lateral_over_length ?? 0, 4)}`;
  if (what === "speed") return `${mark}${figure(result.speed_over_length_per_s ?? 0, 5)} L/s`;
  if (what === "displacement") return `${mark}X/L ${figure(result.displacement_over_length, 4)}`;
  return `${mark}ξ ${figure(result.efficiency ?? 0, 5)}`;
}
