// Bundles the page into one HTML file: `node build.mjs OUTPUT.html VERSION HASH MODULE.wasm.gz…`.
//
// A module goes in compressed, as text that the browser's parser passes over; a worker goes in as text that is made a Blob,
// because a page opened from disk may load nothing beside itself. The page's charset is windows-1252, so that a compressed byte is
// a byte of the page; all else in it is ASCII, and the bundler escapes what is not.

import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const [outputPath, version, hash, ...modulePaths] = process.argv.slice(2);
if (modulePaths.length === 0) {
  console.error("usage: node build.mjs OUTPUT.html VERSION HASH MODULE.wasm.gz…");
  process.exit(2);
}

const options = {
  bundle: true,
  write: false,
  format: "iife",
  target: ["chrome110", "firefox115"],
  minify: true,
  legalComments: "none",
  charset: "ascii",
  jsx: "automatic",
  jsxImportSource: "preact",
  loader: { ".svg": "text" },
  define: { VERSION: JSON.stringify(version), HASH: JSON.stringify(hash) },
  logLevel: "warning",
};

/** `import source from "worker:./worker.ts"`: the bundled worker as text. */
const workers = {
  name: "workers",
  setup(plugin) {
    plugin.onResolve({ filter: /^worker:/ }, ({ path, resolveDir }) => ({
      path: resolve(resolveDir, path.slice("worker:".length)),
      namespace: "worker",
    }));
    plugin.onLoad({ filter: /.*/, namespace: "worker" }, async ({ path }) => {
      const bundled = await build({ ...options, entryPoints: [path] });
      return { contents: bundled.outputFiles[0].text, loader: "text" };
    });
  },
};

async function bundled(entry) {
  const result = await build({ ...options, entryPoints: [join(here, entry)], outdir: "out", plugins: [workers] });
  const of = (ending) => result.outputFiles.find((file) => file.path.endsWith(ending))?.text ?? "";
  return { script: of(".js"), style: of(".css") };
}

const { script, style } = await bundled("src/main.tsx");

/** Bytes that HTML would read as something else (NUL, carriage return, the beginning of a tag), and the mark that escapes them. */
const MARK = 16;
const READ_OTHERWISE = new Set([0, 13, 60, MARK]);
/** A compressed module with one letter for each byte: the page's charset has a letter for every byte. */
function packed(path) {
  const letters = [];
  for (const byte of readFileSync(path)) {
    if (READ_OTHERWISE.has(byte)) letters.push(MARK, byte + 1);
    else letters.push(byte);
  }
  return Buffer.from(letters).toString("latin1");
}
const modules = modulePaths
  .map((path) => `<script type="text/plain" id="module-${basename(path, ".wasm.gz")}">${packed(path)}</script>`)
  .join("\n");
// Nothing in it may look like the end of the element that holds it.
const inScript = (text) => text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const parts = { style: style.replaceAll("</style", "<\\/style"), script: inScript(script), modules, version, hash };
const template = readFileSync(join(here, "src/index.html"), "utf8");
const page = template.replace(/@(style|script|modules|version|hash)@/g, (_, part) => parts[part]);
mkdirSync(dirname(resolve(outputPath)), { recursive: true });
if (/[^\0-\xff]/.test(page)) throw new Error("the page holds a letter that is no byte: write it as an escape");
writeFileSync(outputPath, page, "latin1");
const kilobytes = (length) => `${Math.round(length / 1000)} kB`;
console.log(
  `script ${kilobytes(script.length)}, style ${kilobytes(style.length)}, modules ${kilobytes(modules.length)} as text`,
);
