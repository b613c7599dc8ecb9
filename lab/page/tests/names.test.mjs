// What a screen reader is told: everything that can be used has a role and a name in the browser's own accessibility tree.

import assert from "node:assert/strict";
import { test } from "node:test";
import { BROWSERS, Tab } from "./browsers.mjs";

const ROLES = ["button", "checkbox", "combobox", "link", "radio", "slider", "spinbutton", "switch", "tab", "textbox"];
const ROOMS = ["explore", "drive", "calibrate", "maps"];

/** What Chromium's tree holds: role and name of all that is there. */
async function chromiums(tab) {
  const session = await tab.page.context().newCDPSession(tab.page);
  const { nodes } = await session.send("Accessibility.getFullAXTree");
  await session.detach();
  return nodes
    .filter(({ ignored, role }) => !ignored && ROLES.includes(role?.value))
    .map(({ role, name }) => ({ role: role.value, name: name?.value?.trim() ?? "" }));
}

// Firefox tells its tree node by node only, which takes minutes.
for (const [browser, tree] of [["chromium", chromiums]]) {
  test(`all that can be used has a name, in ${browser}`, async (context) => {
    const launched = await BROWSERS[browser]();
    context.after(() => launched.close());
    const tab = await Tab.open(launched);
    for (const room of ROOMS) {
      await tab.evaluate((room) => document.getElementById(`tab-${room}`).click(), room);
      await tab.until((room) => document.querySelector(`#panel-${room}:not([hidden])`)?.childElementCount > 0, room, "the room");
      await tab.settled();
      const told = await tree(tab);
      assert.ok(told.length > ROOMS.length, `${room}: only ${told.length} things that can be used`);
      assert.deepEqual(told.filter(({ name }) => !name), [], room);
      // What is drawn says what it is, too.
      const pictures = await tab.evaluate(() =>
        [...document.querySelectorAll("canvas, svg")]
          .filter((picture) => picture.checkVisibility() && !picture.closest('[aria-hidden="true"], figure[aria-label]'))
          .filter((picture) => !(picture.getAttribute("aria-label") ?? picture.querySelector("title")?.textContent))
          .map((picture) => picture.outerHTML.slice(0, 200)),
      );
      assert.deepEqual(pictures, [], `${room}: pictures without a name`);
    }
    assert.deepEqual(tab.said, []);
    await tab.close();
  });
}
