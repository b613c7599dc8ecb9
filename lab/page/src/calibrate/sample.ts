// Sample campaign: tracks of a simulated robot, as cameras would see it, with the campaign file that names them.

import { INTERVALS, quick } from "../explore/model.ts";

const PERIOD_S = 30;
const CYCLES = 5;
const AMPLITUDES_DEG = [40, 50, 60, 80, 100];
/** Distance of both reflectors from the middle of the middle link [m]. */
const REACH = 0.0355;
/** Standard deviation of a reflector's coordinate [m]. */
const NOISE = 5e-5;
/** Numbers per instant in a motion; the pose of the middle link follows u and the joint angles. */
const STRIDE = 26;

const swimmer = (name: string, chi: number, radius: number) =>
  `name = "${name}"\n[links]\nmiddle = 0.071\nside = 0.137\n[drag]\nchi = ${chi}\nc_t = { log_aspect = 4.543 }\n[sphere]\nradius = ${radius}\n`;
/** The values that the fit should find, and those from which it starts. */
const TRUE = swimmer("true", 2.72, 0.0515);
const START = swimmer("start", 2.5, 0.05);

const RUNS = AMPLITUDES_DEG.map((amplitude) => `[[run]]\ntrack = "circle-${amplitude}.csv"\ngait = "circle:${amplitude}deg"\nperiod_s = ${PERIOD_S}.0\ncycle_start_s = 0.0\n`);
const CAMPAIGN = `swimmer = "start.toml"\n[reflectors]\nfront = { point = ["x1", "y1"], at = [${REACH}, 0.0] }\nback = { point = ["x2", "y2"], at = [-${REACH}, 0.0] }\n${RUNS.join("")}`;

/** Normally distributed numbers, the same each time. */
function noise(seed: number): () => number {
  let state = seed;
  const uniform = () => ((state = (state * 16807) % 2147483647) / 2147483647);
  return () => NOISE * Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
}

/** Track of both reflectors over all cycles of a circle. */
async function track(amplitude: number): Promise<string> {
  const motion = new Float64Array(await quick.bytes("motion", { swimmer: TRUE, gait: `circle:${amplitude}deg`, intervals: INTERVALS }));
  const of = (instant: number, column: number) => motion[instant * STRIDE + column] ?? 0;
  const error = noise(amplitude);
  const lines = ["t,x1,y1,x2,y2"];
  let [x0, y0, turned] = [0, 0, 0];
  for (let cycle = 0; cycle < CYCLES; cycle++) {
    const [cos, sin] = [Math.cos(turned), Math.sin(turned)];
    for (let k = 0; k < INTERVALS + (cycle === CYCLES - 1 ? 1 : 0); k++) {
      const [x, y, theta] = [x0 + cos * of(k, 3) - sin * of(k, 4), y0 + sin * of(k, 3) + cos * of(k, 4), turned + of(k, 5)];
      const [dx, dy] = [REACH * Math.cos(theta), REACH * Math.sin(theta)];
      const seen = [x + dx, y + dy, x - dx, y - dy].map((value) => (value + error()).toFixed(6));
      lines.push([((cycle + k / INTERVALS) * PERIOD_S).toFixed(4), ...seen].join(","));
    }
    const [dx, dy] = [of(INTERVALS, 3), of(INTERVALS, 4)];
    [x0, y0, turned] = [x0 + cos * dx - sin * dy, y0 + sin * dx + cos * dy, turned + of(INTERVALS, 5)];
  }
  return `${lines.join("\n")}\n`;
}

/** Files of the sample. */
export async function sample(): Promise<File[]> {
  const files = [new File([CAMPAIGN], "campaign.toml"), new File([START], "start.toml")];
  for (const amplitude of AMPLITUDES_DEG) files.push(new File([await track(amplitude)], `circle-${amplitude}.csv`));
  return files;
}
