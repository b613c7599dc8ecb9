// More than fifty results of the module against the command of the same commit, under the same names.

import assert from "node:assert/strict";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { build } from "esbuild";
import { MODULE, swimmer } from "./setting.mjs";

const entry = new URL("../src/wasm/module.ts", import.meta.url).pathname;
const outfile = join(mkdtempSync(join(tmpdir(), "lab-")), "module.mjs");
await build({ entryPoints: [entry], bundle: true, format: "esm", outfile, logLevel: "warning" });
const { Module } = await import(outfile);
const module = await Module.load(await WebAssembly.compile(readFileSync(MODULE)));
const ask = (name, question) => module.call(name, question).json;

const SWIMMERS = ["purcell", "robot", "robot-slender"];
const GAITS = ["circle:30deg", "circle:70deg", "circle:110deg", "circle:1.2:cw", "square:40deg", "square:80deg", "square:1.5:cw", "circle:2.4rad"];
const bounded = ["--max-angle", "2"];
const bounds = { max_angle: 2 };

const simulations = SWIMMERS.flatMap((name) =>
  GAITS.map((gait) => ({
    words: ["simulate", "--swimmer", name, "--gait", gait],
    call: ["simulate", { swimmer: name, gait }],
    keys: ["displacement_over_length", "displacement_m", "lateral_over_length", "rotation_rad", "delta_y_over_length", "delta_theta_rad", "efficiency", "efficiency_constant_power", "links_cross"],
  })),
);
const maps = SWIMMERS.flatMap((name) =>
  ["x", "y", "theta"].map((row) => ({
    words: ["height-map", "--swimmer", name, "--row", row],
    call: ["height-map", { swimmer: name, row, max_angle: 2.8 }],
    keys: ["at_origin_over_length", "zero_on_diagonal", "zero_on_antidiagonal"],
  })),
);
const optima = [
  ["displacement", ["displacement"], ["displacement_over_length", "start_angle_rad"]],
  ["efficiency-small", ["efficiency", "--gait", "small"], ["efficiency", "displacement_over_length", "start_angle_rad"]],
  ["turning", ["turning"], ["rotation_rad"]],
].flatMap(([what, words, keys]) =>
  SWIMMERS.map((name) => ({
    words: ["optimize", ...words, "--swimmer", name, ...bounded],
    call: ["optimize", { swimmer: name, what, bounds }],
    keys,
  })),
);
const others = [
  ["purcell", "efficiency-large", ["efficiency", "--gait", "large"], 2.8, ["efficiency", "displacement_over_length", "start_angle_rad"]],
  ["robot", "efficiency-large", ["efficiency", "--gait", "large"], 2.8, ["efficiency", "displacement_over_length", "start_angle_rad"]],
  ["robot", "sideways", ["sideways"], 2, ["lateral_over_length", "displacement_over_length", "rotation_rad"]],
  ["purcell", "speed", ["speed", "--max-rate", "3"], 2, ["speed_over_length_per_s", "displacement_over_length", "period_s"]],
  ["robot", "speed", ["speed", "--max-rate", "3"], 2, ["speed_over_length_per_s", "displacement_over_length", "period_s"]],
].map(([name, what, words, most, keys]) => ({
  words: ["optimize", ...words, "--swimmer", name, "--max-angle", `${most}`],
  call: ["optimize", { swimmer: name, what, bounds: { max_angle: most }, ...(what === "speed" ? { max_rate: 3 } : {}) }],
  keys,
}));
const certificates = ["purcell", "robot"].flatMap((name) =>
  ["displacement", "efficiency"].flatMap((objective) =>
    ["circle:1.2", "square:1"].map((gait) => ({
      words: ["certify", "--swimmer", name, "--gait", gait, "--objective", objective],
      call: ["certify", { swimmer: name, gait, objective }],
      keys: ["pass", "verdict"],
      checks: true,
    })),
  ),
);
const cases = [...simulations, ...maps, ...optima, ...others, ...certificates];

test("the module agrees with the command", () => {
  assert.equal(cases.length, 55);
  for (const { words, call, keys, checks } of cases) {
    const [told, expected] = [ask(...call), swimmer(...words)];
    for (const key of keys) same(told[key], expected[key], `${words.join(" ")}: ${key}`);
    if (checks) {
      const names = (evidence) => evidence.checks.map(({ name, pass }) => `${name} ${pass}`);
      assert.deepEqual(names(told), names(expected), words.join(" "));
    }
  }
});

/** The same, but for the last digits, which the two machines round each in their own way. */
function same(told, expected, what) {
  if (typeof expected !== "number") assert.equal(told, expected, what);
  else assert.ok(Math.abs(told - expected) <= 1e-9 * Math.max(1, Math.abs(expected)), `${what}: ${told} by the module, ${expected} by the command`);
}

test("a call that the module lacks is refused with its name", () => {
  assert.throws(() => ask("swim!", {}), /swim!/);
});

test("the module asks nothing of the page", () => {
  assert.deepEqual(WebAssembly.Module.imports(new WebAssembly.Module(readFileSync(MODULE))), []);
});
