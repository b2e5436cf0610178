// The viewer as people use it, in Debian's Chromium:  node run.mjs TOPIC TACTUM
// A topic that fails says which sentence was not true. 77: nothing to run it with.
import { topics as connectionTopics } from "./connection_topics.mjs";
import { topics as controlTopics } from "./control_topics.mjs";
import { topics as forceTopics } from "./force_topics.mjs";
import { topics as layoutTopics } from "./layout_topics.mjs";
import { topics as padTopics } from "./pad_topics.mjs";
import { topics as pictureTopics } from "./picture_topics.mjs";
import { topics as recordingTopics } from "./recording_topics.mjs";
import { topics as sceneTopics } from "./scene_topics.mjs";
import { missing, openBrowser } from "./support.mjs";

const [topic, tactum] = process.argv.slice(2);
const topics = { ...sceneTopics, ...forceTopics, ...connectionTopics, ...controlTopics, ...layoutTopics, ...padTopics, ...pictureTopics, ...recordingTopics };

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
  await topics[topic](browser, tactum);
  console.log(`${topic}: passed`);
} catch (error) {
  console.error(`${topic}: ${error.message}`);
  process.exitCode = 1;
} finally {
  await browser.close();
  if (process.exitCode) process.exit(1); // the program that was started ends with us
}
