// Tests distances to others without a page: messages, frames and curves.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {valleys} from '../../../viewer/page/src/chart.ts';
import {distanceText, ProximityLog} from '../../../viewer/page/src/proximity.ts';
import {decodeProximity, type ProximityRow} from '../../../viewer/page/src/protocol.ts';

const near = (frame: number, other: number, lo_m: number, hi_m = lo_m): ProximityRow => ({frame, other, part: 0, otherPart: 1, level: 3, lo_m, hi_m, points: null});

function logOf(...rows: ProximityRow[]): ProximityLog {
  const log = new ProximityLog();
  log.reset(7);
  assert.ok(log.take({body: 7, isRecorded: true, from: 0, to: 100, rows}));
  return log;
}

test('rows of a frame come with the nearest first', () => {
  const log = logOf(near(3, 1, 0.5), near(4, 1, 0.4), near(4, 2, 0.1), near(4, 3, 0.1, 0.2), near(9, 1, 0.3));
  assert.deepEqual(log.at(4).map(({other}) => other), [2, 3, 1]);
  assert.deepEqual(log.at(5), []);
  assert.equal(log.least!.other, 2);
});

test('a curve has the least distance of each frame, and gaps', () => {
  const log = logOf(near(3, 1, 0.5), near(4, 1, 0.5), near(4, 2, 0.25), near(98, 1, 0.75));
  assert.deepEqual([...log.distances(2, 6)], [Infinity, 0.5, 0.25, Infinity]);
  assert.equal(log.distances(0, 100)[98], 0.75);
  assert.deepEqual(valleys([3, 2, Infinity, 1, Infinity, Infinity], 3), [2, 1, Infinity]);
});

test('only rows that continue the known ones are taken', () => {
  const log = logOf(near(3, 1, 0.5));
  for (const [body, from] of [[7, 0], [7, 101], [8, 100]])
    assert.equal(log.take({body, isRecorded: true, from, to: 200, rows: [near(150, 1, 0.1)]}), false);
  assert.ok(log.take({body: 7, isRecorded: true, from: 100, to: 200, rows: [near(150, 1, 0.1)]}));
  log.forget(100);
  assert.deepEqual(log.rows.map(({frame}) => frame), [150]);
});

test('a distance shows its bounds if they differ', () => {
  assert.equal(distanceText({lo_m: 0.41012558, hi_m: 0.41012624}), '0.410 m');
  assert.equal(distanceText({lo_m: 0.401, hi_m: 0.417}), '0.40–0.42 m');
});

test('decodes a proximity message and rejects a wrong length', () => {
  const buffer = new ArrayBuffer(32 + 2 * 20 + 48);
  const view = new DataView(buffer);
  [0x31445454, 2, 7, 1].forEach((word, i) => view.setUint32(4 * i, word, true));
  view.setFloat64(24, 5, true);
  for (const [i, lo_m] of [0.25, 0.5].entries()) {
    const at = 32 + 20 * i;
    view.setInt32(at, 4, true);
    view.setUint32(at + 4, 9 + i, true);
    new Uint8Array(buffer, at + 8, 4).set([1, 2, 3, i]);
    view.setFloat32(at + 12, lo_m, true);
    view.setFloat32(at + 16, lo_m + 0.125, true);
  }
  new Float64Array(buffer, 72).set([1, 2, 3, 4, 5, 6]);
  const {rows, ...head} = decodeProximity(buffer);
  assert.deepEqual(head, {body: 7, isRecorded: true, from: 0, to: 5});
  const common = {frame: 4, part: 1, otherPart: 2, level: 3};
  assert.deepEqual(rows, [
    {...common, other: 9, lo_m: 0.25, hi_m: 0.375, points: null},
    {...common, other: 10, lo_m: 0.5, hi_m: 0.625, points: [[1, 2, 3], [4, 5, 6]]},
  ]);
  for (const bytes of [32, 72, 112]) assert.throws(() => decodeProximity(buffer.slice(0, bytes)), RangeError);
});
