// DensityLog sums where people were over a span of frames. Invariant: each sample has the same weight.
import {cellOf, gridOf, type FloorGrid, type HeatCells} from './heat.ts';
import {isPerson, isPresent, type Frame, type Run} from './protocol.ts';

const CELL_M = 1;

export class DensityLog {
  /** The span: first <= frame < end. */
  first = 0;
  end = -1;
  samples = 0;
  /** Grows with every change. */
  version = 0;
  /** Frames of the first and the last sample. */
  range: [number, number] = [-1, -1];
  private grid: FloorGrid | null = null;
  private sums = new Uint32Array(0);

  reset(run: Run, first: number, end: number): void {
    this.first = first;
    this.end = end;
    this.samples = 0;
    this.range = [-1, -1];
    this.grid = gridOf(run, CELL_M);
    this.sums = new Uint32Array(this.grid.columns * this.grid.rows);
    ++this.version;
  }

  /** Adds a sample: the place of each person, x at `at(id)` of `places` and y after it; NaN: not present. */
  add(run: Run, places: ArrayLike<number>, at: (id: number) => number, frame: number): void {
    const {grid} = this;
    if (!grid) return;
    for (let id = 0; id < run.avatars; ++id) {
      const x = places[at(id)];
      if (!Number.isNaN(x) && isPerson(run, id)) ++this.sums[cellOf(grid, x, places[at(id) + 1])];
    }
    this.range = [this.samples === 0 ? frame : this.range[0], frame];
    ++this.samples;
    ++this.version;
  }

  addFrame(run: Run, frame: Frame): void {
    const places = new Float32Array(2 * run.avatars).fill(NaN);
    for (let id = 0; id < run.avatars; ++id)
      if (isPresent(frame, id)) places.set(frame.positions.subarray(4 * id, 4 * id + 2), 2 * id);
    this.add(run, places, (id) => 2 * id, frame.number);
  }

  /** Returns people per square metre of each cell, the mean of all samples; null: no sample. */
  get cells(): HeatCells | null {
    const {grid, sums, samples} = this;
    if (!grid || samples === 0) return null;
    const counts = Float32Array.from(sums, (sum) => sum / (samples * grid.cell_m ** 2));
    return {...grid, counts, most: counts.reduce((max, value) => Math.max(max, value), 0)};
  }
}
