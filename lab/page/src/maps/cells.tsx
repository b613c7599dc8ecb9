// Coloured cells of a map over its two axes, with ticks, the lines at which the arcs change, and the design that is pointed at.

import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { dark } from "../shell/theme.tsx";
import type { Axis, SweepMap } from "./export.ts";
import { rampColour } from "./ramp.ts";
import { labelOf, printed, wordsOf } from "./words.ts";

/** Column and row of the design that is pointed at. */
export const pointed = signal<readonly [number, number] | null>(null);

interface CellsProps {
  map: SweepMap;
  values: (number | null)[][];
  low: number;
  high: number;
}

/** Largest number of ticks of an axis. */
const TICKS = 6;

/** Cells whose values are printed at an axis: at equal distances, the first and, if it fits, the last among them. */
function ticks({ values }: Axis): number[] {
  const step = Math.max(1, Math.ceil((values.length - 1) / (TICKS - 1)));
  return values.map((_, k) => k).filter((k) => k % step === 0);
}

function Ticks({ axis, up }: { axis: Axis; up: boolean }) {
  const { per } = wordsOf(axis);
  return (
    <span class={`ticks ${up ? "up-ticks" : ""}`} aria-hidden="true">
      {ticks(axis).map((k) => {
        const share = `${(100 * (k + 0.5)) / axis.values.length}%`;
        return <span key={k} style={up ? { bottom: share } : { left: share }}>{printed((axis.values[k] ?? 0) * per, 3)}</span>;
      })}
      {/* Takes the space of the widest tick. */}
      {up && <span class="widest">{ticks(axis).map((k) => printed((axis.values[k] ?? 0) * per, 3)).sort((a, b) => b.length - a.length)[0]}</span>}
    </span>
  );
}

export function Cells({ map, values, low, high }: CellsProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [across, up] = map.axes;
  const [columns, rows] = [across.values.length, up.values.length];
  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (!context) return;
    context.canvas.width = columns;
    context.canvas.height = rows;
    context.clearRect(0, 0, columns, rows);
    values.forEach((row, j) =>
      row.forEach((value, i) => {
        if (value === null) return;
        context.globalAlpha = map.status[j]?.[i] === "optimal" ? 1 : 0.45;
        context.fillStyle = rampColour((value - low) / (high - low || 1));
        context.fillRect(i, rows - 1 - j, 1, 1);
      }),
    );
  }, [values, low, high, dark.value]);
  const point = (event: PointerEvent) => {
    const box = (event.currentTarget as Element).getBoundingClientRect();
    const within = (share: number, count: number) => Math.max(0, Math.min(count - 1, Math.floor(share * count)));
    pointed.value = [within((event.clientX - box.left) / box.width, columns), within((box.bottom - event.clientY) / box.height, rows)];
  };
  const step = (event: KeyboardEvent) => {
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!arrow) return;
    event.preventDefault();
    const [i, j] = pointed.value ?? [0, 0];
    const within = (at: number, count: number) => Math.max(0, Math.min(count - 1, at));
    pointed.value = [within(i + (arrow[0] ?? 0), columns), within(j + (arrow[1] ?? 0), rows)];
  };
  return (
    <div class="sweep-map">
      <span class="up">{labelOf(up)}</span>
      <Ticks axis={up} up />
      <div class="cells" tabIndex={0} role="application" aria-label="Designs; arrow keys go from one to the next" onPointerMove={point} onPointerDown={point} onKeyDown={step}>
        <canvas ref={canvas} id="cells" aria-hidden="true" />
        <svg viewBox={`0 0 ${columns} ${rows}`} preserveAspectRatio="none" aria-hidden="true">
          {map.folds.map((fold, k) => (
            <polyline key={k} class="fold" points={fold.map(([x, y]) => `${place(across.values, x)},${rows - place(up.values, y)}`).join(" ")} />
          ))}
          {pointed.value && <rect class="pointed" x={pointed.value[0]} y={rows - 1 - pointed.value[1]} width={1} height={1} />}
        </svg>
      </div>
      <Ticks axis={across} up={false} />
      <span class="across">{labelOf(across)}</span>
    </div>
  );
}

/** Position of a value in units of cells; the value of a cell is at its centre. */
export function place(values: readonly number[], value: number): number {
  const rising = (values.at(-1) ?? 0) >= (values[0] ?? 0);
  const after = values.findIndex((each) => (rising ? each >= value : each <= value));
  if (after < 0) return values.length - 0.5;
  if (after === 0) return 0.5;
  const [a, b] = [values[after - 1] ?? 0, values[after] ?? 1];
  return after - 0.5 + (value - a) / (b - a || 1);
}
