// The settings, made from the program's own description of them: name, unit, range, meaning. And the device, the health of
// the loop, and what the program has refused.
import { download, get, make } from "./dom";
import type { Run, Setting, Settings, Status } from "./protocol";
import { withUnit } from "./units";

export interface Ask { (message: Record<string, unknown>): void }

const idOf = (setting: Setting) => (setting.section ? `${setting.section}.${setting.key}` : setting.key);
const sections: Record<string, string> = {
  coupling: "Coupling of hand and part", penalty: "Penalty response", shading: "Shading", smoothing: "Smoothing", safety: "Safety: only tighter",
  "": "Response and rate", constraint: "Constraint response", impacts: "Impacts", budget: "Work budget", workspace: "Workspace",
};

/** A value as people read it. */
function wordOf(setting: Setting, value: number | null): string {
  if (value === null) return "the device's own limit";
  if (setting.kind === "on-off") return value ? "on" : "off";
  return setting.kind === "choice" ? setting.choices[value] : `${Number(value.toPrecision(6))} ${setting.unit}`;
}

/** Sliders of wide ranges go by factors, not by steps. */
class Scale {
  private readonly wide: boolean;
  constructor(private readonly s: Setting) {
    this.wide = s.kind !== "on-off" && s.low > 0 && s.high / s.low > 50;
  }
  to(value: number) {
    const { low, high } = this.s;
    return this.wide ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  }
  from(share: number) {
    const { low, high, kind } = this.s;
    const value = this.wide ? low * (high / low) ** share : low + share * (high - low);
    return kind === "integer" ? Math.round(value) : Number(value.toPrecision(3));
  }
}

export class Panel {
  private toml = "";
  private settings: Setting[] = [];
  private typing: HTMLInputElement | null = null; // the field in which somebody types: it is left alone until then
  private scene = "";
  private readonly form = make("form", { class: "settings", autocomplete: "off" });
  private readonly device = make("div", { class: "device" });
  private readonly health = make("dl", { class: "numbers" });
  private readonly refused = make("dl", { class: "numbers" });
  private readonly margin = make("p", { class: "margin", id: "margin", role: "status" });
  private readonly save = make("button", { type: "button", id: "save-toml" }, "Save as TOML");
  private shownFor = "";

  constructor(root: HTMLElement, private readonly ask: Ask) {
    this.save.onclick = () => download(`${this.scene}-settings.toml`, new Blob([this.toml], { type: "application/toml" }));
    this.save.title = "What was changed here, as the table [settings]: behind the scene file, or with tactum feel SCENE --settings FILE";
    this.health.id = "health";
    this.form.onsubmit = (event) => event.preventDefault();
    root.append(make("h2", {}, "Device"), this.device, make("h2", {}, "Response"), this.form, this.save,
      make("h2", {}, "Health"), this.health, make("h2", {}, "Refused by the program"), this.refused);
  }

  begin(run: Run) {
    this.scene = run.scene;
    this.showDevice(run);
    this.showSettings(run);
  }

  private showDevice(run: Run) {
    const { device } = run;
    const choice = make("select", { id: "device", "aria-label": "Device" });
    const known = device.choices.some((c) => c.name === device.name);
    if (!known) choice.append(new Option(device.label, device.name, true, true));
    for (const c of device.choices) choice.append(new Option(c.label, c.name, false, c.name === device.name));
    choice.onchange = () => this.ask({ do: "device", name: choice.value });
    const grip = make("select", { id: "grip", "aria-label": "Grip of the hand" });
    for (const name of device.grips) grip.append(new Option(`${name} grip`, name, false, name === device.grip));
    grip.onchange = () => this.ask({ do: "grip", name: grip.value });
    const can = [
      device.actuates_force ? `force to ${withUnit(device.max_force_N, "N")}` : "no force",
      device.actuates_torque ? `torque to ${withUnit(device.max_torque_Nm, "N m")}` : "no torque: it is shown here only",
      `reach ${withUnit(device.workspace_radius_m, "m")}`,
    ];
    this.device.replaceChildren(choice, grip, make("p", { class: "quiet" }, `${device.label}: ${can.join(", ")}.`,
      device.can_be_led ? "" : " It cannot be led by the mouse."));
  }

  showSettings({ settings, margin, stability, coupling_by_device, toml }: Settings) {
    this.toml = toml;
    this.settings = settings;
    this.save.disabled = toml === "";
    this.save.textContent = toml === "" ? "Nothing is changed" : "Save what is changed as TOML";
    const shape = settings.map(idOf).join();
    if (shape !== this.shownFor) {
      this.shownFor = shape;
      this.build(settings);
    }
    for (const setting of settings) this.fill(setting);
    this.margin.className = `margin ${{ always: "", "in hand": "hand", uncertain: "uncertain" }[stability]}`;
    this.margin.textContent = `${margin}${coupling_by_device ? " It was chosen for this device and rate." : ""}`;
  }

  private build(settings: Setting[]) {
    this.form.replaceChildren();
    for (const section of [...new Set(settings.map((s) => s.section))]) {
      const group = make("fieldset", {}, make("legend", {}, sections[section] ?? section));
      for (const setting of settings.filter((s) => s.section === section)) group.append(this.row(setting));
      if (section === "coupling") group.append(this.margin);
      this.form.append(group);
    }
  }

  private row(setting: Setting): HTMLElement {
    const id = idOf(setting);
    const note = `${setting.meaning}${setting.live ? "" : "; starts the scene again"}`;
    const set = (value: number | null) => this.ask({ do: "set", key: id, value });
    const usual = make("button", { type: "button", class: "usual", id: `usual-${id}`, "aria-label": `${setting.name}: as the scene has it` }, "↺");
    usual.onclick = () => this.ask({ do: "unset", key: id });
    if (setting.kind === "on-off") {
      const box = make("input", { type: "checkbox", id: `set-${id}` });
      box.onchange = () => set(box.checked ? 1 : 0);
      return make("div", { class: "setting", title: note }, make("label", { for: box.id }, setting.name), box, usual, make("small", {}, note));
    }
    if (setting.kind === "choice") {
      const choice = make("select", { id: `set-${id}` });
      setting.choices.forEach((name, value) => choice.append(new Option(name, String(value))));
      choice.onchange = () => set(Number(choice.value));
      return make("div", { class: "setting", title: note }, make("label", { for: choice.id }, setting.name), choice, usual, make("small", {}, note));
    }
    const scale = new Scale(setting);
    const range = `${setting.low} to ${setting.high} ${setting.unit}`;
    const slider = make("input", { type: "range", min: "0", max: "1", step: "0.002", id: `slide-${id}`, "aria-label": `${setting.name}, slider`, tabindex: "-1" });
    const number = make("input", { type: "number", step: "any", min: String(setting.low), max: String(setting.high), id: `set-${id}`,
      "aria-describedby": `note-${id}`, placeholder: setting.unlimited ? "own" : "" });
    if (setting.unlimited) number.title = "Empty: the device's own limit. A limit above that has no effect.";
    slider.oninput = () => (number.value = String(scale.from(Number(slider.value))));
    slider.onchange = () => set(scale.from(Number(slider.value)));
    number.oninput = () => (this.typing = number);
    number.onchange = () => {
      this.typing = null;
      if (number.value !== "") set(Number(number.value));
      else if (setting.unlimited) set(null);
      else this.ask({ do: "unset", key: id });
    };
    number.onblur = () => {
      this.typing = null;
      this.fill(this.settings.find((one) => idOf(one) === id) ?? setting); // what is set, not what was typed
    };
    return make("div", { class: "setting", title: `${note} (${range})` },
      make("label", { for: number.id }, setting.name), number, make("span", { class: "unit" }, setting.unit), usual, slider,
      make("small", { id: `note-${id}` }, `${note} (${range})`));
  }

  private fill(setting: Setting) {
    const id = idOf(setting);
    const field = get<HTMLInputElement>(`set-${id}`);
    const usual = get<HTMLButtonElement>(`usual-${id}`);
    usual.hidden = setting.value === setting.usual;
    usual.title = `Back to ${wordOf(setting, setting.usual)}, as the scene has it`;
    if (setting.kind === "on-off") {
      field.checked = setting.value !== null && setting.value !== 0;
      return;
    }
    if (setting.kind === "choice") {
      field.value = String(setting.value);
      return;
    }
    if (field !== this.typing) field.value = setting.value === null ? "" : String(Number(setting.value.toPrecision(6)));
    const slider = get<HTMLInputElement>(`slide-${id}`);
    slider.value = String(new Scale(setting).to(setting.value ?? setting.high));
  }

  showStatus(status: Status) {
    const p = status.program;
    const rows: [string, string][] = [
      ["Loop", p.device_lost ? "device lost" : p.running ? "running" : "ended"],
      ["Frames", String(p.frames ?? 0)],
      ["Missed deadlines", String(p.missed_deadlines ?? 0)],
      ["Late frames", String(p.late_frames ?? 0)],
      ["Failed reads, writes", `${p.failed_reads ?? 0}, ${p.failed_writes ?? 0}`],
      ["Samples lost on the way", `${(p.samples_dropped ?? 0) + status.samples_lost}`],
      ["Open pages", String(status.pages)],
      ["Safety", p.safety || "nothing acts"],
    ];
    if (p.frame_us) {
      const { mean, p99, p999, max } = p.frame_us;
      rows.push(["Frame: mean", `${mean.toFixed(1)} µs`], ["p99, p99.9", `${p99.toFixed(0)}, ${p999.toFixed(0)} µs`], ["longest", `${max.toFixed(0)} µs`]);
    }
    const list = (entries: [string, string][]) => entries.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]);
    this.health.replaceChildren(...list(rows), ...(p.remarks ?? []).map((remark) => make("p", { class: "quiet" }, remark)));
    const refused = Object.entries(status.refused).filter(([, count]) => count > 0).map(([name, count]): [string, string] => [name, String(count)]);
    this.refused.replaceChildren(...list(refused.length > 0 ? refused : [["requests", "none"]]));
  }

  /** What is set now, a line each. */
  lines(): string[] {
    return this.settings.map((setting) => `${idOf(setting)} = ${setting.value === null ? "device's" : wordOf(setting, setting.value)}`);
  }
}
