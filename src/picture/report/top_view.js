// Footholds from above: actual and predicted, the way of the centre of mass and of ξ. The clip's way lies from left to right. A way
// too long to be legible as a whole is followed by the playhead, until somebody asks for all of it or moves it by hand.
const LEGIBLE = 150; // px a metre

class TopView {
  constructor(canvas, seek) {
    Object.assign(this, { canvas, zoom: 1, pan: [0, 0], seek, follow: true });
    let held = null, moved = 0;
    canvas.addEventListener('pointerdown', (event) => { held = [event.offsetX, event.offsetY]; moved = 0; canvas.setPointerCapture(event.pointerId); });
    canvas.addEventListener('pointermove', (event) => {
      if (!held) return;
      const by = [event.offsetX - held[0], event.offsetY - held[1]];
      moved += Math.abs(by[0]) + Math.abs(by[1]);
      this.pan = [this.pan[0] + by[0], this.pan[1] + by[1]];
      this.free = true;
      held = [event.offsetX, event.offsetY];
      this.draw(this.frame);
    });
    canvas.addEventListener('pointerup', (event) => { if (held && moved < 4) this.pick(event.offsetX, event.offsetY); held = null; });
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const by = Math.exp(-event.deltaY * 0.0015), zoom = Math.min(40, Math.max(0.6, this.zoom * by)), ratio = zoom / this.zoom;
      const middle = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2];
      this.pan = [0, 1].map((axis) => { const at = [event.offsetX, event.offsetY][axis] - middle[axis]; return at - (at - this.pan[axis]) * ratio; });
      this.zoom = zoom;
      this.draw(this.frame);
    }, { passive: false });
    canvas.addEventListener('dblclick', () => this.whole(this.follow));
  }

  // All of the way, or legible and with the playhead.
  whole(all) {
    Object.assign(this, { zoom: 1, pan: [0, 0], follow: !all, free: false });
    this.draw(this.frame);
  }

  show(clip) {
    Object.assign(this, { clip, zoom: 1, pan: [0, 0], follow: true, free: false });
    const places = [];
    const step = Math.max(1, Math.floor(clip.samples / 400));
    for (let sample = 0; sample < clip.samples; sample += step) places.push([raw(clip, 'com_x', sample) / 1000, raw(clip, 'com_z', sample) / 1000]);
    const mean = [0, 1].map((axis) => places.reduce((sum, place) => sum + place[axis], 0) / Math.max(1, places.length));
    let xx = 0, xz = 0, zz = 0;
    for (const [x, z] of places) { xx += (x - mean[0]) ** 2; xz += (x - mean[0]) * (z - mean[1]); zz += (z - mean[1]) ** 2; }
    let turn = 0.5 * Math.atan2(2 * xz, xx - zz);
    const [first, end] = [places[0] ?? mean, places[places.length - 1] ?? mean];
    if ((end[0] - first[0]) * Math.cos(turn) + (end[1] - first[1]) * Math.sin(turn) < 0) turn += Math.PI;
    this.turn = [Math.cos(turn), Math.sin(turn)];
    const corners = [...places, ...clip.prints.flatMap((print) => outline(clip, print)), ...clip.steps.map((step) => step.predicted)].map((place) => this.turned(place));
    this.bounds = [0, 1].map((axis) => {
      const values = corners.map((corner) => corner[axis]).filter(Number.isFinite);
      return values.length ? [values.reduce((a, b) => Math.min(a, b)) - 0.15, values.reduce((a, b) => Math.max(a, b)) + 0.15] : [-1, 1];
    });
  }

  turned([x, z]) { return [x * this.turn[0] + z * this.turn[1], -x * this.turn[1] + z * this.turn[0]]; }

  place(plan) {
    const [u, v] = this.turned(plan);
    return [this.box.width / 2 + this.pan[0] + (u - this.middle[0]) * this.scale, this.box.height / 2 + this.pan[1] + (v - this.middle[1]) * this.scale];
  }

  path(plan, close) {
    const context = this.box.context;
    context.beginPath();
    plan.forEach((point, index) => { const [x, y] = this.place(point); if (index) context.lineTo(x, y); else context.moveTo(x, y); });
    if (close) context.closePath();
  }

  draw(frame) {
    const clip = this.clip;
    if (!clip) return;
    this.frame = frame;
    this.box = canvasOf(this.canvas);
    const { context, width, height } = this.box;
    const spans = this.bounds.map(([low, high]) => Math.max(0.5, high - low));
    this.middle = this.bounds.map(([low, high]) => (low + high) / 2);
    const fits = Math.min(width / spans[0], height / spans[1], 420), moving = this.follow && fits < LEGIBLE;
    this.scale = (moving ? LEGIBLE : fits) * this.zoom;
    if (moving && !this.free) {
      // No further than the way's ends.
      const at = this.turned([value(clip, 'com_x', frame), value(clip, 'com_z', frame)]);
      this.middle = at.map((place, axis) => {
        const half = [width, height][axis] / 2 / this.scale, [low, high] = this.bounds[axis];
        return high - low <= 2 * half ? (low + high) / 2 : Math.min(high - half, Math.max(low + half, place));
      });
      this.held = this.middle;
    } else if (moving && this.held) this.middle = this.held;
    context.fillStyle = colours['stage-near'];
    context.fillRect(0, 0, width, height);
    this.ruler(context, width, height);
    const line = (name, colour) => {
      const places = [], step = Math.max(1, Math.floor(clip.samples / 2000));
      for (let sample = 0; sample < clip.samples; sample += step) places.push([raw(clip, name + '_x', sample) / 1000, raw(clip, name + '_z', sample) / 1000]);
      this.path(places);
      context.strokeStyle = colour;
      context.lineWidth = 1.5;
      context.stroke();
    };
    for (const print of clip.prints) {
      const now = print.start <= frame && frame <= print.end;
      this.path(outline(clip, print), true);
      context.globalAlpha = now ? 0.95 : 0.5;
      context.fillStyle = colours[print.foot];
      context.fill();
      context.globalAlpha = 1;
      if (now) { context.lineWidth = 2; context.strokeStyle = colours.ink; context.stroke(); }
    }
    line('xi', colours.xi);
    line('com', colours.com);
    const flagged = clip.flags.filter((flag) => flag.rule === 'foot-placement' && flag.waived === undefined);
    for (const step of clip.steps) {
      const print = printOf(clip, step);
      if (!print) continue;
      const bad = flagged.some((flag) => flag.foot === step.foot && flag.start <= step.touch_down && step.touch_down <= flag.end);
      context.strokeStyle = bad ? colours.flagged : colours[step.foot];
      context.lineWidth = bad ? 2.4 : 1.5;
      context.setLineDash([4, 3]);
      this.path(outline(clip, print, step.predicted), true);
      context.stroke();
      context.setLineDash([]);
      this.path([step.predicted, step.actual]);
      context.lineWidth = bad ? 3 : 1.5;
      context.stroke();
      if (bad && (this.scale > 100 || Math.abs(step.touch_down - frame) < clip.fps)) this.label(step);
    }
    disc(context, this.place([value(clip, 'xi_x', frame), value(clip, 'xi_z', frame)]), 5, colours.xi, colours.card);
    if (state(clip, 'pressed', frame) > 0) disc(context, this.place([value(clip, 'zmp_x', frame), value(clip, 'zmp_z', frame)]), 4.5, colours.zmp, colours.card);
    disc(context, this.place([value(clip, 'com_x', frame), value(clip, 'com_z', frame)]), 5.5, colours.com, colours.card);
  }

  label(step) {
    const { context } = this.box, at = this.place(step.predicted), from = this.place(step.actual);
    const [x, y] = [at[0], at[1] < from[1] ? at[1] - 8 : at[1] + 38];
    const text = centimetres(step.error_m);
    context.font = '600 12px system-ui, sans-serif';
    const wide = context.measureText(text).width;
    context.fillStyle = colours.flagged;
    context.beginPath();
    context.roundRect(x + 8, y - 22, wide + 10, 17, 4);
    context.fill();
    context.fillStyle = colours.card;
    context.fillText(text, x + 13, y - 9);
  }

  // Metres: lines, and a bar with its length.
  ruler(context, width, height) {
    const step = [0.1, 0.25, 0.5, 1, 2, 5, 10, 25, 50, 100].find((metres) => metres * this.scale > 52) ?? 250;
    context.strokeStyle = colours.grid;
    context.lineWidth = 1;
    const first = [0, 1].map((axis) => this.middle[axis] - (this.pan[axis] + [width, height][axis] / 2) / this.scale);
    context.beginPath();
    for (let u = Math.ceil(first[0] / step) * step; (u - first[0]) * this.scale < width; u += step) {
      const x = (u - first[0]) * this.scale;
      context.moveTo(x, 0); context.lineTo(x, height);
    }
    for (let v = Math.ceil(first[1] / step) * step; (v - first[1]) * this.scale < height; v += step) {
      const y = (v - first[1]) * this.scale;
      context.moveTo(0, y); context.lineTo(width, y);
    }
    context.stroke();
    context.fillStyle = colours.soft;
    context.fillRect(12, height - 14, step * this.scale, 3);
    context.font = '11px system-ui, sans-serif';
    context.fillText(step + ' m', 12, height - 19);
  }

  // A click leads to the step whose footprint is nearest.
  pick(x, y) {
    let best = null, nearest = 30;
    for (const print of this.clip.prints) {
      const place = this.place([print.x / 1000, print.z / 1000]), far = Math.hypot(place[0] - x, place[1] - y);
      if (far < nearest) [best, nearest] = [print, far];
    }
    if (best) this.seek(best.start);
  }
}
