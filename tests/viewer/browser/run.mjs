// The viewer as people use it, in Debian's Chromium:  node run.mjs TOPIC TACTUM
// A topic that fails says which sentence was not true. 77: nothing to run it with.
import { createConnection } from "node:net";
import { mkdirSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, downloaded, drag, graspedAt, inkOf, missing, openBrowser, openPage, Program, readCsv, root, shownForce, state, until } from "./support.mjs";

const [topic, tactum] = process.argv.slice(2);
const pause = (seconds) => new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
const arrowsOf = async (page) => Number((await state(page)).fieldArrows);
const refusedOf = async (page) => JSON.parse((await state(page)).refused);

/** One request on a bare socket: what a browser would never send. */
function bare(port, text) {
  return new Promise((resolve) => {
    const socket = createConnection(port, "127.0.0.1", () => socket.write(text));
    let answer = "";
    socket.on("data", (data) => (answer += data));
    socket.on("error", () => resolve(answer));
    socket.on("close", () => resolve(answer));
    setTimeout(() => socket.destroy(), 1500);
  });
}

/** Drags the held part down until it presses with so much, and no deeper: a hand without force sinks to its aim. */
async function pressDown(page, force_N) {
  const [x, y] = await graspedAt(page);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await pause(0.5); // until the scripted hand has let go
  let down = 0;
  for (; down < 200 && Number((await state(page)).force) < force_N; down += 2) {
    await page.mouse.move(x, y + down);
    await pause(0.15);
  }
}

/** A picture for people, where TACTUM_KEEP_PICTURES names a folder. */
async function keep(page, name) {
  if (process.env.TACTUM_KEEP_PICTURES) await page.screenshot({ path: join(process.env.TACTUM_KEEP_PICTURES, `${name}.png`) });
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

const topics = {
  async loads(browser) {
    const program = await Program.start(tactum, "gears");
    const page = await openPage(browser, program);
    check((await page.title()) === "Tactum: gears", "the title names the scene");
    const response = await page.request.get(program.address);
    const policy = response.headers()["content-security-policy"];
    check(policy.includes("default-src 'none'") && !policy.includes("unsafe"), `the policy is strict: ${policy}`);
    const blocked = await page.evaluate(async () => {
      const script = document.createElement("script");
      try {
        script.textContent = "document.body.dataset.inline = 'ran'";
        document.body.append(script);
      } catch {
        return true;
      }
      return document.body.dataset.inline === undefined;
    });
    check(blocked, "no inline script runs");
    page.complaints.length = 0; // that one was ours
    await pause(3);
    const strips = await page.locator("#strips canvas").count();
    check(strips >= 5, `force, torque, stretch, frame time and contacts have their charts: ${strips}`);
    for (let i = 0; i < 2; ++i) {
      const before = await inkOf(page, i);
      await pause(0.6);
      const after = await inkOf(page, i);
      check(before[0] > 300, `chart ${i} shows something: ${before[0]} pixels`);
      check(before[1] !== after[1], `chart ${i} moves on`);
    }
    const now = await state(page);
    check(now.gaps === "0" && now.lost === "0", `no sample is missing: ${JSON.stringify(now)}`);
    check(page.complaints.length === 0, `no complaints: ${page.complaints.join("; ")}`);
    await program.end();
  },

  async field(browser) {
    const program = await Program.start(tactum, "vortex-field");
    const page = await openPage(browser, program);
    const arrows = () => arrowsOf(page);
    await until("arrows are drawn", async () => (await arrows()) > 100);
    check(await page.isVisible("#field"), "there is a button for them");
    await page.click("#field");
    await until("the button takes them away", async () => (await arrows()) === 0);
    await page.focus("#canvas");
    await page.keyboard.press("f");
    await until("the key brings them back", async () => (await arrows()) > 100);
    await until("the page says that a field pulls", async () =>
      /^[\d.]+ s\. You feel .*Nothing touches “paddle”; force fields pull it with [\d.]+ .?N and turn it with /.test(await page.textContent(".sentence")));
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
    const without = await Program.start(tactum, "block-on-plate");
    const other = await openPage(browser, without);
    await until("a scene without fields has none", async () => (await arrowsOf(other)) === 0);
    check(!(await other.isVisible("#field")), "and no button");
    await without.end();
  },

  async drag(browser) {
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

  async picking(browser) {
    const program = await Program.start(tactum, "moving-objects");
    const page = await openPage(browser, program);
    const places = async () => JSON.parse((await state(page)).bodiesAt);
    check(Object.keys(await places()).length === 13, "thirteen bodies move");
    const holds = async () => (await state(page)).grasped === "cube 1";
    let [x, y] = [0, 0];
    // The stick that the demonstration swings may be before it: then once more.
    for (let tries = 0; tries < 5 && !(await holds()); ++tries) {
      await page.mouse.up();
      [x, y] = (await places())["cube 1"];
      await page.mouse.move(x, y);
      await page.mouse.down();
      for (let i = 0; i < 30 && !(await holds()); ++i) await pause(0.1);
    }
    check(await holds(), "the cube is held");
    for (let i = 1; i <= 10; ++i) await page.mouse.move(x + 3 * i, y - 15 * i);
    await until("it has been lifted", async () => y - (await places())["cube 1"][1] > 80);
    await keep(page, "picking");
    const lifted = (await places())["cube 1"][1];
    for (let i = 1; i <= 4; ++i) await page.mouse.move(x + 30 + 30 * i, y - 150);
    await page.mouse.up();
    await until("the hand is empty again", async () => (await state(page)).grasped === "");
    await until("what was thrown has fallen", async () => (await places())["cube 1"][1] - lifted > 50);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async inspect(browser) {
    // An L without its lid: eight sharp edges and more, one reflex edge, six open ones around the lid.
    const outline = [[0, 0], [40, 0], [40, 20], [20, 20], [20, 40], [0, 40]];
    const corners = [...outline.map(([x, y]) => `v ${x} ${y} 0`), ...outline.map(([x, y]) => `v ${x} ${y} 15`)];
    const walls = outline.map((_, i) => [i + 1, ((i + 1) % 6) + 1, ((i + 1) % 6) + 7, i + 7]);
    const floor = [[1, 4, 3], [1, 3, 2], [1, 5, 4], [1, 6, 5]];
    const file = join(mkdtempSync(join(tmpdir(), "tactum-part-")), "corner.obj");
    writeFileSync(file, [...corners, ...[...walls, ...floor].map((face) => `f ${face.join(" ")}`), ""].join("\n"));
    const program = await Program.command(tactum, ["inspect", file]);
    const page = await openPage(browser, program);
    check((await page.title()) === "Tactum: corner.obj", "the title names the part");
    check((await page.textContent("#hint")).includes("look around"), "the page says what can be done");
    check(!(await page.isVisible("#legend")), "no legend before it is asked for");
    await page.keyboard.press("e");
    const legend = await page.textContent("#legend");
    check(legend.includes("reflex: 1") && legend.includes("open: 6") && legend.includes("sharp: 11"), `edges by kind: ${legend}`);
    await page.keyboard.press("p");
    const picture = await downloaded(page, "#picture");
    check(picture.length > 5000 && picture.subarray(1, 4).toString() === "PNG", "the view is saved as a picture");
    if (process.env.TACTUM_KEEP_PICTURES) await page.screenshot({ path: join(process.env.TACTUM_KEEP_PICTURES, "inspect.png") });
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async friction(browser) {
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

  async raw(browser) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    await page.click('[data-view="front"]');
    await pause(0.3);
    await pressDown(page, 0.8);
    const look = () => page.locator("#canvas").screenshot();
    check(Number((await state(page)).force) > 0.5 && !(await page.isVisible("#grip-legend")), "without friction there is no legend of it");
    check(!(await page.isVisible("#raw-legend")), "no raw wrench before it is asked for");
    await page.keyboard.press("Space"); // from here on nothing is shown; the raw wrench stays
    await until("there is no force", async () => (await state(page)).force === "0");
    await pause(1);
    const without = await look();
    await page.keyboard.press("w");
    check((await page.getAttribute("#raw", "aria-pressed")) === "true" && (await page.isVisible("#raw-legend")), "W shows the raw wrench");
    const keys = await page.locator("#strips .key").allTextContents();
    check(keys.length === 2 && keys.every((key) => key === "rawshown"), `force and torque have two curves each, named: ${keys}`);
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
    check((await page.locator("#strips .key").count()) === 0 && !(await page.isVisible("#raw-legend")), "and it goes away again");
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async energy(browser) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    const strips = await page.locator("#strips canvas").count();
    await page.keyboard.press("n");
    await until("there are two charts more", async () => (await page.locator("#strips canvas").count()) === strips + 2);
    const keys = await page.locator("#strips .key").allTextContents();
    check(keys.length === 2 && keys.every((key) => key.includes("From the hand") && key.includes("To the hand") && key.includes("Energy balance now")), `their curves are named: ${keys}`);
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
    check(told.length === 5 && told[3].startsWith("taken out by the controller") && told[4].startsWith("energy balance now"), told.join("; "));
    for (let i = 1; i < rows.length; ++i)
      for (const key of ["energy_from_hand_J [J]", "energy_to_hand_J [J]"]) check(rows[i][key] >= rows[i - 1][key], `${key} never shrinks`);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async wall(browser) {
    const program = await Program.start(tactum, "peg-in-hole");
    const page = await openPage(browser, program);
    await page.selectOption("#span", "40");
    await page.click("#see-through"); // the peg can be taken through the block
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

  async stop(browser) {
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

  async scenes(browser) {
    const program = await Program.start(tactum, "gears");
    const page = await openPage(browser, program);
    for (const scene of ["peg-in-hole", "block-on-plate", "gears-rim"]) {
      await page.selectOption("#scene", scene);
      await until(`${scene} is there`, async () => (await state(page)).scene === scene && Number((await state(page)).samples) > 300);
    }
    const before = (await state(page)).run;
    await page.click("#reset");
    await until("it starts again", async () => (await state(page)).run !== before && Number((await state(page)).newest) < 5000);
    check((await state(page)).gaps === "0", "no sample is missing");
    check(page.complaints.length === 0, page.complaints.join("; "));
    const summary = await program.end();
    check(summary.scene === "gears-rim", "the summary is of the scene that was felt last");
  },

  async viewers(browser) {
    const program = await Program.start(tactum, "gears");
    const first = await openPage(browser, program);
    const second = await openPage(browser, program);
    await until("both know of each other", async () => (await state(first)).pages === "2" && (await state(second)).pages === "2");
    check((await state(first)).steering === "true" && (await state(second)).steering === "false", "the first steers");
    await second.selectOption("#scene", "peg-in-hole");
    await pause(0.5);
    check((await state(second)).scene === "gears", "who does not steer changes nothing");
    await second.click("#steer");
    await until("the second has the hand", async () => (await state(second)).steering === "true" && (await state(first)).steering === "false");
    await first.keyboard.press("Space");
    await until("anyone may stop", async () => (await state(second)).stopped === "true");
    await second.click("#resume");
    await until("it goes on", async () => (await state(first)).stopped === "false");
    await second.close();
    await until("the first is alone", async () => (await state(first)).pages === "1");
    await drag(first, 40, 20);
    await until("the hand is free to take", async () => (await state(first)).steering === "true");
    check((await state(first)).gaps === "0", "no sample is missing");
    await program.end();
  },

  async stall(browser) {
    const program = await Program.start(tactum, "gears");
    const page = await openPage(browser, program);
    const before = Number((await state(page)).samples);
    await page.evaluate(() => {
      const end = performance.now() + 3000;
      while (performance.now() < end);
    });
    await until("the page has caught up", async () => Number((await state(page)).samples) > before + 3000);
    await until("it shows the present again, not the past", async () => {
      const now = await state(page);
      return Number(now.newest) > Number(now.frames) - 800;
    });
    const now = await state(page);
    check(now.gaps === "0" && now.lost === "0", `stalled for 3 s, it misses nothing: ${JSON.stringify(now)}`);
    await program.end();
  },

  async dropped(browser) {
    const program = await Program.start(tactum, "gears");
    const page = await openPage(browser, program);
    await page.evaluate(() => window.openSockets.at(-1).close());
    await until("the loss is told", async () => (await state(page)).link === "down");
    await until("it has come back by itself", async () => (await state(page)).link === "up");
    const samples = Number((await state(page)).newest);
    await until("frames go on", async () => Number((await state(page)).newest) > samples + 500);
    await page.reload();
    await until("a reload shows frames again", async () => Number((await state(page)).samples) > 300);
    await until("only one page is counted", async () => (await state(page)).pages === "1");
    check((await state(page)).steering === "true", "it has its hand back");
    check((await state(page)).gaps === "0", "no sample is missing");
    await program.end();
  },

  async refusals(browser) {
    const program = await Program.start(tactum, "gears");
    const page = await openPage(browser, program);
    const before = await refusedOf(page);
    const upgrade = (host, origin, token) => `GET /${token}/ws HTTP/1.1\r\nHost: ${host}\r\nOrigin: ${origin}\r\nUpgrade: websocket\r\n` +
      "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
    const own = `127.0.0.1:${program.port}`;
    for (const [what, request] of [
      ["a foreign origin", upgrade(own, "http://tactum.example", program.token)],
      ["a foreign host", upgrade("tactum.example", "http://tactum.example", program.token)],
      ["a wrong token", upgrade(own, `http://${own}`, "0".repeat(32))],
      ["an old-fashioned address", `GET / HTTP/1.1\r\nHost: ${own}\r\n\r\n`],
    ]) check((await bare(program.port, request)).startsWith("HTTP/1.1 403"), `${what} is refused`);
    const closed = await page.evaluate(() => new Promise((resolve) => {
      const socket = new WebSocket(location.href.replace("http", "ws") + "ws");
      socket.onopen = () => {
        socket.send("this is no request");
        socket.send('{"do":"format the disk"}');
        socket.send("x".repeat(5000));
      };
      socket.onclose = () => resolve(true);
    }));
    check(closed, "who sends too much is cut off");
    const after = await until("the page shows the counts", async () => {
      const refused = await refusedOf(page);
      return refused.malformed >= before.malformed + 2 && refused["too large"] > before["too large"] && refused;
    });
    check(after["foreign origin"] === before["foreign origin"] + 1, "the foreign origin is counted");
    check(after["foreign host"] === before["foreign host"] + 1, "the foreign host is counted");
    check(after["wrong token"] === before["wrong token"] + 2, "the wrong tokens are counted");
    await page.click("#tab-panel");
    check((await page.textContent("#panel")).includes("foreign origin"), "people can read it");
    check((await state(page)).gaps === "0", "the charts did not notice");
    const summary = await program.end();
    check(summary.non_finite_frames === 0, "the loop did not notice");
  },

  async why(browser) {
    const program = await Program.start(tactum, "gears");
    const page = await openPage(browser, program);
    await until("the gears touch", async () => (await page.textContent(".sentence")).includes("touches"));
    const stages = await page.locator(".stages tr").count();
    check(stages === 5, `every stage has its row: ${stages - 1}`);
    await page.click(".contacts button");
    check((await page.locator(".contacts tr.chosen").count()) <= 1, "one contact can be chosen");
    await page.click("#pause");
    const chart = await page.locator("#strips .u-over").first().boundingBox();
    await page.mouse.click(chart.x + chart.width / 2, chart.y + chart.height / 2);
    await until("the moment is shown", async () => await page.isVisible("#past"));
    const then = await page.textContent(".sentence");
    await pause(0.6);
    check((await page.textContent(".sentence")) === then, "a moment that was picked stays");
    const png = await downloaded(page, "#charts-png");
    check(png.length > 3000 && png.subarray(1, 4).toString() === "PNG", "the charts as a picture");
    const picture = await downloaded(page, "#picture");
    check(picture.length > 20000 && picture.subarray(1, 4).toString() === "PNG", "the scene as a picture");
    await page.keyboard.press("l");
    await until("it is now again", async () => !(await page.isVisible("#past")));
    await page.selectOption("#also", { index: 1 });
    await until("a further chart is there", async () => (await page.locator("#strips canvas").count()) === 6);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async panel(browser) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    await page.click("#tab-panel");
    const field = page.locator('[id="set-coupling.stiffness_N_per_m"]');
    check((await page.locator('[id="set-response"] option').allTextContents()).join() === "penalty,constraint", "a choice is told by its words");
    const margin = () => page.textContent("#margin");
    check((await margin()).includes("coupling 600 N/m"), `the stability margin is told: ${await margin()}`);
    await field.fill("432");
    await field.press("Enter");
    await field.blur();
    await until("the margin follows the gain", async () => (await margin()).includes("coupling 432 N/m"));
    const toml = (await downloaded(page, "#save-toml")).toString();
    check(toml.includes("[coupling]") && toml.includes("stiffness_N_per_m = 432  #"), `the saved settings have it: ${toml}`);
    await field.fill("99999999");
    await field.press("Enter");
    await until("what is out of range is told", async () => await page.isVisible("#notice"));
    const run = (await state(page)).run;
    await page.selectOption("#device", "pointer:omega.6");
    await until("the device is another", async () => (await state(page)).run !== run && (await page.textContent("#panel")).includes("no torque"));
    const units = await page.locator(".setting .unit").allTextContents();
    check(units.filter((unit) => unit !== "").length >= 15, "settings have units");
    const unnamed = await page.evaluate(() => [...document.querySelectorAll("button, input, select")].filter((element) =>
      !element.textContent.trim() && !element.getAttribute("aria-label") && !element.labels?.length && !element.title).length);
    check(unnamed === 0, `${unnamed} controls have no name`);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async keyboard(browser) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    await page.focus("#canvas");
    await page.keyboard.press("ArrowRight"); // takes the hand; the demonstration ends
    await pause(1.5);
    const before = await graspedAt(page);
    for (let i = 0; i < 25; ++i) await page.keyboard.press("ArrowLeft");
    await pause(1.5);
    const after = await graspedAt(page);
    check(after[0] < before[0] - 10, `arrows move the part: ${before} to ${after}`);
    await page.keyboard.press("4");
    await pause(0.3);
    check((await graspedAt(page)).join() !== after.join(), "digits choose the view");
    await page.keyboard.press("g");
    check((await page.getAttribute("#grasp", "aria-pressed")) === "true", "G grasps");
    await page.keyboard.press("p");
    check((await page.getAttribute("#pieces", "aria-pressed")) === "true", "P colours the pieces");
    await page.keyboard.press("?");
    check(await page.isVisible("#help"), "? explains");
    await page.keyboard.press("Escape");
    check(!(await page.isVisible("#help")), "escape closes it");
    await page.focus("#tab-why");
    await page.keyboard.press("ArrowRight");
    check((await page.getAttribute("#tab-panel", "aria-selected")) === "true", "arrows change tabs");
    for (const [id, role] of [["canvas", "application"], ["summary", "status"], ["stopped", "alert"]])
      check((await page.getAttribute(`#${id}`, "role")) === role, `${id} is a ${role} to a screen reader`);
    const lost = await page.evaluate(() => {
      const seen = [];
      document.querySelectorAll("header button, .tools button").forEach((button) => {
        button.focus();
        if (!button.hidden && document.activeElement !== button) seen.push(button.id);
      });
      return seen;
    });
    check(lost.length === 0, `these cannot be reached by the keyboard: ${lost}`);
    await program.end();
  },

  async narrow(browser) {
    const program = await Program.start(tactum, "gears");
    const page = await openPage(browser, program, { viewport: { width: 390, height: 800 }, colorScheme: "light", hasTouch: true });
    check((await page.getAttribute("html", "data-theme")) === "light", "a light system gets a light page");
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    check(wide <= 0, `nothing sticks out sideways: ${wide} pixels`);
    for (const id of ["stop", "scene", "canvas", "pause"]) check(await page.isVisible(`#${id}`), `${id} is there`);
    const stop = await page.locator("#stop").boundingBox();
    check(stop.y < 60 && stop.width > 60 && stop.height >= 40, "the stop is at hand and large");
    for (const width of [390, 700, 1000]) {  // every chart is above what follows it
      await page.setViewportSize({ width, height: 800 });
      await pause(0.5);
      const over = await page.evaluate(() => {
        const below = document.querySelector("aside").getBoundingClientRect();
        const strips = document.getElementById("strips").getBoundingClientRect();
        const last = Math.max(...[...document.querySelectorAll("#strips canvas")].map((c) => c.getBoundingClientRect().bottom));
        return last - (below.left < strips.right ? below.top : strips.bottom);
      });
      check(over <= 1, `at ${width} pixels the charts end ${over} pixels too low`);
    }
    await page.setViewportSize({ width: 390, height: 800 });
    await pause(1);
    // A finger on the part moves it; the camera stays.
    const [x, y] = await graspedAt(page);
    const session = await page.context().newCDPSession(page);
    const touch = (type, dx, dy) => session.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x: x - 45 + dx, y: y + 12 + dy }] });
    await touch("touchStart", 0, 0);
    for (let i = 1; i <= 20; ++i) {
      await touch("touchMove", i, 2 * i);
      await pause(0.03);
    }
    check(await page.evaluate(() => document.getElementById("canvas").classList.contains("holding")), "a finger takes the part");
    await touch("touchEnd");
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  /** The pictures of the README. TACTUM_PICTURES=keep writes them into the sources. */
  async pictures(browser) {
    const keep = process.env.TACTUM_PICTURES === "keep";
    const folder = keep ? join(root, "docs/pictures") : join(root, "build/pictures");
    mkdirSync(folder, { recursive: true });
    const take = async (scene, options, prepare, words = ["feel", scene]) => {
      const program = await Program.command(tactum, words);
      const page = await openPage(browser, program, { viewport: { width: 1280, height: 720 }, ...options }, "#fine");
      await prepare(page);
      const png = await page.screenshot();
      check(png.length > 60000, `the picture of ${scene} shows something: ${png.length} bytes`);
      writeFileSync(join(folder, `${scene}.png`), png);
      await program.end();
      console.log(`${join(folder, `${scene}.png`)}: ${png.length} bytes`);
    };
    await take("gears", {}, async (page) => {
      const [x, y] = await graspedAt(page);
      await page.mouse.move(x - 70, y + 6);
      await page.mouse.down();
      for (let i = 1; i <= 30; ++i) {
        await page.mouse.move(x - 70 - i * 1.5, y + 6 + i * 1.4);
        await pause(0.03);
      }
      await pause(2);
    });
    await take("peg-in-hole", { colorScheme: "light" }, async (page) => {
      await page.click("#see-through");
      const deep = async () => Number((await state(page)).newest) % 22000 > 6500; // the demonstration, forth and back
      await until("the peg has been deep in its hole", deep, 60);
      await page.click("#pause");
      // The moment of the largest force within reach of the charts.
      const chart = await page.locator("#strips .u-over").first().boundingBox();
      let best = [0, 0];
      for (let share = 0.05; share < 1; share += 0.03) {
        await page.mouse.move(chart.x + share * chart.width, chart.y + chart.height / 2);
        const [, size, prefix] = (await page.textContent("#cursor")).match(/size ([\d.]+) (m?)N/) ?? [];
        const force = Number(size ?? 0) * (prefix ? 1e-3 : 1);
        if (force > best[0]) best = [force, share];
      }
      check(best[0] > 0.2, `a moment with a force was found: ${best[0]} N`);
      await page.mouse.click(chart.x + best[1] * chart.width, chart.y + chart.height / 2);
      await page.mouse.move(700, 500);
      await pause(1.5);
    });
    await take("moving-objects", {}, async (page) => {
      await until("the stick is among the others", async () => Number((await state(page)).newest) % 16180 > 6200, 60);
      await page.keyboard.press("e");
      await pause(0.5);
    });
    await take("nut-bolt", {}, async (page) => {
      await page.keyboard.press("e");
      await until("the nut has been turned for a while", async () => Number((await state(page)).newest) > 1000, 60);
    });
    // Of scenes that tell their story by themselves: the frame to wait for.
    for (const [scene, frame, options] of [["dominoes", 2350, {}], ["scale", 6000, { colorScheme: "light" }], ["lock", 5200, {}],
      ["shaft", 16600, { colorScheme: "light" }], ["vortex-field", 4000, {}]]) {
      await take(scene, options, async (page) => {
        await page.keyboard.press("e");
        if (scene === "shaft" || scene === "lock") await page.click("#see-through");
        await until(`${scene} has come so far`, async () => Number((await state(page)).newest) > frame, 120);
        await page.click("#pause");
        await pause(1);
      });
    }
    // A bracket like an F, as it falls into pieces.
    const outline = [[0, 0], [12, 0], [12, 30], [34, 30], [34, 42], [12, 42], [12, 56], [44, 56], [44, 68], [0, 68]];
    const n = outline.length;
    const corners = [0, 20].flatMap((z) => outline.map(([x, y]) => `v ${x} ${y} ${z}`));
    const below = outline.map((_, i) => n - i);
    const walls = outline.map((_, i) => [i + 1, ((i + 1) % n) + 1, ((i + 1) % n) + 1 + n, i + 1 + n]);
    const faces = [below, below.map((v) => 2 * n + 1 - v), ...walls];
    const file = join(mkdtempSync(join(tmpdir(), "tactum-part-")), "bracket.obj");
    writeFileSync(file, [...corners, ...faces.map((face) => `f ${face.join(" ")}`), ""].join("\n"));
    await take("pieces", { colorScheme: "light" }, async (page) => {
      await page.keyboard.press("p");
      await page.keyboard.press("e");
      await pause(1);
    }, ["inspect", file]);
  },
};

if (!topics[topic] || !tactum) {
  console.error(`usage: node run.mjs ${Object.keys(topics).join("|")} TACTUM`);
  process.exit(2);
}
if (missing) {
  console.log(`skipped: ${missing}`);
  process.exit(77);
}
const browser = await openBrowser();
try {
  await topics[topic](browser);
  console.log(`${topic}: passed`);
} catch (error) {
  console.error(`${topic}: ${error.message}`);
  process.exitCode = 1;
} finally {
  await browser.close();
  if (process.exitCode) process.exit(1); // the program that was started ends with us
}
