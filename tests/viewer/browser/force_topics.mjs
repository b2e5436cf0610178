// Forces that a person makes with the mouse, and what the page says of them.
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, downloaded, drag, graspedAt, inkOf, keep, openPage, pause, Program, readCsv, root, shownForce, state, takePart, until } from "./support.mjs";

/** Drags the held part down until it presses with so much, and no deeper: a hand without force sinks to its aim. */
async function pressDown(page, force_N) {
  const [x, y] = await takePart(page);
  await pause(0.5); // until the scripted hand has let go
  let down = 0;
  for (; down < 200 && Number((await state(page)).force) < force_N; down += 2) {
    await page.mouse.move(x, y + down);
    await pause(0.15);
  }
}

/** The block on its plate, and friction between them. */
function rubbingBlock() {
  const scene = readFileSync(join(root, "scenes/block-on-plate.toml"), "utf8")
    .replaceAll(/^(\[\[body\]\])$/gm, '$1\nmaterial = "steel"');
  const file = join(mkdtempSync(join(tmpdir(), "tactum-scene-")), "rubbing.toml");
  writeFileSync(file, `${scene}\n[[friction]]\nmaterial_a = "steel"\nmaterial_b = "steel"\ncoefficient = 0.4\n`);
  return file;
}

/** The largest force as the page, its CSV file and the program's summary tell it. Ends the program. */
async function forcesAgree(page, program) {
  await page.keyboard.press("Space"); // from here on no force can be larger
  await until("there is no force", async () => (await state(page)).force === "0");
  const rows = readCsv(await downloaded(page, "#csv"));
  const peakOfPage = Number((await state(page)).peakForce);
  const summary = await program.end();
  const peakOfCsv = Math.max(...rows.map(shownForce));
  console.log(`largest force: page ${peakOfPage} N, CSV ${peakOfCsv} N, program ${summary.max_force_N} N`);
  check(Math.abs(peakOfPage - summary.max_force_N) < 1e-5 * summary.max_force_N, "page and program agree");
  check(Math.abs(peakOfCsv - summary.max_force_N) < 1e-5 * summary.max_force_N, "CSV and program agree");
  for (let i = 1; i < rows.length; ++i) check(rows[i].frame === rows[i - 1].frame + 1, `the CSV lacks a frame after ${rows[i - 1].frame}`);
}

export const topics = {
  async drag(browser, tactum) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    await page.selectOption("#span", "40");
    await page.click('[data-view="front"]');
    await pause(0.3);
    const before = await inkOf(page, 0);
    await drag(page, 0, 130, 50, false); // down, into the plate
    await until("the page shows a force", async () => Number((await state(page)).force) > 1);
    await pause(0.5);
    check((await inkOf(page, 0))[1] !== before[1], "the force chart has changed");
    const dragged = Number((await state(page)).force);
    await page.mouse.up(); // the hand stays where it was led
    await pause(0.4);
    const still = Number((await state(page)).force);
    check(still > 0.5 * dragged, `let go of the mouse, the hand goes on pressing: ${dragged} N, then ${still} N`);
    check((await page.textContent("#why")).includes("plate"), "the page says what pushes");
    await page.focus("#canvas");
    for (let i = 0; i < 60; ++i) await page.keyboard.press("ArrowUp"); // up again by the keys
    await until("the part is free", async () => Number((await state(page)).force) < 0.05);
    await pause(0.3);
    await forcesAgree(page, program);
    check(page.complaints.length === 0, page.complaints.join("; "));
  },

  async wall(browser, tactum) {
    const program = await Program.start(tactum, "peg-in-hole");
    const page = await openPage(browser, program);
    await page.selectOption("#span", "40");
    await until("the peg is in its hole", async () => Number((await state(page)).newest) > 4900);
    await drag(page, 0, 0, 1, false);
    await pause(1);
    const before = Number((await state(page)).force);
    const [x, y] = await graspedAt(page);
    for (let i = 1; i <= 30; ++i) {
      await page.mouse.move(x + 3 * i, y + i); // along the block's long side, to the right
      await pause(0.05);
    }
    await until("the wall pushes back", async () => Number((await state(page)).force) > before + 1);
    check((await page.textContent("#why")).includes("“peg” touches “block”"), "the page says what pushes");
    await page.mouse.up();
    await pause(0.3);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await forcesAgree(page, program);
  },

  async stop(browser, tactum) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    await page.click('[data-view="front"]');
    await pause(0.3);
    await pressDown(page, 0.8);
    check(Number((await state(page)).force) > 0.5, "there is a force to stop");
    await page.focus("#reset"); // the space bar stops, whatever has the focus
    await page.keyboard.press("Space");
    await until("it is stopped", async () => (await state(page)).stopped === "true");
    await until("there is no force", async () => (await state(page)).force === "0");
    check((await state(page)).run === "1", "the focused button was not pressed by the space bar");
    check(await page.isVisible("#stopped"), "the page says that it is stopped");
    await page.mouse.up();
    const rows = readCsv(await downloaded(page, "#csv"));
    const stopping = 1 << 5; // safety_flag::kStopping
    const first = rows.findIndex((row) => row.safety_flags & stopping);
    const zero = rows.findIndex((row, i) => i >= first && shownForce(row) === 0);
    console.log(`stopped with ${shownForce(rows[first - 1]).toFixed(3)} N; zero after ${zero - first + 1} frames`);
    check(first > 0 && zero >= first && zero - first < 101, "the force is zero within 101 frames");
    check(rows.slice(zero).every((row) => shownForce(row) === 0), "... and stays there");
    await page.click("#resume");
    await until("the force comes back", async () => Number((await state(page)).force) > 0.3);
    await program.end();
  },

  async friction(browser, tactum) {
    const program = await Program.start(tactum, rubbingBlock()); // its scripted hand presses and slides, forth and back
    const page = await openPage(browser, program);
    await page.selectOption("#span", "40");
    await page.click('[data-view="front"]');
    const first = page.locator(".contacts tbody tr:first-child .grip");
    const told = (start) => until(`a contact ${start}`, async () => {
      const text = (await first.isVisible()) && String(await first.textContent());
      return text && text.startsWith(start) && (await state(page)).grips.includes(start) && text;
    });
    const slips = await told("slips");
    check(/^slips, (9[5-9]|100) % of its friction$/.test(slips), `it slips at the cone's edge: ${slips}`);
    check(await page.isVisible("#grip-legend"), "the colours are explained");
    await keep(page, "friction-slips");
    const sticks = await told("sticks");
    check(/^sticks, \d+ % of its friction$/.test(sticks), `it sticks: ${sticks}`);
    await keep(page, "friction-sticks");
    const rows = readCsv(await downloaded(page, "#csv"));
    check(rows.some((row) => row.slipping_patches > 0 && row.friction_used > 0.95), "the CSV has where it slipped");
    check(rows.some((row) => row.sticking_patches > 0 && row.friction_used > 0.1 && row.friction_used < 0.9), "... and where it stuck");
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async raw(browser, tactum) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    await page.click('[data-view="front"]');
    await pause(0.3);
    await pressDown(page, 0.8);
    const look = () => page.locator("#canvas").screenshot();
    check(Number((await state(page)).force) > 0.5 && !(await page.isVisible("#grip-legend")), "without friction there is no legend of it");
    check((await page.textContent("#scale")).includes("arrows: 1 N"), "the arrows have their usual size");
    for (let i = 0; i < 2; ++i) await page.keyboard.press("+"); // so that half a newton is seen well
    await until("longer arrows were asked for", async () => (await page.textContent("#scale")).includes("arrows: 200 mN"));
    check(!(await page.isVisible("#raw-legend")), "no raw wrench before it is asked for");
    await page.keyboard.press("Space"); // from here on nothing is shown; the raw wrench stays
    await until("there is no force", async () => (await state(page)).force === "0");
    await pause(1);
    const without = await look();
    await page.keyboard.press("w");
    check((await page.getAttribute("#raw", "aria-pressed")) === "true" && (await page.isVisible("#raw-legend")), "W shows the raw wrench");
    const curves = async () => (await page.locator("#strips .key").evaluateAll((keys) => keys.map((key) => [...key.querySelectorAll("i")].map((i) => i.textContent).join())));
    check((await curves()).slice(0, 2).every((names) => names === "raw,shown"), `force and torque have two curves each, named: ${await curves()}`);
    await pause(1);
    const violet = await page.evaluate(async (pictures) => {
      const count = async (base64) => { // pixels of the raw arrow's colour
        const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
        const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
        const sheet = new OffscreenCanvas(bitmap.width, bitmap.height);
        const ctx = sheet.getContext("2d");
        ctx.drawImage(bitmap, 0, 0);
        const { data } = ctx.getImageData(0, 0, bitmap.width, bitmap.height);
        let pixels = 0;
        for (let i = 0; i < data.length; i += 4) if (data[i + 2] > data[i + 1] + 40 && data[i] > data[i + 1] + 4) ++pixels;
        return pixels;
      };
      return [await count(pictures[0]), await count(pictures[1])];
    }, [without.toString("base64"), (await look()).toString("base64")]);
    console.log(`pixels of the raw arrow: ${violet}`);
    check(violet[1] > violet[0] + 150, `stopped, the raw arrow is still there: ${violet}`);
    await keep(page, "raw");
    await page.mouse.up();
    const last = readCsv(await downloaded(page, "#csv")).at(-1);
    check(Math.abs(last["coupling.fz [N]"]) > 0.5 && shownForce(last) === 0, "raw and shown are two things");
    const png = await downloaded(page, "#charts-png");
    check(png.length > 3000, "the charts as a picture");
    await page.click("#raw");
    check((await curves())[0] === "x,y,z,size" && !(await page.isVisible("#raw-legend")), "and it goes away again");
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async energy(browser, tactum) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    const strips = await page.locator("#strips canvas").count();
    await page.keyboard.press("n");
    await until("there are two charts more", async () => (await page.locator("#strips canvas").count()) === strips + 2);
    const keys = (await page.locator("#strips .key").allTextContents()).slice(0, 2);
    check(keys.every((key) => key.includes("From the hand") && key.includes("To the hand")) && keys[0].includes("Energy balance now"), `their curves are named: ${keys}`);
    await page.selectOption("#span", "40");
    await page.click('[data-view="front"]');
    await pause(0.3);
    await pressDown(page, 0.8);
    await page.mouse.up();
    await pause(1);
    check((await inkOf(page, 0))[0] > 300, "the energy chart shows something");
    await page.locator("table.energy").scrollIntoViewIfNeeded();
    await keep(page, "energy");
    await page.click("#pause"); // numbers and samples of one moment
    await page.locator("#strips .u-over").first().scrollIntoViewIfNeeded();
    const chart = await page.locator("#strips .u-over").first().boundingBox();
    await page.mouse.click(chart.x + 0.98 * chart.width, chart.y + chart.height / 2);
    await until("the moment is shown", async () => await page.isVisible("#past"));
    await pause(0.5);
    const told = await page.locator("table.energy tr").allTextContents();
    const moment = Number((await page.textContent("#past span")).match(/frame (\d+)/)[1]);
    const rows = readCsv(await downloaded(page, "#csv"));
    const row = rows.find((one) => one.frame === moment);
    const value = (text) => Number(text.match(/([\d.]+) (m|µ|n)?J/)[1]) * { m: 1e-3, "µ": 1e-6, n: 1e-9 }[text.match(/([\d.]+) (m|µ|n)?J/)[2]] || 0;
    const fromHand = row["energy_from_hand_J [J]"];
    console.log(`${told.join("; ")}: ${fromHand} J`);
    check(fromHand > 1e-4, "pressing takes work");
    check(Math.abs(value(told[1]) - fromHand) < 0.01 * fromHand, `the panel tells it: ${told[1]}, ${fromHand} J`);
    check(told.length === 6 && told[3].startsWith("generated") && told[4].startsWith("paid by the coupling") && told[5].startsWith("energy balance now"), told.join("; "));
    for (let i = 1; i < rows.length; ++i)
      for (const key of ["energy_from_hand_J [J]", "energy_to_hand_J [J]"]) check(rows[i][key] >= rows[i - 1][key], `${key} never shrinks`);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },
};
