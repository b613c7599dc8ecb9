// Tabs of the page, one line each. A tab is mounted when it is first opened and stays mounted.

import type { ComponentType } from "preact";
import { Calibrate } from "../calibrate/calibrate.tsx";
import { Drive } from "../drive/drive.tsx";
import { Explore } from "../explore/explore.tsx";
import { Maps } from "../maps/maps.tsx";

export interface Tab {
  /** Name in the fragment of the URL. */
  id: string;
  name: string;
  /** Purpose in one sentence. */
  about: string;
  /** Key that opens the tab together with Alt. */
  key: string;
  Panel: ComponentType;
}

export const TABS: readonly Tab[] = [
  { id: "explore", name: "Explore", about: "Drag a gait over the height map and watch it swim.", key: "1", Panel: Explore },
  { id: "drive", name: "Drive", about: "Connect the robot, upload the gait, play and stop.", key: "2", Panel: Drive },
  { id: "calibrate", name: "Calibrate", about: "Fit drag and sphere to tracking files.", key: "3", Panel: Calibrate },
  { id: "maps", name: "Maps", about: "Read the map of a sweep over many designs.", key: "4", Panel: Maps },
];
