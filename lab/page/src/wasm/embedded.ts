// The modules, unpacked from the page itself and compiled once, however many workers want them.

/** What a module can do: each kind of worker has its own. */
export type ModuleName = "explore" | "drive" | "calibrate";

const compiled = new Map<ModuleName, Promise<WebAssembly.Module>>();

/** A module, compiled when it is first wanted. */
function moduleOf(name: ModuleName): Promise<WebAssembly.Module> {
  const known = compiled.get(name) ?? compile(name);
  compiled.set(name, known);
  return known;
}

/** Compiles while it unpacks. */
function compile(name: ModuleName): Promise<WebAssembly.Module> {
  const element = document.getElementById(`module-${name}`);
  const packed = bytesOf(element?.textContent ?? "");
  element?.remove();
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compileStreaming(new Response(stream, { headers: { "content-type": "application/wasm" } }));
}

/** The letters of windows-1252 that are not numbered as their bytes are, from 128 on. */
const NAMED = "€\x81‚ƒ„…†‡ˆ‰Š‹Œ\x8dŽ\x8f\x90‘’“”•–—˜™š›œ\x9džŸ";
/** What follows this letter is one more than the byte, which HTML would have read as something else. */
const MARK = 16;

/** A byte for each letter, as `build.mjs` wrote them. */
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

/** Starts a worker of its bundled script, with a module as its first message. */
export async function startWorker(source: string, name: ModuleName): Promise<Worker> {
  const place = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const worker = new Worker(place);
  worker.postMessage(await moduleOf(name));
  return worker;
}
