// Tests the density on the floor and the separation shortfalls in a real browser.
import assert from 'node:assert/strict';
import {writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';
import type {Page} from 'playwright-core';
import {folder, open, runs, stopped, until, view} from './driver.ts';

const log = join(folder, 'bottleneck.lcmlog');
const html = join(folder, 'bottleneck.html');
const cell = join(folder, 'cell.lcmlog');
const cellHtml = join(folder, 'cell.html');
const EVERY = 6; // frames between the samples of the page

const CART = '<robot name="cart"><link name="body"><collision><origin xyz="0 0 0.5"/><geometry><box size="0.6 0.5 0.8"/></geometry></collision></link></robot>';
const CELL = `
name: cell
step_s: 1/30
duration_s: 5
proximity_m: 1.5
culling: {exact: true}
ground: {min_m: [-6, -3], max_m: [6, 3]}
groups:
  - {name: robots, model: cart.urdf, count: 1, desired_speed_mps: 0.6, spawn: {min_m: [-4, -0.5], max_m: [-3, 0.5]}, goals: [{min_m: [4, -0.5], max_m: [5, 0.5]}]}
  - {name: people, count: 6, spawn: {min_m: [-3, -2], max_m: [5, 2]}, goals: [{min_m: [-5, -2], max_m: [-4, 2]}]}
separation: {reaction_s: 0.1, stopping_s: 0.3, intrusion_m: 0.1, human_uncertainty_m: 0.05, robot_uncertainty_m: 0.02}
`;

before(() => {
  runs('run', 'bottleneck', '--seconds', '3', '--lcm', 'off', '--log', log, '--html', html);
  writeFileSync(join(folder, 'cart.urdf'), CART);
  writeFileSync(join(folder, 'cell.yaml'), CELL);
  runs('run', 'cell.yaml', '--lcm', 'off', '--log', cell, '--html', cellHtml);
});

async function onBoth(file: string, recording: string, check: (page: Page, isServed: boolean) => Promise<void>): Promise<void> {
  const {child, url} = await view(file, '--port', '0');
  for (const address of [url, `file://${recording}`]) {
    const {page, close} = await open(address, {width: 1366, height: 768});
    await page.evaluate('window.throng.source.playback.playing = false');
    await check(page, address === url);
    await close();
  }
  await stopped(child);
}

const csv = (file: string, name: string): string[][] =>
  runs('export', file, '--csv', name).trim().split('\n').slice(1).map((line) => line.split(','));

test('the density is the mean number of people per square metre, as the exported states have it', async () => {
  const states = csv(log, 'states').filter(([frame]) => Number(frame) % EVERY === 0);
  for (const [from_s, to_s] of [[0, Infinity], [1, 2]]) {
    const own = states.filter(([frame]) => Number(frame) >= 60 * from_s && Number(frame) < 60 * to_s);
    const samples = new Set(own.map(([frame]) => frame)).size;
    await onBoth(log, html, async (page, isServed) => {
      await until(page, 'window.throng.source.isComplete');
      await page.evaluate(`window.throng.look.setHeat([${from_s}, ${to_s}], true)`);
      await until(page, `window.throng.source.density.samples === ${samples}`);
      await until(page, 'window.throng.look.cells !== null');
      const cells: {counts: Record<string, number>; columns: number; cell_m: number; min_m: number[]} = await page.evaluate('window.throng.look.cells');
      const counts = Object.values(cells.counts);
      assert.equal(cells.cell_m, 1);
      const expected = new Float32Array(counts.length);
      for (const row of own) {
        const [across, up] = [0, 1].map((axis) => Math.floor(Number(row[4 + axis]) - cells.min_m[axis]));
        expected[up * cells.columns + across] += 1 / samples;
      }
      const sum = (values: Iterable<number>): number => [...values].reduce((total, value) => total + value, 0);
      assert.ok(Math.abs(sum(counts) - own.length / samples) < 1e-3);
      // A file rounds places to 5 mm: few people change their cell.
      const off = sum(counts.map((value, i) => Math.abs(value - expected[i])));
      assert.ok(off < (isServed ? 0.01 : 0.02) * sum(expected), `${off} people in other cells`);
    });
  }
});

test('a map shows the value under the mouse, and a link restores it', async () => {
  const {page, close} = await open(`file://${html}`, {width: 1366, height: 768});
  await page.evaluate('window.throng.source.playback.playing = false; window.throng.stage.topView(true)');
  await page.locator('#viewTab').click();
  for (const [map, unit] of [['density', /^-?[\d.]+, -?[\d.]+ m: \d+\.\d\d people per m²$/], ['contacts', /^-?[\d.]+, -?[\d.]+ m: \d+ contacts?$/]] as const) {
    await page.locator('#heat').focus(); // by keys alone
    await page.locator('#heat').selectOption(map);
    await until(page, 'window.throng.look.cells !== null');
    const most: number[] = await page.evaluate(`(() => {
      const {counts, columns, cell_m, min_m, most} = window.throng.look.cells;
      const i = counts.indexOf(most);
      const [x, y] = [min_m[0] + (i % columns + 0.5) * cell_m, min_m[1] + (Math.floor(i / columns) + 0.5) * cell_m];
      const [u, v] = window.throng.stage.project(x, y, 0);
      return [(u + 1) / 2 * innerWidth, (1 - v) / 2 * innerHeight, x, y, most];
    })()`);
    await page.mouse.move(most[0], most[1]);
    await until(page, "!document.querySelector('#heatTip').hidden");
    const tip = await page.locator('#heatTip').textContent();
    assert.match(tip!, unit);
    const [x, y, value] = /^(\S+), (\S+) m: (\S+)/.exec(tip!)!.slice(1).map(Number);
    assert.ok(Math.hypot(x - most[2], y - most[3]) < 0.2 && Math.abs(value - most[4]) < 0.005, `${tip} of ${most}`);
  }
  await page.locator('#heat').selectOption('density');
  assert.match(await page.evaluate('window.throng.linkText()'), /heat=0,&map=density/);
  await page.locator('#heat').selectOption('');
  assert.equal(await page.locator('#heatTip').isHidden(), true);
  await close();
});

test('separation shortfalls are listed and lead to their frames', async () => {
  const ends = csv(cell, 'separation').filter((row) => row[2] === 'end').map((row) => `${row[6]} ${row[0]} ${row[3]} ${row[4]} ${row[5]}`);
  assert.ok(ends.length > 0);
  await onBoth(cell, cellHtml, async (page) => {
    await until(page, 'window.throng.source.isComplete && window.throng.series.shortfalls.length > 0');
    const shown: [number, number, number, number, string][] = await page.evaluate('window.throng.series.shortfalls');
    assert.deepEqual(shown.map((row) => row.slice(0, 5).join(' ')).sort(), ends.sort());
    await page.locator('#chartsTab').click();
    await page.locator('#shortfalls button').first().focus();
    await page.keyboard.press('Enter');
    await until(page, `window.throng.state().frame === ${shown[0][0]}`);
    assert.deepEqual(await page.evaluate('window.throng.selected'), shown[0].slice(2, 4));
  });
});
