// Colour theme: light, dark, or that of the system.

import { effect, signal } from "@preact/signals";

type Theme = "system" | "light" | "dark";
const NEXT: Record<Theme, Theme> = { system: "light", light: "dark", dark: "system" };
const KEY = "swimmer-lab-theme";

function remembered(): Theme {
  try {
    const stored = localStorage.getItem(KEY);
    return stored === "light" || stored === "dark" ? stored : "system";
  } catch {
    return "system"; // a page from disk may be denied storage
  }
}

const system = matchMedia("(prefers-color-scheme: dark)");
const theme = signal<Theme>(remembered());
const systemDark = signal(system.matches);
system.addEventListener("change", (event) => (systemDark.value = event.matches));

/** `true` if the page is dark; used by drawings on a canvas. */
export const dark = signal(false);

effect(() => {
  dark.value = theme.value === "system" ? systemDark.value : theme.value === "dark";
  document.documentElement.dataset.theme = dark.value ? "dark" : "light";
});

export function ThemeToggle() {
  const change = () => {
    theme.value = NEXT[theme.value];
    try {
      localStorage.setItem(KEY, theme.value);
    } catch {
      // The choice is valid for this visit only.
    }
  };
  return (
    <button class="quiet" onClick={change} aria-label={`Colours: ${theme.value}`} title="Light, dark, or as the system says">
      {{ system: "◐", light: "☀", dark: "☾" }[theme.value]}
    </button>
  );
}
