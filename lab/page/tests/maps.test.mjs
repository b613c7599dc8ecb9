// Maps: an export of a sweep opens, is read design by design, and what is no export is refused.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { BROWSERS, Tab } from "./browsers.mjs";
import { OUT, SCREENSHOTS } from "./setting.mjs";

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
    pareto: Array.from({ length: 9 }, (_, k) => ({ key: k, speed: 0.01 + k * 0.002, efficiency: 0.02 - k * k * 0.0002 })),
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
    await tab.drop(good);
    await tab.until(() => document.querySelector("#cells") !== null, undefined, "the map");
    await tab.evaluate(() => document.querySelector(".cells").focus());
    for (let k = 0; k < 3; k++) await tab.press("ArrowRight");
    await tab.press("ArrowUp");
    const read = await tab.text("#pointed");
    assert.ok(read.includes(`${map.quantities[0].values[1][3].toPrecision(6)}`), read);
    assert.match(read, /statusoptimal/);
    await tab.choose("quantity", "1");
    await tab.until(() => document.querySelector("#maps .legend").textContent.includes("rad"), undefined, "the other quantity");
    if (name === "chromium") await tab.page.screenshot({ path: join(SCREENSHOTS, "maps-light.png"), fullPage: true });
    assert.deepEqual(tab.said, []);
    await tab.close();
  });
}
