// Plays animations without a mesh on the character that is in the scene already, in Babylon.js (NullEngine) and in three.js (headless Chromium):
//   node onto_check.mjs FOLDER [CHROMIUM]
// For every FOLDER/NAME.alone.glb (skeleton and clip alone) the character is FOLDER/NAME.rig.glb, and what must be seen is the clip of
// FOLDER/NAME.whole.glb, by gltf_reference.mjs: joints within 1 mm every 10 ms. Both bind by the names of nodes: three.js by itself, Babylon.js
// by a clone of the group. Needs babylonjs, babylonjs-loaders, three and playwright-core, found as in validate.mjs.
import { createRequire } from 'node:module';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Glb, compare, said } from './gltf_reference.mjs';
import { inPage } from './page.mjs';

const BOUND = 1e-3; // m
const RATE = 60; // frames a second of Babylon's animation groups
const FEWEST = 15; // joints that are found by name in the character

const modules = process.env.SUREFOOT_NODE_MODULES;
const require = createRequire(modules ? join(resolve(modules), 'x.js') : import.meta.url);
const [folder, browserPath = process.env.CHROMIUM ?? '/usr/bin/chromium'] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node onto_check.mjs FOLDER [CHROMIUM]');
  process.exit(2);
}
let BABYLON, playwright, three;
try {
  BABYLON = require('babylonjs');
  require('babylonjs-loaders');
  playwright = require('playwright-core');
  three = resolve(dirname(require.resolve('three')), '..');
} catch {
  console.log('skipped: no babylonjs, babylonjs-loaders, three or playwright-core (npm install them, or set SUREFOOT_NODE_MODULES)');
  process.exit(0);
}
if (!existsSync(browserPath)) {
  console.log(`skipped: no browser at ${browserPath}`);
  process.exit(0);
}
BABYLON.Logger.LogLevels = BABYLON.Logger.ErrorLogLevel;

const read = (name) => new Uint8Array(readFileSync(join(folder, name)));

// What must be seen: joints that have a name of their own, and where they are.
function wanted(name) {
  const glb = new Glb(read(`${name}.whole.glb`));
  const { index, report } = glb.clips().at(-1);
  const alone = (joint) => glb.nodes.filter((node) => node.name === glb.nodes[joint].name).length === 1;
  const skinned = new Set((glb.json.skins ?? []).flatMap((skin) => skin.joints));
  const joints = glb.joints().filter((joint) => skinned.has(joint) && glb.nodes[joint].name && alone(joint));
  return { report, joints, names: joints.map((joint) => glb.nodes[joint].name), due: glb.samples(index, joints) };
}

async function inBabylon(name, { names, due }) {
  const scene = new BABYLON.Scene(new BABYLON.NullEngine());
  await BABYLON.AppendSceneAsync(read(`${name}.rig.glb`), scene, { pluginExtension: '.glb' });
  scene.animationGroups.slice().forEach((group) => group.dispose());
  const character = new Map([...scene.transformNodes, ...scene.meshes].map((node) => [node.name, node]));
  const root = scene.getNodeByName('__root__');
  await BABYLON.AppendSceneAsync(read(`${name}.alone.glb`), scene, { pluginExtension: '.glb' });
  const ours = scene.animationGroups.at(-1).clone('ours', (target) => character.get(target.name) ?? target);
  ours.start(false);
  const found = due.map(({ time }) => {
    ours.goToFrame(time * RATE);
    const back = BABYLON.Matrix.Invert(root.computeWorldMatrix(true));
    const world = (node) => {
      if (node.parent && node.parent !== root) world(node.parent);
      return node.computeWorldMatrix(true);
    };
    const place = (joint) => {
      const node = character.get(joint);
      return node ? BABYLON.Vector3.TransformCoordinates(world(node).getTranslation(), back).asArray() : [NaN, NaN, NaN];
    };
    return { time, places: names.map(place) };
  });
  scene.dispose();
  return found;
}

const page = `<!doctype html><script type="importmap">{"imports":{"three":"/three/build/three.module.js"}}</script>
<script type="module">
import * as THREE from 'three';
import { GLTFLoader } from '/three/examples/jsm/loaders/GLTFLoader.js';
window.play = async (name, names, times) => {
  const loader = new GLTFLoader();
  const character = await loader.loadAsync('/files/' + encodeURIComponent(name + '.rig.glb'));
  const alone = await loader.loadAsync('/files/' + encodeURIComponent(name + '.alone.glb'));
  const mixer = new THREE.AnimationMixer(character.scene);
  const action = mixer.clipAction(alone.animations.at(-1));
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  const objects = names.map((name) => character.scene.getObjectByName(THREE.PropertyBinding.sanitizeNodeName(name)));
  return times.map((time) => {
    mixer.setTime(time);
    character.scene.updateMatrixWorld(true);
    return { time, places: objects.map((object) => object?.getWorldPosition(new THREE.Vector3()).toArray() ?? [NaN, NaN, NaN]) };
  });
};
window.ready = true;
</script>`;

const tools = dirname(fileURLToPath(import.meta.url));
const clips = readdirSync(folder).filter((name) => name.endsWith('.alone.glb')).map((name) => name.slice(0, -'.alone.glb'.length)).sort();
let bad = 0;
await inPage({ playwright, browserPath, page, served: { three, tools, files: resolve(folder) } }, async (tab) => {
  for (const name of clips) {
    const want = wanted(name);
    const inThree = ([name, names, times]) => window.play(name, names, times);
    const players = {
      'Babylon.js': () => inBabylon(name, want),
      'three.js': () => tab.evaluate(inThree, [name, want.names, want.due.map(({ time }) => time)]),
    };
    for (const [program, play] of Object.entries(players)) {
      const told = await play().then((found) => compare(want.report, want.joints, want.due, found, 1), (error) => ({ error }));
      const good = !told.error && want.joints.length >= FEWEST && told.off <= BOUND && told.more <= BOUND;
      if (!good) bad += 1;
      console.log(`${name} in ${program}: ${good ? 'ok' : 'BAD'}: ${told.error?.stack ?? said(told, want.joints.length)}`);
    }
  }
});
console.log(`${clips.length} animations alone, ${bad} bad`);
process.exit(bad > 0 || clips.length === 0 ? 1 : 0);
