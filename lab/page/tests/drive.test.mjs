// Drive in the browsers: the robot in the page, a served one, one behind a serial port; two pages, pulled cables, strangers.

import assert from "node:assert/strict";
import { request } from "node:http";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { BROWSERS } from "./browsers.mjs";
import { Driver, Lab, served, Twin, withSerialPort } from "./driving.mjs";
import { PAGE, SCREENSHOTS } from "./setting.mjs";

/** The lease, ms: a robot that hears nothing begins to stop by then, so an e-stop that takes longer is worth nothing. */
const LEASE = 500;

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

/** Presses the space bar, and counts until the page knows that the pulses are off, ms. */
async function eStop(tab, other = tab) {
  const begun = performance.now();
  await tab.space();
  await other.until(() => document.querySelector("#state").dataset.state === "EStopped" && document.querySelector("#panel-drive").textContent.includes("pulsesoff"), undefined, "pulses off");
  return performance.now() - begun;
}

for (const name of Object.keys(BROWSERS)) {
  test(`${name}: the robot in the page is driven, and the space bar drops its pulses`, async () => {
    const tab = await Driver.open(browsers[name]);
    await tab.push("#connect-twin");
    await tab.play();
    const path = () => tab.evaluate(() => document.querySelector("#setpoint").getAttribute("cx"));
    const before = await path();
    await tab.until((before) => document.querySelector("#setpoint").getAttribute("cx") !== before, before, "joints that move");
    // The focus is on a button that does something else, and a number is being typed.
    await tab.evaluate(() => document.querySelector('#panel-drive input[type="number"]').focus());
    const waited = await eStop(tab);
    console.log(`# ${name}: space bar to "pulses off" on the page ${waited.toFixed(0)} ms`);
    assert.ok(waited < LEASE, `${waited} ms`);
    // Nothing is powered: the space bar presses buttons again.
    await tab.evaluate(() => document.querySelector("#clear").focus());
    await tab.space();
    await tab.state("Stopped");
    await tab.push("#arm");
    await tab.state("Holding");
    await tab.push("#stop");
    await tab.state("Stopped");
    const log = await tab.saved(() => tab.push("#log"));
    assert.ok(log.text.startsWith("\x89MCAP"), "a link log");
    assert.deepEqual(tab.said, []);
    await tab.close();
  });

  test(`${name}: a served robot is driven by one page, watched and stopped by another`, async () => {
    const lab = later(await Lab.start("twin"));
    const driver = await Driver.open(browsers[name], { url: lab.address });
    assert.ok(!(await driver.evaluate(() => location.href)).includes(lab.token), "the token left the address");
    await driver.push("#connect-socket");
    await driver.play();
    const watcher = await Driver.open(browsers[name], { url: lab.address });
    await watcher.push("#connect-socket");
    await watcher.says("Another page drives");
    await watcher.state("Playing");
    const waited = await eStop(watcher, driver);
    console.log(`# ${name}: a watcher's space bar to "pulses off" on the driver's page ${waited.toFixed(0)} ms`);
    assert.ok(waited < LEASE, `${waited} ms`);
    await driver.close();
    await watcher.says("Nobody drives");
    await watcher.evaluate(() => [...document.querySelectorAll("#panel-drive button")].find(({ textContent }) => textContent === "Drive").click());
    await watcher.says("This page drives");
    await watcher.push("#clear");
    await watcher.play();
    assert.deepEqual(watcher.said, []);
    await watcher.close();
    await lab.end();
  });
}

test("a robot behind a serial port: driven, unplugged, plugged again", async () => {
  const twin = later(await Twin.start());
  const page = await served();
  ended.push(page);
  const browser = await withSerialPort(browsers.chromium, twin);
  const tab = await Driver.open(browser, { url: page.url });
  await tab.push("#connect-serial");
  await tab.play();
  await tab.evaluate(() => window.cable(false));
  await tab.says("Gone");
  await tab.until(() => document.querySelector(".stale-data") !== null, undefined, "old numbers in grey");
  await tab.evaluate(() => window.cable(true));
  await tab.says("Connected");
  // The lease ran out meanwhile; nothing goes on by itself.
  await tab.state("Stopped");
  await tab.play();
  const waited = await eStop(tab);
  console.log(`# serial port: space bar to "pulses off" on the page ${waited.toFixed(0)} ms`);
  assert.ok(waited < LEASE, `${waited} ms`);
  assert.deepEqual(tab.said, []);
  await browser.close();
});

test("a served robot whose cable is pulled is found again", async () => {
  let twin = later(await Twin.start());
  const lab = later(await Lab.start(`tcp:127.0.0.1:${twin.port}`));
  const tab = await Driver.open(browsers.chromium, { url: lab.address });
  await tab.push("#connect-socket");
  await tab.play();
  const { port } = twin;
  await twin.end();
  await tab.says("Gone");
  twin = later(await Twin.start(port));
  await tab.says("Connected");
  await tab.state("Stopped");
  assert.deepEqual(tab.said, []);
  await tab.close();
});

test("strangers reach no robot", async () => {
  const lab = later(await Lab.start("twin"));
  const socket = `${lab.origin.replace("http", "ws")}/link`;
  const dial = ([socket, protocols]) =>
    new Promise((resolve) => {
      const dialled = new WebSocket(socket, protocols);
      dialled.onopen = () => resolve("open");
      dialled.onerror = () => resolve("refused");
    });
  const other = await served("<!doctype html><title>another site</title>");
  ended.push(other);
  for (const name of Object.keys(BROWSERS)) {
    const page = await browsers[name].newPage();
    await page.goto(other.url);
    assert.equal(await page.evaluate(dial, [socket, ["swimmer", lab.token]]), "refused", `${name}: another site, with the token`);
    // From disk the origin is `null`.
    await page.goto(PAGE);
    assert.equal(await page.evaluate(dial, [socket, ["swimmer"]]), "refused", `${name}: no token`);
    assert.equal(await page.evaluate(dial, [socket, ["swimmer", "0".repeat(32)]]), "refused", `${name}: another token`);
    assert.equal(await page.evaluate(dial, [socket, ["swimmer", lab.token]]), "open", `${name}: the token`);
    await page.close();
  }
  const status = (headers) =>
    new Promise((resolve, reject) => {
      const asked = request(lab.origin, { headers }, (answer) => resolve(answer.resume().statusCode));
      asked.on("error", reject);
      asked.end();
    });
  assert.equal(await status({}), 200);
  assert.equal(await status({ host: `rebound.example:${new URL(lab.origin).port}` }), 421);
});

test("a browser without Web Serial says which way remains", async () => {
  const context = await browsers.chromium.newContext();
  await context.addInitScript(() => Object.defineProperty(navigator, "serial", { value: undefined }));
  const tab = await Driver.open({ newContext() {}, newPage: () => context.newPage() });
  await tab.says("start `swimmer lab --port PORT`");
  assert.ok(await tab.evaluate(() => document.querySelector("#connect-serial").disabled));
  await context.close();
});

const WAYS = {
  light: { width: 1440, height: 900 },
  dark: { width: 1440, height: 900, dark: true },
  phone: { width: 360, height: 740 },
};
for (const [way, size] of Object.entries(WAYS)) {
  test(`Drive, ${way}`, async () => {
    const tab = await Driver.open(browsers.chromium, size);
    await tab.push("#connect-twin");
    await tab.play();
    await new Promise((resolve) => setTimeout(resolve, 1500));
    const overflow = await tab.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    await tab.page.screenshot({ path: join(SCREENSHOTS, `drive-${way}.png`), fullPage: true });
    assert.ok(overflow <= 0, `${overflow} px wider than the screen`);
    await tab.close();
  });
}
