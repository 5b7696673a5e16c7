/* report_selftest.js: what the page of a report tests of itself. */

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
  const { course } = page, drawn = [...byId('course').childNodes];
  if (course.length === 0) return;
  page.course = Array.from({ length: 100000 }, (_, i) => ({ ...course[0], iteration: i + 1, residual_mm: 1, moved_max_mm: 1 }));
  byId('course').replaceChildren();
  try { drawCourse(); } catch (error) { expect(`a long curve: ${error}`, false); }
  expect('a long curve is drawn', byId('course').querySelectorAll('path').length === 2);
  page.course = course;
  byId('course').replaceChildren(...drawn);
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
  expect('nothing of the data became markup', document.querySelectorAll('script').length === 5 && document.querySelectorAll('img, iframe, object').length === 0);
  const light = getComputedStyle(document.body).backgroundColor;
  byId('theme').click();
  expect('the theme changes', getComputedStyle(document.body).backgroundColor !== light);
  byId('theme').click();
}

const SELFTESTS = [testTables, testLongCourse, testView, testSlices, testSampling, () => setColour('distance')];
