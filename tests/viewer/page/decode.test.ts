// Tests decoding of binary messages, and names, charts and simplified meshes.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {peaks, roundUp} from '../../../viewer/page/src/chart.ts';
import {counted} from '../../../viewer/page/src/dom.ts';
import {decodeFrame, kindOf, nameOf, pairsOf, partNameOf, personOf, displayName, type Run} from '../../../viewer/page/src/protocol.ts';
import {crowded, cubic} from '../../../viewer/page/src/motion.ts';
import {Varints} from '../../../viewer/page/src/replay.ts';
import {simplified, sleeve, vertexNormals} from '../../../viewer/page/src/simplify.ts';

/** A frame message of two people, three parts and two pairs. */
function frameBytes(): ArrayBuffer {
  const buffer = new ArrayBuffer(64 + 2 * 16 + 3 * 16 + 2 * 16);
  const view = new DataView(buffer);
  [0x31465454, 2, 3, 2].forEach((word, i) => view.setUint32(4 * i, word, true));
  view.setFloat64(16, 42, true);
  view.setFloat64(24, 0.7, true);
  view.setFloat64(32, 43, true);
  view.setUint32(48, 1, true);
  view.setUint32(52, 2, true);
  [1.5, -2.5, 0].forEach((x, i) => view.setFloat32(64 + 4 * i, x, true));
  view.setUint32(64 + 12, 1 | 2 | (3 << 8) | (1340 << 16), true);
  const pairsAt = 64 + 2 * 16 + 3 * 16;
  [0, 1, 2 | (5 << 8) | (2 << 16), 30, 0, 7, 255 | (255 << 8), ~12].forEach((word, i) => view.setUint32(pairsAt + 4 * i, word, true));
  return buffer;
}

test('a frame is views into the received bytes', () => {
  const buffer = frameBytes();
  const frame = decodeFrame(buffer);
  assert.equal(kindOf(buffer), 'frame');
  assert.deepEqual([frame.number, frame.time_s, frame.seq, frame.avatars, frame.pairs], [42, 0.7, 43, 2, 2]);
  assert.equal(frame.people.buffer, buffer);
  assert.equal(frame.parts.buffer, buffer);
  assert.equal(frame.parts.length, 12);
});

test('a person has a position, a speed and a mark', () => {
  const person = personOf(decodeFrame(frameBytes()), 0);
  assert.deepEqual(person, {present: true, crowded: true, mark: 3, speed_mps: 1.34, position_m: [1.5, -2.5, 0]});
  assert.equal(personOf(decodeFrame(frameBytes()), 1).present, false);
});

test('pairs of a person state both parts and the level', () => {
  const frame = decodeFrame(frameBytes());
  assert.deepEqual(pairsOf(frame, 1), [{a: 0, b: 1, partA: 2, partB: 5, level: 2, began: 30}]);
  assert.deepEqual(pairsOf(frame, 0).map(({began}) => began), [30, ~12]);
  assert.equal(pairsOf(frame, 3).length, 0);
});

test('bytes of another length or kind are rejected', () => {
  const buffer = frameBytes();
  assert.throws(() => decodeFrame(buffer.slice(0, buffer.byteLength - 4)), RangeError);
  assert.throws(() => decodeFrame(new ArrayBuffer(64)), RangeError);
  assert.throws(() => decodeFrame(new ArrayBuffer(3)), RangeError);
});

test('decoding 5000 people copies no part', () => {
  const buffer = new ArrayBuffer(64 + 5000 * 16 + 75_000 * 16);
  const view = new DataView(buffer);
  [0x31465454, 5000, 75_000, 0].forEach((word, i) => view.setUint32(4 * i, word, true));
  const frame = decodeFrame(buffer);
  assert.equal(frame.parts.byteOffset, 64 + 5000 * 16);
  assert.equal(frame.parts.buffer, buffer, 'parts were copied');
});

test('people and parts have readable names', () => {
  const run = {
    avatars: 2,
    groups: ['visitors', 'staff'],
    groupOfAvatar: Int16Array.of(0, 1),
    modelOfAvatar: Int16Array.of(0, 0),
    models: [{parts: [{name: 'upperLeftArm'}]}],
    obstacles: [{name: 'north wall'}],
  } as unknown as Run;
  assert.equal(nameOf(run, 1), 'staff 1');
  assert.equal(nameOf(run, 2), 'north wall');
  assert.equal(partNameOf(run, 0, 0), 'upper left arm');
  assert.equal(partNameOf(run, 0, 255), 'body');
  const names = {
    RightHand: 'right hand',
    upperRightLeg: 'upper right leg',
    left_hip_pitch_link: 'left hip pitch link',
    left__Hand_: 'left hand',
    wrist3Link: 'wrist3 link',
    URDFLink: 'urdf link',
    LElbow: 'l elbow',
    torso: 'torso',
    _: '_',
  };
  for (const [name, expected] of Object.entries(names)) assert.equal(displayName(name), expected);
});

test('counted nouns are singular for one', () => {
  assert.deepEqual([0, 1, 2].map((n) => counted(n, 'pair')), ['0 pairs', '1 pair', '2 pairs']);
  assert.deepEqual([1, 1234].map((n) => counted(n, 'person', 'people')), ['1 person', '1\u202f234 people']);
});

test('varints decode with their signs', () => {
  const numbers = [0, -1, 1, 63, -64, 64, 300, -70_000, 2 ** 40];
  const bytes: number[] = [];
  for (const number of numbers) {
    let folded = number < 0 ? -2 * number - 1 : 2 * number;
    for (; folded >= 128; folded = Math.floor(folded / 128)) bytes.push((folded % 128) + 128);
    bytes.push(folded);
  }
  const reader = new Varints(Uint8Array.from(bytes));
  assert.deepEqual(numbers.map(() => reader.next()), numbers);
  assert.throws(() => reader.next(), RangeError);
});

test('a cubic passes through its keys', () => {
  const through = (t: number, keys: number[]): number => cubic(t).reduce((sum, w, i) => sum + w * keys[i], 0);
  assert.equal(through(0, [9, 1, 2, 7]), 1);
  assert.equal(through(1, [9, 1, 2, 7]), 2);
  assert.equal(through(0.5, [0, 1, 2, 3]), 1.5);
});

test('crowded spheres equal those of all pairs', () => {
  let state = 7;
  const random = (): number => (state = (state * 48271) % 2147483647) / 2147483647;
  const spheres = new Float32Array(4 * 300);
  for (let i = 0; i < 300; ++i) spheres.set([40 * random() - 20, 30 * random() - 25, random(), i % 9 ? random() : 0], 4 * i);
  const expected = new Uint8Array(300);
  for (let i = 0; i < 300; ++i)
    for (let j = i + 1; j < 300; ++j) {
      const [a, b] = [spheres.subarray(4 * i, 4 * i + 4), spheres.subarray(4 * j, 4 * j + 4)];
      if (a[3] > 0 && b[3] > 0 && Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) <= a[3] + b[3]) expected[i] = expected[j] = 1;
    }
  assert.deepEqual(crowded(spheres), expected);
  assert.ok(expected.includes(1) && expected.includes(0), 'the test covers both values');
});

test('a simplified mesh has fewer triangles in the same box', () => {
  const positions: number[] = [];
  const indices: number[] = [];
  const size = 40;
  for (let y = 0; y <= size; ++y) for (let x = 0; x <= size; ++x) positions.push(x / size, y / size, 0);
  for (let y = 0; y < size; ++y)
    for (let x = 0; x < size; ++x) {
      const at = y * (size + 1) + x;
      indices.push(at, at + 1, at + size + 1, at + 1, at + size + 2, at + size + 1);
    }
  const mesh = {positions: Float32Array.from(positions), indices: Uint32Array.from(indices)};
  const coarse = simplified(mesh, 0.1);
  assert.ok(coarse.indices.length < mesh.indices.length / 4, `${coarse.indices.length / 3} triangles`);
  assert.ok(coarse.positions.every((x) => x >= 0 && x <= 1));
  const normals = vertexNormals(coarse);
  for (let i = 2; i < normals.length; i += 3) assert.ok(normals[i] > 0.99);
});

test('a sleeve is closed, faces outwards and has the width of the limb', () => {
  const positions: number[] = [];
  for (let z = -10; z <= 10; ++z)
    for (let i = 0; i < 16; ++i) positions.push(0.05 * Math.cos(i), 0.04 * Math.sin(i), 0.02 * z);
  const limb = {positions: Float32Array.from(positions), indices: new Uint32Array()};
  const box = {centre_m: [0, 0, 0] as [number, number, number], half_m: [0.05, 0.04, 0.2] as [number, number, number]};
  for (const [rings, sides] of [[2, 4], [3, 5], [6, 8]]) {
    const mesh = sleeve(limb, box, rings, sides);
    assert.equal(mesh.indices.length / 3, 2 * sides * (rings - 1) + 2 * (sides - 2));
    const edges = new Map<string, number>();
    for (let t = 0; t < mesh.indices.length; t += 3)
      for (let k = 0; k < 3; ++k) {
        const [a, b] = [mesh.indices[t + k], mesh.indices[t + ((k + 1) % 3)]];
        edges.set(`${a},${b}`, (edges.get(`${a},${b}`) ?? 0) + 1);
      }
    for (const [edge, count] of edges) {
      assert.equal(count, 1, `edge ${edge} occurs twice in the same direction`);
      assert.ok(edges.has(edge.split(',').reverse().join(',')), `edge ${edge} is open`);
    }
    const normals = vertexNormals(mesh);
    let widest = 0;
    for (let v = 0; v < normals.length; v += 3) {
      const out = normals[v] * mesh.positions[v] + normals[v + 1] * mesh.positions[v + 1] + normals[v + 2] * mesh.positions[v + 2];
      assert.ok(out > 0, `corner ${v / 3} faces inwards`);
      assert.ok(Math.abs(mesh.positions[v + 2]) < 0.2001);
      widest = Math.max(widest, Math.abs(mesh.positions[v]));
    }
    assert.ok(widest > 0.04 && widest < 0.07, `${widest} m wide`);
  }
});

test('a part without vertices in the middle becomes a whole sleeve', () => {
  const ends = {positions: Float32Array.of(-1, -1, -5, 1, 1, -5, -1, -1, 5, 1, 1, 5), indices: new Uint32Array()};
  const mesh = sleeve(ends, {centre_m: [0, 0, 0], half_m: [1, 1, 5]}, 5, 4);
  assert.ok(mesh.positions.every((x) => Math.abs(x) < 5.001));
});

test('charts keep their peaks and have round maxima', () => {
  const values = new Array(1000).fill(1);
  values[637] = 50;
  assert.equal(Math.max(...peaks(values, 90)), 50);
  assert.deepEqual([0, 0.7, 3, 17, 999].map(roundUp), [1, 1, 5, 20, 1000]);
});
