// ProximityLog holds how near one body came to others, frame by frame. Invariant: its rows are in the order of frames.
import type {ProximityRow, ProximityRows} from './protocol.ts';

/** A damaged frame number must not allocate memory. */
const MAX_FRAMES = 10_000_000;

export class ProximityLog {
  /** -1: none. */
  body = -1;
  isRecorded = false;
  /** Why there are no rows; empty: nothing to say. */
  note = '';
  rows: ProximityRow[] = [];
  /** The rows cover the frames before this one. */
  to = 0;
  /** Grows with every change. */
  version = 0;
  private curve = {version: -1, first: -1, end: -1, values: new Float32Array(0)};

  /** Forgets the rows and begins with another body. */
  reset(body: number): void {
    this.body = body;
    this.rows = [];
    this.to = 0;
    ++this.version;
  }

  /** Takes rows that continue those known; returns whether they do. */
  take({body, isRecorded, from, to, rows}: ProximityRows): boolean {
    if (body !== this.body || from !== this.to) return false;
    this.isRecorded = isRecorded;
    if (to > from) ++this.version;
    for (const row of rows) this.rows.push(row);
    this.to = to;
    return true;
  }

  /** Forgets the rows before a frame. */
  forget(frame: number): void {
    if (this.rows.length > 0 && this.rows[0].frame < frame) this.rows = this.rows.slice(this.indexOf(frame));
  }

  /** Returns the rows of a frame, the nearest first. */
  at(frame: number): ProximityRow[] {
    const rows = this.rows.slice(this.indexOf(frame), this.indexOf(frame + 1));
    return rows.sort((p, q) => p.lo_m - q.lo_m || p.hi_m - q.hi_m || p.other - q.other);
  }

  /** Returns the first row with the least distance; null: none. */
  get least(): ProximityRow | null {
    let least: ProximityRow | null = null;
    for (const row of this.rows) if (!least || row.lo_m < least.lo_m) least = row;
    return least;
  }

  /** Returns the least distance in each frame from `first` to the one before `end`; Infinity: none known. */
  distances(first: number, end: number): Float32Array {
    const {curve, version, rows} = this;
    if (curve.version === version && curve.first === first && curve.end === end) return curve.values;
    const values = new Float32Array(Math.min(MAX_FRAMES, Math.max(0, end - first))).fill(Infinity);
    // Outside of the array an assignment has no effect.
    for (const {frame, lo_m} of rows) if (lo_m < values[frame - first]) values[frame - first] = lo_m;
    this.curve = {version, first, end, values};
    return values;
  }

  /** Returns the index of the first row in a frame or later. */
  private indexOf(frame: number): number {
    let [low, high] = [0, this.rows.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.rows[middle].frame < frame) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

/** Formats a distance: "0.412 m", or its bounds if they differ: "0.40–0.42 m". */
export function distanceText({lo_m, hi_m}: Pick<ProximityRow, 'lo_m' | 'hi_m'>): string {
  const isExact = hi_m - lo_m <= 0.0011;
  return isExact ? `${lo_m.toFixed(3)} m` : `${lo_m.toFixed(2)}–${hi_m.toFixed(2)} m`;
}
