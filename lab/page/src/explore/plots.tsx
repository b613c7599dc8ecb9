// Joint angles and displacement over the cycle.

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { dark } from "../shell/theme.tsx";
import { shown } from "./document.ts";
import { INTERVALS, motions } from "./model.ts";
import { unit } from "./names.ts";
import { ink } from "./swim.ts";

const STRIDE = 26;

interface Series {
  name: string;
  column: number;
  factor: number;
  dash?: number[];
}

type PlotProps = { title: string; series: readonly Series[] };

const angles = (factor: number): readonly Series[] => [{ name: "front φ₁", column: 1, factor }, { name: "back φ₂", column: 2, factor, dash: [5, 4] }];
const PLOTS: readonly (() => PlotProps)[] = [
  () => (unit.value === "°" ? { title: "joint angles [°]", series: angles(180 / Math.PI) } : { title: "joint angles [rad]", series: angles(1) }),
  () => ({ title: "middle link [mm]", series: [{ name: "along x", column: 3, factor: 1000 }, { name: "across y", column: 4, factor: 1000, dash: [5, 4] }] }),
];

export function Plots() {
  return (
    <section class="card plots" aria-label="Over the cycle">
      {PLOTS.map((plot) => plot()).map((plot) => <Plot key={plot.title} {...plot} />)}
    </section>
  );
}

function Plot({ title, series }: PlotProps) {
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
