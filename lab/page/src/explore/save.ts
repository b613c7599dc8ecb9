// Files of the present view: gait, swimmer, map, motion.

import { applyPalette, GIFEncoder, quantize } from "gifenc";
import { download } from "../files/download.ts";
import { activeGait, shown } from "./document.ts";
import { gaitSource, INTERVALS, motions, quick, swimmer } from "./model.ts";
import { CYCLES, picture } from "./swimming.tsx";

/** Gait file, as `swimmer … -o` writes it; `swimmer simulate` gives the same motion. */
export async function saveGait(): Promise<void> {
  const gait = gaitSource(activeGait(shown.value));
  if (!swimmer.value || !gait) throw new Error("saving the gait: it is still being looked for");
  const bytes = await quick.bytes("gait-file", { swimmer: swimmer.value.toml, gait });
  download("gait.txt", bytes, "text/plain");
}

export function saveSwimmer(): void {
  if (swimmer.value) download("swimmer.toml", swimmer.value.toml, "application/toml");
}

/** Path of one cycle in the format of `swimmer simulate --trajectory`. */
export function saveTable(): void {
  const motion = motions.value[shown.value.active];
  if (!motion) throw new Error("saving the motion: it is not there yet");
  const lines = ["cycle,u,phi1_rad,phi2_rad,x_m,y_m,theta_rad"];
  const stride = motion.length / (INTERVALS + 1);
  for (let k = 0; k <= INTERVALS; k++) lines.push([0, ...motion.slice(k * stride, k * stride + 6)].join(","));
  download("motion.csv", `${lines.join("\n")}\n`, "text/csv");
}

/** Copies the relevant styles of the map onto a copy of its elements. */
function standalone(): { text: string; side: number } {
  const svg = document.getElementById("map");
  const heights = document.getElementById("heights");
  if (!(svg instanceof SVGSVGElement) || !(heights instanceof HTMLCanvasElement)) throw new Error("saving the map: it is not there");
  const copy = svg.cloneNode(true) as SVGSVGElement;
  const originals = svg.querySelectorAll<SVGElement>("path, text, circle");
  copy.querySelectorAll<SVGElement>("path, text, circle").forEach((element, k) => {
    const original = originals[k];
    if (!original) return;
    const style = getComputedStyle(original);
    for (const name of ["fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "vector-effect", "font-family"]) {
      element.setAttribute(name, style.getPropertyValue(name));
    }
    element.removeAttribute("tabindex");
  });
  const side = 900;
  const d = shown.value.halfWidth;
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("width", `${side}`);
  copy.setAttribute("height", `${side}`);
  const image = document.createElementNS("http://www.w3.org/2000/svg", "image");
  for (const [name, value] of Object.entries({ href: heights.toDataURL(), x: -d, y: -d, width: 2 * d, height: 2 * d })) {
    image.setAttribute(name, `${value}`);
  }
  copy.prepend(image);
  return { text: new XMLSerializer().serializeToString(copy), side };
}

export function saveSvg(): void {
  download("height-map.svg", standalone().text, "image/svg+xml");
}

export async function savePng(): Promise<void> {
  const { text, side } = standalone();
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = side;
  canvas.getContext("2d")?.drawImage(image, 0, 0);
  const blob = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png"));
  if (!blob) throw new Error("saving the map: the browser made no picture of it");
  download("height-map.png", blob, "image/png");
}

/** Canvas for an animation of all cycles, and its duration in seconds. */
function film(width: number, height: number): { context: CanvasRenderingContext2D; seconds: number } {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) throw new Error("saving the motion: the browser gave no canvas");
  return { context, seconds: 2 * CYCLES };
}

/** Frames per second of a GIF; the format counts in hundredths of a second. */
const PICTURES = 12.5;

/** Animation of all cycles as a GIF. */
export async function saveGif(): Promise<void> {
  const [width, height] = [640, 320];
  const { context, seconds } = film(width, height);
  const count = Math.round(seconds * PICTURES);
  const drawn = (k: number) => {
    picture(context, (k / count) * CYCLES, width, height);
    return context.getImageData(0, 0, width, height).data;
  };
  // All frames have the colours of the page.
  const palette = quantize(drawn(Math.round(count / 2)), 64);
  const gif = GIFEncoder();
  for (let k = 0; k < count; k++) {
    gif.writeFrame(applyPalette(drawn(k), palette), width, height, { palette: k === 0 ? palette : undefined, delay: 1000 / PICTURES });
    if (k % 8 === 0) await new Promise((resolve) => setTimeout(resolve));
  }
  gif.finish();
  download("motion.gif", new Uint8Array(gif.bytes()), "image/gif");
}

/** Animation of all cycles, recorded by the browser in real time. */
export async function saveVideo(): Promise<void> {
  const type = ["video/webm;codecs=vp9", "video/webm"].find((each) => MediaRecorder.isTypeSupported(each));
  if (!type) throw new Error("saving the motion: this browser records no WebM");
  const { context, seconds } = film(960, 480);
  const { canvas } = context;
  const recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: type, videoBitsPerSecond: 4_000_000 });
  const pieces: Blob[] = [];
  recorder.ondataavailable = ({ data }) => pieces.push(data);
  const stopped = new Promise((resolve) => (recorder.onstop = resolve));
  recorder.start();
  const begun = performance.now();
  await new Promise<void>((resolve) => {
    const step = (now: number) => {
      const at = Math.max(0, (now - begun) / 1000 / seconds);
      picture(context, Math.min(at, 1 - 1e-6) * CYCLES, canvas.width, canvas.height);
      if (at < 1) requestAnimationFrame(step);
      else resolve();
    };
    requestAnimationFrame(step);
  });
  recorder.stop();
  await stopped;
  download("motion.webm", new Blob(pieces, { type }), type);
}
