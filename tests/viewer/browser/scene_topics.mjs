// What a page shows of scenes, of the bodies in them, and of a part that is inspected.
import { mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, downloaded, inkOf, keep, openPage, pause, Program, state, until } from "./support.mjs";

const placeOf = async (page, name) => JSON.parse((await state(page)).bodiesAt)[name];

/** Presses on a body until this page has its hand, and drags it to the right. */
async function dragBody(page, name, right) {
  for (let tries = 0; tries < 20; ++tries) {
    const [x, y] = await placeOf(page, name);
    await page.mouse.move(x, y);
    await page.mouse.down();
    if (await page.evaluate(() => document.getElementById("canvas").classList.contains("holding"))) {
      for (let i = 1; i <= 20; ++i) {
        await page.mouse.move(x + (right * i) / 20, y);
        await pause(0.03);
      }
      return;
    }
    await page.mouse.up();
    await pause(0.2);
  }
  throw new Error(`“${name}” could not be taken`);
}

/** A scene in a file of its own: a cube in the open in the first hand, and one down in a fixed hole, held by the second or, with
 *  one hand, by nobody. */
function sceneWithHole(hands) {
  const cube = (name, at, joint) => `[[body]]\nname = "${name}"\npart = { box = { size_m = [0.02, 0.02, 0.02] } }\npos_m = [${at}]\ndensity_kg_per_m3 = 1000\n${joint}\n`;
  const tools = ["open", "deep"].slice(0, hands).map((body, i) => `[[tool]]\nbody = "${body}"\ngrasp = "centre"\n${i > 0 ? 'device = "premium-1.5-6dof"' : ""}\n`);
  const hole = `[[body]]\nname = "hole"\npart = { hole_block = { peg_width_m = 0.05, peg_depth_m = 0.05, clearance_m = 0.001, wall_m = 0.01, hole_depth_m = 0.08, floor_m = 0.01 } }\njoint = { kind = "fixed" }\n`;
  const file = join(mkdtempSync(join(tmpdir(), "tactum-scene-")), "hole.toml");
  writeFileSync(file, ["schema = 1", 'description = "A part in the open and one in a hole"', 'device = "premium-1.5-6dof"', cube("open", "0, -0.15, 0", ""),
    cube("deep", "0, 0, 0.025", hands > 1 ? "" : 'joint = { kind = "fixed" }'), hole, ...tools, ""].join("\n"));
  return file;
}

const arrowsOf = async (page) => Number((await state(page)).fieldArrows);

export const topics = {
  async loads(browser, tactum) {
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
      check(before[0] > 300, `chart ${i} shows something: ${before[0]} pixels`);
      await until(`chart ${i} moves on`, async () => (await inkOf(page, i))[1] !== before[1]);
    }
    const now = await state(page);
    check(now.gaps === "0" && now.lost === "0", `no sample is missing: ${JSON.stringify(now)}`);
    check(page.complaints.length === 0, `no complaints: ${page.complaints.join("; ")}`);
    await program.end();
  },

  async hands(browser, tactum) {
    const program = await Program.start(tactum, "peg-two-hands");
    const page = await openPage(browser, program);
    await until("the second hand is pushed too", async () => Number((await state(page)).otherForces) > 0.2);
    check(/^The other hand holds “block” and feels [\d.]+ .?N and [\d.]+ .?N m\.$/.test(await page.textContent(".hands li")),
      `the page says what the other hand feels: ${await page.textContent(".hands")}`);
    const other = await openPage(browser, program);
    const before = [await placeOf(page, "peg"), await placeOf(page, "block")];
    await dragBody(page, "peg", -120); // two pages, two hands
    await dragBody(other, "block", 120);
    await until("both hands have followed", async () =>
      (await placeOf(page, "peg"))[0] < before[0][0] - 60 && (await placeOf(page, "block"))[0] > before[1][0] + 60);
    check((await state(page)).steering === "true" && (await state(other)).steering === "false", "the second page steers nothing else");
    await page.mouse.up();
    await page.mouse.move(...(await placeOf(page, "block")));
    await page.mouse.down();
    await until("a hand that another page leads is not taken, and the page says so", () => page.isVisible("#notice"));
    await page.mouse.up();
    await other.mouse.up();
    await dragBody(page, "block", -60); // left, it is free
    await page.mouse.up();
    check(page.complaints.length + other.complaints.length === 0, [...page.complaints, ...other.complaints].join("; "));
    await program.end();
  },

  async glass(browser, tactum) {
    for (const hands of [2, 1]) {
      const deep = await Program.start(tactum, sceneWithHole(hands));
      const looking = await openPage(browser, deep);
      if (hands === 2) await until("what hides the second hand's part is glass", async () => (await state(looking)).transparent === "hole");
      else await pause(1);
      check((await state(looking)).transparent === (hands === 2 ? "hole" : ""), `with ${hands} hands, of what no hand holds nothing is seen`);
      await keep(looking, `hole-${hands}`);
      await looking.keyboard.press("x");
      await looking.keyboard.press("x");
      await until("without glass all are solid", async () => (await state(looking)).transparent === "");
      await deep.end();
    }
  },

  async field(browser, tactum) {
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

  async picking(browser, tactum) {
    const program = await Program.start(tactum, "moving-objects");
    const page = await openPage(browser, program);
    const places = async () => JSON.parse((await state(page)).bodiesAt);
    check(Object.keys(await places()).length === 13, "thirteen bodies move");
    const holds = async () => (await state(page)).grasped === "cube 1";
    let [x, y] = [0, 0];
    // The stick that the demonstration swings may be before it, and a busy machine is slow: then once more.
    for (let tries = 0; tries < 15 && !(await holds()); ++tries) {
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
    await until("what was thrown has fallen", async () => (await places())["cube 1"][1] - lifted > 20);  // it may land on others
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async inspect(browser, tactum) {
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
    await keep(page, "inspect");
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async scenes(browser, tactum) {
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
};
