// Tests that fitted views show all points, as large as possible.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {PerspectiveCamera, Vector3} from 'three';
import type {Frame, Run} from '../../../viewer/page/src/protocol.ts';
import {around, fit, scenePoints, type Rect, type View} from '../../../viewer/page/src/framing.ts';

const FOV = 40;
const UP = new Vector3(0, 0, 1);
const SLANT = new Vector3(0.36, 0.78, -0.52);

/** A plain of 40 m by 6 m with 2 m of room, and some points inside. */
function corridor(): Vector3[] {
  const points: Vector3[] = [];
  for (const x of [-20, 3, 20]) for (const y of [10, 16]) for (const z of [0, 2]) points.push(new Vector3(x, y, z));
  return points;
}

function cameraOf(view: View, aspect: number, up: Vector3): PerspectiveCamera {
  const camera = new PerspectiveCamera(FOV, aspect, 0.1, 4000);
  camera.up.copy(up);
  camera.position.copy(view.position);
  camera.lookAt(view.target);
  camera.updateMatrixWorld();
  return camera;
}

/** Returns by how much the points fill the rectangle: 1 at its nearest edge. */
function filled(points: Vector3[], camera: PerspectiveCamera, free: Rect): number {
  const [x, y] = [(free.left + free.right) / 2, (free.bottom + free.top) / 2];
  const shares = points.map((point) => {
    const p = point.clone().project(camera);
    assert.ok(p.z < 1, 'a point is behind the camera');
    return Math.max(Math.abs(p.x - x) / (free.right - x), Math.abs(p.y - y) / (free.top - y));
  });
  return Math.max(...shares);
}

const FREE: Rect[] = [
  {left: -1, right: 1, bottom: -1, top: 1},
  {left: -0.5, right: 0.5, bottom: -0.7, top: 0.7},
  {left: -0.9, right: 0.3, bottom: -0.2, top: 0.8},
];

test('all points lie in the free rectangle and at least one at its edge', () => {
  for (const aspect of [16 / 9, 390 / 844])
    for (const free of FREE) {
      const view = fit(corridor(), SLANT, UP, FOV, aspect, free);
      const share = filled(corridor(), cameraOf(view, aspect, UP), free);
      assert.ok(Math.abs(share - 1) < 1e-6, `fills ${share} of the rectangle at ${aspect}`);
    }
});

test('looks along the direction, with the target at the middle depth', () => {
  const view = fit(corridor(), SLANT, UP, FOV, 1, FREE[0]);
  const ahead = view.target.clone().sub(view.position);
  assert.ok(ahead.angleTo(SLANT) < 1e-6);
  const direction = SLANT.clone().normalize();
  const depths = corridor().map((point) => point.dot(direction));
  assert.ok(Math.abs(view.target.dot(direction) - (Math.min(...depths) + Math.max(...depths)) / 2) < 1e-9);
});

test('looks straight down with north up', () => {
  const north = new Vector3(0, 1, 0);
  const view = fit(corridor(), new Vector3(0, 0, -1), north, FOV, 1.5, FREE[1]);
  const camera = cameraOf(view, 1.5, north);
  assert.ok(Math.abs(filled(corridor(), camera, FREE[1]) - 1) < 1e-6);
  assert.ok(new Vector3(0, 16, 0).project(camera).y > new Vector3(0, 10, 0).project(camera).y);
});

test('keeps away from a single point', () => {
  const view = fit([new Vector3(3, 4, 1)], SLANT, UP, FOV, 1, FREE[0]);
  assert.ok(view.position.distanceTo(new Vector3(3, 4, 1)) > 0.1);
});

test('a free rectangle in pixels becomes one around the optical axis', () => {
  const free = around({left: 100, top: 50, right: 500, bottom: 450}, 800, 600, 1);
  assert.deepEqual(free, {left: -0.5, right: 0.5, bottom: -400 / 600, top: 400 / 600});
});

test('a scene has its ground, obstacles on it and people present, but nothing far outside', () => {
  const cube = {positions: new Float32Array([-1, -1, 0, 1, 1, 5]), indices: new Uint32Array()};
  const obstacle = (x: number) => ({name: '', kind: 0, centre_m: [x, 0, 0], heading_rad: 0, mesh: cube});
  const run = {
    avatars: 2,
    ground: {min_m: [-10, -10], max_m: [10, 10], floor: []},
    obstacles: [obstacle(3), obstacle(400)],
    models: [{height_m: 2}],
    modelOfAvatar: new Int16Array(2),
    scaleOfAvatar: new Float32Array([1, 0.5]),
  } as unknown as Run;
  const people = new Uint32Array(8);
  const positions = new Float32Array(people.buffer);
  positions.set([-30, 0, 0], 0);
  positions.set([50, 0, 0], 4);
  people[3] = 1;  // present; the other person is not
  const points = scenePoints(run, {avatars: 2, people, positions} as unknown as Frame);
  const range = (axis: 'x' | 'z') => [Math.min(...points.map((p) => p[axis])), Math.max(...points.map((p) => p[axis]))];
  assert.deepEqual(range('x'), [-30, 10]);
  assert.deepEqual(range('z'), [0, 5]);
});
