// The record button, and a recording that is seen again.
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { spawnSync } from "node:child_process";
import { check, openPage, Program, state, until } from "./support.mjs";

const verified = (tactum, file) => spawnSync(tactum, ["replay", file, "--verify"], { encoding: "utf8" });

export const topics = {
  /** A recording from the command line, and one that the page begins and ends in the middle of the run. */
  async record(browser, tactum) {
    const folder = mkdtempSync(join(tmpdir(), "tactum-record-"));
    const first = join(folder, "run.mcap");
    const program = await Program.start(tactum, "gears", ["--record", first], { cwd: folder });
    const page = await openPage(browser, program);
    check((await state(page)).recording === first, `the page says where the file is: ${(await state(page)).recording}`);
    await page.click("#record");
    await until("the recording has ended", async () => (await state(page)).recording === "");
    await until("the page says where it is", async () => (await page.textContent("#notice")).includes(`frames are recorded in ${first}`));
    await page.click("#record");
    const second = await until("another has begun", async () => (await state(page)).recording || false);
    check(second !== first && second.endsWith(".mcap"), `in a file of its own: ${second}`);
    await page.click("#reset");
    const third = await until("it goes on after a start again", async () => {
      const now = (await state(page)).recording;
      return now !== "" && now !== second ? now : false;
    });
    await until("frames are there", async () => Number((await state(page)).frames) > 1500);
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
    for (const file of [first, second, third]) {
      check(existsSync(file) && program.said.includes(file), `the end of the run says where ${file} is`);
      const replay = verified(tactum, file);
      check(replay.status === 0 && /all [1-9]\d* frames are the same/.test(replay.stdout), `${file} is the run: ${replay.stdout}${replay.stderr}`);
    }
    rmSync(folder, { recursive: true, force: true });
  },

  /** The time line: any frame, and what is felt there, is that of the recording. */
  async replay(browser, tactum) {
    const folder = mkdtempSync(join(tmpdir(), "tactum-replay-"));
    const file = join(folder, "gears.mcap");
    const frames = 4000;
    spawnSync(tactum, ["feel", "gears", "--virtual-clock", "--updates", String(frames), "--record", file]);
    const table = spawnSync(tactum, ["export", file, "--csv", "-"], { encoding: "utf8", maxBuffer: 1 << 28 }).stdout
      .split("\n").filter((line) => line !== "" && !line.startsWith("#"));
    const names = table[0].split(",");
    const of = (frame, name) => Number(table[1 + frame].split(",")[names.indexOf(name)]);
    const torque = (frame) => Math.hypot(...["x", "y", "z"].map((axis) => of(frame, `sent_t${axis}_Nm`)));
    const program = await Program.serve(tactum, ["replay", file]);
    const page = await openPage(browser, program);
    check(!(await page.isVisible("#stop")) && (await page.isVisible("#timeline")), "a replay has a time line, and nothing to stop");
    const shown = async () => Number((await page.textContent("#moment")).match(/frame (\d+) of/)?.[1]);
    await page.keyboard.press(" ");
    await until("it stands still", async () => (await page.textContent("#play")) === "Play");
    const goTo = async (frame) => {
      await page.evaluate((at) => {
        const line = document.getElementById("scrub");
        line.value = String(at);
        line.dispatchEvent(new Event("input", { bubbles: true }));
      }, frame);
      await until(`frame ${frame} is shown`, async () => (await shown()) === frame && Number((await state(page)).newest) === frame);
    };
    for (const frame of [3300, 1217, 2050, 3999, 0]) {
      await goTo(frame);
      await until(`the torque is that of frame ${frame}`, async () =>
        Math.abs(Number((await state(page)).torque) - torque(frame)) <= 1e-5 * (1 + torque(frame)), 10);
    }
    const touching = [...Array(frames).keys()].find((frame) => frame > 1200 && of(frame, "grasped_contact_points") > 0 && torque(frame) > 0.002);
    check(touching > 0, "the gears touch in the recording");
    await goTo(touching);
    await until("what is felt is told", async () => (await page.textContent(".sentence")).includes("touches"), 10);
    check((await page.locator(".contacts button").count()) > 0, "with its contacts");
    await page.keyboard.press(".");
    await until("one frame on", async () => (await shown()) === touching + 1);
    await page.keyboard.press(",");
    await page.keyboard.press(",");
    await until("two frames back", async () => (await shown()) === touching - 1);
    await page.selectOption("#speed", "0.1");
    await page.click("#play");
    await until("it goes on, slower", async () => (await shown()) > touching + 20);
    const chart = await page.locator("#strips .u-over").first().boundingBox();
    await page.mouse.click(chart.x + chart.width * 0.6, chart.y + chart.height / 2);
    await until("a chart leads to its moment", async () => (await page.textContent("#play")) === "Play");
    check(page.complaints.length === 0, page.complaints.join("; "));
    program.process.kill("SIGINT");
    check((await program.ended) === 0, program.said);
    rmSync(folder, { recursive: true, force: true });
  },
};
