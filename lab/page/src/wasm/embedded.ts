// The module's bytes, unpacked from the page itself.

let unpacked: Promise<ArrayBuffer> | undefined;

/** The module as it was built; unpacked once, however many workers want it. */
export function moduleBytes(): Promise<ArrayBuffer> {
  unpacked ??= unpack();
  return unpacked;
}

async function unpack(): Promise<ArrayBuffer> {
  const text = document.getElementById("module")?.textContent ?? "";
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** Starts a worker of its bundled script, with a copy of the module as its first message. */
export async function startWorker(source: string): Promise<Worker> {
  const place = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const worker = new Worker(place);
  worker.postMessage((await moduleBytes()).slice(0));
  return worker;
}
