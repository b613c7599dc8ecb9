// Document in the fragment of the URL as compressed JSON, so that a link opens the sender's view.

import { effect } from "@preact/signals";
import { fragment, setFragment } from "../shell/fragment.ts";
import { type Document, FIRST, type Gait, OPTIMA, type Optimum, type Point, shown } from "./document.ts";

const KEY = "explore";
const PLAIN = "open";

async function through(bytes: Uint8Array<ArrayBuffer>, stream: CompressionStream | DecompressionStream): Promise<Uint8Array<ArrayBuffer>> {
  // The reading side reports invalid bytes; the error of the writing side is the same.
  const writer = stream.writable.getWriter();
  const repeated = () => undefined;
  writer.write(bytes).catch(repeated);
  writer.close().catch(repeated);
  const pieces: Uint8Array[] = [];
  const reader = stream.readable.getReader();
  for (let piece = await reader.read(); !piece.done; piece = await reader.read()) pieces.push(piece.value);
  return new Uint8Array(await new Blob(pieces as BlobPart[]).arrayBuffer());
}

export async function packed(document: Document): Promise<string> {
  const bytes = await through(new TextEncoder().encode(JSON.stringify(document)), new CompressionStream("deflate-raw"));
  const text = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

export async function unpacked(text: string): Promise<Document> {
  const bytes = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
  const plain = await through(bytes, new DecompressionStream("deflate-raw"));
  return sound(JSON.parse(new TextDecoder().decode(plain)));
}

/** Valid values of a link; other values have their defaults. A link is untrusted input. */
export function sound(value: unknown): Document {
  if (typeof value !== "object" || value === null) return FIRST;
  const from = value as Record<string, unknown>;
  const number = (value: unknown, [low, high]: [number, number], otherwise: number) =>
    typeof value === "number" && value >= low && value <= high ? value : otherwise;
  const choice = <T>(value: unknown, all: readonly T[], otherwise: T) => (all.includes(value as T) ? (value as T) : otherwise);
  const gaits = Array.isArray(from["gaits"]) ? from["gaits"] : [];
  const changes = Object.entries((from["with"] ?? {}) as object).filter(([key, value]) =>
    ["chi", "sphere_radius_m", "middle_m", "front_m", "back_m", "max_rate_rad_s"].includes(key) && Number.isFinite(value));
  const tank = Array.isArray(from["tank"]) ? from["tank"] : [];
  const second = gaitOf(gaits[1]);
  return {
    swimmer: typeof from["swimmer"] === "string" ? from["swimmer"] : FIRST.swimmer,
    with: Object.fromEntries(changes),
    maxAngle: from["maxAngle"] === null ? null : number(from["maxAngle"], [0.1, 6], FIRST.maxAngle ?? 2.3),
    noOverlap: from["noOverlap"] === true,
    row: choice(from["row"], ["x", "y", "theta"] as const, FIRST.row),
    halfWidth: number(from["halfWidth"], [0.5, 6], FIRST.halfWidth),
    period: number(from["period"], [0.02, 4000], FIRST.period),
    tank: [number(tank[0], [0.1, 100], FIRST.tank[0]), number(tank[1], [0.1, 100], FIRST.tank[1])],
    objective: choice(from["objective"], ["displacement", "efficiency"] as const, FIRST.objective),
    gaits: [gaitOf(gaits[0]) ?? FIRST.gaits[0], second],
    active: from["active"] === 1 && second ? 1 : 0,
    overlaid: OPTIMA.filter((what) => Array.isArray(from["overlaid"]) && from["overlaid"].includes(what)),
  };
}

function gaitOf(value: unknown): Gait | null {
  if (typeof value !== "object" || value === null) return null;
  const from = value as Record<string, unknown>;
  if (from["kind"] === "optimum" && OPTIMA.includes(from["what"] as Optimum)) return { kind: "optimum", what: from["what"] as Optimum };
  if (from["kind"] === "text" && typeof from["text"] === "string") return { kind: "text", name: String(from["name"] ?? "gait"), text: from["text"] };
  const points = from["points"];
  const isPoint = (point: unknown): point is Point => Array.isArray(point) && point.length === 2 && point.every(Number.isFinite);
  if (from["kind"] !== "drawn" || !Array.isArray(points) || points.length < 4 || points.length > 64 || !points.every(isPoint)) return null;
  return { kind: "drawn", points, symmetric: from["symmetric"] === true };
}

/** Link format of reports: the values of the document that differ from the defaults, as plain JSON. */
function openPlain(): void {
  const value = fragment().get(PLAIN);
  if (!value) return;
  setFragment(PLAIN, undefined);
  try {
    shown.value = sound(JSON.parse(value));
  } catch {
    // A truncated link opens the default view.
  }
}

/** Opens the document of the fragment, then updates the fragment shortly after each change. */
export async function followFragment(): Promise<void> {
  const value = fragment().get(KEY);
  if (value) shown.value = await unpacked(value).catch(() => FIRST);
  else openPlain();
  let timer = 0;
  effect(() => {
    const document = shown.value;
    clearTimeout(timer);
    timer = setTimeout(async () => {
      setFragment(KEY, document === FIRST ? undefined : await packed(document));
    }, 300) as unknown as number;
  });
}

/** Copies a link to the present view to the clipboard. */
export async function copyLink(): Promise<string> {
  if (location.protocol === "file:") return "A page on disk has no link for others: save the gait file and the swimmer file, and send those";
  setFragment(KEY, await packed(shown.value));
  try {
    await navigator.clipboard.writeText(location.href);
    return "Link copied";
  } catch {
    return "The link is in the address bar";
  }
}
