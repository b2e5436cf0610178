// The page: what is felt, seen. Puts the parts together; each file beside this one is one part.
import "./style.css";
import type { Glass } from "./bodies";
import { Charts } from "./charts";
import { Connection } from "./connection";
import { download, get, make } from "./dom";
import { Hand } from "./hand";
import { showHelp } from "./help";
import { edgeKinds } from "./look";
import { Pads } from "./pads";
import { Panel } from "./panel";
import { readShapes, type Frames, type Picture, type Run, type Shape, type Status, type ServerMessage } from "./protocol";
import { Recording } from "./recording";
import { Samples } from "./samples";
import type { Facts } from "./table";
import { Timeline } from "./timeline";
import { withUnit } from "./units";
import { View, type ViewName } from "./view";
import { Why } from "./why";

const body = document.body;
const canvas = get<HTMLCanvasElement>("canvas");
const view = new View(canvas, get("labels"), get("scale"), get("cube"));
const charts = new Charts(get("strips"), get("span"), get("also"), get("cursor"));
const why = new Why(get("why"));
let run: Run | null = null;
let samples: Samples | null = null;
let status: Status | null = null;
let shapes: Shape[] = [];
let waitingFrames: Frames[] = []; // of a run whose geometry is on its way
let stopped = false;
let asked: { stop: boolean; timer: number } | null = null; // what the program has not confirmed yet
let begun = 0; // counts the runs that were begun: the geometry of an older one may come late
let cutOff = false; // what is shown is the last that the program sent

const connection = new Connection({ received, frames, linked, gone });
const ask = (message: Record<string, unknown>) => connection.send(message);
const panel = new Panel(get("panel"), (message) => {
  if (maySteer()) ask(message);
});
const hand = new Hand(view, canvas, { mayLead, send: ask });
const pads = new Pads(hand, notice);
const askToSteer = (message: Record<string, unknown>) => void (maySteer() && ask(message));
const timeline = new Timeline(askToSteer);
const recording = new Recording(askToSteer);

function maySteer(): boolean {
  if (status?.steering) return true;
  if (status?.somebody_steers) {
    notice("Another page has the hand. “Take the hand” takes it over.");
    return false;
  }
  ask({ do: "steer" });
  return true;
}

/** The first hand is led by the page that steers, any other by the page that takes it. */
function mayLead(which: number): boolean {
  if (which === 0) return maySteer();
  if (!status?.led_elsewhere.includes(which)) return true;
  notice("Another page leads this hand.");
  return false;
}

function notice(text: string) {
  const box = get("notice");
  box.textContent = text;
  box.hidden = false;
  window.clearTimeout(Number(box.dataset.timer));
  box.dataset.timer = String(window.setTimeout(() => (box.hidden = true), 6000));
}

// ---- what the program says

function received(message: ServerMessage) {
  if (message.type === "run") void begin(message);
  else if (message.type === "settings") panel.showSettings(message);
  else if (message.type === "notice") {
    notice(message.sentence);
    if (run) get<HTMLSelectElement>("scene").value = run.scene; // a scene that could not be opened is not the one that runs
  }
  else showStatus(message);
}

async function begin(next: Run) {
  const number = ++begun;
  const geometry = await fetch("geometry").then((answer) => (answer.ok ? answer.arrayBuffer() : null)).catch(() => null);
  if (number !== begun) return; // another run has begun meanwhile, or the line was lost
  if (!geometry) return notice("The scene's geometry could not be loaded. Load the page anew.");
  shapes = readShapes(geometry);
  cutOff = false;
  newest = null;
  showGone("");
  run = next;
  samples = new Samples(next);
  view.begin(next, shapes);
  hand.begin(next);
  charts.begin(next, samples);
  why.begin(next);
  panel.begin(next);
  timeline.begin(next);
  body.classList.toggle("replays", timeline.active);
  view.bodies?.showPieces(pressed("pieces"));
  view.bodies?.showThrough(glass);
  showKinds(pressed("edges"));
  const choice = get<HTMLSelectElement>("scene");
  const known = next.scenes.some((scene) => scene.name === next.scene);
  choice.replaceChildren(
    ...(known ? [] : [new Option(next.scene, next.scene)]),
    ...next.scenes.map((scene) => {
      const absent = scene.absent.length > 0;
      const option = new Option(`${scene.name}: ${absent ? "its meshes are absent, see docs/real-parts.md" : scene.description}`, scene.name);
      option.disabled = absent;
      return option;
    }));
  choice.value = next.scene;
  document.title = `Tactum: ${next.scene}`;
  body.classList.toggle("only-looks", next.grasped < 0 && next.bodies.every((one) => !one.moves)); // a part alone
  showHint();
  back();
  for (const early of waitingFrames.splice(0)) frames(early);
  body.dataset.scene = next.scene;
  body.dataset.run = String(next.run);
  get("field").hidden = next.field.length === 0;
}

function frames(message: Frames) {
  if (!run || cutOff || message.run !== run.run) {
    if (!run || cutOff || message.run > run.run) waitingFrames.push(message);
    return;
  }
  samples?.take(message);
  if (message.picture) newest = message.picture;
  body.dataset.lost = String(message.lost);
}
let newest: Picture | null = null;

function linked(up: boolean) {
  body.dataset.link = up ? "up" : "down";
  get("link").textContent = up ? "connected" : "connection lost, trying again";
  get("link").classList.toggle("bad", !up);
  if (!up) {
    cutOff = true;
    ++begun;
    waitingFrames = [];
    if (asked) unanswered();
    hand.loseAll();
  }
}

/** Says across the scene that its numbers are old; with an empty text, that they are not. */
function showGone(text: string) {
  get("gone").textContent = text;
  get("gone").hidden = text === "";
  body.classList.toggle("gone", text !== "");
}
function gone(why: "nobody" | "other") {
  if (!cutOff) return;
  get("link").textContent = why === "other" ? "another run" : "no program";
  showGone(why === "other"
    ? "This run has ended, and a new one answers at this port: open the address that its terminal shows. What is seen here is the last of the old run."
    : "The program has ended or cannot be reached. What is seen here is the last that it sent; the page goes on asking.");
}

function showStatus(message: Status) {
  const led = status?.steering ?? false;
  status = message;
  if (led && !message.steering) {
    hand.lose(0);
    notice("Another page has taken the hand.");
  }
  for (const other of message.led_elsewhere) hand.lose(other);
  const confirmed = message.stop_asked || (message.program.stopped ?? false);
  if (asked && confirmed === asked.stop) answered();
  if (!asked) showStopped(confirmed ? "stopped" : "");
  why.showGoals(message.program.goals ?? []);
  get("steer").hidden = message.steering || !message.somebody_steers;
  const link = get("link");
  const health = message.program;
  link.textContent = health.device_lost ? "device lost" : `${run ? `${Math.round(run.rate_Hz)} Hz · ` : ""}${message.pages} ${message.pages === 1 ? "page" : "pages"}`;
  link.classList.toggle("bad", health.device_lost ?? false);
  panel.showStatus(message);
  timeline.showStatus(message);
  recording.showStatus(message);
  body.dataset.steering = String(message.steering);
  body.dataset.stopped = String(confirmed);
  body.dataset.pages = String(message.pages);
  body.dataset.refused = JSON.stringify(message.refused);
  body.dataset.frames = String(health.frames ?? 0);
}

// ---- drawing

let lastSpoken = 0;
function showSummary(sample: number) {
  if (!run || !samples) return;
  const shown = run.stages.length - 1;
  const force = samples.length(shown, 0, sample);
  const torque = samples.length(shown, 3, sample);
  const points = samples.at(samples.column("grasped_contact_points"), sample);
  get("summary").textContent = run.grasped < 0 ? "nothing is held" : `${withUnit(force, "N")} · ${withUnit(torque, "N m")} · ${points > 0 ? `touching at ${points} ${points === 1 ? "point" : "points"}` : "free"}`;
  if (charts.moment === null && points > 0) pads.feel(force / run.device.max_force_N);
  body.dataset.force = String(force);
  body.dataset.torque = String(torque);
  body.dataset.peakForce = String(samples.peakForce);
  body.dataset.otherForces = (view.picture?.others ?? []).map((other) => Math.hypot(...other.wrench.slice(0, 3))).join(",");
  body.dataset.transparent = (view.bodies?.transparent ?? []).join(",");
  body.dataset.fieldArrows = String(view.field.count);
  body.dataset.grips = view.grips.join(",");
  body.dataset.samples = String(samples.count);
  body.dataset.gaps = String(samples.gaps);
  body.dataset.newest = String(samples.frameOf(samples.count - 1));
  body.dataset.graspedAt = run.grasped >= 0 ? view.onScreen(run.grasped).map(Math.round).join(",") : "";
  if (run.picks) body.dataset.grasped = run.grasped >= 0 ? run.bodies[run.grasped].name : "";
  if (run.picks || run.other_hands.length > 0) {
    body.dataset.bodiesAt = JSON.stringify(Object.fromEntries(run.bodies.flatMap((one, i) => one.moves ? [[one.name, view.onScreen(i).map(Math.round)]] : [])));
  }
  const now = performance.now();
  if (now - lastSpoken > 3000 && document.activeElement === canvas) {
    lastSpoken = now;
    get("spoken").textContent = `${withUnit(force, "N")}, ${points > 0 ? `${points} contact points` : "free"}`;
  }
}

/** The sample whose numbers are shown: on a slow page the newest picture is older than the newest sample. */
function momentShown(): number | null {
  if (!samples || samples.count === 0) return null;
  return charts.moment ?? (newest ? samples.find(newest.index) : samples.count - 1);
}

let lastDrawn = 0;
let lastSummary = 0;
function tick(time: number) {
  requestAnimationFrame(tick);
  if (!run || !samples || samples.count === 0) return;
  // Once cut off nothing moves any more but the view; without a graphics card the loop needs the processors more.
  if (time - lastDrawn < (cutOff ? 250 : view.plain ? 30 : 0)) return;
  lastDrawn = time;
  const past = charts.moment !== null;
  const picture = charts.moment !== null ? samples.picture(samples.frameOf(charts.moment)) : newest;
  const sample = momentShown() ?? 0;
  if (picture && (picture !== view.picture || past)) view.show(picture, !past);
  if (picture) {
    const raw = pressed("raw") ? run.stages.findIndex((stage) => stage.key === "coupling") : -1;
    view.showWrench(samples.wrench(run.stages.length - 1, sample), raw >= 0 ? samples.wrench(raw, sample) : null);
    get("grip-legend").hidden = view.grips.length === 0;
    hand.drawPull(picture);
    timeline.show(picture.index);
  }
  view.draw();
  charts.draw();
  why.update(samples, sample, picture);
  if (time - lastSummary > 100) {
    lastSummary = time;
    showSummary(sample);
  }
}

// ---- what people do

function pressed(id: string) {
  return get(id).getAttribute("aria-pressed") === "true";
}
function toggle(id: string, to = !pressed(id)) {
  get(id).setAttribute("aria-pressed", String(to));
  return to;
}

const answerWithin_ms = 1500;

/** What the page shows of a stop: at once that it was asked for, and what the program confirms when it does. */
function showStopped(how: "asked" | "stopped" | "") {
  stopped = how !== "";
  get("stopped").hidden = !stopped;
  (get("stopped").firstElementChild as HTMLElement).textContent = how === "asked" ? "Stopping …" : "Stopped: no force is shown.";
  get("stop").setAttribute("aria-pressed", String(stopped));
}
function askFor(stop: boolean): boolean {
  if (!connection.send({ do: stop ? "stop" : "resume" })) return false;
  if (asked) window.clearTimeout(asked.timer);
  asked = { stop, timer: window.setTimeout(unanswered, answerWithin_ms) };
  return true;
}
function answered() {
  if (asked) window.clearTimeout(asked.timer);
  asked = null;
}
function unanswered() {
  const stop = asked?.stop;
  answered();
  if (!stop) return;
  showStopped("");
  notice("The program has not confirmed the stop: force may still be shown. Use the stop of the device, or Ctrl-C in the terminal.");
}
function stop() {
  if (!askFor(true)) return notice("The program cannot be reached, so it was not stopped from here.");
  showStopped("asked");
  if (!isTyping(document.activeElement)) get("resume").focus({ preventScroll: true }); // Enter feels again
}
function resume() {
  if (maySteer()) askFor(false);
}
function factsOf(): Facts {
  return {
    scene: run?.scene ?? "", version: run?.version ?? "", device: run ? `${run.device.label}, ${run.device.grip} hand` : "",
    settings: panel.lines(),
  };
}
function savePicture() {
  if (!run || !samples) return;
  const sample = momentShown() ?? 0;
  const [force, torque] = [0, 3].map((half) => samples?.length((run as Run).stages.length - 1, half as 0 | 3, sample) ?? 0);
  const title = `Tactum: ${run.scene}, ${samples.timeOf(sample).toFixed(3)} s, ${new Date().toISOString().slice(0, 16)}Z`;
  const felt = run.grasped < 0 ? "nothing is held" : `on the hand: ${withUnit(force, "N")}, ${withUnit(torque, "N m")}`;
  void view.png(title, [felt]).then((png) => download(`tactum-${run?.scene ?? "scene"}.png`, png));
}
const glassNames: Record<Glass, [string, string]> = { auto: ["Glass: auto", "mixed"], all: ["Glass: all", "true"], none: ["Glass: off", "false"] };
let glass: Glass = "auto";
function nextGlass() {
  glass = ({ auto: "all", all: "none", none: "auto" } as const)[glass];
  const [name, state] = glassNames[glass];
  get("see-through").textContent = name;
  get("see-through").setAttribute("aria-pressed", state);
  view.bodies?.showThrough(glass);
}
function back() {
  charts.moment = null;
  charts.pause(false);
  why.chosen = view.overlay.chosen = -1;
  view.bodies?.markFeature(null);
  get("past").hidden = true;
}
function showHint() {
  const grasped = run && run.grasped >= 0 ? run.bodies[run.grasped].name : "";
  const hinged = run && run.grasped >= 0 && run.bodies[run.grasped].joint === "hinge";
  get("hint").textContent = !run ? ""
    : run.replay ? `A recording, ${run.replay.file}: its frames are computed again. Drag to look around, wheel to zoom; press on a chart to go to that moment.`
    : run.picks && hand.canFeel ? "Press on anything that moves to pick it up, drag it against the others, let go to throw it. Drag beside it to look around."
    : run.grasped < 0 ? "Drag to look around, wheel to zoom. Pieces and Edges colour what the part is made of."
    : !hand.canFeel ? "This device is not led by the mouse: look, or choose a simulated device in the settings."
    : `Drag the orange part (${grasped}) to ${hinged || hand.turns ? "turn" : "move"} it and feel it push back; until you do, a scripted hand moves it.${hand.leadsOthers ? " The other hand is led by dragging its part, here or on a second page." : ""} Drag beside it to look around.`;
}
function reset() {
  if (maySteer()) ask({ do: "reset" });
}
function grasp() {
  hand.setButton(toggle("grasp"));
}
function showKinds(on: boolean) {
  view.bodies?.showKinds(on);
  const counts = edgeKinds.map((_, kind) => shapes.reduce((sum, shape) => sum + shape.edgeKinds.filter((k) => k === kind).length, 0));
  get("legend").hidden = !on;
  get("legend").replaceChildren(...edgeKinds.map(({ name, colour }, kind) => {
    const swatch = make("i", {});
    swatch.style.background = `#${colour.toString(16).padStart(6, "0")}`;
    return make("span", {}, swatch, `${name}: ${counts[kind]}`);
  }));
}
function theme(isDark: boolean) {
  document.documentElement.dataset.theme = isDark ? "dark" : "light";
  view.setTheme(isDark);
  charts.setTheme(isDark);
}

const actions: [string, string, () => void][] = [
  ["stop", "", () => (stopped ? resume() : stop())],
  ["resume", "", resume],
  ["reset", "r", reset],
  ["steer", "", () => ask({ do: "steer" })],
  ["theme", "", () => theme(document.documentElement.dataset.theme !== "dark")],
  ["help-button", "?", () => showHelp(!get<HTMLDialogElement>("help").open)],
  ["pieces", "p", () => view.bodies?.showPieces(toggle("pieces"))],
  ["edges", "e", () => showKinds(toggle("edges"))],
  ["see-through", "x", nextGlass],
  ["arrows-smaller", "-", () => view.scaleArrows(false)],
  ["arrows-larger", "+", () => view.scaleArrows(true)],
  ["trail", "t", () => (view.overlay.showsTrail = toggle("trail"))],
  ["field", "f", () => view.field.show(toggle("field"))],
  ["raw", "w", () => {
    const on = toggle("raw");
    get("raw-legend").hidden = !on;
    charts.showRaw(on);
  }],
  ["record", "v", () => recording.toggle()],
  ["play", "", () => timeline.toggle()],
  ["step-back", ",", () => timeline.step(-1)],
  ["step-on", ".", () => timeline.step(1)],
  ["energy", "n", () => charts.showEnergy(toggle("energy"))],
  ["picture", "", savePicture],
  ["mode", "m", () => { hand.turns = toggle("mode"); showHint(); }],
  ["grasp", "g", grasp],
  ["pause", "c", () => charts.pause(!charts.paused)],
  ["csv", "", () => download(`tactum-${run?.scene ?? "run"}.csv`, new Blob([charts.csv(factsOf())], { type: "text/csv" }))],
  ["charts-png", "", () => void charts.png(factsOf()).then((png) => download(`tactum-${run?.scene ?? "run"}-charts.png`, png))],
  ["live", "l", back],
];
for (const [id, , action] of actions) get(id).addEventListener("click", action);
const views: ViewName[] = ["iso", "front", "side", "top"];
for (const button of document.querySelectorAll<HTMLButtonElement>("[data-view]"))
  button.onclick = () => view.look_from(button.dataset.view as ViewName);

function isTyping(target: EventTarget | null) {
  return target instanceof HTMLInputElement && target.type !== "checkbox" && target.type !== "range";
}
// The space bar stops wherever the focus is: before any button, list or field sees it.
window.addEventListener("keydown", (event) => {
  if (event.code === "Space") {
    event.preventDefault();
    event.stopImmediatePropagation();
    if (event.repeat) return;
    if (timeline.active) timeline.toggle();
    else stop();
    return;
  }
  if (event.ctrlKey || event.metaKey || isTyping(event.target) || event.target instanceof HTMLSelectElement) return;
  const number = Number(event.key);
  if (number >= 1 && number <= views.length) view.look_from(views[number - 1]);
  actions.find(([, key]) => key !== "" && key === event.key.toLowerCase())?.[2]();
}, { capture: true });
window.addEventListener("keyup", (event) => {
  if (event.code === "Space") event.preventDefault();
}, { capture: true });

get<HTMLSelectElement>("scene").onchange = (event) => {
  const choice = event.target as HTMLSelectElement;
  if (maySteer()) ask({ do: "scene", name: choice.value });
  else choice.value = run?.scene ?? "";
};

charts.onPause = (on) => {
  toggle("pause", on);
  get("pause").textContent = on ? "Go on" : "Pause";
  if (!on) get("past").hidden = true;
};
charts.onPick = (sample) => {
  if (!samples) return;
  if (timeline.active) return timeline.seek(samples.frameOf(sample)); // that moment itself, not one beside it
  charts.pause(true);
  charts.moment = sample;
  charts.draw(true);
  get("past").hidden = false;
  const picture = samples.picture(samples.frameOf(sample));
  const off = picture ? Math.abs(picture.index - samples.frameOf(sample)) : 0;
  (get("past").firstElementChild as HTMLElement).textContent = `This was ${samples.timeOf(sample).toFixed(3)} s, frame ${samples.frameOf(sample)}` +
    `${off > 0 ? `; places and contacts are those of frame ${picture?.index}` : ""}.`;
  if (picture) why.update(samples, sample, picture, true);
};
why.onChoose = (contact) => {
  view.overlay.chosen = contact?.patch ?? -1;
  if (!contact || !run) return view.bodies?.markFeature(null);
  const side = contact.bodies[0] === run.grasped ? 1 : 0; // what is touched
  const face = contact.kinds[side] === 2 && contact.features[side] >= 0 ? contact.features[side] : null;
  view.bodies?.markFeature(contact.bodies[side], contact.pieces[side], face);
};

// Tabs, as screen readers know them: arrows go from one to the other.
const tabs = [...document.querySelectorAll<HTMLButtonElement>("[role=tab]")];
function select(tab: HTMLButtonElement) {
  for (const other of tabs) {
    const on = other === tab;
    other.setAttribute("aria-selected", String(on));
    other.tabIndex = on ? 0 : -1;
    get(other.getAttribute("aria-controls") ?? "").hidden = !on;
  }
}
tabs.forEach((tab, i) => {
  tab.onclick = () => select(tab);
  tab.onkeydown = (event) => {
    if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
    const next = tabs[(i + 1) % tabs.length];
    select(next);
    next.focus();
  };
});

const prefersDark = window.matchMedia("(prefers-color-scheme: dark)");
prefersDark.onchange = () => theme(prefersDark.matches);
theme(prefersDark.matches);
body.append(make("p", { id: "spoken", class: "spoken", role: "status", "aria-live": "polite" }));
canvas.addEventListener("focus", () => (lastSpoken = 0));
requestAnimationFrame(tick);
