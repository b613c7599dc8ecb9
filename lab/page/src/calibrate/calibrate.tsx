// Calibrate tab: takes dropped tracking files and their campaign; shows tracks, cycles, X(ε), fit, evidence and verdict.

import "./calibrate.css";
import { download } from "../files/download.ts";
import { useDrop } from "../files/drop.ts";
import { DropZone } from "../files/drop-zone.tsx";
import { OpenButton } from "../files/open-button.tsx";
import type { FitOutput } from "./outputs.ts";
import { OverAmplitude, Paths, Profiles, Residuals, Ridge, WithoutRun } from "./figures.tsx";
import { Advice, Further } from "./nuisance.tsx";
import { advice, assessment, clear, doing, evidence, fit, further, open, problem, received, stop, tracks, trySample } from "./model.ts";
import { Budget, Cycles, Goodness, Known, Parameters, Runs, Servos, Table } from "./tables.tsx";

const openAll = (files: File[]) => void open(files);

export function Calibrate() {
  useDrop("calibrate", openAll);
  const busy = doing.value;
  return (
    <div id="calibrate" aria-busy={busy !== null}>
      <div class="toolbar">
        <OpenButton id="open-campaign" name="Open…" accept=".toml,.csv,.txt,.tsv,.json,.trc,.gait,.mcap" open={openAll} />
        <button onClick={clear} disabled={received.value.length === 0 && problem.value === ""}>Clear</button>
        <button disabled={!fit.value} onClick={() => fit.value && download("fitted-swimmer.toml", fit.value.swimmer, "application/toml")}>Save fitted swimmer</button>
        {busy && <button onClick={stop}>Stop</button>}
        <span class="soft" role="status">{busy ? `${busy.what} …${busy.seconds ? ` ${busy.seconds} s` : ""}` : ""}</span>
        {problem.value && <span class="error" role="alert">{problem}</span>}
      </div>
      {!busy && tracks.value.length === 0 && !fit.value && <Invitation />}
      {fit.value && <Fitted fit={fit.value} />}
      {tracks.value.length > 0 && <Tracks />}
    </div>
  );
}

/** Invitation while no tracking file is open. */
function Invitation() {
  return (
    <DropZone name="Files to calibrate with" sample={() => void trySample()}>
      <p>A campaign file (campaign.toml) with all files that it names: r<sub>s</sub> and χ are fitted. Tracking files alone: their points, rates and gaps are listed.</p>
      <p class="soft">The sample is a campaign of five circles by a simulated robot; its fit should find r<sub>s</sub> = 51.5 mm and χ = 2.72. The folder of <code>swimmer demo -o demo-out</code> is another.</p>
      {received.value.length > 0 && <p role="status">Here so far: {received.value.join(", ")}.</p>}
    </DropZone>
  );
}

function Fitted({ fit }: { fit: FitOutput }) {
  const [known, assessed] = [evidence.value, assessment.value];
  return (
    <div class="calibrate">
      <div class="column">
        <Parameters fit={fit} evidence={known} assessment={assessed} />
        <output hidden id="fit-exact">{JSON.stringify({ ...fit, runs: fit.runs.map((run) => ({ ...run, path: [] })), evidence: known, assessment: assessed, further: further.value, advice: advice.value })}</output>
        <Verdict />
      </div>
      <OverAmplitude runs={fit.runs} evidence={known} />
      {known && <Ridge evidence={known} paper={fit} />}
      {known && <Profiles evidence={known} />}
      {known && <WithoutRun evidence={known} paper={fit} />}
      {known && <Residuals evidence={known} />}
      {assessed && <Budget assessed={assessed} />}
      {assessed && <Known assessed={assessed} />}
      <Further />
      {advice.value && <Advice of={advice.value} />}
      {assessed && <Goodness assessed={assessed} />}
      <Servos fit={fit} />
      <Runs fit={fit} />
      <Cycles runs={fit.runs} />
      <Paths runs={fit.runs} />
    </div>
  );
}

function Verdict() {
  const assessed = assessment.value;
  if (!assessed) return null;
  return (
    <section class={`card verdict ${assessed.verdict.replaceAll(" ", "-")}`} aria-label="Verdict">
      <h2>Verdict: {assessed.verdict}</h2>
      {assessed.reduced_chi2 !== null && <p class="soft">reduced χ² {assessed.reduced_chi2.toPrecision(3)}</p>}
      {assessed.headline.by === "systematics" && <p>Recommended: the estimate with systematics.</p>}
      {assessed.reasons.length > 0 ? <ul>{assessed.reasons.map((reason) => <li key={reason}>{reason}</li>)}</ul> : <p class="soft">Nothing speaks against it.</p>}
    </section>
  );
}

function Tracks() {
  return (
    <Table title="Tracking files" id="tracks" head={["file", "format", "rate [Hz]", "unit", "frames", "points (gaps)"]}>
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
    </Table>
  );
}
