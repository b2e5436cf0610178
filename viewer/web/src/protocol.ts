// What the program says: one JSON message for what stays in a run, binary messages for what moves. docs/viewer.md draws
// the layouts; everything here follows from the tables that the run's message brings along.

export type Vec = [number, number, number];
export interface Pose { p: Vec; q: [number, number, number, number] } // w, x, y, z

export interface Body {
  name: string; shape: number; moves: boolean; joint: "free" | "fixed" | "hinge" | "slider" | "ball"; pieces: number;
  mass_kg: number; weight_N: number; joint_acts: boolean; load_acts: boolean; radius_m: number; X_WB: Pose; axis_W?: Vec; anchor_W?: Vec;
}
export interface StageInfo { key: string; name: string; meaning: string }
export interface ChannelInfo { key: string; name: string; unit: string; group: string; meaning: string }
export interface Setting {
  section: string; key: string; name: string; unit: string; meaning: string; low: number; high: number;
  kind: "number" | "integer" | "on-off" | "choice"; choices: string[]; live: boolean; unlimited: boolean;
  value: number | null; usual: number | null; // now and as the scene has it; null: no limit
}
export interface Settings {
  settings: Setting[]; margin: string; stability: "always" | "in hand" | "uncertain"; coupling_by_device: boolean; toml: string;
}
export interface Remark { warning: boolean; text: string }
export interface FlagInfo { flag: number; name: string; fault?: boolean }
export interface DeviceFacts {
  name: string; label: string; can_be_led: boolean; senses_rotation: boolean; actuates_force: boolean;
  actuates_torque: boolean; max_force_N: number; max_torque_Nm: number; max_stiffness_N_per_m: number;
  workspace_radius_m: number; grip: string; grips: string[]; choices: { name: string; label: string }[];
}
export interface Run extends Settings {
  type: "run"; run: number; version: string; scene: string; description: string; remarks: Remark[];
  scenes: { name: string; description: string; absent: string[] }[];
  rate_Hz: number; bodies: Body[]; grasped: number; picks: boolean; X_BH: Pose;
  other_hands: { grasped: number; can_be_led: boolean }[]; // those after the first
  device: DeviceFacts; stages: StageInfo[];
  channels: ChannelInfo[]; flags: { safety: FlagInfo[]; frame: FlagInfo[] };
  posed: number[]; // bodies whose poses every sample has, behind its other numbers
  replay?: { file: string; first: number; past: number }; // of a recording: its frames
  field: number[]; // arrows of the force fields, six numbers each: place [m], force [N]
}
export interface Times { mean: number; p50: number; p99: number; p999: number; max: number }
export interface Status {
  type: "status"; pages: number; steering: boolean; somebody_steers: boolean; stop_asked: boolean; samples_lost: number;
  led_elsewhere: number[]; // hands after the first that other pages lead, the first counted as 0
  refused: Record<string, number>;
  program: {
    stopped?: boolean; stop_ramp_s?: number; running?: boolean; device_lost?: boolean; frames?: number;
    missed_deadlines?: number; late_frames?: number; failed_reads?: number; failed_writes?: number;
    samples_dropped?: number; frame_us?: Times; safety?: string; remarks?: string[];
    goals?: { met: boolean; text: string }[];
    recording?: { file: string; frames: number; dropped: number } | null; // the file that is being written
    replay?: { frame: number; speed: number };
  };
}
export type ServerMessage =
  | Run | Status | (Settings & { type: "settings" }) | { type: "notice"; sentence: string };

export interface Contact {
  bodies: [number, number]; pieces: [number, number]; kinds: [number, number]; features: [number, number];
  patch: number; p: Vec; n: Vec; distance: number; tolerance: number; force: number;
  grip: Grip; coneUsed: number; // the share of the friction cone that the surfaces use, 0 to 1
  rests: boolean; // neither body moves: no force is computed between bodies that sleep
}
export const grips = ["none", "sticks", "slips"] as const;
export type Grip = (typeof grips)[number];
/** A hand after the first: where its device would have it, where its handle is, and the wrench that it was sent. */
export interface OtherHand { body: number; hand: Float32Array; proxy: Float32Array; wrench: number[] }
/** Where everything is in one frame. */
export interface Picture {
  index: number; grasped: boolean; body: number; hand: Float32Array; proxy: Float32Array; bodies: Float32Array; // seven numbers a pose
  others: OtherHand[];
  contacts: Contact[]; leftOut: number;
}
/** A message with frames: rows of `numbers` floats behind a frame index each. */
export interface Frames {
  sequence: number; run: number; lost: number; picture: Picture | null; rows: number; numbers: number;
  indices: Uint32Array; values: Float32Array; // the rows as they lie: index, numbers, index, numbers, ...
}

const headerWords = 8;
const contactWords = 21;

function readPicture(words: Int32Array, floats: Float32Array): Picture {
  const bodies = words[2];
  let at = 6;
  const take = (count: number) => floats.slice(at, (at += count));
  const picture: Picture = {
    index: words[0] >>> 0, grasped: words[1] > 0, body: words[1] - 1, hand: take(7), proxy: take(7), bodies: new Float32Array(), others: [], contacts: [],
    leftOut: words[4],
  };
  at += 7; // the device's frame
  for (let i = 0; i < words[5]; ++i) picture.others.push({ body: words[at++], hand: take(7), proxy: take(7), wrench: [...take(6)] });
  picture.bodies = take(7 * bodies);
  for (let i = 0; i < words[3]; ++i, at += contactWords) {
    picture.contacts.push({
      bodies: [words[at], words[at + 1]], pieces: [words[at + 2], words[at + 3]],
      kinds: [words[at + 4], words[at + 6]], features: [words[at + 5], words[at + 7]], patch: words[at + 8],
      p: [floats[at + 9], floats[at + 10], floats[at + 11]], n: [floats[at + 12], floats[at + 13], floats[at + 14]],
      distance: floats[at + 15], tolerance: floats[at + 16], force: floats[at + 17],
      grip: grips[words[at + 18]] ?? "none", coneUsed: floats[at + 19], rests: words[at + 20] === 1,
    });
  }
  return picture;
}

export function readFrames(buffer: ArrayBuffer): Frames {
  const head = new Uint32Array(buffer, 0, headerWords);
  const pictureBytes = head[6];
  const start = headerWords * 4;
  const picture = pictureBytes > 0
    ? readPicture(new Int32Array(buffer, start, pictureBytes / 4), new Float32Array(buffer, start, pictureBytes / 4))
    : null;
  const rest = start + pictureBytes;
  return {
    sequence: head[1], run: head[2], rows: head[3], numbers: head[4], lost: head[5], picture,
    indices: new Uint32Array(buffer, rest), values: new Float32Array(buffer, rest),
  };
}

/** A part's surface; `piece` of each triangle is its flat face where the part is felt by its surface. */
export interface Shape {
  felt_by_surface: boolean;
  vertices: Float32Array; triangles: Uint32Array; piece: Uint32Array; face: Uint32Array; covered: Uint8Array;
  edges: Float32Array; edgeKinds: Uint32Array; // sharp, reflex, open, of more than two triangles
}

export function readShapes(buffer: ArrayBuffer): Shape[] {
  const words = new Uint32Array(buffer);
  const floats = new Float32Array(buffer);
  const shapes: Shape[] = [];
  let at = 1;
  for (let i = 0; i < words[0]; ++i) {
    const [vertexCount, triangleCount, edgeCount] = [words[at], words[at + 1], words[at + 2]];
    const felt_by_surface = words[at + 3] === 1;
    at += 4;
    const vertices = floats.slice(at, (at += 3 * vertexCount));
    const triangles = words.slice(at, (at += 3 * triangleCount));
    const piece = new Uint32Array(triangleCount);
    const face = new Uint32Array(triangleCount);
    const covered = new Uint8Array(triangleCount); // by another piece: inside the part
    for (let t = 0; t < triangleCount; ++t) {
      piece[t] = words[at++];
      covered[t] = words[at] >>> 31;
      face[t] = words[at++] & 0x7fffffff;
    }
    const edges = floats.slice(at, (at += 6 * edgeCount));
    const edgeKinds = words.slice(at, (at += edgeCount));
    shapes.push({ felt_by_surface, vertices, triangles, piece, face, covered, edges, edgeKinds });
  }
  return shapes;
}
