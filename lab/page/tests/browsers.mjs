// The two browsers behind one small set of doings, so that a test is told once.

import { readFileSync } from "node:fs";
import { chromium } from "playwright-core";
import puppeteer from "puppeteer-core";
import { CHROMIUM, FIREFOX, PAGE } from "./setting.mjs";

/** Browsers by name, each with a function that starts it. */
export const BROWSERS = {
  chromium: () => chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox", "--disable-gpu"] }),
  firefox: () => puppeteer.launch({ browser: "firefox", executablePath: FIREFOX, headless: true }),
};

/** Milliseconds that anything may take without a sign of progress, and with signs; the machines of CI are slow and shared. */
const PATIENCE = 60_000;
const LONGEST = 600_000;

/** Firefox ESR has no command for the screen's orientation, which comes after the size has been set. */
function unlessOrientation(error) {
  if (!String(error).includes("setScreenOrientationOverride")) throw error;
}

/** One tab with the page in it. What the console says is kept: a page has nothing to say there. */
export class Tab {
  constructor(page, said) {
    this.page = page;
    this.said = said;
  }

  static async open(browser, { hash = "", width = 1440, height = 900, dark = false, url = PAGE } = {}) {
    const isPlaywright = typeof browser.newContext === "function";
    const page = isPlaywright
      ? await browser.newPage({ viewport: { width, height }, colorScheme: dark ? "dark" : "light" })
      : await browser.newPage();
    if (!isPlaywright) await page.setViewport({ width, height }).catch(unlessOrientation);
    const said = [];
    page.on("console", (message) => said.push(message.text()));
    page.on("pageerror", (error) => said.push(String(error)));
    await page.goto(url + hash);
    const tab = new Tab(page, said);
    await tab.settled();
    return tab;
  }

  evaluate(perform, argument) {
    return this.page.evaluate(perform, argument);
  }

  /**
   * Waits until the page says yes, by something that can be sent: no element. The patience begins anew when the page reports progress:
   * a search that is under way may take several times as long on a busy machine.
   */
  async until(ask, argument, what = ask) {
    const begun = Date.now();
    let [progress, since] = ["", begun];
    for (;;) {
      const answer = await this.evaluate(ask, argument);
      if (answer) return answer;
      const status = await this.evaluate(() => [...document.querySelectorAll('[aria-busy="true"] [role="status"]')].map(({ textContent }) => textContent).join("; "));
      const now = Date.now();
      if (status !== progress) [progress, since] = [status, now];
      if (now - since > PATIENCE || now - begun > LONGEST) throw new Error(`waiting in vain for ${what} (${progress}); the page said: ${this.said.join("; ")}`);
      await new Promise((resolve) => setTimeout(resolve, 25));
    }
  }

  /** Waits until nothing is being computed. */
  settled() {
    const quiet = () => document.querySelector("[aria-busy]") !== null && document.querySelector('[aria-busy="true"]') === null;
    return this.until(quiet, undefined, "the page to settle");
  }

  text(selector) {
    return this.evaluate((selector) => document.querySelector(selector)?.textContent ?? null, selector);
  }

  /** The numbers of both gaits, as the module told them. */
  async exact() {
    return JSON.parse(await this.text("#exact"));
  }

  /** The middle of an element, on the screen. */
  middle(selector) {
    return this.evaluate((selector) => {
      const element = document.querySelector(selector);
      element.scrollIntoView({ block: "center" });
      const box = element.getBoundingClientRect();
      return [box.x + box.width / 2, box.y + box.height / 2];
    }, selector);
  }

  async click(selector) {
    const [x, y] = await this.middle(selector);
    await this.page.mouse.click(x, y);
  }

  async drag(selector, [dx, dy], steps = 8) {
    const [x, y] = await this.middle(selector);
    await this.page.mouse.move(x, y);
    await this.page.mouse.down();
    for (let k = 1; k <= steps; k++) await this.page.mouse.move(x + (dx * k) / steps, y + (dy * k) / steps);
    await this.page.mouse.up();
    await this.settled();
  }

  /** Keys held together: the last is pressed, the others are held. */
  async press(...keys) {
    const last = keys.pop();
    for (const key of keys) await this.page.keyboard.down(key);
    await this.page.keyboard.press(last);
    for (const key of keys.reverse()) await this.page.keyboard.up(key);
    await this.settled();
  }

  /** Chooses of a list by its words. */
  choose(label, words) {
    return this.evaluate(
      ([label, words]) => {
        const select = document.querySelector(`select[aria-label="${label}"], select#${CSS.escape(label)}`);
        select.value = words;
        select.dispatchEvent(new Event("change", { bubbles: true }));
      },
      [label, words],
    );
  }

  /** The text of what the page hands over when `perform` is done. */
  async saved(perform) {
    await this.evaluate(() => {
      window.handedOver = undefined;
      const create = URL.createObjectURL;
      URL.createObjectURL = (blob) => {
        URL.createObjectURL = create;
        window.handedOver = blob;
        return create.call(URL, blob);
      };
    });
    await perform();
    await this.until(() => window.handedOver !== undefined, undefined, "a file");
    return this.evaluate(async () => {
      const bytes = new Uint8Array(await window.handedOver.arrayBuffer());
      return { type: window.handedOver.type, text: Array.from(bytes, (byte) => String.fromCharCode(byte)).join("") };
    });
  }

  /** Drops files onto the page, once it lets them be dropped. */
  async drop(...paths) {
    const files = paths.map((path) => ({ name: path.split("/").pop(), base64: readFileSync(path, "base64") }));
    const taken = (files) => {
      const data = new DataTransfer();
      for (const { name, base64 } of files) data.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name));
      const refused = (type) => window.dispatchEvent(new DragEvent(type, { dataTransfer: data, bubbles: true, cancelable: true }));
      return !refused("dragover") && !refused("drop");
    };
    await this.until(taken, files, "a place for files");
    await new Promise((resolve) => setTimeout(resolve, 100));
    await this.settled();
  }

  close() {
    return this.page.close();
  }
}
