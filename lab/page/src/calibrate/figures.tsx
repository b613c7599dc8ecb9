// Figures of a calibration: results over the amplitude, profiles, ridge of r_s and χ, influence of single runs, paths of the swimmer.

import { useMemo } from "preact/hooks";
import type { Pair, Profile as ProfileOutput } from "../contracts.ts";
import type { CurvePoint, EvidenceOutput, Run } from "./outputs.ts";
import { Chart, degrees, Dots, HEIGHT, line, MARGIN, scale, type Scale, WIDTH } from "./chart.tsx";

/** Name of a file without its folders. */
export const short = (file: string) => file.split("/").pop() ?? file;

/** Display name of a gait: circles in whole degrees. */
export function named(run: Run): string {
  if (run.amplitude_rad === null) return short(run.gait);
  return `circle ${Number(degrees(run.amplitude_rad).toFixed(2))}°${run.clockwise ? " clockwise" : ""}`;
}

/** Quantity of a circle's cycle: its name, and accessors for runs and curves in the unit of the name. */
interface OfACircle {
  title: string;
  name: string;
  measured(run: Run): readonly [value: number, sd: number];
  predicted(point: CurvePoint): number;
}

const OF_A_CIRCLE: readonly OfACircle[] = [
  {
    title: "X over the amplitude",
    name: "displacement X [mm]",
    measured: (run) => [run.x_m * (run.clockwise ? -1000 : 1000), (run.x_sd_m ?? 0) * 1000],
    predicted: (point) => point.x_m * 1000,
  },
  {
    title: "ΔY over the amplitude",
    name: "sway ΔY [mm]",
    measured: (run) => [run.delta_y_m * 1000, (run.delta_y_sd_m ?? 0) * 1000],
    predicted: (point) => point.delta_y_m * 1000,
  },
  {
    title: "Δθ over the amplitude",
    name: "yaw Δθ [°]",
    measured: (run) => [degrees(run.delta_theta_rad), degrees(run.delta_theta_sd_rad ?? 0)],
    predicted: (point) => degrees(point.delta_theta_rad),
  },
];

/** Measured values of circles, with twice their standard deviation, and the values of the model. */
export function OverAmplitude({ runs, evidence }: { runs: readonly Run[]; evidence: EvidenceOutput | null }) {
  return <>{OF_A_CIRCLE.map((quantity) => <OneOverAmplitude key={quantity.title} of={quantity} runs={runs} evidence={evidence} />)}</>;
}

function OneOverAmplitude({ of, runs, evidence }: { of: OfACircle; runs: readonly Run[]; evidence: EvidenceOutput | null }) {
  const measured = runs.flatMap((run) => (run.amplitude_rad === null ? [] : [[degrees(run.amplitude_rad), ...of.measured(run)] as const]));
  const curve = (points: readonly CurvePoint[]) => points.map((point) => [degrees(point.amplitude_rad), of.predicted(point)] as const);
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

/** Profile likelihood of one parameter, and the ends of its interval. */
export function Profiles({ evidence: { profiles } }: { evidence: EvidenceOutput }) {
  return (
    <>
      <Profile title="Profile of rₛ" name="sphere radius rₛ [mm]" of={profiles.sphere_radius_m} factor={1000} />
      <Profile title="Profile of χ" name="drag ratio χ" of={profiles.chi} factor={1} />
    </>
  );
}

function Profile({ title, name, of: { points, threshold }, factor }: { title: string; name: string; of: ProfileOutput; factor: number }) {
  const near = points.filter(([, height]) => height >= 3 * threshold).map(([value, height]) => [value * factor, height] as const);
  if (near.length < 2) return null;
  const to = scale(near.map(([value]) => value), near.map(([, height]) => height));
  return (
    <Chart title={title} names={[name, "log likelihood below its top"]} to={to}>
      <path class="curve" d={line(near, to)} />
      <path class="curve faint" d={`M${MARGIN.left} ${to.y(threshold)}H${WIDTH - MARGIN.right}`} />
    </Chart>
  );
}

const placed = ({ sphere_radius_m, chi }: Pair) => [sphere_radius_m * 1000, chi] as const;
const AXES: [string, string] = ["sphere radius rₛ [mm]", "drag ratio χ"];

/** Likelihood over both parameters, its joint regions (long and thin, because the parameters compensate each other) and the samples
* of the bootstrap. */
export function Ridge({ evidence, paper }: { evidence: EvidenceOutput; paper: Pair }) {
  const { ridge, draws, likelihood } = evidence;
  const regions = [...ridge.contours].sort((a, b) => b.level - a.level);
  const corners = regions.flatMap((region) => region.corners);
  if (corners.length === 0) return null;
  const to = scale(corners.map(([radius]) => radius * 1000), corners.map(([, chi]) => chi));
  const levels = regions.map(({ level }) => `${Math.round(level * 100)} %`).join(", ");
  const within = ([x, y]: readonly [number, number]) => Math.abs(to.x(x) - WIDTH / 2) < WIDTH / 2 - MARGIN.right && to.y(y) > MARGIN.top && to.y(y) < HEIGHT - MARGIN.bottom && to.x(x) > MARGIN.left;
  return (
    <Chart title="Ridge of rₛ and χ" names={AXES} to={to}>
      <clipPath id="ridge-frame"><rect x={MARGIN.left} y={MARGIN.top} width={WIDTH - MARGIN.left - MARGIN.right} height={HEIGHT - MARGIN.top - MARGIN.bottom} /></clipPath>
      <g clip-path="url(#ridge-frame)"><LikelihoodMap of={ridge} to={to} /></g>
      <Dots kind="draws" radius={1.2} to={to} of={draws.map(placed).filter(within).map((at) => [at, "a draw of the bootstrap"])} />
      {regions.map(({ level, corners }) => (
        <path key={level} class="region" d={`${line(corners.map(([radius, chi]) => [radius * 1000, chi] as const), to)}Z`}>
          <title>{`${Math.round(level * 100)} %`}</title>
        </path>
      ))}
      <Dots kind="measured" radius={4} to={to} of={[[placed(likelihood.estimate), "likeliest"]]} />
      <Dots kind="paper" radius={4} to={to} of={[[placed(paper), "least squares"]]} />
      <text x={WIDTH - MARGIN.right - 4} y={MARGIN.top + 14} text-anchor="end">{levels}</text>
    </Chart>
  );
}

/** Likelihood relative to its maximum, one coloured cell per node of the grid. */
function LikelihoodMap({ of: { sphere_radius_m, chi, log_ratio }, to }: { of: EvidenceOutput["ridge"]; to: Scale }) {
  const [columns, rows] = [sphere_radius_m.length, chi.length];
  const picture = useMemo(() => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [columns, rows];
    const context = canvas.getContext("2d");
    const image = context?.createImageData(columns, rows);
    if (!context || !image) return "";
    log_ratio.forEach((row, k) =>
      row.forEach((height, i) => image.data.set([88, 128, 178, 170 * Math.exp(height ?? -Infinity)], 4 * ((rows - 1 - k) * columns + i))),
    );
    context.putImageData(image, 0, 0);
    return canvas.toDataURL();
  }, [log_ratio]);
  const ends = (values: readonly number[], step = ((values.at(-1) ?? 0) - (values[0] ?? 0)) / Math.max(1, values.length - 1)) =>
    [(values[0] ?? 0) - step / 2, (values.at(-1) ?? 0) + step / 2] as const;
  const [[x0, x1], [y0, y1]] = [ends(sphere_radius_m.map((radius) => radius * 1000)), ends(chi)];
  return <image href={picture} x={to.x(x0)} y={to.y(y1)} width={to.x(x1) - to.x(x0)} height={to.y(y0) - to.y(y1)} preserveAspectRatio="none" />;
}

/** Both fits without each run, which shows the influence of a single run. */
export function WithoutRun({ evidence, paper }: { evidence: EvidenceOutput; paper: Pair }) {
  const without = evidence.without_run;
  if (without.length === 0) return null;
  const of = (fit: "paper" | "likelihood") => without.flatMap((one) => (one[fit] ? [[placed(one[fit]), `without ${short(one.file)}`] as const] : []));
  const all = [placed(paper), ...of("paper").map(([at]) => at), ...of("likelihood").map(([at]) => at)];
  const to = scale(all.map(([x]) => x), all.map(([, y]) => y), 0.12);
  return (
    <Chart title="Without each run" names={AXES} to={to}>
      <Dots kind="measured" to={to} of={of("likelihood")} />
      <Dots kind="others" to={to} of={of("paper")} />
      <Dots kind="paper" radius={4} to={to} of={[[placed(paper), "all runs, least squares"]]} />
      {without.map(({ file, paper }) => {
        const [x, y] = placed(paper);
        const isRight = to.x(x) > WIDTH / 2;
        return <text key={file} x={to.x(x) + (isRight ? -7 : 7)} y={to.y(y) + 4} text-anchor={isRight ? "end" : "start"}>{short(file).replace(/\.\w+$/, "")}</text>;
      })}
    </Chart>
  );
}

/** Residuals of each run at the maximum-likelihood estimate, in standard errors. */
export function Residuals({ evidence }: { evidence: EvidenceOutput }) {
  const of = (key: "x_m" | "delta_y_m" | "delta_theta_rad", name: string, aside: number) =>
    evidence.run_errors.flatMap((run, k) => {
      const left = run[key].standardised;
      return left === null ? [] : [[[k + 1 + aside, left], `${name} of ${short(run.file)}: ${left.toFixed(2)}`] as const];
    });
  const [x, deltaY, deltaTheta] = [of("x_m", "X", -0.12), of("delta_y_m", "ΔY", 0), of("delta_theta_rad", "Δθ", 0.12)];
  const heights = [...x, ...deltaY, ...deltaTheta].map(([[, height]]) => height);
  if (heights.length === 0) return null;
  const to = scale([0.5, evidence.run_errors.length + 0.5], [...heights, -2.5, 2.5], 0);
  return (
    <Chart title="Residuals" names={["run", "X, ΔY, Δθ over their standard errors"]} to={to}>
      {[-2, 0, 2].map((at) => <path key={at} class="curve faint" d={`M${MARGIN.left} ${to.y(at)}H${WIDTH - MARGIN.right}`} />)}
      <Dots kind="measured" to={to} of={x} />
      <Dots kind="others" to={to} of={deltaY} />
      <Dots kind="paper" to={to} of={deltaTheta} />
      {[["measured", "X"], ["others", "ΔY"], ["paper", "Δθ"]].map(([kind, name], k) => (
        <g key={name} class={kind}><circle cx={MARGIN.left + 12 + 44 * k} cy={MARGIN.top + 10} r={3.5} /><text x={MARGIN.left + 20 + 44 * k} y={MARGIN.top + 14}>{name}</text></g>
      ))}
    </Chart>
  );
}

/** Path of the middle link in every run. */
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
