// Tests distances to others in a real browser: they equal the exported rows, and lead to their frames.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import {readFileSync, statSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join} from 'node:path';
import {before, test} from 'node:test';
import type {Page} from 'playwright-core';
import type {ProximityRow} from '../../../viewer/page/src/protocol.ts';
import {browser, children, folder, open, runs, stopped, until, view} from './driver.ts';

const SECONDS = 4;
const FRAMES = 60 * SECONDS;
const log = join(folder, 'robots.lcmlog');
const html = join(folder, 'robots.html');
const crowd = join(folder, 'crowd.lcmlog');
const crowdHtml = join(folder, 'crowd.html');

before(() => {
  const robots = ['robot_in_crowd', '--proximity', '0.6', '--exact', '--filter-groups', 'robots: people'];
  runs('run', ...robots, '--seconds', String(SECONDS), '--lcm', 'off', '--log', log);
  runs('view', log, '--html', html);
  // Distances between volumes, also to walls and of the closest parts of two people.
  runs('run', 'bottleneck', '--proximity', '0.3', '--closest-parts', '0.5', '--seconds', '1', '--lcm', 'off', '--log', crowd, '--html', crowdHtml);
});

/** Returns the exported rows of the nearest parts of each two bodies in each frame, by frame and bodies. */
function exported(file: string): Map<string, string[]> {
  const nearest = new Map<string, string[]>();
  const rows = runs('export', file, '--csv', 'proximity').trim().split('\n').slice(1).map((line) => line.split(','));
  for (const row of rows) {
    const key = `${row[0]} ${row[3]} ${row[4]}`;
    const known = nearest.get(key);
    const less = known ? Number(row[10]) - Number(known[10]) || Number(row[11]) - Number(known[11]) : -1;
    if (less < 0) nearest.set(key, row);
  }
  return nearest;
}

async function rowsOf(page: Page, body: number, frames: number): Promise<ProximityRow[]> {
  await page.evaluate(`window.throng.source.loadProximity(${body})`);
  await until(page, `window.throng.source.proximity.to >= ${frames}`);
  return page.evaluate('window.throng.source.proximity.rows');
}

async function onBoth(file: string, recording: string, check: (page: Page) => Promise<void>): Promise<void> {
  const {child, url} = await view(file, '--port', '0');
  for (const address of [url, `file://${recording}`]) {
    const {page, close} = await open(address, {width: 1366, height: 768});
    await page.evaluate('window.throng.source.playback.playing = false');
    await check(page);
    await close();
  }
  await stopped(child);
}

for (const [name, file, recording, frames, bodies] of [
  ['by triangles', log, html, FRAMES, [0, 1, 2, 3]],
  ['by volumes', crowd, crowdHtml, 60, [0, 17, 63, 149]],
] as const)
  test(`distances ${name} equal the exported proximity rows`, async () => {
    const expected = exported(file);
    await onBoth(file, recording, async (page) => {
      let compared = 0;
      for (const body of bodies) {
        const own = [...expected.values()].filter((row) => Number(row[3]) === body || Number(row[4]) === body);
        const rows = await rowsOf(page, body, frames);
        assert.equal(rows.length, own.length, `rows of ${body}`);
        for (const {frame, other, lo_m, hi_m, level, points} of rows) {
          const row = expected.get(`${frame} ${Math.min(body, other)} ${Math.max(body, other)}`)!;
          const [near, far] = body < other ? [12, 15] : [15, 12];
          assert.deepEqual([level, lo_m, hi_m], [Number(row[9]), Math.fround(Number(row[10])), Math.fround(Number(row[11]))]);
          assert.equal(points === null, row[12] === '');
          points?.forEach((point, i) => point.forEach((at, axis) => assert.equal(Number(at.toFixed(6)), Number(row[(i === 0 ? near : far) + axis]))));
          ++compared;
        }
      }
      assert.ok(compared > 300, `${compared} rows`);
    });
  });

test('a click on the least distance of the curve shows its frame, with a line between the closest points', async () => {
  await onBoth(log, html, async (page) => {
    await page.evaluate('window.throng.choose(1)');
    await until(page, `window.throng.source.proximity.to >= ${FRAMES} && !document.querySelector('#near').hidden`);
    const least: ProximityRow = await page.evaluate('window.throng.source.proximity.least');
    const atLeast = `window.throng.state().frame === ${least.frame}`;
    await until(page, "document.querySelector('#nearChart').getBoundingClientRect().width > 0");
    const box = (await page.locator('#nearChart').boundingBox())!;
    await page.mouse.click(box.x + (box.width * least.frame) / (FRAMES - 1), box.y + box.height / 2);
    await until(page, atLeast);
    await until(page, `window.throng.stage.marks.distances.rows.length > 0`);
    const ends: number[][] = await page.evaluate('window.throng.stage.marks.distances.rows[0].points');
    assert.ok(Math.abs(Math.hypot(...ends[0].map((x, axis) => x - ends[1][axis])) - least.hi_m) < 1e-4);
    await until(page, `document.querySelector('#nearPairs time')?.textContent === '${least.lo_m.toFixed(3)} m'`);
    // Elsewhere on the curve, and back by keys alone.
    await page.mouse.click(box.x + 1, box.y + 5);
    await until(page, 'window.throng.state().frame < 8');
    await page.locator('#nearLeast').focus();
    await page.keyboard.press('Shift+Tab');
    assert.equal(await page.evaluate('document.activeElement.id'), 'nearChart');
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('Tab');
    await page.keyboard.press('Enter');
    await until(page, atLeast);
    await until(page, `document.querySelector('#nearChart').getAttribute('aria-valuenow') === '${least.frame}'`);
  });
});

test('the distances have no violation of accessibility rules', async () => {
  const axe = readFileSync(createRequire(`${process.env.NPM}/`).resolve('axe-core/axe.min.js'), 'utf8');
  for (const viewport of [{width: 1366, height: 768}, {width: 390, height: 844}]) {
    const {page, close} = await open(`file://${html}`, viewport);
    await page.addScriptTag({content: axe});
    await page.evaluate('window.throng.source.playback.playing = false; window.throng.choose(1); window.throng.togglePanel(false)');
    await page.evaluate('window.throng.rest(window.throng.source.proximity.least.frame)');
    for (const theme of ['light', 'dark']) {
      await page.evaluate(`window.throng.setTheme('${theme}')`);
      await page.waitForTimeout(600);
      const found: {id: string; nodes: {html: string}[]}[] = await page.evaluate('axe.run().then(({violations}) => violations)');
      assert.deepEqual(found.map(({id, nodes}) => `${id}: ${nodes.map((node) => node.html.slice(0, 120)).join(' | ')}`), [], theme);
    }
    await close();
  }
});

test('a live run shows the distances of the received frames', async (t) => {
  if (process.env.NO_MULTICAST) return t.skip('no multicast route, and no separate network namespace');
  const lcm = `udpm://239.255.76.67:${20_000 + ((process.pid + 7) % 20_000)}?ttl=0&recv_buf_size=2097152`;
  const {child, url} = await view('--lcm', lcm, '--port', '0');
  const page = await browser.newPage({viewport: {width: 1366, height: 768}});
  await page.goto(url);
  await until(page, "document.querySelector('#notice').textContent.includes('Waiting')");
  const player = spawn('lcm-logplayer', [`--lcm-url=${lcm}`, '--speed=0.3', log], {stdio: 'ignore'});
  children.push(player);
  await until(page, 'window.throng.state().frame >= 0');
  await page.evaluate('window.throng.choose(1)');
  await until(page, `window.throng.source.proximity.to >= ${FRAMES}`);
  await until(page, "document.querySelector('#nearLeast').textContent.startsWith('Least: ')");
  assert.equal(await page.locator('#nearLeast').isDisabled(), true);
  const expected = exported(log);
  const rows: ProximityRow[] = await page.evaluate('window.throng.source.proximity.rows');
  assert.ok(rows.length > 20);
  for (const {frame, other, lo_m} of rows) assert.equal(lo_m, Math.fround(Number(expected.get(`${frame} ${Math.min(1, other)} ${Math.max(1, other)}`)![10])));
  await page.close();
  await stopped(player);
  await stopped(child);
});

test('a run without margins has no distances, and a robot names the option that records them', async () => {
  const plain = join(folder, 'plain.lcmlog');
  runs('run', 'robot_in_crowd', '--seconds', '0.5', '--lcm', 'off', '--log', plain);
  const {child, url} = await view(plain, '--port', '0');
  const {page, close} = await open(url);
  await page.evaluate('window.throng.choose(20)');
  await until(page, 'window.throng.source.proximity.to >= 30');
  assert.equal(await page.locator('#near').isHidden(), true);
  const robot = await page.evaluate(`(({modelOfAvatar, models}) =>
    modelOfAvatar.findIndex((model) => !models[model].is_person))(window.throng.run)`);
  await page.evaluate(`window.throng.choose(${robot})`);
  await page.locator('#nearPairs:has-text("--proximity")').waitFor();
  await close();
  await stopped(child);
});

test('a file leaves out distances that do not fit', async () => {
  const small = join(folder, 'small.html');
  runs('view', crowd, '--html', small);
  const whole_mb = statSync(small).size / 1e6;
  runs('view', crowd, '--html', small, '--html-limit-mb', String(whole_mb - 0.001));
  const {page, close} = await open(`file://${small}`);
  await page.evaluate('window.throng.choose(17)');
  await until(page, "document.querySelector('#nearPairs').textContent.startsWith('left out of this file')");
  await close();
});
