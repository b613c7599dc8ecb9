// Maps: an export of a sweep opens, is read design by design, and what is no export is refused.

import assert from "node:assert/strict";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { BROWSERS, Tab } from "./browsers.mjs";
import { OUT, printed, SCREENSHOTS } from "./setting.mjs";

/** Of the shape that `swimmer sweep map --export` writes, with round numbers. */
function sample() {
  const across = Array.from({ length: 24 }, (_, k) => 1.2 + k * 0.15);
  const up = Array.from({ length: 16 }, (_, k) => 0.2 + k * 0.05);
  const grid = (of) => up.map((y, j) => across.map((x, i) => of(x, y, i, j)));
  return {
    format: "swimmer-sweep-map 1",
    plan: "0123",
    objective: "efficiency",
    axes: [{ name: "chi", unit: "", values: across }, { name: "link_ratio", unit: "", values: up }],
    quantities: [
      { name: "efficiency", unit: "", values: grid((x, y, i, j) => (i < 2 && j < 3 ? null : (x - 1) * Math.sin(3 * y) * 0.01)) },
      { name: "amplitude_rad", unit: "rad", values: grid((x, y) => 1 + y * x * 0.2) },
    ],
    structure: grid((x) => (x < 2.5 ? "regular" : "regular upper")),
    status: grid((x, y, i, j) => (i < 2 && j < 3 ? "none" : i === 5 ? "uncertified" : "optimal")),
    folds: [[[2.475, 0.2], [2.475, 0.95]]],
    plan_axes: [{ name: "chi", unit: "" }, { name: "link_ratio", unit: "" }],
    pareto: Array.from({ length: 9 }, (_, k) => ({ key: k, speed: 0.01 + k * 0.002, efficiency: 0.02 - k * k * 0.0002, design: [across[k], up[2]] })),
  };
}

for (const [name, launch] of Object.entries(BROWSERS)) {
  test(`a map of a sweep, in ${name}`, async (context) => {
    const browser = await launch();
    context.after(() => browser.close());
    const [good, bad] = ["map.json", "no-map.json"].map((file) => join(OUT, file));
    const map = sample();
    writeFileSync(good, JSON.stringify(map));
    writeFileSync(bad, JSON.stringify({ ...map, format: "another 2" }));
    const tab = await Tab.open(browser);
    await tab.click("#tab-maps");
    await tab.drop(bad);
    await tab.until(() => document.querySelector("#maps [role=alert]") !== null, undefined, "a refusal");
    assert.match(await tab.text("#maps [role=alert]"), /no-map\.json: its format is "another 2"/);
    // The error is cleared by its button.
    await tab.evaluate(() => [...document.querySelectorAll("#maps button")].find((one) => one.textContent === "Clear").click());
    assert.equal(await tab.text("#maps [role=alert]"), null);
    await tab.drop(good);
    await tab.until(() => document.querySelector("#cells") !== null, undefined, "the map");
    await tab.evaluate(() => document.querySelector(".cells").focus());
    for (let k = 0; k < 3; k++) await tab.press("ArrowRight");
    await tab.press("ArrowUp");
    const read = await tab.text("#pointed");
    assert.ok(read.includes(`${map.quantities[0].values[1][3].toPrecision(6)}`), read);
    assert.match(read, /statusoptimal/);
    await tab.choose("quantity", "1");
    await tab.until(() => document.querySelector("#maps .legend").textContent.includes("°"), undefined, "the other quantity");
    // The front names its designs, and points at them on the map.
    assert.match(await tab.text("#pareto tbody tr:last-child"), /chi 2\.4, link ratio 0\.3 fastest/);
    await tab.evaluate(() => document.querySelector("#pareto tbody tr:last-child button").click());
    await tab.until(() => document.querySelector("#pointed td").textContent === "2.4", undefined, "the design of the front");
    if (name === "chromium") await tab.page.screenshot({ path: join(SCREENSHOTS, "maps-light.png"), fullPage: true });
    assert.deepEqual(tab.said, []);
    await tab.close();
  });
}

const SAMPLE = fileURLToPath(new URL("../src/maps/sample", import.meta.url));

/** Equal to the rounding of the sample to five digits. */
function alike(found, expected, what) {
  if (typeof expected === "number") assert.ok(Math.abs(found - expected) <= 5.1e-5 * Math.abs(expected), `${what}: ${found} and ${expected}`);
  else if (Array.isArray(expected)) {
    assert.equal(found.length, expected.length, what);
    expected.forEach((each, k) => alike(found[k], each, `${what}, ${k}`));
  } else if (expected !== null && typeof expected === "object") for (const key of Object.keys(expected)) alike(found[key], expected[key], `${what}: ${key}`);
  else assert.equal(found, expected, what);
}

test("the sample is the map of its spec", async () => {
  const folder = join(OUT, "sample-sweep");
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder);
  printed("sweep", "plan", `${SAMPLE}.toml`, "-o", join(folder, "plan"));
  printed("sweep", "run", join(folder, "plan"));
  const { reason } = printed("sweep", "map", join(folder, "plan"), "--across", "links.ratio", "--up", "bounds.max_angle", "--export", join(folder, "map.json"));
  assert.equal(reason, "");
  const map = JSON.parse(readFileSync(join(folder, "map.json"), "utf8"));
  const sample = JSON.parse(readFileSync(`${SAMPLE}.json`, "utf8"));
  const quantities = map.quantities.filter(({ name }) => sample.quantities.some((one) => one.name === name));
  alike({ ...map, quantities }, sample, "sample");
});

for (const [way, size] of Object.entries({ light: {}, dark: { dark: true }, phone: { width: 390, height: 844 } })) {
  test(`the sample of Maps, ${way}: labels that do not overlap`, async (context) => {
    const browser = await BROWSERS.chromium();
    context.after(() => browser.close());
    const tab = await Tab.open(browser, size);
    await tab.click("#tab-maps");
    await tab.evaluate(() => [...document.querySelectorAll("#maps button")].find((one) => one.textContent === "Try the sample").click());
    await tab.until(() => document.querySelector("#pareto tbody tr") !== null, undefined, "the sample");
    const boxes = await tab.evaluate(() => [...document.querySelectorAll("#maps .ticks > span:not(.widest), #maps .chart text")].map((one) => ({ text: one.textContent, box: one.getBoundingClientRect().toJSON() })));
    for (const [k, one] of boxes.entries()) {
      for (const other of boxes.slice(k + 1)) {
        const [across, down] = [Math.min(one.box.right, other.box.right) - Math.max(one.box.left, other.box.left), Math.min(one.box.bottom, other.box.bottom) - Math.max(one.box.top, other.box.top)];
        assert.ok(across < 1 || down < 1, `${one.text} covers ${other.text}`);
      }
    }
    assert.ok((await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth)) <= 0);
    await tab.page.screenshot({ path: join(SCREENSHOTS, `maps-sample-${way}.png`), fullPage: true });
    assert.deepEqual(tab.said, []);
    await tab.close();
  });
}
