// The hand led by a SpaceMouse and by a gamepad: stand-ins of navigator.hid and navigator.getGamepads. The descriptors are laid out
// as those of real models are: turns in a report of their own (SpaceNavigator), or all six axes in one (SpaceMouse Wireless).
// And a page that is a device itself, which joins over WebSocket (examples/network_device.html).
import { mkdtempSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { check, graspedAt, openPage, pause, Program, readCsv, root, state, until, whenStill } from "./support.mjs";

/** The examples, served from this machine as people serve them. */
async function serveExamples() {
  const kinds = { html: "text/html", mjs: "text/javascript" };
  const server = createServer((request, response) => {
    const name = new URL(request.url, "http://localhost").pathname.slice(1);
    if (!/^[a-z_]+\.(html|mjs)$/.test(name)) return response.writeHead(404).end();
    response.writeHead(200, { "Content-Type": kinds[name.split(".")[1]] }).end(readFileSync(join(root, "examples", name)));
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return server;
}

/** What the page of the device says of the force on its hand: toward, right, up [N]. */
async function forceOnDevicePage(page) {
  const words = await page.textContent("#told");
  const [, ...numbers] = words.match(/^force: toward you (-?[\d.]+) N, right (-?[\d.]+) N, up (-?[\d.]+) N$/) ?? [];
  return numbers.length === 3 ? numbers.map(Number) : null;
}

/** In the page, before its scripts. */
function withSpaceMice() {
  const desktop = (usage) => (0x1 << 16) | usage;
  const axes = (usages) => ({ reportSize: 16, reportCount: usages.length, logicalMinimum: -350, logicalMaximum: 350, usages: usages.map(desktop), isArray: false, isConstant: false, isRange: false });
  const buttons = (count) => ({ reportSize: 1, reportCount: count, logicalMinimum: 0, logicalMaximum: 1, isRange: true, usageMinimum: 0x90001, usageMaximum: 0x90000 + count, usages: [], isConstant: false, isArray: false });
  const padding = (bits) => ({ reportSize: bits, reportCount: 1, logicalMinimum: 0, logicalMaximum: 1, usages: [], isConstant: true, isArray: false, isRange: false });
  const collection = (inputReports) => ({ usagePage: 0x1, usage: 0x8, type: 1, children: [], inputReports, outputReports: [], featureReports: [] });
  class Mouse extends EventTarget {
    opened = false;
    constructor(productName, collections) {
      super();
      Object.assign(this, { productName, collections });
    }
    async open() {
      this.opened = true;
    }
    report(reportId, bytes) {
      if (!this.opened) return;
      const event = new Event("inputreport");
      this.dispatchEvent(Object.assign(event, { reportId, data: new DataView(Uint8Array.from(bytes).buffer) }));
    }
  }
  const words = (numbers) => numbers.flatMap((n) => [n & 0xff, (n >> 8) & 0xff]);
  const two = new Mouse("SpaceNavigator", [collection([
    { reportId: 1, items: [axes([0x30, 0x31, 0x32])] }, { reportId: 2, items: [axes([0x33, 0x34, 0x35])] },
    { reportId: 3, items: [buttons(2), padding(14)] }])]);
  const one = new Mouse("SpaceMouse Wireless", [collection([
    { reportId: 1, items: [padding(3), padding(5), axes([0x30, 0x31, 0x32, 0x33, 0x34, 0x35])] }, { reportId: 3, items: [buttons(2), padding(14)] }])]);
  const keyboard = new Mouse("Pad without axes", [collection([{ reportId: 1, items: [buttons(8)] }])]);
  window.mice = { two, one, keyboard };
  window.chosen = two;
  window.deflect = {
    two: (v) => { two.report(1, words(v.slice(0, 3))); two.report(2, words(v.slice(3))); },
    one: (v) => one.report(1, [0xff, ...words(v)]),
  };
  class Hid extends EventTarget {
    async getDevices() {
      return [];
    }
    async requestDevice({ filters }) {
      window.filters = filters;
      return [window.chosen];
    }
  }
  window.hid = new Hid();
  Object.defineProperty(navigator, "hid", { value: window.hid });
}

function withGamepad() {
  window.aims = 0;
  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (message) {
    if (String(message).includes('"aim"')) ++window.aims;
    send.call(this, message);
  };
  window.rumbles = [];
  const up = () => ({ pressed: false, touched: false, value: 0 });
  window.pad = {
    id: "stand-in", index: 0, connected: true, mapping: "standard", axes: [0, 0, 0, 0], buttons: Array.from({ length: 17 }, up), timestamp: 0,
    vibrationActuator: { playEffect: async (kind, how) => void window.rumbles.push({ kind, ...how }) },
  };
  Object.defineProperty(navigator, "getGamepads", { value: () => [null, window.pad] });
}

const force = async (page) => Number((await state(page)).force);

/** Pushes what is led down, seen from the front, until the plate pushes back; then lifts it until it is clearly above the plate. */
async function pressesAndLifts(page, down, up, rest) {
  await down();
  await until("the plate pushes back", async () => (await force(page)) > 0.3);
  await up();
  await until("the part is free again", async () => (await force(page)) < 0.01);
  const [, y] = await graspedAt(page);
  await until("it is drawn higher", async () => (await graspedAt(page))[1] < y - 10);
  await rest();
}

export const topics = {
  async spacemouse(browser, tactum) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program, {}, "", withSpaceMice);
    await page.focus("#canvas");
    await page.keyboard.press("2"); // from the front
    await page.evaluate(() => (window.chosen = window.mice.keyboard));
    await page.click("#spacemouse");
    await until("a device without six axes is told", async () => (await page.textContent("#notice")).includes("six axes"));
    check((await page.getAttribute("#spacemouse", "aria-pressed")) === "false", "and does not lead");
    for (const name of ["two", "one"]) {
      await page.evaluate((which) => (window.chosen = window.mice[which]), name);
      await page.click("#spacemouse");
      await until("it leads the hand", async () => (await page.getAttribute("#spacemouse", "aria-pressed")) === "true");
      check((await page.evaluate(() => JSON.stringify(window.filters))) === '[{"usagePage":1,"usage":8}]', "only such devices are asked for");
      const deflect = (v) => page.evaluate(([which, values]) => window.deflect[which](values), [name, v]);
      await pressesAndLifts(page, () => deflect([0, 0, 200, 0, 0, 0]), () => deflect([0, 0, -200, 0, 0, 0]), () => deflect([0, 0, 0, 0, 0, 0]));
      const [x, y] = await whenStill(page);
      await deflect([200, 0, 0, 0, 0, 0]);
      await until("the part is drawn farther to the right", async () => (await graspedAt(page))[0] > x + 15);
      await deflect([0, 0, 0, 0, 0, 0]);
      const [right, level] = await whenStill(page);
      check(Math.abs(level - y) < 8, `a push to the right moves it by ${level - y} pixels up or down`);
      await deflect([-200, 0, 0, 0, 0, 0]);
      await until("and to the left", async () => (await graspedAt(page))[0] < right - 15);
      await deflect([0, 0, 0, 0, 0, 0]);
      await page.evaluate((which) => {
        const event = Object.assign(new Event("disconnect"), { device: window.mice[which] });
        window.hid.dispatchEvent(event);
      }, name);
      check((await page.getAttribute("#spacemouse", "aria-pressed")) === "false", "unplugged, it leads no more");
    }
    check((await state(page)).steering === "true", "the page has the hand");
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async gamepad(browser, tactum) {
    const program = await Program.start(tactum, "block-on-plate");
    const page = await openPage(browser, program, {}, "", withGamepad);
    await page.focus("#canvas");
    await page.keyboard.press("2");
    const sticks = (axes) => page.evaluate((values) => (window.pad.axes = values), axes);
    await sticks([0.08, -0.08, 0.05, 0.1]);
    await pause(0.5);
    check((await page.evaluate(() => window.aims)) === 0, "sticks that rest beside zero do not lead the hand");
    await page.evaluate(() => (window.rumbles.length = 0));
    await pressesAndLifts(page, () => sticks([0, 0.7, 0, 0]), () => sticks([0, -0.7, 0, 0]), () => sticks([0, 0, 0, 0]));
    const rumbles = await page.evaluate(() => window.rumbles);
    check(rumbles.length > 0 && rumbles.every((one) => one.kind === "dual-rumble" && one.weakMagnitude > 0.2 && one.weakMagnitude <= 1),
      `the contact is rumbled: ${JSON.stringify(rumbles.slice(0, 3))}`);
    const [x] = await whenStill(page);
    const before = await page.evaluate(() => window.rumbles.length);
    await sticks([0.7, 0, 0, 0]);
    await until("the stick moves it to the right", async () => (await graspedAt(page))[0] > x + 15);
    await sticks([0, 0, 0, 0]);
    await whenStill(page);
    check((await page.evaluate(() => window.rumbles.length)) === before, "in the air nothing rumbles");
    await page.evaluate(() => (window.pad.buttons[0] = { pressed: true, touched: true, value: 1 }));
    await pause(0.3);
    await page.evaluate(() => (window.pad.buttons[0] = { pressed: false, touched: false, value: 0 }));
    check(page.complaints.length === 0, page.complaints.join("; "));
    await program.end();
  },

  async device(browser, tactum) {
    const port = 20000 + (process.pid % 20000);
    const server = await serveExamples();
    const page = await (await browser.newContext()).newPage();
    const complaints = [];
    page.on("pageerror", (error) => complaints.push(String(error)));
    await page.goto(`http://127.0.0.1:${server.address().port}/network_device.html?port=${port}`); // waits for the program
    const trace = join(mkdtempSync(join(tmpdir(), "tactum-device-")), "run.csv");
    const program = Program.spawned(tactum, ["feel", "block-on-plate", "--device", `network:${port}`, "--trace", trace]);
    await until("the program says whose device it is", () => program.said.includes("network page at 1000 Hz"));
    const box = await page.locator("#plane").boundingBox();
    const goTo = (right_mm, up_mm) => page.mouse.move(box.x + box.width / 2 + 3 * right_mm, box.y + box.height / 2 - 3 * up_mm, { steps: 20 });
    await goTo(0, 0);
    await page.mouse.down();
    await goTo(0, -20); // the plate is 5 mm below the block
    const pressed = await until("the page shows a force that pushes the hand up", async () => {
      const [, , up] = (await forceOnDevicePage(page)) ?? [0, 0, 0];
      await pause(0.3);
      const force = await forceOnDevicePage(page);
      return up > 0.5 && force && Math.abs(force[2] - up) < 0.02 && force;
    });
    await goTo(0, 10);
    await until("in the air it feels nothing", async () => Math.hypot(...((await forceOnDevicePage(page)) ?? [1])) < 0.02);
    await goTo(20, 10);
    await pause(1);
    await page.mouse.up();
    await program.interrupt();
    await until("after the goodbye no force is left on it", async () => ((await forceOnDevicePage(page)) ?? [1]).every((part) => part === 0));
    const rows = readCsv(readFileSync(trace));
    const [highest, lowest, rightmost] = [Math.max(...rows.map((row) => row.hand_pz_m)), Math.min(...rows.map((row) => row.hand_pz_m)), Math.max(...rows.map((row) => row.hand_py_m))];
    const origin = rows[0];
    check(highest - origin.hand_pz_m > 0.008 && rightmost - origin.hand_py_m > 0.016 && lowest - origin.hand_pz_m < -0.008,
      `the page has led the hand: up to ${highest}, down to ${lowest}, to the right to ${rightmost} m`);
    const told = rows.some((row) => ["x", "y", "z"].every((axis, i) => Math.abs(row[`sent_f${axis}_N`] - pressed[i]) < 0.006));
    check(told, `it has shown what it was sent: ${pressed}`);
    check(complaints.length === 0, complaints.join("; "));
    server.close();
  },
};
