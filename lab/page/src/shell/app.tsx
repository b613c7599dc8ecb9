// Frame of the page: list of tabs, the open tab, and the version of the page.

import { computed } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { EStop, RobotBar } from "../drive/bar.tsx";
import { link } from "../drive/robot.ts";
import { opened, openRoom } from "./open.ts";
import { ROOMS } from "./rooms.tsx";
import { ThemeToggle } from "./theme.tsx";

const open = computed(() => ROOMS.find((room) => room.id === opened.value)?.id ?? ROOMS[0]?.id ?? "");
const visited = new Set<string>();

export function App() {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      const room = event.altKey && ROOMS.find(({ key }) => key === event.key);
      if (!room) return;
      event.preventDefault();
      openRoom(room.id);
      document.getElementById(`tab-${room.id}`)?.focus();
    };
    window.addEventListener("keydown", onKey);
    return () => window.removeEventListener("keydown", onKey);
  }, []);
  visited.add(open.value);
  return (
    <>
      <header class="rail">
        <span class="mark" aria-hidden="true">
          <svg viewBox="0 0 16 16"><path d="M1 11 5 6l6 3 4-6" /></svg>
        </span>
        <h1>swimmer lab</h1>
        <div role="tablist" aria-label="Rooms" class="tabs" onKeyDown={moveAlong}>
          {ROOMS.map(({ id, name, about, key }) => (
            <button
              key={id}
              id={`tab-${id}`}
              role="tab"
              aria-selected={open.value === id}
              aria-controls={`room-${id}`}
              tabIndex={open.value === id ? 0 : -1}
              title={`${about} (Alt+${key})`}
              onClick={() => openRoom(id)}
            >
              {name}
            </button>
          ))}
        </div>
        <ThemeToggle />
        <span class="version" title="Page and module were built from this commit">
          {VERSION} · {HASH}
        </span>
        <RobotBar />
      </header>
      <main>
        {ROOMS.filter(({ id }) => visited.has(id)).map(({ id, Panel }) => (
          <div key={id} id={`room-${id}`} class="panel" role="tabpanel" aria-labelledby={`tab-${id}`} hidden={open.value !== id}>
            <Panel />
          </div>
        ))}
      </main>
      {link.value.state !== "closed" && <div class="place-of-estop" />}
      <EStop />
    </>
  );
}

/** Moves between tabs with the arrow keys, as the ARIA pattern for tabs requires. */
function moveAlong(event: KeyboardEvent): void {
  const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  if (!step) return;
  event.preventDefault();
  const at = ROOMS.findIndex(({ id }) => id === open.value);
  const room = ROOMS[(at + step + ROOMS.length) % ROOMS.length];
  if (!room) return;
  openRoom(room.id);
  document.getElementById(`tab-${room.id}`)?.focus();
}
