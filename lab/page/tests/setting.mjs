// Where the tests find what `cargo xtask` built, and the browsers. Every path can be told by a variable.

import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdirSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const root = resolve(dirname(fileURLToPath(import.meta.url)), "../../..");
const target = process.env.LAB_TARGET ?? join(root, "target");

export const PAGE = pathToFileURL(join(target, "lab/swimmer-lab.html")).href;
export const MODULE = join(target, "lab/explore.wasm");
export const SWIMMER = join(target, "debug/swimmer");
export const OUT = join(target, "lab");
export const SCREENSHOTS = join(OUT, "screenshots");
mkdirSync(SCREENSHOTS, { recursive: true });

const found = (paths) => paths.find((path) => path && existsSync(path));
export const CHROMIUM = found([process.env.LAB_CHROMIUM, "/usr/bin/chromium", "/usr/bin/google-chrome"]);
export const FIREFOX = found([process.env.LAB_FIREFOX, "/usr/bin/firefox-esr", "/usr/bin/firefox"]);

/** What the command prints for people, or the reason that it gives. */
export function printed(...words) {
  const { stdout, stderr } = spawnSync(SWIMMER, words, { encoding: "utf8" });
  return { stdout, reason: stderr.replace(/^[^]*?error: /, "").trim() };
}

/** What the command answers as JSON; a certificate that fails is an answer too. */
export function swimmer(...words) {
  try {
    return JSON.parse(execFileSync(SWIMMER, [...words, "--json"], { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] }));
  } catch (error) {
    if (error.status === 1 && error.stdout) return JSON.parse(error.stdout);
    throw new Error(`swimmer ${words.join(" ")}: ${error.stderr ?? error.message}`);
  }
}
