// Several pages at once, a page that is slow or cut off, and clients that are refused.
import { createConnection } from "node:net";
import { check, drag, openPage, pause, Program, state, until } from "./support.mjs";

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

export const topics = {
  async viewers(browser, tactum) {
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

  async stall(browser, tactum) {
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

  async dropped(browser, tactum) {
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

  async gone(browser, tactum) {
    const program = await Program.start(tactum, "gears");
    const page = await openPage(browser, program);
    check(!(await page.isVisible("#gone")), "no word of a loss while all is well");
    const port = program.port;
    await program.end();
    await until("the page says that nobody is there", async () => (await page.isVisible("#gone")) && (await page.textContent("#gone")).includes("has ended or cannot be reached"));
    check(await page.evaluate(() => document.body.classList.contains("gone")), "the numbers are marked as old");
    const frozen = (await state(page)).newest;
    await page.keyboard.press("Space");
    await until("a stop that reaches nobody is no stop", async () => (await page.textContent("#notice")).includes("was not stopped"));
    check(!(await page.isVisible("#stopped")), "... and is not shown as one");
    check((await state(page)).newest === frozen, "the numbers stand still");
    const next = await Program.start(tactum, "peg-in-hole", ["--port", String(port)]);
    await until("a new run at the same port is told", async () => (await page.textContent("#gone")).includes("a new one answers"));
    const bareAnswer = await bare(port, `GET /${program.token}/ HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n\r\n`);
    check(bareAnswer.includes("terminal shows"), `who comes with an old address is told where the new one is: ${bareAnswer}`);
    await next.end();
  },

  async refusals(browser, tactum) {
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
};
