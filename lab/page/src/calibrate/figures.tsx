// The figures of a calibration: X over the amplitude, the ridge of r_s and χ, the ways that were swum.

import type { ComponentChildren } from "preact";
import type { CurvePoint, EvidenceAnswer, Run } from "./answers.ts";

const [WIDTH, HEIGHT] = [420, 300];
const MARGIN = { left: 64, right: 12, top: 10, bottom: 40 };

interface Scale {
  x(value: number): number;
  y(value: number): number;
  ticks: [number[], number[]];
}

/** Round numbers that divide a range into about five. */
function rounded(low: number, high: number): number[] {
  const raw = (high - low) / 5 || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find((digit) => digit * power >= raw) ?? 10);
  const first = Math.ceil(low / step);
  return Array.from({ length: Math.floor(high / step) - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(6)));
}

function scale(xs: readonly number[], ys: readonly number[], room = 0.05): Scale {
  const ends = (values: readonly number[]): [number, number] => {
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const more = (high - low || Math.abs(high) || 1) * room;
    return [low - more, high + more];
  };
  const [[x0, x1], [y0, y1]] = [ends(xs), ends(ys)];
  return {
    x: (value) => MARGIN.left + ((value - x0) / (x1 - x0)) * (WIDTH - MARGIN.left - MARGIN.right),
    y: (value) => HEIGHT - MARGIN.bottom - ((value - y0) / (y1 - y0)) * (HEIGHT - MARGIN.top - MARGIN.bottom),
    ticks: [rounded(x0, x1), rounded(y0, y1)],
  };
}

function Chart({ title, names, to, children }: { title: string; names: [string, string]; to: Scale; children: ComponentChildren }) {
  const [bottom, left] = [HEIGHT - MARGIN.bottom, MARGIN.left];
  return (
    <section class="card" aria-label={title}>
      <h2>{title}</h2>
      <svg class="chart" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={title}>
        {to.ticks[0].map((tick) => (
          <g key={tick}><path class="grid" d={`M${to.x(tick)} ${MARGIN.top}V${bottom}`} /><text x={to.x(tick)} y={bottom + 14} text-anchor="middle">{tick}</text></g>
        ))}
        {to.ticks[1].map((tick) => (
          <g key={tick}><path class="grid" d={`M${left} ${to.y(tick)}H${WIDTH - MARGIN.right}`} /><text x={left - 5} y={to.y(tick) + 4} text-anchor="end">{tick}</text></g>
        ))}
        <text x={(left + WIDTH - MARGIN.right) / 2} y={HEIGHT - 6} text-anchor="middle">{names[0]}</text>
        <text transform={`translate(11 ${(MARGIN.top + bottom) / 2}) rotate(-90)`} text-anchor="middle">{names[1]}</text>
        {children}
      </svg>
    </section>
  );
}

const line = (points: readonly (readonly [number, number])[], to: Scale) =>
  points.map(([x, y], k) => `${k ? "L" : "M"}${to.x(x).toFixed(1)} ${to.y(y).toFixed(1)}`).join("");

const degrees = (radians: number) => (radians * 180) / Math.PI;

/** A gait as people say it: circles in whole degrees. */
export function named(run: Run): string {
  if (run.amplitude_rad === null) return run.gait.split("/").pop() ?? run.gait;
  return `circle ${Number(degrees(run.amplitude_rad).toFixed(2))}°${run.clockwise ? " clockwise" : ""}`;
}

/** A quantity of a circle's cycle: its name, and where runs and curves have it, in the unit of the name. */
interface OfACircle {
  title: string;
  name: string;
  measured(run: Run): readonly [value: number, sd: number];
  foretold(point: CurvePoint): number;
}

const OF_A_CIRCLE: readonly OfACircle[] = [
  {
    title: "X over the amplitude",
    name: "X [mm]",
    measured: (run) => [run.x_m * (run.clockwise ? -1000 : 1000), (run.x_sd_m ?? 0) * 1000],
    foretold: (point) => point.x_m * 1000,
  },
  {
    title: "ΔY over the amplitude",
    name: "ΔY [mm]",
    measured: (run) => [run.delta_y_m * 1000, (run.delta_y_sd_m ?? 0) * 1000],
    foretold: (point) => point.delta_y_m * 1000,
  },
  {
    title: "Δθ over the amplitude",
    name: "Δθ [°]",
    measured: (run) => [degrees(run.delta_theta_rad), degrees(run.delta_theta_sd_rad ?? 0)],
    foretold: (point) => degrees(point.delta_theta_rad),
  },
];

/** What circles measure, with twice its standard deviation, and what the model makes of them. */
export function OverAmplitude({ runs, evidence }: { runs: readonly Run[]; evidence: EvidenceAnswer | null }) {
  return <>{OF_A_CIRCLE.map((quantity) => <OneOverAmplitude key={quantity.title} of={quantity} runs={runs} evidence={evidence} />)}</>;
}

function OneOverAmplitude({ of, runs, evidence }: { of: OfACircle; runs: readonly Run[]; evidence: EvidenceAnswer | null }) {
  const measured = runs.flatMap((run) => (run.amplitude_rad === null ? [] : [[degrees(run.amplitude_rad), ...of.measured(run)] as const]));
  const curve = (points: readonly CurvePoint[]) => points.map((point) => [degrees(point.amplitude_rad), of.foretold(point)] as const);
  const fitted = evidence ? curve(evidence.fitted_curve) : [];
  const start = evidence ? curve(evidence.start_curve) : [];
  const all = [...measured.map(([x, y]) => [x, y] as const), ...fitted];
  if (all.length === 0) return null;
  const to = scale(all.map(([x]) => x), all.map(([, y]) => y));
  return (
    <Chart title={of.title} names={["amplitude ε [°]", of.name]} to={to}>
      <path class="curve faint" d={line(start, to)} />
      <path class="curve" d={line(fitted, to)} />
      {measured.map(([x, y, sd], k) => (
        <g key={k} class="measured">
          <path d={`M${to.x(x)} ${to.y(y - 2 * sd)}V${to.y(y + 2 * sd)}`} />
          <circle cx={to.x(x)} cy={to.y(y)} r="3.5"><title>{`${x.toFixed(0)}°: ${y.toFixed(2)}`}</title></circle>
        </g>
      ))}
    </Chart>
  );
}

/** How far the likelihood falls as one parameter is held elsewhere, and where its interval ends. */
export function Profiles({ evidence }: { evidence: EvidenceAnswer }) {
  const names = ["rₛ [mm]", "χ"];
  return (
    <>
      {evidence.profiles.map(({ points, threshold }, k) => {
        const scaled = points.map(([value, height]) => [k === 0 ? value * 1000 : value, height] as const);
        const near = scaled.filter(([, height]) => height >= 3 * threshold);
        if (near.length < 2) return null;
        const to = scale(near.map(([value]) => value), near.map(([, height]) => height));
        return (
          <Chart key={names[k]} title={`Profile of ${names[k]?.split(" ")[0]}`} names={[names[k] ?? "", "ln likelihood below its top"]} to={to}>
            <path class="curve" d={line(near, to)} />
            <path class="curve faint" d={`M${MARGIN.left} ${to.y(threshold)}H${WIDTH - MARGIN.right}`} />
          </Chart>
        );
      })}
    </>
  );
}

/** The displacement of every cycle that counts, run by run. */
export function Cycles({ runs }: { runs: readonly Run[] }) {
  const known = runs.filter((run) => run.each.length > 0);
  if (known.length === 0) return null;
  return (
    <section class="card scroll" aria-label="Cycles">
      <h2>Cycles</h2>
      <table class="readout" id="cycles">
        <thead><tr>{["run", "period [s]", "X of each [mm], its start [s] below"].map((name) => <th key={name} scope="col">{name}</th>)}</tr></thead>
        <tbody>
          {known.map((run) => (
            <tr key={run.file}>
              <th scope="row">{run.file.split("/").pop()}</th>
              <td>{run.period_s.toFixed(2)}</td>
              <td class="each">
                {run.each.map(([start, x]) => <span key={start}>{(x * 1000).toFixed(2)}<small class="soft">{start.toFixed(1)}</small></span>)}
                {run.left_out.map(({ what, reason }) => <span key={what} class="out" title={reason}>–<small class="soft">{what}</small></span>)}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

/** Joint regions of r_s and χ: long and thin, because each makes up for the other. */
export function Ridge({ evidence }: { evidence: EvidenceAnswer }) {
  const regions = [...evidence.ridge].sort((a, b) => b.level - a.level);
  const corners = regions.flatMap((region) => region.corners);
  if (corners.length === 0) return null;
  const to = scale(corners.map(([radius]) => radius * 1000), corners.map(([, chi]) => chi));
  return (
    <Chart title="Ridge of rₛ and χ" names={["rₛ [mm]", "χ"]} to={to}>
      {regions.map(({ level, corners }, k) => (
        <path key={level} class={`region within-${k}`} d={`${line(corners.map(([radius, chi]) => [radius * 1000, chi] as const), to)}Z`}>
          <title>{`${Math.round(level * 100)} %`}</title>
        </path>
      ))}
      <g class="measured"><circle cx={to.x(evidence.sphere_radius_m * 1000)} cy={to.y(evidence.chi)} r="4"><title>likeliest</title></circle></g>
      <text x={WIDTH - MARGIN.right - 4} y={MARGIN.top + 14} text-anchor="end">{regions.map(({ level }) => `${Math.round(level * 100)} %`).join(", ")}</text>
    </Chart>
  );
}

/** The middle link's way in every run. */
export function Paths({ runs }: { runs: readonly Run[] }) {
  const swum = runs.filter((run) => run.path.length > 0);
  if (swum.length === 0) return null;
  return (
    <section class="card" aria-label="Tracks">
      <h2>Tracks</h2>
      <div class="paths">
        {swum.map((run) => {
          const [xs, ys] = [run.path.map(([x]) => x), run.path.map(([, y]) => -y)];
          const [x0, y0] = [Math.min(...xs), Math.min(...ys)];
          const side = Math.max(Math.max(...xs) - x0, Math.max(...ys) - y0) || 1;
          const d = run.path.map(([x, y], k) => `${k ? "L" : "M"}${((x - x0) / side).toFixed(4)} ${((-y - y0) / side).toFixed(4)}`).join("");
          return (
            <figure key={run.file}>
              <svg class="chart" viewBox="-0.04 -0.04 1.08 1.08" role="img" aria-label={`Track of ${run.file}`}><path class="curve" d={d} /></svg>
              <figcaption class="soft">{named(run)}, {(side * 1000).toFixed(0)} mm</figcaption>
            </figure>
          );
        })}
      </div>
    </section>
  );
}
