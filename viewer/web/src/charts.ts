// Strip charts at full rate: every sample of the window is drawn, none is skipped. Paused, they can be zoomed by dragging,
// and a click picks the moment that the rest of the page then shows.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { make } from "./dom";
import { lines, rawLine } from "./look";
import type { ChannelInfo, Run } from "./protocol";
import type { Samples } from "./samples";
import { axisUnit, withUnit } from "./units";

interface Line { label: string; colour: number; value(samples: Samples, at: number): number }
interface Strip { key: string; title: string; unit: string; lines: Line[]; tail?: boolean; named?: boolean }

const turningEnergy = "energy of turning";
const energies = ["energy", turningEnergy]; // groups of channels
const spans = [0.5, 1, 2, 5, 10, 20, 40]; // [s]
const gapHeight = 26;

/** The smallest value that at least the share `q` of the values do not exceed. */
function quantile(values: ArrayLike<number>, q: number): number {
  const sorted = Float64Array.from(values).filter(Number.isFinite).sort();
  return sorted.length === 0 ? Number.NaN : sorted[Math.max(0, Math.ceil(q * sorted.length) - 1)];
}

function wrenchStrip(stage: number, half: 0 | 3, title: string, unit: string): Strip {
  const axis = (i: number) => (samples: Samples, at: number) => samples.at(6 * stage + half + i, at);
  return {
    key: title, title, unit,
    lines: [
      ...["x", "y", "z"].map((label, i) => ({ label, colour: i, value: axis(i) })),
      { label: "size", colour: 3, value: (samples: Samples, at: number) => samples.length(stage, half, at) },
    ],
  };
}

/** What was computed and what was sent, as two curves. */
function rawStrip(raw: number, shown: number, half: 0 | 3, title: string, unit: string): Strip {
  const size = (stage: number) => (samples: Samples, at: number) => samples.length(stage, half, at);
  return {
    key: title, title, unit, named: true,
    lines: [{ label: "raw", colour: rawLine, value: size(raw) }, { label: "shown", colour: 3, value: size(shown) }],
  };
}

function channelStrip(channels: ChannelInfo[], group: string, samples: Samples): Strip {
  const members = channels.filter((channel) => channel.group === group);
  const names: Record<string, string> =
    { stretch: "Stretch", frame: "Frame", contacts: "Contacts", energy: "Energy", [turningEnergy]: "Energy of turning" };
  return {
    key: group, title: names[group] ?? members.map((m) => m.name)[0], unit: members[0].unit, tail: group === "frame",
    named: energies.includes(group),
    lines: members.map((channel, i) => {
      const column = samples.column(channel.key);
      return { label: members.length > 1 ? channel.name.replace(/, turning$/, "") : "", colour: members.length > 1 ? i : 3, value: (s, at) => s.at(column, at) };
    }),
  };
}

export class Charts {
  paused = false;
  /** The moment that was picked: a sample's number. */
  moment: number | null = null;
  onPick: ((sample: number) => void) | null = null;
  private samples: Samples | null = null;
  private strips: { strip: Strip; plot: uPlot; box: HTMLElement; note: HTMLElement; factor: number }[] = [];
  private all: Strip[] = [];
  private span = 5;
  private from = 0; // of a paused window: samples
  private to = 0;
  private isDark = true;
  private lastDrawn = 0;
  private cost_ms = 0; // of drawing once: a slow machine draws less often

  constructor(private readonly root: HTMLElement, spanChoice: HTMLSelectElement,
    private readonly alsoChoice: HTMLSelectElement, private readonly cursor: HTMLElement) {
    for (const s of spans) spanChoice.append(new Option(`${s} s`, String(s), s === 5, s === 5));
    spanChoice.onchange = () => {
      this.span = Number(spanChoice.value);
      if (this.paused) this.window(this.to - this.span / (this.samples?.dt ?? 1), this.to);
    };
    alsoChoice.onchange = () => this.build();
    new ResizeObserver(() => this.resize()).observe(root);
  }

  begin(run: Run, samples: Samples) {
    this.samples = samples;
    this.paused = false;
    this.moment = null;
    const shown = run.stages.length - 1;
    this.all = [wrenchStrip(shown, 0, "Force", "N"), wrenchStrip(shown, 3, "Torque", "N m")];
    const groups = [...new Set(run.channels.map((channel) => channel.group))];
    for (const group of ["stretch", "frame", "contacts"].filter((g) => groups.includes(g)))
      this.all.push(channelStrip(run.channels, group, samples));
    const before = this.alsoChoice.value;
    this.alsoChoice.replaceChildren(new Option("–", ""));
    run.stages.slice(0, -1).forEach((stage, i) => {
      this.alsoChoice.append(new Option(`Force: ${stage.name}`, `f${i}`), new Option(`Torque: ${stage.name}`, `t${i}`));
    });
    for (const group of groups.filter((g) => !this.all.some((strip) => strip.key === g)))
      this.alsoChoice.append(new Option(run.channels.filter((c) => c.group === group).map((c) => c.name).join(", "), `c${group}`));
    this.alsoChoice.value = before;
    if (this.alsoChoice.selectedIndex < 0) this.alsoChoice.value = "";
    this.run = run;
    this.build();
  }
  private run: Run | null = null;

  private showsRaw = false;
  private showsEnergy = false;

  /** The force and torque charts then have the raw wrench beside the shown one, instead of the axes. */
  showRaw(on: boolean) {
    this.showsRaw = on;
    this.build();
  }
  showEnergy(on: boolean) {
    this.showsEnergy = on;
    this.build();
  }

  private chosen(): Strip[] {
    const { run, samples } = this;
    if (!run || !samples) return this.all;
    const strips = [...this.all];
    const raw = run.stages.findIndex((stage) => stage.key === "coupling");
    const shown = run.stages.length - 1;
    if (this.showsRaw && raw >= 0)
      strips.splice(0, 2, rawStrip(raw, shown, 0, "Force", "N"), rawStrip(raw, shown, 3, "Torque", "N m"));
    const also = this.alsoChoice.value;
    const title = this.alsoChoice.selectedOptions[0]?.text ?? "";
    if (also[0] === "c") strips.push(channelStrip(run.channels, also.slice(1), samples));
    else if (also) strips.push(wrenchStrip(Number(also.slice(1)), also[0] === "f" ? 0 : 3, title, also[0] === "f" ? "N" : "N m"));
    const energy = this.showsEnergy ? energies.filter((group) => also !== `c${group}`) : [];
    return [...energy.map((group) => channelStrip(run.channels, group, samples)), ...strips];
  }

  setTheme(isDark: boolean) {
    this.isDark = isDark;
    if (this.samples) this.build();
  }

  private build() {
    for (const { plot } of this.strips) plot.destroy();
    this.root.replaceChildren();
    this.strips = this.chosen().map((strip) => this.make(strip));
    this.resize();
    this.draw(true);
  }

  private make(strip: Strip) {
    const box = document.createElement("figure");
    const title = document.createElement("figcaption");
    const note = document.createElement("output");
    title.append(strip.title, note);
    box.append(title);
    this.root.append(box);
    const palette = this.isDark ? lines.dark : lines.light;
    if (strip.named) box.append(make("div", { class: "key" }, ...strip.lines.map((line) => {
      const name = make("span", {}, line.label);
      name.style.color = palette[line.colour % palette.length];
      return name;
    })));
    const ink = this.isDark ? "#9fb0bf" : "#4a5a68";
    const rule = { stroke: this.isDark ? "#26323d" : "#d5dde4", width: 1 };
    const entry = { strip, box, note, factor: 1, plot: null as unknown as uPlot };
    entry.plot = new uPlot(
      {
        width: 300, height: 100, legend: { show: false }, pxAlign: false,
        cursor: { sync: { key: "strips" }, drag: { x: true, y: false }, points: { show: false } },
        scales: { x: { time: false }, y: { range: (_plot, low, high) => this.range(low, high) } },
        axes: [
          { stroke: ink, grid: rule, ticks: rule, size: gapHeight, font: "11px system-ui", values: (_p, v) => v.map((s) => `${Number(s.toFixed(3))} s`) },
          { stroke: ink, grid: rule, ticks: rule, size: 46, font: "11px system-ui", space: 26,
            values: (_p, v) => v.map((y) => String(Number((y * entry.factor).toPrecision(4)))) },
        ],
        series: [{}, ...strip.lines.map((line) => ({
          label: line.label, stroke: palette[line.colour % palette.length], width: line.colour === 3 ? 1.6 : 1.1, points: { show: false },
        }))],
        hooks: {
          setCursor: [(plot) => this.moved(plot, entry.strip)],
          setSelect: [(plot) => this.zoom(plot)],
          draw: [(plot) => this.drawMoment(plot)],
        },
      },
      [[], ...strip.lines.map(() => [])] as unknown as uPlot.AlignedData, box);
    entry.plot.over.addEventListener("click", () => {
      const sample = this.from + (entry.plot.cursor.idx ?? -1);
      if (entry.plot.cursor.idx != null && entry.plot.select.width < 3) this.onPick?.(sample);
    });
    return entry;
  }

  /** Room above and below, and never so narrow that rounding is drawn as a signal. */
  private range(low: number | null, high: number | null): [number, number] {
    if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
    if (low === 0 && high === 0) return [-0.05, 1];
    const span = Math.max(high - low, 0.02 * Math.max(Math.abs(low), Math.abs(high)), 1e-9);
    return [low - 0.08 * span, high + 0.08 * span];
  }

  private drawMoment(plot: uPlot) {
    if (this.moment === null || !this.samples) return;
    const x = plot.valToPos(this.samples.timeOf(this.moment), "x", true);
    const { ctx, bbox } = plot;
    if (x < bbox.left || x > bbox.left + bbox.width) return;
    ctx.save();
    ctx.strokeStyle = this.isDark ? "#f0e442" : "#8a7a00";
    ctx.lineWidth = 1.5 * devicePixelRatio;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.restore();
  }

  private moved(plot: uPlot, strip: Strip) {
    const index = plot.cursor.idx;
    if (index == null || !this.samples || plot.cursor.event == null) return;
    const sample = this.from + index;
    const values = strip.lines.map((line) => `${line.label} ${withUnit(line.value(this.samples as Samples, sample), strip.unit)}`);
    this.cursor.textContent = `${this.samples.timeOf(sample).toFixed(3)} s: ${values.join(", ")}`;
  }

  private zoom(plot: uPlot) {
    if (!this.samples || plot.select.width < 8) return;
    const left = plot.posToVal(plot.select.left, "x");
    const right = plot.posToVal(plot.select.left + plot.select.width, "x");
    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.pause(true);
    this.window(this.samples.find(left / this.samples.dt), this.samples.find(right / this.samples.dt));
  }

  pause(on: boolean) {
    if (on === this.paused) return;
    this.paused = on;
    if (!on) this.moment = null;
    this.onPause?.(on);
    this.draw(true);
  }
  onPause: ((on: boolean) => void) | null = null;

  private window(from: number, to: number) {
    if (!this.samples) return;
    this.to = Math.min(this.samples.count, Math.round(to));
    this.from = Math.max(this.samples.oldest, Math.min(this.to - 4, Math.round(from)));
    this.draw(true);
  }

  /** Shows the newest, unless paused; twenty times a second is all an eye follows. */
  draw(now = false) {
    const samples = this.samples;
    if (!samples || samples.count === 0) return;
    const time = performance.now();
    if (!now && (this.paused || time - this.lastDrawn < Math.max(50, 4 * this.cost_ms))) return;
    this.lastDrawn = time;
    if (!this.paused) {
      this.to = samples.count;
      this.from = Math.max(samples.oldest, this.to - Math.round(this.span / samples.dt));
    }
    const count = this.to - this.from;
    const times = new Float64Array(count);
    for (let i = 0; i < count; ++i) times[i] = samples.timeOf(this.from + i);
    for (const entry of this.strips) {
      const { strip, plot, note } = entry;
      const data = strip.lines.map((line) => {
        const values = new Float64Array(count);
        for (let i = 0; i < count; ++i) values[i] = line.value(samples, this.from + i);
        return values;
      });
      const largest = data.reduce((most, values) => values.reduce((m, v) => (Math.abs(v) > m ? Math.abs(v) : m), most), 0);
      const [factor, unit] = axisUnit(largest, strip.unit);
      entry.factor = factor;
      plot.setData([times, ...data] as unknown as uPlot.AlignedData);
      const last = data[data.length - 1][count - 1];
      note.textContent = strip.tail ? ` ${unit} · p99.9 ${withUnit(quantile(data[0], 0.999), strip.unit)}`
        : ` ${unit} · ${withUnit(last, strip.unit)}`;
    }
    this.cost_ms = performance.now() - time;
  }

  private resize() {
    const wide = this.root.clientWidth;
    const count = Math.max(1, this.strips.length);
    const columns = Math.max(1, Math.min(count, Math.floor(wide / 168)));
    const rows = Math.ceil(count / columns);
    this.root.style.setProperty("--columns", String(columns));
    const height = Math.max(118, Math.floor(this.root.clientHeight / rows) - 20);
    for (const { plot, box } of this.strips) {
      const key = box.querySelector<HTMLElement>(".key")?.offsetHeight ?? 0;
      plot.setSize({ width: Math.max(120, box.clientWidth), height: Math.max(100, height - key) });
    }
  }

  /** The samples in the window, every number, as text that reads back to the same values. */
  csv(): string {
    const samples = this.samples;
    if (!samples) return "";
    const heads = samples.names.map((name, i) => (samples.units[i] ? `${name} [${samples.units[i]}]` : name));
    const rows = [["frame", "time [s]", ...heads].join(",")];
    for (let i = this.from; i < this.to; ++i) {
      const values = samples.names.map((_name, column) => {
        const value = samples.at(column, i);
        return Number.isNaN(value) ? "" : String(Number(value.toPrecision(9)));
      });
      rows.push([samples.frameOf(i), Number(samples.timeOf(i).toFixed(9)), ...values].join(","));
    }
    return `${rows.join("\n")}\n`;
  }

  /** All strips on one picture, with their titles. */
  async png(): Promise<Blob> {
    const plots = this.strips.map((s) => s.plot.ctx.canvas);
    const ratio = devicePixelRatio;
    const width = Math.max(...plots.map((p) => p.width));
    const title = 22 * ratio;
    const sheet = document.createElement("canvas");
    sheet.width = width;
    sheet.height = plots.reduce((sum, p) => sum + p.height + title, 0);
    const ctx = sheet.getContext("2d") as CanvasRenderingContext2D;
    ctx.fillStyle = this.isDark ? "#151d26" : "#ffffff";
    ctx.fillRect(0, 0, sheet.width, sheet.height);
    ctx.fillStyle = this.isDark ? "#e8eef4" : "#1a242d";
    ctx.font = `600 ${13 * ratio}px system-ui`;
    let top = 0;
    this.strips.forEach(({ strip, note }, i) => {
      ctx.fillText(`${strip.title}${note.textContent ?? ""}`, 8 * ratio, top + 15 * ratio);
      const palette = this.isDark ? lines.dark : lines.light;
      let right = width - 8 * ratio;
      for (const line of strip.named ? [...strip.lines].reverse() : []) {
        right -= ctx.measureText(line.label).width + 8 * ratio;
        ctx.save();
        ctx.fillStyle = palette[line.colour % palette.length];
        ctx.fillText(line.label, right, top + 15 * ratio);
        ctx.restore();
      }
      ctx.drawImage(plots[i], 0, top + title);
      top += plots[i].height + title;
    });
    return await new Promise((resolve, reject) => sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("no picture"))), "image/png"));
  }
}
