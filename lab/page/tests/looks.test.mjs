// How the page looks: pictures for people to look at, and what can be measured of it.

import assert from "node:assert/strict";
import { join } from "node:path";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { BROWSERS, Tab } from "./browsers.mjs";
import { PAGE, SCREENSHOTS } from "./setting.mjs";

let browser;
before(async () => (browser = await BROWSERS.chromium()));
after(() => browser?.close());

const WAYS = {
  light: { width: 1440, height: 900 },
  dark: { width: 1440, height: 900, dark: true },
  phone: { width: 360, height: 740 },
};

for (const [way, size] of Object.entries(WAYS)) {
  test(`Explore, ${way}`, async () => {
    const tab = await Tab.open(browser, size);
    await tab.evaluate(() => [...document.querySelectorAll(".optima input")].slice(0, 2).forEach((box) => box.click()));
    await tab.settled();
    const overflow = await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(overflow <= 0, `${overflow} px wider than the screen`);
    await tab.page.screenshot({ path: join(SCREENSHOTS, `explore-${way}.png`), fullPage: true });
    await tab.close();
  });
}

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const ROOMS = ["explore", "drive", "calibrate", "maps"];

/** Opens a tab of the page and waits for its content. */
async function enter(tab, room) {
  await tab.evaluate((room) => document.getElementById(`tab-${room}`).click(), room);
  await tab.until((room) => document.querySelector(`#panel-${room}:not([hidden])`)?.childElementCount > 0, room, "the room");
  await tab.settled();
}

/** Pairs of labels, controls and numbers of the visible room that cover each other by more than a pixel. */
function overlaps() {
  const room = document.querySelector('[role="tabpanel"]:not([hidden])');
  const leaves = [...room.querySelectorAll("button, select, input, output, label > span, th, td, h2, svg text")].filter((one) => one.checkVisibility() && one.type !== "file");
  const boxes = leaves.map((one) => [one, one.getBoundingClientRect()]).filter(([, box]) => box.width > 1 && box.height > 1);
  const pairs = [];
  boxes.forEach(([one, a], k) =>
    boxes.slice(k + 1).forEach(([other, b]) => {
      if (one.contains(other) || other.contains(one)) return;
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (across > 1 && down > 1) pairs.push(`${one.outerHTML.slice(0, 90)} covers ${other.outerHTML.slice(0, 90)}`);
    }),
  );
  return pairs;
}

/** Rules of axe that the page breaks, and where. */
async function violations(tab) {
  // As an expression of the debugger: the page's policy allows no script from elsewhere.
  await tab.evaluate(AXE);
  return tab.evaluate(async () => {
    const { violations } = await axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"] });
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target.join(" ")).join(", ")}`);
  });
}

for (const [way, size] of Object.entries(WAYS)) {
  test(`every room, ${way}: no overflow, no overlap, nothing that axe finds`, async () => {
    const tab = await Tab.open(browser, size);
    for (const room of ROOMS) {
      await enter(tab, room);
      const overflow = await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(overflow <= 0, `${room}: ${overflow} px wider than the screen`);
      assert.deepEqual(await tab.evaluate(overlaps), [], room);
      assert.deepEqual(await violations(tab), [], room);
      await tab.page.screenshot({ path: join(SCREENSHOTS, `${room}-${way}.png`), fullPage: true });
    }
    await tab.close();
  });
}

/** Fills each room as a user would, and waits until it is full. */
const FILLED = {
  drive: async (tab) => {
    await tab.evaluate(() => document.querySelector("#connect-twin").click());
    await tab.until(() => document.querySelector("#preflight .good") !== null && document.querySelector("#panel-drive .plots canvas") !== null, undefined, "a robot");
    await tab.evaluate(() => document.querySelector("#set-up")?.setAttribute("open", ""));
  },
  calibrate: async (tab) => {
    await tab.evaluate(() => [...document.querySelectorAll("#calibrate button")].find((one) => one.textContent === "Try the sample").click());
    await tab.until(() => document.querySelector("#calibrate .verdict, #calibrate [role=alert]") !== null, undefined, "a verdict");
  },
  maps: async (tab) => {
    await tab.evaluate(() => [...document.querySelectorAll("#maps button")].find((one) => one.textContent === "Try the sample").click());
    await tab.until(() => document.querySelector("#pareto") !== null, undefined, "a map");
  },
};

for (const [way, size] of Object.entries(WAYS)) {
  test(`every room in use, ${way}: no overflow, nothing that axe finds`, async () => {
    const tab = await Tab.open(browser, size);
    for (const [room, fill] of Object.entries(FILLED)) {
      await enter(tab, room);
      await fill(tab);
      await tab.settled();
      const overflow = await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      await tab.page.screenshot({ path: join(SCREENSHOTS, `${room}-in-use-${way}.png`), fullPage: true });
      assert.ok(overflow <= 0, `${room}: ${overflow} px wider than the screen`);
      assert.deepEqual(await violations(tab), [], room);
    }
    assert.deepEqual(tab.said, []);
    await tab.close();
  });
}

test("a screen of 1400 by 900 shows map, numbers and plots at once", async () => {
  const tab = await Tab.open(browser, { width: 1400, height: 900 });
  const bottom = await tab.evaluate(() => document.querySelector(".plots").getBoundingClientRect().bottom);
  assert.ok(bottom <= 900, `the plots end at ${bottom} px`);
  await tab.close();
});

test("disabled buttons look and act as such", async () => {
  const tab = await Tab.open(browser);
  const undo = await tab.evaluate(() => {
    const button = [...document.querySelectorAll("button")].find((one) => one.textContent === "Undo");
    return { disabled: button.disabled, border: getComputedStyle(button).borderTopStyle };
  });
  assert.deepEqual(undo, { disabled: true, border: "dashed" });
  await tab.close();
});

test("handles are at least 24 px for a finger", async () => {
  const context = await browser.newContext({ viewport: { width: 360, height: 740 }, hasTouch: true, isMobile: true });
  const page = await context.newPage();
  await page.goto(PAGE);
  await page.waitForSelector(".handles circle");
  const widths = await page.evaluate(() => [...document.querySelectorAll(".handles circle")].map((handle) => handle.getBoundingClientRect().width));
  assert.ok(widths.length > 0 && Math.min(...widths) >= 24, `${widths}`);
  await context.close();
});

test("one switch changes the unit of every angle", async () => {
  const tab = await Tab.open(browser);
  const angles = () => tab.evaluate(() => [...document.querySelectorAll('[data-name="reach"], [data-name="peak rates"], #map .axes text, .u-title')].map((one) => one.textContent).join(" "));
  assert.ok((await angles()).includes("°") && !(await angles()).includes("rad"), await angles());
  await tab.evaluate(() => [...document.querySelectorAll("button")].find((one) => one.textContent.startsWith("Angles in")).click());
  await tab.settled();
  assert.ok((await angles()).includes("rad") && !(await angles()).includes("°"), await angles());
  await tab.close();
});

test("Delete on a symmetric gait says why no point goes", async () => {
  const tab = await Tab.open(browser);
  const count = () => tab.evaluate(() => document.querySelectorAll(".handles circle").length);
  const before = await count();
  await tab.evaluate(() => document.querySelector(".handles circle").focus());
  await tab.press("Delete");
  assert.equal(await count(), before);
  assert.match(await tab.text(".hint"), /Symmetric gaits lose four points/);
  await tab.close();
});
