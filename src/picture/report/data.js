'use strict';
// The clips of the page and how to read them. Lengths in the data are whole mm, here metres; frames are the clip's own.
const clips = JSON.parse(document.getElementById('data').textContent);
const RULES = ['foot-placement', 'balance', 'foot-slide', 'penetration', 'float', 'ballistic', 'timing', 'drift'];
const PARTS = ['heel', 'ball', 'flat'];

// Turns differences into values, once, and makes what every view asks for.
function opened(clip) {
  if (clip.samples !== undefined) return clip;
  const sums = (flat, columns) => {
    const values = Int32Array.from(flat);
    for (let i = columns; i < values.length; i++) values[i] += values[i - columns];
    return values;
  };
  clip.width = 3 * clip.columns;
  clip.places = sums(clip.joints, clip.width);
  clip.values = sums(clip.curves, clip.curveNames.length);
  clip.joints = clip.curves = null;
  clip.samples = clip.places.length / clip.width;
  clip.last = Math.max(0, clip.frames - 1);
  clip.column = Object.fromEntries(clip.curveNames.map((name, index) => [name, index]));
  clip.role = Object.fromEntries(clip.bones.map(([, to, role]) => [role, to]));
  clip.size = clip.height / 1.75 || 1;
  return clip;
}

// The samples on both sides of a frame and the share of the later one.
function between(clip, frame) {
  const at = Math.min(Math.max(frame / clip.stride, 0), clip.samples - 1);
  const first = Math.floor(at);
  return [first, Math.min(first + 1, clip.samples - 1), at - first];
}

// Every column's place in a frame: an array of [x, y, z] in metres.
function pose(clip, frame) {
  const points = [];
  if (!clip.samples) return points;
  const [a, b, share] = between(clip, frame);
  for (let i = 0; i < clip.width; i += 3) {
    const point = [0, 0, 0];
    for (let axis = 0; axis < 3; axis++) {
      const from = clip.places[a * clip.width + i + axis], to = clip.places[b * clip.width + i + axis];
      point[axis] = (from + (to - from) * share) / 1000;
    }
    points.push(point);
  }
  return points;
}

// A curve's value at a sample, as it is in the data.
function raw(clip, name, sample) {
  return clip.values[sample * clip.curveNames.length + clip.column[name]];
}

// A curve in metres (or m/s) in a frame.
function value(clip, name, frame) {
  if (!clip.samples) return 0;
  const [a, b, share] = between(clip, frame);
  const from = raw(clip, name, a), to = raw(clip, name, b);
  return (from + (to - from) * share) / 1000;
}

// The nearest sample's whole number: contact parts, whether there is support.
function state(clip, name, frame) {
  if (!clip.samples) return -1;
  const [a, b, share] = between(clip, frame);
  return raw(clip, name, share < 0.5 ? a : b);
}

// Standing flags first by severity, waived ones after them.
function worstFirst(clip) {
  const order = clip.flags.map((flag, index) => ({ flag, index }));
  const waived = ({ flag }) => (flag.waived === undefined ? 0 : 1);
  return order.sort((a, b) => waived(a) - waived(b) || b.flag.severity - a.flag.severity || a.flag.start - b.flag.start);
}

// The frame of a flag that shows it best.
function tellingFrame(clip, flag) {
  if (flag.rule === 'foot-placement' || !clip.samples) return flag.start;
  const score = {
    balance: (frame) => -value(clip, 'margin', frame),
    float: (frame) => value(clip, 'sole_' + (flag.foot ?? 'left'), frame),
    penetration: (frame) => -value(clip, 'sole_' + (flag.foot ?? 'left'), frame),
    ballistic: (frame) => value(clip, 'com_y', frame),
    'foot-slide': (frame) => slip(clip, flag.foot ?? 'left', frame),
    drift: (frame) => slip(clip, flag.foot ?? 'left', frame),
  }[flag.rule];
  let best = Math.round((flag.start + flag.end) / 2);
  if (!score) return best;
  const step = Math.max(1, Math.floor((flag.end - flag.start) / 200));
  for (let frame = flag.start; frame <= flag.end; frame += step) if (score(frame) > score(best)) best = frame;
  return best;
}

// How far a foot that bears goes in a frame: the stillest of heel, ball and tip.
function slip(clip, foot, frame) {
  if (state(clip, 'part_' + foot, frame) < 0 || value(clip, 'sole_' + foot, frame) > 0.05) return -1;
  const first = clip.columns - 6 + (foot === 'right' ? 3 : 0), before = pose(clip, frame - clip.stride), after = pose(clip, frame + clip.stride);
  return Math.min(...[0, 1, 2].map((i) => Math.hypot(...[0, 1, 2].map((axis) => after[first + i][axis] - before[first + i][axis]))));
}

// Share of the frames that spans cover, both ends of each included.
function shareOf(clip, list) {
  const spans = list.map((span) => [span.start, span.end]).sort((a, b) => a[0] - b[0]);
  let frames = 0, upTo = -1;
  for (const [start, end] of spans) {
    frames += Math.max(0, end - Math.max(start - 1, upTo));
    upTo = Math.max(upTo, end);
  }
  return frames / Math.max(1, clip.frames);
}

const flaggedShare = (clip) => shareOf(clip, clip.flags.filter((flag) => flag.waived === undefined));
const standing = (clip) => [...clip.flags, ...clip.clipFlags].filter((flag) => flag.waived === undefined);
const centimetres = (metres) => (metres ? (metres * 100).toFixed(1) + ' cm' : '');
const seconds = (clip, frame) => (frame / clip.fps).toFixed(2) + ' s';

// A footprint's outline in plan, metres: [[x, z], ...]. `at` where it stands, or the print's own place.
function outline(clip, print, at) {
  const half = clip.feet[print.foot === 'right' ? 1 : 0] / 1000;
  const [x, z] = at ?? [print.x / 1000, print.z / 1000];
  const angle = print.angle / 1000, along = [Math.sin(angle), Math.cos(angle)], side = [along[1], -along[0]];
  const heel = print.heel / 1000, ball = print.ball / 1000, tip = print.tip / 1000, length = tip - heel;
  const shape = [
    [heel, 0.32], [heel + 0.05 * length, 0.62], [heel + 0.2 * length, 0.72], [heel + 0.45 * length, 0.66],
    [ball, 1], [tip - 0.1 * length, 0.8], [tip, 0.35],
  ];
  const place = ([forward, out], sign) => [0, 1].map((axis) => [x, z][axis] + along[axis] * forward + side[axis] * out * half * sign);
  return [...shape.map((point) => place(point, 1)), ...shape.slice().reverse().map((point) => place(point, -1))];
}

// The footprint that a step makes.
function printOf(clip, step) {
  const own = clip.prints.filter((print) => print.foot === step.foot);
  return own.find((print) => print.start <= step.touch_down && step.touch_down <= print.end) ?? own[0];
}

// The page's colours, read again when the scheme changes.
const colours = {};
function readColours() {
  const style = getComputedStyle(document.documentElement);
  const names = ['page', 'card', 'edge', 'ink', 'soft', 'faint', 'grid', 'grid-strong', 'stage-far', 'stage-near', 'shadow', 'accent',
    'left', 'left-heel', 'left-ball', 'right', 'right-heel', 'right-ball', 'trunk', 'head', 'flagged', 'com', 'xi', 'zmp', ...RULES];
  for (const name of names) colours[name] = style.getPropertyValue('--' + name).trim();
}

// A canvas at the screen's own resolution; its context in CSS pixels, and its size.
function canvasOf(canvas, height) {
  const ratio = window.devicePixelRatio || 1;
  const box = { width: canvas.clientWidth || 1, height: height ?? (canvas.clientHeight || 1) };
  const wanted = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
  if (canvas.width !== wanted[0] || canvas.height !== wanted[1]) [canvas.width, canvas.height] = wanted;
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { context, ...box };
}
