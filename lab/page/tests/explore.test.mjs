// Explore in both browsers, from disk: what is dragged is what the command swims.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { BROWSERS, Tab } from "./browsers.mjs";
import { OUT, swimmer } from "./setting.mjs";

const HANDLE = '.handles circle[data-index="1"]';
const curve = (tab) => tab.evaluate(() => document.querySelector("#gait-0").getAttribute("d"));

for (const [name, launch] of Object.entries(BROWSERS)) {
  describe(`Explore in ${name}`, () => {
    let browser;
    before(async () => (browser = await launch()));
    after(() => browser?.close());

    test("a dragged gait swims as the command says of its file; undo and redo step", async () => {
      const tab = await Tab.open(browser);
      const drawn = await curve(tab);
      const [first] = await tab.exact();
      await tab.drag(HANDLE, [47, -31]);
      const dragged = await curve(tab);
      assert.notEqual(dragged, drawn);
      const [told] = await tab.exact();
      assert.notEqual(told.displacement_over_length, first.displacement_over_length);

      const { text } = await tab.saved(() => tab.choose("Save", "Gait file"));
      const file = join(OUT, `dragged-${name}.txt`);
      writeFileSync(file, text);
      const swum = swimmer("simulate", "--swimmer", "robot", "--gait", file);
      for (const key of ["displacement_over_length", "lateral_over_length", "rotation_rad", "efficiency", "delta_theta_rad"]) {
        assert.ok(Math.abs(told[key] - swum[key]) < 1e-9, `${key}: ${told[key]} in the page, ${swum[key]} by the command`);
      }

      await tab.press("Control", "z");
      assert.equal(await curve(tab), drawn, "a drag is one step");
      assert.deepEqual((await tab.exact())[0], first);
      await tab.press("Control", "Shift", "z");
      assert.equal(await curve(tab), dragged);
      assert.deepEqual(tab.said, []);
      await tab.close();
    });

    test("a report's link opens its swimmer and finds its gait", async () => {
      const shown = { swimmer: "purcell", maxAngle: 2.4, period: 20, gaits: [{ kind: "optimum", what: "displacement" }] };
      const tab = await Tab.open(browser, { hash: `#open=${encodeURIComponent(JSON.stringify(shown))}` });
      await tab.until(() => JSON.parse(document.querySelector("#exact").textContent)[0] !== null, undefined, "the gait");
      await tab.settled();
      const [told] = await tab.exact();
      const { displacement_over_length } = swimmer("optimize", "displacement", "--swimmer", "purcell", "--max-angle", "2.4");
      assert.ok(Math.abs(told.displacement_over_length - displacement_over_length) < 1e-9, `${told.displacement_over_length}`);
      assert.ok(!(await tab.evaluate(() => location.hash)).includes("open="));
      await tab.close();
    });

    test("a link opens what its sender saw", async () => {
      const tab = await Tab.open(browser);
      await tab.drag(HANDLE, [-20, 35]);
      await tab.choose("row", "theta");
      await tab.settled();
      const hash = await tab.until(() => location.hash.includes("explore=") && location.hash, undefined, "the fragment");
      await new Promise((resolve) => setTimeout(resolve, 600));
      const [there, numbers] = [await curve(tab), await tab.exact()];
      const latest = await tab.evaluate(() => location.hash);
      assert.ok(hash.length < 2000, "a drawn gait fits a link");
      await tab.close();
      const other = await Tab.open(browser, { hash: latest });
      await other.until((d) => document.querySelector("#gait-0").getAttribute("d") === d, there, "the same curve");
      await other.settled();
      assert.deepEqual(await other.exact(), numbers);
      assert.equal(await other.evaluate(() => document.querySelector("#row").value), "theta");
      const broken = await Tab.open(browser, { hash: "#explore=nonsense&room=nowhere" });
      assert.equal((await broken.exact())[0].links_cross, 0, "a broken link opens a fresh page");
      assert.deepEqual([...other.said, ...broken.said], []);
      await other.close();
      await broken.close();
    });

    test("files dropped on the page open, and what is neither is refused with a reason", async () => {
      const [own, gait, nameless, wrong] = ["own.toml", "own-gait.txt", "nameless.txt", "wrong.txt"].map((file) => join(OUT, file));
      writeFileSync(own, 'name = "dropped"\n[links]\nmiddle = 0.08\nside = 0.12\n[drag]\nchi = 1.8\nc_t = { log_aspect = 4.0 }\n');
      swimmer("optimize", "displacement", "--swimmer", own, "--max-angle", "2", "-o", gait, "--overwrite");
      writeFileSync(wrong, "neither this nor that\n");
      const tab = await Tab.open(browser);
      await tab.drop(own, gait);
      const swum = swimmer("simulate", "--swimmer", own, "--gait", gait);
      const [told] = await tab.exact();
      assert.ok(Math.abs(told.displacement_over_length - swum.displacement_over_length) < 1e-9);
      await tab.until(() => document.querySelector(".certificate.pass:not(.stale)") !== null, undefined, "its certificate");
      // A file that does not tell what it is optimal for is asked what the page asks.
      writeFileSync(nameless, readFileSync(gait, "utf8").replace("objective: displacement", "objective: unspecified"));
      const other = await Tab.open(browser);
      await other.drop(own, nameless);
      assert.deepEqual((await other.exact())[0], told);
      await other.until(() => document.querySelector("details.certificate:not(.stale)") !== null, undefined, "its certificate too");
      assert.deepEqual(other.said, []);
      await other.close();
      await tab.drop(wrong);
      await tab.until(() => document.querySelector(".error") !== null, undefined, "a refusal");
      assert.match(await tab.text(".error"), /wrong\.txt: .*gait/);
      assert.deepEqual(tab.said, []);
      await tab.close();
    });

    test("everything can be done by keyboard", async () => {
      const tab = await Tab.open(browser);
      const before = await curve(tab);
      const focused = () => tab.evaluate(() => document.activeElement.getAttribute("aria-label") ?? document.activeElement.textContent);
      for (let k = 0; k < 40 && !(await focused()).startsWith("Control point 2"); k++) await tab.page.keyboard.press("Tab");
      assert.match(await focused(), /Control point 2 of 12: φ₁/);
      await tab.press("ArrowRight");
      await tab.press("Shift", "ArrowUp");
      assert.notEqual(await curve(tab), before);
      await tab.press("Control", "z");
      await tab.press("Control", "z");
      assert.equal(await curve(tab), before);
      // Nothing that can be clicked is out of the keyboard's reach, or without a name.
      const bad = await tab.evaluate(() =>
        [...document.querySelectorAll("button, select, input, [role=button]")]
          .filter((element) => element.checkVisibility())
          .filter((element) => {
            const name = element.getAttribute("aria-label") ?? element.labels?.[0]?.textContent ?? element.textContent;
            return element.tabIndex < 0 ? element.getAttribute("role") !== "tab" : !name?.trim();
          })
          .map((element) => element.outerHTML),
      );
      assert.deepEqual(bad, []);
      assert.deepEqual(tab.said, []);
      await tab.close();
    });

    test("points of a free curve come one at a time, and a long search is stopped", async () => {
      const tab = await Tab.open(browser);
      const points = () => tab.evaluate(() => document.querySelectorAll(".handles circle").length);
      const press = (words) => tab.evaluate((words) => [...document.querySelectorAll("button")].find((button) => (button.ariaLabel ?? button.textContent) === words).click(), words);
      assert.equal(await points(), 12);
      await press("Symmetric");
      await press("More control points");
      await tab.until(() => document.querySelectorAll(".handles circle").length === 13, undefined, "a thirteenth point");
      await tab.settled();
      const row = "td[data-optimum=sideways]";
      const tick = () => tab.evaluate((row) => document.querySelector(row).closest("tr").querySelector("input").click(), row);
      await tick();
      await tab.until((row) => document.querySelector(`${row} button`) !== null, row, "a way to stop the search");
      assert.match(await tab.text(row), /searching, \d+ s/);
      await tab.evaluate((row) => document.querySelector(`${row} button`).click(), row);
      await tab.until((row) => document.querySelector(row).textContent === "stopped", row, "the search to end");
      await tab.settled();
      await tick();
      await tick();
      await tab.until((row) => /…|searching|Y\/L/.test(document.querySelector(row).textContent), row, "the search to begin anew");
      assert.deepEqual(tab.said, []);
      await tab.close();
    });

    test("two gaits stand side by side, optima are laid over, and all that is shown can be saved", async () => {
      const tab = await Tab.open(browser);
      await tab.evaluate(() => [...document.querySelectorAll("button")].find((button) => button.textContent === "Compare").click());
      await tab.evaluate(() => document.querySelector('[aria-label="Take Displacement"]').click());
      await tab.evaluate(() => document.querySelector(".optima input").click());
      await tab.until(() => document.querySelector("td[data-optimum=displacement]").textContent.includes("X/L"), undefined, "an optimum");
      await tab.settled();
      const [drawn, optimum] = await tab.exact();
      const best = swimmer("optimize", "displacement", "--swimmer", "robot", "--max-angle", "2.3");
      assert.ok(Math.abs(optimum.displacement_over_length - best.displacement_over_length) < 1e-8);
      assert.ok(drawn.displacement_over_length < optimum.displacement_over_length);
      for (const [what, type, begins] of [
        ["Map, SVG", "image/svg+xml", "<svg"],
        ["Map, PNG", "image/png", "\u0089PNG"],
        ["Motion, CSV", "text/csv", "cycle,u,phi1_rad"],
        ["Motion, GIF", "image/gif", "GIF89a"],
        ["Motion, WebM", "video/webm", "\u001aE\u00df\u00a3"],
        ["Swimmer file", "application/toml", "name = "],
      ]) {
        const file = await tab.saved(() => tab.choose("Save", what));
        if (what === "Motion, GIF") writeFileSync(join(OUT, `motion-${name}.gif`), file.text, "latin1");
        assert.ok(file.type.startsWith(type) && file.text.includes(begins), `${what}: ${file.type} ${file.text.slice(0, 40)}`);
      }
      assert.deepEqual(tab.said, []);
      await tab.close();
    });
  });
}
