// What the tests of Drive need: `swimmer lab` and `swimmer twin` as processes, a page that drives, a serial port played by the test.

import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { connect } from "node:net";
import { fileURLToPath } from "node:url";
import { Tab } from "./browsers.mjs";
import { PAGE, SWIMMER } from "./setting.mjs";

const FILE = fileURLToPath(PAGE);

/** A `swimmer` that lives until it is ended, and the first line it says. */
class Process {
  static async start(...words) {
    const child = spawn(SWIMMER, words, { stdio: ["ignore", "pipe", "inherit"] });
    let said = "";
    for await (const piece of child.stdout) {
      said += piece;
      if (said.includes("\n")) break;
    }
    child.stdout.resume?.();
    const process = new this();
    process.child = child;
    process.said = said;
    return process;
  }

  end() {
    if (this.child.exitCode !== null || this.child.signalCode !== null) return undefined;
    const gone = new Promise((resolve) => this.child.once("exit", resolve));
    this.child.kill("SIGINT");
    return gone;
  }
}

/** The server of the page, with a robot. */
export class Lab extends Process {
  static start(port, ...more) {
    return super.start("lab", "--port", port, "--page", FILE, "--no-browser", ...more);
  }

  get address() {
    return /http:\S+/.exec(this.said)[0];
  }

  get origin() {
    return new URL(this.address).origin;
  }

  get token() {
    return /link=(\w+)/.exec(this.address)[1];
  }
}

/** A robot behind TCP, in a process of its own. */
export class Twin extends Process {
  static start(port = 0) {
    return super.start("twin", "--tcp", `127.0.0.1:${port}`);
  }

  get port() {
    return Number(/tcp:127\.0\.0\.1:(\d+)/.exec(this.said)[1]);
  }
}

/** Any page that is not ours, or ours from another server. */
export async function served(text = readFileSync(FILE)) {
  const server = createServer((_, answer) => answer.writeHead(200, { "content-type": "text/html" }).end(text));
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return { url: `http://127.0.0.1:${server.address().port}/`, end: () => server.close() };
}

/** A tab in the room Drive. */
export class Driver extends Tab {
  static async open(browser, options) {
    const tab = Object.setPrototypeOf(await Tab.open(browser, options), Driver.prototype);
    await tab.push("#tab-drive");
    return tab;
  }

  /** Presses a button as soon as it may be pressed. */
  async push(selector) {
    await this.until((selector) => document.querySelector(`${selector}:not(:disabled)`) !== null, selector, `the button ${selector}`);
    await this.evaluate((selector) => document.querySelector(selector).click(), selector);
  }

  state(name) {
    return this.until((name) => document.querySelector("#state")?.dataset.state === name, name, `the state ${name}`);
  }

  says(words) {
    return this.until((words) => document.querySelector("#panel-drive").textContent.includes(words), words, `"${words}"`);
  }

  /** Sets period, s, and cycles of the next play, once the robot has replied. */
  async timing(period, cycles) {
    await this.until(() => document.querySelector("#panel-drive #cycles") !== null, undefined, "the fields of a play");
    await this.evaluate(
      ([period, cycles]) => {
        for (const [selector, value] of [['input[type="number"][step="0.1"]', period], ["#cycles", cycles]]) {
          const input = document.querySelector(`#panel-drive ${selector}`);
          input.value = value;
          input.dispatchEvent(new Event("change", { bubbles: true }));
        }
      },
      [period, cycles],
    );
  }

  /** Uploads Explore's gait and plays it until told otherwise. */
  async play() {
    await this.says("The robot will play it");
    await this.push("#upload");
    await this.says("The gait is on the robot");
    await this.push("#arm");
    await this.state("Holding");
    await this.push("#play");
    await this.state("Playing");
  }

  space() {
    return this.page.keyboard.press(" ");
  }
}

/** What the page and its workers take for the browser's serial ports: bytes go through a channel to the page, and from there on. */
const STAND_IN = `(() => {
  const channel = new BroadcastChannel("stand-in");
  if (typeof document !== "undefined") {
    channel.onmessage = ({ data }) => data.to && window.toRobot(data.to);
    window.fromRobot = (bytes) => channel.postMessage({ from: bytes });
    window.cable = (plugged) => channel.postMessage({ plugged });
    Object.defineProperty(navigator, "serial", { value: { requestPort: async () => ({}), getPorts: async () => [] } });
    return;
  }
  let plugged = true;
  const port = {
    async open() {
      this.readable = new ReadableStream({ start: (controller) => void (this.controller = controller) });
      this.writable = new WritableStream({ write: (bytes) => channel.postMessage({ to: [...bytes] }) });
    },
    async close() {},
  };
  channel.onmessage = ({ data }) => {
    if (data.from && plugged) port.controller?.enqueue(new Uint8Array(data.from));
    if (data.plugged === undefined) return;
    plugged = data.plugged;
    if (!plugged) port.controller?.error(new DOMException("The device has been lost.", "NetworkError"));
    port.controller = undefined;
  };
  Object.defineProperty(navigator, "serial", { value: { getPorts: async () => (plugged ? [port] : []) } });
})();`;

/** A context whose pages have a serial port, with the twin behind it. */
export async function withSerialPort(browser, twin) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 } });
  await context.addInitScript(`${STAND_IN}
    const WholeBlob = Blob;
    window.Blob = class extends WholeBlob {
      constructor(parts, options) {
        super(options?.type === "text/javascript" ? [${JSON.stringify(STAND_IN)}, ...parts] : parts, options);
      }
    };`);
  const socket = connect(twin.port, "127.0.0.1").setNoDelay();
  await context.exposeFunction("toRobot", (bytes) => void socket.write(Buffer.from(bytes)));
  return {
    /** As a browser, for [`Driver.open`]. */
    newContext() {},
    async newPage() {
      const page = await context.newPage();
      socket.on("data", (data) => void page.evaluate((bytes) => window.fromRobot?.(bytes), [...data]).catch(() => undefined));
      return page;
    },
    close() {
      socket.destroy();
      return context.close();
    },
  };
}
