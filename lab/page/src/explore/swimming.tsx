// Animation of the swimmer: play and pause, real or fast time, position in the cycle, forces on and off.

import { effect, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { dark } from "../shell/theme.tsx";
import { shown } from "./document.ts";
import { motions, swimmer } from "./model.ts";
import { figure } from "./names.ts";
import { drawSwim, ink } from "./swim.ts";

/** Number of cycles before the animation repeats. */
export const CYCLES = 3;
const SPEEDS = [1, 4, 16] as const;

const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
export const playing = signal(!calm);
/** In cycles, from 0 to [`CYCLES`]. */
export const time = signal(0);
const speed = signal<(typeof SPEEDS)[number]>(16);
const forces = signal(true);

/** Data of an animation. */
export function picture(context: CanvasRenderingContext2D, at: number, width: number, height: number): void {
  const sphere = swimmer.peek()?.sphere_radius_m ?? 0;
  drawSwim(context, motions.peek(), at, CYCLES, { width, height, sphere, forces: forces.peek() }, ink());
}

export function Swimming() {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (!context) return;
    const redraw = () => {
      const box = context.canvas.getBoundingClientRect();
      const ratio = devicePixelRatio;
      if (box.width === 0) return;
      const [width, height] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
      if (context.canvas.width !== width || context.canvas.height !== height) {
        context.canvas.width = width;
        context.canvas.height = height;
      }
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      picture(context, time.peek(), box.width, box.height);
    };
    const stop = effect(() => {
      void [time.value, motions.value, dark.value, forces.value, swimmer.value];
      redraw();
    });
    const sizes = new ResizeObserver(redraw);
    sizes.observe(context.canvas);
    let frame = 0;
    let before = performance.now();
    const step = (now: number) => {
      const passed = (now - before) / 1000;
      before = now;
      if (playing.peek() && context.canvas.offsetParent) {
        time.value = (time.peek() + (passed * speed.peek()) / shown.peek().period) % CYCLES;
      }
      frame = requestAnimationFrame(step);
    };
    frame = requestAnimationFrame(step);
    return () => {
      stop();
      sizes.disconnect();
      cancelAnimationFrame(frame);
    };
  }, []);
  return (
    <section class="card swimming" aria-label="The swimmer in motion">
      <canvas ref={canvas} id="swim" role="img" aria-label="The swimmer along its path, with the force of the fluid" />
      <div class="bar-of-buttons">
        <button onClick={() => (playing.value = !playing.value)} title="Play or pause (K)">{playing.value ? "Pause" : "Play"}</button>
        <input
          type="range"
          min={0}
          max={CYCLES}
          step={0.005}
          value={time.value}
          aria-label="Place in the cycles"
          aria-valuetext={`cycle ${figure(time.value, 2)}`}
          onInput={(event) => {
            playing.value = false;
            time.value = Math.min(event.currentTarget.valueAsNumber, CYCLES - 1e-6);
          }}
        />
        <select aria-label="Speed" value={speed.value} onChange={(event) => (speed.value = Number(event.currentTarget.value) as 1 | 4 | 16)}>
          {SPEEDS.map((each) => <option key={each} value={each}>{each === 1 ? "real time" : `${each} ×`}</option>)}
        </select>
        <label class="check"><input type="checkbox" checked={forces.value} onChange={() => (forces.value = !forces.value)} /> forces</label>
      </div>
    </section>
  );
}
