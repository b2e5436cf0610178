// The view cube with its triad, in a corner of the scene: it turns with the camera, and a face that is pressed on becomes
// the side one looks from. The axes have the colours of the charts.
import * as THREE from "three";
import { lines } from "./look";

const faces: { name: string; normal: THREE.Vector3; up: THREE.Vector3 }[] = (
  [["right", [1, 0, 0], [0, 0, 1]], ["left", [-1, 0, 0], [0, 0, 1]], ["back", [0, 1, 0], [0, 0, 1]], ["front", [0, -1, 0], [0, 0, 1]],
    ["top", [0, 0, 1], [0, 1, 0]], ["bottom", [0, 0, -1], [0, -1, 0]]] as const
).map(([name, normal, up]) => ({ name, normal: new THREE.Vector3(...normal), up: new THREE.Vector3(...up) }));

function written(text: string, ink: string, ground: string | null): THREE.CanvasTexture {
  const sheet = document.createElement("canvas");
  sheet.width = sheet.height = 128;
  const ctx = sheet.getContext("2d") as CanvasRenderingContext2D;
  if (ground) {
    ctx.fillStyle = ground;
    ctx.fillRect(0, 0, 128, 128);
    ctx.strokeStyle = ink;
    ctx.lineWidth = 3;
    ctx.strokeRect(1, 1, 126, 126);
  }
  ctx.fillStyle = ink;
  ctx.font = ground ? "600 36px system-ui" : "700 96px system-ui";
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  ctx.fillText(text, 64, 68);
  const texture = new THREE.CanvasTexture(sheet);
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}

export class ViewCube {
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.OrthographicCamera(-1.15, 1.15, 1.15, -1.15, 0.1, 10);
  private readonly sides = new THREE.Group();
  private readonly axes = new THREE.Group();

  constructor(private readonly place: HTMLElement) {
    this.scene.add(this.sides, this.axes);
    this.camera.up.set(0, 0, 1);
  }

  setTheme(isDark: boolean) {
    for (const group of [this.sides, this.axes]) {
      for (const child of group.children as THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>[]) {
        child.material.map?.dispose();
        child.material.dispose();
      }
      group.clear();
    }
    const [ink, ground] = isDark ? ["#cdd8e2", "#263440"] : ["#31404d", "#f2f5f8"];
    for (const { name, normal, up } of faces) {
      const material = new THREE.MeshBasicMaterial({ map: written(name, ink, ground), toneMapped: false });
      const side = new THREE.Mesh(new THREE.PlaneGeometry(0.9, 0.9), material);
      const basis = new THREE.Matrix4().makeBasis(up.clone().cross(normal), up, normal);
      side.quaternion.setFromRotationMatrix(basis);
      side.position.copy(normal).multiplyScalar(0.45);
      side.userData.normal = normal;
      this.sides.add(side);
    }
    const palette = isDark ? lines.dark : lines.light;
    ["x", "y", "z"].forEach((name, i) => {
      const colour = palette[i];
      const along = new THREE.Vector3().setComponent(i, 1);
      const corner = new THREE.Vector3(-0.5, -0.5, -0.5);
      const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.035, 0.035, 1.15, 8), new THREE.MeshBasicMaterial({ color: colour, toneMapped: false }));
      shaft.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along);
      shaft.position.copy(corner).addScaledVector(along, 0.575);
      const label = new THREE.Sprite(new THREE.SpriteMaterial({ map: written(name, colour, null), toneMapped: false }));
      label.scale.setScalar(0.34);
      label.position.copy(corner).addScaledVector(along, 1.3);
      this.axes.add(shaft, label as unknown as THREE.Mesh);
    });
  }

  /** Over what has been drawn, where the page keeps room for it. */
  draw(renderer: THREE.WebGLRenderer, canvas: HTMLCanvasElement, camera: THREE.Camera) {
    const room = this.place.getBoundingClientRect();
    const whole = canvas.getBoundingClientRect();
    if (room.width === 0) return;
    this.camera.position.set(0, 0, 3).applyQuaternion(camera.quaternion);
    this.camera.quaternion.copy(camera.quaternion);
    const [left, bottom] = [room.left - whole.left, whole.bottom - room.bottom];
    renderer.autoClear = false;
    renderer.setScissorTest(true);
    renderer.setViewport(left, bottom, room.width, room.height);
    renderer.setScissor(left, bottom, room.width, room.height);
    renderer.clearDepth();
    renderer.render(this.scene, this.camera);
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, whole.width, whole.height);
    renderer.autoClear = true;
  }

  /** The side that is pressed on, as the direction to look from; null beside the cube. */
  pick(event: MouseEvent): THREE.Vector3 | null {
    const room = this.place.getBoundingClientRect();
    const at = new THREE.Vector2((2 * (event.clientX - room.left)) / room.width - 1, 1 - (2 * (event.clientY - room.top)) / room.height);
    const ray = new THREE.Raycaster();
    this.camera.updateMatrixWorld();
    ray.setFromCamera(at, this.camera);
    return (ray.intersectObjects(this.sides.children, false)[0]?.object.userData.normal as THREE.Vector3 | undefined) ?? null;
  }
}
