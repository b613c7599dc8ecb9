// The URL's fragment holds what a link shares: pairs as in a query, nothing that a server would see.

/** Its pairs, decoded. */
export function fragment(): URLSearchParams {
  return new URLSearchParams(location.hash.slice(1));
}

/** Sets a pair, or removes it, without a step in the browser's history. */
export function setFragment(key: string, value: string | undefined): void {
  const pairs = fragment();
  if (value === undefined) pairs.delete(key);
  else pairs.set(key, value);
  history.replaceState(null, "", `#${pairs}`);
}
