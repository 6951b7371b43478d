// The stick figure on its floor, seen by a camera that turns about it. Metres in, CSS pixels out.
class Camera {
  constructor(yaw, pitch, distance) {
    Object.assign(this, { yaw, pitch, distance, target: [0, 0.9, 0], width: 1, height: 1 });
  }

  aim() {
    const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
    this.eye = [this.target[0] + this.distance * cp * sy, this.target[1] + this.distance * sp, this.target[2] + this.distance * cp * cy];
    this.forward = [-cp * sy, -sp, -cp * cy];
    this.right = [cy, 0, -sy];
    this.up = [-sp * sy, cp, -sp * cy];
    this.focal = 1.5 * Math.min(this.width * 1.15, this.height);
  }

  // [x, y, pixels a metre, depth]; depth under `near` is behind the eye.
  project(point) {
    const d = [point[0] - this.eye[0], point[1] - this.eye[1], point[2] - this.eye[2]];
    const dot = (axis) => d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2];
    const depth = dot(this.forward), scale = this.focal / Math.max(depth, 0.05);
    return [this.width / 2 + dot(this.right) * scale, this.height / 2 - dot(this.up) * scale, scale, depth];
  }
}

// m, how thick a bone is drawn, by the role of the joint that it leads to.
function thickness(role) {
  if (/UpperLeg$/.test(role)) return 0.12;
  if (/LowerLeg$/.test(role)) return 0.115;
  if (/Foot$/.test(role)) return 0.085;
  if (/Toes$/.test(role)) return 0;
  if (/UpperArm$/.test(role)) return 0.08;
  if (/LowerArm$/.test(role)) return 0.075;
  if (/Hand$/.test(role)) return 0.06;
  if (/^(spine|chest|upperChest)$/.test(role)) return 0.15;
  return 0.075;
}

const sideOf = (role) => (role.startsWith('left') ? 'left' : role.startsWith('right') ? 'right' : 'trunk');
const mixed = (colour, other, share) => `color-mix(in srgb, ${colour} ${Math.round(100 - share * 100)}%, ${other})`;

// What is flagged in a frame: feet by name, the body, each with its colour.
function flaggedIn(clip, frame) {
  const at = Math.round(frame);
  return clip.flags.filter((flag) => flag.waived === undefined && flag.start <= at && at <= flag.end);
}

// Draws the figure and all that stands on the floor. `plain` leaves floor marks out (thumbnails).
function drawScene(context, camera, clip, frame, plain, only) {
  const { width, height } = camera;
  const sky = context.createLinearGradient(0, 0, 0, height);
  sky.addColorStop(0, colours['stage-far']);
  sky.addColorStop(1, colours['stage-near']);
  context.fillStyle = sky;
  context.fillRect(0, 0, width, height);
  const points = pose(clip, frame);
  if (!points.length) return;
  camera.aim();
  const floor = value(clip, 'floor', frame);
  drawGrid(context, camera, floor);
  if (!plain) drawTrails(context, camera, clip, frame, floor);
  drawPrints(context, camera, clip, frame, plain);
  drawShadow(context, camera, clip, points, floor);
  const flags = only ? [only] : flaggedIn(clip, frame);
  drawBody(context, camera, clip, points, flags);
  drawMarks(context, camera, clip, frame, flags, plain, floor);
}

function drawGrid(context, camera, floor) {
  const reach = 5, middle = [Math.round(camera.target[0]), Math.round(camera.target[2])];
  context.lineWidth = 1;
  for (let i = -reach * 2; i <= reach * 2; i++) {
    for (const axis of [0, 1]) {
      const strong = i % 2 === 0;
      for (let j = -reach; j < reach; j++) {
        const a = [0, floor, 0], b = [0, floor, 0];
        const [fixed, along] = axis ? [0, 2] : [2, 0];
        a[fixed] = b[fixed] = middle[fixed / 2] + i / 2;
        a[along] = middle[along / 2] + j;
        b[along] = a[along] + 1;
        const far = Math.hypot(a[0] + b[0] - 2 * camera.target[0], a[2] + b[2] - 2 * camera.target[2]) / 2;
        const strength = Math.max(0, 1 - far / reach) * (strong ? 0.9 : 0.45);
        const from = camera.project(a), to = camera.project(b);
        if (strength < 0.03 || from[3] < 0.1 || to[3] < 0.1) continue;
        context.globalAlpha = strength;
        context.strokeStyle = colours['grid-strong'];
        context.beginPath();
        context.moveTo(from[0], from[1]);
        context.lineTo(to[0], to[1]);
        context.stroke();
      }
    }
  }
  context.globalAlpha = 1;
}

// Where the centre of mass and ξ went, on the floor, two seconds either way.
function drawTrails(context, camera, clip, frame, floor) {
  const half = 2 * clip.fps, step = Math.max(clip.stride, clip.fps / 30);
  for (const [name, colour] of [['com', 'com'], ['xi', 'xi']]) {
    context.strokeStyle = colours[colour];
    context.lineWidth = 1.5;
    context.globalAlpha = 0.5;
    context.beginPath();
    let pen = false;
    for (let at = Math.max(0, frame - half); at <= Math.min(clip.last, frame + half); at += step) {
      const place = camera.project([value(clip, name + '_x', at), floor, value(clip, name + '_z', at)]);
      if (place[3] < 0.1) { pen = false; continue; }
      if (pen) context.lineTo(place[0], place[1]); else context.moveTo(place[0], place[1]);
      pen = true;
    }
    context.stroke();
  }
  context.globalAlpha = 1;
}

function floorPath(context, camera, plan, height) {
  context.beginPath();
  for (const [index, [x, z]] of plan.entries()) {
    const place = camera.project([x, height, z]);
    if (place[3] < 0.1) return false;
    if (index) context.lineTo(place[0], place[1]); else context.moveTo(place[0], place[1]);
  }
  context.closePath();
  return true;
}

function drawPrints(context, camera, clip, frame, plain) {
  const near = plain ? 0.9 * clip.fps : 2.5 * clip.fps;
  for (const print of clip.prints) {
    if (print.start > frame + near || print.end < frame - near) continue;
    const now = print.start <= frame && frame <= print.end;
    if (!floorPath(context, camera, outline(clip, print), print.y / 1000)) continue;
    context.globalAlpha = now ? 0.6 : 0.22;
    context.fillStyle = colours[print.foot];
    context.fill();
  }
  for (const step of clip.steps) {
    const print = printOf(clip, step);
    if (!print || Math.abs(step.touch_down - frame) > near) continue;
    if (!floorPath(context, camera, outline(clip, print, step.predicted), print.y / 1000)) continue;
    context.globalAlpha = Math.max(0.15, 1 - Math.abs(step.touch_down - frame) / near);
    context.strokeStyle = colours[print.foot];
    context.lineWidth = 1.6;
    context.setLineDash([5, 4]);
    context.stroke();
    context.setLineDash([]);
  }
  context.globalAlpha = 1;
}

function drawShadow(context, camera, clip, points, floor) {
  context.strokeStyle = colours.shadow;
  context.lineCap = 'round';
  context.beginPath();
  let scale = 1;
  for (const [from, to] of clip.bones) {
    const [a, b] = [points[from], points[to]].map((p) => camera.project([p[0], floor, p[2]]));
    if (a[3] < 0.1 || b[3] < 0.1) continue;
    scale = a[2];
    context.moveTo(a[0], a[1]);
    context.lineTo(b[0], b[1]);
  }
  context.lineWidth = Math.max(2, 0.11 * clip.size * scale);
  context.stroke();
}

function drawBody(context, camera, clip, points, flags) {
  const size = clip.size, red = new Set(flags.map((flag) => flag.foot).filter(Boolean));
  const soles = clip.columns - 6, pieces = [];
  const capsule = (a, b, width, colour, glow) => {
    const from = camera.project(a), to = camera.project(b);
    if (from[3] < 0.1 || to[3] < 0.1 || width <= 0) return;
    pieces.push({ depth: (from[3] + to[3]) / 2, from, to, width: Math.max(2, width * size * (from[2] + to[2]) / 2), colour, glow });
  };
  for (const [from, to, role] of clip.bones) {
    const side = sideOf(role), bad = red.has(side) && /(Foot|LowerLeg)$/.test(role);
    capsule(points[from], points[to], thickness(role), bad ? colours.flagged : colours[side], bad && /Foot$/.test(role));
  }
  for (const [index, side] of ['left', 'right'].entries()) {
    const ankle = points[clip.role[side + 'Foot']] ?? points[0];
    const [heel, ball, tip] = [0, 1, 2].map((i) => points[soles + 3 * index + i]);
    const colour = red.has(side) ? colours.flagged : colours[side], thick = 0.045;
    const over = (point) => [point[0], point[1] + 0.5 * thick * size, point[2]];
    const glow = red.has(side);
    capsule(over(heel), over(ball), thick * 1.25, colour, glow);
    capsule(over(ball), over(tip), thick, colour, glow);
    capsule(ankle, over(heel), thick * 1.3, colour, glow);
    capsule(ankle, over(ball), thick * 1.1, colour, glow);
  }
  const head = points[clip.role.head], top = points[clip.columns - 7];
  if (head && top) {
    const low = [0, 1, 2].map((axis) => head[axis] + (top[axis] - head[axis]) * 0.38), high = [0, 1, 2].map((axis) => head[axis] + (top[axis] - head[axis]) * 0.66);
    capsule(head, low, 0.075, colours.trunk, false);
    capsule(low, high, 0.155, colours.head, false);
  }
  // The trunk between shoulders and hips, so that it has breadth from the front.
  const corners = ['leftUpperArm', 'rightUpperArm', 'rightUpperLeg', 'leftUpperLeg'].map((role) => points[clip.role[role]]);
  if (corners.every(Boolean)) {
    const drawn = corners.map((corner, index) => camera.project(index < 2 ? corner.map((x, axis) => x + (corners[3 - index][axis] - x) * 0.1) : corner));
    if (drawn.every((corner) => corner[3] > 0.1)) {
      const depth = drawn.reduce((sum, corner) => sum + corner[3], 0) / 4;
      pieces.push({ depth: depth + 0.02, polygon: drawn, width: 0.1 * size * drawn[0][2], colour: colours.trunk });
    }
  }
  pieces.sort((a, b) => b.depth - a.depth);
  const nearest = pieces.length ? pieces[pieces.length - 1].depth : 1;
  context.lineCap = 'round';
  for (const piece of pieces) {
    const haze = Math.min(0.35, Math.max(0, (piece.depth - nearest) * 0.35));
    if (piece.polygon) {
      drawTrunk(context, piece, mixed(piece.colour, colours['stage-far'], haze));
      continue;
    }
    const line = (width, colour, shift) => {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.beginPath();
      context.moveTo(piece.from[0] + shift, piece.from[1] + shift);
      context.lineTo(piece.to[0] + shift, piece.to[1] + shift);
      context.stroke();
    };
    if (piece.glow) {
      context.globalAlpha = 0.25;
      line(piece.width * 2.1, colours.flagged, 0);
      context.globalAlpha = 1;
    }
    const colour = mixed(piece.colour, colours['stage-far'], haze);
    line(piece.width, mixed(colour, '#000', 0.32), 0);
    line(piece.width * 0.82, colour, 0);
    line(piece.width * 0.34, mixed(colour, '#fff', 0.3), -piece.width * 0.14);
  }
}

function drawTrunk(context, piece, colour) {
  context.lineJoin = 'round';
  for (const [width, shade] of [[piece.width, mixed(colour, '#000', 0.32)], [piece.width * 0.8, colour]]) {
    context.beginPath();
    piece.polygon.forEach((corner, index) => { if (index) context.lineTo(corner[0], corner[1]); else context.moveTo(corner[0], corner[1]); });
    context.closePath();
    context.fillStyle = context.strokeStyle = shade;
    context.lineWidth = width;
    context.stroke();
    context.fill();
  }
}

// Centre of mass with its plumb line, ξ and ZMP on the floor.
function drawMarks(context, camera, clip, frame, flags, plain, floor) {
  const at = (name, height) => camera.project([value(clip, name + '_x', frame), height, value(clip, name + '_z', frame)]);
  const com = at('com', value(clip, 'com_y', frame)), foot = at('com', floor), xi = at('xi', floor);
  const alarmed = flags.some((flag) => !flag.foot);
  context.lineWidth = 1.3;
  context.strokeStyle = colours.com;
  context.setLineDash([3, 4]);
  context.beginPath();
  context.moveTo(com[0], com[1]);
  context.lineTo(foot[0], foot[1]);
  context.stroke();
  context.setLineDash([]);
  context.strokeStyle = context.fillStyle = colours.xi;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(foot[0], foot[1]);
  context.lineTo(xi[0], xi[1]);
  context.stroke();
  disc(context, xi, plain ? 3 : 5, colours.xi, colours.card);
  if (state(clip, 'pressed', frame) > 0 && !plain) disc(context, at('zmp', floor), 4.5, colours.zmp, colours.card);
  if (alarmed) {
    context.globalAlpha = 0.28;
    disc(context, com, plain ? 14 : 22, colours.flagged, colours.flagged);
    context.globalAlpha = 1;
  }
  disc(context, com, plain ? 4 : 6, alarmed ? colours.flagged : colours.com, colours.card);
}

function disc(context, place, radius, fill, rim) {
  context.beginPath();
  context.arc(place[0], place[1], radius, 0, 2 * Math.PI);
  context.fillStyle = fill;
  context.fill();
  context.lineWidth = 1.5;
  context.strokeStyle = rim;
  context.stroke();
}

// m, the height that a camera looks at: the middle of a body on the ground, higher where it jumps.
function middleOf(clip, frame) {
  return Math.max(value(clip, 'floor', frame) + 0.47 * clip.height, value(clip, 'com_y', frame) - 0.1 * clip.height);
}

// rad, where the pelvis looks in a frame: 0 is Z, a quarter turn X.
function facing(clip, frame) {
  const points = pose(clip, frame), left = points[clip.role.leftUpperLeg], right = points[clip.role.rightUpperLeg];
  return left && right ? Math.atan2(-(left[2] - right[2]), left[0] - right[0]) : 0;
}
