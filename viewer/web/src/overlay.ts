// What cannot be seen of a contact: points, normals and forces, the wrench at the hand, the device's own pose as a ghost,
// the stretch between the two, and the way the hand has gone. Everything here is in view units (the scene's radius is one).
import * as THREE from "three";
import type { Look } from "./look";
import type { Contact, Grip } from "./protocol";
import type { Push } from "./pushes";

const mostContacts = 256;
const trailLength = 240;
const up = new THREE.Vector3(0, 1, 0);

function plain(opacity = 1, seenThrough = true): THREE.MeshBasicMaterial {
  return new THREE.MeshBasicMaterial({ transparent: opacity < 1 || seenThrough, opacity, depthTest: !seenThrough, toneMapped: false });
}

/** An arrow of fixed thickness and any length. */
class Arrow {
  readonly root = new THREE.Group();
  private readonly shaft: THREE.Mesh;
  private readonly head: THREE.Mesh;
  constructor(private readonly thickness: number, material: THREE.Material) {
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(thickness, thickness, 1, 16).translate(0, 0.5, 0), material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(2.6 * thickness, 6.5 * thickness, 20).translate(0, -3.25 * thickness, 0), material);
    this.shaft.renderOrder = this.head.renderOrder = 8;
    this.root.add(this.shaft, this.head);
  }
  set(from: THREE.Vector3, along: THREE.Vector3) {
    const length = along.length();
    this.root.visible = length > 0.6 * this.thickness;
    if (!this.root.visible) return;
    this.root.position.copy(from);
    this.root.quaternion.setFromUnitVectors(up, along.clone().divideScalar(length));
    this.head.position.y = length;
    this.head.scale.setScalar(Math.min(1, length / (9 * this.thickness)));
    this.shaft.scale.y = Math.max(1e-4, length - 6 * this.thickness * this.head.scale.x);
  }
}

/** An arc about an axis with an arrow head at its end: how a torque turns. */
class Arc {
  readonly root = new THREE.Group();
  private readonly arc: THREE.Mesh<THREE.TorusGeometry>;
  private readonly head: THREE.Mesh;
  private angle = 0;
  constructor(private readonly radius: number, private readonly thickness: number, material: THREE.Material) {
    this.arc = new THREE.Mesh(new THREE.TorusGeometry(radius, thickness, 10, 8, 1), material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(3 * thickness, 7 * thickness, 18), material);
    this.arc.renderOrder = this.head.renderOrder = 8;
    this.root.add(this.arc, this.head);
  }
  set(at: THREE.Vector3, axis: THREE.Vector3, angle: number) {
    this.root.visible = angle > 0.05;
    if (!this.root.visible) return;
    if (Math.abs(angle - this.angle) > 0.01) {
      this.angle = angle;
      this.arc.geometry.dispose();
      this.arc.geometry = new THREE.TorusGeometry(this.radius, this.thickness, 10, Math.max(8, Math.ceil(angle * 16)), angle);
    }
    this.root.position.copy(at);
    this.root.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), axis);
    this.head.position.set(this.radius * Math.cos(angle), this.radius * Math.sin(angle), 0);
    this.head.rotation.set(0, 0, angle);
  }
  get tip(): THREE.Vector3 {
    return this.head.getWorldPosition(new THREE.Vector3());
  }
}

/** A rod between two points. */
class Rod {
  readonly mesh: THREE.Mesh;
  constructor(private readonly thickness: number, material: THREE.Material) {
    this.mesh = new THREE.Mesh(new THREE.CylinderGeometry(thickness, thickness, 1, 10), material);
    this.mesh.renderOrder = 7;
  }
  set(a: THREE.Vector3, b: THREE.Vector3) {
    const along = b.clone().sub(a);
    const length = along.length();
    this.mesh.visible = length > this.thickness;
    if (!this.mesh.visible) return;
    this.mesh.position.copy(a).addScaledVector(along, 0.5);
    this.mesh.quaternion.setFromUnitVectors(up, along.divideScalar(length));
    this.mesh.scale.y = length;
  }
}

/** A hand that another device leads: its handle, the stretch to its part, and the wrench on it. */
class SecondHand {
  readonly root = new THREE.Group();
  private readonly force: Arrow;
  private readonly torque: Arc;
  private readonly stretch: Rod;
  private readonly handle: THREE.Mesh;
  constructor(materials: { force: THREE.Material; torque: THREE.Material; stretch: THREE.Material; handle: THREE.Material }) {
    this.force = new Arrow(0.013, materials.force);
    this.torque = new Arc(0.2, 0.011, materials.torque);
    this.stretch = new Rod(0.006, materials.stretch);
    this.handle = new THREE.Mesh(new THREE.SphereGeometry(0.02, 20, 14), materials.handle);
    this.handle.renderOrder = 9;
    this.root.add(this.force.root, this.torque.root, this.stretch.mesh, this.handle);
  }
  set(hand: THREE.Vector3, proxy: THREE.Vector3, wrench: number[], scales: Scales) {
    this.handle.position.copy(hand);
    this.stretch.set(hand, proxy);
    setPair(this.force, this.torque, proxy, wrench, scales);
  }
}

/** Draws force and torque at a place; the arrow. */
function setPair(arrow: Arrow, arc: Arc, at: THREE.Vector3, wrench: number[], scales: Scales): THREE.Vector3 {
  const force = new THREE.Vector3(wrench[0], wrench[1], wrench[2]).multiplyScalar(scales.force).clampLength(0, scales.longest);
  arrow.set(at, force);
  const torque = new THREE.Vector3(wrench[3], wrench[4], wrench[5]);
  const size = torque.length();
  arc.set(at, size > 0 ? torque.divideScalar(size) : up, Math.min(5.6, size * scales.torque));
  return force;
}

/** View units a newton, radians a newton metre; arrows end at the longest. */
export interface Scales { force: number; torque: number; longest: number }

export class Overlay {
  readonly root = new THREE.Group();
  readonly ghostMaterial = new THREE.MeshStandardMaterial({ transparent: true, opacity: 0.3, depthWrite: false, roughness: 0.6,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2 }); // where ghost and part agree, the part is seen
  private readonly materials = {
    force: plain(), torque: plain(), contact: plain(0.95), arrow: plain(), raw: plain(0.5), patch: plain(0.35), stretch: plain(), trail: new THREE.LineBasicMaterial(
      { vertexColors: true, transparent: true, toneMapped: false }), handle: plain(), pull: plain(0.7),
  };
  private readonly force = new Arrow(0.013, this.materials.force);
  private readonly torque = new Arc(0.2, 0.011, this.materials.torque);
  private readonly rawForce = new Arrow(0.021, this.materials.raw); // around the shown one where they agree
  private readonly rawTorque = new Arc(0.2, 0.018, this.materials.raw);
  private readonly stretch = new Rod(0.006, this.materials.stretch);
  private readonly pull = new Rod(0.004, this.materials.pull);
  private readonly handle = new THREE.Mesh(new THREE.SphereGeometry(0.02, 20, 14), this.materials.handle);
  private readonly anchor = new THREE.Mesh(new THREE.SphereGeometry(0.013, 16, 12), this.materials.stretch);
  private readonly discs: THREE.InstancedMesh;
  private readonly shafts: THREE.InstancedMesh;
  private readonly heads: THREE.InstancedMesh;
  private readonly patches = new THREE.Mesh(new THREE.BufferGeometry(), this.materials.patch);
  private readonly trail: THREE.Line;
  private readonly others: SecondHand[] = [];
  private trailPoints: THREE.Vector3[] = [];
  private ghost: THREE.Mesh | null = null;
  private readonly trailColour = new THREE.Color();
  private gripColours: Record<Grip, THREE.Color> = { none: new THREE.Color(), sticks: new THREE.Color(), slips: new THREE.Color() };
  showsTrail = true;
  chosen = -1; // number of the chosen patch

  constructor(look: Look) {
    const flat = new THREE.CylinderGeometry(1, 1, 0.25, 20);
    this.discs = new THREE.InstancedMesh(flat, this.materials.contact, mostContacts);
    this.shafts = new THREE.InstancedMesh(new THREE.CylinderGeometry(1, 1, 1, 8).translate(0, 0.5, 0), this.materials.arrow, mostContacts);
    this.heads = new THREE.InstancedMesh(new THREE.ConeGeometry(1, 2.4, 12).translate(0, 1.2, 0), this.materials.arrow, mostContacts);
    for (const mesh of [this.discs, this.shafts, this.heads]) {
      mesh.frustumCulled = false;
      mesh.renderOrder = 6;
    }
    this.materials.patch.side = THREE.DoubleSide;
    this.patches.frustumCulled = false;
    this.patches.renderOrder = 5;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * trailLength), 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(4 * trailLength), 4));
    this.trail = new THREE.Line(geometry, this.materials.trail);
    this.trail.frustumCulled = false;
    this.handle.renderOrder = this.anchor.renderOrder = 9;
    this.rawForce.root.visible = this.rawTorque.root.visible = false;
    this.root.add(this.force.root, this.torque.root, this.rawForce.root, this.rawTorque.root, this.stretch.mesh, this.pull.mesh, this.handle, this.anchor, this.discs, this.shafts,
      this.heads, this.patches, this.trail);
    this.pull.mesh.visible = false;
    this.setLook(look);
  }

  setLook(look: Look) {
    this.materials.force.color.set(look.force);
    this.materials.torque.color.set(look.torque);
    this.materials.raw.color.set(look.raw);
    this.gripColours = {
      none: new THREE.Color(look.force), sticks: new THREE.Color(look.sticks), slips: new THREE.Color(look.slips),
    };
    this.materials.contact.color.set(look.contact);
    this.materials.patch.color.set(look.force);
    this.materials.stretch.color.set(look.stretch);
    this.materials.handle.color.set(look.ghost);
    this.materials.pull.color.set(look.ghost);
    this.ghostMaterial.color.set(look.ghost);
    this.trailColour.set(look.trail);
  }

  /** Null when nothing is held: then there is no hand to show. */
  setGhost(mesh: THREE.Mesh | null, handle: boolean) {
    this.handle.visible = handle;
    if (this.ghost) this.root.parent?.remove(this.ghost);
    this.ghost = mesh;
    if (mesh) mesh.renderOrder = 3;
  }

  clearTrail() {
    this.trailPoints = [];
  }

  /** Handle and proxy, in view units; `ghostMatrix` puts the ghost where the device would have the part. */
  setHand(hand: THREE.Vector3, proxy: THREE.Vector3, ghostMatrix: THREE.Matrix4 | null, turned: number, live: boolean) {
    const apart = hand.distanceTo(proxy);
    this.handle.position.copy(hand);
    this.anchor.position.copy(proxy);
    this.stretch.set(hand, proxy);
    this.anchor.visible = this.stretch.mesh.visible;
    if (this.ghost && ghostMatrix) {
      this.ghost.matrix.copy(ghostMatrix);
      this.ghost.matrixWorldNeedsUpdate = true;
      const seen = Math.min(1, Math.max((apart - 0.004) / 0.03, (turned - 0.004) / 0.05));
      this.ghost.visible = seen > 0;
      this.ghostMaterial.opacity = 0.34 * seen;
    }
    if (live) this.addToTrail(hand);
    this.drawTrail();
  }

  private addToTrail(point: THREE.Vector3) {
    this.trailPoints.push(point.clone());
    if (this.trailPoints.length > trailLength) this.trailPoints.shift();
  }

  private drawTrail() {
    this.trail.visible = this.showsTrail;
    const position = this.trail.geometry.getAttribute("position") as THREE.BufferAttribute;
    const colour = this.trail.geometry.getAttribute("color") as THREE.BufferAttribute;
    const { r, g, b } = this.trailColour;
    this.trailPoints.forEach((p, i) => {
      position.setXYZ(i, p.x, p.y, p.z);
      colour.setXYZW(i, r, g, b, (0.8 * i) / this.trailPoints.length);
    });
    this.trail.geometry.setDrawRange(0, this.trailPoints.length);
    position.needsUpdate = colour.needsUpdate = true;
  }

  /** The shown wrench at the hand, and beside it the raw one if that is wanted. */
  setWrench(at: THREE.Vector3, wrench: number[], raw: number[] | null, scales: Scales): { force: THREE.Vector3; torque: THREE.Vector3 | null } {
    const force = setPair(this.force, this.torque, at, wrench, scales);
    if (raw) setPair(this.rawForce, this.rawTorque, at, raw, scales);
    else this.rawForce.root.visible = this.rawTorque.root.visible = false;
    return { force: at.clone().add(force), torque: this.torque.root.visible ? this.torque.tip : null };
  }

  /** The hands after the first, in view units. */
  setOthers(others: { hand: THREE.Vector3; proxy: THREE.Vector3; wrench: number[] }[], scales: Scales) {
    while (this.others.length < others.length) {
      const other = new SecondHand(this.materials);
      this.others.push(other);
      this.root.add(other.root);
    }
    this.others.forEach((other, i) => {
      other.root.visible = i < others.length;
      if (i < others.length) other.set(others[i].hand, others[i].proxy, others[i].wrench, scales);
    });
  }

  /** The spring from where the part was taken to where the pointer is. */
  setPull(from: THREE.Vector3 | null, to: THREE.Vector3 | null) {
    this.pull.mesh.visible = false;
    if (from && to) this.pull.set(from, to);
  }

  setContacts(contacts: Contact[], pushes: Push[], grasped: number, toView: THREE.Matrix4, scales: Scales) {
    const count = Math.min(contacts.length, mostContacts);
    const at = new THREE.Vector3();
    const along = new THREE.Vector3();
    const turn = new THREE.Quaternion();
    const size = new THREE.Vector3();
    const matrix = new THREE.Matrix4();
    const corners = new Map<string, THREE.Vector3[]>();
    for (let i = 0; i < count; ++i) {
      const contact = contacts[i];
      at.fromArray(contact.p).applyMatrix4(toView);
      along.fromArray(contact.n);
      if (contact.bodies[1] === grasped) along.negate(); // what acts on the held part
      turn.setFromUnitVectors(up, along);
      const disc = contact.patch === this.chosen ? 0.02 : contact.force > 0 ? 0.012 : 0.007;
      this.discs.setMatrixAt(i, matrix.compose(at, turn, size.setScalar(disc)));
      const key = `${contact.patch}`;
      corners.set(key, [...(corners.get(key) ?? []), new THREE.Vector3().fromArray(contact.p).applyMatrix4(toView)]);
    }
    let arrows = 0;
    for (const push of pushes) {
      along.fromArray(push.force);
      const force = along.length();
      const length = Math.min(scales.longest, force * scales.force);
      if (length < 0.01 || arrows === mostContacts) continue;
      along.divideScalar(force);
      turn.setFromUnitVectors(up, along);
      at.fromArray(push.at).applyMatrix4(toView);
      const thick = push.patch === this.chosen ? 0.011 : 0.0075;
      const head = Math.min(0.024, length / 4);
      this.shafts.setMatrixAt(arrows, matrix.compose(at, turn, size.set(thick, length - 2.3 * head, thick)));
      for (const mesh of [this.shafts, this.heads]) mesh.setColorAt(arrows, this.gripColours[push.grip]);
      at.addScaledVector(along, length - 2.4 * head);
      this.heads.setMatrixAt(arrows++, matrix.compose(at, turn, size.setScalar(head)));
    }
    this.discs.count = count;
    this.shafts.count = this.heads.count = arrows;
    for (const mesh of [this.discs, this.shafts, this.heads]) mesh.instanceMatrix.needsUpdate = true;
    for (const { instanceColor } of [this.shafts, this.heads]) if (instanceColor) instanceColor.needsUpdate = true;
    this.setPatches([...corners.values()]);
  }

  /** Four points of a patch span it (mean and spread of its area): the quadrilateral through them. */
  private setPatches(patches: THREE.Vector3[][]) {
    const triangles: number[] = [];
    for (const points of patches) {
      if (points.length !== 4) continue;
      const [a, b, c, d] = points; // ends of one axis, ends of the other
      for (const p of [a, c, b, a, b, d]) triangles.push(p.x, p.y, p.z);
    }
    this.patches.geometry.dispose();
    this.patches.geometry = new THREE.BufferGeometry();
    this.patches.geometry.setAttribute("position", new THREE.Float32BufferAttribute(triangles, 3));
    this.patches.visible = triangles.length > 0;
  }
}
