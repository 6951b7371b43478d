// Plays baked files with three.js in headless Chromium and compares joint positions with the tool's own:
//   node three_check.mjs FOLDER [CHROMIUM]
// For every FOLDER/NAME.pose.json, written by the tests: { file, clip, samples: [{ time, nodes: [[node index, x, y, z], ...] }] },
// world positions in document units and "unit" the document units a metre. Fails over 1 mm. Needs three and playwright-core, found as in validate.mjs.
import { createRequire } from 'node:module';
import { createServer } from 'node:http';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, extname, join, resolve } from 'node:path';

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
const types = { '.js': 'text/javascript', '.glb': 'model/gltf-binary', '.html': 'text/html' };
const server = createServer((request, response) => {
  const path = decodeURIComponent(new URL(request.url, 'http://x').pathname);
  if (path === '/') return response.setHeader('Content-Type', 'text/html').end(page);
  const file = path.startsWith('/three/') ? join(three, path.slice(7)) : join(resolve(folder), path.slice(7));
  if (path.includes('..') || !existsSync(file)) return response.writeHead(404).end();
  response.setHeader('Content-Type', types[extname(file)] ?? 'application/octet-stream').end(readFileSync(file));
});
await new Promise((done) => server.listen(0, '127.0.0.1', done));
const profile = mkdtempSync(join(tmpdir(), 'surefoot-three-'));
const browser = await playwright.chromium.launchPersistentContext(profile, {
  executablePath: browserPath,
  headless: true,
  args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
});
let bad = 0;
let dumps = [];
try {
  const tab = await browser.newPage();
  tab.on('pageerror', (error) => console.error(String(error)));
  await tab.goto(`http://127.0.0.1:${server.address().port}/`);
  await tab.waitForFunction('window.ready', null, { timeout: 30000 });
  dumps = readdirSync(folder).filter((name) => name.endsWith('.pose.json')).sort();
  for (const name of dumps) {
    const result = await tab.evaluate((dump) => window.check(dump), JSON.parse(readFileSync(join(folder, name))));
    const good = !result.error && result.count > 0 && result.worst <= 1e-3 && result.report === 'object';
    if (!good) bad += 1;
    const said = result.error ?? `${(result.worst * 1000).toFixed(4)} mm at worst of ${result.count} (${result.at}), extras: ${result.report}`;
    console.log(`${name}: ${good ? 'ok' : 'BAD'}: ${said}`);
  }
} finally {
  await browser.close();
  server.close();
  rmSync(profile, { recursive: true, force: true });
}
console.log(`${dumps.length} files, ${bad} bad`);
process.exit(bad > 0 || dumps.length === 0 ? 1 : 0);
