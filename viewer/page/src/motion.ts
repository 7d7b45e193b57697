// Motion gives roots and part poses of recorded people at any time, from ten keys per second.
// Invariant: the processor computes roots of all people, but parts on request only; the Poser computes the others.
import {Grid} from './cells.ts';
import {Chains} from './chains.ts';
import type {Run} from './protocol.ts';

/** Numbers per avatar and key: x, y, z, qx, qy, qz, qw and presence. */
export const ROOT_FLOATS = 8;

/** Joint positions of a model: the mean plus the amount of each direction. */
export interface Basis {
  mean: number[];
  directions: number[][];
}

/** Reads columns of numbers; each is the deviation from a straight line through the previous two. */
export interface Curves {
  curve(out: Float32Array | Int16Array, from: number, stride: number, count: number, unit: number): void;
}

interface Steps {
  position_step_m: number;
  quaternion_step: number;
}

export class Motion {
  readonly chains: Chains;
  /** Amounts per member and key in memory: the directions, filled up to a multiple of four. */
  readonly amountsPerMember: number[];
  /** Index of each avatar among those of its model. */
  readonly memberOf: Uint32Array;
  /** The four keys around the present time and their weights. */
  readonly around: [number, number, number, number] = [0, 0, 0, 0];
  weights: [number, number, number, number] = [0, 1, 0, 0];
  /** x, y, z as floats of each avatar, then its presence (1) and speed (<< 16, mm/s): texels of a frame. */
  readonly positions: Float32Array;
  readonly people: Uint32Array;
  /** Texels of parts; valid where fillPart() was called for the present time. */
  readonly parts: Uint32Array;
  /** The mark of each part, and the number of changes so far. */
  readonly marks: Uint8Array;
  marksVersion = 0;
  present = 0;
  private readonly roots: Float32Array; // key by key
  private readonly amounts: Int16Array[]; // by model; key by key, member by member
  private readonly members: number[];
  private readonly states: Uint32Array;
  private statesOf = -1;
  private readonly marked: number[] = [];
  private readonly halves: Int16Array;
  private readonly spheres: Float32Array; // x, y, z and radius of each avatar
  private crowdedCount = -1; // -1: unknown
  private chosen = -1; // avatar of the following two; -1: unknown
  private readonly root = new Float64Array(ROOT_FLOATS);
  private readonly memberAmounts: Float64Array;
  private readonly rows: Float64Array[]; // bases by column: the mean, then the directions

  constructor(
    private readonly run: Run,
    readonly bases: Basis[],
    private readonly keys: readonly number[],
    steps: Steps,
    numbers: Curves,
  ) {
    const {avatars} = run;
    this.chains = new Chains(run.models);
    this.members = run.models.map(() => 0);
    this.memberOf = Uint32Array.from(run.modelOfAvatar, (m) => this.members[m]++);
    this.amountsPerMember = bases.map(({directions}) => 4 * Math.ceil(directions.length / 4));
    this.rows = bases.map(({mean, directions}, m) => {
      const size = 1 + this.amountsPerMember[m];
      return Float64Array.from({length: mean.length * size}, (_, i) => {
        const [column, c] = [Math.floor(i / size), (i % size) - 1];
        return c < 0 ? mean[column] : (directions[c]?.[column] ?? 0);
      });
    });
    this.memberAmounts = new Float64Array(Math.max(0, ...this.amountsPerMember));
    this.roots = this.readRoots(steps, numbers);
    this.amounts = this.readAmounts(numbers);
    const texels = new ArrayBuffer(16 * avatars);
    this.positions = new Float32Array(texels);
    this.people = new Uint32Array(texels);
    this.states = new Uint32Array(avatars);
    this.parts = new Uint32Array(4 * run.firstPart[avatars]);
    this.halves = new Int16Array(this.parts.buffer);
    this.marks = new Uint8Array(run.firstPart[avatars]);
    this.spheres = new Float32Array(4 * avatars);
  }

  private readRoots({position_step_m, quaternion_step}: Steps, numbers: Curves): Float32Array {
    const {avatars} = this.run;
    const keys = this.keys.length;
    const out = new Float32Array(keys * avatars * ROOT_FLOATS);
    for (const column of [7, 0, 1, 2, 3, 4, 5, 6]) {
      const unit = column === 7 ? 1 : column < 3 ? position_step_m : quaternion_step;
      for (let i = 0; i < avatars; ++i)
        numbers.curve(out, i * ROOT_FLOATS + column, avatars * ROOT_FLOATS, keys, unit);
    }
    return out;
  }

  private readAmounts(numbers: Curves): Int16Array[] {
    const keys = this.keys.length;
    return this.bases.map(({directions}, m) => {
      const perMember = this.amountsPerMember[m];
      const stride = this.members[m] * perMember;
      const out = new Int16Array(keys * stride);
      for (let c = 0; c < directions.length; ++c)
        for (let i = 0; i < this.members[m]; ++i) numbers.curve(out, i * perMember + c, stride, keys, 1);
      return out;
    });
  }

  /** Returns the roots of all avatars at a key. */
  rootsAt(key: number): Float32Array {
    const size = this.run.avatars * ROOT_FLOATS;
    return this.roots.subarray(key * size, (key + 1) * size);
  }

  /** Returns the amounts of all members of a model at a key. */
  amountsAt(model: number, key: number): Int16Array {
    const size = this.members[model] * this.amountsPerMember[model];
    return this.amounts[model].subarray(key * size, (key + 1) * size);
  }

  /** Returns the index of the key at or before a position between frames. */
  keyAt(position: number): number {
    const {keys} = this;
    let low = 0;
    let high = keys.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (keys[middle] <= position) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Computes roots at a position between frames; people move smoothly from key to key. */
  seek(position: number): void {
    const {keys, around} = this;
    const last = keys.length - 1;
    const k = this.keyAt(position);
    const next = Math.min(k + 1, last);
    const t = next === k ? 0 : Math.min(1, Math.max(0, (position - keys[k]) / (keys[next] - keys[k])));
    around[0] = Math.max(0, k - 1);
    around[1] = k;
    around[2] = next;
    around[3] = Math.min(last, next + 1);
    this.weights = cubic(t);
    this.chosen = -1;
    this.crowdedCount = -1;
    this.fillStates();
    this.fillPeople();
  }

  /** Presence and speed are the same from key to key. */
  private fillStates(): void {
    const {run, keys, around, states} = this;
    if (this.statesOf === around[1]) return;
    this.statesOf = around[1];
    const before = this.rootsAt(around[1]);
    const after = this.rootsAt(around[2]);
    const time_s = (keys[around[2]] - keys[around[1]]) * run.step_s;
    this.present = 0;
    for (let i = 0, at = 0; i < run.avatars; ++i, at += ROOT_FLOATS) {
      const [dx, dy] = [after[at] - before[at], after[at + 1] - before[at + 1]];
      const speed = time_s > 0 ? Math.sqrt(dx * dx + dy * dy) / time_s : 0;
      const isPresent = before[at + 7] > 0.5;
      states[i] = (isPresent ? 1 : 0) | (Math.min(65535, Math.round(speed * 1000)) << 16);
      if (isPresent) ++this.present;
    }
  }

  private fillPeople(): void {
    const {run, positions, people, states} = this;
    const [a, b, c, d] = this.around.map((key) => this.rootsAt(key));
    const [wa, wb, wc, wd] = this.weights;
    for (let i = 0, out = 0, at = 0; i < run.avatars; ++i, out += 4, at += ROOT_FLOATS) {
      positions[out] = wa * a[at] + wb * b[at] + wc * c[at] + wd * d[at];
      positions[out + 1] = wa * a[at + 1] + wb * b[at + 1] + wc * c[at + 1] + wd * d[at + 1];
      positions[out + 2] = wa * a[at + 2] + wb * b[at + 2] + wc * c[at + 2] + wd * d[at + 2];
      people[out + 3] = states[i];
    }
  }

  clearMarks(): void {
    for (const part of this.marked) this.marks[part] = 0;
    this.marked.length = 0;
    ++this.marksVersion;
  }

  /** Marks a person, unless its mark is higher already; obstacles have none. */
  markPerson(body: number, mark: number): void {
    if (body >= this.run.avatars) return;
    const word = body * 4 + 3;
    if (mark > ((this.people[word] >>> 8) & 0xff)) this.people[word] = (this.people[word] & ~0xff00) | (mark << 8);
  }

  /** Marks people whose spheres overlap, which few pictures show; returns their number. */
  markCrowded(): number {
    if (this.crowdedCount >= 0) return this.crowdedCount;
    const {run, spheres, positions, people} = this;
    for (let i = 0, at = 0; i < run.avatars; ++i, at += 4) {
      const {sphere} = run.models[run.modelOfAvatar[i]];
      const scale = run.scaleOfAvatar[i];
      spheres[at] = positions[at];
      spheres[at + 1] = positions[at + 1];
      spheres[at + 2] = positions[at + 2] + sphere.centre_z_m * scale;
      spheres[at + 3] = people[at + 3] & 1 ? sphere.radius_m * scale : 0;
    }
    const flags = crowded(spheres);
    this.crowdedCount = 0;
    for (let i = 0; i < run.avatars; ++i) {
      if (!flags[i]) continue;
      people[4 * i + 3] |= 2;
      ++this.crowdedCount;
    }
    return this.crowdedCount;
  }

  /** Marks a part, unless its mark is higher already. */
  markPart(body: number, part: number, mark: number): void {
    if (body >= this.run.avatars) return;
    const at = this.run.firstPart[body] + part;
    if (at >= this.run.firstPart[body + 1] || mark <= this.marks[at]) return;
    this.marks[at] = mark;
    this.marked.push(at);
  }

  /** Computes the texel of a part at the present time. */
  fillPart(avatar: number, part: number): void {
    const {run, root} = this;
    const model = run.modelOfAvatar[avatar];
    this.choose(avatar, model);
    this.chains.pose(model, part, root, run.scaleOfAvatar[avatar], this.valueOf, this.halves, 8 * (run.firstPart[avatar] + part));
  }

  private choose(avatar: number, model: number): void {
    if (this.chosen === avatar) return;
    this.chosen = avatar;
    const {root, weights, around, memberAmounts} = this;
    root.fill(0);
    memberAmounts.fill(0);
    const amounts = this.amounts[model];
    const perMember = this.amountsPerMember[model];
    const at = this.memberOf[avatar] * perMember;
    for (let k = 0; k < 4; ++k) {
      const weight = weights[k];
      if (weight === 0) continue;
      const rootAt = (around[k] * this.run.avatars + avatar) * ROOT_FLOATS;
      const amountAt = around[k] * this.members[model] * perMember + at;
      for (let c = 0; c < 7; ++c) root[c] += weight * this.roots[rootAt + c];
      for (let c = 0; c < perMember; ++c) memberAmounts[c] += weight * amounts[amountAt + c];
    }
    const length = Math.hypot(root[3], root[4], root[5], root[6]) || 1;
    for (let c = 3; c < 7; ++c) root[c] /= length;
  }

  /** Returns the joint position in a column of the chosen avatar. */
  private readonly valueOf = (column: number): number => {
    const {memberAmounts} = this;
    const model = this.run.modelOfAvatar[this.chosen];
    const rows = this.rows[model];
    const size = 1 + this.amountsPerMember[model];
    const row = column * size;
    let value = rows[row];
    for (let c = 1; c < size; ++c) value += memberAmounts[c - 1] * rows[row + c];
    return value;
  };
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
