// Flags, contacts and curves over one axis of time, with the playhead. Frames in, CSS pixels out.
const GUTTER = 148, RIGHT = 10;
const LANES = [
  { name: 'Margin of stability', curves: [['margin', 'xi']], least: 0.12, unit: 'cm', times: 100, needs: 'supported', zero: true, height: 62 },
  { name: 'Speed', curves: [['speed', 'accent']], least: 0.5, unit: 'm/s', times: 1, zero: true, height: 52 },
  { name: 'Centre of mass', curves: [['com_y', 'ink']], least: 0.12, unit: 'm', times: 1, height: 52 },
  { name: 'Sole heights', curves: [['sole_left', 'left'], ['sole_right', 'right']], least: 0.08, unit: 'cm', times: 100, zero: true, height: 62 },
];

class Timeline {
  constructor(canvas, seek) {
    Object.assign(this, { canvas, seek, from: 0, to: 1 });
    let held = false;
    const at = (event) => this.seek(this.frameAt(event.offsetX));
    canvas.addEventListener('pointerdown', (event) => { held = true; canvas.setPointerCapture(event.pointerId); at(event); });
    canvas.addEventListener('pointermove', (event) => { if (held) at(event); });
    canvas.addEventListener('pointerup', () => { held = false; });
    canvas.addEventListener('dblclick', () => this.window(0, this.clip.last));
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const frame = this.frameAt(event.offsetX), by = Math.exp(event.deltaY * 0.0015);
      const sideways = event.deltaX * (this.to - this.from) / this.wide;
      this.window(frame - (frame - this.from) * by + sideways, frame + (this.to - frame) * by + sideways);
    }, { passive: false });
  }

  show(clip) {
    this.clip = clip;
    this.rules = RULES.filter((rule) => clip.flags.some((flag) => flag.rule === rule));
    this.lanes = [{ kind: 'ruler', height: 24 }];
    for (const rule of this.rules) this.lanes.push({ kind: 'flags', rule, height: 20 });
    if (clip.abstained.length) this.lanes.push({ kind: 'abstained', height: 16 });
    this.lanes.push({ kind: 'contacts', foot: 'left', height: 22 }, { kind: 'contacts', foot: 'right', height: 22 });
    for (const lane of LANES) this.lanes.push({ kind: 'curve', ...lane, range: this.range(lane) });
    let top = 0;
    for (const lane of this.lanes) { lane.top = top; top += lane.height + (lane.kind === 'curve' ? 8 : 4); }
    this.tall = top;
    this.canvas.style.height = top + 'px';
    this.window(0, clip.last, true);
  }

  window(from, to, quiet) {
    const last = Math.max(1, this.clip.last), span = Math.min(last, Math.max(8, to - from));
    const start = Math.min(Math.max(0, from), last - span);
    Object.assign(this, { from: start, to: start + span, layer: null });
    if (!quiet) this.draw(this.frame);
  }

  range(lane) {
    let low = lane.zero ? 0 : Infinity, high = lane.zero ? 0 : -Infinity;
    const clip = this.clip, values = [];
    for (let sample = 0; sample < clip.samples; sample++) {
      if (lane.needs && raw(clip, lane.needs, sample) < 1) continue;
      for (const [name] of lane.curves) values.push(raw(clip, name, sample) / 1000);
    }
    values.sort((a, b) => a - b);
    // A stray value shall not press the rest flat.
    if (values.length) {
      low = Math.min(low, values[Math.floor(values.length * 0.003)]);
      high = Math.max(high, values[Math.ceil(values.length * 0.997) - 1]);
    }
    if (!(high > low)) [low, high] = [Number.isFinite(low) ? low - 0.01 : 0, Number.isFinite(low) ? low + 0.01 : 1];
    if (high - low < lane.least) [low, high] = lane.zero ? [low - lane.least * 0.2, high + lane.least * 0.8] : [low - lane.least / 2, high + lane.least / 2];
    const room = Math.max((high - low) * 0.08, 0.002);
    return [low - room, high + room];
  }

  get wide() { return Math.max(1, this.canvas.clientWidth - GUTTER - RIGHT); }
  x(frame) { return GUTTER + (frame - this.from) / Math.max(1e-9, this.to - this.from) * this.wide; }
  frameAt(x) { return Math.round(Math.min(this.clip.last, Math.max(0, this.from + (x - GUTTER) / this.wide * (this.to - this.from)))); }

  draw(frame) {
    if (!this.clip) return;
    this.frame = frame;
    const { context, width } = canvasOf(this.canvas, this.tall);
    if (!this.layer || this.layer.width !== this.canvas.width || this.layer.height !== this.canvas.height) this.paint(width);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.drawImage(this.layer, 0, 0);
    const ratio = window.devicePixelRatio || 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.values(context, frame);
    const x = this.x(frame);
    if (x < GUTTER - 1 || x > width - RIGHT + 1) return;
    context.fillStyle = colours.accent;
    context.fillRect(x - 0.75, 14, 1.5, this.tall - 14);
    context.beginPath();
    context.moveTo(x - 6, 6); context.lineTo(x + 6, 6); context.lineTo(x, 16);
    context.fill();
  }

  // What stands still: all but playhead and numbers.
  paint(width) {
    this.layer = document.createElement('canvas');
    [this.layer.width, this.layer.height] = [this.canvas.width, this.canvas.height];
    const context = this.layer.getContext('2d'), ratio = window.devicePixelRatio || 1, clip = this.clip;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = '12px system-ui, sans-serif';
    context.textBaseline = 'middle';
    for (const lane of this.lanes) {
      context.fillStyle = colours.soft;
      const names = { ruler: '', flags: lane.rule, abstained: 'not judged', contacts: lane.foot + ' foot', curve: lane.name };
      context.fillText(names[lane.kind], 0, lane.kind === 'curve' ? lane.top + 9 : lane.top + lane.height / 2);
    }
    context.save();
    context.beginPath();
    context.rect(GUTTER, 0, width - GUTTER - RIGHT, this.tall);
    context.clip();
    for (const lane of this.lanes) {
      if (lane.kind !== 'ruler') {
        context.fillStyle = colours['stage-near'];
        context.fillRect(GUTTER, lane.top, width, lane.height);
      }
      if (lane.kind === 'ruler') this.ruler(context, lane);
      if (lane.kind === 'curve') this.curve(context, lane);
      if (lane.kind === 'flags') {
        for (const flag of clip.flags.filter((flag) => flag.rule === lane.rule)) {
          this.span(context, lane, flag.start, flag.end, flag.waived === undefined ? colours[lane.rule] : colours.faint, flag.waived === undefined ? 1 : 0.4);
        }
      }
      if (lane.kind === 'abstained') for (const span of clip.abstained) this.span(context, lane, span.start, span.end, colours.faint, 0.45);
      if (lane.kind === 'contacts') {
        for (const contact of clip.contacts.filter((contact) => contact.foot === lane.foot)) {
          const colour = contact.part === 'flat' ? lane.foot : lane.foot + '-' + contact.part;
          this.span(context, lane, contact.start, contact.end, colours[colour] ?? colours[lane.foot], 1);
        }
      }
    }
    context.restore();
  }

  // Frames from first to last, both whole, at least three pixels wide.
  span(context, lane, start, end, colour, alpha) {
    const left = this.x(start - 0.5), right = Math.max(this.x(end + 0.5), left + 3);
    context.globalAlpha = alpha;
    context.fillStyle = colour;
    context.beginPath();
    context.roundRect(left, lane.top + 2, right - left, lane.height - 4, Math.min(3, (right - left) / 3));
    context.fill();
    context.globalAlpha = 1;
  }

  ruler(context, lane) {
    const shown = (this.to - this.from) / this.clip.fps;
    const step = [0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600].find((secs) => secs / shown * this.wide > 70) ?? 1200;
    context.strokeStyle = colours.grid;
    context.fillStyle = colours.faint;
    for (let time = Math.ceil(this.from / this.clip.fps / step) * step; time * this.clip.fps <= this.to + 1e-6; time += step) {
      const x = this.x(time * this.clip.fps);
      context.beginPath();
      context.moveTo(x, lane.top + 18); context.lineTo(x, lane.top + 24);
      context.stroke();
      context.fillText(`${+time.toFixed(2)} s`, x + 3, lane.top + 11);
    }
  }

  curve(context, lane) {
    const clip = this.clip, [low, high] = lane.range;
    const y = (metres) => lane.top + lane.height - (metres - low) / (high - low) * lane.height;
    for (const flag of clip.flags.filter((flag) => flag.waived === undefined)) {
      context.globalAlpha = 0.13;
      context.fillStyle = colours[flag.rule];
      const left = this.x(flag.start - 0.5);
      context.fillRect(left, lane.top, Math.max(2, this.x(flag.end + 0.5) - left), lane.height);
    }
    context.globalAlpha = 1;
    if (low < 0 && high > 0) {
      context.strokeStyle = colours['grid-strong'];
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(GUTTER, y(0)); context.lineTo(GUTTER + this.wide, y(0));
      context.stroke();
    }
    const first = Math.max(0, Math.floor(this.from / clip.stride) - 1), last = Math.min(clip.samples - 1, Math.ceil(this.to / clip.stride) + 1);
    const each = Math.max(1, Math.floor((last - first) / this.wide / 2));
    context.save();
    context.beginPath();
    context.rect(GUTTER, lane.top, this.wide, lane.height);
    context.clip();
    for (const [name, colour] of lane.curves) {
      context.strokeStyle = colours[colour];
      context.lineWidth = 1.6;
      context.lineJoin = 'round';
      context.beginPath();
      let pen = false;
      for (let sample = first; sample <= last; sample += each) {
        if (lane.needs && raw(clip, lane.needs, sample) < 1) { pen = false; continue; }
        const point = [this.x(sample * clip.stride), y(raw(clip, name, sample) / 1000)];
        if (pen) context.lineTo(point[0], point[1]); else context.moveTo(point[0], point[1]);
        pen = true;
      }
      context.stroke();
    }
    context.restore();
  }

  // Numbers at the playhead, beside the names of the lanes.
  values(context, frame) {
    const clip = this.clip;
    context.textBaseline = 'middle';
    context.font = '600 12px system-ui, sans-serif';
    for (const lane of this.lanes) {
      if (lane.kind === 'contacts') {
        const part = state(clip, 'part_' + lane.foot, frame);
        context.fillStyle = part < 0 ? colours.faint : colours[lane.foot];
        context.textAlign = 'right';
        context.fillText(part < 0 ? 'in the air' : PARTS[part], GUTTER - 10, lane.top + lane.height / 2);
      }
      if (lane.kind !== 'curve') continue;
      context.textAlign = 'left';
      lane.curves.forEach(([name, colour], index) => {
        const none = lane.needs && state(clip, lane.needs, frame) < 1;
        context.fillStyle = none ? colours.faint : colours[colour];
        const number = (value(clip, name, frame) * lane.times).toFixed(lane.times > 1 ? 1 : 2);
        context.fillText(none ? 'no support' : `${number} ${lane.unit}`, index * 66, lane.top + 27);
      });
    }
    context.textAlign = 'left';
  }
}
