// Tests the table of contacts without a page: contacts, filters, search, colours and links.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {scaleColor} from '../../../viewer/page/src/coloring.ts';
import {ContactLog} from '../../../viewer/page/src/contacts.ts';
import {choosesPerson, countsByPart, matches, NO_FILTER, partNames, select, type Filter} from '../../../viewer/page/src/filter.ts';
import {find} from '../../../viewer/page/src/find.ts';
import {heatOf} from '../../../viewer/page/src/heat.ts';
import {readLink, withTheme, writeLink, type PageView} from '../../../viewer/page/src/link.ts';
import {decodeContacts, type ContactChange, type Run} from '../../../viewer/page/src/protocol.ts';

const began = (frame: number, a: number, b: number, partA = 0, partB = 0): ContactChange => ({kind: 'began', frame, began: frame, a, b, partA, partB, x_m: a, y_m: b});
const ended = (frame: number, a: number, b: number, partA = 0, partB = 0): ContactChange => ({...began(frame, a, b, partA, partB), kind: 'ended'});

function logOf(...changes: ContactChange[]): ContactLog {
  const log = new ContactLog();
  log.take(changes, 99);
  return log;
}

/** Three people in two groups, a robot (3) and a wall (4). */
const run = {
  step_s: 0.1,
  avatars: 4,
  groups: ['east', 'west', 'robots'],
  groupOfAvatar: Int16Array.of(0, 1, 1, 2),
  modelOfAvatar: Int16Array.of(0, 0, 0, 1),
  models: [
    {name: 'person', is_person: true, parts: [{name: 'head'}, {name: 'leftHand'}]},
    {name: 'cart', is_person: false, parts: [{name: 'arm'}]},
  ],
  obstacles: [{name: 'north wall'}],
} as unknown as Run;

test('a contact of bodies lasts from the first begin to the last end of their parts', () => {
  const log = logOf(began(10, 0, 1, 0, 0), began(12, 0, 1, 1, 1), ended(14, 0, 1, 0, 0), ended(20, 0, 1, 1, 1), began(30, 0, 1), ended(31, 0, 1));
  assert.deepEqual(log.ofBodies.map(({begin, end, parts}) => [begin, end, parts]), [[10, 20, 2], [30, 31, 1]]);
  assert.deepEqual(log.ofParts.map(({begin, end}) => [begin, end]), [[10, 14], [12, 20], [30, 31]]);
});

test('a contact goes on if other parts begin in the frame in which the last ones end', () => {
  for (const changes of [[ended(20, 0, 1, 0, 0), began(20, 0, 1, 1, 1)], [began(20, 0, 1, 1, 1), ended(20, 0, 1, 0, 0)]]) {
    const log = logOf(began(10, 0, 1, 0, 0), ...changes, ended(25, 0, 1, 1, 1));
    assert.deepEqual(log.ofBodies.map(({begin, end, parts}) => [begin, end, parts]), [[10, 25, 2]]);
  }
});

test('contacts of random changes equal those of frame sets', () => {
  for (let seed = 1; seed <= 200; ++seed) {
    let state = seed;
    const random = (n: number): number => (state = (state * 48271) % 2147483647) % n;
    const changes: ContactChange[] = [];
    const touching = new Map<string, number>();
    const framesOf = new Map<string, Set<number>>();
    for (let frame = 0; frame < 60; ++frame) {
      for (let i = 0; i < 4; ++i) {
        const [a, b, partA, partB] = [random(2), 2 + random(2), random(2), random(2)];
        const key = `${a} ${b} ${partA} ${partB}`;
        if (touching.get(key) === frame) continue;
        if (touching.has(key)) changes.push(ended(frame, a, b, partA, partB));
        else changes.push(began(frame, a, b, partA, partB));
        if (!touching.delete(key)) touching.set(key, frame);
        else if (random(3) === 0) continue;
      }
      for (const key of touching.keys()) {
        const bodies = key.slice(0, 3);
        if (!framesOf.has(bodies)) framesOf.set(bodies, new Set());
        framesOf.get(bodies)!.add(frame);
      }
    }
    const log = new ContactLog();
    log.take(changes, 59);
    const expected = [...framesOf].flatMap(([bodies, frames]) => [...frames].filter((frame) => !frames.has(frame - 1)).map((frame) => `${bodies} ${frame}`));
    assert.deepEqual(log.ofBodies.map(({a, b, begin}) => `${a} ${b} ${begin}`).sort(), expected.sort(), `seed ${seed}`);
    const total = [...framesOf.values()].reduce((sum, frames) => sum + frames.size, 0);
    assert.equal(log.ofBodies.reduce((sum, contact) => sum + log.frames(contact), 0), total, `seed ${seed}`);
  }
});

test('contacts that ended are forgotten, those that last stay', () => {
  const log = logOf(began(1, 0, 1), ended(5, 0, 1), began(2, 0, 2), began(50, 1, 2), ended(60, 1, 2));
  log.forget(20);
  assert.deepEqual(log.ofBodies.map(({begin}) => begin), [2, 50]);
});

test('a filter chooses by group, body, part, length and other body', () => {
  const log = logOf(began(0, 0, 1, 0, 1), ended(2, 0, 1, 0, 1), began(1, 1, 2), ended(9, 1, 2), began(3, 2, 3), ended(7, 2, 3), began(5, 0, 4), ended(6, 0, 4));
  const pairs = (filter: Partial<Filter>): string[] => select(run, {...NO_FILTER, ...filter}, log).map(({a, b}) => `${a}-${b}`);
  assert.deepEqual(pairs({}), ['0-1', '1-2', '2-3', '0-4']);
  assert.deepEqual(pairs({with: 'people'}), ['0-1', '1-2']);
  assert.deepEqual(pairs({with: 'robots'}), ['2-3']);
  assert.deepEqual(pairs({with: 'obstacles'}), ['0-4']);
  assert.deepEqual(pairs({group: 'east'}), ['0-1', '0-4']);
  assert.deepEqual(pairs({body: 2}), ['1-2', '2-3']);
  assert.deepEqual(pairs({ofParts: true, part: 'left hand'}), ['0-1']);
  assert.deepEqual(pairs({min_s: 0.4}), ['1-2', '2-3']);
  assert.deepEqual(pairs({order: 'length', isDescending: true}), ['1-2', '2-3', '0-1', '0-4']);
  assert.deepEqual(partNames(run), ['head', 'left hand', 'arm']);
  assert.equal(matches(run, {...NO_FILTER, body: 3}, {a: 2, b: 3, partA: 0, partB: 0}), true);
  assert.deepEqual([0, 1, 2, 3].map((id) => choosesPerson(run, {...NO_FILTER, with: 'robots'}, id)), [false, false, false, true]);
});

test('contacts by part count for both bodies', () => {
  const log = logOf(began(0, 0, 1, 0, 1), ended(2, 0, 1, 0, 1), began(3, 1, 2, 1, 1), began(4, 2, 3, 0, 0), began(5, 0, 4, 1, 0));
  assert.deepEqual(countsByPart(run, NO_FILTER, log), [['left hand', 4], ['head', 2], ['arm', 1]]);
  assert.deepEqual(countsByPart(run, {...NO_FILTER, with: 'robots'}, log), [['arm', 1], ['head', 1]]);
});

test('a search finds numbers, groups, robots and obstacles', () => {
  const names = (query: string): string[] => find(run, query).map(({name}) => name);
  assert.deepEqual(names('2'), ['west 2']);
  assert.deepEqual(names('west'), ['group west', 'west 1', 'west 2']);
  assert.deepEqual(names('wall'), ['north wall']);
  assert.equal(names('cart')[0], 'robots 3');
  assert.deepEqual(names(' '), []);
  assert.deepEqual(names('nowhere'), []);
});

test('a link restores the view', () => {
  const view: PageView = {
    frame: 254,
    selected: [312, 15],
    parts: [3, 14],
    isFollowing: true,
    tab: 'view',
    camera: [1.23456, -2, 3, 0.5, 0, 1],
    layers: ['meshes', 'hulls'],
    coloring: 'speed',
    heat: [10, Infinity],
    isDensity: true,
    filter: {...NO_FILTER, ofParts: true, with: 'robots', group: 'a, b & c=d', part: 'left hand', min_s: 0.25, order: 'length', isDescending: true},
    theme: 'dark',
  };
  const {camera, ...rest} = readLink(`#${writeLink(view)}`);
  const {camera: expected, ...same} = view;
  assert.deepEqual(rest, same);
  camera!.forEach((value, i) => assert.ok(Math.abs(value - expected[i]) < 1e-3));
});

test('a link takes another theme and keeps the rest', () => {
  const text = '#frame=3&camera=1,2,3,0.5,0,1&theme=light';
  assert.deepEqual(readLink(withTheme(text, 'dark')), {...readLink(text), theme: 'dark'});
  assert.equal(withTheme('', 'dark'), 'theme=dark');
  assert.equal(readLink('#theme=pink').theme, undefined);
});

test('text that is no link changes nothing', () => {
  assert.deepEqual(readLink(''), {});
  for (const camera of ['1,2', '0,0,0,0,0,0', '1e30,0,0,0,0,0', 'nan']) assert.equal(readLink(`#camera=${camera}`).camera, undefined);
  const view = readLink('#frame=-3&selected=a,b&camera=1,2&color=pink&order=up&min=-1&body=x');
  assert.deepEqual(view, {selected: [], heat: null, filter: NO_FILTER});
});

test('a contacts message states changes with their parts', () => {
  const buffer = new ArrayBuffer(32 + 2 * 28);
  const head = new DataView(buffer);
  head.setUint32(0, 0x31435454, true);
  head.setUint32(4, 2, true);
  [7, 9, 120].forEach((value, i) => head.setFloat64(8 + 8 * i, value, true));
  const words = [100, ~90, 3, 4, 1 | (255 << 8), 0, 0, 120, 100, 3, 4, 1 | (255 << 8) | (1 << 16), 0, 0];
  new Int32Array(buffer, 32).set(words);
  new Float32Array(buffer, 32).set([2.5, -1], 5);
  assert.deepEqual(decodeContacts(buffer), {
    first: 7,
    known: 9,
    frame: 120,
    changes: [
      {kind: 'began', frame: 100, began: ~90, a: 3, b: 4, partA: 1, partB: 255, x_m: 2.5, y_m: -1},
      {kind: 'ended', frame: 120, began: 100, a: 3, b: 4, partA: 1, partB: 255, x_m: 0, y_m: 0},
    ],
  });
  assert.throws(() => decodeContacts(buffer.slice(0, 60)), RangeError);
});

test('cells of the floor map sum to the contacts, also of places off the ground', () => {
  const ground = {min_m: [-2, 1], max_m: [3, 4], floor: []};
  const log = logOf(...Array.from({length: 50}, (_, i) => ({...began(i, 0, 1, i, 0), x_m: i / 5 - 4, y_m: (i * 7) % 6})));
  const {counts, columns, rows, cell_m} = heatOf({...run, ground} as unknown as Run, log.ofParts);
  assert.deepEqual([columns, rows, cell_m], [10, 6, 0.5]);
  assert.equal(counts.reduce((sum, count) => sum + count, 0), 50);
  const {counts: one} = heatOf({...run, ground} as unknown as Run, [{...log.ofParts[0], x_m: -1.4, y_m: 1.6}]);
  assert.equal(one[1 * 10 + 1], 1);
});

test('colours of a scale grow evenly in lightness', () => {
  const light = (value: number): number => scaleColor(value).reduce((sum, c, i) => sum + [0.2126, 0.7152, 0.0722][i] * c, 0);
  for (let i = 0; i < 20; ++i) assert.ok(light((i + 1) / 20) > light(i / 20));
});
