// Strip charts at full rate: every sample of the window is drawn, none is skipped. Paused, they can be zoomed by dragging,
// and a click picks the moment that the rest of the page then shows.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { make } from "./dom";
import { lines, rawLine } from "./look";
import type { ChannelInfo, Run } from "./protocol";
import type { Samples } from "./samples";
import { csvOf, type Facts } from "./table";
import { axisUnit, withUnit } from "./units";

interface Line { label: string; colour: number; value(samples: Samples, at: number): number }
interface Strip { key: string; title: string; unit: string; lines: Line[]; tail?: boolean }

const turningEnergy = "energy of turning";
const energies = ["energy", turningEnergy]; // groups of channels
const spans = [0.5, 1, 2, 5, 10, 20, 40]; // [s]
const gapHeight = 26;
const leastSpan: Record<string, number> = { N: 1e-3, "N m": 1e-5, m: 1e-7 }; // what nobody feels is drawn flat
const [sheetWidth, sheetStrip, sheetMargin] = [1200, 240, 18]; // of the charts as a picture [px]

/** A number of three digits whose unit stands at the axis. */
function inAxisUnits(value: number): string {
  if (Number.isNaN(value)) return "–";
  return (Math.abs(value) < 0.0005 ? "0" : String(Number(value.toPrecision(3)))).replace("-", "−");
}

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
    key: title, title, unit,
    lines: [{ label: "raw", colour: rawLine, value: size(raw) }, { label: "shown", colour: 3, value: size(shown) }],
  };
}

function channelStrip(channels: ChannelInfo[], group: string, samples: Samples): Strip {
  const members = channels.filter((channel) => channel.group === group);
  const names: Record<string, string> =
    { stretch: "Stretch", frame: "Frame", contacts: "Contacts", energy: "Energy", [turningEnergy]: "Energy of turning" };
  return {
    key: group, title: names[group] ?? members.map((m) => m.name)[0], unit: members[0].unit, tail: group === "frame",
    lines: members.map((channel, i) => {
      const column = samples.column(channel.key);
      return { label: channel.name.replace(/, turning$/, ""), colour: members.length > 1 ? i : 3, value: (s, at) => s.at(column, at) };
    }),
  };
}

interface DrawnStrip { strip: Strip; plot: uPlot; box: HTMLElement; note: HTMLElement; values: HTMLElement[]; factor: number }

export class Charts {
  paused = false;
  /** The moment that was picked: a sample's number. */
  moment: number | null = null;
  onPick: ((sample: number) => void) | null = null;
  private samples: Samples | null = null;
  private strips: DrawnStrip[] = [];
  private hovered: number | null = null; // the sample under the pointer
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
    this.hovered = null;
    for (const { plot } of this.strips) plot.destroy();
    this.root.replaceChildren();
    this.strips = this.chosen().map((strip) => this.make(strip));
    this.resize();
    this.draw(true);
  }

  private colourOf(line: Line): string {
    const palette = this.isDark ? lines.dark : lines.light;
    return palette[line.colour % palette.length];
  }

  /** A plot that shows the strip of the page's window, or for export a still one. */
  private plotOf(entry: { strip: Strip; factor: number }, box: HTMLElement, size: { width: number; height: number }, still = false): uPlot {
    const { strip } = entry;
    const ink = this.isDark ? "#9fb0bf" : "#4a5a68";
    const rule = { stroke: this.isDark ? "#26323d" : "#d5dde4", width: 1 };
    return new uPlot(
      {
        ...size, legend: { show: false }, pxAlign: false,
        cursor: still ? { show: false } : { sync: { key: "strips" }, drag: { x: true, y: false }, points: { show: false } },
        scales: { x: { time: false }, y: { range: (_plot, low, high) => this.range(low, high, strip.unit) } },
        axes: [
          { stroke: ink, grid: rule, ticks: rule, size: gapHeight, font: "11px system-ui", values: (_p, v) => v.map((s) => `${Number(s.toFixed(3))} s`) },
          { stroke: ink, grid: rule, ticks: rule, size: still ? 62 : 46, font: "11px system-ui", space: 26,
            values: (_p, v) => v.map((y) => String(Number((y * entry.factor).toPrecision(4)))) },
        ],
        series: [{}, ...strip.lines.map((line) => ({
          label: line.label, stroke: this.colourOf(line), width: line.colour === 3 ? 1.6 : 1.1, points: { show: false },
        }))],
        hooks: still ? {} : {
          setCursor: [(plot) => this.moved(plot)],
          setSelect: [(plot) => this.zoom(plot)],
          draw: [(plot) => this.drawMoment(plot)],
        },
      },
      [[], ...strip.lines.map(() => [])] as unknown as uPlot.AlignedData, box);
  }

  private make(strip: Strip) {
    const box = document.createElement("figure");
    const title = document.createElement("figcaption");
    const note = document.createElement("output");
    title.append(strip.title, note);
    box.append(title);
    this.root.append(box);
    const values = strip.lines.map(() => make("b"));
    const long = strip.lines.some((line) => line.label.length > 8);
    box.append(make("div", { class: long ? "key long" : "key" }, ...strip.lines.map((line, i) => {
      const name = make("i", {}, line.label);
      name.style.color = this.colourOf(line);
      return make("span", { title: line.label }, name, values[i]);
    })));
    const entry: DrawnStrip = { strip, box, note, values, factor: 1, plot: null as unknown as uPlot };
    entry.plot = this.plotOf(entry, box, { width: 300, height: 100 });
    entry.plot.over.addEventListener("click", () => {
      const sample = this.from + (entry.plot.cursor.idx ?? -1);
      if (entry.plot.cursor.idx != null && entry.plot.select.width < 3) this.onPick?.(sample);
    });
    return entry;
  }

  /** Room above and below, and never so narrow that rounding is drawn as a signal. */
  private range(low: number | null, high: number | null, unit: string): [number, number] {
    if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
    if (low === 0 && high === 0) return [-0.05, 1];
    const span = Math.max(high - low, 0.02 * Math.max(Math.abs(low), Math.abs(high)), leastSpan[unit] ?? 1e-9);
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

  /** The values beside the names of the curves are those under the pointer while there is one. */
  private moved(plot: uPlot) {
    if (plot.cursor.event == null) return; // moved along with another chart
    this.hovered = plot.cursor.idx == null ? null : this.from + plot.cursor.idx;
    this.showValues();
  }

  private showValues() {
    const { samples } = this;
    if (!samples || samples.count === 0) return;
    const sample = this.hovered ?? this.moment ?? this.to - 1;
    for (const { strip, values, factor } of this.strips)
      strip.lines.forEach((line, i) => (values[i].textContent = inAxisUnits(line.value(samples, sample) * factor)));
    this.cursor.textContent = `at ${samples.timeOf(sample).toFixed(3)} s`;
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
    for (const entry of this.strips) this.fill(entry, entry.note);
    this.showValues();
    this.cost_ms = performance.now() - time;
  }

  /** Puts the window's samples on a plot, and the unit of its axis beside its title. */
  private fill(entry: { strip: Strip; plot: uPlot; factor: number }, note: HTMLElement | null) {
    const samples = this.samples as Samples;
    const { strip, plot } = entry;
    const count = this.to - this.from;
    const times = new Float64Array(count);
    for (let i = 0; i < count; ++i) times[i] = samples.timeOf(this.from + i);
    const data = strip.lines.map((line) => {
      const values = new Float64Array(count);
      for (let i = 0; i < count; ++i) values[i] = line.value(samples, this.from + i);
      return values;
    });
    const largest = data.reduce((most, values) => values.reduce((m, v) => (Math.abs(v) > m ? Math.abs(v) : m), most), 0);
    const [factor, unit] = axisUnit(largest, strip.unit);
    entry.factor = factor;
    plot.setData([times, ...data] as unknown as uPlot.AlignedData);
    const tail = strip.tail ? ` computing p99.9 ${withUnit(quantile(data[0], 0.999), strip.unit)}` : "";
    const text = `${unit ? ` [${unit}]` : ""}${tail}`;
    if (note) note.textContent = text;
    return text;
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

  /** A window that was held for minutes loses what newer samples have taken the place of. */
  private keepWhatIsThere() {
    const oldest = this.samples?.oldest ?? 0;
    if (this.from < oldest) this.window(oldest, Math.max(this.to, oldest + 4));
  }

  /** The window as a table. */
  csv(facts: Facts): string {
    this.keepWhatIsThere();
    return this.run && this.samples ? csvOf(this.run, this.samples, this.from, this.to, facts) : "";
  }

  /** All charts of the window on one sheet, with titles, units and names. */
  async png(facts: Facts): Promise<Blob> {
    this.keepWhatIsThere();
    const samples = this.samples as Samples;
    const ratio = devicePixelRatio;
    const bench = make("div", { class: "spoken" }); // where plots are made that nobody sees
    document.body.append(bench);
    const drawn = this.strips.map(({ strip }) => {
      const entry = { strip, factor: 1, plot: null as unknown as uPlot };
      entry.plot = this.plotOf(entry, bench, { width: sheetWidth - 2 * sheetMargin, height: sheetStrip }, true);
      return { ...entry, note: this.fill(entry, null), entry };
    });
    for (const { entry } of drawn) entry.plot.redraw(false); // with the axes' factors, which are known by now
    await new Promise((resolve) => setTimeout(resolve, 60));
    const [head, title] = [52, 26];
    const sheet = document.createElement("canvas");
    sheet.width = sheetWidth * ratio;
    sheet.height = (head + drawn.length * (sheetStrip + title) + sheetMargin) * ratio;
    const ctx = sheet.getContext("2d") as CanvasRenderingContext2D;
    ctx.scale(ratio, ratio);
    ctx.fillStyle = this.isDark ? "#151d26" : "#ffffff";
    ctx.fillRect(0, 0, sheet.width, sheet.height);
    const ink = this.isDark ? "#e8eef4" : "#1a242d";
    const write = (text: string, x: number, y: number, font: string, colour = ink) => {
      [ctx.font, ctx.fillStyle] = [font, colour];
      ctx.fillText(text, x, y);
      return ctx.measureText(text).width;
    };
    write(`Tactum: ${facts.scene}`, sheetMargin, 26, "600 17px system-ui");
    write(`${facts.device}, ${samples.timeOf(this.from).toFixed(3)} to ${samples.timeOf(this.to - 1).toFixed(3)} s, ${new Date().toISOString().slice(0, 16)}Z`,
      sheetMargin, 45, "12px system-ui");
    drawn.forEach(({ strip, note, plot }, i) => {
      const top = head + i * (sheetStrip + title);
      let x = sheetMargin + write(`${strip.title}${note}`, sheetMargin, top + 19, "600 14px system-ui") + 24;
      for (const line of strip.lines) {
        ctx.fillStyle = this.colourOf(line);
        ctx.fillRect(x, top + 13, 18, 3);
        x += 24 + write(line.label, x + 24, top + 19, "13px system-ui") + 16;
      }
      ctx.drawImage(plot.ctx.canvas, sheetMargin, top + title, sheetWidth - 2 * sheetMargin, sheetStrip);
      plot.destroy();
    });
    bench.remove();
    return await new Promise((resolve, reject) => sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("no picture"))), "image/png"));
  }
}
