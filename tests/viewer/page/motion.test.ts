// Tests poses of recorded people, levels of detail and the grid of cells.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {Quaternion, Vector3} from 'three';
import {Grid} from '../../../viewer/page/src/cells.ts';
import {Chains} from '../../../viewer/page/src/chains.ts';
import {Motion, type Curves} from '../../../viewer/page/src/motion.ts';
import type {Joint, Model, Run, Vec3} from '../../../viewer/page/src/protocol.ts';
import {largest, limbRibbons, partRibbons} from '../../../viewer/page/src/simplify.ts';

function randomOf(seed: number): () => number {
  let state = seed;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

const unit = (random: () => number): Vec3 =>
  new Vector3(random() - 0.5, random() - 0.5, random() - 0.5).normalize().toArray() as Vec3;

/** A tree of joints of all kinds, some of which repeat another one; a part on every link. */
function anyModel(joints: number, random: () => number): Model {
  let columns = 0;
  const list = Array.from({length: joints}, (_, j): Joint => {
    const mimics = j > 2 && j % 5 === 4;
    const kind = [1, 3, 1, 0, 2][j % 5];
    const rotation = new Quaternion(...unit(random), random()).normalize();
    return {
      name: `joint ${j}`,
      kind: mimics ? 1 : kind,
      parent_link: Math.floor(random() * (j + 1)),
      position_m: [random(), random() - 0.5, random() - 0.5],
      rotation_wxyz: [rotation.w, rotation.x, rotation.y, rotation.z],
      axis: unit(random),
      mimic_joint: mimics ? 0 : -1,
      mimic_multiplier: mimics ? -1.5 : 1,
      mimic_offset: mimics ? 0.3 : 0,
      column: mimics || kind === 0 ? -1 : columns++,
    };
  });
  const box = {centre_m: [0, 0, 0] as Vec3, half_m: [1, 1, 1] as Vec3};
  const parts = Array.from({length: joints + 1}, (_, link) => ({name: `part ${link}`, link, box}));
  return {name: 'any', part_step_m: 1e-3, sphere: {centre_z_m: 0, radius_m: 1}, parts, joints: list} as unknown as Model;
}

/** The slow oracle: the pose of each link from that of its parent. */
function linksOf(model: Model, root: Quaternion, scale: number, columns: number[]): {x: Vector3; q: Quaternion}[] {
  const values = model.joints.map(({column}) => (column >= 0 ? columns[column] : 0));
  const links = [{x: new Vector3(), q: root}];
  model.joints.forEach((joint, j) => {
    const value = joint.mimic_joint >= 0 ? joint.mimic_multiplier * values[joint.mimic_joint] + joint.mimic_offset : values[j];
    const {x, q} = links[joint.parent_link];
    const [rw, rx, ry, rz] = joint.rotation_wxyz;
    const at = new Vector3(...joint.position_m).multiplyScalar(scale).applyQuaternion(q).add(x);
    const turned = q.clone().multiply(new Quaternion(rx, ry, rz, rw));
    const axis = new Vector3(...joint.axis);
    if (joint.kind === 3) at.add(axis.multiplyScalar(value * scale).applyQuaternion(turned));
    else if (joint.kind !== 0) turned.multiply(new Quaternion().setFromAxisAngle(axis, value));
    links.push({x: at, q: turned});
  });
  return links;
}

function assertPose(found: Int16Array, expected: {x: Vector3; q: Quaternion}, step_m: number, name: string): void {
  const x = new Vector3(found[0], found[1], found[2]).multiplyScalar(step_m);
  const q = new Quaternion(found[4], found[5], found[6], found[7]).normalize();
  assert.ok(x.distanceTo(expected.x) < 2 * step_m, `${name} is off by ${x.distanceTo(expected.x)} m`);
  assert.ok(q.angleTo(expected.q) < 3e-4, `${name} is turned by ${q.angleTo(expected.q)} rad`);
}

test('a chain of joints gives the pose of its link', () => {
  for (let seed = 1; seed <= 20; ++seed) {
    const random = randomOf(seed);
    const model = anyModel(14, random);
    const columns = Array.from({length: 14}, () => 2 * random() - 1);
    const root = new Quaternion(...unit(random), random()).normalize();
    const links = linksOf(model, root, 1.1, columns);
    const chains = new Chains([model]);
    const out = new Int16Array(8);
    model.parts.forEach(({name}, part) => {
      chains.pose(0, part, [0, 0, 0, root.x, root.y, root.z, root.w], 1.1, (column) => columns[column], out, 0);
      assertPose(out, links[part], model.part_step_m, `seed ${seed}: ${name}`);
    });
  }
});

/** Two people with three joints each at four keys, ten frames apart. */
function twoPeople(): {motion: Motion; model: Model; roots: number[][][]; amounts: number[][][]} {
  const random = randomOf(5);
  const model = anyModel(3, random);
  const keys = [0, 10, 20, 30];
  const roots = keys.map((_, k) => [0, 1].map((id) => [k + id, 2 * k, 0.5, 0, 0, Math.sin(0.1 * k), Math.cos(0.1 * k), id === 0 || k > 0 ? 1 : 0]));
  const amounts = keys.map(() => [0, 1].map(() => [Math.round(20 * random()), Math.round(20 * random())]));
  const run = {
    avatars: 2,
    step_s: 0.01,
    models: [model],
    modelOfAvatar: Int16Array.of(0, 0),
    scaleOfAvatar: Float32Array.of(1, 0.9),
    firstPart: Uint32Array.of(0, 4, 8),
  } as unknown as Run;
  // In the order of a recording: presence, then x to qw, of each avatar; then the amounts of each direction.
  const order = [7, 0, 1, 2, 3, 4, 5, 6].flatMap((column) => [0, 1].map((id) => roots.map((at) => at[id][column])));
  order.push(...[0, 1].flatMap((c) => [0, 1].map((id) => amounts.map((at) => at[id][c]))));
  const numbers: Curves = {
    curve(out, from, stride, count) {
      const values = order.shift()!;
      for (let i = 0; i < count; ++i) out[from + i * stride] = values[i];
    },
  };
  const basis = {mean: [0.1, 0.2, 0.3], directions: [[0.01, 0.02, 0], [-0.03, 0.01, 0.05]]};
  return {motion: new Motion(run, [basis], keys, {position_step_m: 1, quaternion_step: 1}, numbers), model, roots, amounts};
}

test('people are where a key has them, and move smoothly between keys', () => {
  const {motion, roots} = twoPeople();
  motion.seek(10);
  assert.deepEqual([...motion.positions.subarray(4, 7)], roots[1][1].slice(0, 3));
  assert.equal(motion.people[3] >>> 16, Math.round((1000 * Math.hypot(1, 2)) / 0.1));
  motion.seek(15);
  assert.ok(Math.abs(motion.positions[0] - 1.5) < 1e-6);
  assert.equal(motion.present, 2);
  motion.seek(5);
  assert.equal(motion.present, 1, 'the second person comes at the second key');
});

test('a part is computed on request, at the present time', () => {
  const {motion, model, roots, amounts} = twoPeople();
  const halves = new Int16Array(motion.parts.buffer);
  for (const key of [2, 1, 2]) {
    motion.seek(10 * key);
    [1, 0.9].forEach((scale, id) => {
      const [first, second] = amounts[key][id];
      const columns = [0.1 + 0.01 * first - 0.03 * second, 0.2 + 0.02 * first + 0.01 * second, 0.3 + 0.05 * second];
      const [, , , x, y, z, w] = roots[key][id];
      const links = linksOf(model, new Quaternion(x, y, z, w), scale, columns);
      for (let part = 0; part < 4; ++part) {
        motion.fillPart(id, part);
        const at = 8 * (4 * id + part);
        assertPose(halves.subarray(at, at + 8), links[part], model.part_step_m, `key ${key}, person ${id}, part ${part}`);
      }
    });
  }
});

test('marks of parts end with their frame, and the highest of a part counts', () => {
  const {motion} = twoPeople();
  motion.markPart(1, 2, 3);
  motion.markPart(1, 2, 1);
  motion.markPart(7, 0, 1); // an obstacle
  assert.deepEqual([...motion.marks], [0, 0, 0, 0, 0, 0, 3, 0]);
  motion.clearMarks();
  assert.ok(motion.marks.every((mark) => mark === 0));
});

test('a grid visits each pair of near points once', () => {
  const random = randomOf(11);
  for (const spread of [3, 40, 1e5]) {
    const count = 200;
    const at = Float32Array.from({length: 3 * count}, () => spread * (random() - 0.5));
    const keep = (i: number): boolean => i % 7 !== 0;
    const seen = new Set<string>();
    new Grid(at, 3, count, 2, keep).eachPair((i, j) => {
      const pair = `${Math.min(i, j)} ${Math.max(i, j)}`;
      assert.ok(!seen.has(pair), `${pair} is visited twice`);
      seen.add(pair);
    });
    for (let i = 0; i < count; ++i)
      for (let j = 0; j < i; ++j) {
        const isNear = Math.hypot(at[3 * i] - at[3 * j], at[3 * i + 1] - at[3 * j + 1]) < 2;
        if (isNear && keep(i) && keep(j)) assert.ok(seen.has(`${j} ${i}`), `${j} and ${i} of ${spread} m are missing`);
        if (!keep(i) || !keep(j)) assert.ok(!seen.has(`${j} ${i}`));
      }
  }
});

/** Pelvis, torso, head, and a leg and an arm of three parts each. */
function body(): Model {
  const parents = [0, 1, 2, 2, 4, 5, 1, 7, 8];
  const names = ['pelvis', 'torso', 'head', 'upperArm', 'lowerArm', 'hand', 'upperLeg', 'lowerLeg', 'foot'];
  const half = (name: string): Vec3 => (name === 'foot' ? [0.13, 0.05, 0.05] : [0.06, 0.05, 0.2]);
  return {
    joints: parents.map((parent_link) => ({parent_link})),
    parts: names.map((name, i) => ({name, link: i + 1, box: {centre_m: [0, 0, i < 3 ? 0.2 : -0.2], half_m: half(name)}})),
  } as unknown as Model;
}

test('ribbons replace each part, and of more distant people each limb', () => {
  const model = body();
  assert.equal(partRibbons(model).length, 9);
  const limbs = limbRibbons(model).map(([first, last]) => [model.parts[first.part].name, model.parts[last.part].name]);
  assert.deepEqual(limbs, [
    ['pelvis', 'pelvis'],
    ['torso', 'torso'],
    ['head', 'head'],
    ['upperArm', 'lowerArm'],
    ['upperLeg', 'lowerLeg'],
  ]);
  const [hip, ankle] = limbRibbons(model)[4];
  assert.deepEqual([hip.at, hip.axis], [[0, 0, 0], [0, 0, -1]]);
  assert.deepEqual([ankle.at, ankle.axis], [[0, 0, -0.4], [0, 0, -1]]);
  assert.equal(largest(limbRibbons(model), model, 2).length, 2);
});
