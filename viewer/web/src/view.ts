// The scene view: camera, light, ground, and what is drawn in it. View units: the scene's radius is one.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Bodies } from "./bodies";
import { ViewCube } from "./cube";
import { FieldArrows } from "./field";
import { dark, light, type Look } from "./look";
import { Overlay } from "./overlay";
import type { Grip, Picture, Pose, Run, Shape, Vec } from "./protocol";
import { pushesOf } from "./pushes";
import { withUnit } from "./units";

export type ViewName = "iso" | "front" | "side" | "top";
const directions: Record<ViewName, Vec> = { iso: [0.75, -1.25, 0.95], front: [0.02, -1, 0.12], side: [1, -0.02, 0.12], top: [0, -0.001, 1] };

function matrixOf(pose: Pose): THREE.Matrix4 {
  const [w, x, y, z] = pose.q;
  return new THREE.Matrix4().compose(new THREE.Vector3(...pose.p), new THREE.Quaternion(x, y, z, w), new THREE.Vector3(1, 1, 1));
}
function matrixAt(poses: Float32Array, i: number): THREE.Matrix4 {
  const v = poses.subarray(7 * i, 7 * i + 7);
  return matrixOf({ p: [v[0], v[1], v[2]], q: [v[3], v[4], v[5], v[6]] });
}

/** Sizes that arrows can be given: newtons for the side of a square of the grid, and the torque of half a turn of an arc. */
const arrowSizes = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
const usualSize = arrowSizes.indexOf(1);
const torqueOfSize = 0.1; // half a turn, for each newton of a square [N m/N]
const longestArrow = 1.5; // view units
const glassEvery_ms = 250;
const mostTriangles = 60000; // of a part that is asked whether it hides another

/** A round number just below: 1, 2 or 5 times a power of ten. */
function round125(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = value / power;
  return power * (digit >= 5 ? 5 : digit >= 2 ? 2 : 1);
}

/** Room light for reflections: a bright ceiling, softer walls, a dark floor. No picture is loaded for it. */
function roomLight(): THREE.Scene {
  const room = new THREE.Scene();
  const add = (w: number, h: number, colour: number, strength: number, at: Vec) => {
    const material = new THREE.MeshBasicMaterial({ color: new THREE.Color(colour).multiplyScalar(strength), side: THREE.DoubleSide });
    const panel = new THREE.Mesh(new THREE.PlaneGeometry(w, h), material);
    panel.position.set(...at);
    panel.lookAt(0, 0, 0);
    room.add(panel);
  };
  const walls = new THREE.Mesh(new THREE.BoxGeometry(20, 20, 14), new THREE.MeshBasicMaterial({ color: 0x46525e, side: THREE.BackSide }));
  room.add(walls);
  add(9, 5, 0xfff4e6, 7, [-2, -3, 6.5]);
  add(3, 6, 0xdcecff, 5, [9, -2, 2]);
  add(3, 6, 0xffffff, 3, [-9, 3, 2]);
  add(8, 2, 0xcfe4ff, 3, [0, 9, 4]);
  return room;
}

/** Whether the browser has no graphics card to draw with. */
function drawnBySoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  return !gl || !info || /swiftshader|llvmpipe|software/i.test(String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)));
}

export class View {
  readonly camera = new THREE.PerspectiveCamera(32, 1, 0.02, 60);
  readonly controls: OrbitControls;
  readonly overlay: Overlay;
  readonly field = new FieldArrows();
  bodies: Bodies | null = null;
  /** World to view, and back. */
  readonly toView = new THREE.Matrix4();
  readonly toWorld = new THREE.Matrix4();
  scale = 1; // view units a metre
  picture: Picture | null = null;
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly world = new THREE.Group();
  private readonly sun = new THREE.DirectionalLight(0xfff1de, 2.6);
  private readonly fill = new THREE.HemisphereLight(0xe6eff8, 0x59636d, 0.55);
  /** Takes shadows only: what lies behind the scene is the page's own background. */
  private readonly floor = new THREE.Mesh(new THREE.CircleGeometry(6, 48), new THREE.ShadowMaterial({ color: 0x000000 }));
  private grid: THREE.LineSegments | null = null;
  private spacing = 0; // of the grid [m]
  private readonly box = new THREE.Box3(); // of the scene as it starts
  private look: Look = dark;
  private run: Run | null = null;
  private ghost: THREE.Mesh | null = null;
  private readonly X_HB = new THREE.Matrix4(); // held body from the handle
  private arrowSize = usualSize; // index into arrowSizes
  private readonly cube: ViewCube;
  private lastGlass = 0;
  private readonly forceLabel = document.createElement("span");
  private readonly torqueLabel = document.createElement("span");
  private floorZ = 0;
  onDraw: (() => void) | null = null;
  /** Whether it is drawn with less care, since without a graphics card every pixel costs. */
  readonly plain = drawnBySoftware() && location.hash !== "#fine";

  constructor(private readonly canvas: HTMLCanvasElement, labels: HTMLElement, private readonly scaleNote: HTMLElement, cube: HTMLElement) {
    this.cube = new ViewCube(cube);
    cube.addEventListener("click", (event) => {
      const side = this.cube.pick(event);
      if (side) this.look_along(side.clone().addScaledVector(new THREE.Vector3(0, -1, 0), Math.abs(side.z) > 0.5 ? 1e-3 : 0));
    });
    canvas.addEventListener("dblclick", (event) => {
      const hit = this.bodies?.pick(this.rayAt(event.clientX, event.clientY));
      if (hit) this.controls.target.copy(hit.point);
    });
    const plain = this.plain;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !plain, alpha: true });
    this.renderer.setPixelRatio(Math.min(plain ? 1 : 2, devicePixelRatio));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = plain ? THREE.BasicShadowMap : THREE.PCFSoftShadowMap;
    this.renderer.toneMapping = THREE.NeutralToneMapping;
    this.renderer.toneMappingExposure = 1.1;
    const room = new THREE.PMREMGenerator(this.renderer);
    this.scene.environment = room.fromScene(roomLight(), 0.02).texture;
    this.scene.environmentIntensity = 0.75;
    room.dispose();
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.zoomToCursor = true;
    this.controls.mouseButtons.MIDDLE = THREE.MOUSE.ROTATE; // as in CAD
    this.controls.minDistance = 0.4;
    this.controls.maxDistance = 20;
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.setScalar(plain ? 1024 : 2048);
    this.sun.shadow.camera.left = this.sun.shadow.camera.bottom = -1.7;
    this.sun.shadow.camera.right = this.sun.shadow.camera.top = 1.7;
    this.sun.shadow.camera.near = 0.5;
    this.sun.shadow.camera.far = 9;
    this.sun.shadow.bias = -0.0006;
    this.sun.shadow.normalBias = 0.006;
    this.sun.shadow.radius = 5;
    this.sun.position.set(-1.6, -2.1, 3.6);
    this.floor.receiveShadow = true;
    this.overlay = new Overlay(dark);
    this.scene.add(this.sun, this.fill, this.floor, this.world, this.overlay.root, this.field.root);
    this.world.matrixAutoUpdate = false;
    for (const label of [this.forceLabel, this.torqueLabel]) labels.append(label);
    this.forceLabel.className = "force";
    this.torqueLabel.className = "torque";
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  private resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  begin(run: Run, shapes: Shape[]) {
    const again = this.run?.scene === run.scene;
    this.run = run;
    if (this.bodies) {
      this.world.remove(this.bodies.root);
      this.bodies.dispose();
    }
    this.bodies = new Bodies(run, shapes, this.look);
    this.world.add(this.bodies.root);
    this.X_HB.copy(matrixOf(run.X_BH)).invert();
    this.fit(run, shapes);
    this.field.set(run.field, this.toView);
    this.overlay.clearTrail();
    this.hold(run.grasped);
    this.picture = null;
    if (!again) this.look_from("iso");
  }

  /** The hand has this body now; -1: none. */
  private hold(body: number) {
    if (!this.run || !this.bodies) return;
    this.run.grasped = body;
    this.ghost?.removeFromParent();
    this.ghost = body >= 0 ? this.bodies.copyOf(body, this.overlay.ghostMaterial) : null;
    if (this.ghost) this.bodies.root.add(this.ghost);
    this.overlay.setGhost(this.ghost, body >= 0 || this.run.picks);
  }

  private fit(run: Run, shapes: Shape[]) {
    const box = new THREE.Box3();
    const point = new THREE.Vector3();
    run.bodies.forEach((body) => {
      const X_WB = matrixOf(body.X_WB);
      const { vertices } = shapes[body.shape];
      const step = 3 * Math.max(1, Math.floor(vertices.length / 3 / 20000));
      for (let i = 0; i + 2 < vertices.length; i += step) box.expandByPoint(point.fromArray(vertices, i).applyMatrix4(X_WB));
    });
    const centre = box.getCenter(new THREE.Vector3());
    const radius = Math.max(1e-4, 0.5 * box.getSize(point).length());
    this.scale = 1 / radius;
    this.toView.makeScale(this.scale, this.scale, this.scale).multiply(new THREE.Matrix4().makeTranslation(centre.clone().negate()));
    this.toWorld.copy(this.toView).invert();
    this.box.copy(box).applyMatrix4(this.toView);
    this.world.matrix.copy(this.toView);
    this.world.matrixWorldNeedsUpdate = true;
    this.floorZ = (box.min.z - centre.z) * this.scale - 0.004;
    this.floor.position.z = this.floorZ - 0.002;
    this.drawGrid(radius);
  }

  /** Lines a round length apart, fading outward. */
  private drawGrid(radius: number) {
    if (this.grid) {
      this.scene.remove(this.grid);
      this.grid.geometry.dispose();
    }
    this.spacing = round125(radius / 3);
    const step = this.spacing * this.scale;
    const lines = Math.ceil(3.4 / step);
    const gridHalf = lines * step;
    const points: number[] = [];
    const colours: number[] = [];
    const { r, g, b } = new THREE.Color(this.look.grid);
    const put = (x: number, y: number) => {
      points.push(x, y, this.floorZ);
      colours.push(r, g, b, 0.75 * Math.max(0, 1 - (x * x + y * y) / (gridHalf * gridHalf)));
    };
    for (let i = -lines; i <= lines; ++i)
      for (let k = -lines; k < lines; ++k) {
        put(i * step, k * step);
        put(i * step, (k + 1) * step);
        put(k * step, i * step);
        put((k + 1) * step, i * step);
      }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
    geometry.setAttribute("color", new THREE.Float32BufferAttribute(colours, 4));
    this.grid = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false, toneMapped: false }));
    this.scene.add(this.grid);
  }

  setTheme(isDark: boolean) {
    this.look = isDark ? dark : light;
    this.floor.material.opacity = isDark ? 0.55 : 0.28;
    this.scene.environmentIntensity = isDark ? 0.9 : 1.1;
    this.overlay.setLook(this.look);
    this.field.setColour(this.look.trail);
    this.bodies?.setLook(this.look);
    this.cube.setTheme(isDark);
    if (this.grid && this.run) this.drawGrid(1 / this.scale);
  }

  look_from(name: ViewName) {
    this.look_along(new THREE.Vector3(...directions[name]));
  }

  /** From that side, with everything in view. */
  private look_along(side: THREE.Vector3) {
    const direction = side.clone().normalize();
    this.controls.target.set(0, 0, 0);
    this.stepBack(direction);
    // In the middle: what is seen from above stands higher on the screen than its middle.
    const { top, bottom } = this.extent();
    const up = new THREE.Vector3(0, 1, 0).applyQuaternion(this.camera.quaternion);
    const shift = 0.5 * (top + bottom) * Math.tan((this.camera.fov * Math.PI) / 360) * this.camera.position.distanceTo(this.controls.target);
    this.controls.target.addScaledVector(up, shift);
    this.stepBack(direction);
    this.controls.update();
  }

  /** As near as it can be with everything in view. */
  private stepBack(direction: THREE.Vector3) {
    let near = 0.8;
    let far = 12;
    for (let i = 0; i < 20; ++i) {
      const middle = 0.5 * (near + far);
      this.camera.position.copy(this.controls.target).addScaledVector(direction, middle);
      this.camera.lookAt(this.controls.target);
      this.camera.updateMatrixWorld();
      const { top, bottom, side } = this.extent();
      if (side < 0.92 && top < 0.84 && bottom > -0.84) far = middle;
      else near = middle;
    }
  }

  /** How far the scene's box reaches on the screen; the borders are at one. */
  private extent() {
    const { min, max } = this.box;
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) =>
      new THREE.Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z).project(this.camera));
    return {
      top: Math.max(...corners.map((c) => c.y)), bottom: Math.min(...corners.map((c) => c.y)),
      side: Math.max(...corners.map((c) => Math.abs(c.x))),
    };
  }

  /** Of the surfaces that push and rub, as shown now. */
  grips: Grip[] = [];

  show(picture: Picture, live: boolean) {
    this.picture = picture;
    if (!this.bodies || !this.run) return;
    if (this.run.picks && picture.body !== this.run.grasped) this.hold(picture.body);
    this.bodies.place(picture.bodies, this.camera, this.canvas.clientHeight, this.toView);
    this.bodies.followMark();
    const hand = this.pointOf(picture.hand);
    const proxy = this.pointOf(picture.proxy);
    const X_WH = matrixAt(picture.hand, 0);
    const turned = new THREE.Quaternion(picture.hand[4], picture.hand[5], picture.hand[6], picture.hand[3]).angleTo(
      new THREE.Quaternion(picture.proxy[4], picture.proxy[5], picture.proxy[6], picture.proxy[3]));
    const holds = this.run.grasped >= 0 && picture.grasped;
    this.overlay.setHand(hand, holds ? proxy : hand, holds ? X_WH.multiply(this.graspedFromHandle(picture)) : null, turned, live);
  }

  /** Where the held body sits in the handle's frame, as grasped now. */
  private graspedFromHandle(picture: Picture): THREE.Matrix4 {
    const grasped = this.run?.grasped ?? -1;
    return matrixAt(picture.proxy, 0).invert().multiply(matrixAt(picture.bodies, grasped));
  }

  /** The wrench at the hand (and the raw one beside it), and the contacts' share, all at the one scale. */
  showWrench(wrench: number[], raw: number[] | null) {
    if (!this.picture || !this.run) return;
    const force = Math.hypot(wrench[0], wrench[1], wrench[2]);
    const torque = Math.hypot(wrench[3], wrench[4], wrench[5]);
    const pushes = pushesOf(this.picture, this.run.grasped);
    const scales = this.arrowScales();
    const hand = this.pointOf(this.picture.proxy);
    const tips = this.overlay.setWrench(hand, wrench, raw, scales);
    this.overlay.setOthers(this.picture.others.map((other) =>
      ({ hand: this.pointOf(other.hand), proxy: this.pointOf(other.proxy), wrench: other.wrench })), scales);
    this.overlay.setContacts(this.picture.contacts, pushes, this.run.grasped, this.toView, scales);
    const [x, y] = this.label(this.forceLabel, tips.force, withUnit(force, "N"), force * scales.force > 0.03);
    this.label(this.torqueLabel, tips.torque, withUnit(torque, "N m"), tips.torque !== null, [x, y]);
    this.grips = pushes.filter((push) => push.grip !== "none" && Math.hypot(...push.force) > 0).map((push) => push.grip);
    const square = arrowSizes[this.arrowSize];
    const longest = Math.max(force, ...pushes.map((push) => Math.hypot(...push.force)), Math.hypot(...(raw?.slice(0, 3) ?? [0])));
    const cut = longest * scales.force > longestArrow ? ", the longest are cut off" : "";
    const note = this.run.grasped < 0 && !this.run.picks ? "" :
      ` · arrows: ${withUnit(square, "N")} as long as a square, arcs: ${withUnit(square * torqueOfSize, "N m")} for half a turn${cut}`;
    this.scaleNote.textContent = `grid ${withUnit(this.spacing, "m")}${note}`;
  }

  /** The same for every force of a scene, until people change it: what looks large is large. */
  private arrowScales() {
    const square = arrowSizes[this.arrowSize];
    return { force: (this.spacing * this.scale) / square, torque: Math.PI / (square * torqueOfSize), longest: longestArrow };
  }

  /** Longer or shorter arrows, by the next of the sizes. */
  scaleArrows(longer: boolean) {
    this.arrowSize = Math.min(arrowSizes.length - 1, Math.max(0, this.arrowSize + (longer ? -1 : 1)));
  }

  /** Makes the fixed parts that hide what the hands hold transparent, and the others solid again. */
  private lookThrough() {
    const time = performance.now();
    if (!this.bodies || !this.run || time - this.lastGlass < glassEvery_ms) return;
    this.lastGlass = time;
    const { grasped, other_hands } = this.run;
    const all = [grasped, ...other_hands.map((hand) => hand.grasped)].filter((body) => body >= 0);
    this.bodies.showHiding(all, this.camera, this.toView, mostTriangles);
  }

  /** Puts a label beside a place, below another one that stands there; where it is put. */
  private label(element: HTMLElement, at: THREE.Vector3 | null, text: string, visible: boolean, other?: [number, number]): [number, number] {
    element.hidden = !visible || !at;
    if (!visible || !at) return [-1000, -1000];
    element.textContent = text;
    const p = at.clone().project(this.camera);
    const x = Math.round((0.5 + 0.5 * p.x) * this.canvas.clientWidth + 10);
    let y = Math.round((0.5 - 0.5 * p.y) * this.canvas.clientHeight - 10);
    if (other && Math.abs(x - other[0]) < 80 && Math.abs(y - other[1]) < 21) y = other[1] + 21;
    element.style.transform = `translate(${x}px, ${y}px)`;
    return [x, y];
  }

  /** The place of a pose, in view units. */
  pointOf(pose: Float32Array): THREE.Vector3 {
    return new THREE.Vector3(pose[0], pose[1], pose[2]).applyMatrix4(this.toView);
  }

  /** Where the middle of a body is on the screen, in the window's pixels. */
  onScreen(body: number): [number, number] {
    const matrix = this.bodies?.matrices[body] ?? new THREE.Matrix4();
    const p = new THREE.Vector3().setFromMatrixPosition(matrix).applyMatrix4(this.toView).project(this.camera);
    const rect = this.canvas.getBoundingClientRect();
    return [rect.left + (0.5 + 0.5 * p.x) * rect.width, rect.top + (0.5 - 0.5 * p.y) * rect.height];
  }

  rayAt(x: number, y: number): THREE.Raycaster {
    const rect = this.canvas.getBoundingClientRect();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * (x - rect.left)) / rect.width - 1, 1 - (2 * (y - rect.top)) / rect.height), this.camera);
    return ray;
  }

  draw() {
    this.controls.update();
    this.onDraw?.();
    this.lookThrough();
    this.renderer.render(this.scene, this.camera);
    this.cube.draw(this.renderer, this.canvas, this.camera);
  }

  /** The view as a picture: `title` above; below the scale and `lines`; the labels where they are. */
  async png(title: string, lines: string[]): Promise<Blob> {
    this.draw();
    const unit = this.canvas.width / this.canvas.clientWidth;
    const texts = [...lines, this.scaleNote.textContent ?? ""];
    const [head, row] = [30 * unit, 19 * unit];
    const sheet = document.createElement("canvas");
    sheet.width = this.canvas.width;
    sheet.height = head + this.canvas.height + row * texts.length + 8 * unit;
    const ctx = sheet.getContext("2d") as CanvasRenderingContext2D;
    const css = (colour: number) => `#${colour.toString(16).padStart(6, "0")}`;
    ctx.fillStyle = css(this.look.sky);
    ctx.fillRect(0, 0, sheet.width, sheet.height);
    ctx.drawImage(this.canvas, 0, head);
    ctx.fillStyle = css(this.look.contact);
    ctx.font = `600 ${15 * unit}px system-ui`;
    ctx.fillText(title, 12 * unit, 20 * unit);
    for (const label of [this.forceLabel, this.torqueLabel].filter((one) => !one.hidden)) {
      const [x, y] = (label.style.transform.match(/-?\d+/g) ?? ["0", "0"]).map(Number);
      ctx.fillStyle = getComputedStyle(label).color;
      ctx.fillText(label.textContent ?? "", (x + 6) * unit, head + (y + 15) * unit);
    }
    ctx.fillStyle = css(this.look.contact);
    ctx.font = `${13 * unit}px system-ui`;
    texts.forEach((text, i) => ctx.fillText(text, 12 * unit, head + this.canvas.height + row * (i + 1) - 4 * unit));
    return await new Promise((resolve, reject) =>
      sheet.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("no picture"))), "image/png"));
  }
}
