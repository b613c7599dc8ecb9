// Transports of bytes: a serial port of the browser, a WebSocket of `swimmer lab`, the twin in the page.

import type { Module } from "../wasm/module.ts";
import type { MonitorLine, Stands, TrackedPose, WireOptions } from "./words.ts";

/** Callbacks for the events of a transport. */
export interface WireListener {
  /** The transport is open. */
  up(name: string, bytesPerSecond: number): void;
  bytes(bytes: Uint8Array): void;
  /** The transport is broken and will be opened again automatically. */
  gone(reason: string): void;
  /** Another page is driving. */
  wheel(yours: boolean, free: boolean): void;
  stoppedByAnother(): void;
  stands(stands: Stands): void;
  /** Cameras of the server: pose of the robot, and their comparison with the prediction. */
  tracked(pose: TrackedPose): void;
  monitor(lines: MonitorLine[]): void;
}

export interface Wire {
  /** Sends bytes. If the buffer is full they are lost, as on any link, so the queue is bounded. */
  send(bytes: Uint8Array): void;
  /** Sends a stop, which overtakes all waiting bytes. */
  sendStop(bytes: Uint8Array): void;
  /** Sends a text message, if the other end understands them. */
  say(word: "drive" | "watch" | "stop" | "estop" | "here"): void;
  close(): void;
}

/** Time between two attempts to open a broken transport, ms. */
const AGAIN = 500;
const BITS_OF_A_BYTE = 10;

export function open(options: WireOptions, module: Module, listener: WireListener): Wire {
  if (options.kind === "twin") return new TwinWire(module, options, listener);
  return options.kind === "serial" ? new SerialWire(options.baud, listener) : new SocketWire(options, listener);
}

/** Robot in the page: runs in real time, with a limited number of steps at once. */
class TwinWire implements Wire {
  static readonly STEP = 10;
  static readonly LONGEST = 0.02;
  /** Interval between two readings of the robot's pose, ms. */
  static readonly LOOK = 50;
  readonly #number: number;
  readonly #timer: ReturnType<typeof setInterval>;
  #waiting: Uint8Array[] = [];
  #robot = 0;
  #before = performance.now();
  #looked = 0;

  constructor(
    readonly module: Module,
    options: { swimmer: string; seed: number },
    readonly listener: WireListener,
  ) {
    const { swimmer, seed } = options;
    const answer = module.call("twin open", { swimmer, seed });
    this.#number = "json" in answer ? (answer.json as { number: number }).number : 0;
    this.#timer = setInterval(() => this.#step(), TwinWire.STEP);
    queueMicrotask(() => listener.up("the robot in this page", 11_520));
  }

  #step(): void {
    const now = performance.now();
    // If the machine stalls, the simulated robot waits, so its lease does not expire over unread bytes.
    this.#robot += Math.min((now - this.#before) / 1000, TwinWire.LONGEST);
    this.#before = now;
    const answer = this.module.call("twin step", stepOf(this.#number, this.#robot, this.#waiting));
    this.#waiting = [];
    if ("bytes" in answer && answer.bytes.length > 0) this.listener.bytes(answer.bytes);
    if (now - this.#looked < TwinWire.LOOK) return;
    this.#looked = now;
    const stands = this.module.call("twin stands", { number: this.#number });
    if ("json" in stands) this.listener.stands(stands.json as Stands);
  }

  send(bytes: Uint8Array): void {
    this.#waiting.push(bytes);
  }

  sendStop(bytes: Uint8Array): void {
    this.#waiting = [bytes];
  }

  say(): void {}

  close(): void {
    clearInterval(this.#timer);
    this.module.call("twin close", { number: this.#number });
  }
}

/** Arguments of the module's steps: `[u32 number][f64 s][bytes]`. */
export function stepOf(number: number, now: number, pieces: readonly Uint8Array[]): Uint8Array {
  const length = pieces.reduce((sum, piece) => sum + piece.length, 12);
  const question = new Uint8Array(length);
  const view = new DataView(question.buffer);
  view.setUint32(0, number, true);
  view.setFloat64(4, now, true);
  let at = 12;
  for (const piece of pieces) {
    question.set(piece, at);
    at += piece.length;
  }
  return question;
}

/** The WebSocket of `swimmer lab --port`. */
class SocketWire implements Wire {
  /** Largest number of bytes that wait in the browser. */
  static readonly MOST_WAITING = 4096;
  #socket: WebSocket | undefined;
  #closed = false;
  #timer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    readonly options: { url: string; token: string },
    readonly listener: WireListener,
  ) {
    this.#dial();
  }

  #dial(): void {
    const socket = new WebSocket(this.options.url, ["swimmer", this.options.token]);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }: MessageEvent<string | ArrayBuffer>) => {
      if (data instanceof ArrayBuffer) this.listener.bytes(new Uint8Array(data));
      else this.#hear(JSON.parse(data) as ServerMessage);
    };
    socket.onclose = () => {
      if (this.#closed) return;
      this.listener.gone("the server does not answer: is `swimmer lab` still running, and is this its newest address?");
      this.#timer = setTimeout(() => this.#dial(), AGAIN);
    };
    this.#socket = socket;
  }

  #hear(message: ServerMessage): void {
    if (message.told === "wheel") this.listener.wheel(message.yours, message.free);
    else if (message.told === "stopped") this.listener.stoppedByAnother();
    else if (message.told === "tracked") this.listener.tracked(message.pose);
    else if (message.told === "monitor") this.listener.monitor(message.lines);
    else if (message.open) this.listener.up(message.name, message.bytes_per_second);
    else this.listener.gone(message.why ?? `${message.name} is gone`);
  }

  send(bytes: Uint8Array<ArrayBuffer>): void {
    if (this.#socket?.readyState === WebSocket.OPEN && this.#socket.bufferedAmount < SocketWire.MOST_WAITING) this.#socket.send(bytes);
  }

  /** The server detects stops among the frames and lets them overtake. */
  sendStop(bytes: Uint8Array<ArrayBuffer>): void {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(bytes);
  }

  say(word: string): void {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify({ ask: word }));
  }

  close(): void {
    this.#closed = true;
    clearTimeout(this.#timer);
    this.#socket?.close();
  }
}

type ServerMessage =
  | { told: "wheel"; yours: boolean; free: boolean }
  | { told: "port"; name: string; open: boolean; why: string | null; bytes_per_second: number }
  | { told: "stopped" }
  | { told: "tracked"; pose: TrackedPose }
  | { told: "monitor"; lines: MonitorLine[] };

/** Used parts of Web Serial, which TypeScript's library lacks. */
export interface SerialPort {
  open(options: { baudRate: number; bufferSize?: number }): Promise<void>;
  close(): Promise<void>;
  readonly readable: ReadableStream<Uint8Array> | null;
  readonly writable: WritableStream<Uint8Array> | null;
}

export interface Serial {
  getPorts(): Promise<SerialPort[]>;
  requestPort?(): Promise<SerialPort>;
}

/** Serial ports of the browser; undefined if it does not support them. */
export function serial(): Serial | undefined {
  return (navigator as { serial?: Serial }).serial;
}

/** Serial port chosen by the user, for which the browser has granted permission; found again after it was unplugged. */
class SerialWire implements Wire {
  #closed = false;
  #writer: WritableStreamDefaultWriter<Uint8Array> | undefined;
  #reader: ReadableStreamDefaultReader<Uint8Array> | undefined;
  #port: SerialPort | undefined;
  /** Free capacity of an idle writer. */
  #idle: number | null = null;
  #reported = "";

  constructor(
    readonly baud: number,
    readonly listener: WireListener,
  ) {
    void this.#live();
  }

  async #live(): Promise<void> {
    while (!this.#closed) {
      try {
        // The most recently permitted of several ports.
        const port = (await serial()?.getPorts())?.at(-1);
        if (!port) throw new Error("there is no serial port that this page may have; plug the robot in, or choose its port again");
        await this.#carry(port);
      } catch (error) {
        const reason = error instanceof Error ? error.message : String(error);
        if (!this.#closed && reason !== this.#reported) this.listener.gone(reason);
        this.#reported = reason;
      }
      await new Promise((resolve) => setTimeout(resolve, AGAIN));
    }
  }

  async #carry(port: SerialPort): Promise<void> {
    await port.open({ baudRate: this.baud, bufferSize: 4096 });
    try {
      this.#port = port;
      this.#writer = port.writable?.getWriter();
      this.#idle = this.#writer?.desiredSize ?? null;
      this.#reader = port.readable?.getReader();
      this.#reported = "";
      this.listener.up("the serial port", this.baud / BITS_OF_A_BYTE);
      for (;;) {
        const { value, done } = (await this.#reader?.read()) ?? { value: undefined, done: true };
        if (done) throw new Error("the serial port was unplugged; plug it in again, and the robot is greeted anew");
        if (value && value.length > 0) this.listener.bytes(value);
      }
    } finally {
      this.#writer?.releaseLock();
      this.#reader?.releaseLock();
      this.#writer = this.#reader = this.#port = undefined;
      await port.close().catch(() => undefined);
    }
  }

  send(bytes: Uint8Array): void {
    if ((this.#writer?.desiredSize ?? 0) <= 0) return;
    // Bytes for a broken port are lost too; the end of the reader reports the failure.
    this.#writer?.write(bytes).catch(() => undefined);
  }

  sendStop(bytes: Uint8Array): void {
    const writer = this.#writer;
    if (!writer) return;
    if (writer.desiredSize === this.#idle) return void writer.write(bytes).catch(() => undefined);
    // Discards the waiting bytes together with the stream; the port provides a new stream.
    this.#writer = undefined;
    void writer
      .abort()
      .catch(() => undefined)
      .then(() => {
        writer.releaseLock();
        this.#writer = this.#port?.writable?.getWriter();
        return this.#writer?.write(bytes);
      })
      .catch(() => undefined);
  }

  say(): void {}

  close(): void {
    this.#closed = true;
    void this.#reader?.cancel().catch(() => undefined);
  }
}
