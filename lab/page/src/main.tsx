// Where the page begins: style, then the shell with its rooms.

import "./style/page.css";
import { render } from "preact";
import { App } from "./shell/app.tsx";

const place = document.getElementById("app");
if (place) render(<App />, place);
