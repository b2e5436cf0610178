// Hears the bridges with the clients that others use:  clients.mjs TACTUM PACKAGES
// roslib and @foxglove/ws-protocol subscribe to a run in real time, which writes its trace: what they get is what the trace
// has, to the bit. A client that takes nothing holds up neither them nor the loop; what is not understood is refused with
// a sentence; the hand is led by a message. Installs their packages in a folder the first time; ends with 77 where that cannot be.
import { execFileSync, spawn, spawnSync } from "node:child_process";
import { createHash } from "node:crypto";
import fs from "node:fs";
import { createRequire } from "node:module";
import http from "node:http";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const [tactum, packages] = process.argv.slice(2);
const require = createRequire(path.join(packages, "package.json"));
const lock = createHash("sha256").update(fs.readFileSync(path.join(here, "package-lock.json"))).digest("hex");
const stamp = path.join(packages, "node_modules", ".installed-from");
try {
  if (!fs.existsSync(stamp) || fs.readFileSync(stamp, "utf8") !== lock) {
    fs.mkdirSync(packages, { recursive: true });
    for (const file of ["package.json", "package-lock.json"]) fs.copyFileSync(path.join(here, file), path.join(packages, file));
    execFileSync("npm", ["ci", "--no-audit", "--no-fund", "--ignore-scripts"], { cwd: packages, stdio: "pipe" });
    fs.writeFileSync(stamp, lock);
  }
} catch (error) {
  console.log(`skipped: npm cannot install roslib and @foxglove/ws-protocol: ${error.message.split("\n")[0]}`);
  process.exit(77);
}
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const roslib = require("roslib");
const { WebSocket } = require("ws");

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "tactum-bridge-"));
const running = [];
process.on("exit", () => {
  for (const child of running) child.kill("SIGKILL");
  fs.rmSync(folder, { recursive: true, force: true });
});
function demand(holds, what) {
  if (holds) return;
  console.error(`wrong: ${what}`);
  process.exit(1);
}
setTimeout(() => demand(false, "nothing more happened"), 100000).unref();
const once = (emitter, event) => new Promise((resolve) => emitter.once(event, resolve));

/** Starts a run with both bridges; resolves with the process and the ports. */
function start(args) {
  const child = spawn(tactum, ["feel", ...args, "--bridge", "rosbridge:0", "--bridge", "foxglove:0"]);
  running.push(child);
  child.ended = once(child, "exit");
  let out = "";
  child.stderr.on("data", (text) => (child.err = (child.err ?? "") + text));
  return new Promise((resolve) => {
    child.stdout.on("data", (text) => {
      out += text;
      const found = /rosbridge at ws:\/\/127.0.0.1:(\d+)\nfoxglove at ws:\/\/127.0.0.1:(\d+)\n/.exec(out);
      const page = /see and feel it at http:\/\/([^ \n]+)\n/.exec(out);
      if (found && (page || !args.includes("--view"))) resolve({ child, ros: Number(found[1]), foxglove: Number(found[2]), page: page?.[1] });
    });
    child.ended.then(() => demand(out.includes("foxglove at"), `tactum ended early: ${child.err}`));
  });
}

/** The rows of a trace by their time in nanoseconds. */
function rowsOf(file) {
  const lines = fs.readFileSync(file, "utf8").split("\n").filter((line) => line !== "" && !line.startsWith("#"));
  const names = lines[0].split(",");
  const rows = new Map();
  for (const line of lines.slice(1)) {
    const row = Object.fromEntries(line.split(",").map((number, i) => [names[i], Number(number)]));
    rows.set(Math.round(row.time_s * 1e9), row);
  }
  return rows;
}

const xyz = (v) => [v.x, v.y, v.z];
const wxyz = (q) => [q.w, q.x, q.y, q.z];
const columns = (row, before, unit, turn) => [
  ...["x", "y", "z"].map((axis) => row[`${before}${axis}_${unit}`]),
  ...(turn ? ["w", "x", "y", "z"].map((part) => row[`${turn}_q${part}`]) : []),
];
// What each topic must say, from the row of its frame.
const expected = {
  "/tactum/hand/pose": (m) => [[...xyz(m.pose.position), ...wxyz(m.pose.orientation)], (r) => columns(r, "hand_p", "m", "hand")],
  "/tactum/tool/pose": (m) => [[...xyz(m.pose.position), ...wxyz(m.pose.orientation)], (r) => columns(r, "proxy_p", "m", "proxy")],
  "/tactum/hand/twist": (m) => [
    [...xyz(m.twist.linear), ...xyz(m.twist.angular)],
    (r) => [...columns(r, "hand_v", "m_per_s"), ...columns(r, "hand_w", "rad_per_s")],
  ],
  "/tactum/tool/twist": (m) => [
    [...xyz(m.twist.linear), ...xyz(m.twist.angular)],
    (r) => [...columns(r, "proxy_v", "m_per_s"), ...columns(r, "proxy_w", "rad_per_s")],
  ],
  "/wrench/sent": (m) => [
    [...xyz(m.wrench.force), ...xyz(m.wrench.torque)],
    (r) => [...columns(r, "sent_f", "N"), ...columns(r, "sent_t", "Nm")],
  ],
  "/wrench/computed": (m) => [
    [...xyz(m.wrench.force), ...xyz(m.wrench.torque)],
    (r) => [...columns(r, "computed_f", "N"), ...columns(r, "computed_t", "Nm")],
  ],
};
function compare(topic, messages, rows, who) {
  demand(messages.length >= 100, `${who}: ${messages.length} messages on ${topic}`);
  for (const message of messages) {
    const { stamp } = message.header;
    const time = (stamp.secs ?? stamp.sec) * 1e9 + (stamp.nsecs ?? stamp.nsec);
    demand(rows.has(time), `${who}: ${topic} at ${time} ns, which the trace has not`);
    demand(message.header.frame_id === "world", `${who}: frame ${message.header.frame_id}`);
    const [got, from] = expected[topic](message);
    const want = from(rows.get(time));
    demand(want.every((number, i) => Object.is(number + 0, got[i] + 0)), `${who}: ${topic}: ${got} for ${want}`);
  }
}

/** Whether each topic has so many messages, and one has told a contact. */
const enough = (heard, most) =>
  [...Object.keys(expected), "/tf"].every((topic) => heard[topic]?.length >= most) && heard["/tactum/contacts"].some(({ contacts }) => contacts.length > 0);

/** Collects the topics of a bridge of ROS until there are enough. */
function hearRos(port, most) {
  return new Promise((resolve) => {
    const ros = new roslib.Ros({ url: `ws://127.0.0.1:${port}` });
    const heard = {};
    const types = {};
    ros.on("error", (error) => demand(false, `roslib: ${error.message}`));
    ros.on("connection", () => {
      ros.getTopics((answer) => {
        answer.topics.forEach((topic, i) => (types[topic] = answer.types[i]));
        for (const name of answer.topics) {
          heard[name] = [];
          const topic = new roslib.Topic({ ros, name, messageType: types[name] });
          topic.subscribe((message) => {
            heard[name].push(message);
            if (heard[name].length === most) topic.unsubscribe();
            if (!enough(heard, most)) return;
            ros.close();
            resolve({ heard, types });
          });
        }
      });
    });
  });
}

function hearFoxglove(port, most) {
  return new Promise((resolve) => {
    const client = new FoxgloveClient({ ws: new WebSocket(`ws://127.0.0.1:${port}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
    const heard = {};
    const channels = {};
    const topicOf = new Map();
    client.on("error", (error) => demand(false, `foxglove: ${error.message ?? error}`));
    client.on("serverInfo", (info) => demand(info.name === "tactum", `server ${info.name}`));
    client.on("advertise", (list) => {
      for (const channel of list) {
        JSON.parse(channel.schema);
        channels[channel.topic] = channel;
        heard[channel.topic] = [];
        topicOf.set(client.subscribe(channel.id), channel.topic);
      }
    });
    client.on("message", ({ subscriptionId, data }) => {
      const list = heard[topicOf.get(subscriptionId)];
      list.push(JSON.parse(new TextDecoder().decode(data)));
      if (enough(heard, most)) {
        client.close();
        resolve({ heard, channels });
      }
    });
  });
}

// Every frame of a run, beside a client that subscribes to all and takes nothing, and one that breaks off.
const trace = path.join(folder, "run.csv");
const run = await start(["block-on-plate", "--duration", "60", "--bridge-rate", "1000", "--trace", trace]);
const stuck = new WebSocket(`ws://127.0.0.1:${run.foxglove}`, ["foxglove.websocket.v1"]);
const advertised = new Promise((resolve) =>
  stuck.on("message", (data, isBinary) => {
    const message = isBinary ? {} : JSON.parse(data);
    if (message.op === "advertise") resolve(message.channels);
  }),
);
const channelId = (await advertised).find(({ topic }) => topic === "/tf").id;
const ids = [...Array(40).keys()]; // forty times, so that what the system keeps for it is soon full
stuck.send(JSON.stringify({ op: "subscribe", subscriptions: ids.map((id) => ({ id, channelId })) }));
stuck._socket.pause();
const gone = new WebSocket(`ws://127.0.0.1:${run.foxglove}`, ["foxglove.websocket.v1"]);
await once(gone, "open");
gone.terminate();
const [ros, foxglove] = await Promise.all([hearRos(run.ros, 400), hearFoxglove(run.foxglove, 400)]);

// Refusals.
const rude = new WebSocket(`ws://127.0.0.1:${run.ros}`);
await once(rude, "open");
for (const [message, part] of [
  ["{", "expected a JSON object"],
  [JSON.stringify({ op: "subscribe", topic: "/none" }), "there is no topic /none"],
  [JSON.stringify({ op: "subscribe", topic: "/tf", type: "std_msgs/String" }), "has the type tf2_msgs/TFMessage"],
  [JSON.stringify({ op: "fly" }), 'found the operation "fly"'],
  [JSON.stringify({ op: "publish", topic: "/tactum/hand/command", msg: {} }), "is not led by clients"],
]) {
  rude.send(message);
  const answer = JSON.parse(await once(rude, "message"));
  demand(answer.op === "status" && answer.level === "error" && answer.msg.includes(part), `${message}: ${answer.msg}`);
}
const statusOf = (port, headers) =>
  new Promise((resolve) => http.get({ port, host: "127.0.0.1", headers }, (answer) => resolve(answer.statusCode)));
const upgrade = { Connection: "Upgrade", Upgrade: "websocket", "Sec-WebSocket-Version": 13, "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==" };
demand((await statusOf(run.ros, { ...upgrade, Origin: "https://example.org" })) === 403, "a foreign page is served");
demand((await statusOf(run.ros, { ...upgrade, Host: `example.org:${run.ros}` })) === 403, "a foreign name is served");
demand((await statusOf(run.foxglove, upgrade)) === 400, "a client without the subprotocol is served");
demand((await statusOf(run.ros, {})) === 426, "HTTP alone is served");
const taken = spawnSync(tactum, ["feel", "block-on-plate", "--updates", "10", "--bridge", `rosbridge:${run.ros}`], { encoding: "utf8" });
demand(taken.status === 1 && taken.stderr.includes("the bridge of rosbridge cannot listen"), `port in use: ${taken.stderr}`);
const wrong = spawnSync(tactum, ["feel", "--bridge", "dds"], { encoding: "utf8" });
demand(wrong.status === 2 && wrong.stderr.includes("there is no such bridge"), `a wrong name: ${wrong.stderr}`);

// The one that took nothing is told what it has missed, once it takes again.
const toldOf = new Promise((resolve) =>
  stuck.on("message", (data, isBinary) => {
    const message = isBinary ? {} : JSON.parse(data);
    if (message.op === "status") resolve(message);
  }),
);
await new Promise((resolve) => setTimeout(resolve, 1500)); // for more than the system keeps for it
stuck.send(JSON.stringify({ op: "unsubscribe", subscriptionIds: ids }));
stuck._socket.resume();
const told = await toldOf;
demand(told.level === 1 && /\d+ messages gave way/.test(told.message), `the slow client was told ${told.message}`);

run.child.kill("SIGINT");
await run.child.ended;
const rows = rowsOf(trace);
const alone = path.join(folder, "alone.csv");
spawnSync(tactum, ["feel", "block-on-plate", "--virtual-clock", "--updates", "2", "--trace", alone]);
const columnsOf = (file) => Object.keys(rowsOf(file).values().next().value).join();
demand(columnsOf(trace) === columnsOf(alone), "the trace has other columns than without a bridge");
for (const topic of Object.keys(expected)) {
  compare(topic, ros.heard[topic], rows, "roslib");
  compare(topic, foxglove.heard[topic], rows, "foxglove");
}
demand(ros.types["/tactum/hand/pose"] === "geometry_msgs/PoseStamped", "the type of a pose");
demand(foxglove.channels["/wrench/sent"].schemaName === "geometry_msgs/WrenchStamped", "the schema of a wrench");
demand(ros.heard["/tf"][0].transforms.length === foxglove.heard["/tf"][0].transforms.length, "transforms differ");
demand(ros.heard["/tf"][0].transforms.length >= 4, "transforms are missing");
demand(foxglove.heard["/scene"].length === 1 && foxglove.heard["/scene"][0].entities.length >= 2, "the scene's shapes");
for (const { heard, who } of [{ heard: ros.heard, who: "roslib" }, { heard: foxglove.heard, who: "foxglove" }]) {
  const lists = heard["/tactum/contacts"];
  const contact = lists.flatMap((message) => message.contacts)[0];
  demand(contact !== undefined && Math.abs(Math.hypot(...xyz(contact.n_BA_W)) - 1) < 1e-12, `${who}: no contact, or a normal that is no unit vector`);
}

// A message leads the hand of a device that can be led; two hands have topics of their own.
const led = await start(["block-on-plate", "--device", "pointer:touch", "--duration", "60", "--bridge-rate", "250"]);
await new Promise((resolve) => {
  const client = new roslib.Ros({ url: `ws://127.0.0.1:${led.ros}` });
  let target;
  const command = new roslib.Topic({ ros: client, name: "/tactum/hand/command", messageType: "geometry_msgs/PoseStamped" });
  const pose = new roslib.Topic({ ros: client, name: "/tactum/hand/pose", messageType: "geometry_msgs/PoseStamped", throttle_rate: 20 });
  let last = -1;
  pose.subscribe(({ header, pose: { position, orientation } }) => {
    const time = header.stamp.secs + header.stamp.nsecs * 1e-9;
    demand(last < 0 || time - last > 0.0199, "throttle_rate is not kept");
    last = time;
    target ??= { position: { ...position, z: position.z + 0.02 }, orientation };
    command.publish(new roslib.Message({ header: { frame_id: "world" }, pose: target }));
    if (position.z < target.position.z - 0.008) return; // the part hangs on the hand, which yields
    pose.unsubscribe();
    client.close();
    resolve();
  });
});
led.child.kill("SIGINT");
await led.child.ended;
const two = await start(["peg-two-hands", "--duration", "60"]);
const both = await hearFoxglove(two.foxglove, 5);
demand(both.heard["/tactum/hand2/pose"].length >= 4 && both.heard["/wrench/sent2"].length >= 4, "the second hand");
two.child.kill("SIGINT");
await two.child.ended;

// Beside a page: the numbers of the recording; the page starts the run anew, and then another scene.
const recorded = path.join(folder, "viewed.mcap");
const viewed = await start(["block-on-plate", "--view", "--device", "touch", "--duration", "120", "--record", recorded, "--bridge-rate", "1000"]);
const page = new WebSocket(`ws://${viewed.page}ws`, { origin: `http://${viewed.page.split("/")[0]}` });
await once(page, "open");
const [seenByRos, seenByFoxglove] = await Promise.all([hearRos(viewed.ros, 300), hearFoxglove(viewed.foxglove, 300)]);
const listener = new roslib.Ros({ url: `ws://127.0.0.1:${viewed.ros}` });
const slow = new roslib.Topic({ ros: listener, name: "/wrench/sent", messageType: "geometry_msgs/WrenchStamped", throttle_rate: 100 });
const closed = once(listener, "close");
const times = [];
const anew = new Promise((resolve) =>
  slow.subscribe(({ header: { stamp } }) => {
    times.push(stamp.secs + stamp.nsecs * 1e-9);
    if (times.length === 5) page.send(JSON.stringify({ do: "reset" }));
    const back = times.findIndex((time, i) => i > 0 && time < times[i - 1]);
    if (back > 0 && times.length > back + 5) resolve();
  }),
);
await anew;
page.send(JSON.stringify({ do: "scene", name: "gears" }));
await closed;
// Clients connect again, as often as it takes: the port is free for a moment.
while (await new Promise((resolve) => http.get({ port: viewed.ros, host: "127.0.0.1" }, () => resolve(false)).on("error", () => resolve(true))))
  await new Promise((resolve) => setTimeout(resolve, 50));
const other = await hearRos(viewed.ros, 50);
const framesOf = (heard) => heard["/tf"][0].transforms.map((transform) => transform.child_frame_id).join();
demand(framesOf(other.heard) !== framesOf(seenByRos.heard), `the bodies of another scene: ${framesOf(other.heard)}`);
viewed.child.kill("SIGINT");
await viewed.child.ended;
const table = path.join(folder, "viewed.csv");
const exported = spawnSync(tactum, ["export", recorded, "--csv", table], { encoding: "utf8" });
demand(exported.status === 0, `the recording: ${exported.stderr}`);
const viewedRows = rowsOf(table);
for (const topic of Object.keys(expected)) {
  compare(topic, seenByRos.heard[topic], viewedRows, "roslib beside a page");
  compare(topic, seenByFoxglove.heard[topic], viewedRows, "foxglove beside a page");
}
console.log(`${rows.size} frames in the trace, ${ros.heard["/wrench/sent"].length} wrenches by roslib, the same to the bit`);
process.exit(0);
