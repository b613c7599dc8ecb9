// The page's side of the numerics: questions to a worker, answers as promises.

import { signal, untracked } from "@preact/signals";
import source from "worker:./worker.ts";
import { type ModuleName, startWorker } from "./embedded.ts";
import type { Told } from "./worker.ts";

/** Questions that wait for an answer, of all workers. */
export const waiting = signal(0);

/** What the latest calls took in their workers, ms by name; `cargo xtask bench` prints them. */
export const times = new Map<string, number[]>();
const KEPT = 100;

function timed(name: string, milliseconds: number): void {
  times.set(name, [...(times.get(name) ?? []).slice(1 - KEPT), milliseconds]);
}

interface Waiting {
  answered(told: Told): void;
}

/** A worker with a module of its own. Long searches have their own, so that no drag waits for them. */
export class Lab {
  #started: Promise<Worker> | undefined;
  readonly #waiting = new Map<number, Waiting>();
  #last = 0;

  constructor(readonly module: ModuleName = "explore") {}

  /** The worker, started when it is first asked: what nobody opens costs nothing. */
  #worker(): Promise<Worker> {
    this.#started ??= startWorker(source, this.module).then((worker) => {
      worker.onmessage = ({ data }: MessageEvent<Told>) => {
        this.#waiting.get(data.id)?.answered(data);
        this.#waiting.delete(data.id);
      };
      return worker;
    });
    return this.#started;
  }

  /** Asks; the reason of a refusal is the error's message. */
  ask(name: string, question: unknown): Promise<Told> {
    const id = ++this.#last;
    waiting.value++;
    const answer = new Promise<Told>((resolve, reject) => {
      this.#waiting.set(id, {
        answered: (told) => {
          if ("reason" in told) reject(new Error(told.reason));
          else {
            timed(name, told.milliseconds);
            resolve(told);
          }
        },
      });
      this.#worker().then((worker) => worker.postMessage({ id, name, question }), reject);
    });
    return answer.finally(() => waiting.value--);
  }

  /** Ends what is being computed, and the worker with it: each question is refused with the reason. The next one has a new worker. */
  stop(reason: string): void {
    const ended = this.#started;
    this.#started = undefined;
    void ended?.then((worker) => worker.terminate());
    for (const { answered } of this.#waiting.values()) answered({ id: 0, milliseconds: 0, reason });
    this.#waiting.clear();
  }

  async json<T>(name: string, question: unknown): Promise<T> {
    const told = await this.ask(name, question);
    if (!("json" in told)) throw new Error(`${name}: bytes where a document was expected`);
    return told.json as T;
  }

  async bytes(name: string, question: unknown): Promise<ArrayBuffer> {
    const told = await this.ask(name, question);
    if (!("bytes" in told)) throw new Error(`${name}: a document where bytes were expected`);
    return told.bytes;
  }
}

/** Runs the newest of what it is given and forgets what was overtaken: a hand is faster than a certificate. */
export class Latest<Q> {
  #running = false;
  #next: Q | undefined;

  constructor(readonly perform: (question: Q) => Promise<void>) {}

  give(question: Q): void {
    this.#next = question;
    // What performing looks at is nothing that who gives, an effect, should be run again for.
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
