// Pareto front: designs that no other one beats in both speed and efficiency, by name, before all designs of the map.

import { useMemo } from "preact/hooks";
import { Chart, Dots, line, scale } from "../calibrate/chart.tsx";
import { pointed } from "./cells.tsx";
import type { Axis, FrontPoint, SweepMap } from "./export.ts";
import { type Named, printed, valueOf, wordsOf } from "./words.ts";

/** Largest number of dots of the designs behind the front. */
const MOST_DOTS = 3000;
/** Largest number of rows of the table; the front is thinned evenly. */
const MOST_ROWS = 12;

/** Name of a design: its values on the axes of the plan. */
function named(map: SweepMap, { key, design }: FrontPoint): string {
  if (!design || design.length === 0) return `design ${key}`;
  return map.plan_axes.map((axis, k) => `${short(axis)} ${valueOf(axis, design[k] ?? 0, 3)}`).join(", ");
}

/** Symbol at the end of an axis' words, or the words. */
function short(axis: Named): string {
  const { words } = wordsOf(axis);
  const last = words.split(" ").pop() ?? "";
  return /[^A-Za-z]/.test(last) ? last : words;
}

/** Speed and efficiency [%] of all designs of the map. */
function designs(map: SweepMap): (readonly [number, number])[] {
  const of = (name: string) => map.quantities.find((quantity) => quantity.name === name)?.values.flat() ?? [];
  const [speeds, efficiencies] = [of("speed_over_length_per_s"), of("efficiency")];
  const step = Math.max(1, Math.ceil(speeds.length / MOST_DOTS));
  return speeds.flatMap((speed, k) => {
    const efficiency = efficiencies[k];
    return k % step === 0 && typeof speed === "number" && typeof efficiency === "number" ? [[speed, efficiency * 100] as const] : [];
  });
}

/** Column and row of a design, if it is in the map. */
function cell(map: SweepMap, { design }: FrontPoint): readonly [number, number] | null {
  const at = (axis: Axis) => {
    const value = design?.[map.plan_axes.findIndex(({ name }) => name === axis.name)];
    return axis.values.findIndex((each) => each === value);
  };
  const [i, j] = [at(map.axes[0]), at(map.axes[1])];
  return i < 0 || j < 0 ? null : [i, j];
}

function thinned<T>(all: readonly T[]): readonly T[] {
  if (all.length <= MOST_ROWS) return all;
  return Array.from({ length: MOST_ROWS }, (_, k) => all[Math.round((k * (all.length - 1)) / (MOST_ROWS - 1))] as T);
}

export function Front({ map }: { map: SweepMap }) {
  const { all, front } = useMemo(
    () => ({ all: designs(map), front: [...map.pareto].sort((a, b) => a.speed - b.speed).map((point) => ({ point, at: [point.speed, point.efficiency * 100] as const })) }),
    [map],
  );
  const points = [...all, ...front.map(({ at }) => at)];
  const to = scale(points.map(([x]) => x), points.map(([, y]) => y));
  const [first, last] = [front[0], front.at(-1)];
  return (
    <div class="column">
      <Chart title="Speed against efficiency" names={["speed |d|/(L T) [1/s]", "Lighthill efficiency ξ [%]"]} to={to}>
        <Dots kind="draws" radius={1.6} to={to} of={all.map((at) => [at, "a design of the map"])} />
        <path class="curve" d={line(front.map(({ at }) => at), to)} />
        <Dots kind="others" radius={3.5} to={to} of={front.map(({ point, at }) => [at, named(map, point)])} />
      </Chart>
      <section class="card" aria-label="Pareto front">
        <h2>Pareto front, of the whole sweep</h2>
        <div class="scroll" role="region" aria-label="Designs of the front" tabIndex={0}>
          <table id="pareto">
            <thead><tr><th scope="col">design</th><th scope="col">speed [1/s]</th><th scope="col">ξ [%]</th></tr></thead>
            <tbody>
              {thinned(front).map((one) => {
                const { point, at: [speed, efficiency] } = one;
                const place = cell(map, point);
                const note = one === first && one === last ? "fastest and most efficient" : one === first ? "most efficient" : one === last ? "fastest" : "";
                return (
                  <tr key={point.key}>
                    <th scope="row">
                      {place ? <button class="small" onClick={() => (pointed.value = place)} title="Point at it on the map">{named(map, point)}</button> : named(map, point)}
                      {note && <small class="soft"> {note}</small>}
                    </th>
                    <td>{printed(speed, 4)}</td>
                    <td>{printed(efficiency, 4)}</td>
                  </tr>
                );
              })}
            </tbody>
          </table>
        </div>
        <p class="soft">{front.length} of the designs {front.length > MOST_ROWS ? `(every ${Math.round(front.length / MOST_ROWS)}th is listed) ` : ""}are beaten by no other one in both; the grey dots are the designs of this map.</p>
      </section>
    </div>
  );
}
