// Joint angles and displacement over the cycle.

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { dark } from "../shell/theme.tsx";
import { shown } from "./document.ts";
import { INTERVALS, motions } from "./model.ts";
import { ink } from "./swim.ts";

const STRIDE = 26;

interface Series {
  name: string;
  column: number;
  factor: number;
  dash?: number[];
}

const PLOTS: readonly { title: string; series: readonly Series[] }[] = [
  { title: "joint angles [°]", series: [{ name: "φ₁", column: 1, factor: 180 / Math.PI }, { name: "φ₂", column: 2, factor: 180 / Math.PI, dash: [5, 4] }] },
  { title: "x, y [mm]", series: [{ name: "x", column: 3, factor: 1000 }, { name: "y", column: 4, factor: 1000, dash: [5, 4] }] },
];

export function Plots() {
  return (
    <section class="card plots" aria-label="Over the cycle">
      {PLOTS.map((plot) => <Plot key={plot.title} {...plot} />)}
    </section>
  );
}

function Plot({ title, series }: (typeof PLOTS)[number]) {
  const place = useRef<HTMLDivElement>(null);
  const motion = motions.value[shown.value.active] ?? motions.value[0];
  const second = shown.value.active === 1;
  const plot = useRef<uPlot>();
  useEffect(() => {
    if (!place.current) return;
    const colours = ink();
    const axis = { stroke: colours.soft, grid: { stroke: colours.line, width: 1 }, ticks: { stroke: colours.line, width: 1 }, font: "11px system-ui", size: 42 };
    plot.current = new uPlot(
      {
        width: place.current.clientWidth,
        height: 150,
        title,
        cursor: { y: false },
        legend: { live: false },
        scales: { x: { time: false } },
        axes: [{ ...axis, size: 26 }, { ...axis, space: 22 }],
        series: [
          { label: "t [s]" },
          ...series.map(({ name, dash }) => ({ label: name, stroke: colours.bodies[second ? 1 : 0], width: 1.6, ...(dash ? { dash } : {}) })),
        ],
      },
      [[], ...series.map(() => [])],
      place.current,
    );
    const sizes = new ResizeObserver(() => place.current && plot.current?.setSize({ width: place.current.clientWidth, height: 150 }));
    sizes.observe(place.current);
    return () => {
      sizes.disconnect();
      plot.current?.destroy();
    };
  }, [dark.value, second]);
  useEffect(() => {
    if (!motion) return;
    const column = (at: number, factor: number) => Array.from({ length: INTERVALS + 1 }, (_, k) => (motion[k * STRIDE + at] ?? 0) * factor);
    plot.current?.setData([column(0, shown.value.period), ...series.map(({ column: at, factor }) => column(at, factor))]);
  }, [motion, shown.value.period, dark.value, second]);
  return (
    <figure aria-label={`${title} over the cycle`}>
      <div ref={place} />
    </figure>
  );
}
