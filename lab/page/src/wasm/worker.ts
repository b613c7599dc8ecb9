// Worker of `lab.ts`: one module, which performs one call after the other.

import { Module } from "./module.ts";

export interface CallRequest {
  id: number;
  name: string;
  question: unknown;
}

export type CallReply = { id: number; milliseconds: number } & ({ json: unknown } | { bytes: ArrayBuffer } | { reason: string });

let loading: Promise<Module> | undefined;

self.onmessage = async ({ data }: MessageEvent<WebAssembly.Module | CallRequest>) => {
  if (data instanceof WebAssembly.Module) {
    loading = Module.load(data);
    return;
  }
  const { id, name, question } = data;
  let begun = performance.now();
  try {
    if (!loading) throw new Error("calling a worker that was given no module");
    const module = await loading;
    begun = performance.now();
    const output = module.call(name, question);
    const milliseconds = performance.now() - begun;
    if ("bytes" in output) {
      const { buffer } = output.bytes;
      self.postMessage({ id, milliseconds, bytes: buffer } satisfies CallReply, { transfer: [buffer] });
    } else {
      self.postMessage({ id, milliseconds, json: output.json } satisfies CallReply);
    }
  } catch (error) {
    const reason = error instanceof Error ? error.message : String(error);
    self.postMessage({ id, milliseconds: performance.now() - begun, reason } satisfies CallReply);
  }
};
