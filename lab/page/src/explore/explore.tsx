// Explore: the height map, gaits laid over it, and what they swim.

import { signal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { Lab } from "../wasm/lab.ts";

const lab = new Lab();
const swum = signal("…");

export function Explore() {
  useEffect(() => {
    lab
      .json<{ displacement_over_length: number }>("simulate", { swimmer: "purcell", gait: "circle:70deg" })
      .then((told) => (swum.value = `X/L = ${told.displacement_over_length.toFixed(10)}`))
      .catch((error: Error) => (swum.value = error.message));
  }, []);
  return <p id="swum">{swum}</p>;
}
