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
/** Searches as on the command line, and the same requests in the page: whole documents are compared. */
const SEARCHES = [
  ...SWIMMERS.flatMap((name) => [
    [name, ["displacement"], { objective: "displacement" }, 2],
    [name, ["efficiency", "--gait", "small"], { objective: "efficiency", optimum: "small" }, 2],
    [name, ["turning"], { objective: "turning" }, 2],
  ]),
  ...["purcell", "robot"].map((name) => [name, ["efficiency", "--gait", "large"], { objective: "efficiency", optimum: "large" }, 2.8]),
  ["robot", ["sideways"], { objective: "sideways" }, 2],
  ...["purcell", "robot"].map((name) => [name, ["speed", "--max-rate", "3"], { objective: "speed", max_rate: [3] }, 2]),
];
const searches = SEARCHES.map(([name, words, request, most]) => ({
  words: ["optimize", ...words, "--swimmer", name, "--max-angle", `${most}`],
  call: ["optimize", { ...request, swimmer: name, bounds: { max_angle: most } }],
  whole: true,
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
const cases = [...simulations, ...maps, ...searches, ...certificates];

test("the module agrees with the command", () => {
  assert.equal(cases.length, 55);
  for (const { words, call, keys = [], checks, whole } of cases) {
    const [told, expected] = [ask(...call), swimmer(...words)];
    if (whole) alike(told, expected, words.join(" "));
    for (const key of keys) same(told[key], expected[key], `${words.join(" ")}: ${key}`);
    if (checks) {
      const names = (evidence) => evidence.checks.map(({ name, pass }) => `${name} ${pass}`);
      assert.deepEqual(names(told), names(expected), words.join(" "));
    }
  }
});

/** Keys that only one side has: the module has no clock and no paths, and returns the text of the gait file. */
const ONE_SIDED = { seconds: "command", gait: "module" };
/** Figures near rounding, by which a certificate and a solver judge themselves (a tolerance may be that of a computed figure): names and
 * verdicts are compared. */
const NEAR_ROUNDING = ["value", "tolerance", "residual", "power_variation"];

/** The same documents, except for the last digits. */
function alike(told, expected, what) {
  if (Array.isArray(expected)) {
    assert.equal(told.length, expected.length, what);
    expected.forEach((each, k) => alike(told[k], each, `${what}: ${k}`));
  } else if (expected !== null && typeof expected === "object") {
    const keys = (document, side) => Object.keys(document).filter((key) => ONE_SIDED[key] !== side).sort();
    assert.deepEqual(keys(told, "module"), keys(expected, "command"), what);
    for (const key of keys(expected, "command")) if (!NEAR_ROUNDING.includes(key)) alike(told[key], expected[key], `${what}: ${key}`);
  } else same(told, expected, what);
}

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
