// Whose sphere overlaps somebody else's, for recorded runs; the server knows it of its own frames.
// One rule: cells as wide as the widest sphere, so that a cell and its neighbours hold all partners.

/** `spheres`: x, y, z, radius each; radius 0: nobody there. Returns 1 where one overlaps another. */
export function crowded(spheres: Float32Array): Uint8Array {
  const count = spheres.length / 4;
  const flags = new Uint8Array(count);
  let edge = 1e-3;
  for (let i = 0; i < count; ++i) edge = Math.max(edge, 2 * spheres[4 * i + 3]);
  const cells = new Map<number, number[]>();
  const cellOf = (i: number, dx: number, dy: number): number =>
    (Math.floor(spheres[4 * i] / edge) + dx) * 1_000_003 + Math.floor(spheres[4 * i + 1] / edge) + dy;
  for (let i = 0; i < count; ++i) {
    if (spheres[4 * i + 3] <= 0) continue;
    for (let dx = -1; dx <= 1; ++dx)
      for (let dy = -1; dy <= 1; ++dy)
        for (const j of cells.get(cellOf(i, dx, dy)) ?? []) {
          if (flags[i] && flags[j]) continue;
          const x = spheres[4 * i] - spheres[4 * j];
          const y = spheres[4 * i + 1] - spheres[4 * j + 1];
          const z = spheres[4 * i + 2] - spheres[4 * j + 2];
          const reach = spheres[4 * i + 3] + spheres[4 * j + 3];
          if (x * x + y * y + z * z <= reach * reach) flags[i] = flags[j] = 1;
        }
    const home = cellOf(i, 0, 0);
    const cell = cells.get(home);
    if (cell) cell.push(i);
    else cells.set(home, [i]);
  }
  return flags;
}
