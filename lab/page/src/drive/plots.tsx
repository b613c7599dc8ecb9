// Joints, battery and round trip against time.

import { effect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { dark } from "../shell/theme.tsx";
import { history, link, type Sample } from "./robot.ts";

interface Curve {
  name: string;
  colour: string;
  of(sample: Sample): number | null;
}
interface Chart {
  title: string;
  lines: readonly Curve[];
}

const DEGREES = 180 / Math.PI;
const CHARTS: readonly Chart[] = [
  {
    title: "joints [°]",
    lines: [
      { name: "φ₁", colour: "--accent", of: ({ phi }) => phi[0] * DEGREES },
      { name: "φ₂", colour: "--second", of: ({ phi }) => phi[1] * DEGREES },
    ],
  },
  { title: "battery [V]", lines: [{ name: "battery", colour: "--accent", of: ({ battery }) => battery }] },
  { title: "round trip [ms]", lines: [{ name: "round trip", colour: "--accent", of: ({ trip }) => (trip === null ? null : trip * 1000) }] },
];
const HEIGHT = [150, 90, 90];
/** Interval between two updates, ms: ten per second are fast enough to read. */
const BEAT = 100;

export function Plots() {
  if (link.value.state === "closed") return null;
  return (
    <section class="card plots" aria-label="Plots against time">
      {CHARTS.map((chart, k) => <Plot key={chart.title} chart={chart} height={HEIGHT[k] ?? 90} />)}
    </section>
  );
}

function Plot({ chart, height }: { chart: Chart; height: number }) {
  const place = useRef<HTMLDivElement>(null);
  const isDark = dark.value;
  useEffect(() => {
    const element = place.current;
    if (!element) return;
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    const axis = { stroke: colour("--soft"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false }, font: "11px system-ui" };
    const plot = new uPlot(
      {
        width: Math.max(200, element.clientWidth),
        height,
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false } },
        axes: [{ ...axis, size: 24 }, { ...axis, size: 44 }],
        series: [{}, ...chart.lines.map(({ colour: name }) => ({ stroke: colour(name), width: 1.5, points: { show: false } }))],
      },
      [[], ...chart.lines.map(() => [])],
      element,
    );
    let drawn = 0;
    let waiting: ReturnType<typeof setTimeout> | undefined;
    const draw = () => {
      waiting = undefined;
      drawn = performance.now();
      const samples = history.peek();
      if (element.clientWidth > 0 && element.clientWidth !== plot.width) plot.setSize({ width: element.clientWidth, height });
      plot.setData([samples.map(({ t }) => t), ...chart.lines.map(({ of }) => samples.map(of))]);
    };
    const stop = effect(() => {
      void history.value;
      waiting ??= setTimeout(draw, Math.max(0, BEAT - (performance.now() - drawn)));
    });
    return () => {
      stop();
      clearTimeout(waiting);
      plot.destroy();
    };
  }, [chart, height, isDark]);
  return (
    <figure aria-label={`${chart.title} against time`}>
      <figcaption class="soft">
        {chart.title}
        {chart.lines.length > 1 && chart.lines.map(({ name, colour }) => <span key={name} class="key-of-line" style={{ color: `var(${colour})` }}> — {name}</span>)}
      </figcaption>
      <div ref={place} />
    </figure>
  );
}
