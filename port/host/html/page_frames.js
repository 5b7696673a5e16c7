/* page_frames.js: the frames of a tracking run: the one that is shown, the verdict, figures and the table. */

const ROWS_MOST = 500;
const playing = { timer: 0 };

function frameText(number) {
  const row = rowOf(number);
  return `frame ${number + 1} of ${page.n_frames}${row.number === number ? `: ${row.name}` : ''}, ${digits(number / page.fps, 2)} s`;
}

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
  const { gl } = view, target = targets[0], clouds = frames[state.frame].target.map(readPoints);
  target.place = Float32Array.from(clouds.flatMap((cloud) => [...cloud]));
  target.n = target.place.length / 3;
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
    s.place.after = readPoints(frames[state.frame].places[i]);
    s.values.moved.after = movedFrom(s.place.before, s.place.after);
    if (view.gl) movePlaces(s, view.meshes[i]);
  });
  moveTarget();
  uploadValues();
  byId('frame').value = state.frame;
  byId('frame-value').textContent = frameText(shown[state.frame]);
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

function frameButton(row) {
  return element('button', { type: 'button', click: () => { showFrame(nearestShown(row.number)); byId('view').scrollIntoView(); } }, 'show');
}

function rowWords(row) {
  const words = [...row.reasons];
  if (row.jumped) words.push('the target jumped');
  if (!row.settled) words.push(`did not settle within ${row.ticks} ticks`);
  return words.join('; ');
}

function runItems() {
  const order = ['failed', 'look', 'good'], doubtful = rows.filter(isDoubtful).sort((a, b) => order.indexOf(a.verdict) - order.indexOf(b.verdict) || a.number - b.number);
  const most = rows.reduce((a, b) => ((b.residual_mm ?? -1) > (a.residual_mm ?? -1) ? b : a));
  const items = doubtful.slice(0, 8).map((row) => [element('strong', {}, row.name), `: ${rowWords(row)} `, frameButton(row)]);
  if (doubtful.length > 8) items.push([`and ${doubtful.length - 8} more, in the table of frames`]);
  return [...items, ['largest residual: ', element('strong', {}, most.name), `, ${digits(most.residual_mm)} mm `, frameButton(most)]];
}

function runFigures() {
  const known = rows.map((r) => r.residual_mm).filter((v) => v !== null), sum = known.reduce((a, b) => a + b, 0);
  const last = structures.map((s, i) => movedFrom(s.place.before, readPoints(frames[frames.length - 1].places[i]))), moved = statistics(last);
  return [
    figure('frames', String(page.n_frames), '', `${digits(page.fps, 1)} a second`),
    figure('residual', digits(known.length > 0 ? sum / known.length : null), 'mm', `mean over frames; largest ${digits(known.length > 0 ? known.reduce((a, b) => Math.max(a, b)) : null)}`),
    figure('settled', `${page.counts.settled} of ${page.n_frames}`, '', 'frames'),
    figure('jumps', String(page.counts.jumped), '', 'frames in which the target jumped'),
    figure('moved', digits(moved ? moved.mean : null, 1), 'mm', `mean, first to last frame; largest ${digits(moved ? moved.max : null, 1)}`),
    figure('structures', String(structures.length), '', `${structures.reduce((n, s) => n + s.n, 0)} vertices`),
  ];
}

function tellRun() {
  const { good, look, failed } = page.counts, thin = page.cell_mm > 0 ? `, of vertices ${digits(page.cell_mm)} mm apart` : '';
  tellHead(`${namesOf()} through ${page.n_frames} frames`, page.verdict, `smr ${report.version} \u00b7 state ${report.state_hash}`);
  tellVerdict(page.verdict, `Of ${page.n_frames} frames ${good} are good, ${look} want a look, ${failed} failed. The page has the verdict of the worst.`, runItems(), runFigures());
  byId('view-note').textContent = `${shown.length} of ${page.n_frames} frames are in the view${shown.length < page.n_frames ? ', evenly spread' : ''}${thin}. Of the target at most ${page.target_points} points a frame are shown.`;
  byId('inputs-note').textContent = report.inputs_left_out ? `${report.inputs_left_out} files were read, too many to list.` : '';
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
  if (rows.length < page.n_frames) notes.push(`${rows.length} rows stand for ${page.n_frames} frames, each for the worst of several`);
  if (wanted.length > ROWS_MOST) notes.push(`the first ${ROWS_MOST} of ${wanted.length} rows are shown`);
  byId('frames-note').textContent = notes.length > 0 ? `${notes.join('; ')}. All frames are in track.csv.` : '';
}

/* In the view, L looks from the left. */
function pressFrameKey(key, inView) {
  if (key === 'j' || (key === 'l' && !inView)) { setPlaying(false); showFrame(state.frame + (key === 'l' ? 1 : -1)); }
  if (key === 'k') setPlaying(playing.timer === 0);
}

function startFrames() {
  byId('frame').max = shown.length - 1;
  byId('frame').addEventListener('input', () => { setPlaying(false); showFrame(Number(byId('frame').value)); });
  byId('play').addEventListener('click', () => setPlaying(playing.timer === 0));
  showFrame(shown.length - 1);
}
