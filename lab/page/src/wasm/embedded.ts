// WebAssembly modules, unpacked from the page and compiled once for all workers.

/** Name of a module; each worker has an instance of its own. */
export type ModuleName = "explore" | "robot";

const compiled = new Map<ModuleName, Promise<WebAssembly.Module>>();

/** Returns a module, compiled at its first use. */
function moduleOf(name: ModuleName): Promise<WebAssembly.Module> {
  const known = compiled.get(name) ?? compile(name);
  compiled.set(name, known);
  return known;
}

/** Compiles a module while it is unpacked. */
function compile(name: ModuleName): Promise<WebAssembly.Module> {
  const element = document.getElementById(`module-${name}`);
  const packed = bytesOf(element?.textContent ?? "");
  element?.remove();
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compileStreaming(new Response(stream, { headers: { "content-type": "application/wasm" } }));
}

/** Characters of windows-1252, from 128 on, whose code points differ from their bytes. */
const NAMED = "€\x81‚ƒ„…†‡ˆ‰Š‹Œ\x8dŽ\x8f\x90‘’“”•–—˜™š›œ\x9džŸ";
/** Escape character: the next character is one more than the byte, which HTML would interpret. */
const MARK = 16;

/** Decodes the bytes that `build.mjs` encoded as characters. */
function bytesOf(text: string): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(text.length);
  let at = 0;
  for (let k = 0; k < text.length; k++) {
    const letter = text.charCodeAt(k);
    if (letter === MARK) bytes[at++] = text.charCodeAt(++k) - 1;
    else bytes[at++] = letter < 256 ? letter : 128 + NAMED.indexOf(text.charAt(k));
  }
  return bytes.subarray(0, at);
}

/** Starts a worker from its bundled script and sends it a module as the first message. */
export async function startWorker(source: string, name: ModuleName): Promise<Worker> {
  const place = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const worker = new Worker(place);
  worker.postMessage(await moduleOf(name));
  return worker;
}
