// Builds the page: node build.mjs NPM OUT.html, NPM being the folder where `npm ci` ran. Script and
// style go into the one HTML file, so that it needs no other, served or opened from disk.
import {readFileSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [npm, out] = process.argv.slice(2);
if (!out) {
  console.error('build.mjs: expected the folder of node_modules and the HTML file to write');
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
  legalComments: 'inline',
});
const style = await build({...shared, entryPoints: ['style.css'], target: ['chrome103', 'safari16.4']});

// "</script" inside the script would end it; in a string or a comment the backslash changes nothing.
const code = script.outputFiles[0].text.replaceAll('</script', '<\\/script');
const html = readFileSync(join(source, 'index.html'), 'utf8')
  .replace('/*STYLE*/', () => style.outputFiles[0].text)
  .replace('/*SCRIPT*/', () => code);
writeFileSync(out, html);
