// Calls of the module in a worker, with promises for the results.

import { signal, untracked } from "@preact/signals";
import source from "worker:./worker.ts";
import { type ModuleName, startWorker } from "./embedded.ts";
import type { CallReply } from "./worker.ts";

/** Number of pending calls of all workers. */
export const waiting = signal(0);

/** Times of the latest calls in their workers, ms by name; `cargo xtask bench` prints them. */
export const times = new Map<string, number[]>();
const KEPT = 100;

function timed(name: string, milliseconds: number): void {
  times.set(name, [...(times.get(name) ?? []).slice(1 - KEPT), milliseconds]);
}

interface Waiting {
  answered(reply: CallReply): void;
}

/** Worker with its own module. Long searches have their own worker, so that dragging does not wait for them. */
export class Lab {
  #started: Promise<Worker> | undefined;
  readonly #waiting = new Map<number, Waiting>();
  #last = 0;

  constructor(readonly module: ModuleName = "explore") {}

  /** The worker, started at the first call. */
  #worker(): Promise<Worker> {
    this.#started ??= startWorker(source, this.module).then((worker) => {
      worker.onmessage = ({ data }: MessageEvent<CallReply>) => {
        this.#waiting.get(data.id)?.answered(data);
        this.#waiting.delete(data.id);
      };
      return worker;
    });
    return this.#started;
  }

  /** Performs a call; a failure throws an error with its reason. */
  ask(name: string, question: unknown): Promise<CallReply> {
    const id = ++this.#last;
    waiting.value++;
    const answer = new Promise<CallReply>((resolve, reject) => {
      this.#waiting.set(id, {
        answered: (reply) => {
          if ("reason" in reply) reject(new Error(reply.reason));
          else {
            timed(name, reply.milliseconds);
            resolve(reply);
          }
        },
      });
      this.#worker().then((worker) => worker.postMessage({ id, name, question }), reject);
    });
    return answer.finally(() => waiting.value--);
  }

  /** Terminates the worker; all pending calls fail with the reason. The next call starts a new worker. */
  stop(reason: string): void {
    const ended = this.#started;
    this.#started = undefined;
    void ended?.then((worker) => worker.terminate());
    for (const { answered } of this.#waiting.values()) answered({ id: 0, milliseconds: 0, reason });
    this.#waiting.clear();
  }

  async json<T>(name: string, question: unknown): Promise<T> {
    const reply = await this.ask(name, question);
    if (!("json" in reply)) throw new Error(`${name}: bytes where a document was expected`);
    return reply.json as T;
  }

  async bytes(name: string, question: unknown): Promise<ArrayBuffer> {
    const reply = await this.ask(name, question);
    if (!("bytes" in reply)) throw new Error(`${name}: a document where bytes were expected`);
    return reply.bytes;
  }
}

/** Runs only the latest of several requests and drops older ones, since dragging is faster than a certificate. */
export class Latest<Q> {
  #running = false;
  #next: Q | undefined;

  constructor(readonly perform: (question: Q) => Promise<void>) {}

  give(question: Q): void {
    this.#next = question;
    // Signals that the request reads must not trigger the calling effect again.
    if (!this.#running) void untracked(() => this.#run());
  }

  async #run(): Promise<void> {
    this.#running = true;
    while (this.#next !== undefined) {
      const question = this.#next;
      this.#next = undefined;
      await this.perform(question);
    }
    this.#running = false;
  }
}
