// Calibrate: tracking files and their campaign, dropped; tracks, cycles, X(ε), fit and ridge.

import "./calibrate.css";
import { figure } from "../explore/names.ts";
import { download } from "../files/download.ts";
import { useDrop } from "../files/drop.ts";
import { OpenButton } from "../files/open-button.tsx";
import type { FitAnswer } from "./answers.ts";
import { Cycles, named, OverAmplitude, Paths, Profiles, Ridge } from "./figures.tsx";
import { assessment, clear, doing, evidence, fit, open, problem, tracks } from "./model.ts";

const openAll = (files: File[]) => void open(files);

export function Calibrate() {
  useDrop("calibrate", openAll);
  return (
    <div id="calibrate" aria-busy={doing.value !== ""}>
      <div class="toolbar">
        <OpenButton id="open-campaign" name="Open…" accept=".toml,.csv,.txt,.tsv,.json,.trc,.gait" open={openAll} />
        <button onClick={clear} disabled={tracks.value.length === 0 && !fit.value}>Clear</button>
        <button disabled={!fit.value} onClick={() => fit.value && download("fitted-swimmer.toml", fit.value.swimmer, "application/toml")}>Save fitted swimmer</button>
        <span class="soft" role="status">{doing.value ? `${doing.value} …` : tracks.value.length === 0 ? "Drop a campaign file with its tracking files, or tracking files alone." : ""}</span>
        {problem.value && <span class="error" role="alert">{problem}</span>}
      </div>
      {fit.value && <Fitted fit={fit.value} />}
      {tracks.value.length > 0 && <Tracks />}
    </div>
  );
}

function Fitted({ fit }: { fit: FitAnswer }) {
  return (
    <div class="calibrate">
      <div class="column">
        <Parameters fit={fit} />
        <Verdict />
      </div>
      <OverAmplitude runs={fit.runs} evidence={evidence.value} />
      {evidence.value && <Ridge evidence={evidence.value} />}
      {evidence.value && <Profiles evidence={evidence.value} />}
      <Budget />
      <Runs fit={fit} />
      <Cycles runs={fit.runs} />
      <Paths runs={fit.runs} />
    </div>
  );
}

const millimetres = (metres: number) => figure(metres * 1000, 2);

function Parameters({ fit }: { fit: FitAnswer }) {
  const { intervals } = fit;
  const likely = evidence.value;
  const told = assessment.value;
  const wider = told?.systematics;
  const none = told || likely ? "–" : "…";
  const range = ([low, high]: [number, number], tell: (value: number) => string) => `${tell(low)} … ${tell(high)}`;
  const chi = (value: number) => figure(value, 3);
  return (
    <section class="card" aria-label="Fit">
      <h2>Fit</h2>
      <table class="readout" id="fit">
        <thead><tr><th scope="col">{Math.round(intervals.level * 100)} % intervals</th><th scope="col">least squares</th><th scope="col">likelihood</th><th scope="col">with systematics</th></tr></thead>
        <tbody>
          <tr><th scope="row">rₛ [mm]</th><td>{millimetres(fit.sphere_radius_m)}<br />{range(intervals.sphere_radius_m, millimetres)}</td>
            <td>{likely ? <>{millimetres(likely.sphere_radius_m)}<br />{range(likely.intervals.sphere_radius_m, millimetres)}</> : "…"}</td>
            <td>{wider ? <>{millimetres(wider.sphere_radius_m)}<br />{range(wider.intervals.sphere_radius_m, millimetres)}</> : none}</td></tr>
          <tr><th scope="row">χ</th><td>{chi(fit.chi)}<br />{range(intervals.chi, chi)}</td>
            <td>{likely ? <>{chi(likely.chi)}<br />{range(likely.intervals.chi, chi)}</> : "…"}</td>
            <td>{wider ? <>{chi(wider.chi)}<br />{range(wider.intervals.chi, chi)}</> : none}</td></tr>
          <tr><th scope="row">RMSE</th><td>{fit.rmse.toPrecision(3)}</td><td /><td /></tr>
          <tr><th scope="row">correlation</th><td>{figure(fit.correlation, 3)}</td><td>{likely && figure(likely.correlation, 3)}</td><td /></tr>
          <tr><th scope="row">c_t</th><td colSpan={3}>{fit.c_t_form}</td></tr>
        </tbody>
      </table>
      <output hidden id="fit-exact">{JSON.stringify({ ...fit, runs: fit.runs.map((run) => ({ ...run, path: [] })), evidence: likely, assessment: told })}</output>
      {[...fit.excluded.map(({ what, reason }) => `${what} is left out: ${reason}`), ...fit.warnings].map((line) => <p key={line} class="soft">{line}</p>)}
    </section>
  );
}

function Verdict() {
  const told = assessment.value;
  if (!told) return null;
  return (
    <section class={`card verdict ${told.verdict.replaceAll(" ", "-")}`} aria-label="Verdict">
      <h2>Verdict: {told.verdict}</h2>
      {told.reduced_chi2 !== null && <p class="soft">reduced χ² {told.reduced_chi2.toPrecision(3)}</p>}
      {told.reasons.length > 0 ? <ul>{told.reasons.map((reason) => <li key={reason}>{reason}</li>)}</ul> : <p class="soft">Nothing speaks against it.</p>}
    </section>
  );
}

/** How far both would move with what is taken for granted, and what would explain the runs better. */
function Budget() {
  const told = assessment.value;
  if (!told || told.budget.length === 0) return null;
  const amount = (by: number, unit: string) => `${Number(by.toPrecision(2))}${unit ? ` ${unit}` : ""}`;
  return (
    <section class="card scroll" aria-label="Budget">
      <h2>Budget</h2>
      <table class="readout" id="budget">
        <thead><tr>{["if off", "by", "rₛ [mm]", "χ", "known to"].map((name) => <th key={name} scope="col">{name}</th>)}</tr></thead>
        <tbody>
          {told.budget.map(({ name, by, unit, sphere_radius_m, chi, width, stated }) => (
            <tr key={name}>
              <th scope="row">{name}</th>
              <td>{amount(by, unit)}</td>
              <td>{figure(sphere_radius_m * 1000, 3)}</td>
              <td>{figure(chi, 4)}</td>
              <td>{width === null ? "exact" : `${amount(width, unit)}${stated ? ", stated" : ""}`}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {told.explanations.length > 0 && (
        <table class="readout">
          <thead><tr>{["would explain the runs", "gain of ln likelihood", "rₛ [mm]", "χ"].map((name) => <th key={name} scope="col">{name}</th>)}</tr></thead>
          <tbody>
            {told.explanations.map(({ name, gain, estimate }) => (
              <tr key={name}>
                <th scope="row">{name}</th><td>{figure(gain, 1)}</td><td>{millimetres(estimate.sphere_radius_m)}</td><td>{figure(estimate.chi, 3)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
    </section>
  );
}

function Runs({ fit }: { fit: FitAnswer }) {
  return (
    <section class="card scroll" aria-label="Runs">
      <h2>Runs</h2>
      <table class="readout" id="runs">
        <thead>
          <tr>{["run", "gait", "cycles", "X [mm]", "sd [mm]", "ΔY [mm]", "Δθ [°]", "left out"].map((name) => <th key={name} scope="col">{name}</th>)}</tr>
        </thead>
        <tbody>
          {fit.runs.map((run) => (
            <tr key={run.file} title={run.warnings.join("\n")}>
              <th scope="row">{run.file.split("/").pop()}</th>
              <td>{named(run)}</td>
              <td>{run.cycles ?? "–"}</td>
              <td>{millimetres(run.x_m)}</td>
              <td>{run.x_sd_m === null ? "–" : millimetres(run.x_sd_m)}</td>
              <td>{millimetres(run.delta_y_m)}</td>
              <td>{figure((run.delta_theta_rad * 180) / Math.PI, 2)}</td>
              <td title={run.left_out.map(({ what, reason }) => `${what}: ${reason}`).join("\n")}>{run.left_out.length}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

function Tracks() {
  return (
    <section class="card scroll" aria-label="Tracking files">
      <h2>Tracking files</h2>
      <table class="readout" id="tracks">
        <thead>
          <tr>{["file", "format", "rate [Hz]", "unit", "frames", "points (gaps)"].map((name) => <th key={name} scope="col">{name}</th>)}</tr>
        </thead>
        <tbody>
          {tracks.value.map(({ name, holds }) => (
            <tr key={name} title={holds.warnings.join("\n")}>
              <th scope="row">{name}</th>
              <td>{holds.format}</td>
              <td>{holds.rate_hz === null ? "–" : Number(holds.rate_hz.toPrecision(5))}</td>
              <td>{holds.unit}</td>
              <td>{holds.frames}</td>
              <td>{holds.points.map((point) => `${point.name} (${point.gaps})`).join(", ")}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}
