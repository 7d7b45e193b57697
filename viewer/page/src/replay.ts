// Replay decodes a recording inside the page and rebuilds a frame at any time from ten keys per second.
// Invariant: its frames have the form of the server's frames; the rest of the page sees no difference.
import {Grid} from './cells.ts';
import {Motion, ROOT_FLOATS, type Basis} from './motion.ts';
import {decodeRun, PAIR_WORDS, type ContactChange, type Frame, type Run} from './protocol.ts';

// Overlapping spheres of recorded runs; the server marks them in its own frames.

/** `spheres`: x, y, z, radius each; radius 0: not present. Returns 1 for each sphere that overlaps another. */
export function crowded(spheres: Float32Array): Uint8Array {
  const count = spheres.length / 4;
  const flags = new Uint8Array(count);
  let largest_m = 1e-3;
  for (let i = 0; i < count; ++i) largest_m = Math.max(largest_m, 2 * spheres[4 * i + 3]);
  new Grid(spheres, 4, count, largest_m, (i) => spheres[4 * i + 3] > 0).eachPair((i, j) => {
    if (flags[i] && flags[j]) return;
    const x = spheres[4 * i] - spheres[4 * j];
    const y = spheres[4 * i + 1] - spheres[4 * j + 1];
    const z = spheres[4 * i + 2] - spheres[4 * j + 2];
    const reach = spheres[4 * i + 3] + spheres[4 * j + 3];
    if (x * x + y * y + z * z <= reach * reach) flags[i] = flags[j] = 1;
  });
  return flags;
}

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
  curve(out: Float32Array | Int16Array, from: number, stride: number, count: number, unit: number): void {
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
  private readonly spheres: Float32Array;
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
    const columns = new Uint8Array(buffer, columnsAt);
    const numbers = new Varints(columns);
    this.motion = new Motion(this.run, this.head.models, this.head.keys, this.head, numbers);
    this.spheres = new Float32Array(4 * this.run.avatars);
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
    const candidates = this.bySecond[Math.floor(frame / this.perBucket)] ?? [];
    return candidates.map((i) => this.intervals[i]).filter((s) => s.begin <= frame && frame < s.end);
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
    const crowdedCount = this.markCrowded();
    if (number !== this.pairsOf) this.fillPairs(number);
    for (const {a, b, level} of this.pairsNow) for (const body of [a, b]) markPerson(run, motion.people, body, level + 1);
    return {
      number,
      time_s: number * run.step_s,
      seq: 0,
      frame_ms: this.frame_ms[number] ?? 0,
      build_ms: 0,
      crowded: crowdedCount,
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

  /** Marks people whose spheres overlap; returns their number. */
  private markCrowded(): number {
    const {run, spheres, motion} = this;
    const {positions, people} = motion;
    for (let i = 0, at = 0; i < run.avatars; ++i, at += 4) {
      const {sphere} = run.models[run.modelOfAvatar[i]];
      const scale = run.scaleOfAvatar[i];
      spheres[at] = positions[at];
      spheres[at + 1] = positions[at + 1];
      spheres[at + 2] = positions[at + 2] + sphere.centre_z_m * scale;
      spheres[at + 3] = people[at + 3] & 1 ? sphere.radius_m * scale : 0;
    }
    const flags = crowded(spheres);
    let count = 0;
    for (let i = 0; i < run.avatars; ++i) {
      if (!flags[i]) continue;
      people[4 * i + 3] |= 2;
      ++count;
    }
    return count;
  }

  private fillPairs(number: number): void {
    const {run, motion} = this;
    this.pairsOf = number;
    this.pairsNow = this.touching(number);
    this.pairWords = new Uint32Array(this.pairsNow.length * PAIR_WORDS);
    motion.clearMarks();
    this.pairsNow.forEach(({a, b, partA, partB, level, began}, index) => {
      this.pairWords.set([a, b, partA | (partB << 8) | (level << 16), began], index * PAIR_WORDS);
      if (a < run.avatars) motion.mark(a, partA, level + 1);
      if (b < run.avatars) motion.mark(b, partB, level + 1);
    });
  }
}

function markPerson(run: Run, people: Uint32Array, body: number, mark: number): void {
  if (body >= run.avatars) return;
  const word = body * 4 + 3;
  if (mark > ((people[word] >>> 8) & 0xff)) people[word] = (people[word] & ~0xff00) | (mark << 8);
}
