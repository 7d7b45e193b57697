// Builds the page: node build.mjs NPM OUT.html. NPM is the folder in which `npm ci` ran. Script, style
// and font are embedded: the one HTML file works served or opened from disk.
import {readFileSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {deflateSync} from 'node:zlib';

/** The packages whose code or font the page contains; their licences demand a notice. */
const PACKAGES = ['three', 'webm-muxer', '@fontsource-variable/source-sans-3'];

const [npm, out] = process.argv.slice(2);
if (!out) {
  console.error('build.mjs: expected NPM OUT.html: the folder with node_modules and the file to write');
  process.exit(2);
}
const {build} = createRequire(`${npm}/`)('esbuild');
const source = join(dirname(fileURLToPath(import.meta.url)), 'src');

const shared = {
  absWorkingDir: source,
  nodePaths: [join(npm, 'node_modules')],
  bundle: true,
  minify: true,
  write: false,
  logLevel: 'error',
  charset: 'utf8',
};
const script = await build({
  ...shared,
  entryPoints: ['main.ts'],
  format: 'iife',
  target: ['chrome103', 'firefox115', 'safari16.4'],
  legalComments: 'none',
});
const style = await build({
  ...shared,
  entryPoints: ['style.css'],
  target: ['chrome103', 'safari16.4'],
  loader: {'.woff2': 'dataurl'},
});
const notices = PACKAGES.map((name) => `${name}\n${readFileSync(join(npm, 'node_modules', name, 'LICENSE'), 'utf8')}`);

const html = readFileSync(join(source, 'index.html'), 'utf8')
  .replace('<!--NOTICES-->', () => `<!--\n${notices.join('\n').replaceAll('--', '- -')}-->`)
  .replace('/*STYLE*/', () => style.outputFiles[0].text)
  .replace('/*CODE*/', () => deflateSync(script.outputFiles[0].contents, {level: 9}).toString('base64'));
writeFileSync(out, html);
