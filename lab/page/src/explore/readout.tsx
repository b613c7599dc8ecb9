// Results of one gait, or of two side by side, with units, and the certificate.

import type { ComponentChildren } from "preact";
import type { SimulateOutput, TankOutput } from "./outputs.ts";
import { edit, shown } from "./document.ts";
import { evidence, evidenceIsStale, swum, tank, trouble } from "./model.ts";
import { angle, condition, figure, length, rate } from "./names.ts";

type GaitResults = { swum: SimulateOutput; tank: TankOutput | null };
interface Row {
  name: string;
  /** The quantity in words, before its symbol. */
  words: string;
  about: string;
  value(results: GaitResults): ComponentChildren;
}

const ROWS: readonly Row[] = [
  { name: "X/L", words: "displacement", about: "Displacement of a cycle along the first heading, over the length", value: ({ swum }) => figure(swum.displacement_over_length, 6) },
  { name: "X", words: "displacement", about: "Displacement of a cycle", value: ({ swum }) => length(swum.displacement_m) },
  { name: "Y/L", words: "sideways", about: "Displacement across the first heading, over the length", value: ({ swum }) => figure(swum.lateral_over_length, 6) },
  { name: "θ", words: "rotation", about: "Rotation of a cycle", value: ({ swum }) => angle(swum.rotation_rad) },
  { name: "ξ", words: "efficiency", about: "Lighthill efficiency as parametrised", value: ({ swum }) => figure(swum.efficiency, 6) },
  { name: "ξ, constant power", words: "efficiency at constant power", about: "Lighthill efficiency of the same curve at constant power", value: ({ swum }) => figure(swum.efficiency_constant_power, 6) },
  { name: "speed", words: "", about: "Net displacement over the period", value: ({ swum }) => `${figure(swum.speed_m_per_s * 1000, 3)} mm/s` },
  { name: "peak rates", words: "", about: "Largest joint rates in the period", value: ({ swum }) => `${swum.peak_rates_rad_s.map(rate).join(", ")}` },
  { name: "reach", words: "", about: "Largest joint angle", value: ({ swum }) => angle(swum.reach_rad) },
  { name: "shortest period", words: "", about: "What the servos' rate allows as parametrised", value: ({ swum }) => (swum.shortest_period_s === null ? "–" : `${figure(swum.shortest_period_s, 2)} s`) },
  { name: "tank", words: "", about: "Cycles from the middle of the tank to a wall", value: ({ tank }) => (tank ? (tank.cycles === null ? "no wall met" : `${figure(tank.cycles, 1)} cycles`) : "–") },
  { name: "links cross", words: "", about: "Share of the cycle in which links cross", value: ({ swum }) => (swum.links_cross > 0 ? `${figure(swum.links_cross * 100, 1)} %` : "never") },
];

export function Readout() {
  const both = swum.value.map((results, slot) => (results ? { swum: results, tank: tank.value[slot as 0 | 1] } : null));
  const compared = shown.value.gaits[1] !== null;
  return (
    <section class="card" aria-label="What a cycle brings">
      <table class="readout">
        {compared && (
          <thead>
            <tr>
              <th scope="col">of a cycle</th>
              {["A", "B"].map((name, slot) => (
                <th key={name} scope="col">
                  <button class={`small slot-${slot}`} aria-pressed={shown.value.active === slot} onClick={() => edit({ active: slot as 0 | 1 })}>{name}</button>
                </th>
              ))}
            </tr>
          </thead>
        )}
        <tbody>
          {ROWS.map(({ name, words, about, value }) => (
            <tr key={name} title={about}>
              <th scope="row">{words && `${words} `}{words ? <i>{name.split(",")[0]}</i> : name}</th>
              {both.slice(0, compared ? 2 : 1).map((results, slot) => (
                <td key={slot} data-name={name} data-slot={slot}>{results ? value(results) : "…"}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
      <output hidden id="exact">{JSON.stringify(swum.value)}</output>
      <Certificate />
      {trouble.value && <p class="error" role="status">{trouble.value}</p>}
    </section>
  );
}

const VERDICTS = { pass: "holds every condition", fail: "no optimum", undecided: "undecided from these samples" };

function Certificate() {
  const output = evidence.value?.output;
  if (!output) return <p class="certificate stale">Certificate: …</p>;
  const failed = output.checks.filter((check) => !check.pass).length;
  return (
    <details class={`certificate ${output.verdict} ${evidenceIsStale.value ? "stale" : ""}`}>
      <summary>
        Certificate: {VERDICTS[output.verdict]}
        {failed > 0 && ` (${failed} of ${output.checks.length} fail)`}
      </summary>
      <table>
        <thead>
          <tr><th scope="col">condition</th><th scope="col">number</th><th scope="col">tolerance</th></tr>
        </thead>
        <tbody>
          {output.checks.map(({ name, value, tolerance, pass }) => (
            <tr key={name} title={name} class={pass ? "" : "failed"}>
              <th scope="row">{pass ? "✓" : "✗"} {condition(name)}</th>
              <td>{value?.toExponential(1) ?? "–"}</td>
              <td>{name.endsWith("_least") ? "≥" : "≤"} {tolerance.toExponential(0)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </details>
  );
}
