// Ties the views to one playhead: what is open, where it stands, what moves it.
let clip = null, opened_index = 0, frame = 0, playing = false, last_tick = 0;
const camera = new Camera(0, 0.18, 4);
const stage = byId('stage');
const topView = new TopView(byId('top'), seek);
const timeline = new Timeline(byId('timeline'), seek);

function open(index) {
  if (!clips.length) return;
  opened_index = index;
  clip = opened(clips[index]);
  frame = 0;
  play(false);
  showHeader(clip);
  showAll();
  topView.show(clip);
  timeline.show(clip);
  byId('scrub').max = clip.last;
  look('start');
  const worst = worstFirst(clip).find(({ flag }) => flag.waived === undefined);
  seek(worst ? tellingFrame(clip, worst.flag) : 0);
}

// What depends on the colours too.
function showAll() {
  showIndex(opened_index, open);
  showLegends();
  showFlags(clip, seek);
  showSteps(clip, seek);
  showNotes(clip, seek);
  showThumbs(clip, seek);
}

function look(view) {
  const way = [value(clip, 'com_x', clip.last) - value(clip, 'com_x', 0), value(clip, 'com_z', clip.last) - value(clip, 'com_z', 0)];
  const ahead = view === 'start' && Math.hypot(way[0], way[1]) > 0.7 ? Math.atan2(way[0], way[1]) : facing(clip, frame);
  const [yaw, pitch] = { start: [ahead + 0.95, 0.2], front: [ahead, 0.08], side: [ahead + Math.PI / 2, 0.08], back: [ahead + Math.PI, 0.08], top: [ahead + Math.PI, 1.5] }[view];
  Object.assign(camera, { yaw, pitch, distance: 3.3 * clip.size });
  draw();
}

function seek(to) {
  frame = Math.min(clip.last, Math.max(0, to));
  draw();
}

function draw() {
  if (!clip) return;
  const { context, width, height } = canvasOf(stage);
  Object.assign(camera, { width, height, target: [value(clip, 'com_x', frame), middleOf(clip, frame), value(clip, 'com_z', frame)] });
  drawScene(context, camera, clip, frame, false);
  topView.draw(frame);
  timeline.draw(frame);
  const whole = Math.round(frame);
  byId('scrub').value = whole;
  byId('clock').replaceChildren('frame ', element('b', {}, whole), ` of ${clip.last}  \u00b7  `, element('b', {}, seconds(clip, frame)));
  markFlags(clip, whole);
}

function play(on) {
  playing = on;
  byId('play').textContent = on ? 'Pause' : 'Play';
  if (!on) return;
  if (frame >= clip.last) frame = 0;
  last_tick = performance.now();
  requestAnimationFrame(tick);
}

function tick(now) {
  if (!playing) return;
  const passed = Math.min(0.1, (now - last_tick) / 1000) * Number(byId('speed').value);
  last_tick = now;
  seek(frame + passed * clip.fps);
  if (frame >= clip.last) play(false);
  else requestAnimationFrame(tick);
}

function step(by) {
  play(false);
  seek(Math.round(frame) + by);
}

// The next standing flag in time, or the one before.
function toFlag(direction) {
  play(false);
  const frames = clip.flags.filter((flag) => flag.waived === undefined).map((flag) => tellingFrame(clip, flag)).sort((a, b) => a - b);
  const here = Math.round(frame);
  const next = direction > 0 ? frames.find((at) => at > here) : frames.filter((at) => at < here).pop();
  if (next !== undefined) seek(next);
  else if (frames.length) seek(direction > 0 ? frames[0] : frames[frames.length - 1]);
}

function wire() {
  byId('play').onclick = () => play(!playing);
  byId('back').onclick = () => step(-1);
  byId('on').onclick = () => step(1);
  byId('previous-flag').onclick = () => toFlag(-1);
  byId('next-flag').onclick = () => toFlag(1);
  byId('scrub').oninput = (event) => { play(false); seek(Number(event.target.value)); };
  byId('top-follow').onclick = () => topView.whole(false);
  byId('top-all').onclick = () => topView.whole(true);
  byId('clips').onchange = (event) => open(Number(event.target.value));
  for (const button of document.querySelectorAll('[data-view]')) button.onclick = () => look(button.dataset.view);
  window.addEventListener('keydown', (event) => {
    if (!clip || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.matches?.('select, input[type=text], summary')) return;
    const many = event.shiftKey ? 10 : 1;
    const does = {
      ' ': () => play(!playing), ArrowRight: () => step(many), ArrowLeft: () => step(-many), '[': () => toFlag(-1), ']': () => toFlag(1),
      Home: () => step(-clip.frames), End: () => step(clip.frames),
    }[event.key];
    if (!does) return;
    event.preventDefault();
    does();
  });
  // A focused button would take the space for itself.
  window.addEventListener('keyup', (event) => { if (event.key === ' ' && event.target.matches?.('button')) event.preventDefault(); });
  let held = null;
  stage.addEventListener('pointerdown', (event) => { held = [event.clientX, event.clientY]; stage.setPointerCapture(event.pointerId); });
  stage.addEventListener('pointerup', () => { held = null; });
  stage.addEventListener('pointermove', (event) => {
    if (!held) return;
    camera.yaw -= (event.clientX - held[0]) * 0.008;
    camera.pitch = Math.min(1.52, Math.max(-0.1, camera.pitch + (event.clientY - held[1]) * 0.006));
    held = [event.clientX, event.clientY];
    draw();
  });
  stage.addEventListener('wheel', (event) => {
    event.preventDefault();
    camera.distance = Math.min(30 * clip.size, Math.max(0.6 * clip.size, camera.distance * Math.exp(event.deltaY * 0.001)));
    draw();
  }, { passive: false });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { readColours(); timeline.layer = null; showAll(); draw(); });
  new ResizeObserver(() => { timeline.layer = null; draw(); }).observe(document.body);
}

readColours();
wire();
// The clip with the worst flag; the first where there is none.
const worst_of = (clip) => Math.max(0, ...standing(clip).map((flag) => flag.severity));
open(clips.reduce((best, clip, index) => (worst_of(clip) > worst_of(clips[best]) ? index : best), 0));
// For whoever drives the page by a program.
window.surefoot = { clips, seek, open, get frame() { return frame; }, get playing() { return playing; } };
