// Tests the table of contacts, filters, search and links in a real browser.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join} from 'node:path';
import {before, test} from 'node:test';
import type {Page} from 'playwright-core';
import {browser, folder, open, runs, stopped, until, view} from './driver.ts';

const log = join(folder, 'bottleneck.lcmlog');
const html = join(folder, 'bottleneck.html');
const STEP_S = 1 / 60;

interface Row {
  a: number;
  b: number;
  begin: number;
  end: number;
}

before(() => {
  runs('run', 'bottleneck', '--seconds', '5', '--lcm', 'off', '--log', log, '--contacts', 'tables');
  runs('view', log, '--html', html);
});

/** Runs the same test on a served log and on a file. */
async function onBoth(check: (page: Page) => Promise<void>): Promise<void> {
  const {child, url} = await view(log, '--port', '0');
  for (const address of [url, `file://${html}`]) {
    const {page, close} = await open(address, {width: 1366, height: 768});
    await until(page, 'window.throng.source.contacts.lastFrame >= 299');
    await check(page);
    await close();
  }
  await stopped(child);
}

const csv = (name: string): string[][] =>
  readFileSync(join(folder, 'tables', name), 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
const rows = (page: Page): Promise<Row[]> => page.evaluate('window.throng.contacts.listedRows');
const filter = (page: Page, change: object): Promise<unknown> => page.evaluate(`window.throng.contacts.set(${JSON.stringify(change)})`);
const frameOf = (time_s: string): number => Math.round(Number(time_s) / STEP_S);

test('lists the contacts of contacts.csv, part_contacts.csv and the exported events', async () => {
  const bodies = csv('contacts.csv').map(([begin, , a, b]) => `${frameOf(begin)} ${a} ${b}`);
  const parts = csv('part_contacts.csv').map(([begin, , a, , b]) => `${frameOf(begin)} ${a} ${b}`);
  const avatars = csv('people.csv').length;
  const begins = runs('export', log, '--csv', 'events').trim().split('\n').slice(1).map((line) => line.split(',')).filter((row) => row[2] === 'begin');
  const walls = begins.filter((row) => Number(row[4]) >= avatars).map((row) => `${row[0]} ${row[3]} ${row[4]}`);
  assert.ok(bodies.length > 20 && parts.length > bodies.length && walls.length > 0);
  await onBoth(async (page) => {
    const listed = async (): Promise<string[]> => (await rows(page)).map(({begin, a, b}) => `${begin} ${a} ${b}`).sort();
    await filter(page, {with: 'people'});
    assert.deepEqual(await listed(), bodies.sort());
    await filter(page, {ofParts: true});
    assert.deepEqual(await listed(), parts.sort());
    await filter(page, {with: 'obstacles'});
    assert.deepEqual(await listed(), walls.sort());
    const lengths = csv('contacts.csv').filter((row) => row[10] === '0').map((row) => Math.round(Number(row[1]) / STEP_S));
    await filter(page, {with: 'people', ofParts: false});
    const ended = new Map((await rows(page)).map(({begin, end, a, b}) => [`${begin} ${a} ${b}`, end - begin]));
    const places = new Map<string, number[]>(await page.evaluate('window.throng.contacts.listedRows.map(({begin, a, b, x_m, y_m}) => [`${begin} ${a} ${b}`, [x_m, y_m]])'));
    for (const [begin, , a, b, x, y] of csv('contacts.csv')) {
      const [x_m, y_m] = places.get(`${frameOf(begin)} ${a} ${b}`)!;
      assert.ok(Math.hypot(x_m - Number(x), y_m - Number(y)) < 0.2, `${x_m}, ${y_m} for ${x}, ${y}`);
    }
    await page.evaluate('window.throng.look.setHeat([0, Infinity])');
    await until(page, `document.querySelector('#heatTotal').textContent === '${bodies.length} contacts'`);
    const whole = csv('contacts.csv').filter((row) => row[10] === '0').map(([begin, , a, b]) => ended.get(`${frameOf(begin)} ${a} ${b}`));
    assert.deepEqual(whole, lengths);
  });
});

test('shows the third longest contact of a person in three clicks', async () => {
  const counts = new Map<string, number>();
  for (const [, , a, b] of csv('contacts.csv')) for (const id of [a, b]) counts.set(id, (counts.get(id) ?? 0) + 1);
  const [id] = [...counts].sort((p, q) => q[1] - p[1])[0];
  const frames = ({end, begin}: Row): number => (end < 0 ? 300 : end) - begin;
  await onBoth(async (page) => {
    await page.evaluate('window.throng.source.playback.playing = false');
    await page.evaluate(`window.throng.choose(${id})`); // a click on the person
    await page.locator('#cardContacts').click();
    await page.locator('.row[data-index="2"]').click();
    const listed = await rows(page);
    const lengths = listed.map(frames);
    assert.deepEqual(lengths, [...lengths].sort((p, q) => q - p));
    assert.ok(listed.every(({a, b}) => [a, b].includes(Number(id))));
    const third = listed[2];
    await until(page, `window.throng.state().frame === ${third.begin}`);
    const selected: number[] = await page.evaluate('window.throng.selected');
    assert.deepEqual([...selected].sort((p, q) => p - q), [third.a, third.b]);
    await page.keyboard.press('n');
    await until(page, `window.throng.state().frame === ${listed[3].begin}`);
    await page.keyboard.press('p');
    await until(page, `window.throng.state().frame === ${third.begin}`);
  });
});

test('keeps only the rows in sight as elements', async () => {
  const {page, close} = await open(`file://${html}`, {width: 1366, height: 768});
  await page.evaluate(`(() => {
    const changes = [];
    for (let i = 0; i < 20000; ++i) changes.push({kind: 'began', frame: i, began: i, a: i % 40, b: 41 + (i % 7), partA: 0, partB: 0}, {kind: 'ended', frame: i + 3, began: i, a: i % 40, b: 41 + (i % 7), partA: 0, partB: 0});
    changes.sort((p, q) => p.frame - q.frame);
    const {contacts} = window.throng.source;
    contacts.clear();
    contacts.take(changes, 20003);
    window.throng.contacts.update();
  })()`);
  for (const at of [0, 0.37, 1]) {
    await page.evaluate(`(() => { const list = document.querySelector('#rows'); list.scrollTop = ${at} * (list.scrollHeight - list.clientHeight); })()`);
    const count = (await rows(page)).length;
    // The rows in sight are those of the place.
    await until(page, `(() => {
      const list = document.querySelector('#rows').getBoundingClientRect();
      const rows = [...document.querySelectorAll('.row:not([hidden])')];
      const inside = rows.filter((row) => { const at = row.getBoundingClientRect(); return at.bottom > list.top + 2 && at.top < list.bottom - 2; });
      return rows.length < 40 && inside.length > 5 && inside.every((row) => Math.abs(Number(row.dataset.index) - ${at * count}) < 14);
    })()`);
  }
  await close();
});

test('finds people and groups by number and name, by keys alone', async () => {
  const {page, close} = await open(`file://${html}`, {width: 1366, height: 768});
  await page.keyboard.press('/');
  await page.keyboard.type('17');
  await page.keyboard.press('Enter');
  assert.equal(await page.evaluate('window.throng.state().selected'), 17);
  assert.match(await page.locator('#cardName').innerText(), / 17$/);
  await page.keyboard.press('/');
  const group: string = await page.evaluate('window.throng.run.groups[0]');
  await page.keyboard.type(group);
  await page.keyboard.press('Enter');
  assert.equal(await page.locator('#groupFilter').inputValue(), group);
  await page.keyboard.press('/');
  await page.keyboard.type('no such thing');
  assert.equal(await page.locator('#found').innerText(), 'nothing found');
  await page.keyboard.press('Escape');
  await close();
});

test('a link shows the same view in another browser', async () => {
  const {child, url} = await view(log, '--port', '0');
  for (const address of [url, `file://${html}`]) {
    const first = await open(address, {width: 1366, height: 768});
    await first.page.evaluate('window.throng.source.playback.playing = false; window.throng.source.playback.seek(123)');
    await until(first.page, 'window.throng.state().frame === 123');
    await filter(first.page, {with: 'people', ofParts: true, min_s: 0.1, order: 'length', isDescending: true});
    await first.page.evaluate('window.throng.choose(17); window.throng.toggleFollow(); window.throng.look.showLayers(["meshes", "hulls"]); window.throng.look.setColoring("speed")');
    await first.page.waitForTimeout(400);
    await first.page.locator('#linkButton').click();
    const link = first.page.url();
    const viewOf = (page: Page): Promise<any> => page.evaluate('window.throng.view()');
    const expected = await viewOf(first.page);
    const context = await browser.newContext({viewport: {width: 1366, height: 768}});
    const page = await context.newPage();
    await page.goto(link);
    await until(page, 'window.throng && window.throng.state().frame === 123');
    await page.waitForTimeout(300);
    const {camera, ...shown} = await viewOf(page);
    assert.deepEqual({...shown, camera: expected.camera}, expected);
    camera.forEach((value: number, i: number) => assert.ok(Math.abs(value - expected.camera[i]) < 1e-3, `camera ${camera} of ${expected.camera}`));
    await context.close();
    await first.close();
  }
  await stopped(child);
});

test('a link beyond the last frame shows the last frame', async () => {
  const {child, url} = await view(log, '--port', '0');
  for (const address of [url, `file://${html}`]) {
    const {page, close} = await open(`${address}#frame=999999&selected=99999&camera=0,0,0,0,0,0&with=xyz`);
    await until(page, 'window.throng.state().frame === 299');
    assert.equal(await page.evaluate('window.throng.source.playback.last'), 299);
    await close();
  }
  await stopped(child);
});

test('a row stays chosen in a link, and a filter by length chooses marks', async () => {
  const {page, close} = await open(`file://${html}`, {width: 1366, height: 768});
  await filter(page, {ofParts: true, order: 'length', isDescending: true});
  await page.locator('.row[data-index="1"]').click();
  const [, second] = await rows(page);
  await until(page, `window.throng.state().frame === ${second.begin}`);
  const link: string = await page.evaluate("location.href.split('#')[0]") + '#' + (await page.evaluate('window.throng.linkText()'));
  const again = await open(link, {width: 1366, height: 768});
  await until(again.page, "document.querySelector('.row.chosen')?.dataset.index === '1'");
  await again.close();
  const marks = (): Promise<number> => page.evaluate('window.throng.stage.marks.shown');
  await page.keyboard.press('r');
  await page.waitForTimeout(500);
  const all = await marks();
  await filter(page, {min_s: 0.5});
  const long: number = await page.evaluate(`window.throng.source.contacts.ofParts.filter(({begin, end}) => begin <= ${second.begin} && ${second.begin} < end && end - begin >= 30).length`);
  assert.ok(long < all, `${long} of ${all}`);
  await until(page, `window.throng.stage.marks.shown === ${long}`);
  await close();
});

test('a copied render command projects as the page does', async () => {
  const {page, close} = await open(`file://${html}`, {width: 1366, height: 768});
  await page.evaluate('window.throng.source.playback.playing = false; window.throng.source.playback.seek(123)');
  await until(page, 'window.throng.state().frame === 123');
  await page.evaluate('window.throng.choose(17); window.throng.toggleFollow()');
  await page.waitForTimeout(500);
  const command: string = await page.evaluate('window.throng.renderCommand()');
  const value = (name: string): number[] => new RegExp(`--${name} (\\S+)`).exec(command)![1].split(',').map(Number);
  const [eye, target, [fov], [width], [height], [frame]] = ['eye', 'target', 'fov', 'width', 'height', 'frame'].map(value);
  assert.equal(frame, 123);
  // The projection of throng render (viewer/picture/raster.cpp).
  const minus = (p: number[], q: number[]): number[] => p.map((x, i) => x - q[i]);
  const dot = (p: number[], q: number[]): number => p.reduce((sum, x, i) => sum + x * q[i], 0);
  const unit = (p: number[]): number[] => p.map((x) => x / Math.hypot(...p));
  const cross = ([a, b, c]: number[], [d, e, f]: number[]): number[] => [b * f - c * e, c * d - a * f, a * e - b * d];
  const forward = unit(minus(target, eye));
  const right = unit(cross(forward, [0, 0, 1]));
  const down = cross(forward, right);
  const focal = (0.5 * height) / Math.tan((fov * Math.PI) / 360);
  const free: {left: number; top: number} = await page.evaluate('window.throng.stage.freeRect()');
  const parts: number[] = await page.evaluate('window.throng.partPositions()');
  let seen = 0;
  for (let i = 0; i < parts.length; i += 3) {
    const away = minus(parts.slice(i, i + 3), eye);
    if (dot(away, forward) < 0.5) continue;
    const x = 0.5 * width + (focal * dot(away, right)) / dot(away, forward);
    const y = 0.5 * height + (focal * dot(away, down)) / dot(away, forward);
    if (x < 0 || y < 0 || x > width || y > height) continue;
    const [u, v]: number[] = await page.evaluate(`window.throng.stage.project(${parts.slice(i, i + 3)})`);
    const off = Math.hypot(((u + 1) / 2) * 1366 - free.left - x, ((1 - v) / 2) * 768 - free.top - y);
    assert.ok(off < 2, `${off} pixels`);
    if (++seen > 200) break;
  }
  assert.ok(seen > 30);
  runs(...command.replace('out/bottleneck.lcmlog', log).split(' ').slice(1));
  await close();
});

test('counts and colours follow the filter', async () => {
  const {page, close} = await open(`file://${html}`, {width: 1366, height: 768});
  await page.evaluate('window.throng.source.playback.playing = false; window.throng.source.playback.seek(200)');
  await until(page, 'window.throng.state().frame === 200');
  const people = (): Promise<string> => page.locator('#people').innerText();
  const all = await people();
  await filter(page, {body: 17});
  await until(page, "document.querySelector('#people').textContent.startsWith('1 of ')");
  await page.locator('#clearFilter').click();
  await until(page, `document.querySelector('#people').textContent === '${all}'`);
  await page.locator('#viewTab').click();
  for (const coloring of ['group', 'speed', 'density', 'contacts', 'robot']) {
    await page.locator('#coloring').selectOption(coloring);
    const legend = await page.locator(coloring === 'group' ? '#colorEntries' : '#colorScale').innerText();
    assert.ok(legend.trim().length > 3, `${coloring}: ${legend}`);
  }
  await close();
});

test('has no violation of accessibility rules, in both themes and on a phone', async () => {
  const axe = readFileSync(createRequire(`${process.env.NPM}/`).resolve('axe-core/axe.min.js'), 'utf8');
  for (const viewport of [{width: 1366, height: 768}, {width: 390, height: 844}]) {
    const {page, close} = await open(`file://${html}`, viewport);
    await page.addScriptTag({content: axe});
    await page.evaluate('window.throng.source.playback.playing = false');
    for (const [theme, tab] of [['light', 'contacts'], ['dark', 'contacts'], ['dark', 'view'], ['light', 'view'], ['light', 'charts'], ['dark', 'engine']]) {
      await page.evaluate(`window.throng.setTheme('${theme}'); window.throng.togglePanel(true); window.throng.showTab('${tab}'); window.throng.choose(17)`);
      await page.evaluate(`window.throng.togglePanel(true); window.throng.look.setHeat([0, Infinity])`);
      await page.waitForTimeout(600);
      const found: {id: string; nodes: {html: string}[]}[] = await page.evaluate('axe.run().then(({violations}) => violations)');
      const seen = found.map(({id, nodes}) => `${id}: ${nodes.map((node) => node.html.slice(0, 120)).join(' | ')}`);
      assert.deepEqual(seen, [], `${theme}, ${tab}, ${viewport.width} wide`);
    }
    await close();
  }
});
