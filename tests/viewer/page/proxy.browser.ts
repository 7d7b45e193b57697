// Tests the page behind a reverse proxy with https and a path, as those of Jupyter and Codespaces.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {readFileSync} from 'node:fs';
import http, {type IncomingMessage, type RequestListener} from 'node:http';
import https from 'node:https';
import net, {type AddressInfo} from 'node:net';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {browser, folder, open, runs, stopped, until, view} from './driver.ts';

const log = join(folder, 'proxied.lcmlog');
const NAME = 'hub.localhost'; // browsers resolve it to this machine; the server does not know it
const PATH = '/user/x/proxy/8090/';

interface Proxy {
  url: string;
  close: () => void;
}
const proxies: Proxy[] = [];

/** A key and certificate for NAME; null without openssl. */
function certificate(): {key: Buffer; cert: Buffer} | null {
  const [key, cert] = ['key.pem', 'cert.pem'].map((name) => join(folder, name));
  const args = ['req', '-x509', '-newkey', 'rsa:2048', '-nodes', '-days', '2', '-subj', `/CN=${NAME}`, '-keyout', key, '-out', cert];
  const done = spawnSync('openssl', args, {stdio: 'ignore'});
  return done.status === 0 ? {key: readFileSync(key), cert: readFileSync(cert)} : null;
}

/** Maps PATH to the server at `target`. `setsHost`: replaces the public name in Host by the server's. */
async function proxyTo(target: string, setsHost: boolean): Promise<Proxy> {
  const {hostname: host, port} = new URL(target);
  const asked = (request: IncomingMessage): http.RequestOptions => ({
    host,
    port,
    method: request.method,
    path: `/${request.url!.slice(PATH.length)}`,
    headers: {...request.headers, ...(setsHost ? {host: `${host}:${port}`} : {})},
  });
  const isOurs = (request: IncomingMessage): boolean => request.url!.startsWith(PATH);
  const onRequest: RequestListener = (request, response) => {
    if (!isOurs(request)) return void response.writeHead(404).end();
    http.get(asked(request), (answer) => {
      response.writeHead(answer.statusCode!, answer.headers);
      answer.pipe(response);
    });
  };
  const keys = certificate();
  const server = keys ? https.createServer(keys, onRequest) : http.createServer(onRequest);
  server.on('upgrade', (request: IncomingMessage, browserSide: net.Socket, rest: Buffer) => {
    if (!isOurs(request)) return void browserSide.end('HTTP/1.1 404 Not Found\r\n\r\n');
    const {path, headers} = asked(request);
    const serverSide = net.connect(Number(port), host, () => {
      const lines = Object.entries(headers!).map(([name, value]) => `${name}: ${value}\r\n`);
      serverSide.write(`GET ${path} HTTP/1.1\r\n${lines.join('')}\r\n`);
      serverSide.write(rest);
      serverSide.pipe(browserSide).pipe(serverSide);
    });
    for (const side of [serverSide, browserSide]) side.on('error', () => {}).on('close', () => (serverSide.destroy(), browserSide.destroy()));
  });
  await new Promise<void>((listening) => server.listen(0, '127.0.0.1', listening));
  const proxy = {
    url: `http${keys ? 's' : ''}://${NAME}:${(server.address() as AddressInfo).port}${PATH}`,
    close: () => (server.close(), server.closeAllConnections()),
  };
  proxies.push(proxy);
  return proxy;
}

before(() => void runs('run', 'plaza', '--avatars', '20', '--seconds', '2', '--lcm', 'off', '--log', log));
after(() => proxies.forEach((proxy) => proxy.close()));

test('shows a log under a path of a proxy, with an allowed host name', async () => {
  const {child, url} = await view(log, '--port', '0', '--host-name', NAME);
  for (const setsHost of [false, true]) {
    const proxy = await proxyTo(url, setsHost);
    const {page, addresses, close} = await open(`${proxy.url}#frame=7`);
    await until(page, 'window.throng.state().frame === 7');
    assert.deepEqual(addresses.filter((address) => !address.startsWith(proxy.url) && !address.startsWith('data:')), []);
    const socket = page.waitForEvent('websocket');
    await page.reload();
    assert.equal((await socket).url(), `${proxy.url.replace('http', 'ws')}ws`);
    await until(page, 'window.throng && window.throng.state().frame === 7');
    await close();
  }
  await stopped(child);
});

test('refuses a proxy whose host name is not allowed, and names the remedy', async () => {
  const {child, url} = await view(log, '--port', '0');
  const page = await browser.newPage({ignoreHTTPSErrors: true});
  const answer = await page.goto((await proxyTo(url, false)).url);
  assert.equal(answer!.status(), 403);
  assert.match(await answer!.text(), /expected this machine or a --host-name as Host, found 'hub\.localhost/);
  // This proxy gets the page. Its socket has the origin of the public name.
  await page.goto((await proxyTo(url, true)).url);
  await until(page, "document.querySelector('#notice').textContent.includes('Connection lost')");
  await page.close();
  await stopped(child);
});

test('keeps the theme that the reader chose when the page is loaded again', async () => {
  const {child, url} = await view(log, '--port', '0');
  const {page, close} = await open(url);
  const theme = (): Promise<string> => page.evaluate('document.documentElement.dataset.theme');
  await page.emulateMedia({colorScheme: 'light'});
  await until(page, "document.documentElement.dataset.theme === 'light'");
  await page.keyboard.press('t');
  assert.equal(await theme(), 'dark');
  await page.reload();
  await until(page, 'window.throng && window.throng.state().frame >= 0');
  assert.equal(await theme(), 'dark');
  await page.emulateMedia({colorScheme: 'dark'});
  await page.keyboard.press('t');
  await page.reload();
  await until(page, 'window.throng && window.throng.state().frame >= 0');
  assert.equal(await theme(), 'light');
  await close();
  await stopped(child);
});
