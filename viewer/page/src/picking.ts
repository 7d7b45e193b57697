// pick() finds the person under the pointer: the ray against the oriented boxes of body parts.
import {Quaternion, Ray, Sphere, Vector3} from 'three';
import {CHEST, pointOf} from './framing.ts';
import {isPresent, WHOLE_BODY, type Frame, type Run} from './protocol.ts';

const low = (word: number): number => (word << 16) >> 16;
const high = (word: number): number => word >> 16;

export interface PartPose {
  origin: Vector3;
  rotation: Quaternion;
}

const newPose = (): PartPose => ({origin: new Vector3(), rotation: new Quaternion()});

/** Returns the world pose of a part, read from the frame's texels, in `out`. */
export function poseOf(run: Run, frame: Frame, avatar: number, part: number, out = newPose()): PartPose {
  frame.motion?.fillPart(avatar, part);
  const at = 4 * (run.firstPart[avatar] + part);
  const [x, y, z, w] = [frame.parts[at], frame.parts[at + 1], frame.parts[at + 2], frame.parts[at + 3]];
  const step = run.models[run.modelOfAvatar[avatar]].part_step_m;
  out.origin.set(low(x), high(x), low(y)).multiplyScalar(step);
  out.origin.x += frame.positions[4 * avatar];
  out.origin.y += frame.positions[4 * avatar + 1];
  out.origin.z += frame.positions[4 * avatar + 2];
  out.rotation.set(low(z), high(z), low(w), high(w)).normalize();
  return out;
}

/** Returns the middle of a part; the chest for a whole body. */
export function centreOf(run: Run, frame: Frame, id: number, part: number, out = new Vector3(), pose = newPose()): Vector3 {
  if (part === WHOLE_BODY) return pointOf(run, frame, id, CHEST, out);
  poseOf(run, frame, id, part, pose);
  const [x, y, z] = run.models[run.modelOfAvatar[id]].parts[part].box.centre_m;
  return out.set(x, y, z).multiplyScalar(run.scaleOfAvatar[id]).applyQuaternion(pose.rotation).add(pose.origin);
}

/** Returns the distance along the ray to a box around the origin, or Infinity. */
export function entersBox(origin: Vector3, direction: Vector3, half: Vector3): number {
  let first = 0;
  let last = Infinity;
  for (const axis of ['x', 'y', 'z'] as const) {
    const inverse = 1 / direction[axis];
    const t1 = (-half[axis] - origin[axis]) * inverse;
    const t2 = (half[axis] - origin[axis]) * inverse;
    first = Math.max(first, Math.min(t1, t2));
    last = Math.min(last, Math.max(t1, t2));
  }
  return first <= last ? first : Infinity;
}

/** Returns the nearest person that the ray hits, or -1. `slack_m` widens parts for touch input. */
export function pick(run: Run, frame: Frame, ray: Ray, slack_m: number): number {
  let best = -1;
  let nearest = Infinity;
  const sphere = new Sphere();
  const half = new Vector3();
  for (let id = 0; id < frame.avatars; ++id) {
    if (!isPresent(frame, id)) continue;
    const model = run.models[run.modelOfAvatar[id]];
    const scale = run.scaleOfAvatar[id];
    const [x, y, z] = [frame.positions[4 * id], frame.positions[4 * id + 1], frame.positions[4 * id + 2]];
    sphere.center.set(x, y, z + model.sphere.centre_z_m * scale);
    sphere.radius = model.sphere.radius_m * scale + slack_m;
    if (!ray.intersectsSphere(sphere)) continue;
    model.parts.forEach((part, index) => {
      const pose = poseOf(run, frame, id, index);
      const back = pose.rotation.clone().invert();
      const origin = ray.origin.clone().sub(pose.origin).applyQuaternion(back).divideScalar(scale);
      origin.sub(new Vector3(...part.box.centre_m));
      const direction = ray.direction.clone().applyQuaternion(back).divideScalar(scale);
      half.set(...part.box.half_m).addScalar(slack_m);
      const distance = entersBox(origin, direction, half);
      if (distance < nearest) {
        nearest = distance;
        best = id;
      }
    });
  }
  return best;
}
