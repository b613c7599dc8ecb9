// Frame of the page: list of tabs, the open tab, and the version of the page.

import { computed } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { EStop, RobotBar } from "../drive/bar.tsx";
import { link } from "../drive/robot.ts";
import { opened, openRoom } from "./open.ts";
import { TABS } from "./tabs.tsx";
import { ThemeToggle } from "./theme.tsx";

const open = computed(() => TABS.find((tab) => tab.id === opened.value)?.id ?? TABS[0]?.id ?? "");
const visited = new Set<string>();

export function App() {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      const tab = event.altKey && TABS.find(({ key }) => key === event.key);
      if (!tab) return;
      event.preventDefault();
      openRoom(tab.id);
      document.getElementById(`tab-${tab.id}`)?.focus();
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
          {TABS.map(({ id, name, about, key }) => (
            <button
              key={id}
              id={`tab-${id}`}
              role="tab"
              aria-selected={open.value === id}
              aria-controls={`panel-${id}`}
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
        {TABS.filter(({ id }) => visited.has(id)).map(({ id, Panel }) => (
          <div key={id} id={`panel-${id}`} class="panel" role="tabpanel" aria-labelledby={`tab-${id}`} hidden={open.value !== id}>
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
  const at = TABS.findIndex(({ id }) => id === open.value);
  const tab = TABS[(at + step + TABS.length) % TABS.length];
  if (!tab) return;
  openRoom(tab.id);
  document.getElementById(`tab-${tab.id}`)?.focus();
}
