// Height map: heights on a canvas, with zero curves, gaits and control points as SVG on top.

import { computed } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { dark } from "../shell/theme.tsx";
import { activeGait, OPTIMA, shown } from "./document.ts";
import { diverging, fullScale, painted } from "./colours.ts";
import { Handles } from "./handles.tsx";
import { curveOf, curves, map } from "./model.ts";
import { NAMES, SYMBOLS } from "./names.ts";

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
          <Handles gait={activeGait(shown.value)} second={active === 1} />
        </svg>
      </div>
      <Legend />
    </figure>
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
  const marks = Array.from({ length: 2 * Math.floor(d) + 1 }, (_, k) => k - Math.floor(d)).filter((mark) => mark !== 0);
  const size = d * 0.05;
  return (
    <g class="axes" font-size={size} aria-hidden="true">
      <path d={`M${-d} 0H${d}M0 ${-d}V${d}`} />
      {marks.map((mark) => (
        <g key={mark}>
          <text x={mark} y={d - size * 0.5} text-anchor="middle">{mark}</text>
          <text x={-d + size * 0.4} y={-mark + size * 0.35}>{mark}</text>
        </g>
      ))}
      <text x={d - size * 0.4} y={d - size * 0.5} text-anchor="end">φ₁ [rad]</text>
      <text x={-d + size * 0.4} y={-d + size * 1.1}>φ₂ [rad]</text>
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

