// Drive with the cameras of `swimmer lab --track`: tracked pose and path in the tank, cycles against their prediction, departures.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { BROWSERS } from "./browsers.mjs";
import { Driver, Lab } from "./driving.mjs";
import { SCREENSHOTS } from "./setting.mjs";

const ended = [];
const later = (thing) => (ended.push(thing), thing);
const browsers = {};
before(async () => {
  for (const name of Object.keys(BROWSERS)) browsers[name] = await BROWSERS[name]();
});
after(async () => {
  for (const thing of ended) await thing.end();
  for (const browser of Object.values(browsers)) await browser.close();
});

const lines = (tab) => tab.evaluate(() => [...document.querySelectorAll(".monitor li")].map(({ textContent, className }) => ({ text: textContent, warns: className === "warning" })));

/** Points of a path in the tank, m. */
const points = (tab, kind) =>
  tab.evaluate((kind) => {
    const d = document.querySelector(`#tank .tank-path.${kind}`)?.getAttribute("d") ?? "";
    return d.split(/[ML]/).slice(1).map((pair) => pair.split(" ").map(Number)).map(([x, y]) => [x, -y]);
  }, kind);

/** Displacement, its interval and the prediction of a line about a cycle, mm. */
function cycleOf(text) {
  const [, number, measured, interval, predicted] = /^cycle (\d+): ([\d.]+) mm ± ([\d.]+) mm, predicted ([\d.]+) mm$/.exec(text) ?? [];
  return { number: Number(number), measured: Number(measured), interval: Number(interval), predicted: Number(predicted) };
}

for (const name of Object.keys(BROWSERS)) {
  test(`${name}: a served robot is tracked over its predicted path`, async () => {
    const lab = later(await Lab.start("twin", "--track", "twin"));
    const tab = await Driver.open(browsers[name], { url: lab.address });
    await tab.push("#connect-socket");
    await tab.timing(6, 2);
    await tab.says("where the cameras see it");
    await tab.play();
    await tab.until(() => document.querySelector("#tank .tank-path.tracked") !== null, undefined, "a tracked path");
    await tab.says("cycle 1:");
    await tab.state("Stopped");
    await tab.says("Tracked:");
    const said = await lines(tab);
    assert.deepEqual(said.filter(({ warns }) => warns), []);
    const cycles = said.slice(0, 2).map(({ text }) => cycleOf(text));
    assert.deepEqual(cycles.map(({ number }) => number), [1, 2]);
    for (const { measured, interval, predicted } of cycles) {
      assert.ok(interval > 0 && interval < 0.5, `± ${interval} mm`);
      // Half widths of 95 %: four standard deviations.
      assert.ok(Math.abs(measured - predicted) < 2 * interval, `${measured}, ${predicted} ± ${interval}`);
    }
    assert.match(said.at(-2).text, /^Predicted over 2 cycles: /);
    const tracked = await points(tab, "tracked");
    const predicted = await points(tab, "predicted");
    assert.ok(tracked.length > 100, `${tracked.length} tracked points`);
    assert.ok(predicted.length > 100);
    // Both go the same way: the end of the tracked path is near the point from which the next play is predicted.
    const [end, next] = [tracked.at(-1), predicted[0]];
    assert.ok(Math.hypot(end[0] - next[0], end[1] - next[1]) < 0.003, `${end}, ${next}`);
    assert.deepEqual(tab.said, []);
    await tab.close();
    await lab.end();
  });
}

test("a page that comes later sees the pose and the lines", async () => {
  const lab = later(await Lab.start("twin", "--track", "twin"));
  const driver = await Driver.open(browsers.chromium, { url: lab.address });
  await driver.push("#connect-socket");
  await driver.timing(3, 1);
  await driver.play();
  await driver.says("Tracked:");
  const watcher = await Driver.open(browsers.chromium, { url: lab.address });
  await watcher.push("#connect-socket");
  await watcher.says("where the cameras see it");
  await watcher.says("Tracked:");
  assert.deepEqual(await lines(watcher), await lines(driver));
  await driver.close();
  await watcher.close();
  await lab.end();
});

test("a robot in another tank than predicted departs, and the page says so", async () => {
  const lab = later(await Lab.start("twin:robot-slender", "--track", "twin", "--swimmer", "robot"));
  const tab = await Driver.open(browsers.chromium, { url: lab.address });
  await tab.push("#connect-socket");
  await tab.timing(3, 4);
  await tab.play();
  await tab.says("the robot departs from the prediction since cycle");
  assert.ok((await lines(tab)).some(({ warns }) => warns));
  await tab.close();
  await lab.end();
});

const WAYS = {
  light: { width: 1440, height: 900 },
  dark: { width: 1440, height: 900, dark: true },
  phone: { width: 390, height: 740 },
};
for (const [way, size] of Object.entries(WAYS)) {
  test(`Drive with cameras, ${way}`, async () => {
    const lab = later(await Lab.start("twin", "--track", "twin"));
    const tab = await Driver.open(browsers.chromium, { ...size, url: lab.address });
    await tab.push("#connect-socket");
    await tab.timing(4, 3);
    await tab.play();
    await tab.evaluate(() => [...document.querySelectorAll("#panel-drive .way button")].find(({ textContent }) => textContent === "Near view").click());
    await tab.says("cycle 2:");
    const overflow = await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    await tab.page.screenshot({ path: join(SCREENSHOTS, `drive-tracked-${way}.png`), fullPage: true });
    assert.ok(overflow <= 0, `${overflow} px wider than the screen`);
    await tab.close();
    await lab.end();
  });
}
