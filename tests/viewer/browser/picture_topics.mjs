// The pictures of the README.
import { mkdirSync, mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, downloaded, graspedAt, openPage, pause, Program, readCsv, root, state, until } from "./support.mjs";

/** Width and height of a PNG file. */
const sizeOf = (png) => [png.readUInt32BE(16), png.readUInt32BE(20)];

export const topics = {
  /** What is saved can be used: the table has poses and says what it is, pictures are large and have their numbers. */
  async exports(browser, tactum) {
    const program = await Program.start(tactum, "gears");
    const page = await openPage(browser, program, { deviceScaleFactor: 1 }); // pictures have as many pixels as the screen
    await until("the gears touch", async () => (await page.textContent(".sentence")).includes("touches"));
    const csv = (await downloaded(page, "#csv")).toString();
    const head = csv.split("\n").filter((line) => line.startsWith("#"));
    for (const word of ["scene: gears", "device: ", "rate_Hz: 1000", "date: 20", "setting coupling.stiffness_N_per_m = 600", "column shown.fx"])
      check(head.some((line) => line.includes(word)), `the head of the table has ${word}`);
    const rows = readCsv(Buffer.from(csv));
    const [first] = rows;
    const inHead = (name) => head.some((line) => line.includes(`column ${name}`) || line.includes(`column ${name.split(".")[0]}.`));
    const posed = /\.(p[xyz]|q[wxyz])$/; // the head has one line for all bodies
    check(head.some((line) => line.includes("column BODY.px")), "the head explains the poses of bodies");
    for (const name of Object.keys(first).filter((one) => one !== "frame" && one !== "time [s]" && !posed.test(one.split(" [")[0]))) check(inHead(name.split(" ")[0]), `the head explains ${name}`);
    const length = (row, what) => Math.hypot(...["qw", "qx", "qy", "qz"].map((part) => row[`${what}_${part}`]));
    check(rows.every((row) => Math.abs(length(row, "hand") - 1) < 1e-5 && Math.abs(length(row, "proxy") - 1) < 1e-5), "poses of hand and proxy in every frame");
    const apart = (row) => Math.hypot(...["x", "y", "z"].map((axis) => row[`hand_p${axis}_m [m]`] - row[`proxy_p${axis}_m [m]`]));
    check(rows.every((row) => Math.abs(apart(row) - row["stretch_m [m]"]) < 1e-6), "they are as far apart as the stretch says");
    const q = (row, body) => Math.hypot(...["qw", "qx", "qy", "qz"].map((part) => row[`${body}.${part}`]));
    for (const body of ["driving", "driven"]) check(rows.every((row) => Math.abs(q(row, body) - 1) < 1e-5), `the pose of ${body} in every frame`);
    const charts = sizeOf(await downloaded(page, "#charts-png"));
    check(charts[0] >= 1200 && charts[1] >= 1000, `the charts as a picture are ${charts.join(" x ")} pixels`);
    const view = sizeOf(await downloaded(page, "#picture"));
    const canvas = await page.evaluate(() => [document.getElementById("canvas").width, document.getElementById("canvas").height]);
    check(view[0] === canvas[0] && view[1] > canvas[1] + 60, `the view has lines of text above and below: ${view.join(" x ")}`);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  /** The pictures of the README. TACTUM_PICTURES=keep writes them into the sources. */
  async pictures(browser, tactum) {
    const keep = process.env.TACTUM_PICTURES === "keep";
    const folder = keep ? join(root, "docs/pictures") : join(root, "build/pictures");
    mkdirSync(folder, { recursive: true });
    const take = async (scene, options, prepare, words = ["feel", scene]) => {
      const program = await Program.command(tactum, words);
      const page = await openPage(browser, program, { deviceScaleFactor: 1, ...options }, "#fine");
      await prepare(page);
      const png = await page.screenshot();
      check(png.length > 60000, `the picture of ${scene} shows something: ${png.length} bytes`);
      writeFileSync(join(folder, `${scene}.png`), png);
      await page.close(); // a page draws on, also without its program
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
      const deep = async () => Number((await state(page)).newest) % 22000 > 6500; // the demonstration, forth and back
      await until("the peg has been deep in its hole", deep, 60);
      await page.click("#pause");
      // The moment of the largest force within reach of the charts.
      const chart = await page.locator("#strips .u-over").first().boundingBox();
      let best = [0, 0];
      for (let share = 0.05; share < 1; share += 0.03) {
        await page.mouse.move(chart.x + share * chart.width, chart.y + chart.height / 2);
        const size = (await page.locator("#strips .key").first().textContent()).match(/size([\d.]+)/)?.[1];
        const force = Number(size ?? 0) * ((await page.locator("figcaption").first().textContent()).includes("mN") ? 1e-3 : 1);
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
    // Of scenes that tell their story by themselves: the frame to wait for. A short test takes the first one.
    const stories = [["dominoes", 2350, {}], ["scale", 6000, { colorScheme: "light" }], ["lock", 5200, {}],
      ["shaft", 16600, { colorScheme: "light" }], ["vortex-field", 4000, {}]];
    const all = keep || process.env.TACTUM_FULL === "1";
    for (const [scene, frame, options] of all ? stories : stories.slice(0, 1)) {
      await take(scene, options, async (page) => {
        await page.keyboard.press("e");
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
