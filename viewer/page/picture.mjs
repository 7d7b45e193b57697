// Takes a screenshot of the page and prints the time to its first picture:
// node picture.mjs NPM URL OUT.png [WIDTH HEIGHT [light|dark [SCRIPT]]]. NPM is the folder in which the
// build ran `npm ci`: build/release/viewer/npm. SCRIPT runs in the page before the screenshot.
import {createRequire} from 'node:module';
import {resolve} from 'node:path';

const [npm, url, out, width = '1280', height = '720', colorScheme = 'light', script = ''] = process.argv.slice(2);
if (!out) {
  console.error('picture.mjs: expected NPM URL OUT.png [WIDTH HEIGHT [light|dark [SCRIPT]]]');
  process.exit(2);
}
const {chromium} = createRequire(`${resolve(npm)}/`)('playwright-core');
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  // Software rendering: works without a graphics card.
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});
const page = await browser.newPage({viewport: {width: Number(width), height: Number(height)}, colorScheme});
// Records the times of the first picture with people and of a later frame. Reading a pixel waits
// until all is drawn.
await page.addInitScript(() => {
  const request = requestAnimationFrame;
  window.drawnAt = [];
  let seen = -1;
  window.requestAnimationFrame = (callback) =>
    request((now) => {
      callback(now);
      const {frame} = window.throng?.state() ?? {frame: -1};
      if (window.drawnAt.length === 2 || frame === seen) return;
      seen = frame;
      const gl = window.throng.stage.renderer.getContext();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
      window.drawnAt.push(Math.round(performance.now()));
    });
});
await page.goto(url);
// Polled from here: the page's policy forbids evaluating text later, as waitForFunction would.
while ((await page.evaluate('window.drawnAt.length')) < 2) await page.waitForTimeout(50);
const [first, second] = await page.evaluate('window.drawnAt');
console.log(`first picture ${first} ms after the request of the page, the next ${second} ms`);
await page.waitForTimeout(3000);
if (script) await page.evaluate(script);
await page.waitForTimeout(script ? 4000 : 500);
await page.screenshot({path: out, timeout: 0});
await browser.close();
