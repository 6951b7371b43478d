// Runs the helper that `--engine three` writes, in headless Chromium:
//   node engine_three_check.mjs FOLDER [CHROMIUM]
// FOLDER holds surefoot_three.js and, for every NAME.events.json, NAME.glb or NAME.vrma. Each clip is played three times over at 60 Hz and at
// uneven frames: every event must come once a loop, in the first frame at or after its time, in order; contact() must agree with the
// report; without userData the sidecar must do. Needs three and playwright-core, found as in validate.mjs.
import { createRequire } from 'node:module';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { inPage } from './page.mjs';

const modules = process.env.SUREFOOT_NODE_MODULES;
const require = createRequire(modules ? join(resolve(modules), 'x.js') : import.meta.url);
const [folder, browserPath = process.env.CHROMIUM ?? '/usr/bin/chromium'] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node engine_three_check.mjs FOLDER [CHROMIUM]');
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
import { SurefootEvents } from '/files/surefoot_three.js';
const NAMES = ['foot_down', 'foot_up', 'push_start', 'push_end', 'ball_hit', 'balance_lost', 'balance_regained', 'contact_start', 'contact_end'];
window.check = async (file, sidecar) => {
  const gltf = await new GLTFLoader().loadAsync('/files/' + file);
  const problems = [];
  let told = 0;
  for (const [name, report] of Object.entries(sidecar)) {
    const clip = gltf.animations.find((clip) => clip.name === name);
    if (!clip) { problems.push('no clip ' + name); continue; }
    const due = [...report.events.map((event) => [event.name, event.foot, event.time]),
      ...report.contacts.flatMap((contact) => [['contact_start', contact.foot, contact.start], ['contact_end', contact.foot, contact.end]])];
    for (const [way, frame] of [['extras', () => 1 / 60], ['sidecar', (count) => [0.004, 0.05, 0.021][count % 3]]]) {
      const played = clip.clone();
      played.userData = way === 'extras' ? clip.userData : {};
      const mixer = new THREE.AnimationMixer(gltf.scene);
      const action = mixer.clipAction(played);
      const loops = 3;
      action.setLoop(THREE.LoopRepeat, loops);
      action.clampWhenFinished = true;
      const events = new SurefootEvents(mixer, action, way === 'extras' ? null : sidecar);
      const came = [];
      let clock = 0, count = 0, step = 0;
      for (const type of NAMES) events.addEventListener(type, ({ detail }) => came.push([type, detail.foot, detail.time, clock, step]));
      action.play();
      events.update();
      while (clock < loops * clip.duration + 0.1) {
        step = frame(count);
        clock += step;
        count += 1;
        mixer.update(step);
        events.update();
        for (const foot of ['left', 'right']) {
          const now = report.contacts.some((one) => one.foot === foot && one.start <= action.time && action.time < one.end);
          if ((events.contact(foot) !== null) !== now) problems.push(way + ': contact() is wrong at ' + action.time);
        }
      }
      told += came.length;
      if (came.length !== due.length * loops) problems.push(way + ': ' + came.length + ' events came, ' + due.length * loops + ' were due');
      for (const [type, foot, time] of due) {
        const found = came.filter((one) => one[0] === type && one[1] === foot && one[2] === time);
        if (found.length !== loops) problems.push(way + ': ' + type + ' of ' + time + ' s came ' + found.length + ' times');
        found.forEach(([, , , at, step], loop) => {
          const late = at - loop * clip.duration - time;
          if (late < -1e-6 || late > step + 1e-6) problems.push(way + ': ' + type + ' of ' + time + ' s came ' + late + ' s after its time');
        });
      }
      for (let at = 1; at < came.length; at += 1) {
        if (came[at][3] === came[at - 1][3] && came[at][2] < came[at - 1][2] && came[at - 1][2] - came[at][2] < 1) problems.push(way + ': out of order at ' + came[at][3]);
      }
      events.dispose();
      const silent = new SurefootEvents(mixer, action, sidecar);
      silent.dispose();
    }
    const bare = clip.clone();
    bare.userData = {};
    const mixer = new THREE.AnimationMixer(gltf.scene);
    try { new SurefootEvents(mixer, mixer.clipAction(bare)); problems.push('a clip without a report is taken'); } catch (error) { if (!/events\\.json/.test(String(error))) problems.push(String(error)); }
  }
  return { problems, told };
};
window.ready = true;
</script>`;
let bad = 0;
let sidecars = [];
await inPage({ playwright, browserPath, page, served: { three, files: resolve(folder) } }, async (tab) => {
  sidecars = readdirSync(folder).filter((name) => name.endsWith('.events.json')).sort();
  for (const name of sidecars) {
    const stem = name.slice(0, -'.events.json'.length);
    const file = ['.glb', '.vrma'].map((ending) => stem + ending).find((file) => existsSync(join(folder, file)));
    const { problems, told } = await tab.evaluate(
      ([file, sidecar]) => window.check(file, sidecar).catch((error) => ({ problems: [String(error)], told: 0 })),
      [file, JSON.parse(readFileSync(join(folder, name)))],
    );
    if (told === 0) problems.push('no event came');
    if (problems.length) bad += 1;
    console.log(`${file}: ${problems.length ? 'BAD' : 'ok'}: ${told} events${[...new Set(problems)].slice(0, 8).map((problem) => `\n  ${problem}`).join('')}`);
  }
});
console.log(`${sidecars.length} files, ${bad} bad`);
process.exit(bad > 0 || sidecars.length === 0 ? 1 : 0);
