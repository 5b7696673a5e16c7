/* report_main.js: puts the page together: what is shown now, the controls, and when is drawn what. */

const waiting = new Set();
const blinking = { timer: 0 };

/* Draws at the next frame: 'view', 'slices'. */
function redraw(...what) {
  if (waiting.size === 0) requestAnimationFrame(drawWaiting);
  for (const one of what) waiting.add(one);
}

function drawWaiting() {
  const what = new Set(waiting);
  waiting.clear();
  if (what.has('view')) drawView();
  if (what.has('slices')) slices.forEach(drawSlice);
}

function fail(error) {
  byId('failure').hidden = false;
  byId('failure').append(element('p', {}, String(error && error.message ? error.message : error)));
}

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

function setMost(most) {
  state.most = most > 0 ? most : 1;
  byId('legend-max').value = Number(state.most.toPrecision(4));
  byId('legend-ticks').replaceChildren(...[0, 0.25, 0.5, 0.75, 1].map((k) => element('span', {}, short(k * state.most))));
  redraw('view');
}

/* Colours reach up to what 99 in 100 vertices have, rounded. */
function usualMost(colour) {
  const known = [];
  for (const s of structures) for (const v of s.values[colour].after) if (v >= 0) known.push(v);
  if (known.length === 0) return 1;
  known.sort((a, b) => a - b);
  const most = known[Math.floor(0.99 * (known.length - 1))];
  return most > 1e-3 ? niceAbove(most) : 1;
}

function setColour(colour) {
  state.colour = colour;
  byId('colour').value = colour;
  byId('legend').hidden = colour === 'structure';
  if (colour !== 'structure') {
    byId('legend-title').textContent = COLOURS[colour].title;
    setMost(usualMost(colour));
  }
  uploadValues();
  fillList();
  redraw('view');
}

function choose(which) {
  state.chosen = state.chosen === which ? -1 : which;
  if (state.chosen >= 0) {
    structures[which].visible = true;
    chooseAlong(which);
  }
  fillList();
  fillStructureTable();
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
  byId('reading').replaceChildren(element('strong', {}, s.name), ` at L ${digits(p[0], 1)}, P ${digits(p[1], 1)}, S ${digits(p[2], 1)} mm: ` +
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

function listValue(s) {
  if (state.colour === 'structure') return '';
  const facts = statistics([s.values[state.colour].after]);
  return facts ? `${short(facts.mean)} / ${short(facts.max)}` : '\u2013';
}

/* The structures beside the view: shown or not, and the mean and largest value of what colours them. */
function fillList() {
  const list = byId('structure-list');
  byId('list-note').textContent = state.colour === 'structure' ? '' : `${COLOURS[state.colour].name}: mean / largest over vertices, mm`;
  list.replaceChildren(...structures.map((s, i) => {
    const box = element('input', { type: 'checkbox', 'aria-label': `show ${s.name}` });
    box.checked = s.visible;
    box.addEventListener('change', () => setVisible(i, box.checked));
    const mark = VERDICTS[s.facts.verdict] || VERDICTS.look;
    return element('li', { class: i === state.chosen ? 'chosen' : '' }, box,
      element('span', { class: 'swatch', style: `background:${cssColour(s.colour)}` }),
      element('button', { type: 'button', title: s.name, 'aria-pressed': String(i === state.chosen), click: () => choose(i) }, s.name),
      element('span', { class: 'value' }, listValue(s)),
      element('span', { class: s.facts.verdict, title: mark.word }, mark.sign));
  }));
}

function setVisible(which, on) {
  structures[which].visible = on;
  redraw('view', 'slices');
}

function setAllVisible(of) {
  structures.forEach((s, i) => { s.visible = of(i); });
  fillList();
  redraw('view', 'slices');
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
  byId('legend-max').addEventListener('change', () => setMost(Number(byId('legend-max').value)));
  const canvas = byId('legend-map'), c = canvas.getContext('2d');
  for (let x = 0; x < canvas.width; x++) {
    c.fillStyle = `rgb(${mapColour(x / (canvas.width - 1)).map(Math.round).join(',')})`;
    c.fillRect(x, 0, 1, canvas.height);
  }
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

function startTheme() {
  const dark = () => {
    const set = document.documentElement.dataset.theme;
    return set ? set === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  };
  const tell = () => { byId('theme').textContent = dark() ? 'Light' : 'Dark'; redraw('view', 'slices'); };
  byId('theme').addEventListener('click', () => { document.documentElement.dataset.theme = dark() ? 'light' : 'dark'; tell(); });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', tell);
  tell();
}

function startControls() {
  startWhen();
  startColours();
  startTarget();
  byId('all-on').addEventListener('click', () => setAllVisible(() => true));
  byId('all-off').addEventListener('click', () => setAllVisible(() => false));
  byId('only').addEventListener('click', () => setAllVisible((i) => state.chosen < 0 || i === state.chosen));
  for (const letter of Object.keys(PRESETS)) {
    byId('presets').append(element('button', { type: 'button', title: `look from ${letter}`, click: () => lookFrom(letter) }, letter));
  }
  document.addEventListener('keydown', (event) => {
    const typing = event.target instanceof Element && event.target.closest('input:not([type="range"]):not([type="checkbox"]):not([type="radio"]), select');
    if (!typing && !event.ctrlKey && !event.altKey && !event.metaKey && event.key.toLowerCase() === 'b') setBlinking(blinking.timer === 0);
  });
  listenToPointers(byId('gl'), clickView);
  listenToKeys(byId('gl'));
  window.addEventListener('resize', () => redraw('view', 'slices'));
  window.addEventListener('beforeprint', () => { drawView(); slices.forEach(drawSlice); });
}

/* Each part stands for itself: what fails says so, and the others go on. */
function start() {
  for (const part of [tellTables, startView, startSlices, startControls, startTheme]) {
    try { part(); } catch (error) { fail(error); }
  }
  setColour(statistics(structures.map((s) => s.values.distance.after)) ? 'distance' : 'structure');
  drawWaiting();
}

document.addEventListener('DOMContentLoaded', start);
