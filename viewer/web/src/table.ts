// Samples as a table for other programs: what it is about in comment lines, then a row a frame (docs/viewer.md).
import type { Picture, Run } from "./protocol";
import { poseParts, type Samples } from "./samples";

/** Facts of a run that exports carry in their heads. */
export interface Facts { scene: string; device: string; version: string; settings: string[] }

const quoted = (text: string) => (text.includes(",") || text.includes('"') ? JSON.stringify(text).replaceAll('\\"', '""') : text);
const headed = (name: string, unit: string) => quoted(unit ? `${name} [${unit}]` : name);
const shown = (value: number) => (Number.isNaN(value) ? "" : String(Number(value.toPrecision(9))));

/**
 * Samples from number `from` to before `to`: wrenches, channels, poses. Values read back to the same numbers. Every sample has the
 * poses of the first dozen bodies that move; those of the others are known in the frames of which the page has a picture, else
 * their cells are empty.
 */
export function csvOf(run: Run, samples: Samples, from: number, to: number, facts: Facts): string {
  if (samples.count === 0) return "";
  const others = run.bodies.flatMap((body, i) => (body.moves && !run.posed.includes(i) ? [i] : []));
  const names = [...samples.names.map((name, i) => headed(name, samples.units[i])),
    ...others.flatMap((body) => poseParts.map(([part, unit]) => headed(`${run.bodies[body].name}.${part}`, unit)))];
  const rows = [...headOf(run, facts), ["frame", "time [s]", ...names].join(",")];
  const pictures = samples.picturesBetween(samples.frameOf(from), samples.frameOf(to - 1));
  const poseOf = (picture: Picture | undefined, body: number) => poseParts.map((_part, k) => (picture ? shown(picture.bodies[7 * body + k]) : ""));
  for (let i = from; i < to; ++i) {
    const picture = pictures.get(samples.frameOf(i));
    const values = samples.names.map((_name, column) => shown(samples.at(column, i)));
    rows.push([samples.frameOf(i), Number(samples.timeOf(i).toFixed(9)), ...values, ...others.flatMap((body) => poseOf(picture, body))].join(","));
  }
  return `${rows.join("\n")}\n`;
}

function headOf(run: Run, facts: Facts): string[] {
  const fixed = run.bodies.filter((body) => !body.moves);
  return [
    `Tactum ${facts.version}: every frame of the charts' window, docs/viewer.md#the-csv-file`,
    `scene: ${facts.scene}`, `device: ${facts.device}`, `rate_Hz: ${run.rate_Hz}`, `date: ${new Date().toISOString()}`,
    "axes: of the world; wrenches act on the hand, at the handle; device_* is in the frame of the device; quaternions are w, x, y, z",
    ...run.stages.map((stage) => `column ${stage.key}.fx to .tz [N, N m]: ${stage.name}; ${stage.meaning}`),
    ...run.channels.map((channel) => `column ${headed(channel.key, channel.unit)}: ${channel.name}; ${channel.meaning}`),
    "column BODY.px to .qz [m]: centre of mass and orientation of each body that moves; beyond the first dozen only in frames of which the page has a picture",
    ...fixed.map((body) => `fixed body ${body.name}: px, py, pz [m], qw, qx, qy, qz = ${[...body.X_WB.p, ...body.X_WB.q].join(" ")}`),
    ...facts.settings.map((line) => `setting ${line}`),
  ].map((line) => `# ${line.replaceAll("\n", " ")}`);
}
