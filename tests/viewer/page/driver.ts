// Drives the page in a headless browser with the real program.
import assert from 'node:assert/strict';
import {type ChildProcess, spawn, spawnSync} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before} from 'node:test';
import type {Browser, Page} from 'playwright-core';

const {chromium} = createRequire(`${process.env.NPM}/`)('playwright-core') as typeof import('playwright-core');
export const throng = process.env.THRONG!;
/** A temporary folder of the test program. */
export const folder = mkdtempSync(join(tmpdir(), 'throng-page-'));
export const children: ChildProcess[] = [];
export let browser: Browser;

export function start(...args: string[]): ChildProcess {
  const child = spawn(throng, args, {cwd: folder, stdio: ['ignore', 'pipe', 'inherit']});
  children.push(child);
  return child;
}

/** Runs the program; fails the test if it fails. */
export function runs(...args: string[]): string {
  const done = spawnSync(throng, args, {cwd: folder, maxBuffer: 1 << 28});
  assert.equal(done.status, 0, String(done.stderr));
  return String(done.stdout);
}

/** Polls an expression. The page's policy forbids evaluating text later, as waitForFunction would. */
export async function until(page: Page, expression: string, limit_ms = 60_000): Promise<void> {
  for (const end = Date.now() + limit_ms; !(await page.evaluate(expression)); await page.waitForTimeout(30))
    assert.ok(Date.now() < end, `not true within ${limit_ms} ms: ${expression}`);
}

/** Starts `throng view`; resolves with its URL once it listens. */
export async function view(...args: string[]): Promise<{child: ChildProcess; url: string}> {
  const child = start('view', ...args);
  const url = await new Promise<string>((found, failed) => {
    child.once('exit', (code) => failed(new Error(`throng view ended with ${code}`)));
    child.stdout!.on('data', (text) => {
      const address = /http:\S+/.exec(String(text));
      if (address) found(address[0]);
    });
  });
  return {child, url};
}

export function stopped(child: ChildProcess): Promise<void> {
  return new Promise((done) => {
    if (child.exitCode !== null) return done();
    child.once('exit', () => done());
    child.kill('SIGTERM');
  });
}

/** Opens a page; page errors and outside addresses fail the test. */
export async function open(
  url: string,
  viewport = {width: 800, height: 560},
): Promise<{page: Page; addresses: string[]; close: () => Promise<void>}> {
  const page = await browser.newPage({viewport, ignoreHTTPSErrors: true});
  const addresses: string[] = [];
  const errors: string[] = [];
  page.on('request', (request) => addresses.push(request.url()));
  page.on('pageerror', (error) => errors.push(String(error)));
  await page.goto(url);
  await until(page, 'window.throng && window.throng.state().frame >= 0');
  const close = async (): Promise<void> => {
    await page.close();
    assert.deepEqual(errors, [], 'errors on the page');
  };
  return {page, addresses, close};
}

before(async () => {
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM,
    args: ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
  });
});

after(async () => {
  await browser?.close();
  for (const child of children) child.kill('SIGKILL');
  rmSync(folder, {recursive: true, force: true});
});
