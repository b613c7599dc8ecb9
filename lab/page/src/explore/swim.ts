// Drawing of the swimmer on a canvas: path, trail, body, and force of the fluid along it.

import { INTERVALS } from "./model.ts";

/** Numbers per instant in the output of the module's call `motion`. */
const STRIDE = 26;

export interface Ink {
  paper: string;
  line: string;
  soft: string;
  bodies: readonly [string, string];
  force: string;
}

/** Present colours of the page. */
export function ink(): Ink {
  const style = getComputedStyle(document.documentElement);
  const of = (name: string) => style.getPropertyValue(name).trim();
  return { paper: of("--paper"), line: of("--line"), soft: of("--soft"), bodies: [of("--gait-a"), of("--gait-b")], force: of("--good") };
}

interface Frame {
  left: number;
  top: number;
  scale: number;
}

/** Bounding box of all cycles of all motions, with a margin. */
function frame(motions: readonly Float64Array[], cycles: number, width: number, height: number): Frame {
  let [x0, x1, y0, y1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const motion of motions) {
    for (let cycle = 0; cycle < cycles; cycle++) {
      const place = start(motion, cycle);
      for (let k = 0; k <= INTERVALS; k += 8) {
        for (let corner = 0; corner < 4; corner++) {
          const at = k * STRIDE + 6 + 2 * corner;
          const [x, y] = place(motion[at] ?? 0, motion[at + 1] ?? 0);
          [x0, x1, y0, y1] = [Math.min(x0, x), Math.max(x1, x), Math.min(y0, y), Math.max(y1, y)];
        }
      }
    }
  }
  const scale = 0.88 * Math.min(width / (x1 - x0), height / (y1 - y0));
  return { left: (x0 + x1) / 2 - width / 2 / scale, top: (y0 + y1) / 2 + height / 2 / scale, scale };
}

/** Maps a point of the first cycle to a later one; each cycle begins at the final pose of the previous one. */
function start(motion: Float64Array, cycle: number): (x: number, y: number) => [number, number] {
  const end = INTERVALS * STRIDE;
  const [dx, dy, turn] = [motion[end + 3] ?? 0, motion[end + 4] ?? 0, motion[end + 5] ?? 0];
  let [x, y, theta] = [0, 0, 0];
  for (let k = 0; k < cycle; k++) {
    [x, y] = [x + Math.cos(theta) * dx - Math.sin(theta) * dy, y + Math.sin(theta) * dx + Math.cos(theta) * dy];
    theta += turn;
  }
  const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
  return (px, py) => [x + cos * px - sin * py, y + sin * px + cos * py];
}

/** Draws all motions at a time counted in cycles; the whole is `cycles` long. */
export function drawSwim(
  context: CanvasRenderingContext2D,
  motions: readonly (Float64Array | null)[],
  time: number,
  cycles: number,
  size: { width: number; height: number; sphere: number; forces: boolean },
  colours: Ink,
): void {
  const { width, height } = size;
  context.fillStyle = colours.paper;
  context.fillRect(0, 0, width, height);
  const there = motions.filter((motion) => motion !== null);
  if (there.length === 0) return;
  const view = frame(there, cycles, width, height);
  const screen = ([x, y]: [number, number]): [number, number] => [(x - view.left) * view.scale, (view.top - y) * view.scale];
  motions.forEach((motion, slot) => {
    if (!motion) return;
    const colour = colours.bodies[slot === 1 ? 1 : 0];
    trail(context, motion, time, screen, colour);
    body(context, motion, time, screen, colour, size.sphere * view.scale);
    if (size.forces) forces(context, motion, time, screen, colours.force, there, view.scale);
  });
  scaleBar(context, view.scale, height, colours);
}

type Screen = (point: [number, number]) => [number, number];

function instant(motion: Float64Array, time: number): { at: number; place: ReturnType<typeof start> } {
  const cycle = Math.floor(time);
  const k = Math.min(INTERVALS, Math.round((time - cycle) * INTERVALS));
  return { at: k * STRIDE, place: start(motion, cycle) };
}

function trail(context: CanvasRenderingContext2D, motion: Float64Array, time: number, screen: Screen, colour: string): void {
  context.beginPath();
  for (let cycle = 0; cycle <= Math.floor(time); cycle++) {
    const place = start(motion, cycle);
    const until = cycle === Math.floor(time) ? Math.round((time - cycle) * INTERVALS) : INTERVALS;
    for (let k = 0; k <= until; k++) {
      const point = screen(place(motion[k * STRIDE + 3] ?? 0, motion[k * STRIDE + 4] ?? 0));
      if (k === 0 && cycle === 0) context.moveTo(...point);
      else context.lineTo(...point);
    }
  }
  context.globalAlpha = 0.45;
  context.lineWidth = 1.5;
  context.strokeStyle = colour;
  context.stroke();
  context.globalAlpha = 1;
}

function body(context: CanvasRenderingContext2D, motion: Float64Array, time: number, screen: Screen, colour: string, radius: number): void {
  const { at, place } = instant(motion, time);
  const corners = [0, 1, 2, 3].map((corner) => screen(place(motion[at + 6 + 2 * corner] ?? 0, motion[at + 7 + 2 * corner] ?? 0)));
  context.strokeStyle = context.fillStyle = colour;
  context.lineCap = context.lineJoin = "round";
  if (radius > 0) {
    context.globalAlpha = 0.18;
    context.beginPath();
    context.arc(...screen(place(motion[at + 3] ?? 0, motion[at + 4] ?? 0)), radius, 0, 2 * Math.PI);
    context.fill();
    context.globalAlpha = 1;
  }
  context.lineWidth = 5;
  context.beginPath();
  corners.forEach((corner, k) => (k ? context.lineTo(...corner) : context.moveTo(...corner)));
  context.stroke();
  context.beginPath();
  const tip = corners[3] ?? [0, 0];
  context.arc(...tip, 4.5, 0, 2 * Math.PI); // the front
  context.fill();
}

/** Arrows of force per length along each link: the longest of the cycle is a fifth of the body. */
function forces(
  context: CanvasRenderingContext2D,
  motion: Float64Array,
  time: number,
  screen: Screen,
  colour: string,
  all: readonly Float64Array[],
  scale: number,
): void {
  const { at, place } = instant(motion, time);
  let [most, length] = [1e-12, 0];
  for (const one of all) {
    for (let k = 0; k <= INTERVALS; k += 4) {
      for (let f = 0; f < 12; f += 2) most = Math.max(most, Math.hypot(one[k * STRIDE + 14 + f] ?? 0, one[k * STRIDE + 15 + f] ?? 0));
    }
    for (let corner = 0; corner < 3; corner++) length += Math.hypot((one[8 + 2 * corner] ?? 0) - (one[6 + 2 * corner] ?? 0), (one[9 + 2 * corner] ?? 0) - (one[7 + 2 * corner] ?? 0)) / all.length;
  }
  const long = (0.2 * length) / most;
  context.strokeStyle = colour;
  context.lineWidth = 1.2;
  const origin = place(0, 0);
  for (let link = 0; link < 3; link++) {
    for (let k = 0; k <= 4; k++) {
      const t = k / 4;
      const mix = (from: number, to: number) => (motion[at + from] ?? 0) * (1 - t) + (motion[at + to] ?? 0) * t;
      const root = place(mix(6 + 2 * link, 8 + 2 * link), mix(7 + 2 * link, 9 + 2 * link));
      const force = place(mix(14 + 4 * link, 16 + 4 * link), mix(15 + 4 * link, 17 + 4 * link));
      const [fx, fy] = [(force[0] - origin[0]) * long, (force[1] - origin[1]) * long];
      arrow(context, screen(root), screen([root[0] + fx, root[1] + fy]), Math.min(5, Math.hypot(fx, fy) * scale * 0.4));
    }
  }
}

function arrow(context: CanvasRenderingContext2D, [x, y]: [number, number], [tx, ty]: [number, number], head: number): void {
  const angle = Math.atan2(ty - y, tx - x);
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(tx, ty);
  for (const side of [-0.5, 0.5]) {
    context.moveTo(tx, ty);
    context.lineTo(tx - head * Math.cos(angle + side), ty - head * Math.sin(angle + side));
  }
  context.stroke();
}

/** Draws the scale bar on a translucent background. */
function scaleBar(context: CanvasRenderingContext2D, scale: number, height: number, colours: Ink): void {
  const power = 10 ** Math.floor(Math.log10(90 / scale));
  const long = ([5, 2, 1].find((digit) => digit * power * scale <= 110) ?? 1) * power;
  context.globalAlpha = 0.7;
  context.fillStyle = colours.paper;
  context.fillRect(6, height - 34, long * scale + 12, 28);
  context.globalAlpha = 1;
  context.strokeStyle = context.fillStyle = colours.soft;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(12, height - 12);
  context.lineTo(12 + long * scale, height - 12);
  context.stroke();
  context.font = "12px system-ui, sans-serif";
  context.fillText(long < 1 ? `${Math.round(long * 1000)} mm` : `${long} m`, 12, height - 18);
}
