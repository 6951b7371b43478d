// Plays baked files with three.js in headless Chromium:
//   node three_check.mjs FOLDER [CHROMIUM]
// Every clip with a report of every FOLDER/*.glb, every 10 ms, after the file's other clips: each joint within 1 mm of what the file says
// (gltf_reference.mjs), and a joint of a planted foot moves at most 1 mm more than in the file. And the tool's own positions, to 1 mm, of every
// FOLDER/NAME.pose.json that the tests write: { file, clip, samples: [{ time, nodes: [[node index, x, y, z], ...] }] }, world positions in
// document units and "unit" the document units a metre. Needs three and playwright-core, found as in validate.mjs.
import { createRequire } from 'node:module';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { inPage } from './page.mjs';

const modules = process.env.SUREFOOT_NODE_MODULES;
const require = createRequire(modules ? join(resolve(modules), 'x.js') : import.meta.url);
const [folder, browserPath = process.env.CHROMIUM ?? '/usr/bin/chromium'] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node three_check.mjs FOLDER [CHROMIUM]');
  process.exit(2);
}
let playwright, three;
try {
  playwright = require('playwright-core');
  three = resolve(dirname(require.resolve('three')), '..');
} catch {
  console.log('skipped: no three or playwright-core (npm install them, or set SUREFOOT_NODE_MODULES)');
  process.exit(0);
}
if (!existsSync(browserPath)) {
  console.log(`skipped: no browser at ${browserPath}`);
  process.exit(0);
}

const page = `<!doctype html><script type="importmap">{"imports":{"three":"/three/build/three.module.js"}}</script>
<script type="module">
import * as THREE from 'three';
import { GLTFLoader } from '/three/examples/jsm/loaders/GLTFLoader.js';
import { Glb, compare, said } from '/tools/gltf_reference.mjs';
const objectsOf = (gltf) => {
  const objects = new Map();
  for (const [object, association] of gltf.parser.associations) {
    if (object.isObject3D && association.nodes !== undefined && !objects.has(association.nodes)) objects.set(association.nodes, object);
  }
  return objects;
};
window.play = async (file, scale) => {
  const bytes = new Uint8Array(await (await fetch('/files/' + encodeURIComponent(file))).arrayBuffer());
  const gltf = await new GLTFLoader().parseAsync(bytes.buffer, '/files/');
  const glb = new Glb(bytes);
  const objects = objectsOf(gltf);
  const joints = glb.joints();
  const clips = glb.clips();
  const mixer = new THREE.AnimationMixer(gltf.scene);
  const lines = [];
  for (const { index, name, report } of clips) {
    gltf.animations.forEach((other, at) => {
      if (clips.some((clip) => clip.index === at)) return;
      const action = mixer.clipAction(other).play();
      mixer.update(other.duration / 2);
      action.stop();
    });
    const action = mixer.clipAction(gltf.animations[index]);
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.reset().play();
    const due = glb.samples(index, joints);
    const found = due.map(({ time }) => {
      mixer.setTime(time);
      gltf.scene.updateMatrixWorld(true);
      return { time, places: joints.map((joint) => objects.get(joint)?.getWorldPosition(new THREE.Vector3()).toArray() ?? [NaN, NaN, NaN]) };
    });
    action.stop();
    const told = compare(report, joints, due, found, scale);
    const known = gltf.animations[index].name === name && typeof gltf.animations[index].userData?.surefoot === 'object';
    lines.push({ good: known && told.off <= 1e-3 && told.more <= 1e-3, planted: told.planted, line: name + ': ' + said(told, joints.length) });
  }
  return lines.length ? lines : [{ good: false, planted: 0, line: 'no clip with a report' }];
};
window.check = async (dump) => {
  const gltf = await new GLTFLoader().loadAsync('/files/' + dump.file);
  const animation = gltf.animations.find((clip) => clip.name === dump.clip);
  if (!animation) return { error: 'no clip ' + dump.clip };
  const mixer = new THREE.AnimationMixer(gltf.scene);
  const action = mixer.clipAction(animation);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  const objects = objectsOf(gltf);
  let worst = 0, at = null, count = 0;
  for (const sample of dump.samples) {
    mixer.setTime(sample.time);
    gltf.scene.updateMatrixWorld(true);
    for (const [node, x, y, z] of sample.nodes) {
      const object = objects.get(node);
      if (!object) return { error: 'node ' + node + ' is not in the scene' };
      const off = new THREE.Vector3().setFromMatrixPosition(object.matrixWorld).distanceTo(new THREE.Vector3(x, y, z)) / dump.unit;
      count += 1;
      if (!(off <= worst)) { worst = off; at = [sample.time, object.name]; }
    }
  }
  return { worst, at, count, report: typeof animation.userData?.surefoot };
};
window.ready = true;
</script>`;
let bad = 0;
let planted = 0;
let dumps = [];
let files = [];
const tools = dirname(fileURLToPath(import.meta.url));
await inPage({ playwright, browserPath, page, served: { three, tools, files: resolve(folder) } }, async (tab) => {
  files = readdirSync(folder).filter((name) => name.endsWith('.glb')).sort();
  for (const name of files) {
    const dump = join(folder, `${name}.pose.json`);
    const scale = existsSync(dump) ? JSON.parse(readFileSync(dump)).unit : 1;
    const lines = await tab.evaluate(([name, scale]) => window.play(name, scale).catch((error) => [{ good: false, planted: 0, line: String(error) }]), [name, scale]);
    if (!lines.every(({ good }) => good)) bad += 1;
    planted += lines.reduce((sum, line) => sum + line.planted, 0);
    for (const { good, line } of lines) console.log(`${name}: ${good ? 'ok' : 'BAD'}: ${line}`);
  }
  dumps = readdirSync(folder).filter((name) => name.endsWith('.pose.json')).sort();
  for (const name of dumps) {
    const result = await tab.evaluate((dump) => window.check(dump), JSON.parse(readFileSync(join(folder, name))));
    const good = !result.error && result.count > 0 && result.worst <= 1e-3 && result.report === 'object';
    if (!good) bad += 1;
    const said = result.error ?? `${(result.worst * 1000).toFixed(4)} mm at worst of ${result.count} (${result.at}), extras: ${result.report}`;
    console.log(`${name}: ${good ? 'ok' : 'BAD'}: ${said}`);
  }
});
console.log(`${files.length} files, ${dumps.length} with the tool's own positions, ${planted} planted, ${bad} bad`);
process.exit(bad > 0 || planted === 0 ? 1 : 0);
