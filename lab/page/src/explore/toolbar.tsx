// Toolbar: undo, redo, open, save, share, with buttons and keys.

import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { OpenButton } from "../files/open-button.tsx";
import { canRedo, canUndo, redo, undo } from "./document.ts";
import { unit } from "./names.ts";
import { openFiles } from "./open.ts";
import { saveGait, saveGif, savePng, saveSvg, saveSwimmer, saveTable, saveVideo } from "./save.ts";
import { copyLink } from "./share.ts";
import { playing } from "./swimming.tsx";

const said = signal("");

const SAVES: readonly { name: string; save: () => void | Promise<void> }[] = [
  { name: "Gait file", save: saveGait },
  { name: "Swimmer file", save: saveSwimmer },
  { name: "Map, SVG", save: saveSvg },
  { name: "Map, PNG", save: savePng },
  { name: "Motion, GIF", save: saveGif },
  { name: "Motion, WebM", save: saveVideo },
  { name: "Motion, CSV", save: saveTable },
];

async function perform(name: string, save: () => void | Promise<void>): Promise<void> {
  said.value = `${name} …`;
  try {
    await save();
    said.value = `${name}: saved`;
  } catch (error) {
    said.value = error instanceof Error ? error.message : String(error);
  }
}

export function Toolbar() {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      const typing = event.target instanceof HTMLInputElement && event.target.type !== "range" && event.target.type !== "checkbox";
      if (typing || !document.getElementById("explore")?.offsetParent) return;
      const key = event.key.toLowerCase();
      if ((event.ctrlKey || event.metaKey) && key === "z") (event.shiftKey ? redo : undo)();
      else if ((event.ctrlKey || event.metaKey) && key === "y") redo();
      else if ((event.ctrlKey || event.metaKey) && key === "s") void perform("Gait file", saveGait);
      else if (key === "k" && !event.ctrlKey && !event.metaKey && !event.altKey) playing.value = !playing.value;
      else return;
      event.preventDefault();
    };
    window.addEventListener("keydown", onKey);
    return () => window.removeEventListener("keydown", onKey);
  }, []);
  return (
    <div class="toolbar" role="toolbar" aria-label="Document">
      <button onClick={undo} disabled={!canUndo()} title="Ctrl+Z">Undo</button>
      <button onClick={redo} disabled={!canRedo()} title="Ctrl+Shift+Z">Redo</button>
      <OpenButton id="open-file" name="Open…" accept=".toml,.txt,.gait,.csv" open={(files) => void openFiles(files)} />
      <select
        aria-label="Save"
        value=""
        onChange={(event) => {
          const chosen = SAVES.find(({ name }) => name === event.currentTarget.value);
          event.currentTarget.value = "";
          if (chosen) void perform(chosen.name, chosen.save);
        }}
      >
        <option value="" disabled>Save…</option>
        {SAVES.map(({ name }) => <option key={name}>{name}</option>)}
      </select>
      <button onClick={async () => (said.value = await copyLink())}>Copy link</button>
      <button onClick={() => (unit.value = unit.value === "°" ? "rad" : "°")} title="Unit of every angle on this page">Angles in {unit.value === "°" ? "degrees" : "radians"}</button>
      <span class="soft" role="status">{said}</span>
    </div>
  );
}
