// The door to the Rust module, as `lab/wasm/src/abi.rs` describes it.

interface Exports {
  memory: WebAssembly.Memory;
  lab_input(length: number): number;
  lab_call(name: number, bytes: number): number;
  lab_kind(): number;
  lab_output(): number;
}

/** What a call answers: a JSON document, or bytes that are the caller's to keep. */
export type Answer = { json: unknown } | { bytes: Uint8Array<ArrayBuffer> };

const BYTES = 1;
const REASON = 2;

/** The module, instantiated: one per worker, because it keeps state. */
export class Module {
  readonly #exports: Exports;
  readonly #encoder = new TextEncoder();
  readonly #decoder = new TextDecoder();

  private constructor(exports: Exports) {
    this.#exports = exports;
  }

  static async load(compiled: WebAssembly.Module): Promise<Module> {
    const { exports } = await WebAssembly.instantiate(compiled, {});
    return new Module(exports as unknown as Exports);
  }

  /** Performs a call by name; `question` is bytes or a JSON text as they are, or anything that JSON holds. Throws its reason in one
   * sentence. */
  call(name: string, question: unknown): Answer {
    const called = this.#encoder.encode(name);
    const asked = question instanceof Uint8Array ? question : this.#encoder.encode(typeof question === "string" ? question : JSON.stringify(question));
    const length = called.length + asked.length;
    const place = this.#exports.lab_input(length);
    const room = new Uint8Array(this.#exports.memory.buffer, place, length);
    room.set(called);
    room.set(asked, called.length);
    const answered = this.#exports.lab_call(called.length, asked.length);
    const bytes = new Uint8Array(this.#exports.memory.buffer, this.#exports.lab_output(), answered).slice();
    const kind = this.#exports.lab_kind();
    if (kind === BYTES) return { bytes };
    const text = this.#decoder.decode(bytes);
    if (kind === REASON) throw new Error(text);
    return { json: JSON.parse(text) };
  }
}
