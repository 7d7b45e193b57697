// Builds the page: node build.mjs NPM OUT.html. NPM is the folder in which `npm ci` ran. Script and
// style are embedded: the one HTML file works served or opened from disk.
import {readFileSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

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
  legalComments: 'inline',
});
const style = await build({...shared, entryPoints: ['style.css'], target: ['chrome103', 'safari16.4']});

// "</script" inside the script would end it; the backslash changes neither strings nor comments.
const code = script.outputFiles[0].text.replaceAll('</script', '<\\/script');
const html = readFileSync(join(source, 'index.html'), 'utf8')
  .replace('/*STYLE*/', () => style.outputFiles[0].text)
  .replace('/*SCRIPT*/', () => code);
writeFileSync(out, html);
