// Runs the page's tests: node test.mjs units NPM OUT, or node test.mjs browser NPM OUT THRONG.
// TypeScript is bundled into OUT first, so that plain node runs it.
import {spawnSync} from 'node:child_process';
import {existsSync, mkdirSync, readdirSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

const [kind, npm, out, throng] = process.argv.slice(2);
const {build} = createRequire(`${npm}/`)('esbuild');
const tests = resolve(dirname(fileURLToPath(import.meta.url)), '../../tests/viewer/page');
const suffix = kind === 'units' ? '.test.ts' : '.browser.ts';
const chromium = process.env.CHROMIUM ?? '/usr/bin/chromium';
const SKIPPED = 77; // SKIP_RETURN_CODE of ctest
if (kind === 'browser' && !existsSync(chromium)) {
  console.error(`skipped: no browser at ${chromium}; run scripts/setup.sh page, or set CHROMIUM to a browser`);
  process.exit(SKIPPED);
}

// Live runs need multicast. A machine without a multicast route runs the tests in a separate network namespace.
function hasMulticast() {
  return spawnSync('ip', ['route', 'get', '239.255.76.67'], {stdio: 'ignore'}).status === 0;
}
const unshare = ['--net', '--map-root-user', 'sh', '-c'];
const canUnshare = () => spawnSync('unshare', [...unshare, 'true'], {stdio: 'ignore'}).status === 0;
let isMulticastMissing = false;
if (kind === 'browser' && !process.env.THRONG_OWN_NETWORK && !hasMulticast()) {
  if (canUnshare()) {
    const script = 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$0" "$@"';
    const own = spawnSync('unshare', [...unshare, script, process.execPath, ...process.argv.slice(1)], {
      stdio: 'inherit',
      env: {...process.env, THRONG_OWN_NETWORK: '1'},
    });
    process.exit(own.status ?? 1);
  }
  isMulticastMissing = true;
}

mkdirSync(out, {recursive: true});
const entries = readdirSync(tests).filter((name) => name.endsWith(suffix));
await build({
  entryPoints: entries.map((name) => join(tests, name)),
  outdir: join(out, kind),
  outExtension: {'.js': '.mjs'},
  bundle: true,
  platform: 'node',
  format: 'esm',
  target: 'node18',
  external: ['playwright-core'],
  nodePaths: [join(npm, 'node_modules')],
  logLevel: 'error',
});
const files = entries.map((name) => join(out, kind, name.replace(/\.ts$/, '.mjs')));
const result = spawnSync(process.execPath, ['--test', ...files], {
  stdio: 'inherit',
  env: {
    ...process.env,
    CHROMIUM: chromium,
    THRONG: throng ?? '',
    NPM: npm,
    NO_MULTICAST: isMulticastMissing ? '1' : '',
  },
});
process.exit(result.status ?? 1);
