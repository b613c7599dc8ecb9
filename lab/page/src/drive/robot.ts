// State of the robot in the page: signals updated by the worker's messages, and the requests to the robot.

import { computed, effect, type Signal, signal } from "@preact/signals";
import source from "worker:./worker.ts";
import { download } from "../files/download.ts";
import { startWorker } from "../wasm/embedded.ts";
import { fragment, setFragment } from "../shell/fragment.ts";
import { compose, frameOf, MIDDLE, type Place, type Pose } from "./body.ts";
import { addRecordings, endReplay, unreadable } from "./recordings.ts";
import type { Forecast, Health, Held, Hello, LinkState, MonitorLine, News, Order, Request, Stands, StateName, TableInfo, Telemetry, TrackedPose, WireOptions } from "./words.ts";

export const link = signal<{ state: LinkState; name: string; reason: string }>({ state: "closed", name: "", reason: "" });
export const wheel = signal<{ yours: boolean; free: boolean } | null>(null);
export const telemetry = signal<Telemetry | null>(null);
/** Time of arrival, ms of the page's clock. */
export const heardAt = signal(0);
export const hello = signal<Hello | null>(null);
export const configuration = signal<object | null>(null);
export const table = signal<TableInfo | null>(null);
export const held = signal<Held | null>(null);
export const health = signal<Health | null>(null);
export const stands = signal<Stands | null>(null);
export const progress = signal<{ done: number; total: number } | null>(null);
export const latestForecast = signal<{ of: number; result: Forecast | null; reason: string } | null>(null);
/** Gaits that this page has sent, by the checksum of their tables; only these can be drawn while the robot plays. */
export const sent = signal<ReadonlyMap<number, string | number[]>>(new Map());
/** Result of the last action. */
export const said = signal<{ text: string; failed: boolean }>({ text: "", failed: false });
/** Action in progress. */
export const busy = signal("");
export const wireKind = signal<WireOptions["kind"] | null>(null);

/** Sample of the plots. */
export interface Sample {
  /** Time since power-on of the robot, s. */
  t: number;
  phi: [number, number];
  battery: number | null;
  trip: number | null;
}
/** Number of samples in about two minutes. */
const KEPT = 3000;
export const history = signal<readonly Sample[]>([]);
/** Pose in the tank at which the robot's own model began this play. */
export const base = signal<Pose>(MIDDLE);
/** Pose in the tank from which the next play is predicted, or the present one was. */
export const start = signal<Pose>(MIDDLE);
/** Path of this play by the robot's own model, and the true one of the robot in the page, in the tank. */
export const path = signal<readonly Place[]>([]);
export const truth = signal<readonly Place[]>([]);
/** Pose by the cameras of the server: undefined without cameras, null while they do not see the robot. */
export const tracked = signal<TrackedPose | undefined>(undefined);
/** Path of this play by the cameras; null where the robot was not seen. */
export const trackedPath = signal<readonly (Place | null)[]>([]);
/** Lines of the monitor about this play. */
export const monitor = signal<readonly MonitorLine[]>([]);

/** Age above which telemetry is grey, ms; the robot sends it 25 times per second. */
const FRESH = 500;
const tick = signal(performance.now());
setInterval(() => (tick.value = performance.now()), 100);
export const stale = computed(() => telemetry.value === null || tick.value - heardAt.value > FRESH);

const AT_REST = new Set(["Stopped", "EStopped"]);
/** Time at which a powering request was sent, ms of the page's clock. */
let powered = -Infinity;
/** `true` if pulses may be on; the space bar is then the e-stop. */
export function mayMove(): boolean {
  const { state } = link.peek();
  if (state === "closed" || state === "opening") return false;
  if (performance.now() - powered < 2000 || stale.peek()) return true;
  return !AT_REST.has(telemetry.peek()?.state ?? "");
}

const UPLOADING = "uploading the gait";
let worker: Promise<Worker> | undefined;

function order(order: Order): void {
  worker ??= startWorker(source, "robot").then((started) => {
    started.onmessage = ({ data }: MessageEvent<News>) => hear(data);
    return started;
  });
  void worker.then((started) => started.postMessage(order));
}

function hear(news: News): void {
  switch (news.kind) {
    case "link":
      link.value = news;
      if (news.state !== "open") busy.value = "";
      if (news.state === "closed") {
        wheel.value = telemetry.value = hello.value = stands.value = null;
        tracked.value = undefined;
        monitor.value = [];
      }
      // A new session requests the status again, since e-stops or settings may have changed.
      if (news.state !== "open") table.value = held.value = null;
      break;
    case "events":
      for (const event of news.events) if (event.event === "telemetry") take(event.telemetry);
      break;
    case "done":
      busy.value = "";
      progress.value = null;
      said.value = news.reason === null ? { text: done(news.what), failed: false } : { text: news.reason, failed: true };
      break;
    case "hello":
      hello.value = news.hello;
      configuration.value = news.configuration;
      break;
    case "table":
      table.value = news.table;
      break;
    case "held":
      held.value = news.held;
      break;
    case "uploaded": {
      table.value = news.table;
      const gait = uploads.get(news.of);
      if (gait) sent.value = new Map([...sent.peek(), [news.table.crc32, gait]]);
      break;
    }
    case "alive?":
      order({ do: "alive" });
      break;
    case "progress":
      progress.value = news;
      break;
    case "health":
      health.value = news.health;
      break;
    case "stands":
      stands.value = news.stands;
      if (MOVES.has(news.stands.state)) truth.value = [...truth.peek().slice(1 - KEPT), [news.stands.pose[0], news.stands.pose[1]]];
      break;
    case "tracked":
      tracked.value = news.pose;
      if (MOVES.has(telemetry.peek()?.state ?? "Stopped")) trackedPath.value = [...trackedPath.peek().slice(1 - KEPT), news.pose && [news.pose[0], news.pose[1]]];
      break;
    case "monitor":
      monitor.value = news.lines;
      break;
    case "wheel":
      wheel.value = news;
      break;
    case "stopped by another":
      said.value = { text: "Another page has asked the robot to stop.", failed: false };
      break;
    case "forecast":
      latestForecast.value = { of: news.of, result: news.forecast, reason: news.reason };
      break;
    case "recording":
      if (news.reason) unreadable.value = `${news.name || "The log of this play"}: ${news.reason}`;
      else addRecordings(news.plays, news.name, news.log);
      break;
    case "log":
      download("link.mcap", news.bytes, "application/octet-stream");
  }
}

const done = (what: string) => (what === UPLOADING ? "Uploaded." : `The robot has acknowledged: ${what}.`);

function take(latest: Telemetry): void {
  const before = telemetry.peek();
  telemetry.value = latest;
  heardAt.value = performance.now();
  const sample: Sample = {
    t: latest.robot_us * 1e-6,
    phi: [latest.setpoint[0] * 1e-4, latest.setpoint[1] * 1e-4],
    battery: latest.battery_mv === null ? null : latest.battery_mv * 1e-3,
    trip: health.peek()?.round_trip_s ?? null,
  };
  const again = before && latest.robot_us < before.robot_us;
  history.value = again ? [sample] : [...history.peek().slice(1 - KEPT), sample];
  const began = latest.state === "Starting" && before?.state !== "Starting";
  if (again || began) {
    path.value = truth.value = [];
    trackedPath.value = [];
    endReplay();
  }
  const truly = stands.peek()?.pose ?? tracked.peek();
  const cyclesBegin = latest.state === "Playing" && before?.state === "Starting";
  const rests = !MOVES.has(latest.state);
  // Poses are compared at rest, since true ones arrive at other times. The robot's own model begins anew at the first cycle, where the
  // soft start has led by the model.
  if (truly && rests) place(base, frameOf(truly, own(latest)));
  else if (again) place(base, MIDDLE);
  else if (cyclesBegin && before) place(base, compose(base.peek(), own(before)));
  const here = compose(base.peek(), own(latest));
  if (!rests) path.value = [...path.peek().slice(1 - KEPT), [here[0], here[1]]];
  if (rests || cyclesBegin) place(start, truly ?? here);
}

const MOVES: ReadonlySet<StateName> = new Set(["Starting", "Playing", "Paused", "Stopping", "Settling"]);
const own = ({ pose: { x, y, theta } }: Telemetry): Pose => [x, y, theta];

/** Sets a pose if it differs. */
function place(signal: Signal<Pose>, pose: Pose): void {
  if (pose.some((value, k) => Math.abs(value - (signal.peek()[k] ?? 0)) > 1e-6)) signal.value = pose;
}

/** The robot was put back into the middle of the tank, heading along it. */
export function putBack(): void {
  const latest = telemetry.peek();
  path.value = [];
  if (latest) place(base, frameOf(MIDDLE, own(latest)));
  place(start, MIDDLE);
}

export function connect(wire: WireOptions, key: string | null): void {
  wireKind.value = wire.kind;
  history.value = path.value = truth.value = [];
  trackedPath.value = [];
  base.value = start.value = MIDDLE;
  telemetry.value = null;
  order({ do: "open", wire, key });
}

export const disconnect = () => order({ do: "close" });
export const takeWheel = () => order({ do: "drive" });
export const leaveWheel = () => order({ do: "watch" });
export const openRecording = (name: string, bytes: ArrayBuffer) => order({ do: "read recording", name, bytes });
export const downloadLog = () => order({ do: "log" });
export const cancelUpload = () => order({ do: "cancel upload" });
export const requestForecast = (question: object, of: number) => order({ do: "preflight", question, of });

/** Stops never wait for a reply, a dialog or another action. */
export const stop = () => order({ do: "stop" });
export function estop(): void {
  powered = -Infinity;
  order({ do: "estop" });
}

export function request(request: Request, what: string): void {
  busy.value = what;
  if (typeof request === "object" || request === "Arm" || request === "Resume") powered = performance.now();
  order({ do: "request", request, what });
}

let lastUpload = 0;
const uploads = new Map<number, string | number[]>();
export function upload(gait: string | number[]): void {
  busy.value = UPLOADING;
  progress.value = { done: 0, total: 1 };
  lastUpload += 1;
  uploads.clear();
  uploads.set(lastUpload, gait);
  order({ do: "upload", gait, of: lastUpload });
}

/** Token that `swimmer lab --port` put into the address: stored for this tab, and removed from the address, which may be shared. */
const SERVED = "swimmer-link";
export function served(): { url: string; token: string } | null {
  const fromLink = fragment().get("link");
  if (fromLink) {
    try {
      sessionStorage.setItem(SERVED, fromLink);
    } catch {
      // Without storage, the page needs the address again after a reload.
    }
    setFragment("link", undefined);
    kept = fromLink;
  }
  const token = kept ?? remembered();
  if (!token || !location.protocol.startsWith("http")) return null;
  return { url: `${location.protocol.replace("http", "ws")}//${location.host}/link`, token };
}
let kept: string | undefined;
function remembered(): string | null {
  try {
    return sessionStorage.getItem(SERVED);
  } catch {
    return null;
  }
}

/** While pulses may be on, the space bar is the e-stop in every tab, whatever has the focus. */
window.addEventListener(
  "keydown",
  (event) => {
    if (event.code !== "Space" || event.repeat || event.ctrlKey || event.altKey || event.metaKey || !mayMove()) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    estop();
  },
  { capture: true },
);
// Releasing the key must not press a button.
window.addEventListener("keyup", (event) => event.code === "Space" && mayMove() && event.preventDefault(), { capture: true });

/** Shows the state of the robot in the title of the browser tab. */
effect(() => {
  const state = telemetry.value?.state;
  document.title = state && link.value.state !== "closed" ? `${state} – swimmer lab` : "swimmer lab";
});
