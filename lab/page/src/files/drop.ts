// Files dropped anywhere on a tab, or chosen; the tab decides which files it opens.

import { signal } from "@preact/signals";
import { useLayoutEffect } from "preact/hooks";

/** `true` while files are dragged over the page. */
export const dragging = signal(false);

/** Calls `open` for files dropped on the page while `place` is visible. */
export function useDrop(place: string, open: (files: File[]) => void): void {
  useLayoutEffect(() => {
    const here = () => document.getElementById(place)?.offsetParent !== null;
    const over = (event: DragEvent) => {
      if (!here() || !event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      dragging.value = true;
    };
    // A drag that leaves the window has no element that it enters.
    const leave = (event: DragEvent) => event.relatedTarget === null && (dragging.value = false);
    const drop = (event: DragEvent) => {
      dragging.value = false;
      const files = [...(event.dataTransfer?.files ?? [])];
      if (!here() || files.length === 0) return;
      event.preventDefault();
      open(files);
    };
    window.addEventListener("dragover", over);
    window.addEventListener("dragleave", leave);
    window.addEventListener("drop", drop);
    return () => {
      window.removeEventListener("dragover", over);
      window.removeEventListener("dragleave", leave);
      window.removeEventListener("drop", drop);
    };
  }, [place, open]);
}
