// Forward kinematics of one person, for recorded runs: joint values to part poses.
// One rule: the same tree and the same conventions as the server's; poses leave packed like its.
import type {Model} from './protocol.ts';

export interface Posture {
  columns: Float64Array; // joint values that move by themselves
  values: Float64Array; // scratch: of every joint
  links: Float64Array; // scratch: x, y, z, qx, qy, qz, qw of every link, root first
}

const UNIT = 32767;

/** a * b of quaternions x, y, z, w at offsets. */
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
 * Poses of the parts relative to the root's position, in world axes, translations scaled; written
 * as eight int16 a part from out[at] on: x, y, z in steps of the model, a mark of 0, and the
 * quaternion x, y, z, w. `root` is x, y, z, qx, qy, qz, qw.
 */
export function posesOf(model: Model, posture: Posture, root: Float32Array, scale: number, out: Int16Array, at: number): void {
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
      // A sliding joint's value is metres of the unscaled model.
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
