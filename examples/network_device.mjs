// A device in JavaScript, for a page of a browser or for node: the packets of
// src/tactum/drivers/tactum_device.h, one binary WebSocket message each.
//
//   tactum feel block-on-plate --device network --duration 4 & node examples/network_device.mjs 5
//
// On a page see examples/network_device.html. node needs version 22, or 20 with --experimental-websocket, or
// the package ws.

const kPort = 47320, kMagic = 0x44486354, kVersion = 1;
const kHello = 1, kWelcome = 2, kState = 3, kCommand = 4, kBye = 5;
const kStale_ms = 20; // a wrench older than this is not exerted
export const kSensesRotation = 1, kActuatesForce = 2, kActuatesTorque = 4;

/// Joins Tactum as soon as it listens, and again after each goodbye.
/// The device is an object with
///   info: {flags, max_force_N, ...}, as tactum_device_info; numbers that are absent are zero
///   measure(): {position: [x, y, z], orientation_wxyz, velocity, buttons}, of the handle, in metres and the
///     axes of tactum_device.h
///   exert(wrench): six numbers, in newtons and newton metres; called for each command, and with zeros when
///     none came for 20 ms
///   goodbye(): called when Tactum says it; may be absent
/// Returns a function that says goodbye.
export function joinAsDevice({ info, measure, exert, goodbye }, { port = kPort, host = "127.0.0.1", Socket = WebSocket } = {}) {
  let socket, session = 0, sent = 0, lastCommand = 0, commandAt_ms = 0, welcome = false, ended = false;

  function packet(size, kind) {
    const view = new DataView(new ArrayBuffer(size));
    view.setUint32(0, kMagic, true);
    view.setUint16(4, kVersion, true);
    view.setUint16(6, kind, true);
    view.setUint32(8, session, true);
    view.setUint32(12, ++sent, true);
    return view;
  }
  function send(view) {
    if (socket.readyState === 1) socket.send(view.buffer);
  }
  function sayHello() {
    const view = packet(208, kHello);
    view.setUint32(16, info.flags, true);
    ["max_force_N", "max_torque_Nm", "stiffest_N_per_m", "stiffest_Nm_per_rad", "workspace_radius_m", "rate_Hz",
      "mass_kg", "inertia_kg_m2", "damping_Ns_per_m", "damping_Nms_per_rad", "delay_s"]
      .forEach((name, i) => view.setFloat64(24 + 8 * i, info[name] ?? 0, true));
    const text = (at, room, words) =>
      [...words].slice(0, room - 1).forEach((c, i) => view.setUint8(at + i, c.charCodeAt(0)));
    text(112, 64, info.name ?? "");
    text(176, 32, info.serial ?? "");
    send(view);
  }
  function sendState() {
    const now_ms = performance.now(), state = measure(), view = packet(208, kState);
    view.setFloat64(16, now_ms / 1e3, true);
    view.setFloat64(24, lastCommand === 0 ? 0 : (now_ms - commandAt_ms) / 1e3, true);
    view.setUint32(32, lastCommand, true);
    const numbers = (at, list) => list.forEach((number, i) => view.setFloat64(at + 8 * i, number, true));
    numbers(40, state.position);
    numbers(64, state.orientation_wxyz ?? [1, 0, 0, 0]);
    numbers(96, state.velocity ?? []);
    view.setUint32(200, state.buttons ?? 0, true);
    view.setUint32(204, state.velocity ? 1 : 0, true);
    send(view);
  }
  function take(view) {
    if (view.byteLength < 16 || view.getUint32(0, true) !== kMagic || view.getUint32(8, true) !== session) return;
    const kind = view.getUint16(6, true), sequence = view.getUint32(12, true);
    if (kind === kWelcome) welcome = true;
    if (kind === kBye) {
      socket.close();
      return goodbye?.();
    }
    if (kind === kCommand && sequence > lastCommand) {
      lastCommand = sequence;
      commandAt_ms = performance.now();
      exert([0, 1, 2, 3, 4, 5].map((i) => view.getFloat64(24 + 8 * i, true)));
    }
    sendState(); // as often as commands come: timers of browsers are slower
  }
  function connect() {
    if (ended) return;
    session = (Math.random() * 2 ** 32) >>> 0;
    sent = lastCommand = 0;
    welcome = false;
    socket = new Socket(`ws://${host}:${port}`);
    socket.binaryType = "arraybuffer";
    socket.onopen = sayHello;
    socket.onmessage = (message) => take(new DataView(message.data));
    socket.onerror = () => {}; // onclose follows
    socket.onclose = () => {
      exert([0, 0, 0, 0, 0, 0]);
      setTimeout(connect, 100);
    };
  }
  const timer = setInterval(() => {
    if (performance.now() - commandAt_ms < kStale_ms) return;
    exert([0, 0, 0, 0, 0, 0]);
    if (welcome) sendState();
  }, kStale_ms / 4);
  connect();
  return () => {
    ended = true;
    clearInterval(timer);
    send(packet(16, kBye));
    socket.close();
  };
}

/// The same ball on a spring as examples/network_device.c, for node.
async function main(duration_s, port) {
  const Socket = globalThis.WebSocket ?? (await import("ws")).default;
  const info = {
    flags: kSensesRotation | kActuatesForce, max_force_N: 8, stiffest_N_per_m: 1500, workspace_radius_m: 0.08,
    rate_Hz: 1000, mass_kg: 0.1, damping_Ns_per_m: 2, name: "example in JavaScript", serial: "1",
  };
  const position = [0, 0, 0], velocity = [0, 0, 0, 0, 0, 0];
  let begin_s, last_s, largest_N = 0, wrench = [0, 0, 0, 0, 0, 0];
  const measure = () => {
    const now_s = performance.now() / 1e3;
    begin_s ??= last_s = now_s; // the hand begins to move when Tactum first asks where it is
    const dt_s = Math.min(now_s - last_s, 0.002);
    last_s = now_s;
    for (let i = 0; i < 3; ++i) {
      const hand_m = i === 2 ? -0.02 * Math.sin(3 * (now_s - begin_s)) : 0; // the hand's place goes down and up
      const force_N = wrench[i] + 200 * (hand_m - position[i]) - (2 + info.damping_Ns_per_m) * velocity[i];
      velocity[i] += (dt_s * force_N) / info.mass_kg;
      position[i] += dt_s * velocity[i];
    }
    return { position, velocity };
  };
  const exert = (F) => {
    wrench = F;
    largest_N = Math.max(largest_N, Math.hypot(F[0], F[1], F[2]));
  };
  const end = () => {
    leave();
    console.log(`largest force ${largest_N.toFixed(3)} N`);
    setTimeout(() => process.exit(0), 100);
  };
  const leave = joinAsDevice({ info, measure, exert, goodbye: end }, { port, Socket });
  setTimeout(end, 1e3 * duration_s);
}

if (globalThis.process?.argv?.[1]?.endsWith("network_device.mjs"))
  main(Number(process.argv[2] ?? 5), Number(process.argv[3] ?? kPort));
