// fit() finds the camera's place from which all points lie in the free part of the window.
import {Vector3} from 'three';
import {isPresent, type Box, type Frame, type Obstacle, type Run} from './protocol.ts';
import {boxOf} from './bodies.ts';

export interface Rect {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

export interface View {
  position: Vector3;
  /** On the optical axis, at the middle depth of the points. */
  target: Vector3;
}

const UP = new Vector3(0, 0, 1);
/** Height of the space above the ground that belongs to the scene, in metres. */
const ROOM_M = 2;
/** The nearest point stays at least this far in front of the camera. */
const NEAREST_M = 0.5;
/** Obstacles this much of the ground's size outside of it are not part of the scene. */
const OUTSIDE = 0.15;
/** Height of the chest as a share of the person's. */
export const CHEST = 0.7;

interface Interval {
  low: number;
  high: number;
}

/**
 * Returns the nearest view along `direction` that has all points in `free`. That rectangle is in normalised device
 * coordinates about the optical axis, y up. Let a point be at (x, z), across and along the view, the camera at (c, -d).
 * The point is inside if left (z + d) <= x - c <= right (z + d). The extremes of x - slope z over all points decide.
 */
export function fit(
  points: Vector3[],
  direction: Vector3,
  up: Vector3,
  fov_deg: number,
  aspect: number,
  free: Rect,
): View {
  const ahead = direction.clone().normalize();
  const across = ahead.clone().cross(up).normalize();
  const upwards = across.clone().cross(ahead);
  const tan = Math.tan((fov_deg * Math.PI) / 360);
  const slopesX = {low: free.left * tan * aspect, high: free.right * tan * aspect};
  const slopesY = {low: free.bottom * tan, high: free.top * tan};
  const x = limits(points, across, ahead, slopesX);
  const y = limits(points, upwards, ahead, slopesY);
  const depth = extent(points, ahead);
  const distance = Math.max(needed(x, slopesX), needed(y, slopesY), NEAREST_M - depth.low);
  const position = new Vector3()
    .addScaledVector(across, middle(x, slopesX, distance))
    .addScaledVector(upwards, middle(y, slopesY, distance))
    .addScaledVector(ahead, -distance);
  const target = position.clone().addScaledVector(ahead, (depth.low + depth.high) / 2 + distance);
  return {position, target};
}

function extent(points: Vector3[], axis: Vector3): Interval {
  const found = {low: Infinity, high: -Infinity};
  for (const point of points) {
    const at = point.dot(axis);
    found.low = Math.min(found.low, at);
    found.high = Math.max(found.high, at);
  }
  return found;
}

/** Returns the limits of the camera's coordinate at distance 0: at least `low`, at most `high`. */
function limits(points: Vector3[], axis: Vector3, ahead: Vector3, slope: Interval): Interval {
  const found = {low: -Infinity, high: Infinity};
  for (const point of points) {
    const at = point.dot(axis);
    const depth = point.dot(ahead);
    found.low = Math.max(found.low, at - slope.high * depth);
    found.high = Math.min(found.high, at - slope.low * depth);
  }
  return found;
}

function needed(limit: Interval, slope: Interval): number {
  return (limit.low - limit.high) / (slope.high - slope.low);
}

function middle(limit: Interval, slope: Interval, distance: number): number {
  return (limit.low + limit.high - (slope.low + slope.high) * distance) / 2;
}

/** Returns a rectangle of normalised device coordinates around the middle of a free rectangle in pixels. */
export function around(free: Rect, width: number, height: number, share: number): Rect {
  const x = share * Math.max(0.2, (free.right - free.left) / width);
  const y = share * Math.max(0.2, (free.bottom - free.top) / height);
  return {left: -x, right: x, bottom: -y, top: y};
}

/** Returns the corners of the ground, of obstacles on it and of the people present. */
export function scenePoints(run: Run, frame: Frame | null): Vector3[] {
  const points = groundPoints(run);
  for (const obstacle of run.obstacles) {
    const corners = cornersOf(obstacle, boxOf(obstacle.mesh));
    if (corners.every((corner) => isOnGround(run, corner))) points.push(...corners);
  }
  for (let id = 0; frame && id < frame.avatars; ++id) {
    if (!isPresent(frame, id)) continue;
    points.push(pointOf(run, frame, id, 0), pointOf(run, frame, id, 1));
  }
  return points;
}

function groundPoints(run: Run): Vector3[] {
  const {min_m, max_m, floor} = run.ground;
  const bounds = [min_m, [max_m[0], min_m[1]], max_m, [min_m[0], max_m[1]]];
  const corners = floor.length > 0 ? floor.flatMap(([outline]) => outline) : bounds;
  return corners.flatMap(([x, y]) => [new Vector3(x, y, 0), new Vector3(x, y, ROOM_M)]);
}

function cornersOf(obstacle: Obstacle, box: Box): Vector3[] {
  const half = new Vector3(...box.half_m);
  const centre = new Vector3(...box.centre_m);
  return Array.from({length: 8}, (_, bits) => {
    const corner = new Vector3(bits & 1 ? 1 : -1, bits & 2 ? 1 : -1, bits & 4 ? 1 : -1).multiply(half).add(centre);
    return corner.applyAxisAngle(UP, obstacle.heading_rad).add(new Vector3(...obstacle.centre_m));
  });
}

function isOnGround(run: Run, point: Vector3): boolean {
  const {min_m, max_m} = run.ground;
  const slack = OUTSIDE * Math.max(max_m[0] - min_m[0], max_m[1] - min_m[1]);
  const isInside = (axis: 0 | 1, at: number): boolean => at >= min_m[axis] - slack && at <= max_m[axis] + slack;
  return isInside(0, point.x) && isInside(1, point.y);
}

export function heightOf(run: Run, id: number): number {
  return run.models[run.modelOfAvatar[id]].height_m * run.scaleOfAvatar[id];
}

/** Returns the point of a person at a share of its height: 0 for the feet, CHEST for the chest. */
export function pointOf(run: Run, frame: Frame, id: number, share: number, out = new Vector3()): Vector3 {
  const [x, y, z] = [frame.positions[4 * id], frame.positions[4 * id + 1], frame.positions[4 * id + 2]];
  return out.set(x, y, z + share * heightOf(run, id));
}
