// Coarser meshes for distant people.
// Invariant: a simplified part stays near its original, and a person keeps all limbs.
import type {Box, Mesh, Model, Vec3} from './protocol.ts';

/** Exceeds the number of cells of a body part along an axis; its cube fits exactly into a double. */
const SPAN = 131_072;

/**
 * Vertex clustering (Rossignac and Borrel 1993): the vertices of a cell become their mean; collapsed
 * triangles are omitted.
 */
export function simplified(mesh: Mesh, cell_m: number): Mesh {
  const {positions, indices} = mesh;
  const cells = new Map<number, number>();
  const cellOf = new Uint32Array(positions.length / 3);
  const sums: number[] = [];
  for (let v = 0; v < cellOf.length; ++v) {
    const [x, y, z] = [positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]];
    const key = (Math.round(x / cell_m) * SPAN + Math.round(y / cell_m)) * SPAN + Math.round(z / cell_m);
    let cell = cells.get(key);
    if (cell === undefined) {
      cell = cells.size;
      cells.set(key, cell);
      sums.push(0, 0, 0, 0);
    }
    cellOf[v] = cell;
    sums[4 * cell] += x;
    sums[4 * cell + 1] += y;
    sums[4 * cell + 2] += z;
    sums[4 * cell + 3] += 1;
  }
  const coarse = new Float32Array(cells.size * 3);
  for (let c = 0; c < cells.size; ++c)
    for (let i = 0; i < 3; ++i) coarse[3 * c + i] = sums[4 * c + i] / sums[4 * c + 3];
  const triangles: number[] = [];
  const seen = new Set<number>();
  for (let t = 0; t + 2 < indices.length; t += 3) {
    const [a, b, c] = [cellOf[indices[t]], cellOf[indices[t + 1]], cellOf[indices[t + 2]]];
    if (a === b || b === c || c === a) continue;
    const low = Math.min(a, b, c);
    const [p, q, r] = low === a ? [a, b, c] : low === b ? [b, c, a] : [c, a, b];
    const key = (p * cells.size + q) * cells.size + r;
    if (seen.has(key)) continue;
    seen.add(key);
    triangles.push(a, b, c);
  }
  return {positions: coarse, indices: new Uint32Array(triangles)};
}

/**
 * Returns a sleeve along the longest axis of the part's box: rings of `sides` corners around the mesh.
 * Clustering tears limbs apart that are as thin as a cell; a sleeve stays whole.
 */
export function sleeve(mesh: Mesh, box: Box, rings: number, sides: number): Mesh {
  const along = box.half_m.indexOf(Math.max(...box.half_m));
  const [u, v] = [(along + 1) % 3, (along + 2) % 3];
  const spans = spansOf(mesh, box, along, rings);
  // The polygon has the area of the ellipse that it replaces.
  const wider = Math.sqrt((2 * Math.PI) / (sides * Math.sin((2 * Math.PI) / sides)));
  const positions = new Float32Array(3 * rings * sides);
  for (let ring = 0; ring < rings; ++ring)
    for (let side = 0; side < sides; ++side) {
      const angle = (2 * Math.PI * (side + 0.5)) / sides;
      const at = 3 * (ring * sides + side);
      const {low, high} = spans[ring];
      positions[at + along] = box.centre_m[along] + box.half_m[along] * ((2 * ring) / (rings - 1) - 1);
      positions[at + u] = (low[u] + high[u]) / 2 + (Math.cos(angle) * wider * (high[u] - low[u])) / 2;
      positions[at + v] = (low[v] + high[v]) / 2 + (Math.sin(angle) * wider * (high[v] - low[v])) / 2;
    }
  const indices: number[] = [];
  for (let ring = 0; ring + 1 < rings; ++ring)
    for (let side = 0; side < sides; ++side) {
      const [a, b] = [ring * sides + side, ring * sides + ((side + 1) % sides)];
      indices.push(a, b, b + sides, a, b + sides, a + sides);
    }
  const last = (rings - 1) * sides;
  for (let side = 1; side + 1 < sides; ++side) indices.push(0, side + 1, side, last, last + side, last + side + 1);
  return {positions, indices: new Uint32Array(indices)};
}

interface Span {
  low: number[];
  high: number[];
}

/** Returns the extent of a mesh across an axis, per ring; a ring without a vertex repeats the previous one. */
function spansOf(mesh: Mesh, box: Box, along: number, rings: number): Span[] {
  const spans = Array.from({length: rings}, (): Span => ({low: [1e9, 1e9, 1e9], high: [-1e9, -1e9, -1e9]}));
  const start = box.centre_m[along] - box.half_m[along];
  const length = Math.max(1e-9, 2 * box.half_m[along]);
  for (let p = 0; p < mesh.positions.length; p += 3) {
    const ring = Math.round(((mesh.positions[p + along] - start) / length) * (rings - 1));
    const {low, high} = spans[Math.min(rings - 1, Math.max(0, ring))];
    for (let axis = 0; axis < 3; ++axis) {
      low[axis] = Math.min(low[axis], mesh.positions[p + axis]);
      high[axis] = Math.max(high[axis], mesh.positions[p + axis]);
    }
  }
  let known = spans.find(({low, high}) => low[0] <= high[0]) ?? {low: [...box.centre_m], high: [...box.centre_m]};
  return spans.map((span) => (known = span.low[0] <= span.high[0] ? span : known));
}

/** Returns normals at the vertices, weighted by the area of the adjacent triangles. */
export function vertexNormals(mesh: Mesh): Float32Array {
  const {positions: p, indices} = mesh;
  const normals = new Float32Array(p.length);
  for (let t = 0; t + 2 < indices.length; t += 3) {
    const [a, b, c] = [3 * indices[t], 3 * indices[t + 1], 3 * indices[t + 2]];
    const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const corner of [a, b, c]) for (let i = 0; i < 3; ++i) normals[corner + i] += n[i];
  }
  for (let v = 0; v < normals.length; v += 3) {
    const length = Math.hypot(normals[v], normals[v + 1], normals[v + 2]) || 1;
    for (let i = 0; i < 3; ++i) normals[v + i] /= length;
  }
  return normals;
}

/** An end of a ribbon, in the frame of its part. */
export interface RibbonEnd {
  part: number;
  at: Vec3;
  half_width_m: number;
  /** The direction of the ribbon, from its first to its second end. */
  axis: Vec3;
}

/** A ribbon replaces a limb of distant people: two triangles, which the graphics card turns to the eye. */
export type Ribbon = [RibbonEnd, RibbonEnd];

/** Limbs of more parts than this end before the last one: hands and feet are too small to be seen. */
const MAX_LIMB_PARTS = 2;

/** Returns a ribbon for each part of a model. */
export function partRibbons(model: Model): Ribbon[] {
  return model.parts.map((_, part) => [endOf(model, part, false), endOf(model, part, true)]);
}

/** Returns a ribbon for each limb: a series of parts without a branch. */
export function limbRibbons(model: Model): Ribbon[] {
  const parents = model.parts.map((_, part) => parentOf(model, part));
  const childrenOf = (part: number): number[] => parents.flatMap((parent, child) => (parent === part ? [child] : []));
  const starts = parents.flatMap((parent, part) => (parent < 0 || childrenOf(parent).length > 1 ? [part] : []));
  return starts.map((start) => {
    const limb = [start];
    for (let next = childrenOf(start); next.length === 1; next = childrenOf(next[0])) limb.push(next[0]);
    if (limb.length > MAX_LIMB_PARTS) limb.pop();
    return [endOf(model, start, false), endOf(model, limb.at(-1)!, true)];
  });
}

/** Returns the largest ribbons, which suffice for the shadow of a distant person. */
export function largest(ribbons: readonly Ribbon[], model: Model, count: number): Ribbon[] {
  const area = ([first, second]: Ribbon): number =>
    (first.half_width_m + second.half_width_m) * (lengthOf(model, first) + lengthOf(model, second));
  return [...ribbons].sort((p, q) => area(q) - area(p)).slice(0, count);
}

const lengthOf = (model: Model, {part}: RibbonEnd): number => Math.max(...model.parts[part].box.half_m);

/** Returns the part on the nearest link before a part's own; -1: none. */
function parentOf(model: Model, part: number): number {
  let link = model.parts[part].link;
  while (link > 0) {
    link = model.joints[link - 1].parent_link;
    const found = model.parts.findIndex((other) => other.link === link);
    if (found >= 0) return found;
  }
  return -1;
}

/** Returns the end of a part's box that is near or far from its joint, along the longest axis. */
function endOf({parts}: Model, part: number, isFar: boolean): RibbonEnd {
  const {centre_m, half_m} = parts[part].box;
  const along = half_m.indexOf(Math.max(...half_m));
  const outwards = centre_m[along] < 0 ? -1 : 1;
  const at = [...centre_m] as Vec3;
  at[along] += (isFar ? outwards : -outwards) * half_m[along];
  const axis: Vec3 = [0, 0, 0];
  axis[along] = outwards;
  const [u, v] = [half_m[(along + 1) % 3], half_m[(along + 2) % 3]];
  return {part, at, half_width_m: Math.sqrt(u * v), axis};
}
