// Runs the Khronos validator over every .glb and .vrma of a folder:
//   node validate.mjs FOLDER [SOURCES]
// Prints one line a file and fails on an error, or on a kind of warning that the file's source did not have. A file's source
// is named in FOLDER/baked.glb.source, relative to SOURCES; one without is compared with nothing.
// gltf-validator is found beside this script, in NODE_PATH, or in SUREFOOT_NODE_MODULES.
import { createRequire } from 'node:module';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';

const modules = process.env.SUREFOOT_NODE_MODULES;
const require = createRequire(modules ? join(resolve(modules), 'x.js') : import.meta.url);
let validator;
try {
  validator = require('gltf-validator');
} catch {
  console.log('skipped: no gltf-validator (npm install gltf-validator, or set SUREFOOT_NODE_MODULES)');
  process.exit(0);
}

const [folder, sources] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node validate.mjs FOLDER [SOURCES]');
  process.exit(2);
}

async function findings(path) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(path)), {
    maxIssues: 0,
    externalResourceFunction: async (uri) => new Uint8Array(readFileSync(join(dirname(path), decodeURIComponent(uri)))),
  });
  const kinds = new Map();
  for (const message of report.issues.messages) {
    if (message.severity > 1) continue;
    const kind = `${message.severity === 0 ? 'error' : 'warning'} ${message.code}`;
    const entry = kinds.get(kind) ?? { count: 0, example: `${message.pointer}: ${message.message}` };
    entry.count += 1;
    kinds.set(kind, entry);
  }
  return kinds;
}

const bad = [];
const files = readdirSync(folder).filter((name) => /\.(glb|vrma)$/.test(name)).sort();
for (const name of files) {
  const found = await findings(join(folder, name));
  const note = join(folder, `${name}.source`);
  const source = sources && existsSync(note) ? join(sources, readFileSync(note, 'utf8').trim()) : null;
  const before = source && existsSync(source) ? await findings(source) : new Map();
  const fresh = [...found].filter(([kind, entry]) => entry.count > (before.get(kind)?.count ?? 0));
  const count = (severity) => [...found].filter(([kind]) => kind.startsWith(severity)).reduce((sum, [, entry]) => sum + entry.count, 0);
  console.log(`${name}: ${count('error')} errors, ${count('warning')} warnings, ${fresh.length} kinds that the source did not have`);
  if (fresh.length > 0) bad.push([name, ...fresh.map(([kind, entry]) => `${kind} x ${entry.count}: ${entry.example}`)]);
}
// Last, where who reads the end of a long log sees them.
console.log(`${files.length} files, ${bad.length} with findings of their own`);
for (const found of bad) console.log(found.join('\n  '));
process.exit(bad.length > 0 || files.length === 0 ? 1 : 0);
