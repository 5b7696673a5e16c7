/* track_main.js: puts the page of a tracking run together: the frame that is shown, the controls, the table of frames. */

const ROWS_MOST = 500;
const playing = { timer: 0 };

function viewText() { return `${rowText(rowOf(shown[state.frame]), shown[state.frame])}${state.showTarget ? ', target as points in blue' : ''}`; }

function rowText(row, number) { return `frame ${number + 1} of ${page.frames}${row.number === number ? `: ${row.name}` : ''}, ${digits(number / page.fps, 2)} s`; }

/* New positions of a mesh on the graphics card. */
function movePlaces(s, mesh) {
  const { gl } = view;
  gl.bindBuffer(gl.ARRAY_BUFFER, mesh.places);
  gl.bufferData(gl.ARRAY_BUFFER, s.place.after, gl.STATIC_DRAW);
  gl.bindBuffer(gl.ARRAY_BUFFER, mesh.normals);
  gl.bufferData(gl.ARRAY_BUFFER, normalsOf(s.place.after, s.index), gl.STATIC_DRAW);
}

/* The target's points: a cloud of another size in each frame. */
function moveTarget() {
  const { gl } = view, at = page.scene.targets[state.frame], target = targets[0];
  target.n = at.points;
  target.place = readPoints(at.at, at.points);
  if (!gl) return;
  for (const mesh of view.targets) {
    for (const buffer of [mesh.before, mesh.places, mesh.still, mesh.normals, mesh.values, mesh.index]) gl.deleteBuffer(buffer);
    gl.deleteVertexArray(mesh.array);
  }
  view.targets = [upload(gl, target.place, target.place, target.index, target.n)];
}

function showFrame(k) {
  state.frame = Math.max(0, Math.min(shown.length - 1, k));
  structures.forEach((s, i) => {
    s.place.after = readPoints(s.at[state.frame], s.n);
    s.values.moved.after = movedAt(s, s.place.after);
    if (view.gl) movePlaces(s, view.meshes[i]);
  });
  moveTarget();
  uploadValues();
  byId('frame').value = state.frame;
  byId('frame-value').textContent = rowText(rowOf(shown[state.frame]), shown[state.frame]);
  markFrame();
  if (state.colour !== 'structure') fillList();
  for (const row of byId('frame-table').querySelectorAll('tbody tr')) row.classList.toggle('chosen', Number(row.dataset.number) === shown[state.frame]);
  redraw('view');
}

function setPlaying(on) {
  if (playing.timer !== 0) clearInterval(playing.timer);
  const step = shown.length > 1 ? 1000 * (shown[shown.length - 1] - shown[0]) / (shown.length - 1) / page.fps : 1000;
  playing.timer = on ? setInterval(() => showFrame((state.frame + 1) % shown.length), Math.max(50, Math.min(1000, step))) : 0;
  byId('play').setAttribute('aria-pressed', String(on));
}

function choose(which) {
  state.chosen = state.chosen === which ? -1 : which;
  if (state.chosen >= 0) structures[which].visible = true;
  fillList();
  redraw('view');
}

function readVertex(which, vertex) {
  const s = structures[which], p = s.place.after.subarray(3 * vertex, 3 * vertex + 3);
  byId('reading').replaceChildren(element('strong', {}, s.name), ` at L ${digits(p[0], 1)}, P ${digits(p[1], 1)}, S ${digits(p[2], 1)} mm: ` +
    `${short(s.values.moved.after[vertex])} mm from its place in the first frame`);
}

function showVertex(which, vertex) {
  if (state.chosen !== which) choose(which);
  readVertex(which, vertex);
}

function clickView(x, y) {
  const hit = pick(x, y);
  if (!hit) return;
  showVertex(hit.structure, hit.vertex);
  state.pointed = true;
  state.point = hit.point;
}

function frameButton(row) {
  return element('button', { type: 'button', click: () => { showFrame(nearestShown(row.number)); byId('view').scrollIntoView(); } }, 'show');
}

function rowWords(row) {
  const words = [...row.reasons];
  if (row.jumped) words.push('the target jumped');
  if (!row.settled) words.push(`did not settle within ${row.ticks} ticks`);
  return words.join('; ');
}

function tellVerdict() {
  const level = page.verdict in VERDICTS ? page.verdict : 'look', { good, look, failed } = page.counts;
  byId('verdict-badge').classList.add(level);
  byId('verdict-sign').textContent = VERDICTS[level].sign;
  byId('verdict-word').textContent = VERDICTS[level].word;
  byId('verdict-text').textContent = `Of ${page.frames} frames ${good} are good, ${look} want a look, ${failed} failed. The page has the verdict of the worst.`;
  const order = ['failed', 'look', 'good'];
  const doubtful = rows.filter(isDoubtful).sort((a, b) => order.indexOf(a.verdict) - order.indexOf(b.verdict) || a.number - b.number);
  const most = rows.reduce((a, b) => ((b.residual_mm ?? -1) > (a.residual_mm ?? -1) ? b : a));
  const items = doubtful.slice(0, 8).map((row) => [element('strong', {}, row.name), `: ${rowWords(row)} `, frameButton(row)]);
  if (doubtful.length > 8) items.push([`and ${doubtful.length - 8} more, in the table of frames`]);
  items.push(['largest residual: ', element('strong', {}, most.name), `, ${digits(most.residual_mm)} mm `, frameButton(most)]);
  byId('look-list').append(...items.map((parts) => element('li', {}, ...parts)));
}

function tellFigures() {
  const known = rows.map((r) => r.residual_mm).filter((v) => v !== null), sum = known.reduce((a, b) => a + b, 0);
  const last = structures.map((s) => movedAt(s, readPoints(s.at[shown.length - 1], s.n))), moved = statistics(last);
  byId('figures').append(
    figure('frames', String(page.frames), '', `${digits(page.fps, 1)} a second`),
    figure('residual', digits(known.length > 0 ? sum / known.length : null), 'mm', `mean over frames; largest ${digits(known.length > 0 ? known.reduce((a, b) => Math.max(a, b)) : null)}`),
    figure('settled', `${page.counts.settled} of ${page.frames}`, '', 'frames'),
    figure('jumps', String(page.counts.jumped), '', 'frames in which the target jumped'),
    figure('moved', digits(moved ? moved.mean : null, 1), 'mm', `mean, first to last frame; largest ${digits(moved ? moved.max : null, 1)}`),
    figure('structures', String(structures.length), '', `${page.vertices} vertices`));
}

function tellHead() {
  const what = structures.length === 1 ? structures[0].name : `${structures.length} structures`;
  byId('page-title').textContent = `${what} through ${page.frames} frames`;
  document.title = `${(VERDICTS[page.verdict] || VERDICTS.look).word}: ${what} through ${page.frames} frames`;
  byId('page-line').textContent = `smr ${page.version} \u00b7 state ${page.state_hash}`;
  byId('footer').textContent = `Written by smr ${page.version}. Coordinates: LPS, millimetres. This file holds all that it shows and asks no network.`;
  const { scene } = page, thin = scene.cell_mm > 0 ? `, of vertices ${digits(scene.cell_mm)} mm apart` : '';
  byId('view-note').textContent = `${shown.length} of ${page.frames} frames are in the view${shown.length < page.frames ? ', evenly spread' : ''}${thin}. Of the target at most ${scene.target_points} points a frame are shown.`;
}

function fillFrames() {
  const only = byId('doubtful-only').checked, wanted = rows.filter((row) => !only || isDoubtful(row));
  const heads = ['frame', 'time, s', 'ticks', 'residual, mm', 'verdict', 'settled', 'jumped', 'reasons'].map((name, i) => element('th', { scope: 'col', class: i > 3 ? 'text' : '' }, name));
  byId('frame-table').replaceChildren(element('thead', {}, element('tr', {}, ...heads)), element('tbody', {}, ...wanted.slice(0, ROWS_MOST).map((row) =>
    element('tr', { 'data-number': row.number, class: row.number === shown[state.frame] ? 'chosen' : '', click: () => showFrame(nearestShown(row.number)) },
      element('td', {}, row.name), element('td', {}, digits(row.time_s, 3)), element('td', {}, String(row.ticks)), element('td', {}, digits(row.residual_mm, 3)),
      element('td', { class: 'text' }, verdictMark(row.verdict)), element('td', { class: 'text' }, row.settled ? 'yes' : 'no'),
      element('td', { class: 'text' }, row.jumped ? 'yes' : ''), element('td', { class: 'wrap' }, row.reasons.join('; '))))));
  const notes = [];
  if (rows.length < page.frames) notes.push(`${rows.length} rows stand for ${page.frames} frames, each for the worst of several`);
  if (wanted.length > ROWS_MOST) notes.push(`the first ${ROWS_MOST} of ${wanted.length} rows are shown`);
  byId('frames-note').textContent = notes.length > 0 ? `${notes.join('; ')}. All frames are in track.csv.` : '';
}

function tellTables() {
  tellHead();
  tellVerdict();
  tellFigures();
  drawCurves();
  fillFrames();
  fillSettings();
  fillInputs();
  byId('inputs-note').textContent = page.inputs_left_out ? `${page.inputs_left_out} files were read, too many to list.` : '';
  byId('changed-only').addEventListener('change', fillSettings);
  byId('doubtful-only').addEventListener('change', fillFrames);
}

function startFrames() {
  byId('frame').max = shown.length - 1;
  byId('frame').addEventListener('input', () => { setPlaying(false); showFrame(Number(byId('frame').value)); });
  byId('play').addEventListener('click', () => setPlaying(playing.timer === 0));
  byId('show-target').addEventListener('change', () => { state.showTarget = byId('show-target').checked; redraw('view'); });
  document.addEventListener('keydown', (event) => {
    const typing = event.target instanceof Element && event.target.closest('input:not([type="range"]):not([type="checkbox"]), select, #gl');
    const key = event.key.toLowerCase();
    if (event.ctrlKey || event.altKey || event.metaKey || (typing && !(typing.id === 'gl' && key !== 'l'))) return;
    if (key === 'j' || key === 'l') { setPlaying(false); showFrame(state.frame + (key === 'l' ? 1 : -1)); }
    if (key === 'k') setPlaying(playing.timer === 0);
  });
  showFrame(shown.length - 1);
}

function startControls() {
  for (const [key, { name }] of Object.entries(COLOURS)) byId('colour').append(element('option', { value: key }, name));
  byId('colour').addEventListener('change', () => setColour(byId('colour').value));
  startLegend();
  startPresets();
  byId('all-on').addEventListener('click', () => setAllVisible(() => true));
  byId('all-off').addEventListener('click', () => setAllVisible(() => false));
  byId('only').addEventListener('click', () => setAllVisible((i) => state.chosen < 0 || i === state.chosen));
  listenToPointers(byId('gl'), clickView);
  listenToKeys(byId('gl'));
  window.addEventListener('resize', () => redraw('view'));
  window.addEventListener('beforeprint', drawView);
}

/* Each part stands for itself: what fails says so, and the others go on. */
function start() {
  for (const part of [tellTables, startView, startControls, startTheme, startFrames, () => setColour('structure')]) {
    try { part(); } catch (error) { fail(error); }
  }
  drawWaiting();
}

document.addEventListener('DOMContentLoaded', start);
