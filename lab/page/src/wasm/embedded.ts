// The modules' bytes, unpacked from the page itself.

/** What a module can do: each kind of worker has its own. */
export type ModuleName = "explore" | "drive" | "calibrate";

/** Whether the page was built with a module. */
export const hasModule = (name: ModuleName) => document.getElementById(`module-${name}`) !== null;

const unpacked = new Map<ModuleName, Promise<ArrayBuffer>>();

/** A module as it was built; unpacked once, however many workers want it. */
export function moduleBytes(name: ModuleName): Promise<ArrayBuffer> {
  const known = unpacked.get(name) ?? unpack(name);
  unpacked.set(name, known);
  return known;
}

async function unpack(name: ModuleName): Promise<ArrayBuffer> {
  const text = document.getElementById(`module-${name}`)?.textContent ?? "";
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** Starts a worker of its bundled script, with a copy of a module as its first message. */
export async function startWorker(source: string, name: ModuleName): Promise<Worker> {
  const place = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const worker = new Worker(place);
  worker.postMessage((await moduleBytes(name)).slice(0));
  return worker;
}
