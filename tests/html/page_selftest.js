/* page_selftest.js: tests of a page, run within it: check_html.sh appends this file to a copy of the page. */

const selftest = { errors: [], lines: [], failed: 0 };
window.addEventListener('error', (event) => selftest.errors.push(event.message));
window.addEventListener('unhandledrejection', (event) => selftest.errors.push(String(event.reason)));

function expect(name, good) {
  selftest.lines.push(`${good ? 'ok' : 'not ok'} ${name}`);
  selftest.failed += good ? 0 : 1;
}

/* All pixels of the 3D view, as they are after drawing. */
function viewPixels() {
  drawView();
  const gl = view.gl, pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return pixels;
}

function slicePixels(slice) {
  drawSlice(slice);
  return slice.canvas.getContext('2d').getImageData(0, 0, slice.canvas.width, slice.canvas.height).data;
}

/* How many pixels differ by more than a little. */
function different(a, b) {
  let n = a.length === b.length ? 0 : Infinity;
  for (let i = 0; i < a.length; i += 4) {
    if (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) > 12) n++;
  }
  return n;
}

function press(target, key, shiftKey = false) {
  target.dispatchEvent(new KeyboardEvent('keydown', { key, shiftKey, bubbles: true, cancelable: true }));
}

function change(control, value) {
  if (control.type === 'checkbox' || control.type === 'radio') control.checked = value;
  else control.value = value;
  control.dispatchEvent(new Event('input', { bubbles: true }));
  control.dispatchEvent(new Event('change', { bubbles: true }));
}

/* Does something, looks whether the view changed, undoes it and looks whether it is as before. */
function changesView(name, act, undo) {
  const before = viewPixels();
  act();
  const then = viewPixels();
  expect(`${name} changes the view`, different(before, then) > 20);
  undo();
  expect(`${name}: and back`, different(before, viewPixels()) === 0);
}

function testMoves() {
  const canvas = byId('gl');
  changesView('an arrow', () => press(canvas, 'ArrowRight'), () => press(canvas, 'ArrowLeft'));
  changesView('Shift and an arrow', () => press(canvas, 'ArrowUp', true), () => press(canvas, '0'));
  changesView('plus', () => press(canvas, '+'), () => press(canvas, '0'));
  for (const letter of ['P', 'L', 'S']) changesView(`looking from ${letter}`, () => press(canvas, letter), () => press(canvas, 'A'));
  const drag = (from, to, type, id) => {
    const send = (name, [x, y]) => canvas.dispatchEvent(new PointerEvent(name, { pointerId: id, pointerType: type, clientX: x, clientY: y, buttons: 1, bubbles: true }));
    send('pointerdown', from);
    send('pointermove', to);
    send('pointerup', to);
  };
  changesView('a drag', () => drag([200, 200], [260, 230], 'mouse', 1), () => press(canvas, 'A'));
  changesView('a finger', () => drag([200, 200], [150, 200], 'touch', 7), () => press(canvas, 'A'));
  changesView('the wheel', () => canvas.dispatchEvent(new WheelEvent('wheel', { deltaY: 240, cancelable: true })), () => press(canvas, '0'));
}

function testColours() {
  const seen = [];
  for (const option of byId('colour').options) {
    change(byId('colour'), option.value);
    const pixels = viewPixels();
    expect(`colour: ${option.value} differs`, seen.every((other) => different(other, pixels) > 100));
    seen.push(pixels);
    expect(`colour: ${option.value} has its legend`, byId('legend').hidden === (option.value === 'structure'));
  }
  if (byId('colour').options.length > 1) {
    const most = byId('legend-max').value;
    changesView('the end of the colours', () => change(byId('legend-max'), String(0.2 * Number(most))), () => change(byId('legend-max'), most));
  }
  change(byId('colour'), 'structure');
}

function testView() {
  expect('WebGL2', view.gl !== null && view.gl.getError() === 0);
  if (view.gl === null) return;
  byId('all-off').click();
  const empty = viewPixels();
  byId('all-on').click();
  expect('the model is drawn', different(empty, viewPixels()) > 500);
  structures.forEach((s, i) => {
    if (structures.length > 8 && i % 6 !== 0) return;
    setAllVisible((k) => k === i);
    expect(`structure ${i + 1} alone is drawn`, different(empty, viewPixels()) > 10);
  });
  setAllVisible(() => true);
  const box = () => byId('structure-list').querySelector('input');
  lookFrom('A');
  if (structures.length === 1) changesView('a structure switched off', () => change(box(), false), () => change(box(), true));
  changesView('before', () => change(document.querySelector('#when input[value="before"]'), true), () => change(document.querySelector('#when input[value="after"]'), true));
  changesView('half way', () => change(byId('blend'), '0.5'), () => change(byId('blend'), '1'));
  if (targets.length > 0) changesView('the target', () => change(byId('show-target'), true), () => change(byId('show-target'), false));
  testMoves();
  testColours();
  testPicking();
  expect('no error of WebGL', view.gl.getError() === 0);
}

function testPicking() {
  const canvas = byId('gl');
  let hit = null;
  for (let y = 0.1; y < 0.95 && !hit; y += 0.05) for (let x = 0.1; x < 0.95 && !hit; x += 0.05) hit = pick(x * canvas.clientWidth, y * canvas.clientHeight);
  expect('a click finds a surface', hit !== null);
  if (!hit) return;
  const s = structures[hit.structure], at = 3 * hit.vertex;
  expect('near the vertex that it reads', Math.hypot(...hit.point.map((v, c) => v - s.place.after[at + c])) < 0.2 * sceneRadius);
  showVertex(hit.structure, hit.vertex);
  expect('and names it', byId('reading').textContent.startsWith(s.name));
  const pressed = [...byId('structure-list').querySelectorAll('button')].map((button) => button.getAttribute('aria-pressed'));
  expect('the list says which one is chosen', state.chosen === hit.structure && pressed.every((is, i) => is === String(i === state.chosen)));
  choose(hit.structure);
  state.pointed = false;
}

function testSlices() {
  for (const slice of slices) {
    const name = slice.along ? 'along' : slice.plane.title, at = slice.slider.value, before = slicePixels(slice);
    expect(`${name}: something is drawn`, new Set(before).size > 8);
    press(slice.canvas, 'PageUp');
    expect(`${name}: a key moves it`, different(before, slicePixels(slice)) > 20);
    change(slice.slider, at);
    expect(`${name}: the slider moves it back`, different(before, slicePixels(slice)) === 0);
  }
  const first = slices[0], whole = slicePixels(first);
  for (const kind of Object.keys(OUTLINES)) {
    const box = byId(`outline-${kind}`);
    if (!box || !slices.some((s) => hasOutline(s, kind))) continue;
    const slice = slices.find((s) => hasOutline(s, kind)), with_ = slicePixels(slice);
    change(box, false);
    expect(`outlines of ${kind} can be switched off`, different(with_, slicePixels(slice)) > 5);
    change(box, true);
  }
  if (image) {
    const window = byId('window').value;
    change(byId('window'), String(0.3 * Number(window)));
    expect('the window changes the greys', different(whole, slicePixels(first)) > 100);
    byId('window-reset').click();
    expect('and is reset', different(whole, slicePixels(first)) === 0);
  }
  byId('blink').click();
  setBlend(0);
  const dark = slicePixels(first);
  setBlend(1);
  expect('blinking changes slices', different(dark, slicePixels(first)) > 5 || !hasOutline(first, 'after'));
  byId('blink').click();
  expect('and ends', blinking.timer === 0 && state.blend === 1);
}

function hasOutline(slice, kind) {
  const cut = (xyz, index) => cutSurface(xyz, index, slice.plane, slice.at).length > 0;
  return kind === 'target' ? targets.some((t) => cut(t.place, t.index)) : structures.some((s) => cut(s.place[kind], s.index));
}

/* Colours of slices are where the image is: each main plane through the middle of a voxel shows that voxel's grey. */
function testSampling() {
  if (!image) return;
  const at = image.size.map((n) => n >> 1), point = frameAxes().reduce((p, axis, j) => along(p, axis, at[j] * image.spacing[j]), image.first);
  const want = image.voxels[(at[2] * image.size[1] + at[1]) * image.size[0] + at[0]];
  for (const { plane } of slices.filter((s) => !s.along)) {
    const mm = 0.5, depth = dot(point, plane.normal), got = sampleImage(plane, depth, mm);
    const x = Math.round((dot(point, plane.right) - plane.rangeRight[0]) / mm - 0.5), y = Math.round((dot(point, plane.down) - plane.rangeDown[0]) / mm - 0.5);
    expect(`${plane.title}: the voxel in the middle is where it should be`, Math.abs(got.grey[y * got.width + x] - want) <= 40);
  }
}

/* As many iterations as nobody makes: what takes them as arguments of one call ends here. */
function testLongCourse() {
  const { course } = page;
  if (course.length === 0) return;
  page.course = Array.from({ length: 100000 }, (_, i) => ({ ...course[0], iteration: i + 1, residual_mm: 1, moved_max_mm: 1 }));
  try { drawCourse(); } catch (error) { expect(`a long curve: ${error}`, false); }
  expect('a long curve is drawn', byId('course').querySelectorAll('path').length === 2);
  page.course = course;
  drawCourse();
}

function testTables() {
  const names = () => [...byId('structure-table').querySelectorAll('tbody td:first-child')].map((cell) => cell.textContent);
  expect('a row for each structure', names().length === structures.length && structures.every((s) => names().includes(s.name)));
  const first = names().join();
  byId('structure-table').querySelectorAll('th button')[0].click();
  expect('the table is sorted the other way', structures.length < 2 || names().join() !== first);
  byId('structure-table').querySelectorAll('th button')[0].click();
  expect('the verdict is in words', byId('verdict-word').textContent.length > 3 && byId('verdict-text').textContent.length > 20);
  expect('inputs with checksums', byId('inputs-table').querySelectorAll('tbody tr').length === report.inputs.length && /[0-9a-f]{8}/.test(byId('inputs-table').textContent));
  const all = byId('settings-table').querySelectorAll('tbody tr').length;
  change(byId('changed-only'), true);
  expect('settings: all, and those that changed', all > 60 && byId('settings-table').querySelectorAll('tbody tr').length < all);
  change(byId('changed-only'), false);
  expect('a curve of the convergence', page.course.length > 0 && byId('course').querySelectorAll('path').length === 2);
  expect('nothing of the data became markup', document.querySelectorAll('script').length === 3 && document.querySelectorAll('img, iframe, object').length === 0);
  const light = getComputedStyle(document.body).backgroundColor;
  byId('theme').click();
  expect('the theme changes', getComputedStyle(document.body).backgroundColor !== light);
  byId('theme').click();
}

function testFrames() {
  expect('WebGL2', view.gl !== null && view.gl.getError() === 0);
  if (view.gl === null) return;
  const last = shown.length - 1;
  expect('it begins with the last frame', state.frame === last && Number(byId('frame').value) === last && shown[last] === page.n_frames - 1);
  byId('all-off').click();
  const empty = viewPixels();
  byId('all-on').click();
  expect('the model is drawn', different(empty, viewPixels()) > 500);
  changesView('the slider', () => change(byId('frame'), '0'), () => change(byId('frame'), String(last)));
  change(byId('frame'), '0');
  expect('and its frame is named', byId('frame-value').textContent.includes(rows[0].name) && byId('now').getAttribute('x1') === String(plotX(0)));
  press(document.body, 'l');
  expect('a key goes on', state.frame === Math.min(1, last));
  press(document.body, 'j');
  expect('and back', state.frame === 0);
  press(document.body, 'k');
  expect('a key plays', playing.timer !== 0 && byId('play').getAttribute('aria-pressed') === 'true');
  byId('play').click();
  expect('and a button stops', playing.timer === 0);
  showFrame(last);
  changesView('the target', () => change(byId('show-target'), true), () => change(byId('show-target'), false));
  for (let k = 0; k <= last; k += Math.max(1, last >> 2)) {
    showFrame(k);
    expect(`frame ${shown[k]} has places and a target`, structures.every((s) => s.place.after.every(Number.isFinite)) && targets[0].n > 0);
  }
  showFrame(last);
  testMoves();
  testColours();
  testPicking();
  expect('no error of WebGL', view.gl.getError() === 0);
}

/* Where nothing is doubtful the target's points are near the model: the places of both are in one space. */
function testNear() {
  for (const k of [0, shown.length >> 1, shown.length - 1].filter((i) => !isDoubtful(rowOf(shown[i])))) {
    showFrame(k);
    const target = targets[0].place, some = Math.max(1, Math.floor(targets[0].n / 200));
    let sum = 0, n = 0;
    for (let i = 0; i < targets[0].n; i += some, n++) {
      let near = Infinity;
      for (const { place } of structures) for (let j = 0; j < place.after.length; j += 3) near = Math.min(near, Math.hypot(place.after[j] - target[3 * i], place.after[j + 1] - target[3 * i + 1], place.after[j + 2] - target[3 * i + 2]));
      sum += near;
    }
    expect(`frame ${shown[k]}: the target is where the model is (${digits(sum / n)} mm)`, sum / n < 0.08 * sceneRadius);
  }
}

function testTrackTables() {
  expect('the verdict is in words', byId('verdict-word').textContent.length > 3 && byId('verdict-text').textContent.length > 20);
  expect('every frame has a verdict', page.counts.good + page.counts.look + page.counts.failed === page.n_frames);
  expect('curves', byId('curves').querySelectorAll('path').length === 2 && byId('curves').querySelectorAll('rect').length >= 3);
  const count = () => byId('frame-table').querySelectorAll('tbody tr').length, all = count();
  expect('a row for each frame', all === Math.min(rows.length, ROWS_MOST));
  change(byId('doubtful-only'), true);
  expect('and only those to look at', count() === Math.min(rows.filter(isDoubtful).length, ROWS_MOST));
  change(byId('doubtful-only'), false);
  byId('frame-table').querySelector('tbody tr').click();
  expect('a row shows its frame', state.frame === 0 && byId('frame-table').querySelector('tr.chosen') !== null);
  const box = byId('curves').querySelector('svg').getBoundingClientRect();
  byId('curves').querySelector('svg').dispatchEvent(new MouseEvent('click', { clientX: box.right - 4, clientY: box.top + 20, bubbles: true }));
  expect('a click in the curves shows the last frame', state.frame === shown.length - 1);
  expect('inputs with checksums', /[0-9a-f]{8}/.test(byId('inputs-table').textContent));
  expect('settings', byId('settings-table').querySelectorAll('tbody tr').length > 60);
  expect('nothing of the data became markup', document.querySelectorAll('script').length === 3 && document.querySelectorAll('img, iframe, object').length === 0);
}

/* As many frames as nobody has: what takes them as arguments of one call ends here. */
function testManyFrames() {
  const kept = rows.slice();
  rows.length = 0;
  for (let i = 0; i < 20000; i++) rows.push({ ...kept[0], number: i, time_s: i / page.fps });
  try { drawCurves(); fillFrames(); } catch (error) { expect(`many frames: ${error}`, false); }
  expect('many frames are drawn', byId('curves').querySelectorAll('path').length === 2 && byId('frame-table').querySelectorAll('tbody tr').length === ROWS_MOST);
  rows.length = 0;
  rows.push(...kept);
  drawCurves();
  fillFrames();
  markFrame();
}

/* Cards of many results: the worst first, each with a picture that shows something. */
function testCohort() {
  const cards = [...document.querySelectorAll('article')], order = ['missing', 'unreadable', 'failed', 'look', 'good'];
  const ranks = cards.map((card) => order.indexOf(card.classList[1]));
  expect('a card for each result', cards.length === page.cases.length && cards.length > 0);
  expect('the worst first', ranks.every((rank, i) => i === 0 || ranks[i - 1] <= rank));
  cards.forEach((card, i) => {
    const canvas = card.querySelector('canvas');
    expect(`card ${i + 1} has its path and verdict`, card.querySelector('h3').textContent.length > 0 && card.querySelector('.mark').textContent === order[ranks[i]]);
    if (!canvas) return;
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    expect(`card ${i + 1}: its picture shows something`, data.filter((v, k) => k % 4 === 3 && v > 0).length > 2000 && new Set(data).size > 8);
  });
  expect('nothing of the data became markup', document.querySelectorAll('script').length === 3 && document.querySelectorAll('img, iframe, object').length === 0);
  expect('only cards are shown', byId('view').offsetParent === null && byId('ranks').offsetParent !== null);
}

const SELFTESTS = {
  register: [testTables, testLongCourse, testView, testSlices, testSampling, () => setColour('distance')],
  track: [testTrackTables, testManyFrames, testFrames, testNear],
  cohort: [testCohort],
}[page.kind];

function runSelftest() {
  for (const part of SELFTESTS) {
    try { part(); } catch (error) { expect(`${part.name} ends: ${error && error.stack}`, false); }
  }
  expect(`no error: ${selftest.errors.join('; ')}`, selftest.errors.length === 0 && byId('failure').hidden);
  const result = `selftest: ${selftest.failed === 0 ? 'passed' : 'failed'}, ${selftest.lines.length} checks, ${selftest.failed} failed`;
  document.body.append(element('pre', {}, `${selftest.lines.join('\n')}\n${result}`));
  document.title = result;
}

window.addEventListener('load', () => setTimeout(runSelftest, 50));
