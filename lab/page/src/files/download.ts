// Download of a file.

export function download(name: string, content: BlobPart, type: string): void {
  const place = URL.createObjectURL(new Blob([content], { type }));
  const link = document.createElement("a");
  link.href = place;
  link.download = name;
  link.click();
  // The browser has taken it by then.
  setTimeout(() => URL.revokeObjectURL(place), 10_000);
}
