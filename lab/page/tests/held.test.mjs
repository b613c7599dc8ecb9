// What the page drives and what it shows: the gait that the robot holds against the one shown, the robot's state and the e-stop in
// every tab, on a desk and on a phone; the fields of Drive; in both browsers.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { BROWSERS } from "./browsers.mjs";
import { Driver, Lab, Twin } from "./driving.mjs";
import { OUT, printed, SCREENSHOTS } from "./setting.mjs";

const TABS = ["explore", "drive", "calibrate", "maps"];
const HANDLE = '.handles circle[data-index="1"]';
const PHONE = { width: 390, height: 844 };
const DESK = { width: 1440, height: 900 };

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

const open = (tab, id) => tab.push(`#tab-${id}`);
const held = (tab, is) => tab.until((is) => document.querySelector("#held")?.dataset.held === is, is, `the gait there: ${is}`);
const isDisabled = (tab, selector) => tab.evaluate((selector) => document.querySelector(selector).disabled, selector);

/** An element that can be seen and pressed without scrolling: whole on the screen, with nothing over its middle. */
const isAtHand = (tab, selector) =>
  tab.evaluate((selector) => {
    const element = document.querySelector(selector);
    if (!element || element.offsetParent === null && getComputedStyle(element).position !== "fixed") return false;
    const { left, top, right, bottom } = element.getBoundingClientRect();
    const over = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
    return left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight && (element === over || element.contains(over));
  }, selector);

/** Draws another gait in Explore, and comes back. */
async function drawAnother(tab) {
  await open(tab, "explore");
  await tab.drag(HANDLE, [47, -31]);
  await open(tab, "drive");
}

for (const name of Object.keys(BROWSERS)) {
  test(`${name}: Play plays the gait that is shown, and nothing else`, async () => {
    const tab = await Driver.open(browsers[name]);
    await tab.push("#connect-twin");
    await held(tab, "none");
    assert.ok(await isDisabled(tab, "#play"), "the robot holds no gait");
    await tab.says("The robot will play it");
    await tab.push("#upload");
    await held(tab, "same");
    await tab.push("#arm");
    await tab.state("Holding");
    await tab.until(() => !document.querySelector("#play").disabled, undefined, "Play");

    await drawAnother(tab);
    await held(tab, "other");
    await tab.says("The robot holds another gait than the one shown");
    assert.ok(await isDisabled(tab, "#play"), "Play is off while the robot holds another gait");
    const [there, here] = await tab.evaluate(() => document.querySelector("#held").textContent.match(/[0-9a-f]{8}/g));
    assert.notEqual(there, here, "both are named");
    // Both are drawn, and told apart.
    assert.ok(await tab.evaluate(() => document.querySelector("#gait-there") && document.querySelector("#gait-shown").classList.contains("not-there")));
    assert.ok(!(await tab.text("#said")).includes("gait is on the robot"), await tab.text("#said"));

    await tab.push("#upload");
    await held(tab, "same");
    assert.equal(await tab.evaluate(() => document.querySelector("#gait-there")), null);
    await tab.push("#play");
    await tab.state("Playing");
    // Drawn while it plays: what plays stays drawn and named.
    await drawAnother(tab);
    await held(tab, "other");
    assert.ok(await tab.evaluate(() => document.querySelector("#gait-there") !== null));
    await tab.push("#stop");
    await tab.state("Stopped");
    assert.deepEqual(tab.said, []);
    await tab.close();
  });

  for (const [way, size] of Object.entries({ desk: DESK, phone: PHONE })) {
    test(`${name}, ${way}: every tab shows the state and the play, and stops the robot`, async () => {
      const tab = await Driver.open(browsers[name], size);
      assert.ok(!(await isAtHand(tab, "#estop")), "without a robot there is nothing to stop");
      await tab.push("#connect-twin");
      await tab.evaluate(() => window.scrollTo(0, 0));
      await tab.play();
      for (const id of TABS) {
        await open(tab, id);
        await tab.evaluate(() => window.scrollTo(0, 0));
        for (const selector of ["#state", "#playing", "#estop"]) {
          assert.ok(await isAtHand(tab, selector), `${selector} on the first screen of ${id}`);
        }
        assert.ok((await tab.text("#state")).startsWith("Playing"));
        assert.match(await tab.text("#playing"), /cycle \d+ of 3/);
        if (name === "chromium") await tab.page.screenshot({ path: join(SCREENSHOTS, `playing-${id}-${way}.png`) });
        // At the end of the page too.
        await tab.evaluate(() => window.scrollTo(0, document.documentElement.scrollHeight));
        for (const selector of ["#state", "#estop"]) assert.ok(await isAtHand(tab, selector), `${selector} at the end of ${id}`);
        const overflow = await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        assert.ok(overflow <= 0, `${id}: ${overflow} px wider than the screen`);
      }
      for (const id of TABS) {
        await open(tab, id);
        const [x, y] = await tab.evaluate(() => {
          const { left, right, top, bottom } = document.querySelector("#estop").getBoundingClientRect();
          return [(left + right) / 2, (top + bottom) / 2];
        });
        await tab.page.mouse.click(x, y);
        await tab.state("EStopped");
        await open(tab, "drive");
        await tab.push("#clear");
        await tab.state("Stopped");
        await tab.push("#arm");
        await tab.state("Holding");
        await tab.push("#play");
        await tab.state("Playing");
      }
      assert.deepEqual(tab.said, []);
      await tab.close();
    });
  }

  test(`${name}: a Play that is off looks off, three cycles are standard, and without end only where it is chosen`, async () => {
    const tab = await Driver.open(browsers[name]);
    await tab.push("#connect-twin");
    await held(tab, "none");
    const looks = () =>
      tab.evaluate(() => {
        const { backgroundColor, color, borderStyle, cursor } = getComputedStyle(document.querySelector("#play"));
        return { backgroundColor, color, borderStyle, cursor };
      });
    const off = await looks();
    assert.equal(off.cursor, "not-allowed");
    await tab.says("The robot will play it");
    await tab.push("#upload");
    await held(tab, "same");
    await tab.push("#arm");
    await tab.until(() => !document.querySelector("#play").disabled, undefined, "Play");
    const on = await looks();
    for (const key of Object.keys(off)) assert.notEqual(off[key], on[key], key);

    assert.equal(await tab.evaluate(() => document.querySelector("#cycles").value), "3");
    assert.equal(await tab.evaluate(() => document.querySelector("#endless").checked), false);
    await tab.push("#play");
    await tab.state("Playing");
    assert.match(await tab.text("#playing"), /of 3/);
    await tab.push("#stop");
    await tab.state("Stopped");
    await tab.evaluate(() => document.querySelector("#endless").click());
    assert.ok(await isDisabled(tab, "#cycles"));
    await tab.push("#arm");
    await tab.state("Holding");
    await tab.push("#play");
    await tab.state("Playing");
    assert.match(await tab.text("#playing"), /until stopped/);
    await tab.push("#stop");
    await tab.state("Stopped");
    assert.deepEqual(tab.said, []);
    await tab.close();
  });

  test(`${name}: a key is typed or chosen, named, and removed; what is none is told`, async () => {
    const KEY = "00112233445566778899aabbccddeeff";
    const file = join(OUT, `key-${name}.txt`);
    writeFileSync(file, `${KEY}\n`);
    const wrong = join(OUT, `no-key-${name}.txt`);
    writeFileSync(wrong, "12345678\n");
    const tab = await Driver.open(browsers[name], PHONE);
    const upload = async (path) => {
      const input = await tab.page.$("#key-file");
      await (input.setInputFiles ? input.setInputFiles(path) : input.uploadFile(path));
    };
    const says = (words) => tab.until((words) => document.querySelector("#key").textContent.includes(words), words, `"${words}" at the key`);
    const type = (text) =>
      tab.evaluate((text) => {
        const input = document.querySelector("#key-digits");
        input.value = text;
        input.dispatchEvent(new Event("change", { bubbles: true }));
      }, text);
    const { width, height } = await tab.evaluate(() => document.querySelector("#key").getBoundingClientRect().toJSON());
    assert.ok(width > 300 && height < 120, `${width} x ${height} px of a phone`);
    await upload(wrong);
    await says("holds no key");
    await upload(file);
    await says(`Key: key-${name}.txt`);
    await tab.push("#key button");
    await type("not a key");
    await says("holds no key");
    await type(KEY.toUpperCase());
    await says("Key: as typed");
    assert.ok(!(await tab.text("#panel-drive")).toLowerCase().includes(KEY), "the key is not shown");
    await tab.close();

    // The robot has it too: what is typed drives it.
    const twin = later(await Twin.start());
    const port = `tcp:127.0.0.1:${twin.port}`;
    const set = printed("robot", "key", "set", file, "--port", port);
    assert.equal(set.reason, "", set.reason);
    const lab = later(await Lab.start(port));
    const driver = await Driver.open(browsers[name], { url: lab.address });
    await driver.until(() => document.querySelector("#key-digits") !== null, undefined, "the field");
    await driver.evaluate((key) => {
      const input = document.querySelector("#key-digits");
      input.value = key;
      input.dispatchEvent(new Event("change", { bubbles: true }));
    }, KEY);
    await driver.push("#connect-socket");
    await driver.play();
    await driver.says("Signed with the key as typed");
    await driver.close();
    await lab.end();
    await twin.end();
  });
}

test("a robot that another program gave another gait is not played by the page", async () => {
  const twin = later(await Twin.start());
  const port = `tcp:127.0.0.1:${twin.port}`;
  const sent = printed("robot", "upload", "circle:30deg", "--port", port);
  assert.equal(sent.reason, "", sent.reason);
  const lab = later(await Lab.start(port));
  const tab = await Driver.open(browsers.chromium, { url: lab.address });
  await tab.push("#connect-socket");
  await held(tab, "other");
  await tab.push("#arm");
  await tab.state("Holding");
  assert.ok(await isDisabled(tab, "#play"));
  await tab.says("came from elsewhere and is not drawn");
  await tab.push("#upload");
  await held(tab, "same");
  await tab.push("#play");
  await tab.state("Playing");
  await tab.close();
  await lab.end();
});

test("a page that hangs loses the wheel within two seconds, and the robot stops", async () => {
  const lab = later(await Lab.start("twin"));
  const driver = await Driver.open(browsers.chromium, { url: lab.address });
  await driver.push("#connect-socket");
  await driver.play();
  const watcher = await Driver.open(browsers.chromium, { url: lab.address });
  await watcher.push("#connect-socket");
  await watcher.says("Another page drives");
  const begun = performance.now();
  // The main thread hangs; the browser goes on answering pings, and the worker goes on by itself.
  driver.page.evaluate(() => {
    const until = performance.now() + 6000;
    while (performance.now() < until);
  }).catch(() => undefined);
  await watcher.says("Nobody drives");
  const took = performance.now() - begun;
  console.log(`# a page that hangs loses the wheel after ${took.toFixed(0)} ms`);
  // Half a second more for a machine that is shared.
  assert.ok(took < 2500, `${took} ms`);
  await watcher.state("Stopped");
  await watcher.close();
  await driver.close();
  await lab.end();
});
