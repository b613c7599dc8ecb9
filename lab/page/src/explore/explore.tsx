// Explore tab: height map, gaits on the map, and the motion of the swimmer.

import "./explore.css";
import { useDrop } from "../files/drop.ts";
import { Gaits } from "./gaits.tsx";
import { HeightMap } from "./map.tsx";
import { openFiles } from "./open.ts";
import { Plots } from "./plots.tsx";
import { Readout } from "./readout.tsx";
import { followFragment } from "./share.ts";
import { Sliders } from "./sliders.tsx";
import { Swimming } from "./swimming.tsx";
import { waiting } from "../wasm/lab.ts";
import { Toolbar } from "./toolbar.tsx";

void followFragment();

const open = (files: File[]) => void openFiles(files);

export function Explore() {
  useDrop("explore", open);
  return (
    <div id="explore" aria-busy={waiting.value > 0}>
      <Toolbar />
      <div class="explore">
        <div class="column">
          <HeightMap />
          <Plots />
        </div>
        <div class="column">
          <Readout />
          <Swimming />
        </div>
        <div class="column">
          <Gaits />
          <Sliders />
        </div>
      </div>
    </div>
  );
}
