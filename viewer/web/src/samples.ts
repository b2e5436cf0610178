// Every frame's numbers of the last minute, one column each, in a ring; and the pictures that belong to them.
import type { Frames, Picture, Run } from "./protocol";

const room = 1 << 16; // samples: 65 s at 1 kHz
const pictureRoom = 2048; // half a minute at 60 Hz

/** The numbers of a pose and their units. */
export const poseParts = [["px", "m"], ["py", "m"], ["pz", "m"], ["qw", ""], ["qx", ""], ["qy", ""], ["qz", ""]] as const;

export class Samples {
  readonly names: string[] = []; // of the columns: "shown.fx", ..., "stretch_m", ...
  readonly units: string[] = [];
  readonly dt: number;
  count = 0; // samples so far; the newest is number count - 1
  gaps = 0; // frames that are missing between samples
  peakForce = 0; // of the shown force over the run [N]
  private readonly stages: number;
  private readonly jumps: boolean; // a recording: it may go on anywhere
  private readonly columns: Float32Array[] = [];
  private readonly index = new Float64Array(room);
  private pictures: Picture[] = [];
  private nextPicture = 0;

  constructor(run: Run) {
    this.dt = 1 / run.rate_Hz;
    this.stages = run.stages.length;
    this.jumps = run.replay !== undefined;
    for (const stage of run.stages)
      for (const axis of ["fx", "fy", "fz", "tx", "ty", "tz"]) {
        this.names.push(`${stage.key}.${axis}`);
        this.units.push(axis[0] === "f" ? "N" : "N m");
      }
    for (const channel of run.channels) {
      this.names.push(channel.key);
      this.units.push(channel.unit);
    }
    for (const body of run.posed) this.addPose(run.bodies[body].name);
    for (let i = 0; i < this.names.length; ++i) this.columns.push(new Float32Array(room));
  }

  private addPose(body: string) {
    for (const [part, unit] of poseParts) {
      this.names.push(`${body}.${part}`);
      this.units.push(unit);
    }
  }

  take(frames: Frames) {
    const shown = 6 * (this.stages - 1);
    for (let row = 0, at = 0; row < frames.rows; ++row, at += 1 + frames.numbers) {
      const index = frames.indices[at];
      if (this.jumps && this.count > 0 && index !== this.frameOf(this.count - 1) + 1) this.clear();
      const slot = this.count % room;
      if (this.count > 0) {
        const expected = this.index[(this.count - 1) % room] + 1;
        if (index > expected) this.gaps += index - expected;
      }
      this.index[slot] = index;
      for (let i = 0; i < this.columns.length; ++i) this.columns[i][slot] = frames.values[at + 1 + i];
      const v = frames.values;
      const force = Math.hypot(v[at + 1 + shown], v[at + 2 + shown], v[at + 3 + shown]);
      if (force > this.peakForce) this.peakForce = force;
      ++this.count;
    }
    if (!frames.picture) return;
    this.pictures[this.nextPicture] = frames.picture;
    this.nextPicture = (this.nextPicture + 1) % pictureRoom;
  }

  /** Samples are in the order of their frames: what was before a jump is no longer there. */
  private clear() {
    this.count = this.gaps = this.peakForce = this.nextPicture = 0;
    this.pictures = [];
  }

  get oldest() {
    return Math.max(0, this.count - room);
  }
  column(name: string) {
    return this.names.indexOf(name);
  }
  at(column: number, sample: number) {
    return this.columns[column][sample % room];
  }
  frameOf(sample: number) {
    return this.index[sample % room];
  }
  timeOf(sample: number) {
    return this.index[sample % room] * this.dt;
  }
  /** The sample of a frame, or the first behind it. */
  find(frame: number) {
    let low = this.oldest;
    let high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.frameOf(middle) < frame) low = middle + 1;
      else high = middle;
    }
    return Math.min(low, this.count - 1);
  }
  wrench(stage: number, sample: number): number[] {
    return [0, 1, 2, 3, 4, 5].map((i) => this.at(6 * stage + i, sample));
  }
  length(stage: number, half: 0 | 3, sample: number) {
    const i = 6 * stage + half;
    return Math.hypot(this.at(i, sample), this.at(i + 1, sample), this.at(i + 2, sample));
  }
  /** The pictures of the frames from `first` to `last`, by their frame. */
  picturesBetween(first: number, last: number): Map<number, Picture> {
    return new Map(this.pictures.filter((p) => p.index >= first && p.index <= last).map((p) => [p.index, p]));
  }
  /** The picture nearest to a frame. */
  picture(frame: number): Picture | null {
    let best: Picture | null = null;
    for (const picture of this.pictures)
      if (!best || Math.abs(picture.index - frame) < Math.abs(best.index - frame)) best = picture;
    return best;
  }
}
