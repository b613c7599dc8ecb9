// Files dropped anywhere on a tab, or chosen; the tab decides which files it opens.

import { useLayoutEffect } from "preact/hooks";

/** Calls `open` for files dropped on the page while `place` is visible. */
export function useDrop(place: string, open: (files: File[]) => void): void {
  useLayoutEffect(() => {
    const here = () => document.getElementById(place)?.offsetParent !== null;
    const over = (event: DragEvent) => {
      if (here() && event.dataTransfer?.types.includes("Files")) event.preventDefault();
    };
    const drop = (event: DragEvent) => {
      const files = [...(event.dataTransfer?.files ?? [])];
      if (!here() || files.length === 0) return;
      event.preventDefault();
      open(files);
    };
    window.addEventListener("dragover", over);
    window.addEventListener("drop", drop);
    return () => {
      window.removeEventListener("dragover", over);
      window.removeEventListener("drop", drop);
    };
  }, [place, open]);
}
