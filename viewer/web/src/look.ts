// Colours of the scene, for light and dark. Held, touched and force differ in lightness as well as in hue (after Okabe
// and Ito), so that people who tell few hues apart tell these apart.
export interface Look {
  sky: number; grid: number; grasped: number; others: number[]; fixed: number; edge: number; edgeOpacity: number;
  ghost: number; stretch: number; force: number; torque: number; contact: number; trail: number; chosen: number;
  raw: number; sticks: number; slips: number;
}

export const dark: Look = {
  sky: 0x151d26, grid: 0x3f5162, grasped: 0xe8a33d, others: [0x7fa6c4, 0x6fb8a0, 0xb59ac2, 0xa9b47a],
  fixed: 0x8593a1, edge: 0x05080b, edgeOpacity: 0.55, ghost: 0x7cc7f0, stretch: 0xf0e442, force: 0xff6a2b,
  torque: 0xe08bc0, contact: 0xffffff, trail: 0x7cc7f0, chosen: 0xf0e442,
  raw: 0xb79bff, sticks: 0x3fc79a, slips: 0xffd24d,
};

export const light: Look = {
  sky: 0xeaeff4, grid: 0x9fb0bf, grasped: 0xe0912a, others: [0x5f8fb4, 0x4d9f88, 0x9a7bab, 0x8c9a55],
  fixed: 0x9aa6b1, edge: 0x1a242d, edgeOpacity: 0.6, ghost: 0x0072b2, stretch: 0x8a7a00, force: 0xc43c00,
  torque: 0xa8327f, contact: 0x101820, trail: 0x0072b2, chosen: 0x8a7a00,
  raw: 0x6a3fb5, sticks: 0x00805c, slips: 0x9a6a00,
};

/** Colours and names of the kinds of edges, as the program numbers them. */
export const edgeKinds: readonly { name: string; colour: number }[] = [
  { name: "sharp", colour: 0xb9c4cf }, { name: "reflex", colour: 0x56b4e9 }, { name: "open", colour: 0xd55e00 },
  { name: "of more than two triangles", colour: 0xf0e442 },
];

/** Colours of charts: x, y, z, magnitude, then others, the last that of the raw wrench. */
export const rawLine = 6;
export const lines = {
  dark: ["#56b4e9", "#e69f00", "#3fc79a", "#f4f7fa", "#e08bc0", "#f0e442", "#b79bff"],
  light: ["#0072b2", "#b86e00", "#00805c", "#1a242d", "#a8327f", "#7d6f00", "#6a3fb5"],
};
