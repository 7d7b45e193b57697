// Tests the page in a real browser with the real program: a log, a live run, a file.
import assert from 'node:assert/strict';
import {spawn, spawnSync} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {before, test} from 'node:test';
import type {Page} from 'playwright-core';
import {browser, children, folder, open, stopped, throng, until, view} from './driver.ts';

const log = join(folder, 'plaza.lcmlog');

interface Begun {
  frame: number;
  pair: string;
}

interface State {
  mode: string;
  avatars: number;
  frame: number;
  frames: number;
  selected: number;
  selectedName: string;
  build_ms: number;
}

const state = (page: Page): Promise<State> => page.evaluate('window.throng.state()');
const pictures = (page: Page): Promise<number> => page.evaluate('window.throng.stage.renderer.info.render.frame');
const position = (page: Page, id: number): Promise<number[]> => page.evaluate(`window.throng.positionOf(${id})`);

const pairs = (page: Page): Promise<number> => page.evaluate('window.throng.state().pairs');

before(() => {
  const run = spawnSync(throng, ['run', 'plaza', '--avatars', '40', '--seconds', '4', '--lcm', 'off', '--log', log]);
  assert.equal(run.status, 0, String(run.stderr));
});

test('plays, steps and scrubs a log', async () => {
  const {child, url} = await view(log, '--port', '0');
  const {page, addresses, close} = await open(url);
  const first = await state(page);
  assert.equal(first.mode, 'log');
  assert.equal(first.avatars, 40);
  const start = await position(page, 0);
  const {frame} = await state(page);  // the frame of the position, or a later one
  await until(page, `window.throng.state().frame > ${frame + 10}`);
  const later = await position(page, 0);
  assert.ok(Math.hypot(later[0] - start[0], later[1] - start[1]) > 0.02, 'person 0 stands still');

  await page.keyboard.press('Space');
  await page.waitForTimeout(1000);
  const paused = await state(page);
  await page.waitForTimeout(500);
  assert.equal((await state(page)).frame, paused.frame, 'continues although paused');
  const drawn = await pictures(page);
  await page.waitForTimeout(500);
  assert.equal(await pictures(page), drawn, 'an unchanged picture is drawn again');
  await page.keyboard.press('ArrowRight');
  await until(page, `window.throng.state().frame === ${paused.frame + 1}`);
  await page.locator('#scrub').fill('150');
  await until(page, 'window.throng.state().frame === 150');
  const there = await position(page, 0);
  await page.keyboard.press('Home');
  await until(page, 'window.throng.state().frame === 0');
  await page.locator('#scrub').fill('150');
  await until(page, 'window.throng.state().frame === 150');
  assert.deepEqual(await position(page, 0), there, 'the same frame looks different');
  assert.ok(addresses.every((address) => address.startsWith(url) || address.startsWith('data:')), addresses.join(' '));
  await close();
  await stopped(child);
});

/** Returns how many people and corners of the ground lie outside the free rectangle. */
const outside = (page: Page): Promise<number> =>
  page.evaluate(`(() => {
    const {stage, run, frame} = window.throng;
    const free = stage.freeRect();
    const isOutside = ([x, y, z]) => {
      const p = stage.project(x, y, z);
      const [across, down] = [((p[0] + 1) / 2) * innerWidth, ((1 - p[1]) / 2) * innerHeight];
      return across < free.left || across > free.right || down < free.top || down > free.bottom;
    };
    const {min_m, max_m} = run.ground;
    const points = [min_m, max_m, [min_m[0], max_m[1]], [max_m[0], min_m[1]]].map(([x, y]) => [x, y, 0]);
    for (let id = 0; id < run.avatars; ++id) if (frame.people[4 * id + 3] & 1) points.push(window.throng.positionOf(id));
    return points.filter(isOutside).length;
  })()`);

test('the first view and the top view show the whole scene clear of the panels, in any window', async () => {
  const {child, url} = await view(log, '--port', '0');
  const {page, close} = await open(url);
  await page.keyboard.press('Space');
  await page.evaluate('window.throng.stage.freeRect = () => ({left: 20, top: 60, right: innerWidth - 100, bottom: innerHeight - 80})');
  for (const [width, height] of [[1280, 720], [390, 844]]) {
    await page.setViewportSize({width, height});
    await until(page, `window.throng.stage.camera.aspect === ${width} / ${height}`);
    await page.evaluate('window.throng.stage.overview()');
    assert.equal(await outside(page), 0, `in a window of ${width} x ${height}`);
    assert.equal(await page.evaluate('window.throng.stage.topView()'), true);
    assert.equal(await outside(page), 0, `from above in a window of ${width} x ${height}`);
    assert.equal(await page.evaluate('window.throng.stage.topView()'), false);
    assert.equal(await outside(page), 0);
  }
  await close();
  await stopped(child);
});

test('draws layers on request and describes the selected person', async () => {
  const {child, url} = await view(log, '--port', '0');
  const {page, close} = await open(url);
  await page.keyboard.press('Space');
  await page.waitForTimeout(600);
  const drawn = (): Promise<{calls: number; triangles: number}> => page.evaluate('window.throng.stage.drawn');
  await page.locator('#engineTab').click();
  for (const layer of ['spheres', 'hulls', 'boxes']) {
    const {calls} = await drawn();
    await page.locator(`#layer-${layer}`).check();
    await until(page, `window.throng.stage.drawn.calls > ${calls}`);
    await page.keyboard.press({spheres: '2', hulls: '3', boxes: '4'}[layer]!);
    assert.equal(await page.locator(`#layer-${layer}`).isChecked(), false);
    await until(page, `window.throng.stage.drawn.calls === ${calls}`);
  }

  const where = await page.evaluate(`(() => {
    for (let id = 0; id < 40; ++id) {
      const at = window.throng.screenPosition(id);
      if (at && at[0] > 20 && at[0] < 400 && at[1] > 140 && at[1] < 480) return [id, ...at];
    }
  })()`) as number[];
  assert.ok(where, 'no person is in the picture');
  await page.mouse.click(where[1], where[2]);
  await until(page, 'window.throng.state().selected >= 0');
  const {selected, selectedName} = await state(page);
  assert.match(await page.locator('#cardName').innerText(), new RegExp(`^\\S.* ${selected}$`));
  assert.equal(await page.locator('#cardName').innerText(), selectedName);
  await until(page, "document.querySelector('#cardState').textContent.includes('m/s')");
  await page.locator('#follow').click();
  assert.equal(await page.locator('#follow').getAttribute('aria-pressed'), 'true');
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#card').isVisible(), false);
  await close();
  await stopped(child);
});

/** Returns begins and ends of a log from `throng export`; a pair is "a b part_a part_b". */
function eventsOf(file: string): {begins: Begun[]; ends: Begun[]} {
  const csv = spawnSync(throng, ['export', file, '--csv', 'events'], {maxBuffer: 1 << 28});
  const rows = String(csv.stdout).trim().split('\n').slice(1).map((line) => line.split(','));
  const of = (kind: string): Begun[] =>
    rows
      .filter((row) => row[2] === kind)
      .map((row) => ({frame: Number(row[0]), pair: [row[3], row[4], row[7], row[8]].join(' ').replaceAll('"', '')}));
  return {begins: of('begin'), ends: of('end')};
}

/** Returns the times under "Contacts now", sorted, and their frame. */
const since = (page: Page): Promise<[number, string[]]> =>
  page.evaluate(`(() => {
    const times = [...document.querySelectorAll('#cardPairs time')].map((time) => time.textContent);
    return [window.throng.state().frame, times.sort()];
  })()`);

function expectedSince(log: {begins: Begun[]; ends: Begun[]}, id: number, frame: number, step_s: number): string[] {
  const open = new Map<string, number>();
  const changes = [...log.begins.map((b) => ({...b, begins: true})), ...log.ends.map((e) => ({...e, begins: false}))];
  for (const change of changes.sort((p, q) => p.frame - q.frame)) {
    if (change.frame > frame || !change.pair.split(' ').slice(0, 2).includes(String(id))) continue;
    if (change.begins) open.set(change.pair, change.frame);
    else open.delete(change.pair);
  }
  return [...open.values()].map((begin) => `${((frame - begin) * step_s).toFixed(2)} s`).sort();
}

test('shows since when a contact lasts at any frame, from the server and in a file', async () => {
  const dense = join(folder, 'dense.lcmlog');
  assert.equal(spawnSync(throng, ['run', 'bottleneck', '--seconds', '4', '--lcm', 'off', '--log', dense]).status, 0);
  const events = eventsOf(dense);
  // The person with the most begins.
  const counts = new Map<number, number>();
  for (const {pair} of events.begins) {
    const id = Number(pair.split(' ')[0]);
    counts.set(id, (counts.get(id) ?? 0) + 1);
  }
  const [id] = [...counts].sort((p, q) => q[1] - p[1])[0];
  const touched = events.begins.find(({pair}) => pair.startsWith(`${id} `))!;
  const html = join(folder, 'since.html');
  assert.equal(spawnSync(throng, ['view', dense, '--html', html]).status, 0);
  const {child, url} = await view(dense, '--port', '0');
  for (const address of [url, `file://${html}`]) {
    const {page, close} = await open(address);
    await page.evaluate(`window.throng.choose(${id})`);
    let compared = 0;
    const compare = async (): Promise<void> => {
      const [frame, times] = await since(page);
      assert.deepEqual(times, expectedSince(events, id, frame, 1 / 60), `frame ${frame} of ${address}`);
      compared += times.length;
    };
    for (let i = 0; i < 20; ++i) await compare();  // while playing
    await page.evaluate('window.throng.source.playback.playing = false');
    for (const frame of [200, 90, touched.frame, 239, touched.frame + 1, 0, 150, 149, 200]) {
      await page.evaluate(`window.throng.source.playback.seek(${frame})`);
      await until(page, `window.throng.state().frame === ${frame}`);
      await compare();
      await page.keyboard.press('ArrowRight');
      await until(page, `window.throng.state().frame === Math.min(239, ${frame} + 1)`);
      await compare();
    }
    assert.ok(compared > 5, `${compared} times seen`);
    // Past contacts arrive also while the picture rests.
    await page.evaluate('window.throng.source.playback.seek(239)');
    const over = new Set(events.ends.filter((end) => end.frame <= 239 && end.pair.split(' ').slice(0, 2).includes(String(id))).map((end) => end.pair));
    if (over.size > 0) await until(page, "document.querySelectorAll('#cardHistory time').length > 0");
    await close();
  }
  await stopped(child);
});

test('shows an upper bound for a contact from before the log', async () => {
  const [first, rest] = ['first.lcmlog', 'rest.lcmlog'].map((name) => join(folder, name));
  const scene = ['run', 'bottleneck', '--lcm', 'off'];
  spawnSync(throng, [...scene, '--seconds', '0.5', '--log', first, '--checkpoint', 'c', '--checkpoint-every', '0.5'], {cwd: folder});
  const run = spawnSync(throng, [...scene, '--seconds', '1', '--log', rest, '--resume', 'c'], {cwd: folder});
  assert.equal(run.status, 0, String(run.stderr));
  const {begins, ends} = eventsOf(first);
  const over = [...ends.filter((end) => end.frame < 30), ...eventsOf(rest).ends.filter((end) => end.frame <= 31)];
  const touching = begins.filter(({pair, frame}) => !over.some((end) => end.pair === pair && end.frame >= frame));
  assert.ok(touching.length > 0, 'no contact when the run is stopped');
  const id = Number(touching[0].pair.split(' ')[0]);
  const html = join(folder, 'rest.html');
  assert.equal(spawnSync(throng, ['view', rest, '--html', html]).status, 0);
  const {child, url} = await view(rest, '--port', '0');
  for (const address of [url, `file://${html}`]) {
    const {page, close} = await open(address);
    await page.evaluate(`window.throng.choose(${id}); window.throng.source.playback.playing = false; window.throng.source.playback.seek(30)`);
    await until(page, 'window.throng.state().frame === 30');
    const [, times] = await since(page);
    assert.ok(times.includes('before 0.50 s'), times.join(', '));
    await close();
  }
  await stopped(child);
});

test('shows missing parts of a torn log in a banner, from the server and in a file', async () => {
  const torn = join(folder, 'torn.lcmlog');
  const bytes = readFileSync(log);
  writeFileSync(torn, bytes.subarray(0, Math.floor(bytes.length * 0.6)));
  const html = join(folder, 'torn.html');
  const made = spawnSync(throng, ['view', torn, '--html', html]);
  assert.equal(made.status, 1, String(made.stderr));
  const {child, url} = await view(torn, '--port', '0');
  for (const address of [url, `file://${html}`]) {
    const {page, close} = await open(address);
    await until(page, "!document.querySelector('#banner').hidden");
    assert.match(await page.locator('#banner').innerText(), /torn: it ends inside a message after frame \d+ \(\d+\.\d\d s\)/);
    await page.locator('#closeBanner').click();
    await page.waitForTimeout(700);
    assert.equal(await page.locator('#banner').isVisible(), false, 'the closed banner returns');
    await close();
  }
  await stopped(child);
  const whole = await view(log, '--port', '0');
  const {page, close} = await open(whole.url);
  await page.waitForTimeout(1000);
  assert.equal(await page.locator('#banner').isVisible(), false);
  await close();
  await stopped(whole.child);
});

test('reports too many pages, and opens when one is closed', async () => {
  const {child, url} = await view(log, '--port', '0');
  const sockets = `${url.replace('http', 'ws')}ws`;
  const {page: holder, close} = await open(url);
  await holder.evaluate(`window.sockets = Array.from({length: 7}, () => new WebSocket('${sockets}'))`);
  await until(holder, 'window.sockets.every((socket) => socket.readyState === 1)');
  const ninth = await browser.newPage({viewport: {width: 800, height: 560}});
  const errors: string[] = [];
  ninth.on('console', (message) => message.type() === 'error' && errors.push(message.text()));
  await ninth.goto(url);
  const notice = ninth.locator('#notice');
  await until(ninth, "document.querySelector('#notice').textContent.includes('8 pages are open')");
  for (let i = 0; i < 30; ++i) {
    assert.ok(!(await notice.innerText()).includes('lost'), 'reports a lost connection');
    await ninth.waitForTimeout(100);
  }
  await holder.evaluate('window.sockets[0].close()');
  await ninth.locator('#notice button').click();
  await until(ninth, 'window.throng.state().frame >= 0');
  assert.equal(await notice.isVisible(), false);
  assert.deepEqual(errors, []);
  await ninth.close();
  await close();
  await stopped(child);
});

test('reports a lost connection and reconnects', async () => {
  const first = await view(log, '--port', '0');
  const {page, close} = await open(first.url);
  await stopped(first.child);
  await until(page, "document.querySelector('#notice').textContent.includes('Connection lost')");
  const second = await view(log, '--port', new URL(first.url).port);
  await until(page, "document.querySelector('#notice').hidden");
  await page.locator('#scrub').fill('20');
  await until(page, 'window.throng.state().frame >= 20');
  await close();
  await stopped(second.child);
});

test('shows a run over LCM with moving people', async (t) => {
  if (process.env.NO_MULTICAST) return t.skip('no multicast route, and no separate network namespace');
  const lcm = `udpm://239.255.76.67:${20_000 + (process.pid % 20_000)}?ttl=0&recv_buf_size=2097152`;
  const {child, url} = await view('--lcm', lcm, '--port', '0');
  const page = await browser.newPage({viewport: {width: 800, height: 560}});
  await page.goto(url);
  await until(page, "document.querySelector('#notice').textContent.includes('Waiting')");
  const hint = await page.locator('#notice').innerText();
  assert.ok(hint.includes(`listening to ${lcm}`) && hint.includes(`--lcm '${lcm}'`), hint);
  // LCM's own player sends the log slowly: the first picture of a busy machine takes seconds.
  const run = spawn('lcm-logplayer', [`--lcm-url=${lcm}`, `--speed=0.3`, log], {stdio: 'ignore'});
  children.push(run);
  await until(page, 'window.throng.state().frame >= 0');
  const seen = await state(page);
  assert.equal(seen.mode, 'live');
  const before = await position(page, 3);
  const {frame} = await state(page);
  await until(page, `window.throng.state().frame > ${frame + 30}`);
  assert.notDeepEqual(await position(page, 3), before, 'no person moves');
  const shown: string = await page.locator('#liveClock').innerText();
  assert.match(shown, /^0:0[0-4]\.\d\d$/);
  await until(page, 'window.throng.state().isEnded');
  const late = await open(url);
  for (const one of [page, late.page]) {
    await until(one, "document.querySelector('#liveClock').textContent === '0:03.98'");
    await until(one, "document.querySelector('#notice').textContent.includes('The run has finished')");
    assert.match(await one.locator('#notice').innerText(), /last frame is at 0:03\.98/);
    assert.equal(await one.locator('#mode').innerText(), 'FINISHED');
    await one.waitForTimeout(3000);
    assert.ok(await one.locator('#notice').isVisible(), 'the notice disappears');
  }
  const touching = await pairs(page);
  assert.equal(await pairs(late.page), touching, 'the last frames differ');
  await late.close();
  await page.close();
  await stopped(run);
  await stopped(child);
});

test('shows the same people from one file', async () => {
  const html = join(folder, 'plaza.html');
  const made = spawnSync(throng, ['view', log, '--html', html]);
  assert.equal(made.status, 0, String(made.stderr));
  assert.ok(!/(src|href)="?https?:/.test(readFileSync(html, 'utf8')), 'names an outside address');
  const {page, addresses, close} = await open(`file://${html}`);
  assert.deepEqual(addresses.filter((address) => !address.startsWith('file:') && !address.startsWith('data:')), []);
  const {child, url} = await view(log, '--port', '0');
  const server = await open(url);
  for (const frame of [0, 60, 150, 239]) {
    for (const one of [page, server.page]) {
      await one.evaluate(`(() => { const p = window.throng; p.source.playback.playing = false; p.source.playback.seek(${frame}); })()`);
      await until(one, `window.throng.state().frame === ${frame}`);
    }
    // All part positions in metres, at keys and between them.
    const expression = 'window.throng.partPositions()';
    const [fromFile, fromServer] = (await Promise.all([page.evaluate(expression), server.page.evaluate(expression)])) as number[][];
    assert.equal(fromFile.length, fromServer.length);
    assert.ok(fromFile.length > 40 * 15);
    let worst = 0;
    for (let i = 0; i < fromFile.length; ++i) worst = Math.max(worst, Math.abs(fromFile[i] - fromServer[i]));
    assert.ok(worst < 0.06, `frame ${frame}: a part is off by ${worst} m`);
  }
  await server.close();
  await stopped(child);
  await close();
});
