// List of recorded plays: replay on the map and in the tank, download, and link logs opened from disk.

import { useEffect } from "preact/hooks";
import { figure, length } from "../explore/names.ts";
import { download } from "../files/download.ts";
import { useDrop } from "../files/drop.ts";
import { OpenButton } from "../files/open-button.tsx";
import { duration, endReplay, type Recording, recordings, replayed, replayRuns, replayTime, startReplay, unreadable } from "./recordings.ts";
import { openRecording } from "./robot.ts";

const open = (files: readonly File[]) => {
  for (const file of files) void file.arrayBuffer().then((bytes) => openRecording(file.name, bytes));
};

export function Recordings() {
  useDrop("panel-drive", open);
  const all = recordings.value;
  return (
    <section class="card recordings" aria-label="Recordings" id="recordings">
      <div class="bar-of-buttons">
        <h2>Recordings</h2>
        <span class="soft">{all.length === 0 ? "Every play of this page is listed here." : ""}</span>
        <OpenButton id="open-recording" name="Open a log…" accept=".mcap" open={open} />
      </div>
      {unreadable.value && <p class="error" role="alert">{unreadable.value}</p>}
      {all.length > 0 && (
        <table>
          <tbody>{all.map((recording) => <Row key={recording.id} recording={recording} />)}</tbody>
        </table>
      )}
      <Player />
    </section>
  );
}

function Row({ recording }: { recording: Recording }) {
  const { name, cycles, end: [x, y], log } = recording;
  const isReplayed = replayed.value?.id === recording.id;
  return (
    <tr>
      <th scope="row">
        {name}
        <small class="soft note">{cycles} {cycles === 1 ? "cycle" : "cycles"}, {figure(duration(recording), 1)} s, {length(Math.hypot(x, y))} by its own model{recording.ended ? "" : "; the log ends before the play"}</small>
      </th>
      <td>
        <button class="small replay" aria-pressed={isReplayed} onClick={() => (isReplayed ? endReplay() : startReplay(recording))} aria-label={`Replay ${name}`}>Replay</button>{" "}
        <button class="small" onClick={() => saveTable(recording)} aria-label={`Save ${name} as CSV`}>CSV</button>{" "}
        {log && <button class="small save-log" onClick={() => download(`${fileName(recording)}.mcap`, log, "application/octet-stream")} aria-label={`Save ${name} as MCAP`}>MCAP</button>}
      </td>
    </tr>
  );
}

const fileName = ({ began_s }: Recording) => `play-${new Date(began_s * 1000).toISOString().slice(0, 19).replaceAll(":", "-")}`;

function saveTable(recording: Recording): void {
  const rows = recording.samples.map(({ t_s, phi_rad, pose }) => [t_s, ...phi_rad, ...pose].join(","));
  download(`${fileName(recording)}.csv`, `t_s,phi1_rad,phi2_rad,x_m,y_m,theta_rad\n${rows.join("\n")}\n`, "text/csv");
}

/** Time of the replay, with pause and a slider. */
function Player() {
  const recording = replayed.value;
  useEffect(() => {
    if (!recording) return;
    const end = duration(recording);
    let [frame, before] = [0, performance.now()];
    const step = (now: number) => {
      if (replayRuns.peek()) {
        replayTime.value = Math.min(end, replayTime.peek() + ((now - before) / 1000) * SPEED);
        if (replayTime.peek() >= end) replayRuns.value = false;
      }
      before = now;
      frame = requestAnimationFrame(step);
    };
    frame = requestAnimationFrame(step);
    return () => cancelAnimationFrame(frame);
  }, [recording]);
  if (!recording) return null;
  const end = duration(recording);
  const resume = () => {
    if (replayTime.peek() >= end) replayTime.value = 0;
    replayRuns.value = !replayRuns.peek();
  };
  return (
    <div class="bar-of-buttons">
      <button onClick={resume}>{replayRuns.value ? "Pause" : "Go on"}</button>
      <input
        type="range"
        id="replay-time"
        min={0}
        max={end}
        step={0.02}
        value={replayTime.value}
        aria-label="Time in the recording"
        aria-valuetext={`${figure(replayTime.value, 1)} seconds`}
        onInput={(event) => {
          replayRuns.value = false;
          replayTime.value = event.currentTarget.valueAsNumber;
        }}
      />
      <span class="soft clock">{figure(replayTime.value, 1)} of {figure(end, 1)} s, {SPEED} ×</span>
      <button onClick={endReplay}>Close</button>
    </div>
  );
}

/** Replayed seconds per second. */
const SPEED = 4;
