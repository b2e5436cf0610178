// The panels, the keyboard, and a page on a narrow screen.
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, downloaded, graspedAt, openPage, pause, Program, readCsv, root, shownForce, state, until, whenStill } from "./support.mjs";

export const topics = {
  async why(browser, tactum) {
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

  async panel(browser, tactum) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    await page.click("#tab-panel");
    const field = page.locator('[id="set-coupling.stiffness_N_per_m"]');
    check((await page.locator('[id="set-response"] option').allTextContents()).join() === "penalty,constraint", "a choice is told by its words");
    const margin = () => page.textContent("#margin");
    check((await margin()).includes("The coupling of 600 N/m"), `the stability margin is told: ${await margin()}`);
    await field.fill("432");
    await field.press("Enter");
    await field.blur();
    await until("the margin follows the gain", async () => (await margin()).includes("coupling of 432 N/m"));
    const toml = (await downloaded(page, "#save-toml")).toString();
    check(toml.includes("[settings]") && toml.includes("coupling.stiffness_N_per_m = 432  #"), `the saved settings have it: ${toml}`);
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

  /** Limits and gains go back to where they were, and what was changed goes back into its scene. */
  async settings(browser, tactum) {
    const folder = mkdtempSync(join(tmpdir(), "tactum-settings-"));
    const scene = join(folder, "press.toml"); // the scripted hand presses the block down
    writeFileSync(scene, `${readFileSync(join(root, "scenes/block-on-plate.toml"), "utf8")}\n[safety]\nmax_torque_Nm = 0.3\n`);
    const program = await Program.start(tactum, scene);
    const page = await openPage(browser, program);
    await page.click("#tab-panel");
    const field = (id) => page.locator(`[id="set-${id}"]`);
    const usual = (id) => page.locator(`[id="usual-${id}"]`);
    const fill = async (id, text) => {
      await field(id).fill(text);
      await field(id).press("Enter");
      await field(id).blur();
    };
    const isNow = (id, text) => until(`${id} is ${text}`, async () => (await field(id).inputValue()) === text);
    check(await page.isDisabled("#save-toml"), "nothing was changed, so there is nothing to save");
    await fill("safety.max_force_N", "0.2");
    await isNow("safety.max_force_N", "0.2");
    await pause(6); // of the scripted press
    const forces = async () => readCsv(await downloaded(page, "#csv")).map(shownForce);
    check(Math.max(...(await forces()).slice(-3000)) < 0.2001, "the limit holds");
    await fill("safety.max_force_N", "");
    await isNow("safety.max_force_N", "");
    await until("the force is beyond the limit that was taken away", async () => Number((await state(page)).force) > 0.3, 60);
    check(!(await usual("safety.max_force_N").isVisible()), "that is as the scene has it");
    await fill("safety.max_torque_Nm", ""); // a limit of the scene's own
    await isNow("safety.max_torque_Nm", "");
    check((await usual("safety.max_torque_Nm").getAttribute("title")).includes("0.3 N m"), "the way back says where it leads");
    await usual("safety.max_torque_Nm").click();
    await isNow("safety.max_torque_Nm", "0.3");
    await fill("coupling.stiffness_N_per_m", "432");
    await fill("coupling.damping_Ns_per_m", "");
    await fill("penalty.stiffness_N_per_m", "777");
    await isNow("coupling.stiffness_N_per_m", "432");
    await isNow("penalty.stiffness_N_per_m", "777");
    const toml = (await downloaded(page, "#save-toml")).toString();
    const keys = toml.split("\n").filter((line) => line !== "").map((line) => line.split(" ")[0]);
    check(keys.join() === "[settings],coupling.stiffness_N_per_m,penalty.stiffness_N_per_m", `only what was changed is saved: ${toml}`);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
    const saved = join(folder, "saved.toml");
    writeFileSync(saved, toml);
    writeFileSync(scene, `${readFileSync(scene, "utf8")}\n${toml}`);
    for (const words of [[scene], ["block-on-plate", "--settings", saved]]) {
      const again = await Program.command(tactum, ["feel", ...words]);
      const other = await openPage(browser, again);
      await other.click("#tab-panel");
      for (const [id, text] of [["coupling.stiffness_N_per_m", "432"], ["penalty.stiffness_N_per_m", "777"]])
        check((await other.locator(`[id="set-${id}"]`).inputValue()) === text, `${words.join(" ")} has ${id} = ${text}`);
      await again.end();
    }
  },

  /** What the page says of a scene and its goals, and a scene that cannot be opened. */
  async remarks(browser, tactum) {
    const folder = mkdtempSync(join(tmpdir(), "tactum-remarks-"));
    const scene = join(folder, "odd.toml");
    writeFileSync(scene, readFileSync(join(root, "scenes/block-on-plate.toml"), "utf8")
      .replace(/^schema = 1/m, "schema = 1\ngravity_m_per_s2 = [0, 0, -1]").replace("density_kg_per_m3 = 1000", "density_kg_per_m3 = 40000")
      .replace("[[hand.step]]", "[[hand.step]]\nhold_s = 60\n\n[[hand.step]]")); // above the plate, until the page is there
    const program = await Program.start(tactum, scene);
    const page = await openPage(browser, program);
    const warnings = await page.locator(".remarks li.warning").allTextContents();
    check(warnings.some((text) => text.includes("densest metal")), `the remarks of the terminal stand on the page: ${warnings}`);
    check((await page.locator(".about li").count()) > 0, "and what the scene is");
    const sentence = await until("nothing touches yet", async () => { const text = await page.textContent(".sentence"); return text.includes("Nothing") && text; });
    check(sentence.includes("its weight is") && !sentence.includes("joint"), `weight is named where there is one, a joint is not where there is none: ${sentence}`);
    const absent = await page.locator("#scene option:disabled").allTextContents();
    check(absent.some((text) => text.startsWith("nut-bolt-file") && text.includes("absent")), `scenes without their meshes cannot be chosen: ${absent}`);
    await page.evaluate(() => { // ... and one that is asked for all the same leaves the list where it was
      const list = document.getElementById("scene");
      list.querySelector("option:disabled").disabled = false;
      list.value = "nut-bolt-file";
      list.dispatchEvent(new Event("change"));
    });
    await until("the page says why", async () => await page.isVisible("#notice"));
    check((await page.inputValue("#scene")) === "odd", "the list names the scene that runs");
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
    const gears = await Program.start(tactum, "gears");
    const other = await openPage(browser, gears);
    await until("the goals are on the page", async () => (await other.locator(".goals li").count()) > 0);
    await until("a goal is met", async () => (await other.locator(".goals li.met").count()) > 0, 60);
    check(!(await other.textContent(".sentence")).includes("weight"), "there is no weight in this scene");
    await gears.end();
  },

  async keyboard(browser, tactum) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program);
    await page.focus("#canvas");
    await page.keyboard.press("ArrowRight"); // takes the hand; the demonstration ends
    await until("the page leads the hand", async () => (await state(page)).steering === "true");
    const before = await whenStill(page);
    for (let i = 0; i < 25; ++i) await page.keyboard.press("ArrowLeft");
    await until("arrows have moved the part", async () => (await graspedAt(page))[0] < before[0] - 10);
    const after = await whenStill(page);
    await page.keyboard.press("4");
    await until("digits choose the view", async () => (await graspedAt(page)).join() !== after.join());
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

  async narrow(browser, tactum) {
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
};
