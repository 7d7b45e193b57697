// Coarser meshes for people who are far away.
// One rule: vertex clustering (Rossignac and Borrel 1993): vertices of a cell become their mean;
// triangles that collapse are left out.
import type {Mesh} from './protocol.ts';

export function simplified(mesh: Mesh, cell_m: number): Mesh {
  const {positions, indices} = mesh;
  const cells = new Map<string, number>();
  const cellOf = new Uint32Array(positions.length / 3);
  const sums: number[] = [];
  for (let v = 0; v < cellOf.length; ++v) {
    const [x, y, z] = [positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]];
    const key = `${Math.round(x / cell_m)},${Math.round(y / cell_m)},${Math.round(z / cell_m)}`;
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
  const seen = new Set<string>();
  for (let t = 0; t + 2 < indices.length; t += 3) {
    const [a, b, c] = [cellOf[indices[t]], cellOf[indices[t + 1]], cellOf[indices[t + 2]]];
    if (a === b || b === c || c === a) continue;
    const low = Math.min(a, b, c);
    const key = low === a ? `${a},${b},${c}` : low === b ? `${b},${c},${a}` : `${c},${a},${b}`;
    if (seen.has(key)) continue;
    seen.add(key);
    triangles.push(a, b, c);
  }
  return {positions: coarse, indices: new Uint32Array(triangles)};
}

/** Normals at the vertices, weighted by the area of the triangles around them. */
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
