// Chains list the joints from the root to each part of a model: forward kinematics of single parts.
// Invariant: processor and graphics card compute poses from the same numbers.
import type {Model, Vec3} from './protocol.ts';

/** Scale of the quaternions in the texels of parts. */
export const UNIT = 32767;

/**
 * A joint is eight floats: x, y, z relative to the joint before, the column of its position, the axis, and a turn.
 * The turn is in radians per unit of the column; 0 is a joint that slides. Fixed transforms belong to the next joint.
 * After the last joint: x, y, z of the part; steps per metre; its rotation as a quaternion x, y, z, w.
 */
export interface Chain {
  joints: number;
  floats: number[];
}

type Quaternion = [number, number, number, number];

function product([ax, ay, az, aw]: Quaternion, [bx, by, bz, bw]: Quaternion): Quaternion {
  return [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

function turned([qx, qy, qz, qw]: Quaternion, [x, y, z]: Vec3): Vec3 {
  const [tx, ty, tz] = [2 * (qy * z - qz * y), 2 * (qz * x - qx * z), 2 * (qx * y - qy * x)];
  return [x + qw * tx + qy * tz - qz * ty, y + qw * ty + qz * tx - qx * tz, z + qw * tz + qx * ty - qy * tx];
}

function turnOf([x, y, z]: Vec3, angle_rad: number): Quaternion {
  const s = Math.sin(angle_rad / 2);
  return [x * s, y * s, z * s, Math.cos(angle_rad / 2)];
}

/** Returns the chain to a link; link 0 is the root. */
export function chainOf(model: Model, link: number): Chain {
  const path: number[] = [];
  for (let at = link; at > 0; at = model.joints[at - 1].parent_link) path.unshift(at - 1);
  const floats: number[] = [];
  let rotation: Quaternion = [0, 0, 0, 1];
  let offset: Vec3 = [0, 0, 0];
  const move = (along: Vec3, times = 1): void => {
    offset = offset.map((value, i) => value + times * along[i]) as Vec3;
  };
  for (const index of path) {
    const joint = model.joints[index];
    const isMimic = joint.mimic_joint >= 0;
    const column = isMimic ? model.joints[joint.mimic_joint].column : joint.column;
    const [factor, constant] = isMimic ? [joint.mimic_multiplier, joint.mimic_offset] : [1, 0];
    const isMoving = joint.kind !== 0 && column >= 0 && factor !== 0;
    const slides = joint.kind === 3;
    const [w, x, y, z] = joint.rotation_wxyz;
    move(turned(rotation, joint.position_m));
    rotation = product(rotation, [x, y, z, w]);
    const axis = turned(rotation, joint.axis);
    if (isMoving) {
      floats.push(...offset, column, ...(slides ? axis.map((value) => value * factor) : axis), slides ? 0 : factor);
      offset = [0, 0, 0];
    }
    if (slides) move(axis, constant);
    else if (joint.kind !== 0) rotation = product(rotation, turnOf(joint.axis, constant));
  }
  floats.push(...offset, 1 / model.part_step_m, ...rotation);
  return {joints: floats.length / 8 - 1, floats};
}

/** All chains of some models, one after the other. */
export class Chains {
  readonly floats: Float32Array;
  private readonly current = new Float64Array(7);
  private readonly places: {first: number; joints: number}[][];

  constructor(models: readonly Model[]) {
    const all: number[] = [];
    this.places = models.map((model) =>
      model.parts.map((part) => {
        const {joints, floats} = chainOf(model, part.link);
        const first = all.length;
        all.push(...floats);
        return {first, joints};
      }),
    );
    this.floats = Float32Array.from(all);
  }

  /** Returns the index of the first float of a part, and the number of its joints. */
  placeOf(model: number, part: number): {first: number; joints: number} {
    return this.places[model][part];
  }

  /**
   * Writes the pose of a part relative to the root position, in world axes, to a texel of eight int16 at out[at].
   * The texel is x, y, z in steps of the model, a mark that stays, and a quaternion.
   * `root` has seven numbers: x, y, z and a quaternion.
   */
  pose(model: number, part: number, root: ArrayLike<number>, scale: number, valueOf: (column: number) => number, out: Int16Array, at: number): void {
    const {floats, current: pose} = this;
    const {first, joints} = this.places[model][part];
    const end = first + 8 * joints;
    pose.fill(0, 0, 3);
    for (let i = 3; i < 7; ++i) pose[i] = root[i];
    for (let j = first; j < end; j += 8) {
      const value = valueOf(floats[j + 3]);
      const factor = floats[j + 7];
      const along = factor === 0 ? value : 0;
      move(pose, floats[j] + along * floats[j + 4], floats[j + 1] + along * floats[j + 5], floats[j + 2] + along * floats[j + 6]);
      if (factor === 0) continue;
      const s = Math.sin(0.5 * factor * value);
      turn(pose, s * floats[j + 4], s * floats[j + 5], s * floats[j + 6], Math.cos(0.5 * factor * value));
    }
    move(pose, floats[end], floats[end + 1], floats[end + 2]);
    turn(pose, floats[end + 4], floats[end + 5], floats[end + 6], floats[end + 7]);
    const steps = scale * floats[end + 3];
    for (let i = 0; i < 3; ++i) out[at + i] = Math.round(pose[i] * steps);
    for (let i = 0; i < 4; ++i) out[at + 4 + i] = Math.round(pose[3 + i] * UNIT);
  }
}

/** Moves a pose x, y, z, qx, qy, qz, qw along its own axes. */
function move(pose: Float64Array, x: number, y: number, z: number): void {
  const qx = pose[3];
  const qy = pose[4];
  const qz = pose[5];
  const qw = pose[6];
  const tx = 2 * (qy * z - qz * y);
  const ty = 2 * (qz * x - qx * z);
  const tz = 2 * (qx * y - qy * x);
  pose[0] += x + qw * tx + qy * tz - qz * ty;
  pose[1] += y + qw * ty + qz * tx - qx * tz;
  pose[2] += z + qw * tz + qx * ty - qy * tx;
}

/** Turns a pose by a quaternion relative to it. */
function turn(pose: Float64Array, x: number, y: number, z: number, w: number): void {
  const qx = pose[3];
  const qy = pose[4];
  const qz = pose[5];
  const qw = pose[6];
  pose[3] = qw * x + qx * w + qy * z - qz * y;
  pose[4] = qw * y - qx * z + qy * w + qz * x;
  pose[5] = qw * z + qx * y - qy * x + qz * w;
  pose[6] = qw * w - qx * x - qy * y - qz * z;
}
