// Reads a recording with @mcap/core, the reader that Foxglove uses:  mcap_core.mjs TACTUM
// Every channel is there, every message can be read by its schema, checksums hold with the stream reader, and the numbers
// of /tactum/frame are those of `tactum export --csv` to the bit. Ends with 77 where the packages are not installed.
import { execFileSync, spawnSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const web = path.join(path.dirname(fileURLToPath(import.meta.url)), "../../viewer/web/package.json");
const require = createRequire(web);
let core, fzstd;
try {
  core = require("@mcap/core");
  fzstd = require("fzstd");
} catch (error) {
  console.log(`skipped: ${error.message.split("\n")[0]}`);
  process.exit(77);
}

function demand(holds, what) {
  if (holds) return;
  console.error(`wrong: ${what}`);
  process.exit(1);
}

const tactum = process.argv[2];
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "tactum-mcap-"));
process.on("exit", () => fs.rmSync(folder, { recursive: true, force: true }));
const recording = path.join(folder, "run.mcap");
const table = path.join(folder, "run.csv");
const run = spawnSync(tactum, ["feel", "block-on-plate", "--virtual-clock", "--updates", "800", "--record", recording]);
demand(run.status === 0 || run.status === 2, `tactum feel ended with ${run.status}: ${run.stderr}`);
execFileSync(tactum, ["export", recording, "--csv", table], { stdio: "ignore" });

const bytes = fs.readFileSync(recording);
const decompressHandlers = { zstd: (data, size) => fzstd.decompress(data, new Uint8Array(Number(size))) };

// With every checksum, from front to back.
const stream = new core.McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(bytes);
const streamed = {};
for (let record; (record = stream.nextRecord()); ) streamed[record.type] = (streamed[record.type] ?? 0) + 1;
demand(stream.done(), "the stream has no end");
demand(streamed.Attachment === 1 && streamed.Metadata === 1, "attachment or metadata is missing");

// By the summary and its indexes.
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
};
const reader = await core.McapIndexedReader.Initialize({ readable, decompressHandlers });
const channels = new Map([...reader.channelsById.values()].map((channel) => [channel.topic, channel]));
for (const topic of ["run", "input", "command", "report", "frame", "contacts"])
  demand(channels.has(`/tactum/${topic}`), `no channel /tactum/${topic}`);
for (const topic of ["/tf", "/scene", "/wrench/sent", "/wrench/computed"])
  demand(channels.has(topic), `no channel ${topic}`);

// The numbers of a flat ROS 1 message, by its schema's lines.
const fieldsOf = (schema) =>
  new TextDecoder().decode(schema.data).split("\n").filter((line) => line.startsWith("float64 ")).map((line) => line.split(/\s+/)[1]);
const counts = new Map();
const rows = [];
let frameFields = [];
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  counts.set(channel.topic, (counts.get(channel.topic) ?? 0) + 1);
  if (channel.messageEncoding === "json") {
    const value = JSON.parse(new TextDecoder().decode(message.data));
    demand(typeof value === "object", `${channel.topic} is no object`);
    continue;
  }
  demand(schema.encoding === "ros1msg", `${channel.topic} has the encoding ${schema.encoding}`);
  if (channel.topic !== "/tactum/frame" && channel.topic !== "/tactum/report") continue;
  const fields = fieldsOf(schema);
  demand(message.data.byteLength === 8 * fields.length, `${channel.topic}: ${message.data.byteLength} bytes`);
  if (channel.topic !== "/tactum/frame") continue;
  frameFields = fields;
  const view = new DataView(message.data.buffer, message.data.byteOffset, message.data.byteLength);
  rows.push(fields.map((_, i) => view.getFloat64(8 * i, true)));
}
for (const topic of ["/tactum/input", "/tactum/report", "/tactum/frame"])
  demand(counts.get(topic) === 800, `${topic} has ${counts.get(topic)} messages`);
demand(counts.get("/tf") > 100, "no poses");
demand(counts.get("/wrench/sent") === 48, `${counts.get("/wrench/sent")} wrenches`);

const lines = fs.readFileSync(table, "utf8").split("\n").filter((line) => line !== "" && !line.startsWith("#"));
const names = lines[0].split(",");
demand(JSON.stringify(names) === JSON.stringify(frameFields), "the columns are not the fields");
demand(lines.length === rows.length + 1, `${lines.length - 1} rows, ${rows.length} messages`);
rows.forEach((row, i) => {
  const cells = lines[i + 1].split(",");
  row.forEach((number, j) => demand(number + 0 === Number(cells[j]), `row ${i}, ${names[j]}: ${number} and ${cells[j]}`));
});
console.log(`${rows.length} frames of ${names.length} numbers are those of the table; ${channels.size} channels`);
