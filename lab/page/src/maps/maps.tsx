// Maps tab: interactive map of an export of `swimmer sweep map --export`.

import "./maps.css";
import { signal } from "@preact/signals";
import { useDrop } from "../files/drop.ts";
import { DropZone } from "../files/drop-zone.tsx";
import { OpenButton } from "../files/open-button.tsx";
import { Cells, pointed } from "./cells.tsx";
import { readMap, type SweepMap } from "./export.ts";
import { Front } from "./front.tsx";
import { rampColour, range } from "./ramp.ts";
import sample from "./sample.json";
import { labelOf, printed, valueOf, wordsOf } from "./words.ts";

const opened = signal<{ name: string; map: SweepMap } | null>(null);
const problem = signal("");
const chosen = signal(0);

function show(name: string, map: SweepMap): void {
  opened.value = { name, map };
  [chosen.value, pointed.value, problem.value] = [0, null, ""];
}

function clear(): void {
  opened.value = null;
  problem.value = "";
}

async function open(files: readonly File[]): Promise<void> {
  const file = files[0];
  if (!file) return;
  try {
    show(file.name, readMap(await file.text()));
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
        <button onClick={clear} disabled={!opened.value && problem.value === ""}>Clear</button>
        {opened.value && <span class="soft">{opened.value.name}</span>}
        {problem.value && <span class="error" role="alert">{problem}</span>}
      </div>
      {opened.value ? <Opened map={opened.value.map} /> : <Invitation />}
    </div>
  );
}

function Invitation() {
  return (
    <DropZone name="Map to open" sample={() => show("sample: fastest gaits of the robot", readMap(JSON.stringify(sample)))}>
      <p>The JSON that <code>swimmer sweep map FOLDER --export map.json</code> writes: each quantity of a sweep over two of its axes, and the designs that no other one beats.</p>
      <p class="soft">The sample is a sweep over the links’ ratio and the largest joint angle of the robot, for its fastest gait.</p>
    </DropZone>
  );
}

function Opened({ map }: { map: SweepMap }) {
  const quantity = map.quantities[chosen.value] ?? map.quantities[0];
  if (!quantity) return null;
  const [low, high] = range(quantity.values);
  const { per } = wordsOf(quantity);
  const stops = Array.from({ length: 11 }, (_, k) => rampColour(k / 10));
  return (
    <div class="maps">
      <section class="card" aria-label="Map">
        <div class="bar-of-buttons">
          <label>
            quantity{" "}
            <select id="quantity" value={chosen.value} onChange={(event) => (chosen.value = Number(event.currentTarget.value))}>
              {map.quantities.map((each, k) => <option key={each.name} value={k}>{labelOf(each)}</option>)}
            </select>
          </label>
          <span class="soft">gaits best for {map.objective}</span>
        </div>
        <Cells map={map} values={quantity.values} low={low} high={high} />
        <div class="legend">
          <span>{printed(low * per, 3)}</span>
          <span class="bar" style={{ background: `linear-gradient(90deg, ${stops.join()})` }} />
          <span>{valueOf(quantity, high, 3)}</span>
          {map.folds.length > 0 && <span>— arcs change</span>}
        </div>
        <Pointed map={map} />
      </section>
      {map.pareto.length > 0 && <Front map={map} />}
    </div>
  );
}

function Pointed({ map }: { map: SweepMap }) {
  if (!pointed.value) return <p class="soft">Point at a design to read it.</p>;
  const [i, j] = pointed.value;
  const lines: [string, string][] = [
    ...map.axes.map((axis, k): [string, string] => [wordsOf(axis).words, valueOf(axis, axis.values[k === 0 ? i : j] ?? 0)]),
    ...map.quantities.map((quantity): [string, string] => {
      const value = quantity.values[j]?.[i];
      return [wordsOf(quantity).words, value === null || value === undefined ? "–" : valueOf(quantity, value, 6)];
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
