// Tank and recordings of Drive: the swimmer to scale with its predicted path; a play is listed, replayed, saved and read again.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { BROWSERS } from "./browsers.mjs";
import { Driver } from "./driving.mjs";
import { OUT, SCREENSHOTS } from "./setting.mjs";

/** Length of the preset `robot`, and of the tank that Explore begins with [m]. */
const [BODY, TANK] = [0.071 + 2 * 0.137, 2];

/** Sizes on the screen, and the numbers that the tank prints. */
const tank = (tab) =>
  tab.evaluate(() => {
    const box = (selector) => document.querySelector(`#tank ${selector}`)?.getBoundingClientRect();
    const points = (selector) => document.querySelector(`#tank ${selector}`)?.getAttribute("d").match(/[ML][^ML]+/g).map((step) => step.slice(1).split(" ").map(Number)) ?? [];
    return { body: points(".body"), walls: box(".walls").width, tip: box(".tip").x, predicted: points(".predicted"), own: points(".own"), true: points(".true"), words: document.querySelector("#way")?.textContent ?? "" };
  });

for (const [name, launch] of Object.entries(BROWSERS)) {
  test(`${name}: the tank is drawn to scale, and a play is recorded, replayed and read again`, async (context) => {
    const browser = await launch();
    context.after(() => browser.close());
    const tab = await Driver.open(browser);
    // Straight, the body is as much of the tank as it is of the real one.
    const straight = await tab.evaluate(() => document.querySelector("#tank .body").getBBox().width / document.querySelector("#tank .walls").getBBox().width);
    assert.ok(Math.abs(straight - BODY / TANK) < 1e-4, `${straight}`);
    await tab.push("#connect-twin");
    await tab.says("The robot will play it");
    await tab.evaluate(() => {
      const period = document.querySelector('#panel-drive .fields input[type="number"]');
      period.value = "4";
      period.dispatchEvent(new Event("change", { bubbles: true }));
      const cycles = document.querySelector("#cycles");
      cycles.value = "1";
      cycles.dispatchEvent(new Event("change", { bubbles: true }));
    });
    await tab.says("in 1 cycle");
    await tab.push("#upload");
    await tab.says("The gait is on the robot");
    await tab.push("#arm");
    await tab.state("Holding");
    // The joints reach neutral; the robot's own model begins there.
    await new Promise((resolve) => setTimeout(resolve, 2000));
    await tab.push("#play");
    await tab.state("Playing");
    await tab.state("Stopped");
    await tab.until(() => document.querySelectorAll("#recordings tbody tr").length === 1, undefined, "the recording");
    // The prediction of the next play begins where the robot is now, in the virtual tank.
    const after = await tank(tab);
    const [here, predicted] = [after.true.at(-1), after.predicted.at(0)];
    assert.ok(Math.hypot(here[0] - predicted[0], here[1] - predicted[1]) < 2e-3, `${here} and ${predicted}`);
    // The robot's own model and the virtual tank end at one place.
    const own = after.own.at(-1);
    assert.ok(Math.hypot(here[0] - own[0], here[1] - own[1]) < 2e-3, `${here} and ${own}`);
    if (name === "chromium") await tab.page.screenshot({ path: join(SCREENSHOTS, "drive-tank.png"), fullPage: true });
    await tab.push("#recordings .replay");
    const joints = () => tab.evaluate(() => document.querySelector("#setpoint").getAttribute("cx"));
    const before = await joints();
    await tab.until((before) => document.querySelector("#setpoint").getAttribute("cx") !== before, before, "joints that are replayed");
    await tab.until(() => document.querySelectorAll("#panel-drive path.recorded").length === 1, undefined, "the recorded curve on the map");
    if (name === "chromium") await tab.page.screenshot({ path: join(SCREENSHOTS, "drive-replay.png"), fullPage: true });
    const table = await tab.saved(() => tab.evaluate(() => [...document.querySelectorAll("#recordings button")].find((one) => one.textContent === "CSV").click()));
    const rows = table.text.trim().split("\n");
    assert.equal(rows[0], "t_s,phi1_rad,phi2_rad,x_m,y_m,theta_rad");
    assert.ok(rows.length > 80 && rows.slice(1).every((row) => row.split(",").length === 6 && row.split(",").every((value) => Number.isFinite(Number(value)))), table.text.slice(0, 300));
    const log = await tab.saved(() => tab.push("#recordings .save-log"));
    assert.ok(log.text.startsWith("\x89MCAP"), "a link log");
    const file = join(OUT, `recorded-${name}.mcap`);
    writeFileSync(file, Buffer.from(log.text, "latin1"));
    await tab.drop(file);
    await tab.until(() => document.querySelectorAll("#recordings tbody tr").length === 2, undefined, "the opened log");
    const [opened, played] = await tab.evaluate(() => [...document.querySelectorAll("#recordings tbody .note")].map((note) => note.textContent));
    assert.equal(opened, played);
    const bad = join(OUT, "no-log.mcap");
    writeFileSync(bad, "no log");
    await tab.drop(bad);
    await tab.until(() => document.querySelector("#recordings [role=alert]")?.textContent.includes("another kind of file"), undefined, "a refusal");
    assert.deepEqual(tab.said, []);
    await tab.close();
  });
}
