// The geometry of a model: all its parts in one mesh, each vertex knowing its part.
// One rule: one draw call a model and level of detail, however many people there are.
import {
  BufferAttribute,
  BufferGeometry,
  DynamicDrawUsage,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
} from 'three';
import type {Model, Mesh, Part, Run} from './protocol.ts';
import {simplified, vertexNormals} from './simplify.ts';
import {slotOf} from './theme.ts';

const HAIR = 3;

/** Edges of clustering cells, finest first, metres. */
export const CELLS_M = [0, 0.028, 0.07, 0.12];

interface Merged {
  positions: number[];
  normals: number[];
  partSlots: number[];
  indices: number[];
}

function hasHair(part: Part, x: number, z: number): boolean {
  const {centre_m, half_m} = part.box;
  const up = (z - centre_m[2]) / half_m[2];
  const ahead = (x - centre_m[0]) / half_m[0];
  return up > 0.5 || (ahead < -0.1 && up > -0.35);
}

function append(out: Merged, mesh: Mesh, part: Part, index: number): void {
  const base = out.positions.length / 3;
  const normals = vertexNormals(mesh);
  const slot = slotOf(part.name);
  for (let v = 0; v < mesh.positions.length; v += 3) {
    const [x, y, z] = [mesh.positions[v], mesh.positions[v + 1], mesh.positions[v + 2]];
    out.positions.push(x, y, z);
    out.normals.push(normals[v], normals[v + 1], normals[v + 2]);
    out.partSlots.push(index, /head/i.test(part.name) && hasHair(part, x, z) ? HAIR : slot);
  }
  for (const i of mesh.indices) out.indices.push(base + i);
}

export function bodyGeometry(model: Model, cell_m: number): InstancedBufferGeometry {
  const out: Merged = {positions: [], normals: [], partSlots: [], indices: []};
  model.parts.forEach((part, index) => {
    append(out, cell_m > 0 ? simplified(part.mesh, cell_m) : part.mesh, part, index);
  });
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(out.positions), 3));
  geometry.setAttribute('normal', new BufferAttribute(new Float32Array(out.normals), 3));
  geometry.setAttribute('partSlot', new BufferAttribute(new Float32Array(out.partSlots), 2));
  geometry.setIndex(out.indices);
  return geometry;
}

/** The lines of all or-DOPs of a model. */
export function hullGeometry(model: Model): InstancedBufferGeometry {
  const positions: number[] = [];
  const parts: number[] = [];
  const indices: number[] = [];
  model.parts.forEach((part, index) => {
    const base = parts.length;
    positions.push(...part.hull.positions);
    for (let v = 0; v < part.hull.positions.length; v += 3) parts.push(index);
    for (const i of part.hull.indices) indices.push(base + i);
  });
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
  geometry.setAttribute('part', new BufferAttribute(new Float32Array(parts), 1));
  geometry.setIndex(indices);
  return geometry;
}

/** The twelve edges of a box for each part; the card turns them into the box along the world's axes. */
export function boxGeometry(model: Model): InstancedBufferGeometry {
  const corners: number[] = [];
  const centres: number[] = [];
  const halves: number[] = [];
  const parts: number[] = [];
  const indices: number[] = [];
  model.parts.forEach((part, index) => {
    const base = parts.length;
    for (let corner = 0; corner < 8; ++corner) {
      corners.push(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      centres.push(...part.box.centre_m);
      halves.push(...part.box.half_m);
      parts.push(index);
      for (const bit of [1, 2, 4]) if (!(corner & bit)) indices.push(base + corner, base + corner + bit);
    }
  });
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(corners), 3));
  geometry.setAttribute('centre', new BufferAttribute(new Float32Array(centres), 3));
  geometry.setAttribute('halfSize', new BufferAttribute(new Float32Array(halves), 3));
  geometry.setAttribute('part', new BufferAttribute(new Float32Array(parts), 1));
  geometry.setIndex(indices);
  return geometry;
}

/** A list of people to draw, shared by the geometries that draw them. */
export class Instances {
  count = 0;
  readonly attribute: InstancedBufferAttribute;
  private readonly geometries: InstancedBufferGeometry[] = [];

  constructor(capacity: number) {
    this.attribute = new InstancedBufferAttribute(new Float32Array(3 * Math.max(1, capacity)), 3);
    this.attribute.setUsage(DynamicDrawUsage);
  }

  drives(geometry: InstancedBufferGeometry): InstancedBufferGeometry {
    geometry.setAttribute('instance', this.attribute);
    geometry.instanceCount = 0;
    this.geometries.push(geometry);
    return geometry;
  }

  clear(): void {
    this.count = 0;
  }

  add(run: Run, avatar: number): void {
    this.attribute.setXYZ(this.count++, avatar, run.firstPart[avatar], run.scaleOfAvatar[avatar]);
  }

  done(): void {
    for (const geometry of this.geometries) geometry.instanceCount = this.count;
    this.attribute.clearUpdateRanges();
    this.attribute.addUpdateRange(0, 3 * this.count);
    this.attribute.needsUpdate = true;
  }
}

/** A mesh of its own, for obstacles. Flat faces stay flat: corners are not shared. */
export function solidGeometry(mesh: Mesh): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
  geometry.setIndex(new BufferAttribute(mesh.indices, 1));
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}
