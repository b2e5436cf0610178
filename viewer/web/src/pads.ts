// A SpaceMouse (WebHID) and gamepads as leaders of the hand: their deflection is a speed of the aim, in the axes of the view.
//
//   SpaceMouse   its cap moves and turns as the hand does; its first button grasps
//   gamepad      left stick right and up, triggers nearer and farther, right stick and bumpers turn, A grasps
//
// A gamepad that can rumble does so while the part pushes: a cue of contact, no force.
import { get } from "./dom";
import type { Hand } from "./hand";
import { SixAxisReports, type HidCollection } from "./hid_report";
import type { Vec } from "./protocol";

const deadZone = 0.12; // of a stick's full deflection: worn sticks rest beside zero
const deadCap = 0.02; // of the cap's
const speed_per_s = 0.5; // of the scene's radius, at full deflection
const turn_per_s = 1.5; // [rad/s]
const longestStep_s = 0.1; // a page that slept does not leap
const rumbleEvery_ms = 100;

interface HidDevice extends EventTarget {
  opened: boolean; productName: string; collections: HidCollection[];
  open(): Promise<void>;
}
interface HidReportEvent extends Event { reportId: number; data: DataView }
interface Hid extends EventTarget {
  getDevices(): Promise<HidDevice[]>;
  requestDevice(options: { filters: { usagePage: number; usage: number }[] }): Promise<HidDevice[]>;
}
interface Rumble { playEffect(kind: string, how: Record<string, number>): Promise<unknown> }

/** Nothing within the dead zone, and from its edge on in proportion. */
function beyond(value: number, dead: number): number {
  const over = Math.abs(value) - dead;
  return over > 0 ? (Math.sign(value) * Math.min(1, over / (1 - dead))) : 0;
}
/** The same of a stick, whose dead zone is round. */
function stick(x = 0, y = 0): [number, number] {
  const length = Math.hypot(x, y);
  const share = length > 0 ? beyond(length, deadZone) / length : 0;
  return [x * share, y * share];
}

interface Deflection { move: Vec; turn: Vec; buttons: number }

/** The first gamepad in the standard layout. */
function gamepadNow(): Gamepad | null {
  return navigator.getGamepads?.().find((pad) => pad?.connected && pad.mapping === "standard") ?? null;
}
function ofGamepad(pad: Gamepad): Deflection {
  const [right, down] = stick(pad.axes[0], pad.axes[1]);
  const [about, over] = stick(pad.axes[2], pad.axes[3]);
  const button = (i: number) => pad.buttons[i]?.value ?? 0;
  return {
    move: [right, -down, beyond(button(6), deadZone) - beyond(button(7), deadZone)],
    turn: [over, about, button(4) - button(5)],
    buttons: pad.buttons[0]?.pressed ? 1 : 0,
  };
}
/** The device's x is right, y toward the person, z down; its turns are about the same axes. */
function ofSpaceMouse(reports: SixAxisReports): Deflection {
  const [x, y, z, rx, ry, rz] = reports.values.map((value) => beyond(value, deadCap));
  return { move: [x, -z, y], turn: [rx, -rz, ry], buttons: reports.buttons & 1 };
}

export class Pads {
  private readonly hid = (navigator as unknown as { hid?: Hid }).hid;
  private mice: { device: HidDevice; reports: SixAxisReports }[] = [];
  private pressed = 0; // by a device here
  private lastTime = 0;
  private lastRumble = 0;

  constructor(private readonly hand: Hand, private readonly notice: (text: string) => void) {
    const button = get("spacemouse");
    button.hidden = !this.hid;
    button.onclick = () => void this.choose();
    void this.hid?.getDevices().then((devices) => this.takeAll(devices)); // those that were allowed before
    this.hid?.addEventListener("disconnect", (event) => this.drop((event as Event & { device: HidDevice }).device));
    window.addEventListener("gamepadconnected", (event) => notice(event.gamepad.mapping === "standard"
      ? `${event.gamepad.id} leads the hand: sticks and triggers.`
      : `${event.gamepad.id} has no standard layout, so nothing is known of its sticks.`));
    requestAnimationFrame((time) => this.tick(time));
  }

  private async choose() {
    const generic = { usagePage: 0x1, usage: 0x8 }; // Generic Desktop, multi-axis controller
    try {
      await this.takeAll((await this.hid?.requestDevice({ filters: [generic] })) ?? []);
    } catch (error) {
      this.notice(`The device could not be opened: ${String(error)}`);
    }
  }
  private async takeAll(devices: HidDevice[]) {
    for (const device of devices) {
      if (this.mice.some((known) => known.device === device)) continue;
      const reports = new SixAxisReports(device.collections);
      if (!reports.complete) {
        this.notice(`${device.productName} has not all six axes in its report descriptor.`);
        continue;
      }
      device.addEventListener("inputreport", (event) => reports.take((event as HidReportEvent).reportId, (event as HidReportEvent).data));
      this.mice.push({ device, reports });
      try {
        if (!device.opened) await device.open();
        this.notice(`${device.productName} leads the hand.`);
      } catch (error) {
        this.drop(device);
        this.notice(`${device.productName} could not be opened, as another program may hold it: ${String(error)}`);
      }
    }
    this.show();
  }
  private drop(device: HidDevice) {
    this.mice = this.mice.filter((known) => known.device !== device);
    this.show();
  }
  private show() {
    get("spacemouse").setAttribute("aria-pressed", String(this.mice.length > 0));
  }

  private tick(time: number) {
    requestAnimationFrame((next) => this.tick(next));
    const step_s = Math.min(longestStep_s, Math.max(0, (time - this.lastTime) / 1000));
    this.lastTime = time;
    const pad = gamepadNow();
    const led = [...this.mice.map(({ reports }) => ofSpaceMouse(reports)), ...(pad ? [ofGamepad(pad)] : [])];
    const sum = (of: (one: Deflection) => Vec, scale: number): Vec =>
      led.reduce<Vec>((all, one) => of(one).map((value, i) => all[i] + value * scale * step_s) as Vec, [0, 0, 0]);
    const move = sum((one) => one.move, speed_per_s);
    const turn = sum((one) => one.turn, turn_per_s);
    if ([...move, ...turn].some((value) => value !== 0)) this.hand.lead(move, turn);
    const pressed = led.reduce((all, one) => all | one.buttons, 0);
    if (pressed !== this.pressed) this.hand.setButton(pressed !== 0);
    this.pressed = pressed;
  }

  /** How hard the part pushes, as a share of what the device can: the gamepad rumbles, where it can. */
  feel(share: number) {
    const pad = gamepadNow();
    const rumble = (pad as unknown as { vibrationActuator?: Rumble } | null)?.vibrationActuator;
    if (!rumble || !(share > 0.01) || performance.now() - this.lastRumble < rumbleEvery_ms) return;
    this.lastRumble = performance.now();
    const strength = Math.min(1, 0.2 + share); // weaker is not noticed
    rumble.playEffect("dual-rumble", { startDelay: 0, duration: 1.5 * rumbleEvery_ms, weakMagnitude: strength, strongMagnitude: Math.min(1, share) })
      .catch(() => (this.lastRumble = Number.POSITIVE_INFINITY)); // it cannot after all
  }
}
