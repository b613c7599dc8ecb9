// Tables of a calibration: fits with their intervals, runs and their cycles, servos, error budget of both parameters.

import type { ComponentChildren } from "preact";
import { figure } from "../explore/names.ts";
import type { AssessmentDocument, Intervals, Measured, Pair } from "../contracts.ts";
import type { EvidenceOutput, FitOutput, Run } from "./outputs.ts";
import { degrees } from "./chart.tsx";
import { named, short } from "./figures.tsx";

const millimetres = (metres: number) => figure(metres * 1000, 2);
const chiOf = (value: number) => figure(value, 3);

export function Head({ of }: { of: readonly string[] }) {
  return <thead><tr>{of.map((name) => <th key={name} scope="col">{name}</th>)}</tr></thead>;
}

/** A table in a card of its own. */
export function Table({ title, id, head, notes = [], children }: { title: string; id: string; head: readonly string[]; notes?: readonly string[]; children: ComponentChildren }) {
  return (
    <section class="card scroll" aria-label={title} tabIndex={0}>
      <h2>{title}</h2>
      <table class="readout" id={id}><Head of={head} /><tbody>{children}</tbody></table>
      {notes.map((note) => <p key={note} class="soft">{note}</p>)}
    </section>
  );
}

/** Result of one method of fitting; null if it gives none, undefined while it is computed. */
interface Way {
  name: string;
  estimate: Pair | null | undefined;
  intervals: Intervals | null | undefined;
  correlation?: number | undefined;
}

/** Both parameters, one line per method of fitting. */
export function Parameters({ fit, evidence, assessment }: { fit: FitOutput; evidence: EvidenceOutput | null; assessment: AssessmentDocument | null }) {
  const likelihood = evidence?.likelihood;
  const wider = assessment ? assessment.systematics ?? null : undefined;
  const bootstrap = evidence ? evidence.bootstrap : undefined;
  const ways: Way[] = [
    { name: "least squares", estimate: fit, intervals: fit.intervals, correlation: fit.correlation },
    { name: "bootstrap", estimate: bootstrap && fit, intervals: bootstrap && bootstrap.intervals },
    { name: "likelihood", estimate: likelihood?.estimate, intervals: likelihood?.intervals, correlation: likelihood?.correlation },
    { name: "with systematics", estimate: wider, intervals: wider && assessment?.intervals_with_systematics },
  ];
  const cell = (value: number | undefined, range: [number, number] | undefined, tell: (value: number) => string, none: string) =>
    value === undefined || range === undefined ? none : <>{tell(value)}<br /><small class="soft">{`${tell(range[0])} … ${tell(range[1])}`}</small></>;
  return (
    <section class="card scroll" aria-label="Fit" tabIndex={0}>
      <h2>Fit</h2>
      <table class="readout" id="fit">
        <Head of={[`${Math.round(fit.intervals.level * 100)} % intervals`, "rₛ [mm]", "χ", "correlation"]} />
        <tbody>
          {ways.map(({ name, estimate, intervals, correlation }) => {
            const none = estimate === null || assessment ? "–" : "…";
            return (
              <tr key={name}>
                <th scope="row">{name}</th>
                <td>{cell(estimate?.sphere_radius_m, intervals?.sphere_radius_m, millimetres, none)}</td>
                <td>{cell(estimate?.chi, intervals?.chi, chiOf, none)}</td>
                <td>{correlation === undefined ? "" : figure(correlation, 3)}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
      <p class="soft">RMSE {fit.rmse.toPrecision(3)}; c_t: {fit.c_t_form}</p>
      {evidence?.bootstrap && <p class="soft">{`Bootstrap of ${evidence.bootstrap.draws} draws, ${evidence.bootstrap.at_border} of them at the border.`}</p>}
      {evidence?.outliers.map(({ file, quantity, standard_errors }) => (
        <p key={file + quantity} class="soft">{`${quantity} of ${short(file)} stands out by ${standard_errors.toFixed(1)} standard errors: the likelihood leaves it out`}</p>
      ))}
      {[...fit.excluded.map(({ file, reason }) => `${file} is left out: ${reason}`), ...fit.warnings].map((line) => <p key={line} class="soft">{line}</p>)}
    </section>
  );
}

const chanceOf = (value: number | null) => (value === null ? "–" : value < 1e-3 ? "< 0.001" : value.toFixed(3));

/** Goodness of fit: statistics of each run, and the signs of the residuals. */
export function Goodness({ assessed: { goodness, reduced_chi2 } }: { assessed: AssessmentDocument }) {
  const withError = ([value, error]: [number | null, number | null], unit: number, digits: number) =>
    value === null ? "–" : `${figure(value * unit, digits)}${error === null ? "" : ` ± ${(error * unit).toFixed(digits)}`}`;
  const chi2 = (value: number | null) => (value === null ? "–" : value.toPrecision(3));
  return (
    <Table
      title="How well the model explains the runs" id="goodness" head={["run", "Y/X", "chance", "net turn [°]", "chance", "drift along, across [mm/s]", "lengths"]}
      notes={[
        `reduced χ² by the cycles' own scatter ${chi2(reduced_chi2)} (${goodness.freedom} degrees of freedom), with systematics ${chi2(goodness.reduced_chi2_with_systematics)}`,
        ...goodness.signs.map(({ quantity, signs, stretches, chance }) =>
          `signs of simulated − measured ${quantity} from the smallest gait to the largest: ${signs.map((sign) => (sign > 0 ? "+" : "−")).join("")} (${stretches} stretches, chance ${chance.toFixed(2)})`),
      ]}
    >
      {goodness.runs.map((run) => (
        <tr key={run.file}>
          <th scope="row">{short(run.file)}</th>
          <td>{withError(run.y_over_x, 1, 4)}</td>
          <td>{chanceOf(run.y_chance)}</td>
          <td>{withError(run.turn_rad, degrees(1), 3)}</td>
          <td>{chanceOf(run.turn_chance)}</td>
          <td>{run.drift_m_per_s.map((speed) => (speed === null ? "–" : figure(speed * 1000, 4))).join(", ")}</td>
          <td>{run.scale === null ? "–" : withError(run.scale, 1, 4)}</td>
        </tr>
      ))}
    </Table>
  );
}

/** Error budget of both parameters, and alternative explanations of the runs. */
export function Budget({ assessed }: { assessed: AssessmentDocument }) {
  if (assessed.budget.length === 0) return null;
  const amount = (by: number, unit: string) => `${Number(by.toPrecision(2))}${unit ? ` ${unit}` : ""}`;
  return (
    <>
      <Table title="Budget" id="budget" head={["if off", "by", "rₛ [mm]", "χ", "known to"]}>
        {assessed.budget.map(({ name, by, unit, sphere_radius_m, chi, width, stated }) => (
          <tr key={name}>
            <th scope="row">{name}</th>
            <td>{amount(by, unit)}</td>
            <td>{figure(sphere_radius_m * 1000, 3)}</td>
            <td>{figure(chi, 4)}</td>
            <td>{width === null ? "exact" : `${amount(width, unit)}${stated ? ", stated" : ""}`}</td>
          </tr>
        ))}
      </Table>
      {assessed.explanations.length > 0 && (
        <Table title="What would explain the runs better" id="explanations" head={["if this were so", "gain of ln likelihood", "rₛ [mm]", "χ"]}>
          {assessed.explanations.map(({ name, gain, estimate }) => (
            <tr key={name}><th scope="row">{name}</th><td>{figure(gain, 1)}</td><td>{millimetres(estimate.sphere_radius_m)}</td><td>{chiOf(estimate.chi)}</td></tr>
          ))}
        </Table>
      )}
    </>
  );
}

/** Nuisance parameters: prior and fitted values. */
export function Known({ assessed }: { assessed: AssessmentDocument }) {
  if (!assessed.systematics || assessed.systematics.parameters.length === 0) return null;
  const amount = ([value, deviation]: [number, number], unit: string) => {
    const [per, name, digits] = unit === "m" ? [1000, " mm", 2] : unit === "rad" ? [degrees(1), "°", 2] : unit === "s" ? [1000, " ms", 0] : [1, "", 4];
    return `${figure(value * per, digits)} ± ${(deviation * per).toFixed(digits)}${name}`;
  };
  return (
    <Table title="Nuisance parameters" id="known" head={["parameter", "known", "found", "pull"]} notes={["pull: deviation of the runs alone from the known value, in standard deviations"]}>
      {assessed.systematics.parameters.map(({ name, unit, known, stated, found, pull }) => (
        <tr key={name}>
          <th scope="row">{name}</th>
          <td>{amount(known, unit)}{stated ? "" : " (usual)"}</td>
          <td>{amount(found, unit)}</td>
          <td>{figure(pull, 1)}</td>
        </tr>
      ))}
    </Table>
  );
}

/** Results and notes of each run. */
export function Runs({ fit }: { fit: FitOutput }) {
  return (
    <Table title="Runs" id="runs" head={["run", "gait", "cycles", "X [mm]", "sd [mm]", "ΔY [mm]", "Δθ [°]", "left out"]}>
      {fit.runs.map((run) => (
        <tr key={run.file}>
          <th scope="row">{short(run.file)}{run.diagnoses.map((line) => <small key={line} class="soft note">{line}</small>)}</th>
          <td>{named(run)}</td>
          <td>{run.cycles ?? "–"}</td>
          <td>{millimetres(run.x_m)}</td>
          <td>{run.x_sd_m === null ? "–" : millimetres(run.x_sd_m)}</td>
          <td>{millimetres(run.delta_y_m)}</td>
          <td>{figure(degrees(run.delta_theta_rad), 2)}</td>
          <td title={run.left_out.map(({ start_s, reason }) => `${start_s.toFixed(1)} s: ${reason}`).join("\n")}>{run.left_out.length}</td>
        </tr>
      ))}
    </Table>
  );
}

/** Displacement of every valid cycle, by run. */
export function Cycles({ runs }: { runs: readonly Run[] }) {
  const known = runs.filter((run) => run.each.length > 0);
  if (known.length === 0) return null;
  return (
    <Table title="Cycles" id="cycles" head={["run", "period [s]", "X of each [mm], its start [s] below"]}>
      {known.map((run) => (
        <tr key={run.file}>
          <th scope="row">{short(run.file)}</th>
          <td>{run.period_s.toFixed(2)}</td>
          <td class="each">
            {run.each.map(([start, x]) => <span key={start}>{(x * 1000).toFixed(2)}<small class="soft">{start.toFixed(1)}</small></span>)}
            {run.left_out.map(({ start_s, reason }) => <span key={start_s} class="out" title={reason}>–<small class="soft">{start_s.toFixed(1)} s</small></span>)}
          </td>
        </tr>
      ))}
    </Table>
  );
}

/** Behaviour of the servos, measured by the reflectors on the side links: mean over the runs. */
export function Servos({ fit }: { fit: FitOutput }) {
  if (!fit.joints) return null;
  const { front, back } = fit.joints;
  const tell = (measured: Measured | null, unit: number, digits: number) =>
    measured === null ? "–" : `${(measured.value * unit).toFixed(digits)}${measured.error === null ? "" : ` ± ${(measured.error * unit).toFixed(digits)}`}`;
  return (
    <Table title="Servos" id="servos" head={["measured joint", "gain", "dead band [°]", "offset [°]", "lag [ms]"]}>
      {Object.entries({ front, back }).map(([name, servo]) => (
        <tr key={name}>
          <th scope="row">{name}</th>
          <td>{tell(servo.gain, 1, 4)}</td>
          <td>{tell(servo.dead_band_rad, degrees(1), 2)}</td>
          <td>{tell(servo.offset_rad, degrees(1), 2)}</td>
          <td>{tell(servo.lag_s, 1000, 1)}</td>
        </tr>
      ))}
    </Table>
  );
}
