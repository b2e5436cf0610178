// The scene's force fields: arrows on the lattice that the program sends with the scene. The longest is as long as the
// lattice is wide, the others go by the root of their force, so that weak places still tell their direction.
import * as THREE from "three";

const up = new THREE.Vector3(0, 1, 0);
const numbersAnArrow = 6; // place and force

export class FieldArrows {
  readonly root = new THREE.Group();
  private readonly material = new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.55, toneMapped: false, depthWrite: false });
  private shown = true;

  setColour(colour: number) {
    this.material.color.set(colour);
  }

  show(on: boolean) {
    this.root.visible = this.shown = on;
  }

  /** How many are drawn: those that are not too short to be seen. */
  get count(): number {
    return this.shown && this.root.children.length > 0 ? (this.root.children[0] as THREE.InstancedMesh).count : 0;
  }

  /** The arrows of a scene, in view units; none of a scene without fields. */
  set(field: number[], toView: THREE.Matrix4) {
    for (const mesh of this.root.children as THREE.InstancedMesh[]) {
      mesh.geometry.dispose();
      mesh.dispose();
    }
    this.root.clear();
    const total = Math.floor(field.length / numbersAnArrow);
    if (total < 2) return;
    const place = (i: number) => new THREE.Vector3().fromArray(field, numbersAnArrow * i).applyMatrix4(toView);
    const width = place(0).distanceTo(place(1));
    const force = (i: number) => new THREE.Vector3().fromArray(field, numbersAnArrow * i + 3);
    let strongest = 0;
    for (let i = 0; i < total; ++i) strongest = Math.max(strongest, force(i).length());
    if (strongest === 0) return;
    const thick = 0.02 * width;
    const shafts = new THREE.InstancedMesh(new THREE.CylinderGeometry(1, 1, 1, 6), this.material, total);
    const heads = new THREE.InstancedMesh(new THREE.ConeGeometry(1, 2.4, 8), this.material, total);
    const matrix = new THREE.Matrix4();
    const turn = new THREE.Quaternion();
    const size = new THREE.Vector3();
    let drawn = 0;
    for (let i = 0; i < total; ++i) {
      const along = force(i);
      const strength = along.length();
      const length = 0.9 * width * Math.sqrt(strength / strongest);
      if (length < 4 * thick) continue;
      along.divideScalar(strength);
      turn.setFromUnitVectors(up, along);
      const at = place(i); // the arrow's middle
      const head = Math.min(2.5 * thick, length / 5);
      shafts.setMatrixAt(drawn, matrix.compose(at, turn, size.set(thick, length - 2 * head, thick)));
      at.addScaledVector(along, 0.5 * length - head);
      heads.setMatrixAt(drawn++, matrix.compose(at, turn, size.setScalar(head)));
    }
    shafts.count = heads.count = drawn;
    for (const mesh of [shafts, heads]) {
      mesh.frustumCulled = false;
      mesh.renderOrder = 4;
      this.root.add(mesh);
    }
  }
}
