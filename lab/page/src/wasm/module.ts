// Interface to the Rust module, described in `lab/wasm/src/abi.rs`.

interface Exports {
  memory: WebAssembly.Memory;
  lab_input(length: number): number;
  lab_call(name: number, bytes: number): number;
  lab_kind(): number;
  lab_output(): number;
}

/** Output of a call: a JSON document, or bytes owned by the caller. */
export type CallOutput = { json: unknown } | { bytes: Uint8Array<ArrayBuffer> };

const BYTES = 1;
const REASON = 2;

/** Instance of the module: one per worker, because it has state. */
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

  /** Performs a call by name; `question` is bytes, a JSON text, or a value to be encoded as JSON. Throws an error message of one
  * sentence. */
  call(name: string, question: unknown): CallOutput {
    const called = this.#encoder.encode(name);
    const encoded = question instanceof Uint8Array ? question : this.#encoder.encode(typeof question === "string" ? question : JSON.stringify(question));
    const length = called.length + encoded.length;
    const place = this.#exports.lab_input(length);
    const input = new Uint8Array(this.#exports.memory.buffer, place, length);
    input.set(called);
    input.set(encoded, called.length);
    const outputLength = this.#exports.lab_call(called.length, encoded.length);
    const bytes = new Uint8Array(this.#exports.memory.buffer, this.#exports.lab_output(), outputLength).slice();
    const kind = this.#exports.lab_kind();
    if (kind === BYTES) return { bytes };
    const text = this.#decoder.decode(bytes);
    if (kind === REASON) throw new Error(text);
    return { json: JSON.parse(text) };
  }
}
