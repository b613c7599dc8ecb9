// Worker of the robot's session. The session runs here because the timers of a hidden page tick once per second, while the robot's
// lease is half a second.

import { Module } from "../wasm/module.ts";
import { type WireListener, open, stepOf, type Wire } from "./wires.ts";
import type { Event, Forecast, Health, News, Order, RecordedPlay, Reply, Request, StateName, Status } from "./words.ts";

/** Longest interval between two steps of the session, ms. */
const BEAT = 20;
/** Interval between two readings of the link's statistics, ms. */
const LOOK = 500;
/** Interval between two heartbeats to the server, ms. */
const SIGN = 250;
/** Interval between two checks of the robot's gait, in readings of the link: another program may have sent one. */
const STATUS_EVERY = 4;
/** Time without a reply after which the main thread counts as hung and heartbeats stop, ms. */
const HANGS = 400;

let module: Module;
let wire: Wire | undefined;
let wireName = "";
let session: number | undefined;
let spectator: number | undefined;
let key: string | null = null;
let timer: ReturnType<typeof setTimeout> | undefined;
/** Purpose of each ticket. */
const pending = new Map<number, string>();
/** Number of the upload in progress, chosen by the page. */
let uploading = 0;
let looks = 0;
let alive = performance.now();

const now = () => performance.now() / 1000;
const tell = (news: News, transfer: Transferable[] = []) => self.postMessage(news, { transfer });

function json<T>(name: string, question: object): T {
  const answer = module.call(name, question);
  if (!("json" in answer)) throw new Error(`${name}: bytes where a document was expected`);
  return answer.json as T;
}

const reasonOf = (error: unknown) => (error instanceof Error ? error.message : String(error));

const GREETING = "connecting";
const CONFIGURATION = "reading the configuration";
const STATUS = "reading which gait and settings the robot holds";
const UPLOADING = "uploading the gait";

const listener: WireListener = {
  up(name, bytesPerSecond) {
    wireName = name;
    try {
      openSession(bytesPerSecond);
    } catch (error) {
      tell({ kind: "link", state: "gone", name: wireName, reason: reasonOf(error) });
    }
  },
  bytes(bytes) {
    if (session !== undefined) step(bytes);
    else if (spectator !== undefined) overhear(bytes);
  },
  gone(reason) {
    closeSession();
    tell({ kind: "link", state: "gone", name: wireName, reason });
  },
  wheel(yours, free) {
    if (yours) {
      if (session === undefined) openSession(lineSpeed);
    } else {
      closeSession();
      spectator = json<{ number: number }>("overhear open", {}).number;
      tell({ kind: "link", state: "watching", name: wireName, reason: "" });
    }
    tell({ kind: "wheel", yours, free });
  },
  stoppedByAnother: () => tell({ kind: "stopped by another" }),
  stands: (stands) => tell({ kind: "stands", stands }),
  tracked: (pose) => tell({ kind: "tracked", pose }),
  monitor: (lines) => tell({ kind: "monitor", lines }),
};

let lineSpeed = 11_520;

function openSession(bytesPerSecond: number): void {
  closeSession();
  lineSpeed = bytesPerSecond;
  const seed = crypto.getRandomValues(new Uint32Array(1))[0] ?? 1;
  session = json<{ number: number }>("session open", {
    seed,
    bytes_per_second: bytesPerSecond,
    epoch_s: performance.timeOrigin / 1000,
    key,
  }).number;
  tell({ kind: "link", state: "greeting", name: wireName, reason: "" });
  greet();
}

function closeSession(): void {
  clearTimeout(timer);
  endRecording();
  if (session !== undefined) json("session close", { number: session });
  if (spectator !== undefined) json("overhear close", { number: spectator });
  session = spectator = hello = undefined;
  pending.clear();
}

function greet(): void {
  ask("session connect", {}, GREETING);
}

function ask(name: string, question: object, what: string, stops = false): void {
  if (session === undefined) {
    tell({ kind: "done", what, reason: `${what}: no robot is connected` });
    return;
  }
  try {
    const { ticket } = json<{ ticket: number }>(name, { number: session, now_s: now(), ...question });
    pending.set(ticket, what);
  } catch (error) {
    tell({ kind: "done", what, reason: reasonOf(error) });
  }
  step(new Uint8Array(), stops);
}

const request = (request: Request, what: string, stops = false) => ask("session request", { request }, what, stops);

/** Steps the session: passes bytes in and out, handles events, schedules the next step. */
function step(received: Uint8Array, stops = false): void {
  if (session === undefined) return;
  const answer = module.call("session step", stepOf(session, now(), [received]));
  if (!("bytes" in answer)) return;
  const { bytes } = answer;
  const count = new DataView(bytes.buffer).getUint32(0, true);
  if (count > 0 && stops) wire?.sendStop(bytes.slice(4, 4 + count));
  else if (count > 0) wire?.send(bytes.slice(4, 4 + count));
  const news = JSON.parse(new TextDecoder().decode(bytes.subarray(4 + count))) as { events: Event[]; next_s: number | null };
  clearTimeout(timer);
  const wait = news.next_s === null ? BEAT : Math.max(0, news.next_s - now()) * 1000;
  timer = setTimeout(() => step(new Uint8Array()), Math.min(wait, BEAT));
  for (const event of news.events) hear(event);
  if (news.events.length > 0) tell({ kind: "events", events: news.events });
}

function hear(event: Event): void {
  if (event.event === "telemetry") {
    // An e-stop is cleared by its count.
    if (event.telemetry.state === "EStopped" && state !== "EStopped") request("Status", STATUS);
    state = event.telemetry.state;
    record(event.telemetry.state, event.at_s);
    return;
  }
  if (event.event === "progress") {
    tell({ kind: "progress", done: event.done, total: event.total });
    return;
  }
  const what = pending.get(event.ticket) ?? "";
  pending.delete(event.ticket);
  if (event.event === "failed") {
    if (what === GREETING) {
      tell({ kind: "link", state: "gone", name: wireName, reason: event.reason });
      // Finds a robot that is switched on later.
      timer = setTimeout(greet, LOOK);
    } else {
      if (what !== STATUS) tell({ kind: "done", what, reason: event.reason });
      // E-stops or settings may have changed, so the values for the next request are read again.
      if (what !== STATUS) request("Status", STATUS);
    }
    return;
  }
  if (event.event === "connected") {
    tell({ kind: "link", state: "open", name: wireName, reason: event.restarted ? "The robot has restarted." : "" });
    tell({ kind: "hello", hello: event.hello, configuration: null });
    hello = event.hello;
    request("Configuration", CONFIGURATION);
    request("Status", STATUS);
    return;
  }
  if (event.event === "uploaded") tell({ kind: "uploaded", of: uploading, table: event.table });
  if (event.event === "answered") answered(event.reply);
  if (what !== CONFIGURATION && what !== STATUS) tell({ kind: "done", what, reason: null });
}

/** State of the robot by its last telemetry. */
let state = "";
let hello: (Event & { event: "connected" })["hello"] | undefined;

const MOVES: ReadonlySet<StateName> = new Set(["Starting", "Playing", "Paused", "Stopping"]);
/** Time of the last request to play, and the time from which the log of the present play is kept, s. */
let playRequested: number | undefined;
let recordedFrom: number | undefined;

/** Begins a recording when the robot begins to move, and ends it when the robot rests. */
function record(state: StateName, at: number): void {
  if (!MOVES.has(state)) endRecording();
  else recordedFrom ??= playRequested ?? at;
}

function endRecording(): void {
  if (recordedFrom === undefined || session === undefined) return;
  const answer = module.call("session log", { number: session, from_s: recordedFrom });
  recordedFrom = playRequested = undefined;
  if ("bytes" in answer) readRecording("", answer.bytes);
}

/** Reads the plays of a log; without a name the log is that of the present session. */
function readRecording(name: string, bytes: Uint8Array<ArrayBuffer>): void {
  try {
    const answer = module.call("recordings", bytes);
    const plays = "json" in answer ? (answer.json as RecordedPlay[]) : [];
    const log = name ? null : bytes.buffer;
    tell({ kind: "recording", name, plays, log, reason: "" }, log ? [log] : []);
  } catch (error) {
    tell({ kind: "recording", name, plays: [], log: null, reason: reasonOf(error) });
  }
}

function answered(reply: Reply): void {
  if (typeof reply !== "object") return;
  if ("Configuration" in reply && hello) tell({ kind: "hello", hello, configuration: reply.Configuration as object });
  if ("Status" in reply) {
    const { table, settings_crc32, estops } = reply.Status as Status;
    tell({ kind: "table", table });
    tell({ kind: "held", held: { settings_crc32, estops } });
  }
}

function overhear(bytes: Uint8Array): void {
  if (spectator === undefined) return;
  const { events } = json<{ events: Event[] }>("overhear step", stepOf(spectator, now(), [bytes]));
  if (events.length > 0) tell({ kind: "events", events });
}

setInterval(() => {
  if (performance.now() - alive < HANGS) wire?.say("here");
  // Messages are handled in a hidden page too, where timers tick rarely.
  tell({ kind: "alive?" });
}, SIGN);

setInterval(() => {
  if (session === undefined) return;
  tell({ kind: "health", health: json<Health>("session link", { number: session }) });
  looks += 1;
  const isAsked = [...pending.values()].some((what) => what === STATUS || what === GREETING || what === UPLOADING);
  if (hello && looks % STATUS_EVERY === 0 && !isAsked) request("Status", STATUS);
}, LOOK);

function perform(order: Order): void {
  switch (order.do) {
    case "open":
      closeWire();
      key = order.key;
      tell({ kind: "link", state: "opening", name: "", reason: "" });
      wire = open(order.wire, module, listener);
      return;
    case "close":
      closeWire();
      tell({ kind: "link", state: "closed", name: "", reason: "" });
      return;
    case "stop":
    case "estop":
      // A spectator has no session; the server stops the robot on its behalf.
      if (session === undefined) wire?.say(order.do);
      else request(order.do === "stop" ? "Stop" : "EStop", order.do === "stop" ? "stop" : "e-stop", true);
      return;
    case "drive":
    case "watch":
      wire?.say(order.do);
      return;
    case "request":
      if (typeof order.request === "object" && "Play" in order.request) playRequested = now();
      request(order.request, order.what);
      return;
    case "upload":
      uploading = order.of;
      ask("session upload", { gait: order.gait }, UPLOADING);
      return;
    case "cancel upload":
      if (session !== undefined) json("session cancel upload", { number: session, now_s: now() });
      return;
    case "preflight":
      try {
        tell({ kind: "forecast", of: order.of, forecast: json<Forecast>("preflight", order.question), reason: "" });
      } catch (error) {
        tell({ kind: "forecast", of: order.of, forecast: null, reason: reasonOf(error) });
      }
      return;
    case "read recording":
      readRecording(order.name, new Uint8Array(order.bytes));
      return;
    case "alive":
      alive = performance.now();
      return;
    case "log": {
      if (session === undefined) return;
      const answer = module.call("session log", { number: session, from_s: null });
      if ("bytes" in answer) tell({ kind: "log", bytes: answer.bytes.buffer }, [answer.bytes.buffer]);
    }
  }
}

function closeWire(): void {
  closeSession();
  wire?.close();
  wire = undefined;
}

let loading: Promise<Module> | undefined;

self.onmessage = async ({ data }: MessageEvent<WebAssembly.Module | Order>) => {
  if (data instanceof WebAssembly.Module) {
    loading = Module.load(data);
    return;
  }
  try {
    if (!loading) throw new Error("ordering a worker that was given no module");
    module = await loading;
    perform(data);
  } catch (error) {
    tell({ kind: "done", what: data.do, reason: reasonOf(error) });
  }
};
