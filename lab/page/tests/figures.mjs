// What follows a hand, measured in the page by its own clock. Printed, never asserted: machines differ.

import { statSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { BROWSERS, Tab } from "./browsers.mjs";
import { PAGE } from "./setting.mjs";

const browser = await BROWSERS.chromium();
const lines = [];
const line = (what, values, promised) => {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted[Math.floor(sorted.length / 2)] ?? NaN;
  lines.push({ what, "median ms": middle.toFixed(1), "longest ms": (sorted.at(-1) ?? NaN).toFixed(1), "promised ms": promised });
};

async function slide(tab, id, value) {
  await tab.evaluate(
    ([id, value]) => {
      const slider = document.getElementById(id);
      slider.value = `${value}`;
      slider.dispatchEvent(new Event("input", { bubbles: true }));
    },
    [id, value],
  );
  await tab.settled();
}

for (const swimmer of ["purcell", "robot"]) {
  const tab = await Tab.open(browser);
  if (swimmer === "purcell") {
    line("page from disk, to its first numbers", [await tab.evaluate(() => globalThis.swimmerLab.firstNumbers.value)], 1000);
    line("page from disk, until nothing is computed any more", [await tab.evaluate(() => performance.now())], "");
  }
  await tab.choose("Swimmer", swimmer);
  // A bound for which nothing was searched yet.
  await slide(tab, "max-angle", 2.25);
  const told = (name) => tab.evaluate((name) => globalThis.swimmerLab.times.get(name) ?? [], name);
  const forget = () => tab.evaluate(() => globalThis.swimmerLab.times.clear());
  await forget();
  await tab.evaluate(() => {
    window.frames_ = [];
    let before = performance.now();
    const step = (now) => {
      window.frames_.push(now - before);
      before = now;
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  });
  // Time of the page's own thread in scripts and in everything (layout, paint), by the browser's count.
  const devtools = await tab.page.context().newCDPSession(tab.page);
  await devtools.send("Performance.enable");
  const spent = async () => Object.fromEntries((await devtools.send("Performance.getMetrics")).metrics.map(({ name, value }) => [name, value * 1000]));
  const [framesBefore, before] = [await tab.evaluate(() => window.frames_.length), await spent()];
  await tab.drag('.handles circle[data-index="1"]', [60, -40], 90);
  const [framesAfter, after] = [await tab.evaluate(() => window.frames_.length), await spent()];
  const aFrame = (name) => (after[name] - before[name]) / (framesAfter - framesBefore);
  line(`${swimmer}: JavaScript a frame while dragging, mean`, [aFrame("ScriptDuration")], 8);
  line(`${swimmer}: main thread a frame while dragging, mean`, [aFrame("TaskDuration")], 16.7);
  line(`${swimmer}: displacement of a 192-sample curve`, await told("net"), 2);
  line(`${swimmer}: all else that is read of it`, await told("simulate"), "");
  line(`${swimmer}: full certificate, in a worker`, await told("certify"), 40);
  line(`${swimmer}: frames while dragging`, await tab.evaluate(() => window.frames_.slice(2)), "16.7");
  await forget();
  await tab.evaluate(() => document.querySelector('[aria-label="Take Displacement"]').click());
  await tab.settled();
  line(`${swimmer}: cold optimum of displacement, certified`, await told("optimize"), 60);
  await forget();
  await tab.evaluate(() => document.querySelector('[aria-label="Take Efficiency, small"]').click());
  await tab.settled();
  line(`${swimmer}: cold optimum of efficiency, certified`, await told("optimize"), 60);
  await forget();
  await slide(tab, "half-width", 2.7);
  const [coarse, fine] = await told("height-grid");
  const [curves] = await told("height-map");
  line(`${swimmer}: height map, first picture`, [coarse], 300);
  line(`${swimmer}: height map, fine, with zero curves`, [coarse + fine + curves], 300);
  await tab.close();
}
await browser.close();
console.table(lines);
console.log(`page: ${statSync(fileURLToPath(PAGE)).size} bytes of 1700000`);
