// Calibrate: the page's fit of dropped files is the command's, with all that is asked beyond it, and its tracks are what the command
// says they are.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { BROWSERS, Tab } from "./browsers.mjs";
import { OUT, printed, SCREENSHOTS, swimmer } from "./setting.mjs";

const PERIOD = 30;
const CYCLES = 5;
/** Where the reflectors sit, metres from the middle of the middle link. */
const REACH = 0.0355;
/** Five: of fewer runs there is no bootstrap. */
const AMPLITUDES = [40, 50, 60, 80, 100];
/** Whose track is UTF-16, as some tracking programs write it, and whose cycles a link log that was cut off times elsewhere. */
const [IN_UTF16, LOGGED] = [50, 80];
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
  const put = (name, content) => {
    writeFileSync(join(folder, name), content);
    paths.push(join(folder, name));
  };
  const ours = 'name = "ours"\n[links]\nmiddle = 0.071\nside = 0.137\n[drag]\nchi = 2.5\nc_t = { log_aspect = 4.543 }\n[sphere]\nradius = 0.05\n';
  put("ours.toml", ours);
  for (const amplitude of AMPLITUDES) put(`circle-${amplitude}.csv`, amplitude === IN_UTF16 ? Buffer.from(`\ufeff${track(amplitude)}`, "utf16le") : track(amplitude));
  const log = join(folder, "whole.mcap");
  printed("robot", "play", "--gait", `circle:${LOGGED}deg`, "--cycles", `${CYCLES}`, "--period", `${PERIOD}`, "--port", "twin", "--log", log);
  put("link.mcap", readFileSync(log).subarray(0, -60));
  const runs = AMPLITUDES.map((amplitude) => `[[run]]\ntrack = "circle-${amplitude}.csv"\ngait = "circle:${amplitude}deg"\nperiod_s = ${PERIOD}.0\ncycle_start_s = 0.0\n`);
  put(
    "campaign.toml",
    `swimmer = "ours.toml"\n[reflectors]\nfront = { point = ["x1", "y1"], at = [${REACH}, 0.0] }\nback = { point = ["x2", "y2"], at = [-${REACH}, 0.0] }\n${runs.join("")}`,
  );
  const timed = (log) => readFileSync(join(folder, "campaign.toml"), "utf8").replace(new RegExp(`(circle:${LOGGED}deg"\\nperiod_s = .*)\\ncycle_start_s = 0.0`), `$1\n${log}`);
  writeFileSync(join(folder, "logged.toml"), timed('log = "link.mcap"'));
  writeFileSync(join(folder, "third.toml"), timed('log = "link.mcap"\nplay = 3'));
  expected = swimmer("calibrate", join(folder, "campaign.toml"), "--advise", "-o", join(folder, "report"));
});

/** The same numbers and words under these keys, as far as two machines round alike: what a search ends at, to its tolerance. */
function same(told, expected, keys, what) {
  for (const key of keys) alike(told[key], expected[key], `${what}: ${key}`);
}

/** Correlations and pulls have no unit and are compared on the scale of 1: a pull counts standard deviations. */
const UNITS = { correlations: 1, pull: 1 };

/** Parameters that these tracks hardly determine: the likelihood is flat, and rounding decides where on it a search ends. */
const FLAT = ["marker", "tilt"];

function alike(told, expected, what, unit = 1e-3) {
  if (typeof expected === "number") {
    assert.ok(Math.abs(told - expected) <= 1e-6 * Math.max(Math.abs(expected), unit), `${what}: ${told} in the page, ${expected} by the command`);
  } else if (Array.isArray(expected)) {
    assert.equal(told.length, expected.length, what);
    expected.forEach((each, k) => alike(told[k], each, `${what}, ${k}`, unit));
  } else if (expected !== null && typeof expected === "object") {
    for (const key of Object.keys(told)) if (key in expected) alike(told[key], expected[key], `${what}: ${key}`, UNITS[key] ?? unit);
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
  alike(told.advice, expected.advice, "advice");
  assert.ok(told.advice.candidates.length > 20);
  assert.deepEqual(Object.keys(told.advice), Object.keys(expected.advice));
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

/** What the page shows under a table's id, line by line, and its notes, as the terminal writes them. */
const shown = (tab, id) =>
  tab.evaluate((id) => {
    const table = document.getElementById(id);
    const rows = [...table.rows].map((row) => [...row.cells].map((cell) => cell.textContent).join(" "));
    const notes = [...table.parentElement.querySelectorAll("p")].map((note) => note.textContent);
    return [...rows, ...notes].map((line) => line.replaceAll("−", "-").replaceAll("ₛ", "_s").replace(/\s+/g, " ").trim());
  }, id);

/** Chooses just these words of what can be fitted also, by key, and waits for what comes of it. */
async function fitAlso(tab, ...words) {
  for (const { word, checked } of await tab.evaluate(() => [...document.querySelectorAll(".choices input")].map(({ value, checked }) => ({ word: value, checked })))) {
    if (checked === words.includes(word)) continue;
    await tab.evaluate((word) => document.querySelector(`.choices input[value="${word}"]`).focus(), word);
    await tab.press(" ");
  }
  if (words.length === 0) await tab.until(() => document.querySelector("#further") === null, undefined, "nothing fitted also");
  await tab.settled();
  const { further } = JSON.parse(await tab.text("#fit-exact"));
  return { further, reason: await tab.text('[aria-label="What else may be off"] [role=alert]') };
}

for (const [name, launch] of Object.entries(BROWSERS)) test(`what else is fitted, and what to measure next, are the command's, in ${name}`, async (context) => {
  const browser = await launch();
  context.after(() => browser.close());
  const tab = await Tab.open(browser, { hash: "#room=calibrate" });
  await tab.drop(...paths);
  await tab.until(() => document.querySelector("#advice, #calibrate [role=alert]") !== null, undefined, "advice");
  assert.equal(await tab.text("#calibrate [role=alert]"), null);
  await tab.settled();
  const campaign = join(folder, "campaign.toml");
  const offered = await tab.evaluate(() => [...document.querySelectorAll(".choices input")].map(({ value }) => value));
  const [, taken] = /--fit-also[^]*?\[possible values: (.*?)\]/.exec(printed("calibrate", "--help").stdout.replace(/\s+/g, " "));
  assert.deepEqual([...offered].sort(), taken.split(", ").sort());
  // Each alone, where there is time for it, and the last together with another.
  const questions = [...(name === "chromium" ? offered.slice(0, -1).map((word) => [word]) : []), ["gain", "scale"], ["deadband", "offsets"]];
  for (const words of questions) {
    const told = await fitAlso(tab, ...words);
    const asked = ["calibrate", campaign, "--fit-also", words.join(",")];
    if (told.reason === null) {
      const { further } = swimmer(...asked);
      const { swimmer: file, ...fit } = told.further;
      assert.deepEqual(Object.keys(fit), Object.keys(further));
      assert.deepEqual(fit.parameters.map((each) => each.name), further.parameters.map((each) => each.name));
      if (FLAT.some((word) => words.includes(word))) assert.ok(Math.abs(fit.log_likelihood_gain - further.log_likelihood_gain) < 0.01, `${fit.log_likelihood_gain}, ${further.log_likelihood_gain}`);
      else alike(fit, further, `fitting ${words} also`);
      assert.match(file, /\[sphere\]/);
    } else assert.equal(told.reason, printed(...asked).reason);
  }
  const { stdout } = printed("calibrate", campaign, "--fit-also", questions.at(-1).join(","), "--advise");
  const lines = stdout.split("\n").map((line) => line.replace(/\s+/g, " ").trim());
  for (const id of ["further", "advice"]) {
    const rows = await shown(tab, id);
    assert.ok(rows.length > 5, `${id}: ${rows.length} lines`);
    for (const row of rows) assert.ok(lines.includes(row), `${id}: "${row}" is in the page and not in\n${stdout}`);
  }
  if (name === "chromium") {
    await tab.page.screenshot({ path: join(SCREENSHOTS, "calibrate-further-light.png"), fullPage: true });
    await tab.page.emulateMedia({ colorScheme: "dark" });
    await tab.page.screenshot({ path: join(SCREENSHOTS, "calibrate-further-dark.png"), fullPage: true });
    await tab.page.setViewportSize({ width: 360, height: 740 });
    const wide = await tab.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 360, `${wide} px wide on a phone`);
    await tab.page.screenshot({ path: join(SCREENSHOTS, "calibrate-further-phone.png"), fullPage: true });
  }
  // What is chosen stays chosen where the campaign comes again; nothing chosen, nothing shown.
  await tab.drop(paths.at(-1));
  await tab.until(() => document.querySelector("#further") !== null, undefined, "the same again");
  assert.deepEqual(await fitAlso(tab), { further: null, reason: null });
  assert.equal(await tab.text("#further"), null);
  // At the end: Firefox shows a download in a panel of its own, which takes the keys.
  await fitAlso(tab, "deadband");
  const { text } = await tab.saved(() => tab.evaluate(() => document.querySelector('[aria-label="What else may be off"] button').click()));
  assert.match(text, /dead_band/);
  assert.deepEqual(tab.said, []);
  await tab.close();
});

for (const [name, launch] of Object.entries(BROWSERS)) test(`link logs time the runs that name them, in ${name}`, async (context) => {
  const browser = await launch();
  context.after(() => browser.close());
  const tab = await Tab.open(browser, { hash: "#room=calibrate" });
  const others = paths.filter((path) => !path.endsWith("campaign.toml"));
  const logged = join(folder, "logged.toml");
  await tab.drop(logged, ...others);
  await tab.until(() => document.querySelector("#runs, #calibrate [role=alert]") !== null, undefined, "the runs");
  assert.equal(await tab.text("#calibrate [role=alert]"), null);
  const told = JSON.parse(await tab.text("#fit-exact"));
  const command = swimmer("calibrate", logged);
  assert.ok(command.runs.some((run) => run.phase === "log-and-heading"));
  told.runs.forEach((run, k) => same(run, command.runs[k], ["cycles", "x_m", "x_sd_m", "delta_y_m", "delta_theta_rad", "period_s", "diagnoses"], run.file));
  assert.ok(told.warnings.some((line) => line.startsWith(`circle-${LOGGED}.csv: its link log has no end`)), told.warnings.join("\n"));
  for (const line of told.warnings) assert.ok(command.warnings.includes(line), line);
  // The log of one play has no third: both report it.
  const third = join(folder, "third.toml");
  await tab.evaluate(() => [...document.querySelectorAll("#calibrate button")].find((button) => button.textContent === "Clear").click());
  await tab.drop(third, ...others);
  await tab.until(() => document.querySelector("#calibrate [role=alert]") !== null, undefined, "a reason");
  const { reason } = printed("calibrate", third);
  assert.match(reason, /the log holds 1 plays \(\d+ cycles of 30 s\), and no number 3/);
  assert.equal(await tab.text("#calibrate [role=alert]"), reason.replace(`${folder}/`, ""));
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
  assert.match(await tab.text("#calibrate [role=alert]"), /circle-40\.csv: the campaign names it, and it was not dropped/);
  await tab.close();
});

for (const [name, launch] of Object.entries(BROWSERS)) {
  test(`${name}: a wrong file is named and stands in the way of no other`, async () => {
    const browser = await launch();
    const tab = await Tab.open(browser, { hash: "#room=calibrate" });
    const wrong = join(folder, "photo.csv");
    writeFileSync(wrong, Buffer.from([0x89, 0x50, 0x4e, 0x47, 0, 1, 2, 3]));
    await tab.drop(wrong);
    const problem = () => tab.text('#calibrate [role="alert"]');
    assert.ok((await problem()).includes("photo.csv"), await problem());
    const broken = join(folder, "broken.toml");
    writeFileSync(broken, "[[run]]\ntrack = ");
    await tab.drop(broken, paths.find((path) => path.endsWith("circle-40.csv")));
    assert.ok((await problem()).includes("broken.toml"), await problem());
    assert.ok((await tab.text("#tracks")).includes("circle-40.csv"), "the good one of the two is read");
    await tab.drop(...paths);
    await tab.until(() => document.querySelector("#fit-exact") !== null, undefined, "the fit");
    assert.equal(await problem(), null);
    assert.ok(!(await tab.text("#tracks")).includes("photo.csv"));
    await browser.close();
  });
}

test("the sample is fitted, and an error is cleared", async (context) => {
  const browser = await BROWSERS.chromium();
  context.after(() => browser.close());
  const tab = await Tab.open(browser, { hash: "#room=calibrate" });
  const press = (name) => tab.evaluate((name) => [...document.querySelectorAll("#calibrate button")].find((one) => one.textContent === name).click(), name);
  const bad = join(OUT, "no-track.csv");
  writeFileSync(bad, "nothing\n");
  await tab.drop(bad);
  await tab.until(() => document.querySelector("#calibrate [role=alert]") !== null, undefined, "an error");
  await press("Clear");
  assert.equal(await tab.text("#calibrate [role=alert]"), null);
  await press("Try the sample");
  await tab.until(() => document.querySelector("#calibrate .verdict, #calibrate [role=alert]") !== null, undefined, "a verdict");
  await tab.settled();
  assert.equal(await tab.text("#calibrate [role=alert]"), null);
  // The values with which the sample's tracks were simulated.
  const { evidence } = JSON.parse(await tab.text("#fit-exact"));
  const { sphere_radius_m: radius, chi } = evidence.likelihood.estimate;
  assert.ok(Math.abs(radius - 0.0515) < 5e-4 && Math.abs(chi - 2.72) < 0.05, `${radius}, ${chi}`);
  await tab.page.screenshot({ path: join(SCREENSHOTS, "calibrate-sample.png"), fullPage: true });
  assert.deepEqual(tab.said, []);
  await tab.close();
});
