// Fragment of the URL with the data of a link: pairs as in a query, which are not sent to a server.

/** Decoded pairs. */
export function fragment(): URLSearchParams {
  return new URLSearchParams(location.hash.slice(1));
}

/** Sets or removes a pair without an entry in the browser's history. */
export function setFragment(key: string, value: string | undefined): void {
  const pairs = fragment();
  if (value === undefined) pairs.delete(key);
  else pairs.set(key, value);
  history.replaceState(null, "", `#${pairs}`);
}
