// Tests that the keyboard alone reaches all that a mouse reaches.
import assert from 'node:assert/strict';
import {join} from 'node:path';
import {test} from 'node:test';
import type {Page} from 'playwright-core';
import {folder, open, runs, until} from './driver.ts';

const html = join(folder, 'keyboard.html');

/** Clickable elements that neither lie in something that can have the focus nor hold it. */
const UNREACHABLE = `[...document.querySelectorAll('body *')]
  .filter((element) => element.checkVisibility() && getComputedStyle(element).cursor === 'pointer')
  .filter((element) => getComputedStyle(element.parentElement).cursor !== 'pointer')
  .filter((element) => !element.closest('button, input, select, a[href], [tabindex="0"], [role=listbox]'))
  .filter((element) => !element.querySelector('button, input'))
  .map((element) => element.outerHTML.slice(0, 100))`;
/** A tab list has one place in the order, from which arrow keys go on. */
const CONTROLS = `[...document.querySelectorAll('button:not([role=tab]), input, select, [tabindex="0"]')]
  .filter((element) => element.checkVisibility({visibilityProperty: true}))
  .map((element) => element.id || element.textContent)`;
const FOCUSED = `document.activeElement.id || document.activeElement.textContent`;

async function reachedByTab(page: Page): Promise<Set<string>> {
  const reached = new Set<string>();
  await page.evaluate('document.activeElement.blur()');
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(FOCUSED));
  }
  return reached;
}

test('reaches every control with the Tab key, in all tabs', async () => {
  runs('run', 'bottleneck', '--seconds', '4', '--lcm', 'off', '--html', html);
  const {page, close} = await open(`file://${html}#frame=200`, {width: 1366, height: 768});
  await page.keyboard.press('n');
  await until(page, 'window.throng.selected.length === 2');
  await page.locator('#contactsTab').focus();
  for (const tab of ['view', 'charts', 'engine', 'contacts']) {
    await page.keyboard.press('ArrowRight');
    await until(page, `!document.querySelector('#${tab}Pane').hidden`);
    assert.deepEqual(await page.evaluate(UNREACHABLE), []);
    const reached = await reachedByTab(page);
    const missed = (await page.evaluate(CONTROLS) as string[]).filter((name) => !reached.has(name));
    assert.deepEqual(missed, [], `not reached in tab ${tab}`);
    await page.locator(`#${tab}Tab`).focus();
  }
  await close();
});

test('turns, moves and zooms the view by keys', async () => {
  const {page, close} = await open(`file://${html}#frame=200`);
  const camera = (): Promise<number[]> => page.evaluate('window.throng.view().camera');
  const away = ([x, y, z, a, b, c]: number[]): number[] => [x - a, y - b, z - c];
  const length = (v: number[]): number => Math.hypot(...v);
  const before = await camera();
  for (const key of ['a', 'w']) await page.keyboard.press(key);
  const turned = await camera();
  assert.deepEqual(turned.slice(3), before.slice(3), 'the target stays');
  assert.ok(Math.abs(length(away(turned)) - length(away(before))) < 1e-3, 'the distance stays');
  assert.ok(turned[2] > before[2], 'W turns the eye up');
  await page.keyboard.press('Shift+D');
  const moved = await camera();
  assert.ok(length(away(moved).map((value, i) => value - away(turned)[i])) < 1e-3, 'the direction stays');
  assert.ok(length(moved.map((value, i) => value - turned[i])) > 0.1);
  await page.keyboard.press('+');
  assert.ok(length(away(await camera())) < 0.95 * length(away(moved)));
  await close();
});

test('Space plays after a click on a button, and presses a button that keys have reached', async () => {
  const {page, close} = await open(`file://${html}#frame=200`);
  await page.locator('#panelButton').click();
  await page.keyboard.press('Space');
  assert.equal(await page.evaluate('window.throng.source.playback.playing'), true);
  await page.keyboard.press('Space');
  const isClosed = 'document.querySelector("#panel").classList.contains("closed")';
  const before = await page.evaluate(isClosed);
  await page.locator('#find').focus();
  while ((await page.evaluate(FOCUSED)) !== 'panelButton') await page.keyboard.press('Tab');
  await page.keyboard.press('Space');
  assert.equal(await page.evaluate('window.throng.source.playback.playing'), false);
  assert.equal(await page.evaluate(isClosed), !before);
  await close();
});

test('the wheel zooms a resting picture, from below the whole scene to above the ground', async () => {
  const {page, close} = await open(`file://${html}#frame=200`);
  const drawn = 'window.throng.stage.renderer.info.render.frame';
  await page.waitForTimeout(1500); // the picture at rest has been drawn
  const before = (await page.evaluate(drawn)) as number;
  await page.mouse.move(400, 300);
  await page.mouse.wheel(0, -200);
  await until(page, `${drawn} > ${before}`);
  for (const key of ['+', '-']) {
    for (let i = 0; i < 60; ++i) await page.keyboard.press(key);
    await until(page, 'window.throng.stage.camera.position.z > 0.1');
    const share = (await page.evaluate(`(() => {
      const {camera, controls} = window.throng.stage;
      return camera.position.distanceTo(controls.target) / controls.maxDistance;
    })()`)) as number;
    assert.ok(share <= 1.001, `${share} of the largest distance`);
  }
  const places = (await page.evaluate('Array.from({length: window.throng.run.avatars}, (_, id) => window.throng.screenPosition(id))')) as ([number, number] | null)[];
  const across = places.filter((place) => place !== null).map(([x]) => x);
  assert.ok(Math.max(...across) - Math.min(...across) > 20, `from afar, the crowd is ${Math.min(...across)} to ${Math.max(...across)}`);
  await close();
});

test('all controls of the header lie in windows of any width', async () => {
  const {page, close} = await open(`file://${html}#frame=200`);
  for (const width of [1366, 900, 844, 800, 760, 721, 390]) {
    await page.setViewportSize({width, height: 600});
    const outside = await page.evaluate(`[...document.querySelectorAll('.bar button, .bar input')]
      .filter((control) => control.checkVisibility())
      .filter((control) => control.getBoundingClientRect().right > ${width} - 10)
      .map((control) => control.id)`);
    assert.deepEqual(outside, [], `${width} pixels`);
  }
  await close();
});
