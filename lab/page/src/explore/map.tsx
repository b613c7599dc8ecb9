// Height map: heights on a canvas, with zero curves, gaits and control points as SVG on top.

import { computed } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { dark } from "../shell/theme.tsx";
import { activeGait, OPTIMA, shown } from "./document.ts";
import { diverging, fullScale, painted } from "./colours.ts";
import { Handles, hint } from "./handles.tsx";
import { curveOf, curves, INTERVALS, map, motions } from "./model.ts";
import { inUnit, NAMES, SYMBOLS, unit } from "./names.ts";
import { time } from "./swimming.tsx";

const full = computed(() => (map.value ? fullScale(map.value.heights) : 1));

/** A path through points of the (φ₁, φ₂) plane; φ₂ is drawn upwards. */
export function path(points: readonly (readonly [number, number])[], closed: boolean): string {
  if (points.length === 0) return "";
  const steps = points.map(([x, y], k) => `${k ? "L" : "M"}${x.toFixed(4)} ${(-y).toFixed(4)}`);
  return steps.join("") + (closed ? "Z" : "");
}

export function HeightMap() {
  const { row, halfWidth: d, gaits, overlaid, active } = shown.value;
  return (
    <figure class="map" aria-label={`Height map, ${SYMBOLS[row]}`}>
      <div class="plane">
        <Heights />
        <svg id="map" viewBox={`${-d} ${-d} ${2 * d} ${2 * d}`} role="group" aria-label="Gaits over the map">
          <Axes d={d} />
          {curves.value?.zero_curves.map(({ vertices, closed }, k) => <path key={k} class="zero" d={path(vertices, closed)} />)}
          {overlaid.map((what) => (
            <path key={what} class={`overlaid of-${OPTIMA.indexOf(what)}`} d={path(curveOf({ kind: "optimum", what }), true)}>
              <title>{NAMES[what]}</title>
            </path>
          ))}
          {gaits.map((gait, slot) => (
            <path key={slot} id={`gait-${slot}`} class={slot === 0 ? "gait first" : "gait second"} d={path(curveOf(gait), true)} />
          ))}
          {gaits.map((gait, slot) => (
            <path key={slot} class={slot === 0 ? "heads first" : "heads second"} d={heads(curveOf(gait), d)} />
          ))}
          <Handles gait={activeGait(shown.value)} second={active === 1} />
          <Now d={d} />
        </svg>
      </div>
      <Legend />
      {activeGait(shown.value).kind === "drawn" && <p class="soft hint" role="status">{hint}</p>}
    </figure>
  );
}

/** Number of arrow heads on a gait. */
const HEADS = 4;

/** Arrow heads along a closed curve, in its direction. */
function heads(points: readonly (readonly [number, number])[], d: number): string {
  const size = d * 0.035;
  return Array.from({ length: points.length < 2 * HEADS ? 0 : HEADS }, (_, k) => {
    const at = Math.floor(((k + 0.5) * points.length) / HEADS);
    const [[x, y], [x1, y1]] = [points[at] ?? [0, 0], points[(at + 1) % points.length] ?? [0, 0]];
    const along = Math.atan2(y1 - y, x1 - x);
    const corner = (turn: number, far: number) => `${(x + far * Math.cos(along + turn)).toFixed(4)} ${(-(y + far * Math.sin(along + turn))).toFixed(4)}`;
    return `M${corner(0, size)}L${corner(2.5, size)}L${corner(-2.5, size)}Z`;
  }).join("");
}

/** Numbers per instant in a motion; joint angles are the second and third. */
const STRIDE = 26;

/** Shapes of the animation at this moment. */
function Now({ d }: { d: number }) {
  const at = Math.round((time.value % 1) * INTERVALS) * STRIDE;
  return (
    <g aria-hidden="true">
      {motions.value.map((motion, slot) => motion && (
        <circle key={slot} class={slot === 0 ? "now first" : "now second"} cx={motion[at + 1] ?? 0} cy={-(motion[at + 2] ?? 0)} r={d * 0.016} />
      ))}
    </g>
  );
}

function Heights() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [seen, isDark, most] = [map.value, dark.value, full.value];
  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (!context || !seen) return;
    context.canvas.width = context.canvas.height = seen.count;
    context.putImageData(painted(seen.heights, seen.count, most, isDark), 0, 0);
  }, [seen, isDark, most]);
  return <canvas ref={canvas} id="heights" aria-hidden="true" />;
}

function Axes({ d }: { d: number }) {
  // Radians at each tick: whole ones, or multiples of 45°.
  const step = unit.value === "°" ? Math.PI / 4 : 1;
  const most = Math.floor((d * 0.97) / step);
  const marks = Array.from({ length: 2 * most + 1 }, (_, k) => (k - most) * step).filter((mark) => mark !== 0);
  const label = (mark: number) => String(Math.round(inUnit(mark))).replace("-", "−");
  const size = d * 0.05;
  return (
    <g class="axes" font-size={size} aria-hidden="true">
      <path d={`M${-d} 0H${d}M0 ${-d}V${d}`} />
      {marks.map((mark) => (
        <g key={mark}>
          {/* The name of the axis is at its end. */}
          {mark < 0.4 * d && <text x={mark} y={d - size * 0.5} text-anchor="middle">{label(mark)}</text>}
          <text x={-d + size * 0.4} y={-mark + size * 0.35}>{label(mark)}</text>
        </g>
      ))}
      <text x={d - size * 0.4} y={d - size * 0.5} text-anchor="end">front joint φ₁ [{unit}]</text>
      <text x={-d + size * 0.4} y={-d + size * 1.1}>back joint φ₂ [{unit}]</text>
    </g>
  );
}

function Legend() {
  const { row } = shown.value;
  const unit = row === "theta" ? "rad⁻¹" : "rad⁻²";
  const stops = Array.from({ length: 21 }, (_, k) => `rgb(${diverging(k / 10 - 1, dark.value).join(" ")})`);
  const end = full.value.toPrecision(2);
  return (
    <figcaption class="legend">
      <span>{SYMBOLS[row]}{row === "theta" ? "" : "/L"} [{unit}]</span>
      <span>−{end}</span>
      <span class="bar" style={{ background: `linear-gradient(90deg, ${stops.join()})` }} />
      <span>{end}</span>
      <span class="zero-key">— zero</span>
    </figcaption>
  );
}

