// What a clip of a .glb says, by glTF 2.0's own rules: the reference of the checks in JavaScript, in node and in a page.
// World positions of nodes, in the file's axes and units. Interpolation as appendix C of the specification has it; before the first key
// the first, after the last the last. Shares nothing with the program, nor with gltf_reference.py. Leaves out: sparse accessors, buffers
// outside of the file, weights of morph targets.
const PLANTED = 3e-3; // m; a joint that the file itself holds within this while a foot lies flat is a planted one
const STEP = 0.01; // s, between two samples
const NEAR = 0.4; // m, from a contact's point to a joint of that foot

const kinds = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const tops = { 5120: 127, 5121: 255, 5122: 32767, 5123: 65535 };
const widths = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT4: 16 };

export class Glb {
  /** `bytes`: the whole file, a Uint8Array. */
  constructor(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const length = view.getUint32(12, true);
    this.json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + length)));
    this.data = bytes.slice(20 + length + 8, 20 + length + 8 + view.getUint32(20 + length, true));
    this.nodes = this.json.nodes ?? [];
    this.parents = new Map(this.nodes.flatMap((node, at) => (node.children ?? []).map((child) => [child, at])));
  }

  /** An accessor's values, one array an element, integers as glTF normalises them. */
  array(index) {
    const { sparse, componentType, type, count, bufferView, byteOffset = 0, normalized } = this.json.accessors[index];
    if (sparse) throw new Error('sparse accessors are not read here');
    const width = widths[type];
    if (bufferView === undefined) return Array.from({ length: count }, () => new Array(width).fill(0));
    const view = this.json.bufferViews[bufferView];
    const Kind = kinds[componentType];
    const stride = view.byteStride ?? width * Kind.BYTES_PER_ELEMENT;
    const start = (view.byteOffset ?? 0) + byteOffset;
    return Array.from({ length: count }, (_, at) => {
      const from = start + at * stride;
      const values = Array.from(new Kind(this.data.buffer.slice(from, from + width * Kind.BYTES_PER_ELEMENT)));
      return normalized ? values.map((value) => Math.max(value / tops[componentType], -1)) : values;
    });
  }

  /** The clips that carry a report. */
  clips() {
    const told = (this.json.animations ?? []).map((clip, index) => ({ index, name: clip.name ?? '', report: clip.extras?.surefoot }));
    return told.filter((clip) => clip.report);
  }

  /** Skins' joints, and whatever a clip moves but by STEP (contact nodes jump at the very moment of a sample), of the default scene. */
  joints() {
    const found = new Set((this.json.skins ?? []).flatMap((skin) => skin.joints));
    for (const clip of this.json.animations ?? []) {
      for (const { target, sampler } of clip.channels) {
        if (target.node !== undefined && clip.samplers[sampler].interpolation !== 'STEP') found.add(target.node);
      }
    }
    const shown = new Set();
    const todo = this.json.scenes ? [...(this.json.scenes[this.json.scene ?? 0].nodes ?? [])] : this.nodes.map((_, at) => at);
    while (todo.length) {
      const node = todo.pop();
      shown.add(node);
      todo.push(...(this.nodes[node].children ?? []));
    }
    return [...found].filter((node) => shown.has(node)).sort((a, b) => a - b);
  }

  /** A clip's samplers, read: a function of the time to what moves, { "node path": value }. */
  sampler(index) {
    const clip = this.json.animations[index];
    const tracks = clip.channels
      .filter(({ target }) => target.node !== undefined && target.path !== 'weights')
      .map(({ target, sampler }) => {
        const { input, output, interpolation = 'LINEAR' } = clip.samplers[sampler];
        return { key: `${target.node} ${target.path}`, turns: target.path === 'rotation', keys: this.array(input).flat(), values: this.array(output), interpolation };
      });
    const duration = Math.max(...tracks.map((track) => track.keys.at(-1)));
    return { duration, at: (time) => new Map(tracks.map((track) => [track.key, sampled(track, time)])) };
  }

  /** Every 10 ms of a clip: [{ time, places: one [x, y, z] a joint }]. `end`: where another file's clip ends, s. */
  samples(index, joints, end = null) {
    const { duration, at } = this.sampler(index);
    const count = Math.floor((end ?? duration) / STEP + 1e-7) + 1;
    return Array.from({ length: count }, (_, sample) => {
      const time = sample * STEP;
      return { time, places: this.places(at(time), joints) };
    });
  }

  /** World positions of the joints where `moved` moves them. */
  places(moved, joints) {
    const worlds = new Map();
    const world = (node) => {
      if (!worlds.has(node)) {
        const { matrix, translation: t = [0, 0, 0], rotation: r = [0, 0, 0, 1], scale: s = [1, 1, 1] } = this.nodes[node];
        const of = (path, rest) => moved.get(`${node} ${path}`) ?? rest;
        const own = matrix ?? composed(of('translation', t), of('rotation', r), of('scale', s));
        worlds.set(node, this.parents.has(node) ? times(world(this.parents.get(node)), own) : own);
      }
      return worlds.get(node);
    };
    return joints.map((joint) => world(joint).slice(12, 15));
  }
}

/**
 * The file with its nodes called n0, n1, ..., without extras: for programs that tell nodes by name. Assimp 5.2 stops at nested extras.
 */
export function renamed(glb) {
  const json = structuredClone(glb.json);
  const strip = (value) => {
    if (value === null || typeof value !== 'object') return;
    delete value.extras;
    Object.values(value).forEach(strip);
  };
  strip(json);
  json.nodes.forEach((node, at) => { node.name = `n${at}`; });
  const text = new TextEncoder().encode(JSON.stringify(json));
  const length = Math.ceil(text.length / 4) * 4;
  const bytes = new Uint8Array(28 + length + glb.data.length).fill(0x20, 20, 20 + length);
  bytes.set(text, 20);
  bytes.set(glb.data, 28 + length);
  const words = [0x46546c67, 2, bytes.length, length, 0x4e4f534a];
  const view = new DataView(bytes.buffer);
  words.forEach((word, at) => view.setUint32(4 * at, word, true));
  view.setUint32(20 + length, glb.data.length, true);
  view.setUint32(24 + length, 0x004e4942, true);
  return bytes;
}

function sampled({ keys, values, interpolation, turns }, time) {
  const spline = interpolation === 'CUBICSPLINE';
  const value = (key) => values[spline ? 3 * key + 1 : key];
  const last = keys.length - 1;
  if (time <= keys[0]) return unit(value(0), turns);
  if (time >= keys[last]) return unit(value(last), turns);
  let [low, high] = [0, last];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (keys[middle] <= time) low = middle;
    else high = middle;
  }
  const span = keys[high] - keys[low];
  const u = (time - keys[low]) / span;
  if (interpolation === 'STEP') return value(low);
  if (spline) {
    const [u2, u3] = [u * u, u * u * u];
    const [leave, arrive] = [values[3 * low + 2], values[3 * high]];
    const mixed = value(low).map((a, i) => (2 * u3 - 3 * u2 + 1) * a + (u3 - 2 * u2 + u) * span * leave[i] + (3 * u2 - 2 * u3) * value(high)[i] + (u3 - u2) * span * arrive[i]);
    return unit(mixed, turns);
  }
  return turns ? slerp(value(low), value(high), u) : value(low).map((a, i) => a + u * (value(high)[i] - a));
}

const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const unit = (value, turns) => (turns ? value.map((x) => x / Math.sqrt(dot(value, value))) : value);

export function slerp(a, b, u) {
  const cosine = dot(a, b);
  const sign = cosine < 0 ? -1 : 1;
  const angle = Math.acos(Math.min(Math.abs(cosine), 1));
  const [from, to] = angle < 1e-6 ? [1 - u, u] : [Math.sin((1 - u) * angle) / Math.sin(angle), Math.sin(u * angle) / Math.sin(angle)];
  return unit(a.map((x, i) => from * x + to * sign * b[i]), true);
}

/** A matrix, column by column. */
export function composed(t, r, s) {
  const [x, y, z, w] = unit(r, true);
  const columns = [
    [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
    [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
    [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
  ];
  return [...columns.flatMap((column, i) => [...column.map((value) => value * s[i]), 0]), ...t, 1];
}

export function times(a, b) {
  const product = new Array(16);
  for (let column = 0; column < 4; column += 1) {
    for (let row = 0; row < 4; row += 1) {
      let sum = 0;
      for (let k = 0; k < 4; k += 1) sum += a[4 * k + row] * b[4 * column + k];
      product[4 * column + row] = sum;
    }
  }
  return product;
}

const far = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/**
 * How far a program's joints (`found`: samples as those of `due`) are from the reference, m; `scale`: the file's units a metre.
 * off, at: the worst joint. planted: spans of joints that stand while a foot lies flat; slid: the most that one of them moves in the program;
 * more: the most that it moves beyond the reference.
 */
export function compare(report, joints, due, found, scale = 1) {
  const told = { off: 0, at: '', planted: 0, slid: 0, more: 0, slidAt: '' };
  due.forEach(({ time, places }, sample) => {
    places.forEach((place, joint) => {
      const off = far(place, found[sample].places[joint]) / scale;
      if (!(off <= told.off)) [told.off, told.at] = [Number.isFinite(off) ? off : Infinity, `node ${joints[joint]} at ${time.toFixed(2)} s`];
    });
  });
  for (const contact of report.contacts ?? []) {
    const inside = due.map(({ time }, sample) => (time >= contact.start && time <= contact.end ? sample : -1)).filter((sample) => sample >= 0);
    if (contact.part !== 'flat' || (contact.frame ?? 'world') !== 'world' || inside.length < 3) continue;
    joints.forEach((node, joint) => {
      if (far(due[inside[0]].places[joint], contact.position) / scale > NEAR) return;
      const moves = (samples) => Math.max(...inside.map((sample) => far(samples[sample].places[joint], samples[inside[0]].places[joint]))) / scale;
      const own = moves(due);
      if (own > PLANTED) return;
      const seen = moves(found);
      told.planted += 1;
      told.slid = Math.max(told.slid, seen);
      if (seen - own > told.more) [told.more, told.slidAt] = [seen - own, `node ${node}, ${contact.foot} from ${contact.start.toFixed(2)} s`];
    });
  }
  return told;
}

/** A line that tells it. */
export function said({ off, at, planted, slid, more, slidAt }, joints) {
  const mm = (metres) => (metres * 1000).toFixed(3);
  return `${mm(off)} mm at worst of ${joints} joints (${at}); planted ${planted}: ${mm(slid)} mm, ${mm(more)} beyond the file's (${slidAt})`;
}
