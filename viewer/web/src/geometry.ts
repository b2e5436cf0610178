// From a part's surface to what is drawn: normals that are smooth over facets of a curved surface and sharp at edges,
// colours of the pieces, and a simplified copy for far away. Only for the eye: contact never sees any of it.
import * as THREE from "three";
import type { Shape } from "./protocol";

const smoothBelow = Math.cos(0.55); // facets that meet at less than this angle [rad] are one surface to the eye
const farFrom = 3000; // triangles from which a far copy pays
const farCells = 28; // along the longest side

/** Corners at the same place have the same number. */
function places(vertices: Float32Array): Uint32Array {
  const bits = new Uint32Array(vertices.buffer, vertices.byteOffset, vertices.length);
  const known = new Map<string, number>();
  const result = new Uint32Array(vertices.length / 3);
  for (let i = 0; i < result.length; ++i) {
    const key = `${bits[3 * i]},${bits[3 * i + 1]},${bits[3 * i + 2]}`;
    let number = known.get(key);
    if (number === undefined) known.set(key, (number = known.size));
    result[i] = number;
  }
  return result;
}

function facetNormals(shape: Shape): Float32Array {
  const { vertices: v, triangles: t } = shape;
  const normals = new Float32Array(t.length);
  for (let i = 0; i < t.length; i += 3) {
    const [a, b, c] = [3 * t[i], 3 * t[i + 1], 3 * t[i + 2]];
    const [ux, uy, uz] = [v[b] - v[a], v[b + 1] - v[a + 1], v[b + 2] - v[a + 2]];
    const [wx, wy, wz] = [v[c] - v[a], v[c + 1] - v[a + 1], v[c + 2] - v[a + 2]];
    normals[i] = uy * wz - uz * wy;
    normals[i + 1] = uz * wx - ux * wz;
    normals[i + 2] = ux * wy - uy * wx;
  }
  return normals; // as long as twice the area
}

/** A colour for a piece that differs from its neighbours'. */
function pieceColour(piece: number, colour: THREE.Color) {
  const golden = 0.61803398875;
  return colour.setHSL((0.08 + piece * golden) % 1, 0.5, 0.42 + 0.24 * ((piece * 0.37) % 1));
}

export function nearGeometry(shape: Shape): THREE.BufferGeometry {
  const { vertices, triangles } = shape;
  const place = places(vertices);
  const facets = facetNormals(shape);
  const at: number[][] = [];
  const drawn: number[] = []; // corners of the triangles that can be seen
  for (let corner = 0; corner < triangles.length; ++corner) {
    if (shape.covered[(corner - (corner % 3)) / 3]) continue;
    (at[place[triangles[corner]]] ??= []).push(corner - (corner % 3));
    drawn.push(corner);
  }
  const positions = new Float32Array(3 * drawn.length);
  const normals = new Float32Array(3 * drawn.length);
  const colours = new Float32Array(3 * drawn.length);
  const colour = new THREE.Color();
  const own = new THREE.Vector3();
  const other = new THREE.Vector3();
  const sum = new THREE.Vector3();
  drawn.forEach((corner, i) => {
    const vertex = triangles[corner];
    const facet = corner - (corner % 3);
    own.fromArray(facets, facet).normalize();
    sum.set(0, 0, 0);
    for (const neighbour of at[place[vertex]]) {
      other.fromArray(facets, neighbour);
      const length = other.length();
      if (length > 0 && other.dot(own) > smoothBelow * length) sum.add(other);
    }
    (sum.lengthSq() > 0 ? sum.normalize() : own).toArray(normals, 3 * i);
    for (let k = 0; k < 3; ++k) positions[3 * i + k] = vertices[3 * vertex + k];
    pieceColour(shape.piece[facet / 3], colour).toArray(colours, 3 * i);
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  geometry.computeBoundingSphere();
  geometry.computeBoundingBox();
  return geometry;
}

/** Corners within one cell of a grid become one; null where that would save nothing. */
export function farGeometry(shape: Shape): THREE.BufferGeometry | null {
  const { vertices, triangles } = shape;
  if (triangles.length / 3 < farFrom) return null;
  const box = new THREE.Box3().setFromArray(vertices);
  const size = box.getSize(new THREE.Vector3());
  const cell = Math.max(size.x, size.y, size.z) / farCells;
  const cells = new Map<number, number>();
  const corners: number[] = [];
  const counts: number[] = [];
  const cellOf = new Uint32Array(vertices.length / 3);
  for (let i = 0; i < cellOf.length; ++i) {
    const key = [0, 1, 2].reduce((k, a) => k * 64 + Math.floor((vertices[3 * i + a] - box.min.getComponent(a)) / cell), 0);
    let number = cells.get(key);
    if (number === undefined) {
      cells.set(key, (number = counts.length));
      counts.push(0);
      corners.push(0, 0, 0);
    }
    ++counts[number];
    for (let k = 0; k < 3; ++k) corners[3 * number + k] += vertices[3 * i + k];
    cellOf[i] = number;
  }
  counts.forEach((count, i) => [0, 1, 2].forEach((k) => (corners[3 * i + k] /= count)));
  const index: number[] = [];
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [cellOf[triangles[i]], cellOf[triangles[i + 1]], cellOf[triangles[i + 2]]];
    if (a !== b && b !== c && a !== c) index.push(a, b, c);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  return geometry;
}

export function edgeGeometry(shape: Shape, kinds: readonly number[]): THREE.BufferGeometry {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(shape.edges, 3));
  const colours = new Float32Array(shape.edges.length);
  const colour = new THREE.Color();
  for (let end = 0; end < colours.length / 3; ++end) colour.set(kinds[shape.edgeKinds[end >> 1]]).toArray(colours, 3 * end);
  geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  return geometry;
}

/** The triangles of one piece, or of one face of it, for showing where a contact lies. */
export function featureGeometry(shape: Shape, piece: number, face: number | null): THREE.BufferGeometry {
  const corners: number[] = [];
  for (let t = 0; t < shape.piece.length; ++t) {
    if (shape.piece[t] !== piece || (face !== null && shape.face[t] !== face)) continue;
    for (let k = 0; k < 3; ++k) {
      const vertex = shape.triangles[3 * t + k];
      corners.push(shape.vertices[3 * vertex], shape.vertices[3 * vertex + 1], shape.vertices[3 * vertex + 2]);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
  return geometry;
}
