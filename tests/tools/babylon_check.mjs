// Plays baked files in Babylon.js without a screen (NullEngine), with the loader's own defaults:
//   node babylon_check.mjs FOLDER [NAME ...]
// Every clip with a report of every FOLDER/*.glb whose name has NAME in it, every 10 ms, after all of the file's other clips were played
// and stopped (what a clip has no channel for keeps their last value): each joint within 1 mm of what the file says (gltf_reference.mjs), and
// a joint of a planted foot moves at most 1 mm more than in the file. Fails where no foot is planted in any file, too. Needs babylonjs and
// babylonjs-loaders, found as in validate.mjs.
import { createRequire } from 'node:module';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { Glb, compare, said } from './gltf_reference.mjs';

const BOUND = 1e-3; // m
const RATE = 60; // frames a second of the loader's animation groups

const modules = process.env.SUREFOOT_NODE_MODULES;
const require = createRequire(modules ? join(resolve(modules), 'x.js') : import.meta.url);
const [folder, ...names] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node babylon_check.mjs FOLDER [NAME ...]');
  process.exit(2);
}
let BABYLON;
try {
  BABYLON = require('babylonjs');
  require('babylonjs-loaders');
} catch {
  console.log('skipped: no babylonjs or babylonjs-loaders (npm install them, or set SUREFOOT_NODE_MODULES)');
  process.exit(0);
}
BABYLON.Logger.LogLevels = BABYLON.Logger.ErrorLogLevel;

async function check(path, file) {
  const bytes = new Uint8Array(readFileSync(path));
  const glb = new Glb(bytes);
  const dump = `${path}.pose.json`;
  const scale = existsSync(dump) ? JSON.parse(readFileSync(dump)).unit : 1;
  const engine = new BABYLON.NullEngine();
  const scene = new BABYLON.Scene(engine);
  await BABYLON.AppendSceneAsync(bytes, scene, { pluginExtension: '.glb' });
  scene.animationGroups.forEach((group) => group.stop());
  const nodes = new Map();
  for (const node of [...scene.transformNodes, ...scene.meshes]) {
    for (const pointer of node._internalMetadata?.gltf?.pointers ?? []) {
      const index = /^\/nodes\/(\d+)$/.exec(pointer)?.[1];
      if (index !== undefined) nodes.set(Number(index), node);
    }
  }
  // The loader turns the file's right-handed space with a node of its own, above all others.
  const root = scene.getNodeByName('__root__');
  const joints = glb.joints();
  const clips = glb.clips();
  const lines = [];
  if (clips.length === 0) lines.push({ good: false, planted: 0, line: 'no clip with a report' });
  for (const { index, name, report } of clips) {
    const ours = scene.animationGroups[index];
    scene.animationGroups.forEach((group, at) => {
      if (clips.some((clip) => clip.index === at)) return;
      group.start(false);
      group.goToFrame((group.from + group.to) / 2);
      group.stop();
    });
    ours.start(false);
    const due = glb.samples(index, joints);
    const found = due.map(({ time }) => {
      ours.goToFrame(time * RATE);
      const back = BABYLON.Matrix.Invert(root.computeWorldMatrix(true));
      const done = new Set([root]);
      const world = (node) => {
        if (!done.has(node)) {
          if (node.parent) world(node.parent);
          done.add(node);
          node.computeWorldMatrix(true);
        }
        return node.getWorldMatrix();
      };
      const place = (joint) => {
        const node = nodes.get(joint);
        if (!node) return [NaN, NaN, NaN];
        return BABYLON.Vector3.TransformCoordinates(world(node).getTranslation(), back).asArray();
      };
      return { time, places: joints.map(place) };
    });
    ours.stop();
    const told = compare(report, joints, due, found, scale);
    const good = told.off <= BOUND && told.more <= BOUND && ours.name === name && ours.metadata?.gltf?.extras?.surefoot !== undefined;
    lines.push({ good, planted: told.planted, line: `${name}: ${said(told, joints.length)}${ours.name === name ? '' : `, called ${ours.name}`}` });
  }
  scene.dispose();
  engine.dispose();
  for (const { good, line } of lines) console.log(`${file}: ${good ? 'ok' : 'BAD'}: ${line}`);
  return { good: lines.every(({ good }) => good), planted: lines.reduce((sum, { planted }) => sum + planted, 0) };
}

const started = Date.now();
const files = readdirSync(folder).filter((name) => name.endsWith('.glb') && (names.length === 0 || names.some((part) => name.includes(part)))).sort();
let bad = 0;
let planted = 0;
for (const file of files) {
  const result = await check(join(folder, file), file).catch((error) => {
    console.log(`${file}: BAD: ${error.stack ?? error}`);
    return { good: false, planted: 0 };
  });
  if (!result.good) bad += 1;
  planted += result.planted;
}
console.log(`Babylon.js ${BABYLON.Engine.Version}: ${files.length} files, ${bad} bad, ${planted} planted, ${Math.round((Date.now() - started) / 1000)} s`);
process.exit(bad > 0 || planted === 0 ? 1 : 0);
