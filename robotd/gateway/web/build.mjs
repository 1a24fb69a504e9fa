// Bundle the console: modules and styles into built/, named by their content, with the licences of what is in them.
import { build } from 'esbuild';
import { createHash } from 'node:crypto';
import { cp, mkdir, readFile, readdir, rm, writeFile } from 'node:fs/promises';
import { basename, join } from 'node:path';

// Ours lies in the folder that is named; what others made lies beside this copy of the recipe.
const HERE = process.argv[2];
const OTHERS = join(import.meta.dirname, 'node_modules');
const BUILT = join(HERE, 'built');
const APP = join(BUILT, 'app');

const result = await build({
  entryPoints: [join(HERE, 'app/console.js'), join(HERE, 'style/console.css')],
  outdir: APP,
  nodePaths: [OTHERS],
  bundle: true,
  splitting: true,
  format: 'esm',
  target: ['chrome111', 'firefox114', 'safari17'],
  minify: true,
  legalComments: 'none',
  entryNames: '[name]-[hash]',
  chunkNames: '[name]-[hash]',
  metafile: true,
  write: false,
});
await rm(BUILT, { recursive: true, force: true });
await mkdir(APP, { recursive: true });
for (const file of result.outputFiles) await writeFile(file.path, file.contents);

const named = Object.fromEntries(
  Object.entries(result.metafile.outputs)
    .filter(([, output]) => output.entryPoint !== undefined)
    .map(([path, output]) => [basename(output.entryPoint), `app/${basename(path)}`]),
);
const icon = await readFile(join(HERE, 'icon.svg'));
const iconName = `app/icon-${createHash('sha256').update(icon).digest('hex').slice(0, 8)}.svg`;
await writeFile(join(BUILT, iconName), icon);
await cp(join(HERE, 'style/stop.css'), join(APP, 'stop.css'));

const page = await readFile(join(HERE, 'index.html'), 'utf8');
const filled = page
  .replace('style/console.css', named['console.css'])
  .replace('app/console.js', named['console.js'])
  .replace('icon.svg', iconName);
await writeFile(join(BUILT, 'index.html'), filled);

// Whose work is in the bundle, as its licences ask us to say.
const inside = new Set(
  Object.keys(result.metafile.inputs)
    .map((path) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(path)?.[1])
    .filter((name) => name !== undefined),
);
const told = [];
for (const name of [...inside].sort()) {
  const folder = join(OTHERS, name);
  const { version } = JSON.parse(await readFile(join(folder, 'package.json'), 'utf8'));
  const licence = (await readdir(folder)).find((file) => /^licen[cs]e/i.test(file));
  const text = licence === undefined ? 'MIT' : await readFile(join(folder, licence), 'utf8');
  told.push(`${name} ${version}\n\n${text.trim()}\n`);
}
await writeFile(join(APP, 'licences.txt'), told.join('\n\n----\n\n'));
