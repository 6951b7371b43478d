// Validates what clips and audits report against the schemas of exports/:
//   node schema_check.mjs CLIPS [AUDITS]
// CLIPS: a folder, searched with those in it, of .glb, .vrm and .vrma (each animation's extras.surefoot; clips of others are passed over) and of
// .events.json. AUDITS: a folder of what `surefoot audit --json` or `surefoot correct --json` wrote. Prints the counts and the first errors of each
// file; fails on an error, and where there was nothing to check. ajv (8) is found beside this script, in NODE_PATH, or in SUREFOOT_NODE_MODULES.
import { createRequire } from 'node:module';
import { readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';

const modules = process.env.SUREFOOT_NODE_MODULES;
const require = createRequire(modules ? join(resolve(modules), 'x.js') : import.meta.url);
let Ajv;
try {
  Ajv = require('ajv');
} catch {
  console.log('skipped: no ajv (npm install ajv@8, or set SUREFOOT_NODE_MODULES)');
  process.exit(0);
}

const [clips, audits] = process.argv.slice(2);
if (!clips) {
  console.error('usage: node schema_check.mjs CLIPS [AUDITS]');
  process.exit(2);
}

const ajv = new Ajv({ allErrors: true, strict: true, strictRequired: false, allowUnionTypes: true });
const schema = (name) => {
  const value = JSON.parse(readFileSync(new URL(`../../exports/${name}.schema.json`, import.meta.url), 'utf8'));
  ajv.addSchema(value, name);
  return name;
};
const [surefoot, audit] = [schema('surefoot'), schema('audit')];
const compiled = {
  clip: ajv.getSchema(surefoot),
  events: ajv.getSchema(`${surefoot}#/definitions/events_file`),
  audit: ajv.getSchema(audit),
  correction: ajv.getSchema(`${audit}#/definitions/correction`),
};

const counts = { clip: 0, events: 0, audit: 0, correction: 0 };
let bad = 0;
function check(kind, value, where) {
  counts[kind] += 1;
  const valid = compiled[kind];
  if (valid(value)) return;
  bad += 1;
  console.log(`${where}: not as the schema says (${valid.errors.length} errors)`);
  for (const error of valid.errors.slice(0, 5)) {
    console.log(`  ${error.instancePath || '/'}: ${error.message} ${JSON.stringify(error.params)}`);
  }
}

function animations(path) {
  const bytes = readFileSync(path);
  if (bytes.toString('latin1', 0, 4) !== 'glTF') return [];
  return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12))).animations ?? [];
}

const files = (folder) => readdirSync(folder, { recursive: true }).map(String).sort().map((name) => join(folder, name));
for (const path of files(clips)) {
  if (/\.(glb|vrm|vrma)$/.test(path)) {
    for (const { name, extras } of animations(path)) {
      if (extras?.surefoot) check('clip', extras.surefoot, `${path}, clip ${name}`);
    }
  } else if (path.endsWith('.events.json')) {
    check('events', JSON.parse(readFileSync(path, 'utf8')), path);
  }
}
for (const path of audits ? files(audits).filter((path) => path.endsWith('.json')) : []) {
  const value = JSON.parse(readFileSync(path, 'utf8'));
  const corrections = [value].flat().every((one) => one !== null && typeof one === 'object' && 'before' in one);
  if (corrections) [value].flat().forEach((one) => check('correction', one, path));
  else check('audit', value, path);
}

const { clip, events, audit: audited, correction } = counts;
console.log(`${clip} clips, ${events} events files, ${audited} audits and ${correction} corrections against their schemas, ${bad} not as they say`);
if (clip === 0) console.log(`${clips}: no clip of Surefoot to check`);
if (audits && audited + correction === 0) console.log(`${audits}: no audit to check`);
process.exit(bad > 0 || clip === 0 || (audits && audited + correction === 0) ? 1 : 0);
