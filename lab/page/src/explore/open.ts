// A swimmer or gait file, dropped or chosen.

import { edit, editGait } from "./document.ts";
import { quick, trouble } from "./model.ts";

/** Opens files one after the other; other files than swimmers and gaits are refused with the parser's message. */
export async function openFiles(files: readonly File[]): Promise<void> {
  for (const file of files) {
    const text = await file.text();
    try {
      if (/\.toml$/i.test(file.name)) {
        await quick.json("swimmer", { swimmer: text });
        edit({ swimmer: text, with: {} });
      } else {
        await quick.json("simulate", { swimmer: "purcell", gait: `${text}\n` });
        editGait({ kind: "text", name: file.name, text: `${text}\n` });
      }
      trouble.value = "";
    } catch (error) {
      trouble.value = `${file.name}: ${error instanceof Error ? error.message : String(error)}`;
    }
  }
}
