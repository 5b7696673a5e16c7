/* page_main.js: puts the page together: what is shown now, the controls, what a click reads. */

const blinking = { timer: 0 };

function setBlend(blend) {
  state.blend = blend;
  state.when = blend < 0.5 ? 'before' : 'after';
  byId('blend').value = blend;
  for (const choice of document.querySelectorAll('#when input')) choice.checked = choice.value === (blend === 0 ? 'before' : blend === 1 ? 'after' : '');
  if (blinking.timer !== 0) redraw('view', 'slices');
  else redraw('view');
}

function setBlinking(on) {
  if (blinking.timer !== 0) clearInterval(blinking.timer);
  blinking.timer = on ? setInterval(() => setBlend(state.when === 'before' ? 1 : 0), 700) : 0;
  byId('blink').setAttribute('aria-pressed', String(on));
  if (!on) setBlend(1);
  redraw('slices');
}

function viewText() {
  if (isTrack) return `${frameText(shown[state.frame])}${state.showTarget ? ', target as points in blue' : ''}`;
  const now = state.blend > 0.995 ? 'after' : state.blend < 0.005 ? 'before' : `${Math.round(100 * state.blend)} % of the way`;
  return `model: ${now}${state.showTarget ? `, ${targetWord} in blue` : ''}`;
}

function choose(which) {
  state.chosen = state.chosen === which ? -1 : which;
  if (state.chosen >= 0) {
    structures[which].visible = true;
    if (!isTrack) chooseAlong(which);
  }
  fillList();
  if (!isTrack) fillStructureTable();
  redraw('view', 'slices');
}

function chooseOnly(which) {
  if (state.chosen !== which) choose(which);
}

/* What is known of a vertex, in words. */
function readVertex(which, vertex) {
  const s = structures[which], p = s.place.after.subarray(3 * vertex, 3 * vertex + 3);
  const value = (v) => (v === undefined || v === null || v < 0 ? 'not known' : `${short(v)} mm`);
  const { distance, expected, moved } = s.values;
  byId('reading').replaceChildren(element('strong', {}, s.name), ` at L ${digits(p[0], 1)}, P ${digits(p[1], 1)}, S ${digits(p[2], 1)} mm: `, isTrack ?
    `${value(moved.after[vertex])} from its place in the first frame` :
    `distance to the ${targetWord} ${value(distance.after[vertex])} (before ${value(distance.before[vertex])}), ` +
    `expected error ${value(expected.after[vertex])}, moved ${value(moved.after[vertex])}`);
}

function showVertex(which, vertex) {
  chooseOnly(which);
  state.pointed = true;
  slicesTo(structures[which].place.after.subarray(3 * vertex, 3 * vertex + 3));
  readVertex(which, vertex);
}

/* Of the vertex of the shown structures that is nearest to a point. */
function readNearest(point) {
  let best = { d: Infinity };
  structures.forEach((s, which) => {
    if (!s.visible) return;
    for (let i = 0; i < s.n; i++) {
      const a = s.place.after, d = (a[3 * i] - point[0]) ** 2 + (a[3 * i + 1] - point[1]) ** 2 + (a[3 * i + 2] - point[2]) ** 2;
      if (d < best.d) best = { d, which, vertex: i };
    }
  });
  if (best.d < Infinity) readVertex(best.which, best.vertex);
}

function clickView(x, y) {
  const hit = pick(x, y);
  if (!hit) return;
  chooseOnly(hit.structure);
  state.pointed = true;
  slicesTo(hit.point);
  readVertex(hit.structure, hit.vertex);
}

function startWhen() {
  for (const [value, text] of [['before', 'before'], ['after', 'after']]) {
    const choice = element('input', { type: 'radio', name: 'when', value });
    choice.checked = value === 'after';
    choice.addEventListener('change', () => { setBlinking(false); setBlend(value === 'after' ? 1 : 0); });
    byId('when').append(element('label', {}, choice, text));
  }
  byId('blend').addEventListener('input', () => setBlend(Number(byId('blend').value)));
  byId('blink').addEventListener('click', () => setBlinking(blinking.timer === 0));
}

function startColours() {
  for (const [key, { name }] of Object.entries(COLOURS)) {
    if (key === 'structure' || statistics(structures.map((s) => s.values[key].after))) byId('colour').append(element('option', { value: key }, name));
  }
  byId('colour').addEventListener('change', () => setColour(byId('colour').value));
  startLegend();
}

function startTarget() {
  byId('target-word').textContent = targetWord;
  if (targets.length === 0) {
    byId('show-target').parentElement.style.display = 'none';
    byId('opacity-label').style.display = 'none';
  }
  byId('show-target').addEventListener('change', () => { state.showTarget = byId('show-target').checked; redraw('view'); });
  byId('opacity').addEventListener('input', () => { state.opacity = Number(byId('opacity').value); redraw('view'); });
}

/* What the keyboard does everywhere but where text is typed: B blinks; J and L go to other frames, K plays. */
function listenToPage() {
  document.addEventListener('keydown', (event) => {
    const typing = event.target instanceof Element && event.target.closest('input:not([type="range"]):not([type="checkbox"]):not([type="radio"]), select');
    const key = event.key.toLowerCase();
    if (typing || event.ctrlKey || event.altKey || event.metaKey) return;
    if (key === 'b' && !isTrack) setBlinking(blinking.timer === 0);
    if (isTrack) pressFrameKey(key, event.target === byId('gl'));
  });
  window.addEventListener('resize', () => redraw('view', 'slices'));
  window.addEventListener('beforeprint', () => { drawView(); slices.forEach(drawSlice); });
}

function startControls() {
  if (!isTrack) startWhen();
  startColours();
  startTarget();
  byId('all-on').addEventListener('click', () => setAllVisible(() => true));
  byId('all-off').addEventListener('click', () => setAllVisible(() => false));
  byId('only').addEventListener('click', () => setAllVisible((i) => state.chosen < 0 || i === state.chosen));
  startPresets();
  listenToPointers(byId('gl'), clickView);
  listenToKeys(byId('gl'));
  listenToPage();
}

function tellTables() {
  if (isTrack) {
    tellRun();
    drawCurves();
    fillFrames();
    byId('doubtful-only').addEventListener('change', fillFrames);
  } else {
    tellRegistration();
    fillStructureTable();
    drawCourse();
  }
  fillSettings();
  fillInputs();
  byId('changed-only').addEventListener('change', fillSettings);
}

/* Each part stands for itself: what fails says so, and the others go on. */
function start() {
  document.body.classList.add(page.kind);
  const parts = page.kind === 'cohort' ? [tellCohort, startTheme] : [tellTables, startView, isTrack ? startFrames : startSlices, startControls, startTheme,
    () => setColour(statistics(structures.map((s) => s.values.distance?.after)) ? 'distance' : 'structure')];
  for (const part of parts) {
    try { part(); } catch (error) { fail(error); }
  }
  if (page.kind !== 'cohort') drawWaiting();
}

document.addEventListener('DOMContentLoaded', start);
