// The hand by mouse, touch and keys. The part is taken where it is touched and follows the pointer by a spring: the page
// only says where the hand shall be, the simulated hand and the contacts decide where the part goes.
//
//   drag            moves in the plane of the view (a hinged part turns about its hinge)
//   shift + drag    turns about the part's handle
//   wheel, dragging nearer and farther
//   where bodies can be picked up, the hand goes to where one is pressed on and holds it until the pointer is let go
//   arrows          fine steps, page up and down in depth, with shift turns
//
// Where several hands hold parts, the one whose part is pressed on is led. A hand after the first is taken by the page
// that aims it, and left when the pointer lets go, so that two pages lead two hands.
import * as THREE from "three";
import type { Picture, Run, Vec } from "./protocol";
import type { View } from "./view";

const turnPerPixel = 0.008; // [rad]
const farthestLead = 1.0; // how far an aim may turn ahead of a hinged part [rad]
const fineStep = 0.006; // of the scene's radius
const fineTurn = (0.5 * Math.PI) / 180; // [rad]
const sendEvery_ms = 16;
const leash = 0.3; // of the scene's radius
const nearEnough_m = 0.004; // of the hand to what it shall pick up

export interface HandTalk {
  /** Makes sure that this page may lead the hand, counted from 0; false when it cannot. */
  mayLead(hand: number): boolean;
  send(message: Record<string, unknown>): void;
}

interface Drag {
  pointer: number; from: THREE.Vector3; plane: THREE.Plane; start: THREE.Vector3; // world [m]
  x: number; y: number; p0: THREE.Vector3; q0: THREE.Quaternion; angle: number; last: number; grabbed: THREE.Vector3; // of the held body
  depth: number; free: boolean;
}

export class Hand {
  turns = false; // dragging turns, without the key
  buttons = 0;
  private run: Run | null = null;
  private which = 0; // the hand that is led, the first one is 0
  private readonly others = new Map<number, { p: THREE.Vector3; q: THREE.Quaternion }>(); // aims of hands that were led before
  private p = new THREE.Vector3(); // the aim: the handle in the world [m]
  private q = new THREE.Quaternion();
  private aimed = false; // the aim is ours
  private reaching = false; // on the way to what is to be picked up
  private drag: Drag | null = null;
  private lastSent = 0;
  private waiting = 0;
  onChange: (() => void) | null = null;

  constructor(private readonly view: View, private readonly canvas: HTMLCanvasElement, private readonly talk: HandTalk) {
    canvas.addEventListener("pointerdown", (event) => this.down(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"] as const) canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { capture: true, passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  begin(run: Run) {
    this.run = run;
    this.which = 0;
    this.others.clear();
    this.aimed = false;
    this.drag = null;
    this.view.controls.enabled = true;
    this.view.overlay.setPull(null, null);
  }
  /** The line to the program is cut. */
  loseAll() {
    this.others.clear();
    this.lose(this.which);
  }
  /** Somebody else leads the hand now. */
  lose(hand: number) {
    this.others.delete(hand);
    if (hand !== this.which) return;
    this.aimed = false;
    this.release();
  }
  get dragging() {
    return this.drag !== null;
  }
  get canFeel() {
    return this.run !== null && this.handsLed.length > 0;
  }
  /** Whether hands after the first are led by pages. */
  get leadsOthers() {
    return this.handsLed.some((hand) => hand > 0);
  }
  /** The hands that hold something, or can, and are led by pages. */
  private get handsLed(): number[] {
    if (!this.run) return [];
    const { grasped, picks, device, other_hands } = this.run;
    const first = (grasped >= 0 || picks) && device.can_be_led ? [0] : [];
    return [...first, ...other_hands.flatMap((hand, i) => (hand.grasped >= 0 && hand.can_be_led ? [i + 1] : []))];
  }
  private graspedBy(hand: number): number {
    if (!this.run) return -1;
    return hand === 0 ? this.run.grasped : this.run.other_hands[hand - 1].grasped;
  }
  private get grasped() {
    return this.graspedBy(this.which);
  }
  /** The hand that would lead the body, or -1. */
  private handFor(body: number): number {
    const holder = this.handsLed.find((hand) => this.graspedBy(hand) === body);
    return holder ?? (this.run?.picks && this.run.device.can_be_led && this.run.bodies[body].moves ? 0 : -1);
  }
  private get picks() {
    return this.which === 0 && this.run?.picks === true;
  }
  private placeOf(picture: Picture): { body: number; hand: Float32Array; proxy: Float32Array } {
    return this.which === 0 ? picture : picture.others[this.which - 1];
  }
  /** Another hand is led from now on; the one before goes where it was aimed. */
  private choose(hand: number) {
    if (hand === this.which) return;
    if (this.aimed) this.others.set(this.which, { p: this.p.clone(), q: this.q.clone() });
    this.which = hand;
    const last = this.others.get(hand);
    this.aimed = last !== undefined;
    if (!last) return;
    this.p.copy(last.p);
    this.q.copy(last.q);
  }

  /** From where the handle is, or from where we last wanted it. */
  private takeUp(): boolean {
    const picture = this.view.picture;
    if (!picture || !this.handsLed.includes(this.which) || !this.talk.mayLead(this.which)) return false;
    if (!this.aimed) {
      const h = this.placeOf(picture).hand;
      this.p.set(h[0], h[1], h[2]);
      this.q.set(h[4], h[5], h[6], h[3]);
      this.aimed = true;
    }
    return true;
  }

  private down(event: PointerEvent) {
    if (event.button !== 0 || this.drag || !this.canFeel) return;
    const ray = this.view.rayAt(event.clientX, event.clientY);
    const hit = this.view.bodies?.pick(ray);
    const which = hit ? this.handFor(hit.body) : -1;
    if (!hit || !this.run || which < 0) return;
    this.choose(which);
    if (!this.takeUp()) return;
    event.stopImmediatePropagation(); // the camera stays where it is
    this.view.controls.enabled = false;
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.classList.add("holding");
    const point = hit.point.clone().applyMatrix4(this.view.toWorld);
    const body = this.run.bodies[hit.body];
    const hinged = body.joint === "hinge" && !event.altKey && !this.picks;
    const sight = this.view.camera.getWorldDirection(new THREE.Vector3());
    const normal = hinged && body.axis_W ? new THREE.Vector3(...body.axis_W) : sight.clone();
    if (hinged && Math.abs(normal.dot(ray.ray.direction)) < 0.12) normal.copy(sight);
    const grasped = this.view.bodies?.matrices[hit.body] ?? new THREE.Matrix4();
    this.reaching = this.picks;
    if (this.reaching) this.p.copy(point);
    this.drag = {
      pointer: event.pointerId, from: point, plane: new THREE.Plane().setFromNormalAndCoplanarPoint(normal, point),
      start: point.clone(), x: event.clientX, y: event.clientY, p0: this.p.clone(), q0: this.q.clone(), angle: 0, last: 0,
      grabbed: point.clone().applyMatrix4(grasped.clone().invert()), depth: 0, free: !hinged,
    };
    this.canvas.focus({ preventScroll: true });
    this.canvas.classList.add("by-pointer"); // no ring around what a pointer has chosen
    this.send(true);
    this.onChange?.();
  }

  /** Where the pointer's ray meets the plane of the drag, in the world. */
  private onPlane(event: PointerEvent | WheelEvent): THREE.Vector3 | null {
    const drag = this.drag as Drag;
    const ray = this.view.rayAt(event.clientX, event.clientY).ray.clone().applyMatrix4(this.view.toWorld);
    return ray.intersectPlane(drag.plane, new THREE.Vector3());
  }

  private move(event: PointerEvent) {
    const drag = this.drag;
    if (!drag) {
      if (event.buttons === 0) this.hover(event);
      return;
    }
    if (event.pointerId !== drag.pointer || this.reaching) return;
    if (event.shiftKey || this.turns) {
      this.turnBy((event.clientX - drag.x) * turnPerPixel, (event.clientY - drag.y) * turnPerPixel);
      drag.p0.copy(this.p);
      drag.start.copy(this.onPlane(event) ?? drag.start);
    } else if (drag.free) {
      const now = this.onPlane(event);
      if (now) this.p.copy(drag.p0).add(now).sub(drag.start);
    } else {
      this.turnHinge(event);
    }
    drag.x = event.clientX;
    drag.y = event.clientY;
    this.send(false);
  }

  /** A hinged part follows the pointer on its circle, never more than a lead ahead of where it is. */
  private turnHinge(event: PointerEvent) {
    const drag = this.drag as Drag;
    const now = this.onPlane(event);
    const body = this.run?.bodies[this.grasped];
    if (!now || !body?.axis_W || !body.anchor_W) return;
    const axis = new THREE.Vector3(...body.axis_W);
    const anchor = new THREE.Vector3(...body.anchor_W);
    const across = (v: THREE.Vector3) => v.clone().sub(anchor).projectOnPlane(axis);
    const angleTo = (v: THREE.Vector3) => {
      const [a, b] = [across(drag.start), across(v)];
      return Math.atan2(axis.dot(a.clone().cross(b)), a.dot(b));
    };
    const nearest = (angle: number, to: number) => angle + 2 * Math.PI * Math.round((to - angle) / (2 * Math.PI));
    drag.last = nearest(angleTo(now), drag.last);
    const there = drag.grabbed.clone().applyMatrix4(this.view.bodies?.matrices[this.grasped] ?? new THREE.Matrix4());
    const part = nearest(angleTo(there), drag.last);
    drag.angle = Math.min(part + farthestLead, Math.max(part - farthestLead, drag.last));
    const turn = new THREE.Quaternion().setFromAxisAngle(axis, drag.angle);
    this.p.copy(drag.p0).sub(anchor).applyQuaternion(turn).add(anchor);
    this.q.copy(turn).multiply(drag.q0);
  }

  /** About the view's upright and sideways axes. */
  private turnBy(right: number, down: number, roll = 0) {
    const camera = this.view.camera;
    const axis = (x: number, y: number, z: number) => new THREE.Vector3(x, y, z).applyQuaternion(camera.quaternion);
    for (const [a, angle] of [[axis(0, 1, 0), right], [axis(1, 0, 0), down], [axis(0, 0, 1), roll]] as const)
      this.q.premultiply(new THREE.Quaternion().setFromAxisAngle(a, angle));
    this.q.normalize();
    if (this.drag) this.drag.q0.copy(this.q);
  }

  private up(event: PointerEvent) {
    if (event.pointerId === this.drag?.pointer) this.release();
  }
  private release() {
    const dragged = this.drag !== null;
    this.drag = null;
    this.reaching = false;
    if (this.picks && this.buttons !== 0) {
      this.buttons = 0;
      if (this.aimed) this.send(true);
    } else if (dragged && this.which > 0 && this.aimed) {
      this.send(true); // the last aim, after which the hand is left
    }
    this.view.controls.enabled = true;
    this.canvas.classList.remove("holding");
    this.view.overlay.setPull(null, null);
    this.onChange?.();
  }

  private wheel(event: WheelEvent) {
    if (!this.drag) return;
    event.stopImmediatePropagation();
    event.preventDefault();
    const sight = this.view.camera.getWorldDirection(new THREE.Vector3());
    const step = sight.multiplyScalar((-Math.sign(event.deltaY) * 0.02) / this.view.scale);
    this.p.add(step);
    this.drag.p0.add(step);
    this.send(false);
  }

  private hover(event: PointerEvent) {
    if (event.pointerType === "touch") return;
    const hit = this.canFeel ? this.view.bodies?.pick(this.view.rayAt(event.clientX, event.clientY)) : null;
    this.canvas.classList.toggle("can-hold", hit ? this.handFor(hit.body) >= 0 : false);
  }

  private key(event: KeyboardEvent) {
    this.canvas.classList.remove("by-pointer");
    const directions: Record<string, [number, number, number]> = {
      ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, -1], PageDown: [0, 0, 1],
    };
    const direction = directions[event.key];
    if (!direction || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (!this.takeUp()) return;
    const finer = event.altKey ? 0.2 : 1;
    const body = this.run?.bodies[this.grasped];
    if (body?.joint === "hinge" && body.axis_W && body.anchor_W && direction[2] === 0) {
      const turn = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(...body.axis_W), -(direction[0] || direction[1]) * fineTurn * finer);
      const anchor = new THREE.Vector3(...body.anchor_W);
      this.p.sub(anchor).applyQuaternion(turn).add(anchor);
      this.q.premultiply(turn);
    } else if (event.shiftKey) {
      this.turnBy(direction[0] * 2 * fineTurn * finer, -direction[1] * 2 * fineTurn * finer, direction[2] * 2 * fineTurn * finer);
    } else {
      const step = new THREE.Vector3(...direction).applyQuaternion(this.view.camera.quaternion);
      this.p.addScaledVector(step, (fineStep * finer) / this.view.scale);
    }
    this.send(false);
  }

  /** Moves and turns the aim in the axes of the view, by parts of the scene's radius and by radians. It goes no farther ahead
   *  of the handle than a leash: what is pushed against a wall comes back at once. */
  lead(move: Vec, turn: Vec) {
    if (this.drag || !this.takeUp()) return;
    const handle = this.view.picture ? this.placeOf(this.view.picture).hand : [0, 0, 0];
    this.p.addScaledVector(new THREE.Vector3(...move).applyQuaternion(this.view.camera.quaternion), 1 / this.view.scale);
    const from = new THREE.Vector3(handle[0], handle[1], handle[2]);
    this.p.sub(from).clampLength(0, leash / this.view.scale).add(from);
    this.turnBy(turn[1], turn[0], turn[2]);
    this.send(false);
  }

  setButton(on: boolean) {
    this.buttons = on ? 1 : 0;
    if (this.takeUp()) this.send(true);
  }

  /** At most so often; the last one is never forgotten. */
  private send(now: boolean) {
    const since = performance.now() - this.lastSent;
    if (!now && since < sendEvery_ms) {
      if (!this.waiting) this.waiting = window.setTimeout(() => this.send(true), sendEvery_ms - since);
      return;
    }
    window.clearTimeout(this.waiting);
    this.waiting = 0;
    this.lastSent = performance.now();
    const { p, q, which } = this;
    this.talk.send({ do: "aim", hand: which, p: [p.x, p.y, p.z], q: [q.w, q.x, q.y, q.z], buttons: this.buttons });
    if (which > 0 && !this.drag) this.talk.send({ do: "leave", hand: which });
  }

  /** Presses the button when the hand has come near enough, and drags from there once something is held. */
  private grabWhenNear(picture: Picture) {
    const drag = this.drag as Drag;
    const away = this.p.distanceTo(new THREE.Vector3(picture.hand[0], picture.hand[1], picture.hand[2]));
    if (this.buttons === 0 && away < nearEnough_m) {
      this.buttons = 1;
      this.send(true);
    }
    const grasped = this.view.bodies?.matrices[picture.body];
    if (!grasped || this.buttons === 0) return;
    this.reaching = false;
    drag.p0.copy(this.p);
    drag.q0.copy(this.q);
    drag.start.copy(this.p);
    drag.from.copy(this.p);
    drag.plane.setFromNormalAndCoplanarPoint(drag.plane.normal, this.p);
    drag.grabbed.copy(this.p).applyMatrix4(grasped.clone().invert());
  }

  /** The spring from the place that was taken to the pointer. */
  drawPull(picture: Picture) {
    const drag = this.drag;
    if (!drag || !this.run) return;
    if (this.reaching) this.grabWhenNear(picture);
    const grasped = this.view.bodies?.matrices[this.grasped];
    if (!grasped) return;
    const place = this.placeOf(picture);
    const from = drag.grabbed.clone().applyMatrix4(grasped);
    const proxy = new THREE.Vector3(place.proxy[0], place.proxy[1], place.proxy[2]);
    const turned = new THREE.Quaternion(place.proxy[4], place.proxy[5], place.proxy[6], place.proxy[3]).invert();
    const to = from.clone().sub(proxy).applyQuaternion(turned).applyQuaternion(this.q).add(this.p);
    this.view.overlay.setPull(from.applyMatrix4(this.view.toView), to.applyMatrix4(this.view.toView));
  }
}
