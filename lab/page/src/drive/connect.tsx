// Connection to the robot: in this page, over the browser's serial port, or through `swimmer lab`.

import { signal } from "@preact/signals";
import { shown } from "../explore/document.ts";
import { swimmer } from "../explore/model.ts";
import { OpenButton } from "../files/open-button.tsx";
import { connect, disconnect, leaveWheel, link, served, takeWheel, wheel } from "./robot.ts";
import { SetUp } from "./setup.tsx";
import { serial } from "./wires.ts";

const BAUD = 115_200;
/** The text of a key file, for a robot that has a key. */
const key = signal<{ name: string; text: string } | null>(null);
/** Reason why the last chosen key is invalid. */
const noKey = signal("");
const refused = signal("");
const socket = served();

const connectTwin = () =>
  connect({ kind: "twin", swimmer: swimmer.value?.toml ?? shown.value.swimmer, seed: crypto.getRandomValues(new Uint32Array(1))[0] ?? 1 }, key.value?.text ?? null);

async function connectSerial(): Promise<void> {
  refused.value = "";
  try {
    // The browser shows the ports; the worker opens the chosen one.
    await serial()?.requestPort?.();
    connect({ kind: "serial", baud: BAUD }, key.value?.text ?? null);
  } catch (error) {
    refused.value = `No port was chosen (${error instanceof Error ? error.message : String(error)}).`;
  }
}

export function Connect() {
  const { state, name, reason } = link.value;
  if (state !== "closed") {
    return (
      <section class="card" aria-label="Connection">
        <div class="bar-of-buttons">
          <h2>{STATES[state]}</h2>
          <span class="soft">{name}</span>
          <button onClick={disconnect}>Disconnect</button>
        </div>
        {key.value && <p class="soft">Signed with the key {key.value.name}.</p>}
        {reason && <p class={state === "gone" ? "error" : "soft"} role="status">{reason}</p>}
        <Wheel />
      </section>
    );
  }
  return (
    <section class="card" aria-label="Connection">
      <h2>Connect a robot</h2>
      <div class="ways">
        <button onClick={connectTwin} id="connect-twin">Robot in this page</button>
        <span class="soft">The brain of the firmware, in a virtual tank, of the swimmer in Explore.</span>
        <button onClick={() => void connectSerial()} disabled={!serial()} id="connect-serial">Serial port</button>
        <span class="soft">
          {serial()
            ? "A board on USB, or a Bluetooth port (RFCOMM) of this computer."
            : "This browser has no Web Serial: use a newer Chrome, Edge or Firefox, or start `swimmer lab --port PORT`."}
        </span>
        <button onClick={() => socket && connect({ kind: "socket", ...socket }, key.value?.text ?? null)} disabled={!socket} id="connect-socket">
          Served robot
        </button>
        <span class="soft">
          {socket ? "The robot of the `swimmer lab` that served this page." : "Start `swimmer lab --port PORT` and open the address that it prints."}
        </span>
      </div>
      <KeyField />
      {refused.value && <p class="error" role="status">{refused.value}</p>}
      <SetUp />
      <p class="soft">Tried with the robot in the page, with a serial port played by a test, and over the WebSocket; no real port and no Android phone was tried.</p>
    </section>
  );
}

/** Parses a key: 32 hexadecimal digits in one line; lines that begin with # are comments. */
function take(name: string, text: string): void {
  const lines = text.split(/\r?\n/).map((line) => line.trim()).filter((line) => line !== "" && !line.startsWith("#"));
  const isKey = lines.length === 1 && /^[0-9a-f]{32}$/i.test(lines[0] ?? "");
  key.value = isKey ? { name, text } : null;
  noKey.value = isKey ? "" : `${name} holds no key: 32 hexadecimal digits in one line are one; \`swimmer robot key make FILE\` writes one.`;
}

/** Key of a robot: from a file or typed. The present key is named and can be removed. */
function KeyField() {
  if (key.value) {
    return (
      <p class="robot-key" id="key">
        <span>Key: {key.value.name}</span> <button class="small" onClick={() => (key.value = null)}>Remove</button>
      </p>
    );
  }
  return (
    <form class="robot-key" id="key" onSubmit={(event) => event.preventDefault()}>
      <span class="soft">Key, only for a robot that has one:</span>
      <OpenButton id="key-file" name="Choose file…" accept="" open={([file]) => file && void file.text().then((text) => take(file.name, text))} />
      <input
        type="password"
        id="key-digits"
        aria-label="Key, 32 hexadecimal digits"
        placeholder="or its 32 digits"
        autocomplete="off"
        spellcheck={false}
        onChange={(event) => event.currentTarget.value !== "" && take("as typed", event.currentTarget.value)}
      />
      {noKey.value && <p class="error" role="alert">{noKey.value}</p>}
    </form>
  );
}

const STATES = {
  closed: "Not connected",
  opening: "Opening",
  greeting: "Greeting",
  open: "Connected",
  watching: "Watching",
  gone: "Gone",
};

function Wheel() {
  if (!wheel.value) return null;
  const { yours, free } = wheel.value;
  if (yours) return <p class="soft">This page drives; others watch and may stop. <button class="small" onClick={leaveWheel}>Let go</button></p>;
  return (
    <p class="soft">
      {free ? "Nobody drives. " : "Another page drives; this one watches and may stop. "}
      {free && <button class="small" onClick={takeWheel}>Drive</button>}
    </p>
  );
}
