// Replay decodes a recording inside the page and rebuilds a frame at any time from ten keys per second.
// Invariant: its frames have the form of the server's frames; the rest of the page sees no difference.
import type {DensityLog} from './density.ts';
import {Motion, ROOT_FLOATS, type Basis} from './motion.ts';
import {decodeRun, PAIR_WORDS, type ContactChange, type Frame, type ProximityRow, type ProximityRows, type Run, type Shortfall, type Vec3} from './protocol.ts';

interface Head {
  position_step_m: number;
  quaternion_step: number;
  frames: number;
  pairs: number;
  pairs_at: number;
  problem: string;
  keys: number[];
  frame_us: number[];
  models: Basis[];
  shortfalls?: Shortfall[];
  /** `dropped`: the rows did not fit into the file. */
  nearest?: {bodies: number; rows: number; at: number; dropped: boolean};
}

/** Proximity rows of all bodies: the nearest parts of each two, by their ids, then by frames. */
interface Nearest {
  a: Int32Array;
  b: Int32Array;
  frame: Int32Array;
  partA: Uint8Array;
  partB: Uint8Array;
  level: Uint8Array;
  lo_m: Float32Array;
  hi_m: Float32Array;
  /** Index of a row's points; -1: unknown. */
  pointAt: Int32Array;
  points: Float64Array; // column by column: x, y, z of a's, then of b's
}

/** A contact from its begin frame to the frame before its end. */
export interface ContactInterval {
  a: number;
  b: number;
  partA: number;
  partB: number;
  level: number;
  begin: number;
  end: number;
  /** `begin`, or ~begin if it began before that frame. */
  began: number;
  /** Whether the end was not recorded; the contact lasted at least until `end`. */
  isLost: boolean;
}

/** Step of closest points, in metres. */
const POINT_M = 1e-6;
/** Flag in the level of a proximity row: its points are known. */
const HAS_POINTS = 128;
const BEGAN_BEFORE = 1;
const END_LOST = 2;

/** Varints reads numbers of seven bits per byte, with the sign in the lowest bit. */
export class Varints {
  constructor(
    private readonly bytes: Uint8Array,
    public at = 0,
  ) {}

  next(): number {
    let value = 0;
    let factor = 1;
    for (;;) {
      if (this.at >= this.bytes.length) throw new RangeError('the recording ends too early');
      const byte = this.bytes[this.at++];
      value += (byte & 127) * factor;
      if (byte < 128) break;
      factor *= 128;
    }
    return value % 2 === 0 ? value / 2 : -(value + 1) / 2;
  }

  /** Reads `count` numbers, each the deviation from a straight line through the previous two. */
  curve(out: Float32Array | Float64Array | Int16Array | Int32Array, from: number, stride: number, count: number, unit: number): void {
    let last = 0;
    let slope = 0;
    for (let i = 0; i < count; ++i) {
      const value = this.next() + last + slope;
      slope = i === 0 ? 0 : value - last;
      last = value;
      out[from + i * stride] = value * unit;
    }
  }

  bytesOf(count: number): Uint8Array {
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }
}

export async function inflated(base64: string): Promise<ArrayBuffer> {
  const text = atob(base64.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}

export class Replay {
  readonly run: Run;
  readonly frames: number;
  readonly intervals: ContactInterval[] = [];
  /** Missing parts of the run; empty: none. */
  readonly problem: string;
  /** Number of touching pairs per frame. */
  readonly pairs: Int32Array;
  readonly frame_ms: number[];
  private readonly head: Head;
  private readonly motion: Motion;
  private readonly columns: Uint8Array;
  private nearest: Nearest | null = null;
  private readonly bySecond: number[][] = [];
  private readonly perBucket: number;
  private pairsOf = -1; // the frame of the following two
  private pairsNow: ContactInterval[] = [];
  private pairWords = new Uint32Array(0);

  constructor(buffer: ArrayBuffer) {
    const view = new DataView(buffer);
    const runBytes = view.getUint32(0, true);
    this.run = decodeRun(buffer.slice(4, 4 + runBytes));
    const headBytes = view.getUint32(4 + runBytes, true);
    const columnsAt = 8 + runBytes + headBytes;
    this.head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8 + runBytes, headBytes)));
    this.frames = this.head.frames;
    this.problem = this.head.problem;
    this.frame_ms = this.head.frame_us.map((us) => us / 1000);
    this.perBucket = Math.max(1, Math.round(1 / this.run.step_s));
    const columns = (this.columns = new Uint8Array(buffer, columnsAt));
    const numbers = new Varints(columns);
    this.motion = new Motion(this.run, this.head.models, this.head.keys, this.head, numbers);
    this.readPairs(new Varints(columns, this.head.pairs_at));
    this.pairs = this.countPairs();
  }

  private readPairs(numbers: Varints): void {
    const count = this.head.pairs;
    const a = new Int32Array(count);
    const b = new Int32Array(count);
    for (let i = 0; i < count; ++i) a[i] = (i > 0 ? a[i - 1] : 0) + numbers.next();
    for (let i = 0; i < count; ++i)
      b[i] = numbers.next() + (a[i] === (i > 0 ? a[i - 1] : 0) ? (i > 0 ? b[i - 1] : 0) : a[i]);
    const partA = numbers.bytesOf(count);
    const partB = numbers.bytesOf(count);
    const level = numbers.bytesOf(count);
    const flags = numbers.bytesOf(count);
    const begins = Int32Array.from({length: count}, () => numbers.next());
    const lengths = Int32Array.from({length: count}, () => numbers.next());
    let end = 0;
    for (let i = 0; i < count; ++i) {
      const isSame =
        i > 0 && a[i] === a[i - 1] && b[i] === b[i - 1] && partA[i] === partA[i - 1] && partB[i] === partB[i - 1];
      const begin = begins[i] + (isSame ? end : 0);
      end = begin + lengths[i];
      const began = flags[i] & BEGAN_BEFORE ? ~begin : begin;
      const isLost = (flags[i] & END_LOST) !== 0;
      this.intervals.push({a: a[i], b: b[i], partA: partA[i], partB: partB[i], level: level[i], begin, end, began, isLost});
    }
  }

  get shortfalls(): Shortfall[] {
    return this.head.shortfalls ?? [];
  }

  /** Fills `log` with the keys of its span. */
  sampleDensity(log: DensityLog): void {
    const {run} = this;
    const {keys} = this.head;
    const places = new Float32Array(2 * run.avatars);
    for (let key = 0; key < keys.length; ++key) {
      if (keys[key] < log.first || keys[key] >= log.end) continue;
      const roots = this.motion.rootsAt(key);
      for (let id = 0; id < run.avatars; ++id) {
        const at = id * ROOT_FLOATS;
        places[2 * id] = roots[at + 7] > 0.5 ? roots[at] : NaN;
        places[2 * id + 1] = roots[at + 1];
      }
      log.add(run, places, (id) => 2 * id, keys[key]);
    }
  }

  /** Whether proximity rows were left out of the file, which they would have made too large. */
  get isProximityDropped(): boolean {
    return this.head.nearest?.dropped ?? false;
  }

  /** Returns the nearest parts of the others, in the order of frames. */
  proximity(body: number): ProximityRows {
    const {nearest} = this.head;
    const range = {body, isRecorded: nearest !== undefined, from: 0, to: this.frames};
    if (!nearest) return {...range, rows: []};
    const all = (this.nearest ??= this.readProximity(nearest.bodies, nearest.rows, nearest.at));
    const rows: ProximityRow[] = [];
    for (let i = 0; i < nearest.rows; ++i)
      if (all.a[i] === body || all.b[i] === body) rows.push(nearOf(all, i, body));
    return {...range, rows: rows.sort((p, q) => p.frame - q.frame || p.other - q.other)};
  }

  private readProximity(bodies: number, count: number, at: number): Nearest {
    const numbers = new Varints(this.columns, at);
    const ends = new Int32Array(bodies);
    const [a, b] = [new Int32Array(count), new Int32Array(count)];
    let [lastA, lastB, end] = [0, 0, 0];
    for (let i = 0; i < bodies; ++i) {
      lastA += numbers.next();
      lastB += numbers.next();
      const begin = end;
      ends[i] = end += numbers.next();
      a.fill(lastA, begin, end);
      b.fill(lastB, begin, end);
    }
    const curves = <Out extends Int32Array | Float64Array>(out: Out, stops: Int32Array, unit = 1): Out => {
      stops.forEach((stop, i) => numbers.curve(out, i > 0 ? stops[i - 1] : 0, 1, stop - (i > 0 ? stops[i - 1] : 0), unit));
      return out;
    };
    const frame = curves(new Int32Array(count), ends);
    const [partA, partB, level] = [numbers.bytesOf(count), numbers.bytesOf(count), numbers.bytesOf(count)];
    const lo = curves(new Int32Array(count), ends);
    const hi = curves(new Int32Array(count), ends).map((more, i) => lo[i] + more);
    let known = 0;
    const pointAt = Int32Array.from(level, (flags) => (flags & HAS_POINTS ? known++ : -1));
    // Bodies without a row with points have an empty curve.
    const pointEnds = Int32Array.from(ends);
    let [row, seen] = [0, 0];
    ends.forEach((stop, i) => {
      for (; row < stop; ++row) if (pointAt[row] >= 0) ++seen;
      pointEnds[i] = seen;
    });
    const points = new Float64Array(6 * known);
    for (let column = 0; column < 6; ++column) curves(points.subarray(column * known, (column + 1) * known), pointEnds, POINT_M);
    return {a, b, frame, partA, partB, level, lo_m: new Float32Array(lo.buffer), hi_m: new Float32Array(hi.buffer), pointAt, points};
  }

  private countPairs(): Int32Array {
    const changes = new Int32Array(this.frames + 1);
    this.intervals.forEach((interval, index) => {
      changes[Math.min(this.frames, interval.begin)] += 1;
      changes[Math.min(this.frames, interval.end)] -= 1;
      const first = Math.floor(interval.begin / this.perBucket);
      const last = Math.floor(Math.max(interval.begin, interval.end - 1) / this.perBucket);
      for (let s = first; s <= last; ++s) (this.bySecond[s] ??= []).push(index);
    });
    let open = 0;
    return changes.subarray(0, this.frames).map((change) => (open += change));
  }

  /** Returns the touching pairs in the server's order. */
  touching(frame: number): ContactInterval[] {
    const found: ContactInterval[] = [];
    for (const index of this.bySecond[Math.floor(frame / this.perBucket)] ?? []) {
      const interval = this.intervals[index];
      if (interval.begin <= frame && frame < interval.end) found.push(interval);
    }
    return found;
  }

  /** Returns all begins and ends in the order of frames. */
  changes(): ContactChange[] {
    const changes = this.intervals.flatMap(({a, b, partA, partB, begin, end, began, isLost}): ContactChange[] => {
      const [x_m, y_m] = this.placeOf(a, b, begin);
      const pair = {began, a, b, partA, partB, x_m, y_m};
      return [
        {kind: 'began', frame: begin, ...pair},
        {kind: isLost ? 'lost' : 'ended', frame: end, ...pair},
      ];
    });
    // A pair may end and begin again in one frame.
    return changes.sort((p, q) => p.frame - q.frame || Number(p.kind === 'began') - Number(q.kind === 'began'));
  }

  /** Returns the middle between two people at the key before a frame; of an obstacle, the person's place. */
  private placeOf(a: number, b: number, frame: number): [number, number] {
    const roots = this.motion.rootsAt(this.motion.keyAt(frame));
    const at = (body: number, axis: number): number => roots[body * ROOT_FLOATS + axis];
    const other = b < this.run.avatars ? b : a;
    return [(at(a, 0) + at(other, 0)) / 2, (at(a, 1) + at(other, 1)) / 2];
  }

  /** Returns the newest pairs of a body that began at or before a frame, newest first. */
  history(body: number, frame: number, max: number): ContactInterval[] {
    return this.intervals
      .filter((s) => (s.a === body || s.b === body) && s.begin <= frame && !(s.isLost && s.end <= frame))
      .sort((p, q) => q.begin - p.begin)
      .slice(0, max);
  }

  /** Returns the frame at a position between frames. Its arrays are valid until the next call. */
  frameAt(position: number): Frame {
    const {run, motion} = this;
    const number = Math.min(this.frames - 1, Math.max(0, Math.floor(position)));
    motion.seek(position);
    if (number !== this.pairsOf) this.fillPairs(number);
    for (const {a, b, level} of this.pairsNow) {
      motion.markPerson(a, level + 1);
      motion.markPerson(b, level + 1);
    }
    return {
      number,
      time_s: number * run.step_s,
      seq: 0,
      frame_ms: this.frame_ms[number] ?? 0,
      build_ms: 0,
      get crowded() {
        return motion.markCrowded();
      },
      present: motion.present,
      lost: 0,
      avatars: run.avatars,
      pairs: this.pairsNow.length,
      people: motion.people,
      positions: motion.positions,
      parts: motion.parts,
      pairWords: this.pairWords,
      motion,
    };
  }

  private fillPairs(number: number): void {
    const {motion} = this;
    this.pairsOf = number;
    this.pairsNow = this.touching(number);
    this.pairWords = new Uint32Array(this.pairsNow.length * PAIR_WORDS);
    motion.clearMarks();
    this.pairsNow.forEach(({a, b, partA, partB, level, began}, index) => {
      this.pairWords.set([a, b, partA | (partB << 8) | (level << 16), began], index * PAIR_WORDS);
      motion.markPart(a, partA, level + 1);
      motion.markPart(b, partB, level + 1);
    });
  }
}

function nearOf(all: Nearest, i: number, body: number): ProximityRow {
  const isA = all.a[i] === body;
  const [own, other] = isA ? [all.partA[i], all.partB[i]] : [all.partB[i], all.partA[i]];
  const known = all.points.length / 6;
  const point = (first: number): Vec3 =>
    [0, 1, 2].map((axis) => all.points[(first + axis) * known + all.pointAt[i]]) as Vec3;
  return {
    frame: all.frame[i],
    other: isA ? all.b[i] : all.a[i],
    part: own,
    otherPart: other,
    level: all.level[i] & ~HAS_POINTS,
    lo_m: all.lo_m[i],
    hi_m: all.hi_m[i],
    points: all.pointAt[i] < 0 ? null : isA ? [point(0), point(3)] : [point(3), point(0)],
  };
}
