// Grid lists points by square cells, so that only neighbours are compared.
// Invariant: points nearer than `size` lie in the same or in adjacent cells.

/** Cells per point at most; wider cells are as correct. */
const MAX_CELLS = 8;

export class Grid {
  private readonly cell: Int32Array;
  private readonly next: Int32Array;
  private readonly first: Int32Array;
  private readonly columns: number;

  /** The points are x, y at each `stride` numbers; those that `keep` rejects are left out. */
  constructor(at: Float32Array, stride: number, count: number, size: number, keep: (index: number) => boolean = () => true) {
    let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let i = 0; i < count; ++i) {
      if (!keep(i)) continue;
      const x = at[stride * i];
      const y = at[stride * i + 1];
      left = Math.min(left, x);
      right = Math.max(right, x);
      top = Math.min(top, y);
      bottom = Math.max(bottom, y);
    }
    const [width, height] = right >= left ? [right - left, bottom - top] : [0, 0];
    let edge = size;
    while (Math.floor(width / edge) * Math.floor(height / edge) > MAX_CELLS * count + 64) edge *= 2;
    // An empty cell on each side lets a search in neighbouring cells do without limits.
    this.columns = Math.floor(width / edge) + 3;
    const rows = Math.floor(height / edge) + 3;
    this.first = new Int32Array(this.columns * rows).fill(-1);
    this.next = new Int32Array(count);
    this.cell = new Int32Array(count).fill(-1);
    for (let i = 0; i < count; ++i) {
      if (!keep(i)) continue;
      const column = 1 + Math.floor((at[stride * i] - left) / edge);
      const row = 1 + Math.floor((at[stride * i + 1] - top) / edge);
      const cell = row * this.columns + column;
      this.cell[i] = cell;
      this.next[i] = this.first[cell];
      this.first[cell] = i;
    }
  }

  /** Calls `visit` once for each pair of points in the same or in adjacent cells. */
  eachPair(visit: (i: number, j: number) => void): void {
    const {cell, next, first, columns} = this;
    const steps = [0, 1, columns - 1, columns, columns + 1];
    for (let i = 0; i < cell.length; ++i) {
      if (cell[i] < 0) continue;
      // The point's own cell and half of the neighbours; the other half finds this point.
      for (let k = 0; k < 5; ++k)
        for (let j = k === 0 ? next[i] : first[cell[i] + steps[k]]; j >= 0; j = next[j]) visit(i, j);
    }
  }
}
