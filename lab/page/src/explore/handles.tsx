// Control points of the dragged gait: moved by pointer or arrow keys; points can be added and removed.

import { signal } from "@preact/signals";
import { useRef } from "preact/hooks";
import { editGait, endGesture, type Gait, type Point, shown } from "./document.ts";
import { moved, resampled } from "./spline.ts";

/** Steps of the arrow keys [rad]. */
const STEP = 0.01;
const LARGE_STEP = 0.1;
/** Least number of control points of a dragged gait. */
export const FEWEST = 4;
/** Largest joint angle of a dragged gait [rad]. */
const FARTHEST = 6;

const ARROWS: Record<string, Point> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** A finger needs a handle of 24 px on the narrowest map. */
const coarse = matchMedia("(pointer: coarse)").matches;
const RADIUS = coarse ? 0.075 : 0.022;

const USAGE = "Drag a point, or move the focused one with the arrow keys; Delete removes it.";
/** Line below the map about the control points. */
export const hint = signal(USAGE);

const bounded = (value: number) => Math.max(-FARTHEST, Math.min(FARTHEST, value));

export function Handles({ gait, second }: { gait: Gait; second: boolean }) {
  const dragged = useRef<number | null>(null);
  if (gait.kind !== "drawn") return null;
  const { points, symmetric } = gait;
  const radius = shown.value.halfWidth * RADIUS;
  const move = (index: number, to: Point, gesture: string) =>
    editGait({ ...gait, points: moved(points, index, [bounded(to[0]), bounded(to[1])], symmetric) }, gesture);
  const onKey = (event: KeyboardEvent, index: number, [x, y]: Point) => {
    const arrow = ARROWS[event.key];
    if (arrow && !event.altKey) {
      const step = event.shiftKey ? LARGE_STEP : STEP;
      move(index, [x + arrow[0] * step, y + arrow[1] * step], `key-${index}`);
    } else if (event.key === "Delete" || event.key === "Backspace") {
      if (symmetric) hint.value = "Symmetric gaits lose four points at once: press − or switch Symmetric off.";
      else if (points.length <= FEWEST) hint.value = `A gait has at least ${FEWEST} points.`;
      else {
        hint.value = USAGE;
        editGait({ ...gait, points: points.filter((_, k) => k !== index) });
      }
    } else return;
    event.preventDefault();
  };
  return (
    <g class={second ? "handles second" : "handles"}>
      {points.map(([x, y], index) => (
        <circle
          key={index}
          cx={x}
          cy={-y}
          r={radius}
          tabindex={0}
          role="button"
          aria-label={`Control point ${index + 1} of ${points.length}: φ₁ ${x.toFixed(2)}, φ₂ ${y.toFixed(2)} rad; arrow keys move it`}
          data-index={index}
          onKeyDown={(event) => onKey(event, index, [x, y])}
          onKeyUp={endGesture}
          onPointerDown={(event) => {
            event.currentTarget.setPointerCapture(event.pointerId);
            dragged.current = index;
          }}
          onPointerMove={(event) => {
            if (dragged.current === index) move(index, place(event), `drag-${index}`);
          }}
          onPointerUp={() => {
            dragged.current = null;
            endGesture();
          }}
          onPointerCancel={() => (dragged.current = null)}
        />
      ))}
    </g>
  );
}

/** Position of the pointer in the (φ₁, φ₂) plane. */
function place(event: PointerEvent): Point {
  const svg = (event.currentTarget as SVGElement).ownerSVGElement;
  const box = svg?.getBoundingClientRect();
  if (!box) return [0, 0];
  const d = shown.value.halfWidth;
  return [((event.clientX - box.left) / box.width) * 2 * d - d, d - ((event.clientY - box.top) / box.height) * 2 * d];
}

/** Changes the number of control points on the same curve; the paper's symmetries need a multiple of four. */
export function withPoints(gait: Gait, count: number): void {
  if (gait.kind === "drawn") editGait({ ...gait, points: resampled(gait.points, count) });
}

