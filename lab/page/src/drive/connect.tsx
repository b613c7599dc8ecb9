// How the robot is reached: in this page, over the browser's serial port, or through `swimmer lab`.

import { signal } from "@preact/signals";
import { shown } from "../explore/document.ts";
import { swimmer } from "../explore/model.ts";
import { connect, disconnect, leaveWheel, link, served, takeWheel, wheel } from "./robot.ts";
import { serial } from "./wires.ts";

const BAUD = 115_200;
/** The text of a key file, for a robot that has a key. */
const key = signal<{ name: string; text: string } | null>(null);
const refused = signal("");
const socket = served();

const connectTwin = () =>
  connect({ kind: "twin", swimmer: swimmer.value?.toml ?? shown.value.swimmer, seed: crypto.getRandomValues(new Uint32Array(1))[0] ?? 1 }, key.value?.text ?? null);

async function connectSerial(): Promise<void> {
  refused.value = "";
  try {
    // The browser shows the ports; the worker then has the one that was chosen.
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
      <label class="soft key">
        Key file, for a robot that has a key:{" "}
        <input
          type="file"
          aria-label="Key file"
          onChange={(event) => {
            const file = event.currentTarget.files?.[0];
            if (!file) key.value = null;
            else void file.text().then((text) => (key.value = { name: file.name, text }));
          }}
        />
      </label>
      {refused.value && <p class="error" role="status">{refused.value}</p>}
      <p class="soft">Tried with the robot in the page, with a serial port played by a test, and over the WebSocket; no real port and no Android phone was tried.</p>
    </section>
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
