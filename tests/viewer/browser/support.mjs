// What every browser test needs: the program, a browser, pages whose every complaint is remembered, and waiting.
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

export const root = join(dirname(fileURLToPath(import.meta.url)), "../../..");
const browserPath = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find((path) => existsSync(path));
const playwright = join(root, "viewer/web/node_modules/playwright-core");

/** Why the tests cannot run here; empty when they can. */
export const missing = !browserPath ? "there is no chromium" : !existsSync(playwright) ? "the page was not built here, so there is no playwright-core" : "";

export async function openBrowser() {
  const { chromium } = createRequire(import.meta.url)(playwright);
  return await chromium.launch({
    executablePath: browserPath,
    args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
}

export const pause = (seconds) => new Promise((resolve) => setTimeout(resolve, 1000 * seconds));

export function check(condition, sentence) {
  if (!condition) throw new Error(sentence);
}

const started = [];
process.on("exit", () => started.forEach((program) => program.kill("SIGKILL"))); // none outlives its test

/** The program with its page, as a user starts it. */
export class Program {
  static async start(tactum, scene, options = [], place = {}) {
    return await Program.command(tactum, ["feel", scene, ...options], place);
  }
  /** Any command that serves a page and writes a summary. */
  static async command(tactum, words, place = {}) {
    const folder = mkdtempSync(join(tmpdir(), "tactum-browser-"));
    const json = join(folder, "summary.json");
    const program = await Program.serve(tactum, [...words, "--json", json], place);
    return Object.assign(program, { folder, json });
  }
  /** Any command that serves a page. */
  static async serve(tactum, words, place = {}) {
    const program = Program.spawned(tactum, [...words, "--view"], place);
    const address = await until("the program tells its address", () => program.said.match(/http:\/\/\S+/)?.[0]);
    program.address = address;
    const url = new URL(address);
    program.port = Number(url.port);
    program.token = url.pathname.split("/")[1];
    return program;
  }
  /** Any command. */
  static spawned(tactum, words, place = {}) {
    const program = new Program();
    program.process = spawn(tactum, words, {
      stdio: ["ignore", "pipe", "pipe"], env: { ...process.env, DISPLAY: "", WAYLAND_DISPLAY: "" }, ...place,
    });
    started.push(program.process);
    program.said = "";
    program.ended = new Promise((resolve) => program.process.on("exit", (code) => resolve(code)));
    for (const stream of [program.process.stdout, program.process.stderr]) stream.on("data", (data) => (program.said += data));
    return program;
  }
  /** Ends it as Ctrl-C does. */
  async interrupt() {
    this.process.kill("SIGINT");
    const code = await this.ended;
    // 2: the goals of the scene were not met, as where a test leads the hand.
    check(code === 0 || code === 2, `the program ended with ${code}:\n${this.said}`);
  }
  /** The same; its summary for machines. */
  async end() {
    await this.interrupt();
    const summary = JSON.parse(readFileSync(this.json, "utf8"));
    rmSync(this.folder, { recursive: true, force: true });
    return summary;
  }
}

/** Asks again and again until the answer is neither false nor undefined. */
export async function until(sentence, ask, seconds = 40) {
  for (let i = 0; i < seconds * 20; ++i) {
    const answer = await ask();
    if (answer !== false && answer !== undefined && answer !== null) return answer;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  throw new Error(`waited in vain until ${sentence}`);
}

/** A page that remembers what it complained of, and its sockets so that a test can cut them. `before` runs in the page before
 *  its own scripts. */
export async function openPage(browser, program, options = {}, look = "", before = null) {
  // Half as many pixels each way as the page has places: no graphics card draws here, and every pixel costs the other processes time.
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, deviceScaleFactor: 0.5, colorScheme: "dark", acceptDownloads: true, ...options });
  const page = await context.newPage();
  page.complaints = [];
  page.on("console", (message) => {
    if (message.type() === "error" || /Content Security Policy|Trusted/i.test(message.text())) page.complaints.push(message.text());
  });
  page.on("pageerror", (error) => page.complaints.push(String(error)));
  await page.addInitScript(() => {
    const Plain = window.WebSocket;
    window.openSockets = [];
    window.WebSocket = class extends Plain {
      constructor(...all) {
        super(...all);
        window.openSockets.push(this);
      }
    };
  });
  if (before) await page.addInitScript(before);
  await page.goto(program.address + look);
  await until("the page shows frames", async () => Number((await state(page)).samples) > 200);
  return page;
}

/** What the page tells of itself in attributes: the strict policy forbids most other ways to ask. */
export async function state(page) {
  return await page.evaluate(() => ({ ...document.body.dataset }));
}

export async function graspedAt(page) {
  return (await state(page)).graspedAt.split(",").map(Number);
}

/** Where the held part is drawn once it has stopped moving, however slowly the page draws: several frames on end show it there. */
export async function whenStill(page) {
  let last = "";
  let since = 0;
  await until("the held part is still", async () => {
    const { graspedAt: at, newest } = await state(page);
    if (at !== last) [last, since] = [at, Number(newest)];
    return Number(newest) - since > 700;
  });
  return last.split(",").map(Number);
}

/** Presses on the held part until it is taken: the scripted hand may move it away meanwhile. The place where it was taken. */
export async function takePart(page) {
  for (let tries = 0; tries < 10; ++tries) {
    const [x, y] = await graspedAt(page);
    await page.mouse.move(x, y);
    await page.mouse.down();
    if (await page.evaluate(() => document.getElementById("canvas").classList.contains("holding"))) return [x, y];
    await page.mouse.up();
    await pause(0.3);
  }
  throw new Error("the held part could not be taken");
}

/** Takes the held part where it is now and drags it by so many pixels, slowly. */
export async function drag(page, right, down, steps = 40, release = true) {
  const [x, y] = await takePart(page);
  for (let i = 1; i <= steps; ++i) {
    await page.mouse.move(x + (right * i) / steps, y + (down * i) / steps);
    await new Promise((resolve) => setTimeout(resolve, 25));
  }
  if (release) await page.mouse.up();
}

/** A picture for people, where TACTUM_KEEP_PICTURES names a folder. */
export async function keep(page, name) {
  if (process.env.TACTUM_KEEP_PICTURES) await page.screenshot({ path: join(process.env.TACTUM_KEEP_PICTURES, `${name}.png`) });
}

/** The content of what a click downloads. */
export async function downloaded(page, selector) {
  const [download] = await Promise.all([page.waitForEvent("download"), page.click(selector)]);
  return readFileSync(await download.path());
}

/** Rows of a CSV file as objects. */
export function readCsv(bytes) {
  const [head, ...lines] = bytes.toString("utf8").trim().split("\n").filter((line) => !line.startsWith("#"));
  const names = head.split(",");
  return lines.map((line) => Object.fromEntries(line.split(",").map((value, i) => [names[i], value === "" ? Number.NaN : Number(value)])));
}
export const shownForce = (row) => Math.hypot(row["shown.fx [N]"], row["shown.fy [N]"], row["shown.fz [N]"]);

/** How many pixels of a chart are not of its most common colour: a flat or empty chart has few. */
export async function inkOf(page, index) {
  return await page.evaluate((i) => {
    const canvas = document.querySelectorAll("#strips canvas")[i];
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let ink = 0;
    let sum = 0;
    for (let k = 3; k < data.length; k += 4) {
      if (data[k] > 40) ++ink;
      sum = (sum * 31 + data[k] + data[k - 1]) % 1000000007;
    }
    return [ink, sum];
  }, index);
}
