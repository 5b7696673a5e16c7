/* track_selftest.js: what the page of a tracking run tests of itself. */

function testFrames() {
  expect('WebGL2', view.gl !== null && view.gl.getError() === 0);
  if (view.gl === null) return;
  const last = shown.length - 1;
  expect('it begins with the last frame', state.frame === last && Number(byId('frame').value) === last && shown[last] === page.frames - 1);
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
  testReading();
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

function testReading() {
  const canvas = byId('gl');
  let hit = null;
  for (let y = 0.1; y < 0.95 && !hit; y += 0.05) for (let x = 0.1; x < 0.95 && !hit; x += 0.05) hit = pick(x * canvas.clientWidth, y * canvas.clientHeight);
  expect('a click finds a surface', hit !== null);
  if (!hit) return;
  showVertex(hit.structure, hit.vertex);
  expect('and names it', byId('reading').textContent.startsWith(structures[hit.structure].name) && state.chosen === hit.structure);
  choose(hit.structure);
  state.pointed = false;
}

function testTrackTables() {
  expect('the verdict is in words', byId('verdict-word').textContent.length > 3 && byId('verdict-text').textContent.length > 20);
  expect('every frame has a verdict', page.counts.good + page.counts.look + page.counts.failed === page.frames);
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

const SELFTESTS = [testTrackTables, testManyFrames, testFrames, testNear];
