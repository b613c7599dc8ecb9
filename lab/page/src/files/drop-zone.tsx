// Invitation to drop files, shown while a tab has none.

import type { ComponentChildren } from "preact";
import { dragging } from "./drop.ts";

export function DropZone({ name, sample, children }: { name: string; sample: () => void; children: ComponentChildren }) {
  return (
    <section class={`drop-zone ${dragging.value ? "over" : ""}`} aria-label={name}>
      <h2>Drop files here, or press Open…</h2>
      {children}
      <p><button class="first" onClick={sample}>Try the sample</button></p>
      <p class="soft">The files stay on this computer.</p>
    </section>
  );
}
