// Maps tab: interactive map of an export of `swimmer sweep map --export`.

import "./maps.css";
import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { useDrop } from "../files/drop.ts";
import { OpenButton } from "../files/open-button.tsx";
import { dark } from "../shell/theme.tsx";
import { readMap, type SweepMap } from "./export.ts";
import { Front } from "./front.tsx";
import { rampColour, range } from "./ramp.ts";

const opened = signal<{ name: string; map: SweepMap } | null>(null);
const problem = signal("");
const chosen = signal(0);
const pointed = signal<readonly [number, number] | null>(null);

async function open(files: readonly File[]): Promise<void> {
  const file = files[0];
  if (!file) return;
  try {
    opened.value = { name: file.name, map: readMap(await file.text()) };
    [chosen.value, pointed.value, problem.value] = [0, null, ""];
  } catch (error) {
    problem.value = `${file.name}: ${error instanceof Error ? error.message : String(error)}`;
  }
}

const openAll = (files: File[]) => void open(files);

export function Maps() {
  useDrop("maps", openAll);
  return (
    <div id="maps">
      <div class="toolbar">
        <OpenButton id="open-map" name="Open a map…" accept=".json" open={openAll} />
        <span class="soft">{opened.value ? opened.value.name : "Drop the JSON of `swimmer sweep map --export` here."}</span>
        {problem.value && <span class="error" role="alert">{problem}</span>}
      </div>
      {opened.value && <Opened map={opened.value.map} />}
    </div>
  );
}

function Opened({ map }: { map: SweepMap }) {
  const quantity = map.quantities[chosen.value] ?? map.quantities[0];
  if (!quantity) return null;
  const [low, high] = range(quantity.values);
  const stops = Array.from({ length: 11 }, (_, k) => rampColour(k / 10));
  return (
    <div class="maps">
      <section class="card" aria-label="Map">
        <div class="bar-of-buttons">
          <label>
            quantity{" "}
            <select id="quantity" value={chosen.value} onChange={(event) => (chosen.value = Number(event.currentTarget.value))}>
              {map.quantities.map(({ name, unit }, k) => <option key={name} value={k}>{spoken(name)}{unit && ` [${unit}]`}</option>)}
            </select>
          </label>
          <span class="soft">most {map.objective}</span>
        </div>
        <Cells map={map} values={quantity.values} low={low} high={high} />
        <div class="legend">
          <span>{low.toPrecision(3)}</span>
          <span class="bar" style={{ background: `linear-gradient(90deg, ${stops.join()})` }} />
          <span>{high.toPrecision(3)} {quantity.unit}</span>
          <span>— arcs change</span>
        </div>
        <Pointed map={map} />
      </section>
      {map.pareto.length > 0 && <Front points={map.pareto} />}
    </div>
  );
}

/** Display name of a quantity, without its unit. */
const spoken = (name: string) => name.replace(/(_per_s|_rad|_s|_m)$/, "").replaceAll("_", " ");

interface CellsProps {
  map: SweepMap;
  values: (number | null)[][];
  low: number;
  high: number;
}

function Cells({ map, values, low, high }: CellsProps) {
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
      <span class="up">{spoken(up.name)}{up.unit && ` [${up.unit}]`}</span>
      <span class="ends up-ends"><span>{rounded(up.values.at(-1))}</span><span>{rounded(up.values[0])}</span></span>
      <div class="cells" tabIndex={0} role="application" aria-label="Designs; arrow keys go from one to the next" onPointerMove={point} onPointerDown={point} onKeyDown={step}>
        <canvas ref={canvas} id="cells" aria-hidden="true" />
        <svg viewBox={`0 0 ${columns} ${rows}`} preserveAspectRatio="none" aria-hidden="true">
          {map.folds.map((fold, k) => (
            <polyline key={k} class="fold" points={fold.map(([x, y]) => `${place(across.values, x)},${rows - place(up.values, y)}`).join(" ")} />
          ))}
          {pointed.value && <rect class="pointed" x={pointed.value[0]} y={rows - 1 - pointed.value[1]} width={1} height={1} />}
        </svg>
      </div>
      <span class="ends across-ends"><span>{rounded(across.values[0])}</span><span>{rounded(across.values.at(-1))}</span></span>
      <span class="across">{spoken(across.name)}{across.unit && ` [${across.unit}]`}</span>
    </div>
  );
}

const rounded = (value: number | undefined) => (value === undefined ? "" : `${Number(value.toPrecision(4))}`);

/** Position of a value in units of cells; the value of a cell is at its centre. */
export function place(values: readonly number[], value: number): number {
  const rising = (values.at(-1) ?? 0) >= (values[0] ?? 0);
  const after = values.findIndex((each) => (rising ? each >= value : each <= value));
  if (after < 0) return values.length - 0.5;
  if (after === 0) return 0.5;
  const [a, b] = [values[after - 1] ?? 0, values[after] ?? 1];
  return after - 0.5 + (value - a) / (b - a || 1);
}

function Pointed({ map }: { map: SweepMap }) {
  if (!pointed.value) return <p class="soft">Point at a design to read it.</p>;
  const [i, j] = pointed.value;
  const lines: [string, string][] = [
    ...map.axes.map((axis, k): [string, string] => [spoken(axis.name), `${rounded(axis.values[k === 0 ? i : j])} ${axis.unit}`]),
    ...map.quantities.map(({ name, unit, values }): [string, string] => {
      const value = values[j]?.[i];
      return [spoken(name), value === null || value === undefined ? "–" : `${Number(value.toPrecision(6))} ${unit}`];
    }),
    ["arcs", map.structure[j]?.[i] ?? "–"],
    ["status", map.status[j]?.[i] ?? "–"],
  ];
  return (
    <table class="readout" id="pointed" aria-live="polite">
      <tbody>{lines.map(([name, value]) => <tr key={name}><th scope="row">{name}</th><td>{value}</td></tr>)}</tbody>
    </table>
  );
}
