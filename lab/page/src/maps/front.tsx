// Pareto front: designs that no other one beats in both speed and efficiency.

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import { ink } from "../explore/swim.ts";
import { dark } from "../shell/theme.tsx";
import type { SweepMap } from "./export.ts";

export function Front({ points }: { points: SweepMap["pareto"] }) {
  const place = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (!place.current) return;
    const colours = ink();
    const axis = { stroke: colours.soft, grid: { stroke: colours.line, width: 1 }, ticks: { stroke: colours.line, width: 1 }, font: "11px system-ui" };
    const sorted = [...points].sort((a, b) => a.speed - b.speed);
    const plot = new uPlot(
      {
        width: place.current.clientWidth,
        height: 320,
        title: "Pareto set",
        legend: { show: false },
        scales: { x: { time: false } },
        axes: [{ ...axis, label: "speed [L/s]" }, { ...axis, label: "efficiency ξ", size: 64 }],
        series: [{ label: "speed [L/s]" }, { label: "ξ", stroke: colours.bodies[0], width: 1, points: { show: true, size: 5 } }],
      },
      [sorted.map(({ speed }) => speed), sorted.map(({ efficiency }) => efficiency)],
      place.current,
    );
    return () => plot.destroy();
  }, [points, dark.value]);
  return <section class="card plots" aria-label="Pareto set of speed and efficiency"><div ref={place} id="pareto" /></section>;
}
