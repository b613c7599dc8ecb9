// Additional parameters, fitted on request, and advice on the next measurement.

import { figure } from "../explore/names.ts";
import { download } from "../files/download.ts";
import type { Advice as AdviceOutput } from "../contracts.ts";
import { degrees } from "./chart.tsx";
import { also, choose, further, noFurther } from "./model.ts";
import { Head, Table } from "./tables.tsx";

/** Words of `swimmer calibrate --fit-also`, with descriptions. */
const CHOICES: readonly (readonly [word: string, what: string])[] = [
  ["gain", "actual over commanded angle of the servos"],
  ["gains", "the same for each servo"],
  ["offsets", "of both joints"],
  ["deadband", "of the servos"],
  ["ct", "c_t/μ"],
  ["marker", "position of the reflectors’ middle on the link"],
  ["scale", "of the cameras"],
  ["lengths", "of the links"],
  ["float", "rotational drag of the float over a sphere’s"],
  ["tilt", "of the cameras"],
  ["walls", "of the tank, if the campaign states it"],
  ["distortion", "of the lens"],
];

/** Displayed value: in mm, in degrees, or as a number. */
function readable(value: number, unit: string): string {
  if (unit === "m") return Math.abs(value) < 1 ? `${figure(value * 1000, 3)} mm` : `${figure(value, 6)} m`;
  if (unit === "rad") return `${figure(degrees(value), 3)}°`;
  return unit === "s" ? `${figure(value * 1000, 0)} ms` : figure(value, 4);
}

const signed = (value: number) => `${value < 0 ? "" : "+"}${figure(value, 1)}`;

export function Further() {
  const fit = further.value;
  return (
    <section class="card scroll" aria-label="What else may be off" tabIndex={0}>
      <h2>What else may be off</h2>
      <fieldset class="choices">
        <legend class="soft">Fit more than rₛ and χ:</legend>
        {CHOICES.map(([word, what]) => (
          <label key={word} class="check"><input type="checkbox" value={word} checked={also.value.includes(word)} onChange={() => choose(word)} /> {word} <small class="soft">{what}</small></label>
        ))}
      </fieldset>
      {noFurther.value && <p class="error" role="alert">{noFurther}</p>}
      {fit && (
        <>
          <table class="readout" id="further">
            <Head of={["by likelihood", "before", "fitted", "from", "to"]} />
            <tbody>
              {fit.parameters.map(({ name, unit, before, value, interval }) => (
                <tr key={name}><th scope="row">{name}</th>{[before, value, ...interval].map((each, k) => <td key={k}>{readable(each, unit)}</td>)}</tr>
              ))}
            </tbody>
          </table>
          <p class="soft">{`intervals of ${Math.round(fit.level * 100)} %; log-likelihood ${signed(fit.log_likelihood_gain)} over r_s and chi alone`}</p>
          {fit.warnings.map((warning) => <p key={warning} class="soft">{`note: ${warning}`}</p>)}
          <button onClick={() => download("fitted-further.toml", fit.swimmer, "application/toml")}>Save swimmer with these</button>
        </>
      )}
    </section>
  );
}

/** Number of displayed lines of advice. */
const SHOWN = 8;

/** Gaits, ordered by the narrowing of the intervals by one run of each. */
export function Advice({ of: { period_s, candidates } }: { of: AdviceOutput }) {
  const change = (width: number) => `${signed(100 * (width - 1))} %`;
  return (
    <Table
      title="What to measure next" id="advice" head={["measure next", "interval of rₛ", "of χ", "both"]}
      notes={[`one run more with a cycle of ${period_s} s, and as many cycles and errors as the others`]}
    >
      {candidates.slice(0, SHOWN).map(({ gait, sphere_radius_width, chi_width, both }) => (
        <tr key={gait}><th scope="row">{gait}</th><td>{change(sphere_radius_width)}</td><td>{change(chi_width)}</td><td>{change(both)}</td></tr>
      ))}
    </Table>
  );
}
