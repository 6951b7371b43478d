// Plays VRM animations on VRM characters with three-vrm in headless Chromium and compares joints with the tool's own:
//   node vrma_check.mjs FOLDER [CHROMIUM]
// For every FOLDER/NAME.play.json, written by the tests: { vrm, file, unit, samples: [{ time, nodes: [[node, [x, y, z], [x, y, z, w]], ...] }] },
// world places and turns of the VRM's nodes. Fails over 1 mm or 0.1 degrees. Needs three, @pixiv/three-vrm, @pixiv/three-vrm-animation and
// playwright-core, found as in validate.mjs.
import { createRequire } from 'node:module';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { inPage } from './page.mjs';

const modules = process.env.SUREFOOT_NODE_MODULES;
const require = createRequire(modules ? join(resolve(modules), 'x.js') : import.meta.url);
const [folder, browserPath = process.env.CHROMIUM ?? '/usr/bin/chromium'] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node vrma_check.mjs FOLDER [CHROMIUM]');
  process.exit(2);
}
let playwright;
const served = {};
try {
  playwright = require('playwright-core');
  served.three = resolve(dirname(require.resolve('three')), '..');
  for (const name of ['three-vrm', 'three-vrm-animation']) served[name] = dirname(require.resolve(`@pixiv/${name}/package.json`));
} catch {
  console.log('skipped: no three, @pixiv/three-vrm, @pixiv/three-vrm-animation or playwright-core (npm install them, or set SUREFOOT_NODE_MODULES)');
  process.exit(0);
}
if (!existsSync(browserPath)) {
  console.log(`skipped: no browser at ${browserPath}`);
  process.exit(0);
}

const page = `<!doctype html><script type="importmap">{"imports":{
"three":"/three/build/three.module.js",
"three/addons/":"/three/examples/jsm/",
"@pixiv/three-vrm":"/three-vrm/lib/three-vrm.module.js",
"@pixiv/three-vrm-animation":"/three-vrm-animation/lib/three-vrm-animation.module.js"}}</script>
<script type="module">
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { VRMLoaderPlugin } from '@pixiv/three-vrm';
import { VRMAnimationLoaderPlugin, createVRMAnimationClip } from '@pixiv/three-vrm-animation';
window.check = async (dump) => {
  const loader = new GLTFLoader();
  loader.register((parser) => new VRMLoaderPlugin(parser, { autoUpdateHumanBones: true }));
  loader.register((parser) => new VRMAnimationLoaderPlugin(parser));
  const model = await loader.loadAsync('/files/' + dump.vrm);
  const { vrm } = model.userData;
  if (!vrm) return { error: 'three-vrm finds no VRM in ' + dump.vrm };
  const animated = await loader.loadAsync('/files/' + dump.file);
  const [animation] = animated.userData.vrmAnimations ?? [];
  if (!animation) return { error: 'three-vrm-animation finds no animation' };
  const clip = createVRMAnimationClip(animation, vrm);
  const mixer = new THREE.AnimationMixer(vrm.scene);
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  const objects = new Map();
  for (const [object, association] of model.parser.associations) {
    if (object.isObject3D && association.nodes !== undefined && !objects.has(association.nodes)) objects.set(association.nodes, object);
  }
  let worst = 0, turned = 0, at = null, count = 0;
  for (const sample of dump.samples) {
    mixer.setTime(sample.time);
    vrm.humanoid.update();
    model.scene.updateMatrixWorld(true);
    for (const [node, place, turn] of sample.nodes) {
      const object = objects.get(node);
      if (!object) return { error: 'node ' + node + ' is not in the scene' };
      const off = object.getWorldPosition(new THREE.Vector3()).distanceTo(new THREE.Vector3(...place)) / dump.unit;
      // Not angleTo: the cosine of so small an angle has no digits left.
      const apart = object.getWorldQuaternion(new THREE.Quaternion()).normalize().invert().multiply(new THREE.Quaternion(...turn));
      const angle = THREE.MathUtils.radToDeg(2 * Math.atan2(Math.hypot(apart.x, apart.y, apart.z), Math.abs(apart.w)));
      count += 1;
      if (!(off <= worst)) { worst = off; at = [sample.time, object.name]; }
      if (!(angle <= turned)) turned = angle;
    }
  }
  return { worst, turned, at, count, tracks: clip.tracks.length, version: vrm.meta.metaVersion, report: typeof animated.animations[0].userData?.surefoot };
};
window.ready = true;
</script>`;
let bad = 0;
let dumps = [];
await inPage({ playwright, browserPath, page, served: { ...served, files: resolve(folder) } }, async (tab) => {
  dumps = readdirSync(folder).filter((name) => name.endsWith('.play.json')).sort();
  for (const name of dumps) {
    const result = await tab.evaluate((dump) => window.check(dump).catch((error) => ({ error: String(error) })), JSON.parse(readFileSync(join(folder, name))));
    const good = !result.error && result.count > 0 && result.worst <= 1e-3 && result.turned <= 0.1 && result.report === 'object';
    if (!good) bad += 1;
    const said = result.error
      ?? `VRM ${result.version}, ${(result.worst * 1000).toFixed(4)} mm and ${result.turned.toFixed(4)} degrees at worst of ${result.count} (${result.at}), extras: ${result.report}`;
    console.log(`${name}: ${good ? 'ok' : 'BAD'}: ${said}`);
  }
});
console.log(`${dumps.length} files, ${bad} bad`);
process.exit(bad > 0 || dumps.length === 0 ? 1 : 0);
