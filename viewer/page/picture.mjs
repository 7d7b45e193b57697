// A screenshot of the page: node picture.mjs NPM URL OUT.png [WIDTH HEIGHT [light|dark [SCRIPT]]], NPM
// being the folder where the build ran `npm ci`: build/release/viewer/npm.
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
  // No graphics card is needed: the browser draws in software.
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});
const page = await browser.newPage({viewport: {width: Number(width), height: Number(height)}, colorScheme});
await page.goto(url);
// Polled here: the page's policy lets nobody evaluate text later on, as waitForFunction would.
while (!(await page.evaluate('window.throng && window.throng.state().frame >= 0'))) await page.waitForTimeout(50);
await page.waitForTimeout(3000);
if (script) await page.evaluate(script);
await page.waitForTimeout(script ? 4000 : 500);
await page.screenshot({path: out, timeout: 0});
await browser.close();
