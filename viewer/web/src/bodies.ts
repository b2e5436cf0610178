// The bodies: one instanced mesh a shape, however many bodies have it; far ones by a simplified copy.
import * as THREE from "three";
import { edgeGeometry, farGeometry, featureGeometry, nearGeometry } from "./geometry";
import { edgeKinds, type Look } from "./look";
import type { Run, Shape } from "./protocol";

const farPixels = 70; // a body smaller than this on the screen is far
const mostWithEdges = 80; // bodies

interface Drawn {
  shape: Shape; bodies: number[]; near: THREE.InstancedMesh; far: THREE.InstancedMesh | null; radius: number; glass: boolean;
}

export type Glass = "auto" | "all" | "none";
// Of the six middles of the sides of a held part's box: so many hidden ones make a part transparent, and keep it so.
const [becomesGlass, staysGlass] = [3, 2];
const hiddenBy = 0.01; // view units that the hiding surface is nearer

export class Bodies {
  readonly root = new THREE.Group();
  readonly matrices: THREE.Matrix4[];
  private readonly drawn: Drawn[] = [];
  private readonly edges: (THREE.LineSegments | null)[];
  private readonly material: THREE.MeshStandardMaterial;
  private readonly glass: THREE.MeshStandardMaterial;
  private readonly edgeMaterial = new THREE.LineBasicMaterial({ transparent: true });
  private readonly mark = new THREE.Group();
  private readonly markMaterial = new THREE.MeshBasicMaterial({
    transparent: true, opacity: 0.55, depthTest: false, side: THREE.DoubleSide,
  });
  private pieces = false;
  private kinds = false;
  private glassFor: Glass = "auto";

  constructor(private readonly run: Run, private readonly shapes: Shape[], private look: Look) {
    this.matrices = run.bodies.map(() => new THREE.Matrix4());
    const open = shapes.some((shape) => shape.edgeKinds.includes(edgeKinds.findIndex((k) => k.name === "open")));
    this.material = new THREE.MeshStandardMaterial({
      metalness: 0.35, roughness: 0.42, side: open ? THREE.DoubleSide : THREE.FrontSide,
    });
    this.glass = new THREE.MeshStandardMaterial({
      metalness: 0.1, roughness: 0.3, transparent: true, opacity: 0.2, depthWrite: false, side: THREE.DoubleSide,
    });
    const withEdges = run.bodies.length <= mostWithEdges;
    // A body that is fixed stands apart from its kin, so that it can become glass.
    const groups = new Map<string, number[]>();
    run.bodies.forEach((body, i) => {
      const key = `${body.shape} ${body.moves}`;
      groups.set(key, [...(groups.get(key) ?? []), i]);
    });
    const geometries = shapes.map((shape) => ({ near: nearGeometry(shape), far: farGeometry(shape), edges: edgeGeometry(shape, edgeKinds.map((k) => k.colour)) }));
    for (const bodies of groups.values()) {
      const which = run.bodies[bodies[0]].shape;
      const { near, far } = geometries[which];
      this.drawn.push({
        shape: shapes[which], bodies, near: this.instanced(near, bodies.length), far: far && this.instanced(far, bodies.length),
        radius: near.boundingSphere?.radius ?? 1, glass: false,
      });
    }
    this.edges = run.bodies.map((body) => {
      if (!withEdges || shapes[body.shape].edges.length === 0) return null;
      const lines = new THREE.LineSegments(geometries[body.shape].edges, this.edgeMaterial);
      lines.matrixAutoUpdate = false;
      this.root.add(lines);
      return lines;
    });
    this.mark.matrixAutoUpdate = false;
    this.root.add(this.mark);
    this.setLook(look);
  }

  private instanced(geometry: THREE.BufferGeometry, count: number) {
    const mesh = new THREE.InstancedMesh(geometry, this.material, count);
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = false; // the bounds of an instanced mesh do not follow its instances
    this.root.add(mesh);
    return mesh;
  }

  colour(body: number): number {
    const { bodies, grasped } = this.run;
    if (body === grasped) return this.look.grasped;
    if (!bodies[body].moves) return this.look.fixed;
    const free = bodies.slice(0, body).filter((b, i) => b.moves && i !== grasped).length;
    return this.look.others[free % this.look.others.length];
  }

  setLook(look: Look) {
    this.look = look;
    this.edgeMaterial.color.set(this.kinds ? 0xffffff : look.edge);
    this.edgeMaterial.opacity = this.kinds ? 1 : look.edgeOpacity;
    this.markMaterial.color.set(look.chosen);
  }

  showPieces(on: boolean) {
    this.pieces = on;
    this.material.vertexColors = on;
    this.material.needsUpdate = true;
  }

  /** Colours the edges by their kind. */
  showKinds(on: boolean) {
    this.kinds = on;
    this.edgeMaterial.vertexColors = on;
    this.edgeMaterial.needsUpdate = true;
    this.setLook(this.look);
  }

  /** Which of the fixed parts are transparent: those that hide a held one, all, or none. */
  showThrough(which: Glass) {
    this.glassFor = which;
    for (const drawn of this.drawn) this.setGlass(drawn, which === "all" && !this.run.bodies[drawn.bodies[0]].moves);
  }

  private setGlass(drawn: Drawn, on: boolean) {
    if (drawn.glass === on) return;
    drawn.glass = on;
    for (const mesh of [drawn.near, drawn.far])
      if (mesh) {
        mesh.material = on ? this.glass : this.material;
        mesh.castShadow = !on;
      }
  }

  /** The names of the bodies that are transparent now. */
  get transparent(): string[] {
    return this.drawn.filter((d) => d.glass).flatMap((d) => d.bodies.map((body) => this.run.bodies[body].name));
  }

  /** Makes the fixed parts transparent that hide one of the held ones from the camera, whichever hand holds it. */
  showHiding(grasped: number[], camera: THREE.Camera, toView: THREE.Matrix4, mostTriangles: number) {
    if (this.glassFor !== "auto") return;
    const fixed = this.drawn.filter((d) => !this.run.bodies[d.bodies[0]].moves && d.shape.piece.length <= mostTriangles);
    const hidden = grasped.map((body) => this.sidesHidden(body, fixed, camera, toView));
    for (const drawn of this.drawn) {
      const count = Math.max(0, ...hidden.map((sides) => sides.get(drawn) ?? 0));
      this.setGlass(drawn, drawn.glass ? count >= staysGlass : count >= becomesGlass);
    }
  }

  /** How many of the middles of the sides of a held part's box each of `fixed` hides, by rays from the camera to them. */
  private sidesHidden(grasped: number, fixed: Drawn[], camera: THREE.Camera, toView: THREE.Matrix4): Map<Drawn, number> {
    const hidden = new Map<Drawn, number>();
    const own = this.drawn.find((d) => d.bodies.includes(grasped));
    const box = own?.near.geometry.boundingBox;
    if (!box) return hidden;
    const centre = box.getCenter(new THREE.Vector3());
    const toWorld = new THREE.Matrix4().copy(toView).multiply(this.matrices[grasped]);
    for (const side of [box.min, box.max])
      for (let axis = 0; axis < 3; ++axis) {
        const point = centre.clone().setComponent(axis, side.getComponent(axis)).applyMatrix4(toWorld);
        const away = point.distanceTo(camera.position);
        const ray = new THREE.Raycaster(camera.position, point.sub(camera.position).normalize(), 0, away - hiddenBy);
        for (const drawn of fixed)
          if (drawn !== own && ray.intersectObject(drawn.near, false).length > 0) hidden.set(drawn, (hidden.get(drawn) ?? 0) + 1);
      }
    return hidden;
  }

  /** Puts every body where it is; which copy is drawn depends on its size on the screen. */
  place(poses: Float32Array, camera: THREE.PerspectiveCamera, pixels: number, toView: THREE.Matrix4) {
    const q = new THREE.Quaternion();
    const p = new THREE.Vector3();
    const one = new THREE.Vector3(1, 1, 1);
    this.matrices.forEach((matrix, i) => {
      p.fromArray(poses, 7 * i);
      q.set(poses[7 * i + 4], poses[7 * i + 5], poses[7 * i + 6], poses[7 * i + 3]);
      matrix.compose(p, q, one);
      const lines = this.edges[i];
      if (lines) {
        lines.matrix.copy(matrix);
        lines.matrixWorldNeedsUpdate = true;
      }
    });
    const perRadian = pixels / (2 * Math.tan((camera.fov * Math.PI) / 360));
    const scale = toView.getMaxScaleOnAxis();
    const colour = new THREE.Color();
    for (const { bodies, near, far, radius } of this.drawn) {
      let nearCount = 0;
      let farCount = 0;
      for (const body of bodies) {
        p.setFromMatrixPosition(this.matrices[body]).applyMatrix4(toView);
        const size = (2 * radius * scale * perRadian) / Math.max(1e-3, p.distanceTo(camera.position));
        const mesh = far && size < farPixels ? far : near;
        const slot = mesh === near ? nearCount++ : farCount++;
        mesh.setMatrixAt(slot, this.matrices[body]);
        mesh.setColorAt(slot, this.pieces && mesh === near ? colour.set(0xffffff) : colour.set(this.colour(body)));
        if (mesh === near) near.userData[slot] = body;
      }
      near.count = nearCount;
      near.instanceMatrix.needsUpdate = true;
      if (near.instanceColor) near.instanceColor.needsUpdate = true;
      near.boundingSphere = null; // it is kept for picking, and the instances have moved
      if (!far) continue;
      far.count = farCount;
      far.instanceMatrix.needsUpdate = true;
      if (far.instanceColor) far.instanceColor.needsUpdate = true;
    }
  }

  /** The body under a ray, and where. */
  pick(ray: THREE.Raycaster): { body: number; point: THREE.Vector3 } | null {
    const solid = this.drawn.filter((d) => !d.glass);
    const hit = ray.intersectObjects(solid.map((d) => d.near), false)[0];
    if (!hit || hit.instanceId === undefined) return null;
    return { body: hit.object.userData[hit.instanceId] as number, point: hit.point };
  }

  /** Marks a piece, or a face of it. */
  markFeature(body: number | null, piece = -1, face: number | null = null) {
    for (const child of [...this.mark.children]) {
      this.mark.remove(child);
      (child as THREE.Mesh).geometry.dispose();
    }
    if (body === null || piece < 0) return;
    const shape = this.shapes[this.run.bodies[body].shape];
    const marked = shape.felt_by_surface ? shape.piece[piece] : piece; // there a contact names a triangle
    const mesh = new THREE.Mesh(featureGeometry(shape, marked, face), this.markMaterial);
    mesh.renderOrder = 5;
    this.mark.userData.body = body;
    this.mark.add(mesh);
    this.followMark();
  }
  followMark() {
    const body = this.mark.userData.body as number | undefined;
    if (body === undefined) return;
    this.mark.matrix.copy(this.matrices[body]);
    this.mark.matrixWorldNeedsUpdate = true;
  }

  /** A translucent copy of a body, for the ghost. */
  copyOf(body: number, material: THREE.Material): THREE.Mesh {
    const drawn = this.drawn.find((d) => d.bodies.includes(body)) as Drawn;
    const mesh = new THREE.Mesh(drawn.near.geometry, material);
    mesh.matrixAutoUpdate = false;
    return mesh;
  }

  dispose() {
    for (const { near, far } of this.drawn) {
      near.geometry.dispose();
      near.dispose();
      far?.geometry.dispose();
      far?.dispose();
    }
    this.edges.forEach((lines) => lines?.geometry.dispose());
  }
}
