// Tests that marks of contacts stay countable, and what people wear.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {spread} from '../../../viewer/page/src/marks.ts';
import {CHOICE_BITS, CLOTHES, clothesOf} from '../../../viewer/page/src/theme.ts';

const RADIUS = 6;

const same = (count: number): Float32Array => new Float32Array(count).fill(RADIUS);

/** Returns points in a square from a fixed sequence. */
function scattered(count: number, size: number): Float32Array {
  const points = new Float32Array(2 * count);
  for (let i = 0, state = 1; i < points.length; ++i) {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    points[i] = 200 + (size * state) / 2 ** 32;
  }
  return points;
}

function nearest(points: Float32Array): number {
  let found = Infinity;
  for (let i = 0; i < points.length; i += 2)
    for (let j = 0; j < i; j += 2)
      found = Math.min(found, Math.hypot(points[i] - points[j], points[i + 1] - points[j + 1]));
  return found;
}

test('marks that overlap none stay', () => {
  const points = new Float32Array([10, 10, 30, 10, 10, 300]);
  assert.deepEqual(spread(points, same(3)), points);
});

test('marks at one point are pushed apart and stay around it', () => {
  for (const count of [2, 5, 40]) {
    const placed = spread(new Float32Array(2 * count).fill(100), same(count));
    assert.ok(nearest(placed) > 1.9 * RADIUS, `${count} marks, ${nearest(placed)} px apart`);
    const reach = 3 * RADIUS * Math.sqrt(count);
    for (const at of placed) assert.ok(Math.abs(at - 100) < reach, `a mark of ${count} at ${at}`);
  }
});

test('crowded marks hardly overlap', () => {
  for (const [count, size] of [[100, 20], [500, 250], [1500, 600]]) {
    const placed = spread(scattered(count, size), same(count));
    assert.ok(nearest(placed) > 1.6 * RADIUS, `${count} marks, ${nearest(placed)} px apart`);
  }
});

test('larger marks get more room', () => {
  const placed = spread(new Float32Array([50, 50, 51, 50]), new Float32Array([6, 9]));
  assert.ok(placed[2] - placed[0] > 14.5);
});

test('equal marks are placed equally, and the given points are kept', () => {
  const points = scattered(300, 100);
  const before = points.slice();
  assert.deepEqual(spread(points, same(300)), spread(points, same(300)));
  assert.deepEqual(points, before);
});

test('thousands of marks stay where they are', () => {
  const many = scattered(3001, 400);
  assert.deepEqual(spread(many, same(3001)), many);
});

test('a person wears the same as in pictures of throng render', () => {
  const worn = [0, 1, 2, 3, 4].map((slot) => {
    const choice = (clothesOf(17) >> (CHOICE_BITS * slot)) & ((1 << CHOICE_BITS) - 1);
    return `#${CLOTHES[(slot << CHOICE_BITS) + choice].getHexString()}`;
  });
  assert.deepEqual(worn, ['#6d7f94', '#4a5261', '#a8775a', '#231f20', '#2b2d33']);
});
