// Plays baked files as four other programs read them, by hand:
//   node programs_check.mjs FOLDER [--only assimp,optimize,gltfpack,gltfpack30,filament] [--browser CHROMIUM] [NAME ...]
// Every clip with a report of every FOLDER/*.glb whose name has NAME in it, every 10 ms, against what the file says (gltf_reference.mjs): finite, each
// joint of a skin within 1 mm in Assimp (Debian's assimp-utils) and Filament (in Chromium), within 5 mm after `gltf-transform optimize` at its
// defaults and after gltfpack with -af 120. What gltfpack's own 30 Hz leave of a foot that lifts off between two samples is told and not held. Assimp and Filament get a copy with nodes called n0, n1, ... and without extras, as do the two that
// rewrite files: they reorder nodes. Needs filament, playwright-core, gltfpack, @gltf-transform/cli (which brings core, extensions and
// meshoptimizer), found as in validate.mjs.
import { spawnSync } from 'node:child_process';
import { createRequire } from 'node:module';
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { parseArgs } from 'node:util';
import { pathToFileURL } from 'node:url';
import { Glb, compare, composed, renamed, said, slerp, times } from './gltf_reference.mjs';
import { inPage } from './page.mjs';

const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: { only: { type: 'string', default: 'assimp,optimize,gltfpack,gltfpack30,filament' }, browser: { type: 'string', default: process.env.CHROMIUM ?? '/usr/bin/chromium' } },
});
const [folder, ...names] = positionals;
if (!folder) {
  console.error('usage: node programs_check.mjs FOLDER [--only assimp,optimize,gltfpack,gltfpack30,filament] [--browser CHROMIUM] [NAME ...]');
  process.exit(2);
}
const modules = process.env.SUREFOOT_NODE_MODULES;
const require = createRequire(modules ? join(resolve(modules), 'x.js') : import.meta.url);
/** A file of a package, also one that it does not export. */
const packageOf = (name, inner) => join(require.resolve.paths(name).map((path) => join(path, name)).find(existsSync) ?? '/nowhere', inner);
const scratch = mkdtempSync(join(tmpdir(), 'surefoot-programs-'));
process.on('exit', () => rmSync(scratch, { recursive: true, force: true }));

function run(program, words) {
  const { status, stdout, stderr, error } = spawnSync(program, words, { encoding: 'utf8', maxBuffer: 1 << 28 });
  if (error || status !== 0) throw new Error(`${program}: ${error ?? `${stdout.slice(-200)} ${stderr.slice(-400)}`}`);
}

/** A clip as it is in a file that a program has made of ours. */
function rewritten(bytes) {
  const glb = new Glb(bytes);
  const places = new Map(glb.nodes.map((node, at) => [node.name, at]));
  return (index, joints, due) => glb.samples(index, joints.map((joint) => places.get(`n${joint}`)), due.at(-1).time);
}

async function optimize(given) {
  const made = join(scratch, 'optimized.glb');
  run(process.execPath, [packageOf('@gltf-transform/cli', 'bin/cli.js'), 'optimize', given, made]);
  const [{ NodeIO }, { ALL_EXTENSIONS }, { MeshoptDecoder }] = await Promise.all(
    [['@gltf-transform/core', 'dist/index.js'], ['@gltf-transform/extensions', 'dist/index.js'], ['meshoptimizer', 'index.js']].map(([name, file]) => import(pathToFileURL(packageOf(name, file)))),
  );
  await MeshoptDecoder.ready;
  const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ 'meshopt.decoder': MeshoptDecoder });
  const document = await io.read(made);
  // Written plainly, for the reader here.
  document.getRoot().listExtensionsUsed().filter((one) => one.extensionName === 'EXT_meshopt_compression').forEach((one) => one.dispose());
  return rewritten(await io.writeBinary(document));
}

const gltfpack = (...words) => (given) => {
  const made = join(scratch, 'packed.glb');
  run(process.execPath, [packageOf('gltfpack', 'cli.js'), '-i', given, '-o', made, ...words]);
  return rewritten(new Uint8Array(readFileSync(made)));
};

/** Assimp's own scene, as its JSON has it: times in ticks, quaternions w first, matrices row by row. */
function assimp(given) {
  const made = join(scratch, 'scene.json');
  run('assimp', ['export', given, made, '-fassjson']);
  const scene = JSON.parse(readFileSync(made, 'utf8').replace(/"?-?\b(nan|NaN|inf|Infinity)\b"?/g, 'null'));
  const nodes = new Map();
  const gather = (node, parent) => {
    nodes.set(node.name, { parent, matrix: [0, 1, 2, 3].flatMap((column) => [0, 1, 2, 3].map((row) => node.transformation[4 * row + column])) });
    (node.children ?? []).forEach((child) => gather(child, node.name));
  };
  gather(scene.rootnode, null);
  return (index, joints, due) => {
    const { channels, tickspersecond } = scene.animations[index];
    const held = new Map(channels.map((channel) => [channel.name, channel]));
    const value = (keys, tick, mix) => {
      const after = keys.findIndex(([time]) => time > tick);
      if (after < 0) return keys.at(-1)[1];
      if (after === 0) return keys[0][1];
      const [[from, a], [to, b]] = [keys[after - 1], keys[after]];
      return mix(a, b, (tick - from) / (to - from));
    };
    const line = (a, b, u) => a.map((x, i) => x + u * (b[i] - x));
    const number = (list) => list.map((x) => x ?? NaN);
    return due.map(({ time }) => {
      const worlds = new Map();
      const world = (name) => {
        if (!worlds.has(name)) {
          const { parent, matrix } = nodes.get(name);
          const channel = held.get(name);
          const tick = time * tickspersecond;
          const [w, x, y, z] = channel ? number(value(channel.rotationkeys, tick, slerp)) : [];
          const own = channel ? composed(number(value(channel.positionkeys, tick, line)), [x, y, z, w], value(channel.scalingkeys, tick, line)) : matrix;
          worlds.set(name, parent ? times(world(parent), own) : own);
        }
        return worlds.get(name);
      };
      return { time, places: joints.map((joint) => world(`n${joint}`).slice(12, 15)) };
    });
  };
}

const page = `<!doctype html><canvas width="8" height="8"></canvas><script src="/filament/filament.js"></script><script>
Filament.init([], () => {
  const engine = Filament.Engine.create(document.querySelector('canvas'));
  window.play = async (index, joints, moments) => {
    const bytes = new Uint8Array(await (await fetch('/files/given.glb', { cache: 'no-store' })).arrayBuffer());
    const loader = engine.createAssetLoader();
    const asset = loader.createAsset(bytes);
    await new Promise((done) => asset.loadResources(done, null, null, 1));
    const animator = asset.getInstance().getAnimator();
    const manager = engine.getTransformManager();
    const instances = joints.map((joint) => asset.getEntitiesByName('n' + joint)[0]).map((entity) => entity && manager.getInstance(entity));
    const found = moments.map((time) => {
      animator.applyAnimation(index, time);
      return { time, places: instances.map((one) => (one ? Array.from(manager.getWorldTransform(one)).slice(12, 15) : [NaN, NaN, NaN])) };
    });
    loader.destroyAsset(asset);
    return found;
  };
  window.ready = true;
});
</script>`;

/** Filament begins again at a clip's very end: the moments, the last a little earlier. */
const before = (due) => due.map(({ time }, at) => (at === due.length - 1 ? time - 1e-5 : time));

const programs = {
  assimp: { bound: 1e-3, open: assimp },
  optimize: { bound: 5e-3, open: optimize },
  gltfpack: { bound: 5e-3, open: gltfpack('-af', '120') },
  gltfpack30: { bound: Infinity, open: gltfpack() },
  filament: { bound: 1e-3, open: () => (index, joints, due) => tab.evaluate(([index, joints, moments]) => window.play(index, joints, moments), [index, joints, before(due)]) },
};
const asked = options.only.split(',');
const files = readdirSync(folder).filter((name) => name.endsWith('.glb') && (names.length === 0 || names.some((part) => name.includes(part)))).sort();
const bad = Object.fromEntries(asked.map((name) => [name, 0]));
let tab = null;

async function all() {
  for (const file of files) {
    const glb = new Glb(new Uint8Array(readFileSync(join(folder, file))));
    const given = join(scratch, 'given.glb');
    writeFileSync(given, renamed(glb));
    const shown = new Set(glb.joints());
    const joints = [...new Set((glb.json.skins ?? []).flatMap((skin) => skin.joints))].filter((joint) => shown.has(joint));
    for (const program of asked) {
      let good = joints.length > 0;
      let lines = good ? [] : ['no skin'];
      try {
        const play = good ? await programs[program].open(given) : null;
        for (const { index, name, report } of good ? glb.clips() : []) {
          const due = glb.samples(index, joints);
          const told = compare(report, joints, due, await play(index, joints, due));
          lines.push(`${name}: ${said(told, joints.length)}`);
          good &&= told.off <= programs[program].bound;
        }
      } catch (error) {
        good = false;
        lines = [String(error.message ?? error).split('\n')[0]];
      }
      if (!good && joints.length > 0) bad[program] += 1;
      lines.forEach((line) => console.log(`${program}: ${file}: ${good ? 'ok' : joints.length ? 'BAD' : 'not compared'}: ${line}`));
    }
  }
}

if (asked.includes('filament')) {
  const served = { filament: packageOf('filament', '.'), files: scratch };
  await inPage({ playwright: require('playwright-core'), browserPath: options.browser, page, served, drawn: true }, async (opened) => {
    tab = opened;
    await all();
  });
} else {
  await all();
}
console.log(`${files.length} files; bad: ${asked.map((name) => `${name} ${bad[name]}`).join(', ')}`);
process.exit(files.length === 0 || Object.values(bad).some((count) => count > 0) ? 1 : 0);
