// Replay decodes a recording inside the page and rebuilds a frame at any time from ten keys per second.
// Invariant: its frames have the form of the server's frames; the rest of the page sees no difference.
import {decodeRun, PAIR_WORDS, type ContactChange, type Frame, type Joint, type Model, type Run} from './protocol.ts';

// Forward kinematics of one person: joint positions to part poses, with the conventions of the server.

interface Posture {
  columns: Float64Array; // positions of the independent joints
  values: Float64Array; // scratch: positions of all joints
  links: Float64Array; // scratch: x, y, z, qx, qy, qz, qw of all links, root first
}

const UNIT = 32767;

/** Quaternion product a * b, each x, y, z, w at an offset. */
function multiply(out: Float64Array, o: number, a: ArrayLike<number>, i: number, b: ArrayLike<number>, j: number): void {
  const [ax, ay, az, aw] = [a[i], a[i + 1], a[i + 2], a[i + 3]];
  const [bx, by, bz, bw] = [b[j], b[j + 1], b[j + 2], b[j + 3]];
  out[o] = aw * bx + ax * bw + ay * bz - az * by;
  out[o + 1] = aw * by - ax * bz + ay * bw + az * bx;
  out[o + 2] = aw * bz + ax * by - ay * bx + az * bw;
  out[o + 3] = aw * bw - ax * bx - ay * by - az * bz;
}

/** out[o..] += q * (x, y, z) */
function addTurned(out: Float64Array, o: number, q: ArrayLike<number>, i: number, x: number, y: number, z: number): void {
  const [qx, qy, qz, qw] = [q[i], q[i + 1], q[i + 2], q[i + 3]];
  const tx = 2 * (qy * z - qz * y);
  const ty = 2 * (qz * x - qx * z);
  const tz = 2 * (qx * y - qy * x);
  out[o] += x + qw * tx + qy * tz - qz * ty;
  out[o + 1] += y + qw * ty + qz * tx - qx * tz;
  out[o + 2] += z + qw * tz + qx * ty - qy * tx;
}

const turn = new Float64Array(4);
const origin = new Float64Array(4);

/**
 * Computes part poses relative to the root position, in world axes, with scaled translations.
 * Writes eight int16 per part to out[at] and following: x, y, z in steps of the model, a mark of 0, and the
 * quaternion x, y, z, w. `root` is x, y, z, qx, qy, qz, qw.
 */
function posesOf(model: Model, posture: Posture, root: Float32Array, scale: number, out: Int16Array, at: number): void {
  const {links, values, columns} = posture;
  links.set([0, 0, 0, root[3], root[4], root[5], root[6]]);
  const {joints} = model;
  for (let j = 0; j < joints.length; ++j) {
    const joint = joints[j];
    values[j] = joint.column >= 0 ? columns[joint.column] : 0;
  }
  for (let j = 0; j < joints.length; ++j) {
    const joint = joints[j];
    const value =
      joint.mimic_joint >= 0
        ? joint.mimic_multiplier * values[joint.mimic_joint] + joint.mimic_offset
        : values[j];
    const parent = 7 * joint.parent_link;
    const link = 7 * (j + 1);
    const [px, py, pz] = joint.position_m;
    const [rw, rx, ry, rz] = joint.rotation_wxyz;
    origin[0] = rx;
    origin[1] = ry;
    origin[2] = rz;
    origin[3] = rw;
    for (let i = 0; i < 3; ++i) links[link + i] = links[parent + i];
    addTurned(links, link, links, parent + 3, px * scale, py * scale, pz * scale);
    multiply(links, link + 3, links, parent + 3, origin, 0);
    const [x, y, z] = joint.axis;
    if (joint.kind === 3) {
      // The position of a prismatic joint is in metres of the unscaled model.
      addTurned(links, link, links, link + 3, x * value * scale, y * value * scale, z * value * scale);
    } else if (joint.kind !== 0) {
      const s = Math.sin(value / 2);
      turn[0] = x * s;
      turn[1] = y * s;
      turn[2] = z * s;
      turn[3] = Math.cos(value / 2);
      multiply(links, link + 3, links, link + 3, turn, 0);
    }
  }
  for (let p = 0; p < model.parts.length; ++p) {
    const link = 7 * model.parts[p].link;
    const o = at + 8 * p;
    for (let i = 0; i < 3; ++i) out[o + i] = Math.round(links[link + i] / model.part_step_m);
    out[o + 3] = 0;
    for (let i = 0; i < 4; ++i) out[o + 4 + i] = Math.round(links[link + 3 + i] * UNIT);
  }
}

// Overlapping spheres of recorded runs; the server marks them in its own frames.
// Cells are as wide as the largest diameter: a cell and its neighbours hold all partners.

/** `spheres`: x, y, z, radius each; radius 0: not present. Returns 1 for each sphere that overlaps another. */
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

interface Head {
  position_step_m: number;
  quaternion_step: number;
  frames: number;
  pairs: number;
  pairs_at: number;
  problem: string;
  keys: number[];
  frame_us: number[];
  models: {mean: number[]; directions: number[][]}[];
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
  private readonly roots: Float32Array; // key by key: x, y, z, qw.. of each avatar, then presence
  private readonly steps: Int16Array[]; // per model: key by key, member by member, coefficients
  private readonly memberOf: Uint32Array;
  private readonly members: number[];
  private readonly bySecond: number[][] = [];
  private readonly perBucket: number;

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
    this.members = this.run.models.map(() => 0);
    this.memberOf = Uint32Array.from(this.run.modelOfAvatar, (m) => this.members[m]++);
    const columns = new Uint8Array(buffer, columnsAt);
    const numbers = new Varints(columns);
    this.roots = this.readRoots(numbers);
    this.steps = this.readSteps(numbers);
    this.readPairs(new Varints(columns, this.head.pairs_at));
    this.pairs = this.countPairs();
  }

  private readRoots(numbers: Varints): Float32Array {
    const {avatars} = this.run;
    const keys = this.head.keys.length;
    const out = new Float32Array(keys * avatars * 8);
    const columns = [7, 0, 1, 2, 3, 4, 5, 6];
    for (const column of columns) {
      const unit = column === 7 ? 1 : column < 3 ? this.head.position_step_m : this.head.quaternion_step;
      for (let i = 0; i < avatars; ++i) numbers.curve(out, i * 8 + column, avatars * 8, keys, unit);
    }
    return out;
  }

  private readSteps(numbers: Varints): Int16Array[] {
    const keys = this.head.keys.length;
    return this.head.models.map((model, m) => {
      const components = model.directions.length;
      const stride = this.members[m] * components;
      const out = new Int16Array(keys * stride);
      for (let c = 0; c < components; ++c)
        for (let i = 0; i < this.members[m]; ++i)
          numbers.curve(out, i * components + c, stride, keys, 1);
      return out;
    });
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
    const key = this.keyAt(frame) * this.run.avatars;
    const at = (body: number, axis: number): number => this.roots[(key + body) * 8 + axis];
    const other = b < this.run.avatars ? b : a;
    return [(at(a, 0) + at(other, 0)) / 2, (at(a, 1) + at(other, 1)) / 2];
  }

  /** Returns the index of the key at or before a position between frames. */
  private keyAt(position: number): number {
    const keys = this.head.keys;
    let low = 0;
    let high = keys.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (keys[middle] <= position) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Returns the newest pairs of a body that began at or before a frame, newest first. */
  history(body: number, frame: number, max: number): ContactInterval[] {
    return this.intervals
      .filter((s) => (s.a === body || s.b === body) && s.begin <= frame && !(s.isLost && s.end <= frame))
      .sort((p, q) => q.begin - p.begin)
      .slice(0, max);
  }

  /** Returns the frame at a position between frames; people move smoothly from key to key. */
  frameAt(position: number): Frame {
    const number = Math.min(this.frames - 1, Math.max(0, Math.floor(position)));
    const keys = this.head.keys;
    const k = this.keyAt(position);
    const next = Math.min(k + 1, keys.length - 1);
    const t = next === k ? 0 : Math.min(1, Math.max(0, (position - keys[k]) / (keys[next] - keys[k])));
    return this.build(number, [Math.max(0, k - 1), k, next, Math.min(keys.length - 1, next + 1)], t);
  }

  private build(number: number, keys: [number, number, number, number], t: number): Frame {
    const {run} = this;
    const touching = this.touching(number);
    const parts = run.firstPart[run.avatars];
    const buffer = new ArrayBuffer(run.avatars * 16 + parts * 16 + touching.length * 4 * PAIR_WORDS);
    const positions = new Float32Array(buffer, 0, run.avatars * 4);
    const people = new Uint32Array(buffer, 0, run.avatars * 4);
    const partWords = new Uint32Array(buffer, run.avatars * 16, parts * 4);
    const partHalves = new Int16Array(buffer, run.avatars * 16, parts * 8);
    const weights = cubic(t);
    const root = new Float32Array(8);
    const postures = run.models.map((model, m) => this.posture(model, m));
    const spheres = new Float32Array(run.avatars * 4);
    let present = 0;
    for (let i = 0; i < run.avatars; ++i) {
      const m = run.modelOfAvatar[i];
      const model = run.models[m];
      this.rootAt(i, keys, weights, root);
      const there = this.roots[(keys[1] * run.avatars + i) * 8 + 7] > 0.5;
      const speed = this.speedAt(i, keys);
      positions.set(root.subarray(0, 3), i * 4);
      people[i * 4 + 3] = (there ? 1 : 0) | (Math.min(65535, Math.round(speed * 1000)) << 16);
      if (there) ++present;
      const scale = run.scaleOfAvatar[i];
      spheres.set([root[0], root[1], root[2] + model.sphere.centre_z_m * scale, there ? model.sphere.radius_m * scale : 0], i * 4);
      this.fillPosture(postures[m], m, this.memberOf[i], keys, weights);
      posesOf(model, postures[m], root, scale, partHalves, run.firstPart[i] * 8);
    }
    const flags = crowded(spheres);
    let crowdedCount = 0;
    for (let i = 0; i < run.avatars; ++i) {
      if (!flags[i]) continue;
      people[i * 4 + 3] |= 2;
      ++crowdedCount;
    }
    const pairWords = new Uint32Array(buffer, run.avatars * 16 + parts * 16, touching.length * PAIR_WORDS);
    touching.forEach((pair, index) => {
      const parts = pair.partA | (pair.partB << 8) | (pair.level << 16);
      pairWords.set([pair.a, pair.b, parts, pair.began], index * PAIR_WORDS);
      for (const [body, part] of [[pair.a, pair.partA], [pair.b, pair.partB]])
        markPart(run, people, partWords, body, part, pair.level + 1);
    });
    return {
      number,
      time_s: number * run.step_s,
      seq: 0,
      frame_ms: this.frame_ms[number] ?? 0,
      build_ms: 0,
      crowded: crowdedCount,
      present,
      lost: 0,
      avatars: run.avatars,
      pairs: touching.length,
      people,
      positions,
      parts: partWords,
      pairWords,
    };
  }

  private rootAt(i: number, keys: number[], weights: number[], out: Float32Array): void {
    out.fill(0);
    for (let k = 0; k < 4; ++k) {
      const at = (keys[k] * this.run.avatars + i) * 8;
      for (let c = 0; c < 7; ++c) out[c] += weights[k] * this.roots[at + c];
    }
    const length = Math.hypot(out[3], out[4], out[5], out[6]) || 1;
    for (let c = 3; c < 7; ++c) out[c] /= length;
  }

  private speedAt(i: number, keys: number[]): number {
    const frames = this.head.keys[keys[2]] - this.head.keys[keys[1]];
    if (frames === 0) return 0;
    const from = (keys[1] * this.run.avatars + i) * 8;
    const to = (keys[2] * this.run.avatars + i) * 8;
    const way = Math.hypot(this.roots[to] - this.roots[from], this.roots[to + 1] - this.roots[from + 1]);
    return way / (frames * this.run.step_s);
  }

  private posture(model: Model, m: number): Posture {
    return {columns: new Float64Array(this.head.models[m].mean.length), ...linksOf(model)};
  }

  private fillPosture(posture: Posture, m: number, member: number, keys: number[], weights: number[]): void {
    const {mean, directions} = this.head.models[m];
    const steps = this.steps[m];
    const stride = this.members[m] * directions.length;
    posture.columns.set(mean);
    for (let c = 0; c < directions.length; ++c) {
      const at = member * directions.length + c;
      let amount = 0;
      for (let k = 0; k < 4; ++k) amount += weights[k] * steps[keys[k] * stride + at];
      const direction = directions[c];
      for (let j = 0; j < direction.length; ++j) posture.columns[j] += amount * direction[j];
    }
  }
}

/** Returns the weights of four keys for a curve through the middle two (Catmull and Rom 1974). */
export function cubic(t: number): [number, number, number, number] {
  const t2 = t * t;
  const t3 = t2 * t;
  return [
    -0.5 * t3 + t2 - 0.5 * t,
    1.5 * t3 - 2.5 * t2 + 1,
    -1.5 * t3 + 2 * t2 + 0.5 * t,
    0.5 * t3 - 0.5 * t2,
  ];
}

function linksOf(model: Model): {values: Float64Array; links: Float64Array} {
  const joints: Joint[] = model.joints;
  return {values: new Float64Array(joints.length), links: new Float64Array(7 * (joints.length + 1))};
}

function markPart(run: Run, people: Uint32Array, parts: Uint32Array, body: number, part: number, mark: number): void {
  if (body >= run.avatars) return;
  const word = body * 4 + 3;
  const known = (people[word] >>> 8) & 0xff;
  if (mark > known) people[word] = (people[word] & ~0xff00) | (mark << 8);
  const at = run.firstPart[body] + part;
  if (at >= run.firstPart[body + 1]) return;
  if (mark > parts[at * 4 + 1] >>> 16) parts[at * 4 + 1] = (parts[at * 4 + 1] & 0xffff) | (mark << 16);
}
