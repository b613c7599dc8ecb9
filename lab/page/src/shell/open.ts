// The tab that is open.

import { signal } from "@preact/signals";
import { fragment, setFragment } from "./fragment.ts";

/** Name of the open tab; `undefined` before the first was chosen. */
export const opened = signal<string | undefined>(fragment().get("room") ?? undefined);

export function openRoom(id: string): void {
  opened.value = id;
  setFragment("room", id);
}
