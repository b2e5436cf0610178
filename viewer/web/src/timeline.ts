// The time line of a recording: play, slow down, go to any frame, and one by one.
import { get } from "./dom";
import type { Run, Status } from "./protocol";

const speeds: [number, string][] = [[0.01, "1/100"], [0.02, "1/50"], [0.05, "1/20"], [0.1, "1/10"], [0.25, "1/4"], [0.5, "1/2"], [1, "1"], [2, "2"], [4, "4"]];
const between_ms = 40; // moments are asked for this often at most while the line is dragged
const lost_ms = 400; // a moment that is not there by then is asked for again: who steers may not have been known yet

export class Timeline {
  private replay: Run["replay"] = undefined;
  private dt = 0.001;
  private frame = 0; // that is shown
  private wanted: number | null = null; // that was asked for and is not there yet
  private asked = 0; // when that was [ms]
  private playing = false;
  private readonly line = get<HTMLInputElement>("scrub");
  private readonly speed = get<HTMLSelectElement>("speed");

  constructor(private readonly ask: (message: Record<string, unknown>) => void) {
    this.speed.replaceChildren(...speeds.map(([value, name]) => new Option(`× ${name}`, String(value), value === 1, value === 1)));
    this.speed.onchange = () => {
      if (this.playing) this.play(true);
    };
    this.line.oninput = () => this.seek(Number(this.line.value));
  }

  get active() {
    return this.replay !== undefined;
  }

  begin(run: Run) {
    this.replay = run.replay;
    this.dt = 1 / run.rate_Hz;
    get("timeline").hidden = !run.replay;
    if (!run.replay) return;
    this.line.min = String(run.replay.first);
    this.line.max = String(run.replay.past - 1);
    this.show(run.replay.first);
  }

  toggle() {
    this.play(!this.playing);
  }
  step(frames: number) {
    this.seek((this.wanted ?? this.frame) + frames);
  }
  /** Stands still at a frame: as it is computed, with every contact. */
  seek(frame: number) {
    if (!this.replay) return;
    if (this.playing) this.play(false);
    this.wanted = Math.min(Math.max(frame, this.replay.first), this.replay.past - 1);
    this.line.value = String(this.wanted);
    const now = performance.now();
    const wait = this.asked + between_ms - now;
    if (wait <= 0) this.send();
    else window.setTimeout(() => {
      if (performance.now() - this.asked >= between_ms - 1) this.send();
    }, wait);
  }
  private send() {
    if (this.wanted === null) return;
    this.asked = performance.now();
    this.ask({ do: "seek", frame: this.wanted });
  }

  private play(on: boolean) {
    this.wanted = null;
    this.ask({ do: "play", value: on ? Number(this.speed.value) : 0 });
    this.setPlaying(on);
  }
  private setPlaying(on: boolean) {
    this.playing = on;
    const button = get("play");
    button.textContent = on ? "Pause" : "Play";
    button.setAttribute("aria-pressed", String(on));
  }

  showStatus(status: Status) {
    const replay = status.program.replay;
    if (replay) this.setPlaying(replay.speed > 0);
    if (this.wanted !== null && performance.now() - this.asked > lost_ms) this.send();
  }
  /** The frame that is drawn now. */
  show(frame: number) {
    if (!this.replay) return;
    this.frame = frame;
    if (this.wanted === frame) this.wanted = null;
    if (this.wanted === null) this.line.value = String(frame);
    const end = this.replay.past - 1;
    get("moment").textContent = `frame ${frame} of ${end} · ${(frame * this.dt).toFixed(3)} s`;
    this.line.setAttribute("aria-valuetext", `${(frame * this.dt).toFixed(3)} seconds`);
  }
}
