// How the page looks: pictures for people to look at, and what can be measured of it.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { BROWSERS, Tab } from "./browsers.mjs";
import { SCREENSHOTS } from "./setting.mjs";

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
