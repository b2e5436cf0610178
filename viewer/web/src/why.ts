// "Why do I feel this?" for now or for a moment that was picked: which pieces and features push, how much each gives, and
// what every later stage made of it. Stages, channels and flags are those of the run's tables: a new one appears by itself.
import { make } from "./dom";
import type { Contact, Picture, Run } from "./protocol";
import { pushesOf, type Push } from "./pushes";
import type { Samples } from "./samples";
import { withUnit } from "./units";

const kinds = ["vertex", "edge", "face"];
const mostRows = 12;
const mostUnfolded = 100;
const felt_N = 5e-3; // below this nobody feels a push
const grainOfTouch_N = 1e-3; // an answer of the device below this is nothing to explain

/** Name, channel, meaning; the first is the head. */
const energyRows: [string, string, string][] = [
  ["", "", ""],
  ["from the hand", "energy_from_hand_J", "work the hand put in, moving against the wrench"],
  ["to the hand", "energy_to_hand_J", "work the hand was given, moved along by the wrench"],
  ["generated", "energy_generated_J", "energy that came out and that nobody put in"],
  ["paid by the coupling", "energy_paid_J", "of it, what its spring gave up as its stiffness was lowered"],
  ["energy balance now", "port_energy_balance_J", "taken in and not stored; below zero, energy was generated and the coupling pays for it"],
];

const size = (v: number[]) => Math.hypot(v[0], v[1], v[2]);
const dot = (a: number[], b: number[]) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

function direction(v: number[]): string {
  const axes = ["along x", "along y", "upward (z)"];
  const opposite = ["along −x", "along −y", "downward (−z)"];
  const main = [0, 1, 2].sort((a, b) => Math.abs(v[b]) - Math.abs(v[a]))[0];
  return v[main] > 0 ? axes[main] : opposite[main];
}

export class Why {
  /** Of the chosen patch. */
  chosen = -1;
  onChoose: ((contact: Contact | null) => void) | null = null;
  private run: Run | null = null;
  private last = 0;
  private readonly sentence = make("p", { class: "sentence", role: "status", "aria-live": "off" });
  private readonly others = make("ul", { class: "remarks hands" });
  private readonly table = make("table", { class: "contacts" },
    make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "pieces and features"), make("th", { scope: "col" }, "force"),
      make("th", { scope: "col" }, "distance, normal"))), make("tbody"));
  private readonly more = make("button", { class: "plain", title: "Show or fold away what cannot be felt" });
  private unfolded = false;
  private readonly goals = make("ul", { class: "goals" });
  private readonly remarks = make("ul", { class: "remarks" });
  private readonly facts = make("ul", { class: "remarks" });
  private rows: Push[] = [];
  private readonly stages = make("table", { class: "stages" });
  private readonly energy = make("table", { class: "energy" });
  private readonly flags = make("ul", { class: "flags" });
  private readonly numbers = make("dl", { class: "numbers" });

  constructor(root: HTMLElement) {
    const more = make("details", {}, make("summary", {}, "Every number of this frame"), this.numbers);
    this.more.onclick = () => (this.unfolded = !this.unfolded);
    root.append(this.sentence, this.others, this.goals, this.remarks, make("details", { class: "about" }, make("summary", {}, "About this scene"), this.facts), make("h2", {}, "What pushes"), this.table, this.more, make("h2", {}, "From the contact to your hand"), this.stages,
      this.flags, make("h2", {}, "Energy since the start"), this.energy, more);
  }

  begin(run: Run) {
    this.run = run;
    this.chosen = -1;
    this.unfolded = false;
    this.goals.replaceChildren();
    const list = (warning: boolean) => run.remarks.filter((remark) => remark.warning === warning)
      .map(({ text }) => make("li", warning ? { class: "warning" } : {}, `${text[0].toUpperCase()}${text.slice(1)}.`));
    this.remarks.replaceChildren(...list(true));
    this.facts.replaceChildren(...list(false));
  }

  showGoals(goals: { met: boolean; text: string }[]) {
    this.goals.replaceChildren(...goals.map((goal) => make("li", goal.met ? { class: "met" } : {}, `Goal: ${goal.text}`)));
  }

  update(samples: Samples, sample: number, picture: Picture | null, now = false) {
    const time = performance.now();
    if (!this.run || !picture || (!now && time - this.last < 120)) return;
    this.last = time;
    const pushes = pushesOf(picture, this.run.grasped).sort((a, b) => Number(b.onGrasped) - Number(a.onGrasped) || size(b.force) - size(a.force));
    const felt = pushes.filter((push) => push.onGrasped);
    const sum = felt.reduce((total, push) => total.map((v, i) => v + push.force[i]), [0, 0, 0]);
    this.showSentence(samples, sample, felt, sum);
    this.showOthers(picture);
    this.showContacts(pushes, sum, picture);
    this.showStages(samples, sample);
    this.showFlags(samples, sample);
    this.showEnergy(samples, sample);
    this.showNumbers(samples, sample);
  }

  private name(body: number) {
    return this.run?.bodies[body]?.name ?? "?";
  }
  private called(body: number) {
    return `“${this.name(body)}”`;
  }

  private showSentence(samples: Samples, sample: number, felt: Push[], sum: number[]) {
    const run = this.run as Run;
    const shown = run.stages.length - 1;
    const [force, torque] = [samples.length(shown, 0, sample), samples.length(shown, 3, sample)];
    const wrench = `${withUnit(force, "N")} and ${withUnit(torque, "N m")}`;
    const active = felt.filter((push) => size(push.force) > 0);
    const field = this.fieldText(samples, sample);
    let text: string;
    if (run.grasped < 0) text = "Nothing is held, so nothing is felt.";
    else if (active.length === 0) text = `You feel ${wrench}. Nothing ${felt.length === 0 ? "touches" : "pushes"} ${this.called(run.grasped)}${this.otherCauses(samples, sample, force, field)}`;
    else {
      const others = [...new Set(active.map((push) => this.called(push.contact.bodies.find((b) => b !== run.grasped) ?? run.grasped)))];
      text = `You feel ${wrench}: ${this.called(run.grasped)} touches ${others.join(" and ")} in ` +
        `${active.length} ${active.length === 1 ? "place" : "places"}, together they push ${withUnit(size(sum), "N")} ${direction(sum)}${this.shared(size(sum), force)}${field ? `; ${field}` : ""}.`;
    }
    this.sentence.textContent = `${samples.timeOf(sample).toFixed(3)} s. ${text}`;
  }

  /** What the hands after the first feel. */
  private showOthers(picture: Picture) {
    const [one, all] = ["The other hand", (i: number) => `Hand ${i + 2}`];
    this.others.replaceChildren(...picture.others.map(({ body, wrench }, i) =>
      make("li", {}, `${picture.others.length === 1 ? one : all(i)} ${body < 0 ? "holds nothing" : `holds ${this.called(body)}`} ` +
        `and feels ${withUnit(size(wrench), "N")} and ${withUnit(size(wrench.slice(3)), "N m")}.`)));
  }

  /** What acts on the held part beside contacts, as far as there is such a thing. */
  private otherCauses(samples: Samples, sample: number, force: number, field: string): string {
    const run = this.run as Run;
    const body = run.bodies[run.grasped];
    const causes = [
      body.weight_N > 0 && body.joint === "free" && `its weight is ${withUnit(body.weight_N, "N")}`,
      body.joint_acts && `its ${body.joint} pushes by spring, damper, friction or stop`,
      body.load_acts && "its load acts on it",
      field,
    ].filter(Boolean);
    if (causes.length === 0 && force > grainOfTouch_N)
      causes.push(`what is left is the coupling's spring, ${withUnit(samples.at(samples.column("stretch_m"), sample), "m")} long`);
    return causes.length > 0 ? `; ${causes.join("; ")}.` : ".";
  }

  /** Who takes the difference between what pushes the part and what the hand feels. */
  private shared(pushed: number, force: number): string {
    const { joint } = (this.run as Run).bodies[(this.run as Run).grasped];
    return joint !== "free" && Math.abs(pushed - force) > 0.1 * pushed ? `, and its ${joint} carries what the hand does not feel` : "";
  }

  /** What force fields do to the held part; empty where there are none. */
  private fieldText(samples: Samples, sample: number): string {
    const [force, torque] = ["field_N", "field_Nm"].map((key) => samples.at(samples.column(key), sample) || 0);
    return force > 0 || torque > 0 ? `force fields pull it with ${withUnit(force, "N")} and turn it with ${withUnit(torque, "N m")}` : "";
  }

  private feature(contact: Contact, side: 0 | 1): string {
    const run = this.run as Run;
    const many = (run.bodies[contact.bodies[side]]?.pieces ?? 1) > 1;
    const piece = many && contact.pieces[side] >= 0 ? ` piece ${contact.pieces[side]},` : "";
    const kind = contact.features[side] >= 0 ? ` ${kinds[contact.kinds[side]]} ${contact.features[side]}` : "";
    return `${this.name(contact.bodies[side])}:${piece}${kind}`;
  }

  /** Rows stay where they are and change their text: what is being pressed is never replaced under the press. */
  private showContacts(pushes: Push[], sum: number[], picture: Picture) {
    const total = size(sum);
    const worth = pushes.filter((push) => size(push.force) >= felt_N).slice(0, mostRows);
    const shown = this.unfolded ? pushes.slice(0, mostUnfolded) : worth;
    const body = this.table.tBodies[0];
    while (body.rows.length < shown.length) body.append(this.contactRow(body.rows.length));
    this.rows = shown;
    [...body.rows].forEach((row, i) => {
      const push = shown[i];
      row.hidden = !push;
      if (!push) return;
      const share = push.onGrasped && total > 1e-9 ? dot(push.force, sum) / (total * total) : Number.NaN;
      const chosen = push.patch === this.chosen;
      row.classList.toggle("chosen", chosen);
      const [button, force, place] = [...row.cells].map((cell) => cell.firstElementChild as HTMLElement);
      button.setAttribute("aria-pressed", String(chosen));
      this.showGrip(row.cells[0].lastElementChild as HTMLElement, push);
      button.textContent = `${this.feature(push.contact, 0)}\n${this.feature(push.contact, 1)}`;
      force.textContent = push.rests ? "rests\nno force is computed"
        : `${withUnit(size(push.force), "N")}\n${Number.isNaN(share) ? "to others" : `${Math.round(100 * share)} %`.replace("-", "−")}`;
      (row.cells[1].lastElementChild as HTMLElement).style.width = `${Math.round(100 * Math.min(1, Math.max(0, share || 0)))}%`;
      place.textContent = `${withUnit(push.distance, "m")}\n${push.contact.n.map((c) => c.toFixed(2).replace("-", "−")).join(" ")}`;
    });
    const folded = pushes.slice(worth.length);
    const resting = folded.filter((push) => push.rests).length;
    const weak = folded.length - resting + picture.leftOut;
    const parts = [weak > 0 && `${weak} ${weak === 1 ? "contact pushes" : "contacts push"} less than these or ${withUnit(felt_N, "N")}`,
      resting > 0 && `${resting} ${resting === 1 ? "contact" : "contacts"} of bodies at rest`].filter(Boolean);
    this.more.hidden = pushes.length === 0 && picture.leftOut === 0 ? false : parts.length === 0;
    this.more.disabled = folded.length === 0;
    this.more.textContent = pushes.length === 0 ? "no contact" : `${parts.join(", ")}: ${this.unfolded ? "fold away" : "show"}`;
  }

  private contactRow(i: number) {
    const choose = make("button", { class: "plain", title: "Show it in the scene" });
    choose.onclick = () => {
      const push = this.rows[i];
      if (!push) return;
      this.chosen = this.chosen === push.patch ? -1 : push.patch;
      this.onChoose?.(this.chosen < 0 ? null : push.contact);
    };
    return make("tr", {}, make("td", {}, choose, make("span", { class: "grip" })), make("td", { class: "number" }, make("span"), make("span", { class: "bar" })),
      make("td", { class: "number" }, make("span")));
  }

  /** Sticking or slipping, where there is friction. */
  private showGrip(element: HTMLElement, push: Push) {
    element.hidden = push.grip === "none";
    element.classList.toggle("slips", push.grip === "slips");
    element.textContent = `${push.grip}, ${Math.round(100 * push.coneUsed)} % of its friction`;
  }

  private showEnergy(samples: Samples, sample: number) {
    const [head, ...rows] = energyRows.map(([name, key, meaning]) => {
      const value = (suffix: string) => {
        const column = samples.column(key.replace("_J", suffix));
        return column < 0 ? "" : withUnit(samples.at(column, sample), "J"); // the balance is one, of both
      };
      return key === "" ? make("tr", {}, ...["", "moving", "turning"].map((text) => make("th", { scope: "col" }, text)))
        : make("tr", { title: meaning }, make("td", {}, name), make("td", { class: "number" }, value("_J")), make("td", { class: "number" }, value("_turning_J")));
    });
    this.energy.replaceChildren(head, ...rows);
  }

  private showStages(samples: Samples, sample: number) {
    const run = this.run as Run;
    const wrenches = run.stages.map((_stage, i) => samples.wrench(i, sample));
    const most = Math.max(1e-9, ...wrenches.map((w) => size(w)));
    const head = make("tr", {}, make("th", { scope: "col" }, "stage"), make("th", { scope: "col" }, "force"), make("th", { scope: "col" }, "torque"),
      make("th", { scope: "col" }, "changed by"));
    const rows = run.stages.map((stage, i) => {
      const w = wrenches[i];
      const before = i > 0 ? wrenches[i - 1] : null;
      const change = before ? size(w.slice(0, 3).map((v, k) => v - before[k])) : Number.NaN;
      const turn = before ? size(w.slice(3).map((v, k) => v - before[3 + k])) : Number.NaN;
      const bar = make("span", { class: "bar" });
      bar.style.width = `${Math.round((100 * size(w)) / most)}%`;
      return make("tr", { title: stage.meaning },
        make("td", {}, make("strong", {}, stage.name), make("small", {}, stage.meaning), bar),
        make("td", { class: "number" }, withUnit(size(w), "N")),
        make("td", { class: "number" }, withUnit(size(w.slice(3)), "N m")),
        make("td", { class: "number" }, before ? `${withUnit(change, "N")}` : "", before ? make("br") : null, before ? withUnit(turn, "N m") : ""));
    });
    this.stages.replaceChildren(head, ...rows);
  }

  private showFlags(samples: Samples, sample: number) {
    const run = this.run as Run;
    const bits = (key: string) => samples.at(samples.column(key), sample) || 0;
    const on = [
      ...run.flags.safety.filter((flag) => bits("safety_flags") & flag.flag).map((flag) => ({ ...flag, kind: flag.fault ? "fault" : "safety" })),
      ...run.flags.frame.filter((flag) => bits("frame_flags") & flag.flag).map((flag) => ({ ...flag, kind: "frame" })),
    ];
    this.flags.replaceChildren(...on.map((flag) => make("li", { class: flag.kind }, flag.name)));
  }

  private showNumbers(samples: Samples, sample: number) {
    const run = this.run as Run;
    this.numbers.replaceChildren(...run.channels.filter((channel) => channel.group !== "flags").flatMap((channel) => [
      make("dt", { title: channel.meaning }, channel.name),
      make("dd", {}, withUnit(samples.at(samples.column(channel.key), sample), channel.unit)),
    ]));
  }
}
