// Plays baked files with three.js in headless Chromium and compares joint positions with the tool's own:
//   node three_check.mjs FOLDER [CHROMIUM]
// For every FOLDER/NAME.pose.json, written by the tests: { file, clip, samples: [{ time, nodes: [[node index, x, y, z], ...] }] },
// world positions in document units and "unit" the document units a metre. Fails over 1 mm. Needs three and playwright-core, found as in validate.mjs.
import { createRequire } from 'node:module';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
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
window.check = async (dump) => {
  const gltf = await new GLTFLoader().loadAsync('/files/' + dump.file);
  const animation = gltf.animations.find((clip) => clip.name === dump.clip);
  if (!animation) return { error: 'no clip ' + dump.clip };
  const mixer = new THREE.AnimationMixer(gltf.scene);
  const action = mixer.clipAction(animation);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  const objects = new Map();
  for (const [object, association] of gltf.parser.associations) {
    if (object.isObject3D && association.nodes !== undefined && !objects.has(association.nodes)) objects.set(association.nodes, object);
  }
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
let dumps = [];
await inPage({ playwright, browserPath, page, served: { three, files: resolve(folder) } }, async (tab) => {
  dumps = readdirSync(folder).filter((name) => name.endsWith('.pose.json')).sort();
  for (const name of dumps) {
    const result = await tab.evaluate((dump) => window.check(dump), JSON.parse(readFileSync(join(folder, name))));
    const good = !result.error && result.count > 0 && result.worst <= 1e-3 && result.report === 'object';
    if (!good) bad += 1;
    const said = result.error ?? `${(result.worst * 1000).toFixed(4)} mm at worst of ${result.count} (${result.at}), extras: ${result.report}`;
    console.log(`${name}: ${good ? 'ok' : 'BAD'}: ${said}`);
  }
});
console.log(`${dumps.length} files, ${bad} bad`);
process.exit(bad > 0 || dumps.length === 0 ? 1 : 0);
