// Where things are on the page: nothing covers anything else, at any width, and nothing moves under the pointer.
import { check, keep, openPage, pause, Program, state, until } from "./support.mjs";

const widths = [820, 900, 1000, 1100, 1280, 1366];

/** What covers or leaves what, as sentences; the page's parts are compared in pairs. */
async function faults(page) {
  return await page.evaluate(() => {
    const groups = [
      ["header", "header > *"], ["#stage", ".tools button, #cube, .handbox button, #hint, #scale, #arrow-size button, .banner:not([hidden]), #notice"],
      ["#charts", ".charts-bar > *, figure"], ["aside", "[role=tab], [role=tabpanel]"],
    ];
    const name = (element) => element.id || element.textContent.trim().slice(0, 20) || element.className;
    const parts = [];
    const said = [];
    for (const [within, selector] of groups) {
      const room = document.querySelector(within).getBoundingClientRect();
      for (const element of document.querySelectorAll(selector)) {
        const box = element.getBoundingClientRect();
        if (box.width === 0 || box.height === 0) continue;
        parts.push([element, box]);
        if (box.left < room.left - 1 || box.right > room.right + 1 || box.top < room.top - 1 || (element.tagName !== "FIGURE" && box.bottom > room.bottom + 1))
          said.push(`${name(element)} sticks out of ${within}`);
        if (room.right > innerWidth + 1) said.push(`${within} sticks out of the window`);
      }
    }
    parts.forEach(([a, boxA], i) => parts.slice(i + 1).forEach(([b, boxB]) => {
      const wide = Math.min(boxA.right, boxB.right) - Math.max(boxA.left, boxB.left);
      const high = Math.min(boxA.bottom, boxB.bottom) - Math.max(boxA.top, boxB.top);
      if (wide > 1 && high > 1 && !a.contains(b) && !b.contains(a)) said.push(`${name(a)} and ${name(b)} cover each other`);
    }));
    for (const cell of document.querySelectorAll("td, th, .key b"))
      if (cell.scrollWidth > cell.clientWidth + 1 && getComputedStyle(cell).display !== "inline") said.push(`"${cell.textContent}" is wider than its column`);
    const stop = document.getElementById("stop").getBoundingClientRect();
    if (stop.right > innerWidth || stop.left < 0 || stop.width < 60) said.push("STOP is not whole");
    return said;
  });
}

/** Looks at the page at every width. */
async function lookAtWidths(page, scene, height) {
  for (const width of widths) {
    await page.setViewportSize({ width, height });
    await pause(0.4);
    const said = await faults(page);
    check(said.length === 0, `${scene} at ${width} x ${height}: ${said.join("; ")}`);
    await keep(page, `${scene}-${width}`);
  }
}

export const topics = {
  async layout(browser, tactum) {
    const program = await Program.start(tactum, "peg-in-hole");
    for (const [colorScheme, height] of [["dark", 720], ["light", 640]]) {
      const page = await openPage(browser, program, { colorScheme });
      await lookAtWidths(page, "peg-in-hole", height);
      await page.keyboard.press("w"); // two legends more
      await page.keyboard.press("n");
      await page.keyboard.press("Space"); // and the banner
      await until("it is stopped", async () => (await state(page)).stopped === "true");
      await lookAtWidths(page, "stopped", 720);
      await page.click("#resume");
      await until("it goes on", async () => (await state(page)).stopped === "false");
      await page.close();
    }
    await program.end();
    const long = await Program.start(tactum, "moving-objects"); // the longest hint, and much that touches
    const page = await openPage(browser, long);
    await lookAtWidths(page, "moving-objects", 720);
    await long.end();
  },

  async hover(browser, tactum) {
    const program = await Program.start(tactum, "peg-in-hole");
    const page = await openPage(browser, program);
    await until("there is a force", async () => Number((await state(page)).force) > 0.05);
    await page.click("#pause");
    await pause(0.5);
    const places = async () => JSON.stringify(await page.evaluate(() =>
      [...document.querySelectorAll("#strips canvas, .charts-bar > *, aside")].map((e) => { const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })));
    const before = await places();
    const plot = page.locator("#strips .u-over").first();
    const box = await plot.boundingBox();
    const names = await page.locator("#strips .key").evaluateAll((keys) => keys.map((key) => [...key.querySelectorAll("i")].map((i) => i.textContent)));
    check(names.length >= 5 && names.every((one) => one.length > 0 && one.every((name) => name !== "")), `every curve of every chart has its name: ${JSON.stringify(names)}`);
    const values = new Set();
    for (let share = 0.1; share < 1; share += 0.2) {
      await page.mouse.move(box.x + share * box.width, box.y + box.height / 2);
      await pause(0.15);
      check((await places()) === before, "nothing moves under the pointer");
      values.add(await page.locator("#strips .key").first().textContent());
    }
    check(values.size > 2, `the values are those under the pointer: ${[...values].join(" | ")}`);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },
};
