// Geometry of a model: all parts in one mesh, each vertex with its part.
// Invariant: one draw call per model and level of detail, for any number of people.
import {
  BufferAttribute,
  BufferGeometry,
  InstancedBufferGeometry,
} from 'three';
import type {Box, Model, Mesh, Part, Vec3} from './protocol.ts';
import {RIBBON_PEOPLE} from './shaders.ts';
import {largest, limbRibbons, partRibbons, simplified, sleeve, vertexNormals, type Ribbon} from './simplify.ts';
import {slotOf} from './theme.ts';

const HAIR = 3;

/** The shape of a part at each level of detail with meshes, finest first. */
const MESHES: ((part: Part) => Mesh)[] = [
  (part) => part.mesh,
  (part) => simplified(part.mesh, 0.028),
  (part) => sleeve(part.mesh, part.box, 6, 8),
  (part) => sleeve(part.mesh, part.box, 3, 5),
];
/** Ribbons in the shadows of the most distant people: the trunk and both legs. */
const SHADOW_RIBBONS = 3;

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

export interface BodyLevel {
  body: InstancedBufferGeometry;
  shadow: InstancedBufferGeometry;
  /** Whether the geometries are ribbons, for other shaders. */
  isRibbon: {body: boolean; shadow: boolean};
  /** Number for a body with its shadow. */
  triangles: number;
}

function trianglesOf(shape: InstancedBufferGeometry): number {
  return shape.index!.count / 3 / (shape.hasAttribute('member') ? RIBBON_PEOPLE : 1);
}

/** Returns a model's geometry at each level of detail, finest first. */
export function bodyLevels(model: Model): BodyLevel[] {
  const [full, close, near, middle] = MESHES.map((shape) => merged(model, shape));
  const parts = ribbons(partRibbons(model), model);
  const limbs = ribbons(limbRibbons(model), model);
  const few = ribbons(largest(limbRibbons(model), model, SHADOW_RIBBONS), model);
  const level = (body: InstancedBufferGeometry, shadow: InstancedBufferGeometry): BodyLevel => ({
    body: sharing(body),
    shadow: sharing(shadow),
    isRibbon: {body: body.hasAttribute('member'), shadow: shadow.hasAttribute('member')},
    triangles: trianglesOf(body) + trianglesOf(shadow),
  });
  return [level(full, middle), level(close, middle), level(near, parts), level(middle, parts), level(parts, limbs), level(limbs, few)];
}

/**
 * `normal` is the axis; `edge` is how far a corner lies aside and, seen along the axis, ahead of its end. One geometry
 * has the ribbons of several people: graphics cards draw small instances slowly.
 */
function ribbons(list: readonly Ribbon[], model: Model): InstancedBufferGeometry {
  const out: Merged = {positions: [], normals: [], partSlots: [], indices: []};
  const edges: number[] = [];
  const members: number[] = [];
  const append = (ends: Ribbon, member: number): void => {
    const base = out.positions.length / 3;
    ends.forEach(({part, at, axis, half_width_m}, end) => {
      const {name} = model.parts[part];
      const slot = /head/i.test(name) && end === 1 ? HAIR : slotOf(name);
      for (const side of [-1, 1]) {
        out.positions.push(...at);
        out.normals.push(...axis);
        out.partSlots.push(part, slot);
        edges.push(side * half_width_m, (end === 0 ? -1 : 1) * half_width_m);
        members.push(member);
      }
    });
    out.indices.push(base, base + 1, base + 2, base + 2, base + 1, base + 3);
  };
  for (let member = 0; member < RIBBON_PEOPLE; ++member) for (const ends of list) append(ends, member);
  const geometry = geometryOf(out);
  geometry.setAttribute('edge', new BufferAttribute(new Float32Array(edges), 2));
  geometry.setAttribute('member', new BufferAttribute(new Float32Array(members), 1));
  return geometry;
}

function merged(model: Model, shape: (part: Part) => Mesh): InstancedBufferGeometry {
  const out: Merged = {positions: [], normals: [], partSlots: [], indices: []};
  model.parts.forEach((part, index) => append(out, shape(part), part, index));
  return geometryOf(out);
}

function geometryOf(out: Merged): InstancedBufferGeometry {
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(out.positions), 3));
  geometry.setAttribute('normal', new BufferAttribute(new Float32Array(out.normals), 3));
  geometry.setAttribute('partSlot', new BufferAttribute(new Float32Array(out.partSlots), 2));
  geometry.setIndex(out.indices);
  return geometry;
}

/** Returns a geometry that shares vertices with `shape`, for another list of people. */
function sharing(shape: InstancedBufferGeometry): InstancedBufferGeometry {
  const geometry = new InstancedBufferGeometry();
  for (const [name, attribute] of Object.entries(shape.attributes)) geometry.setAttribute(name, attribute);
  geometry.setIndex(shape.index);
  return geometry;
}

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

/** Returns the twelve edges of each part's box; the graphics card turns them into world-aligned boxes. */
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

/** PeopleList is a range in the order of visible people, which several geometries draw. */
export class PeopleList {
  count = 0;
  /** The uniform of the first one. */
  readonly first = {value: 0};
  private readonly geometries: InstancedBufferGeometry[] = [];

  drives(geometry: InstancedBufferGeometry): InstancedBufferGeometry {
    geometry.instanceCount = 0;
    this.geometries.push(geometry);
    return geometry;
  }

  /** Draws `count` people from `first` on; returns the end of the range, to which the last instances reach. */
  place(first: number): number {
    this.first.value = first;
    const instances = Math.ceil(this.count / RIBBON_PEOPLE);
    for (const geometry of this.geometries)
      geometry.instanceCount = geometry.hasAttribute('member') ? instances : this.count;
    return first + instances * RIBBON_PEOPLE;
  }
}

/** Returns the axis-aligned box of a mesh in its own frame. */
export function boxOf(mesh: Mesh): Box {
  const low: Vec3 = [Infinity, Infinity, Infinity];
  const high: Vec3 = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < mesh.positions.length; ++i) {
    low[i % 3] = Math.min(low[i % 3], mesh.positions[i]);
    high[i % 3] = Math.max(high[i % 3], mesh.positions[i]);
  }
  const half = (sign: number): Vec3 => [0, 1, 2].map((axis) => (high[axis] + sign * low[axis]) / 2) as Vec3;
  return {centre_m: half(1), half_m: half(-1)};
}

/** Returns the mesh of an obstacle. Corners are not shared, which keeps flat faces flat. */
export function solidGeometry(mesh: Mesh): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
  geometry.setIndex(new BufferAttribute(mesh.indices, 1));
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}
