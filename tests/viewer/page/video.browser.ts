// Tests that the page saves videos, for a file and for a served log.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {join} from 'node:path';
import {test} from 'node:test';
import type {Page} from 'playwright-core';
import {browser, folder, open, runs, stopped, view} from './driver.ts';

const log = join(folder, 'video.lcmlog');
const html = join(folder, 'video.html');

/** Returns width, height and duration as a video element of another page reports them. */
async function played(file: string): Promise<number[]> {
  const page = await browser.newPage();
  const found = await page.evaluate(async (base64) => {
    const video = document.createElement('video');
    video.src = `data:video/webm;base64,${base64}`;
    await new Promise((done, failed) => {
      video.onloadeddata = done;
      video.onerror = () => failed(new Error(video.error?.message));
    });
    return [video.videoWidth, video.videoHeight, video.duration];
  }, readFileSync(file).toString('base64'));
  await page.close();
  return found;
}

async function saved(page: Page, from: string, to: string): Promise<string> {
  await page.locator('#viewTab').click();
  await page.locator('#videoFrom').fill(from);
  await page.locator('#videoTo').fill(to);
  await page.locator('#videoSize').selectOption('720');
  const [download] = await Promise.all([page.waitForEvent('download', {timeout: 300_000}), page.locator('#videoButton').click()]);
  const file = join(folder, download.suggestedFilename());
  await download.saveAs(file);
  return file;
}

test('saves a span as video at the speed of the timeline, and shows the same frame again', async () => {
  runs('run', 'bottleneck', '--seconds', '1', '--lcm', 'off', '--log', log);
  runs('view', log, '--html', html);
  const {child, url} = await view(log, '--port', '0');
  for (const address of [url, `file://${html}`]) {
    const {page, close} = await open(`${address}#frame=6`);
    // A slow machine may draw fewer pixels, but their shape is that of the window.
    const shape = '(({width, height}) => Math.round(100 * width / height))(window.throng.stage.renderer.domElement)';
    const camera = 'window.throng.renderCommand()';
    const before = [await page.evaluate(shape), await page.evaluate(camera)];
    const [w, h, duration_s] = await played(await saved(page, '0.2', '0.4'));
    assert.deepEqual([w, h], [1280, 720]);
    // Up to the begin of the last picture, as browsers count, or to its end.
    assert.ok(duration_s > 0.15 && duration_s < 0.21, `${duration_s} s for 0.2 s`);
    await page.evaluate('window.throng.source.playback.speed = 0.5');
    const slow_s = (await played(await saved(page, '0.2', '0.4')))[2]!;
    assert.ok(slow_s > 0.35 && slow_s < 0.41, `${slow_s} s for 0.2 s at half the speed`);
    assert.equal(await page.evaluate('window.throng.state().frame'), 6);
    assert.deepEqual([await page.evaluate(shape), await page.evaluate(camera)], before);
    await close();
  }
  await stopped(child);
});

test('stops on demand, and names the reason where a browser cannot encode', async () => {
  const {page, close} = await open(`file://${html}`);
  await page.locator('#viewTab').click();
  await page.locator('#videoButton').click();
  await page.locator('#videoButton:has-text("Stop")').click();
  await page.locator('#videoButton:has-text("Save video")').waitFor();
  await page.evaluate('delete window.VideoEncoder');
  await page.locator('#videoButton').click();
  await page.locator('#notice:has-text("throng render")').waitFor();
  await close();
});

test('only its button can be used while a video is made, and a span outside of the recording is named', async () => {
  const {page, close} = await open(`file://${html}#frame=6`);
  await page.locator('#viewTab').click();
  for (const [from, to, message] of [['0.6', '0.2', 'before it begins'], ['500', '600', 'the recording ends at']]) {
    await page.locator('#videoFrom').fill(from!);
    await page.locator('#videoTo').fill(to!);
    await page.locator('#videoButton').click();
    await page.locator(`#notice:has-text("${message}")`).waitFor();
  }
  await page.locator('#videoFrom').fill('0');
  await page.locator('#videoTo').fill('');
  await page.locator('#videoButton').click();
  await page.locator('#videoButton:has-text("Stop")').waitFor();
  const theme = await page.evaluate('document.documentElement.dataset.theme');
  await page.keyboard.press('t');
  assert.equal(await page.evaluate('document.documentElement.dataset.theme'), theme);
  const usable = '[...document.querySelectorAll("button, input, select")].filter((e) => e.checkVisibility() && !e.closest("[inert]") && !e.closest("#videoBox")).length';
  assert.equal(await page.evaluate(usable), 0);
  await page.locator('#videoButton').click();
  await page.locator('#videoButton:has-text("Save video")').waitFor();
  assert.notEqual(await page.evaluate(usable), 0);
  await close();
});
