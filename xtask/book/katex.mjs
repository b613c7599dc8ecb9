// Sets formulas: a JSON list of { tex, display } on standard input, a list of HTML on standard output.
import katex from "katex";

let text = "";
for await (const piece of process.stdin) text += piece;
const set = JSON.parse(text).map(({ tex, display }) =>
  katex.renderToString(tex, { displayMode: display, throwOnError: true, strict: "error", output: "htmlAndMathml" }),
);
process.stdout.write(JSON.stringify(set));
