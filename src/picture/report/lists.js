// The lists of the page: facts, flags, steps, notes, thumbnails, the index of clips. Text is only ever set as text.
function element(tag, attributes, ...children) {
  const made = document.createElement(tag);
  for (const [name, content] of Object.entries(attributes ?? {})) {
    if (name === 'style') Object.assign(made.style, content);
    else if (name.startsWith('on')) made.addEventListener(name.slice(2), content);
    else if (content !== undefined && content !== false) made.setAttribute(name, content);
  }
  made.append(...children.map((child) => (child instanceof Node ? child : String(child))));
  return made;
}

const byId = (id) => document.getElementById(id);
const swatch = (colour) => element('span', { class: 'swatch', style: { background: colour } });

// Rows of cells under a head: a cell is text, a node, or { number: text }.
function fill(table, head, rows) {
  const cell = (tag, content) => {
    const attributes = content?.number !== undefined ? { class: 'number narrow' } : content?.text !== undefined ? { class: 'text' } : { class: 'narrow' };
    return element(tag, attributes, content?.number ?? content?.text ?? content ?? '');
  };
  const body = element('tbody');
  for (const { cells, go, waived, id } of rows) {
    const line = element('tr', { class: [go && 'go', waived && 'waived'].filter(Boolean).join(' '), 'data-id': id, onclick: go ?? (() => {}) });
    line.append(...cells.map((content) => cell('td', content)));
    body.append(line);
  }
  table.replaceChildren(element('thead', {}, element('tr', {}, ...head.map((name) => cell('th', name)))), body);
}

function showHeader(clip) {
  byId('name').textContent = clip.name;
  document.title = clip.name + ' - Surefoot audit';
  const count = standing(clip).length, waived = clip.flags.length + clip.clipFlags.length - count;
  const unjudged = shareOf(clip, clip.abstained), silent = unjudged > 0.95;
  const verdict = byId('verdict');
  verdict.textContent = (count === 0 ? (silent ? 'not judged' : 'no flags') : count === 1 ? '1 flag' : count + ' flags') + (waived ? `, ${waived} waived` : '');
  verdict.className = 'verdict' + (count ? ' bad' : silent ? ' wait' : '');
  const fact = (name, content) => element('span', {}, name + ' ', element('b', {}, content));
  const errors = clip.steps.map((step) => step.error_m).sort((a, b) => a - b);
  const facts = [
    fact('', `${(clip.frames / clip.fps).toFixed(2)} s`), fact('', `${clip.frames} frames`), fact('at', `${+clip.fps.toFixed(3)} fps`),
    fact('flagged', `${(100 * flaggedShare(clip)).toFixed(1)} %`),
  ];
  if (unjudged) facts.push(fact('not judged', `${(100 * unjudged).toFixed(0)} %`));
  if (errors.length) facts.push(fact('step error', centimetres((errors[(errors.length - 1) >> 1] + errors[errors.length >> 1]) / 2)));
  facts.push(fact('unit', `${+clip.unit.toPrecision(4)} m`), fact('up', clip.up), fact('confidence', clip.confidence.toFixed(2)));
  byId('facts').replaceChildren(...facts);
}

function showFlags(clip, seek) {
  const severity = (flag) => {
    const bar = element('span', { class: 'bar', title: flag.severity.toFixed(2) }, element('i', { style: { width: `${Math.round(100 * flag.severity)}%` } }));
    return bar;
  };
  const why = (flag) => ({ text: flag.waived === undefined ? flag.why : `${flag.why}  (waived: ${flag.waived})` });
  const rule = (flag) => element('span', {}, swatch(colours[flag.rule]), flag.rule);
  const rows = clip.clipFlags.map((flag) => ({
    cells: [rule(flag), 'whole clip', '', '', '', severity(flag), why(flag)], waived: flag.waived !== undefined,
  }));
  for (const { flag, index } of worstFirst(clip)) {
    rows.push({
      cells: [rule(flag), `${flag.start}-${flag.end}`, `${(flag.start / clip.fps).toFixed(2)}-${seconds(clip, flag.end)}`, flag.foot ?? '',
        { number: centimetres(flag.delta_m) }, severity(flag), why(flag)],
      go: () => seek(tellingFrame(clip, flag)), waived: flag.waived !== undefined, id: index,
    });
  }
  const table = byId('flags');
  if (rows.length) fill(table, ['rule', 'frames', 'time', 'foot', { number: 'off by' }, 'severity', { text: 'why' }], rows);
  else table.replaceChildren(element('caption', { class: 'none' }, shareOf(clip, clip.abstained) > 0.95 ? 'Not judged: see below why.' : 'No flags: nothing that was judged contradicts a balanced person.'));
}

// The flags under the playhead stand out in the list.
function markFlags(clip, frame) {
  for (const line of byId('flags').querySelectorAll('tr[data-id]')) {
    const flag = clip.flags[+line.dataset.id];
    line.classList.toggle('here', flag.start <= frame && frame <= flag.end);
  }
  const now = clip.flags.filter((flag) => flag.start <= frame && frame <= flag.end);
  byId('now').replaceChildren(...now.map((flag) => {
    const words = [flag.rule, flag.foot, centimetres(flag.delta_m), flag.waived !== undefined && 'waived'].filter(Boolean).join(' \u00b7 ');
    return element('span', { class: flag.waived === undefined ? '' : 'quiet', style: { background: colours[flag.rule] } }, words);
  }));
}

function showSteps(clip, seek) {
  byId('steps-card').hidden = !clip.steps.length;
  byId('steps-hint').textContent = `${clip.steps.length} steps: where the pendulum puts each foot, and where it stands`;
  const signed = (metres) => ({ number: (metres >= 0 ? '+' : '\u2212') + Math.abs(100 * metres).toFixed(1) + ' cm' });
  const place = ([x, z]) => ({ number: `${x.toFixed(2)}, ${z.toFixed(2)}` });
  fill(byId('steps'), ['foot', { number: 'lift off' }, { number: 'touch down' }, { number: 'predicted x, z' }, { number: 'actual x, z' }, { number: 'error' }, { number: 'ahead' }, { number: 'out' }, { text: '' }],
    clip.steps.map((step) => ({
      cells: [element('span', {}, swatch(colours[step.foot]), step.foot), { number: step.lift_off }, { number: step.touch_down }, place(step.predicted), place(step.actual),
        { number: centimetres(step.error_m) }, signed(step.error_forward_m ?? 0), signed(step.error_sideways_m ?? 0), { text: '' }],
      go: () => seek(step.touch_down),
    })));
}

function showNotes(clip, seek) {
  // One line a reason, with a button a span.
  const reasons = [...new Set(clip.abstained.map((span) => span.why))];
  const notes = reasons.map((why) => {
    const spans = clip.abstained.filter((span) => span.why === why);
    const buttons = spans.slice(0, 60).map((span) => element('button', { class: 'small', onclick: () => seek(span.start) }, `${span.start}-${span.end}`));
    const more = spans.length - buttons.length;
    return element('li', {}, 'not judged, ' + why + ': frames ', ...buttons, more > 0 ? ` and ${more} spans more` : '');
  });
  notes.push(element('li', {}, `file ${clip.file}; bones found by ${clip.method}`));
  if (clip.stride > 1) notes.push(element('li', {}, `the clip is long: this page keeps every ${clip.stride}th frame of its motion and curves; flags, contacts and steps are exact`));
  notes.push(...clip.notes.map((note) => element('li', {}, note)));
  byId('notes').replaceChildren(...notes);
}

// Small pictures of the worst flags, seen from the flagged foot's side.
function showThumbs(clip, seek) {
  const worst = worstFirst(clip).filter(({ flag }) => flag.waived === undefined).slice(0, 10);
  byId('worst-card').hidden = !worst.length;
  byId('thumbs').replaceChildren(...worst.map(({ flag }) => {
    const frame = tellingFrame(clip, flag), canvas = element('canvas');
    const words = element('div', { style: { borderTopColor: colours[flag.rule] } },
      element('b', {}, [flag.rule, flag.foot].filter(Boolean).join(', ')), `frame ${frame}` + (flag.delta_m ? ` \u00b7 ${centimetres(flag.delta_m)}` : ''));
    const card = element('button', { class: 'thumb', onclick: () => seek(frame), title: flag.why }, canvas, words);
    requestAnimationFrame(() => drawThumb(canvas, clip, frame, flag));
    return card;
  }));
}

function drawThumb(canvas, clip, frame, flag) {
  const { context, width, height } = canvasOf(canvas);
  const side = flag.foot === 'right' ? -1 : 1;
  const camera = new Camera(facing(clip, frame) + side * 1.05, 0.2, 2.95 * clip.size);
  Object.assign(camera, { width, height, target: [value(clip, 'com_x', frame), middleOf(clip, frame), value(clip, 'com_z', frame)] });
  drawScene(context, camera, clip, frame, true, flag);
}

// Why most of a clip was not judged, in short.
function silence(clip) {
  if (shareOf(clip, clip.abstained) < 0.5) return '';
  const frames = new Map();
  for (const span of clip.abstained) frames.set(span.why, (frames.get(span.why) ?? 0) + span.end + 1 - span.start);
  const [[why]] = [...frames].sort((a, b) => b[1] - a[1]);
  return element('span', { class: 'silent', title: why }, 'not judged: ' + why.split(':')[0]);
}

function showIndex(current, open) {
  const several = clips.length > 1;
  byId('index-card').hidden = byId('picker').hidden = !several;
  if (!several) return;
  const bad = clips.filter((clip) => standing(clip).length).length;
  byId('index-hint').textContent = `${clips.length} clips, ${bad} with flags`;
  const rules = RULES.filter((rule) => clips.some((clip) => standing(clip).some((flag) => flag.rule === rule)));
  fill(byId('index'), [{ text: 'clip' }, { number: 'seconds' }, ...rules.map((rule) => ({ number: rule })), { number: 'flagged' }, { number: 'confidence' }, 'worst'],
    clips.map((clip, index) => {
      const flags = standing(clip), worst = worstFirst(clip).find(({ flag }) => flag.waived === undefined)?.flag;
      const count = (rule) => flags.filter((flag) => flag.rule === rule).length;
      return {
        cells: [{ text: clip.name }, { number: (clip.frames / clip.fps).toFixed(1) }, ...rules.map((rule) => ({ number: count(rule) || '\u00b7' })),
          { number: (100 * flaggedShare(clip)).toFixed(1) + ' %' }, { number: clip.confidence.toFixed(2) },
          worst ? element('span', {}, swatch(colours[worst.rule]), `${worst.rule} ${centimetres(worst.delta_m)}`) : flags.length ? element('span', { title: flags[0].why }, swatch(colours[flags[0].rule]), `${flags[0].rule}, whole clip`) : silence(clip)],
        go: () => open(index), id: index,
      };
    }));
  for (const line of byId('index').querySelectorAll('tr[data-id]')) line.classList.toggle('here', +line.dataset.id === current);
  const here = byId('index').querySelector('tr.here'), box = byId('index').parentElement;
  if (here && (here.offsetTop < box.scrollTop + 30 || here.offsetTop > box.scrollTop + box.clientHeight - 40)) box.scrollTop = here.offsetTop - box.clientHeight / 2;
  if (byId('clips').options.length !== clips.length) {
    byId('clips').replaceChildren(...clips.map((clip, index) => element('option', { value: index }, `${clip.name} (${standing(clip).length})`)));
  }
  byId('clips').value = String(current);
}

function showLegends() {
  const entry = (colour, words, kind) => element('span', {}, element('i', { class: kind ?? '', style: { background: colour, borderColor: colour } }), words);
  byId('stage-legend').replaceChildren(entry(colours.left, 'left'), entry(colours.right, 'right'), entry(colours.flagged, 'flagged'),
    entry(colours.com, 'centre of mass', 'dot'), entry(colours.xi, '\u03be, where it is heading', 'dot'), entry(colours.zmp, 'pressure (ZMP)', 'dot'));
  const parts = ['left', 'right'].flatMap((foot) => [entry(colours[foot + '-heel'], foot + ' heel'), entry(colours[foot], 'flat'), entry(colours[foot + '-ball'], 'ball')]);
  byId('time-legend').replaceChildren(...parts, ...(clips.some((clip) => clip.abstained.length) ? [entry(colours.faint, 'not judged, or waived')] : []));
  byId('top-legend').replaceChildren(entry(colours.left, 'left'), entry(colours.right, 'right'), entry(colours.soft, 'predicted', 'ring'),
    entry(colours.com, 'centre of mass'), entry(colours.xi, '\u03be'));
}
