// Tests files of many people: poses from the graphics card, levels of detail, exact seeking.
import assert from 'node:assert/strict';
import {join} from 'node:path';
import {before, test} from 'node:test';
import type {Page} from 'playwright-core';
import {folder, open, runs, until} from './driver.ts';

const few = join(folder, 'few.html');
const many = join(folder, 'many.html');

before(() => {
  runs('run', 'robot_in_crowd', '--seconds', '2', '--lcm', 'off', '--log', 'off', '--html', few);
  runs('run', 'city_square', '--avatars', '20000', '--seconds', '0.3', '--lcm', 'off', '--log', 'off', '--html', many);
});

/** Seeks a position and draws it at once. */
const seek = (page: Page, position: number): Promise<unknown> =>
  page.evaluate(`(() => {
    const {source, stage} = window.throng;
    source.playback.playing = false;
    source.playback.position = ${position};
    source.tick(0);
    stage.draw(window.throng.frame, stage.crowd.budget);
  })()`);

/**
 * Returns the poses of all parts in the picture, as shaders see them and as the processor computes them. A pose is
 * x, y, z in metres, the mark, and the quaternion in units of the texels.
 */
const poses = (page: Page): Promise<{drawn: number; seen: number[]; expected: number[]}> =>
  page.evaluate(`(() => {
    const {run, frame, stage} = window.throng;
    const {poser} = stage.crowd;
    const {width, height} = poser.parts;
    const words = new Uint32Array(4 * width * height);
    stage.renderer.readRenderTargetPixels(poser.parts, 0, 0, width, height, words);
    const [gpu, cpu] = [new Int16Array(words.buffer), new Int16Array(frame.parts.buffer)];
    const [seen, expected] = [[], []];
    let drawn = 0;
    for (let id = 0; id < run.avatars; ++id) {
      if (!poser.drawnFlags[id]) continue;
      ++drawn;
      for (let at = run.firstPart[id]; at < run.firstPart[id + 1]; ++at) {
        frame.motion.fillPart(id, at - run.firstPart[id]);
        const step_m = run.models[run.modelOfAvatar[id]].part_step_m;
        for (let i = 0; i < 8; ++i) {
          const unit = i < 3 ? step_m : 1;
          seen.push(gpu[8 * at + i] * unit);
          expected.push(i === 3 ? frame.motion.marks[at] : cpu[8 * at + i] * unit);
        }
      }
    }
    return {drawn, seen, expected};
  })()`);

test('the graphics card computes the poses that the processor computes', async () => {
  const {page, close} = await open(`file://${few}`);
  const first = new Map<number, number[]>();
  // At keys and between them, forwards, backwards and far away.
  for (const position of [0, 3.5, 60, 61.25, 17, 119, 60]) {
    await seek(page, position);
    const {drawn, seen, expected} = await poses(page);
    assert.ok(drawn > 50, `${drawn} people are in the picture`);
    let [worst_m, worst_turn] = [0, 0];
    for (let i = 0; i < seen.length; ++i) {
      const off = Math.abs(seen[i] - expected[i]);
      if (i % 8 === 3) assert.equal(seen[i], expected[i], `a mark at ${position}`);
      else if (i % 8 < 3) worst_m = Math.max(worst_m, off);
      else worst_turn = Math.max(worst_turn, off / 32767);
    }
    // Graphics cards round sines.
    assert.ok(worst_m < 2e-3, `at ${position} a part is off by ${worst_m} m`);
    assert.ok(worst_turn < 2e-3, `at ${position} a part is turned by ${worst_turn}`);
    if (first.has(position)) assert.deepEqual(seen, first.get(position), 'the same frame looks different');
    first.set(position, seen);
  }
  await close();
});

test('seeking in a file shows the sought frame, also while it plays', async () => {
  const {page, close} = await open(`file://${few}`);
  for (const frame of [70, 3, 119, 0]) {
    await page.evaluate(`window.throng.source.playback.playing = false; window.throng.source.playback.seek(${frame})`);
    await until(page, `window.throng.state().frame === ${frame}`);
  }
  const shown = await page.evaluate(`(() => {
    const {source} = window.throng;
    source.playback.playing = true;
    source.playback.seek(50);
    source.tick(0);
    return window.throng.state().frame;
  })()`);
  assert.equal(shown, 50);
  await close();
});

const lists = (page: Page): Promise<number[]> =>
  page.evaluate('window.throng.stage.crowd.draws[0].lists.map((list) => list.count)');

test('20 000 people from afar are at most 500 000 triangles, and a near one is drawn with the full mesh', async () => {
  const {page, close} = await open(`file://${many}`, {width: 1280, height: 720});
  await page.evaluate('window.throng.source.playback.playing = false; window.throng.stage.overview()');
  const draw = (budget: number): Promise<unknown> =>
    page.evaluate(`window.throng.stage.draw(window.throng.frame, ${budget})`);
  for (const budget of [1e5, 6e6]) {
    await draw(budget);
    const drawn = (await lists(page)).reduce((sum, count) => sum + count, 0);
    assert.ok(drawn > 19_000, `${drawn} people are in the picture`);
    const {triangles} = await page.evaluate('window.throng.stage.drawn') as {triangles: number};
    assert.ok(triangles <= 500_000, `${triangles} triangles with a budget of ${budget}`);
  }
  await page.evaluate(`(() => {
    const [x, y] = window.throng.positionOf(0);
    window.throng.stage.setCamera([x + 0.7, y + 0.7, 1.6, x, y, 1.5]);
  })()`);
  await draw(1e5);
  const [full, ...others] = await lists(page);
  assert.ok(full >= 1, 'no full mesh');
  assert.ok(others.at(-1)! > 0, 'no coarse body far away');
  await close();
});

test('hidden bodies cast no shadow, and without shadows walls cast none', async () => {
  const {page, close} = await open(`file://${few}`);
  await seek(page, 0);
  const triangles = async (): Promise<number> => {
    await page.evaluate('window.throng.stage.draw(window.throng.frame, 1e5)');
    return (await page.evaluate('window.throng.stage.drawn') as {triangles: number}).triangles;
  };
  const show = (layer: string, visible: boolean): Promise<unknown> =>
    page.evaluate(`window.throng.stage.show('${layer}', ${visible})`);
  const all = await triangles();
  await show('meshes', false);
  const wallsWithShadows = await triangles();
  await show('shadows', false);
  const walls = await triangles();
  await show('meshes', true);
  const withoutShadows = await triangles();
  const ofWallShadows = await page.evaluate(`window.throng.stage.walls.shadows.children
    .reduce((sum, {geometry}) => sum + (geometry.index ?? geometry.attributes.position).count / 3, 0)`) as number;
  assert.ok(ofWallShadows > 0);
  assert.equal(wallsWithShadows - walls, ofWallShadows);
  assert.ok(all - wallsWithShadows > withoutShadows - walls, 'bodies that are shown cast shadows');
  assert.ok(walls < withoutShadows && withoutShadows < all);
  await show('meshes', false);
  await show('shadows', true);
  assert.equal(await triangles(), wallsWithShadows);
  await close();
});

test('the ground of a resting camera is copied, and each pixel stays the same', async () => {
  const {page, close} = await open(`file://${few}`);
  await page.evaluate('window.throng.source.playback.playing = false');
  for (const theme of ['light', 'dark']) {
    const seen = (await page.evaluate(`(() => {
      const {stage} = window.throng;
      window.throng.chooseTheme('${theme}');
      stage.setCamera(${theme === 'light' ? '[6, -9, 1.7, 6, 4, 1.6]' : '[3, -6, 9, 3, 2, 0]'}); // with sky, and without
      const picture = document.createElement('canvas');
      picture.width = stage.renderer.domElement.width;
      picture.height = stage.renderer.domElement.height;
      return [0, 1, 2].map(() => {
        stage.drawInto(picture, 1e5);
        const {data} = picture.getContext('2d').getImageData(0, 0, picture.width, picture.height);
        return {isCopied: stage.ground.copy.visible, bytes: Array.from(data).join()};
      });
    })()`)) as {isCopied: boolean; bytes: string}[];
    assert.deepEqual(seen.map(({isCopied}) => isCopied), [false, true, true], theme);
    for (const {bytes} of seen.slice(1)) assert.ok(bytes === seen[0].bytes, `${theme}: pixels differ`);
  }
  await close();
});
