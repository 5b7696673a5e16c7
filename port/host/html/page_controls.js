/* page_controls.js: when is drawn what; colours and their legend, the list of structures, the theme. */

const waiting = new Set();

/* Draws at the next frame: 'view', 'slices'. */
function redraw(...what) {
  if (waiting.size === 0) requestAnimationFrame(drawWaiting);
  for (const one of what) waiting.add(one);
}

function drawWaiting() {
  const what = new Set(waiting);
  waiting.clear();
  if (what.has('view')) drawView();
  if (what.has('slices')) slices.forEach((slice) => drawSlice(slice));
}

function fail(error) {
  byId('failure').hidden = false;
  byId('failure').append(element('p', {}, String(error && error.message ? error.message : error)));
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
  for (const values of allValues(colour)) for (const v of values) if (v >= 0) known.push(v);
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
    const mark = s.facts && (VERDICTS[s.facts.verdict] || VERDICTS.look);
    return element('li', { class: i === state.chosen ? 'chosen' : '' }, box,
      element('span', { class: 'swatch', style: `background:${cssColour(s.colour)}` }),
      element('button', { type: 'button', title: s.name, 'aria-pressed': String(i === state.chosen), click: () => choose(i) }, s.name),
      element('span', { class: 'value' }, listValue(s)),
      mark && element('span', { class: s.facts.verdict, title: mark.word }, mark.sign));
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

function startLegend() {
  byId('legend-max').addEventListener('change', () => setMost(Number(byId('legend-max').value)));
  const canvas = byId('legend-map'), c = canvas.getContext('2d');
  for (let x = 0; x < canvas.width; x++) {
    c.fillStyle = `rgb(${mapColour(x / (canvas.width - 1)).map(Math.round).join(',')})`;
    c.fillRect(x, 0, 1, canvas.height);
  }
}

function startPresets() {
  for (const letter of Object.keys(PRESETS)) {
    byId('presets').append(element('button', { type: 'button', title: `look from ${letter}`, click: () => lookFrom(letter) }, letter));
  }
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
