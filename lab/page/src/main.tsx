// Entry point of the page: style, then the frame with its tabs.

import "./style/page.css";
import { render } from "preact";
import { App } from "./shell/app.tsx";
import { firstNumbers } from "./explore/model.ts";
import { times } from "./wasm/lab.ts";

const place = document.getElementById("app");
if (place) render(<App />, place);

// For measurements of the page.
Object.assign(globalThis, { swimmerLab: { times, firstNumbers } });
