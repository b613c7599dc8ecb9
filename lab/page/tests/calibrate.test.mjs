// Calibrate: the page's fit of dropped files is the command's, and its tracks are what the command says they are.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { BROWSERS, Tab } from "./browsers.mjs";
import { OUT, SCREENSHOTS, swimmer } from "./setting.mjs";

const PERIOD = 30;
const CYCLES = 5;
/** Where the reflectors sit, metres from the middle of the middle link. */
const REACH = 0.0355;
/** Five: of fewer runs there is no bootstrap. */
const AMPLITUDES = [40, 50, 60, 80, 100];
const folder = join(OUT, "campaign");
const paths = [];
/** What the command makes of it. */
let expected;

/** What cameras would see of a swimmer, with a little noise that is always the same. */
function track(amplitude) {
  const way = join(folder, "way.csv");
  swimmer("simulate", "--swimmer", "robot", "--gait", `circle:${amplitude}deg`, "--cycles", `${CYCLES}`, "--trajectory", way, "--overwrite");
  let noise = 1;
  const jitter = () => ((noise = (noise * 16807) % 2147483647) / 2147483647 - 0.5) * 2e-4;
  const rows = readFileSync(way, "utf8").trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
  const lines = rows.map(([cycle, u, , , x, y, theta]) => {
    const [dx, dy] = [REACH * Math.cos(theta), REACH * Math.sin(theta)];
    const seen = [x + dx, y + dy, x - dx, y - dy].map((value) => (value + jitter()).toFixed(6));
    return [((cycle + u) * PERIOD).toFixed(4), ...seen].join(",");
  });
  return `t,x1,y1,x2,y2\n${lines.join("\n")}\n`;
}

before(() => {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const put = (name, text) => {
    writeFileSync(join(folder, name), text);
    paths.push(join(folder, name));
  };
  const ours = 'name = "ours"\n[links]\nmiddle = 0.071\nside = 0.137\n[drag]\nchi = 2.5\nc_t = { log_aspect = 4.543 }\n[sphere]\nradius = 0.05\n';
  put("ours.toml", ours);
  for (const amplitude of AMPLITUDES) put(`circle-${amplitude}.csv`, track(amplitude));
  const runs = AMPLITUDES.map((amplitude) => `[[run]]\ntrack = "circle-${amplitude}.csv"\ngait = "circle:${amplitude}deg"\nperiod_s = ${PERIOD}.0\ncycle_start_s = 0.0\n`);
  put(
    "campaign.toml",
    `swimmer = "ours.toml"\n[reflectors]\nfront = { point = ["x1", "y1"], at = [${REACH}, 0.0] }\nback = { point = ["x2", "y2"], at = [-${REACH}, 0.0] }\n${runs.join("")}`,
  );
  expected = swimmer("calibrate", join(folder, "campaign.toml"), "-o", join(folder, "report"));
});

/** The same numbers and words under these keys, as far as two machines round alike: what a search ends at, to its tolerance. */
function same(told, expected, keys, what) {
  for (const key of keys) alike(told[key], expected[key], `${what}: ${key}`);
}

function alike(told, expected, what) {
  if (typeof expected === "number") {
    assert.ok(Math.abs(told - expected) <= 1e-6 * Math.max(Math.abs(expected), 1e-3), `${what}: ${told} in the page, ${expected} by the command`);
  } else if (Array.isArray(expected)) {
    assert.equal(told.length, expected.length, what);
    expected.forEach((each, k) => alike(told[k], each, `${what}, ${k}`));
  } else if (expected !== null && typeof expected === "object") {
    for (const key of Object.keys(told)) if (key in expected) alike(told[key], expected[key], `${what}: ${key}`);
  } else assert.equal(told, expected, what);
}

for (const [name, launch] of Object.entries(BROWSERS)) test(`a campaign that is dropped is fitted as by the command, in ${name}`, async (context) => {
  const browser = await launch();
  context.after(() => browser.close());
  const tab = await Tab.open(browser, { hash: "#room=calibrate" });
  await tab.drop(...paths);
  await tab.until(() => document.querySelector("#calibrate .verdict, #calibrate [role=alert]") !== null, undefined, "a verdict");
  assert.equal(await tab.text("#calibrate [role=alert]"), null);
  const told = JSON.parse(await tab.text("#fit-exact"));
  same(told, expected, ["sphere_radius_m", "chi", "rmse", "correlation", "c_t_form", "intervals"], "fit");
  const report = JSON.parse(readFileSync(join(folder, "report/evidence.json"), "utf8"));
  assert.ok(report.bootstrap.draws > 0 && report.without_run.length === AMPLITUDES.length && report.ridge.log_ratio.length > 10);
  same(told.evidence, report, Object.keys(report), "evidence");
  same(told.evidence.likelihood, expected.likelihood, ["intervals"], "likelihood");
  const assessed = ["verdict", "reasons", "reduced_chi2", "intervals_with_systematics", "headline", "goodness", "systematics", "budget", "explanations", "excluded"];
  assert.deepEqual(Object.keys(told.assessment), assessed.filter((key) => key in expected));
  const { explanations, ...determined } = told.assessment;
  same(determined, expected, Object.keys(determined), "assessment");
  // These tracks leave nothing to explain: what each explanation would take is rounding, and even its sign is open.
  const words = ({ name, parameters }) => [name, ...parameters.map((each) => each.name)];
  assert.deepEqual((explanations ?? []).map(words), (expected.explanations ?? []).map(words));
  const goodness = await tab.evaluate(() => [...document.querySelectorAll("#goodness tbody tr")].map((row) => row.cells[6].textContent));
  assert.deepEqual(goodness, expected.goodness.runs.map(({ scale }) => (scale ? `${scale[0].toFixed(4)} ± ${scale[1].toFixed(4)}` : "–")));
  assert.equal(told.runs.length, expected.runs.length);
  const ofARun = ["cycles", "x_m", "x_sd_m", "delta_y_m", "delta_y_sd_m", "delta_theta_rad", "delta_theta_sd_rad", "period_s", "diagnoses"];
  told.runs.forEach((run, k) => same(run, expected.runs[k], ofARun, run.file));
  assert.equal(await tab.text("#calibrate .verdict h2"), `Verdict: ${expected.verdict}`);
  const x = await tab.evaluate(() => [...document.querySelectorAll("#runs tbody tr")].map((row) => row.cells[3].textContent));
  assert.deepEqual(x, expected.runs.map((run) => (run.x_m * 1000).toFixed(2)));
  const holds = swimmer("tracks", paths[1]);
  const row = await tab.evaluate(() => [...document.querySelector("#tracks tbody tr").cells].map((cell) => cell.textContent));
  assert.equal(row[1], holds.format);
  assert.equal(row[4], `${holds.frames}`);
  if (name === "chromium") {
    await tab.page.screenshot({ path: join(SCREENSHOTS, "calibrate-light.png"), fullPage: true });
    await tab.page.emulateMedia({ colorScheme: "dark" });
    await tab.page.setViewportSize({ width: 360, height: 740 });
    const wide = await tab.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 360, `${wide} px wide on a phone`);
    await tab.page.screenshot({ path: join(SCREENSHOTS, "calibrate-phone-dark.png"), fullPage: true });
  }
  assert.deepEqual(tab.said, []);
  await tab.close();
});

test("what takes long can be stopped, and begun again", async (context) => {
  const browser = await BROWSERS.chromium();
  context.after(() => browser.close());
  const tab = await Tab.open(browser, { hash: "#room=calibrate" });
  const dropped = tab.drop(...paths);
  await tab.until(() => [...document.querySelectorAll("#calibrate button")].find((button) => button.textContent === "Stop")?.click() === undefined && document.querySelector("#calibrate [role=alert]") !== null, undefined, "a stop");
  await dropped;
  assert.match(await tab.text("#calibrate [role=alert]"), /stopped/);
  assert.equal(await tab.text("#calibrate .verdict h2"), null);
  await tab.drop(paths[0]);
  await tab.until(() => document.querySelector("#calibrate .verdict") !== null, undefined, "a verdict");
  assert.deepEqual(tab.said, []);
  await tab.close();
});

test("what is missing of a campaign is named", async (context) => {
  const browser = await BROWSERS.chromium();
  context.after(() => browser.close());
  const tab = await Tab.open(browser, { hash: "#room=calibrate" });
  await tab.drop(paths.at(-1), paths[0]);
  await tab.until(() => document.querySelector("#calibrate [role=alert]") !== null, undefined, "a reason");
  assert.match(await tab.text("#calibrate [role=alert]"), /circle-40\.csv, which was not dropped/);
  await tab.close();
});
