// Makes a "captured" walk with one fault in it, from a walk that was baked as a VRM animation:
//   node planted_walk.mjs WALK.vrma STEP CENTIMETRES OUT.bvh
// After the STEP-th landing of the left foot (from 1) the foot slides outwards by so many centimetres while it is on the ground, and comes back in
// its next swing, as captured feet do; the sole's own angle stays. 0 cm writes the walk as it is. BVH: 30 frames a second, centimetres, the
// body without fingers. A VRM animation's bones rest without rotation, so its local rotations are BVH's own.
import { readFileSync, writeFileSync } from 'node:fs';

const [source, step, centimetres, out] = process.argv.slice(2);
if (!out) {
  console.error('usage: node planted_walk.mjs WALK.vrma STEP CENTIMETRES OUT.bvh');
  process.exit(2);
}
const fps = 30;
const file = readFileSync(source);
const length = file.readUInt32LE(12);
const gltf = JSON.parse(file.subarray(20, 20 + length));
const floats = (index) => {
  const { bufferView, byteOffset = 0, count, type } = gltf.accessors[index];
  const width = { SCALAR: 1, VEC3: 3, VEC4: 4 }[type];
  const start = 28 + length + (gltf.bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
  const at = (i, k) => file.readFloatLE(start + 4 * (i * width + k));
  return Array.from({ length: count }, (_, i) => Array.from({ length: width }, (_, k) => at(i, k)));
};

// Quaternions [x, y, z, w].
const times = ([ax, ay, az, aw], [bx, by, bz, bw]) => [
  aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
  aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz,
];
const inverse = ([x, y, z, w]) => [-x, -y, -z, w];
const mix = (a, b, share) => {
  const sign = a.length === 4 && a.reduce((sum, x, k) => sum + x * b[k], 0) < 0 ? -1 : 1;
  const sum = a.map((x, k) => x * (1 - share) + sign * b[k] * share);
  return a.length === 4 ? sum.map((x) => x / Math.hypot(...sum)) : sum;
};

const [animation] = gltf.animations;
const curve = ({ sampler }) => {
  const { input, output } = animation.samplers[sampler];
  const [keys, values] = [floats(input).flat(), floats(output)];
  return (time) => {
    const after = keys.findIndex((key) => key > time);
    if (after < 0) return values.at(-1);
    if (after === 0) return values[0];
    return mix(values[after - 1], values[after], (time - keys[after - 1]) / (keys[after] - keys[after - 1]));
  };
};
const curves = new Map(animation.channels.map((channel) => [`${channel.target.node} ${channel.target.path}`, curve(channel)]));
const named = (name) => gltf.nodes.findIndex((node) => node.name === name);
const turn = (node, time) => curves.get(`${node} rotation`)?.(time) ?? [0, 0, 0, 1];

// How much of the slide is there: 0 at the landing, 1 at the lift-off, 0 at the next landing.
const { events, duration } = animation.extras.surefoot;
const of = (name) => events.filter((event) => event.name === name && event.foot === 'left').map((event) => event.time);
const [downs, ups] = [of('foot_down'), of('foot_up')];
const lands = downs[step - 1];
const leaves = ups.find((time) => time > lands) ?? duration;
const next = downs.find((time) => time > leaves) ?? duration;
const smooth = (from, to, time) => {
  const share = Math.min(Math.max((time - from) / (to - from), 0), 1);
  return share * share * (3 - 2 * share);
};
const there = (time) => smooth(lands, leaves, time) * (1 - smooth(leaves, next, time));

const [thigh, shank, foot, hips] = ['leftUpperLeg', 'leftLowerLeg', 'leftFoot', 'hips'].map(named);
const legLength = Math.hypot(...gltf.nodes[shank].translation) + Math.hypot(...gltf.nodes[foot].translation);
const angle = (time) => Math.asin(Math.min(centimetres / 100 / legLength, 0.9)) * there(time);
// The thigh turns outwards about the hips' forward axis, the foot turns back.
const planted = (node, time) => {
  const own = turn(node, time);
  const out = [0, 0, Math.sin(angle(time) / 2), Math.cos(angle(time) / 2)];
  if (node === thigh) return times(out, own);
  if (node !== foot) return own;
  const leg = times(turn(thigh, time), turn(shank, time));
  return times(inverse(times(out, leg)), times(leg, own));
};

const joints = [];
const lines = ['HIERARCHY'];
const cm = (metres) => metres.map((x) => (100 * x).toFixed(4)).join(' ');
const write = (node, depth) => {
  const pad = '\t'.repeat(depth);
  const { name, translation = [0, 0, 0], children = [] } = gltf.nodes[node];
  const kept = children.filter((child) => !/Thumb|Index|Middle|Ring|Little/.test(gltf.nodes[child].name));
  joints.push(node);
  lines.push(`${pad}${depth === 0 ? 'ROOT' : 'JOINT'} ${name}`, `${pad}{`);
  lines.push(`${pad}\tOFFSET ${depth === 0 ? '0 0 0' : cm(translation)}`);
  lines.push(`${pad}\tCHANNELS ${depth === 0 ? '6 Xposition Yposition Zposition' : '3'} Zrotation Xrotation Yrotation`);
  kept.forEach((child) => write(child, depth + 1));
  if (kept.length === 0) {
    const end = /Toes/.test(name) ? [0, 0, 0.06] : /Hand/.test(name) ? [name.startsWith('left') ? 0.1 : -0.1, 0, 0] : [0, 0.2, 0];
    lines.push(`${pad}\tEnd Site`, `${pad}\t{`, `${pad}\t\tOFFSET ${cm(end)}`, `${pad}\t}`);
  }
  lines.push(`${pad}}`);
};
write(hips, 0);

// Degrees about Z, X, Y in that order.
const euler = ([x, y, z, w]) => {
  const degrees = (radians) => ((radians * 180) / Math.PI).toFixed(3);
  const tilt = Math.asin(Math.min(Math.max(2 * (y * z + w * x), -1), 1));
  const about = [Math.atan2(2 * (w * z - x * y), 1 - 2 * (x * x + z * z)), tilt, Math.atan2(2 * (w * y - x * z), 1 - 2 * (x * x + y * y))];
  return about.map(degrees).join(' ');
};
const frames = Math.round(duration * fps) + 1;
lines.push('MOTION', `Frames: ${frames}`, `Frame Time: ${(1 / fps).toFixed(8)}`);
for (let frame = 0; frame < frames; frame += 1) {
  const time = frame / fps;
  const place = curves.get(`${hips} translation`)?.(time) ?? gltf.nodes[hips].translation;
  lines.push(`${place.map((x) => (100 * x).toFixed(2)).join(' ')} ${joints.map((node) => euler(planted(node, time))).join(' ')}`);
}
writeFileSync(out, `${lines.join('\n')}\n`);
console.log(`${out}: ${frames} frames; the left foot slides by ${centimetres} cm from ${lands.toFixed(2)} to ${leaves.toFixed(2)} s`);
