// Chains list the joints from the root to each part of a model: forward kinematics of single parts.
// Invariant: processor and graphics card compute poses from the same numbers.
import type {Model, Vec3} from './protocol.ts';

/** Scale of the quaternions in the texels of parts. */
export const UNIT = 32767;

/**
 * Per joint eight floats: x, y, z relative to the joint before and the column of its position; the axis and the
 * radians per unit of the column, or 0 for a joint that slides along the axis. Fixed transforms are part of the next
 * joint. After the last joint: x, y, z of the part, steps per metre, and its rotation as a quaternion x, y, z, w.
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
   * Writes the pose of a part relative to the root position, in world axes, to eight int16 at out[at]: x, y, z in
   * steps of the model, unchanged, and the quaternion x, y, z, w. `root` is x, y, z, qx, qy, qz, qw.
   */
  pose(model: number, part: number, root: ArrayLike<number>, scale: number, valueOf: (column: number) => number, out: Int16Array, at: number): void {
    const {floats} = this;
    const {first, joints} = this.places[model][part];
    let [x, y, z] = [0, 0, 0];
    let [qx, qy, qz, qw] = [root[3], root[4], root[5], root[6]];
    const end = first + 8 * joints;
    for (let j = first; j <= end; j += 8) {
      const isEnd = j === end;
      const factor = floats[j + 7];
      const value = isEnd ? 0 : valueOf(floats[j + 3]);
      const along = !isEnd && factor === 0 ? value : 0;
      const [ox, oy, oz] = [floats[j] + along * floats[j + 4], floats[j + 1] + along * floats[j + 5], floats[j + 2] + along * floats[j + 6]];
      const [tx, ty, tz] = [2 * (qy * oz - qz * oy), 2 * (qz * ox - qx * oz), 2 * (qx * oy - qy * ox)];
      x += ox + qw * tx + qy * tz - qz * ty;
      y += oy + qw * ty + qz * tx - qx * tz;
      z += oz + qw * tz + qx * ty - qy * tx;
      if (!isEnd && factor === 0) continue;
      const half = 0.5 * factor * value;
      const s = isEnd ? 1 : Math.sin(half);
      const [bx, by, bz, bw] = [s * floats[j + 4], s * floats[j + 5], s * floats[j + 6], isEnd ? factor : Math.cos(half)];
      [qx, qy, qz, qw] = [
        qw * bx + qx * bw + qy * bz - qz * by,
        qw * by - qx * bz + qy * bw + qz * bx,
        qw * bz + qx * by - qy * bx + qz * bw,
        qw * bw - qx * bx - qy * by - qz * bz,
      ];
    }
    const steps = scale * floats[end + 3];
    out[at] = Math.round(x * steps);
    out[at + 1] = Math.round(y * steps);
    out[at + 2] = Math.round(z * steps);
    out[at + 4] = Math.round(qx * UNIT);
    out[at + 5] = Math.round(qy * UNIT);
    out[at + 6] = Math.round(qz * UNIT);
    out[at + 7] = Math.round(qw * UNIT);
  }
}
