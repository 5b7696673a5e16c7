/* page_tables.js: verdicts, figures, and the tables of structures, settings and inputs. */

const VERDICTS = {
  good: { word: 'good', sign: '\u2713', text: 'Nothing that was measured speaks against this result.' },
  look: { word: 'look at it', sign: '!', text: 'Something speaks against this result. Look at what is listed before you use it.' },
  failed: { word: 'failed', sign: '\u2717', text: 'Do not use this result.' },
};

function verdictMark(level) {
  const verdict = VERDICTS[level] || VERDICTS.look;
  return element('span', { class: level, title: verdict.word }, `${verdict.sign} ${verdict.word}`);
}

function figure(name, value, unitText, more) {
  return element('div', {}, element('dt', {}, name), element('dd', {}, value, unitText ? ` ${unitText}` : '', more ? element('small', {}, more) : null));
}

/* The verdict in words, what to look at first, and the figures. */
function tellVerdict(level, text, items, figures) {
  const verdict = VERDICTS[level] || VERDICTS.look;
  byId('verdict-badge').classList.add(level in VERDICTS ? level : 'look');
  byId('verdict-sign').textContent = verdict.sign;
  byId('verdict-word').textContent = verdict.word;
  byId('verdict-text').textContent = text;
  byId('look-list').append(...items.map((parts) => element('li', {}, ...parts)));
  byId('figures').append(...figures.filter((one) => one));
}

function tellHead(title, verdict, line) {
  byId('page-title').textContent = title;
  document.title = `${(VERDICTS[verdict] || VERDICTS.look).word}: ${title}`;
  byId('page-line').textContent = line;
  byId('footer').textContent = `Written by smr ${report.version}. Coordinates: LPS, millimetres. This file holds all that it shows and asks no network.`;
}

function namesOf() { return structures.length === 1 ? structures[0].name : `${structures.length} structures`; }

/* Numbers of a setting as text: words of choices and switches; arrays up to the last that is not 0. */
function settingText(s, values) {
  const used = values.slice(0, Math.max(1, values.findLastIndex((v) => v !== 0) + 1));
  return used.map((v) => (s.words ? s.words.split('|')[v] : s.switch ? (v > 0 ? 'on' : 'off') : String(v))).join(', ');
}

function fillSettings() {
  const only = byId('changed-only').checked, rows = [];
  let group = null;
  for (const s of page.settings) {
    const value = settingText(s, s.value), usual = settingText(s, s.default), changed = value !== usual;
    if (only && !changed) continue;
    if (s.group !== group) rows.push(element('tr', { class: 'group' }, element('th', { colspan: 4, scope: 'colgroup' }, s.group)));
    ({ group } = s);
    rows.push(element('tr', { class: changed ? 'changed' : '' }, element('td', {}, s.name),
      element('td', { class: 'text' }, `${value}${s.unit ? ` ${s.unit}` : ''}${changed ? ' *' : ''}`), element('td', { class: 'text' }, usual),
      element('td', { class: 'wrap' }, s.text)));
  }
  if (rows.length === 0) rows.push(element('tr', {}, element('td', { colspan: 4 }, 'All settings are the defaults.')));
  const heads = ['setting', 'value', 'default', 'meaning'].map((name) => element('th', { scope: 'col', class: 'text' }, name));
  byId('settings-table').replaceChildren(element('thead', {}, element('tr', {}, ...heads)), element('tbody', {}, ...rows));
  byId('settings-note').textContent = '* differs from the default. n_workers, n_landmarks and n_target_vertices follow from the machine and the inputs; search and radii that are chosen by the library show as the default.' +
    (page.prepared ? ' The model was prepared before: what it was prepared with is not known here.' : '');
}

/* As it would be typed. */
function commandText() {
  return report.command.map((word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`)).join(' ');
}

function fillInputs() {
  byId('command').textContent = commandText();
  byId('copy').addEventListener('click', () => {
    const range = document.createRange();
    range.selectNodeContents(byId('command'));
    getSelection().removeAllRanges();
    getSelection().addRange(range);
    document.execCommand('copy');
  });
  const heads = ['file', 'bytes', 'CRC-32'].map((name) => element('th', { scope: 'col' }, name));
  byId('inputs-table').append(element('thead', {}, element('tr', {}, ...heads)), element('tbody', {}, ...report.inputs.map((file) =>
    element('tr', {}, element('td', {}, file.path), element('td', {}, String(file.bytes)), element('td', {}, element('code', {}, file.crc32))))));
}

/* A button that chooses a structure and goes to the vertex with the largest of these values. */
function showButton(which, colour) {
  return element('button', { type: 'button', click: () => {
    setColour(colour);
    choose(which);
    const s = structures[which], values = s.values[colour].after;
    showVertex(which, largestAt(values));
    byId('view').scrollIntoView();
  } }, 'show');
}

/* The structures with the largest mean or largest value: where to look when nothing is wrong. */
function worst(colour) {
  let best = -1, most = 0;
  structures.forEach((s, i) => {
    const facts = statistics([s.values[colour].after]);
    if (facts && facts.max > most) [best, most] = [i, facts.max];
  });
  return best < 0 ? null : { which: best, value: most };
}

function lookItems() {
  const items = report.reasons.map((text) => [text]);
  structures.forEach((s, i) => {
    if (s.facts.verdict === 'good' || s.facts.reasons.length === 0) return;
    items.push([element('strong', {}, s.name), `: ${s.facts.reasons.join('; ')} `, showButton(i, worstKnown(s))]);
  });
  for (const [colour, text] of [['distance', `farthest from the ${targetWord}`], ['expected', 'largest expected error'], ['moved', 'moved farthest']]) {
    const found = worst(colour);
    if (found) items.push([`${text}: `, element('strong', {}, structures[found.which].name), `, ${digits(found.value)} mm at most `, showButton(found.which, colour)]);
  }
  return items;
}

function worstKnown(s) { return statistics([s.values.distance.after]) ? 'distance' : 'expected'; }

function registrationFigures() {
  const distance = report.distance_mm?.model_to_target, back = report.distance_mm?.target_to_model, vertex = report.truth?.vertex_to_vertex_mm;
  const over = (which, when) => statistics(structures.map((s) => s.values[which][when]));
  const start = over('distance', 'before'), end = over('distance', 'after'), moved = over('moved', 'after');
  const tail = ({ p95, max }) => `mean; 95 % below ${digits(p95)}, largest ${digits(max)}`;
  return [
    distance && figure(`model to ${targetWord}`, digits(distance.mean), 'mm', tail(distance)),
    back && figure(`${targetWord} to model`, digits(back.mean), 'mm', tail(back)),
    start && end && figure('before \u2192 after', `${digits(start.mean, 1)}\u2009\u2192\u2009${digits(end.mean)}`, 'mm', `mean over vertices, to the ${targetWord}\u2019s surface`),
    vertex && figure('vertex to its true place', digits(vertex.mean), 'mm', `mean; largest ${digits(vertex.max)}`),
    figure('probability', digits(report.probability, 2), '', 'of being right within 1 mm; what the registration itself says'),
    figure('expected error', digits(report.expected_error_mm), report.expected_error_mm === null ? '' : 'mm', 'mean; what the registration itself says'),
    moved && figure('moved from the start', digits(moved.mean, 1), 'mm', `mean; largest ${digits(moved.max, 1)}`),
    figure('structures', `${structures.filter((s) => s.facts.verdict === 'good').length} of ${structures.length}`, '', 'are good'),
    figure('folds', String(report.folds), '', 'edges that turned over'),
    figure('time', digits(report.time_s.total, 1), 's', `${report.iterations} iterations, ${report.threads} threads, ${report.vertices} vertices`),
  ];
}

function tellRegistration() {
  const level = report.verdict in VERDICTS ? report.verdict : 'look', others = structures.filter((s) => s.facts.verdict !== 'good').length;
  const onto = page.image_target ? 'into the image' : 'onto';
  const target = page.image_target && image ? image.path : targets.length === 1 ? targets[0].path : targets.length > 1 ? `${targets.length} targets` : 'landmarks';
  tellHead(`${namesOf()} ${onto} ${target}`, report.verdict, `smr ${report.version} \u00b7 ${report.converged ? 'converged' : 'not converged'} after ${report.iterations} iterations \u00b7 ` +
    `state ${report.state_hash}${page.resumed ? ' \u00b7 resumed: \u201cbefore\u201d is where it went on' : ''}`);
  tellVerdict(level, VERDICTS[level].text + (others > 0 ? ` ${others} of ${structures.length} structures are not good.` : '') +
    (level === 'good' ? ' Where to look first, all the same:' : ' Where to look:'), lookItems(), registrationFigures());
  const step = Math.max(...boxes.flatMap((p) => p.low.map((v, c) => (p.high[c] - v) / 65535))), thin = page.triangles_shown < page.triangles_whole;
  byId('table-note').textContent = 'Distances in this table integrate over the area of the whole surfaces; moved: over what is shown. ' +
    `In the views places are rounded to ${digits(1000 * step, 0)} \u00b5m` +
    `${thin ? `, and ${page.triangles_shown} of ${page.triangles_whole} triangles are shown, of vertices ${digits(page.cell_mm)} mm apart` : ''}. ` +
    'goals: vertices with a goal at the end.';
}

/* Columns: title, unit, value of a structure's facts (a number or text). */
function columns() {
  const target = (f) => f.distance_mm && f.distance_mm.model_to_target, from = (f) => f.distance_mm && f.distance_mm.target_to_model;
  return [
    ['structure', '', (f) => f.name],
    ['verdict', '', (f) => ['good', 'look', 'failed'].indexOf(f.verdict)],
    ['expected error', 'mm', (f) => f.expected_error_mm],
    [`mean to ${targetWord}`, 'mm', (f) => target(f) && target(f).mean],
    ['95 %', 'mm', (f) => target(f) && target(f).p95],
    ['largest', 'mm', (f) => target(f) && target(f).max],
    [`mean from ${targetWord}`, 'mm', (f) => from(f) && from(f).mean],
    ['residual', 'mm', (f) => f.residual_mean_mm],
    ['moved, mean', 'mm', (f) => statistics([structures[report.per_structure.indexOf(f)].values.moved.after])?.mean],
    ['moved, largest', 'mm', (f) => statistics([structures[report.per_structure.indexOf(f)].values.moved.after])?.max],
    ['goals', '%', (f) => (f.matched_share === null ? null : 100 * f.matched_share)],
    ['folds', '', (f) => f.folds],
    ['vertices', '', (f) => f.vertices],
  ];
}

const sorting = { column: 0, down: false };

function cellText(i, unitText, value) {
  if (typeof value === 'string') return value;
  return i >= columns().length - 2 ? String(value ?? '\u2013') : digits(value, unitText === '%' ? 0 : 2);
}

function fillStructureTable() {
  const table = byId('structure-table'), all = columns();
  const rows = report.per_structure.map((facts, i) => ({ facts, i, values: all.map(([, , of]) => of(facts)) }));
  const { column, down } = sorting, missing = (v) => v === null || v === undefined;
  rows.sort((p, q) => {
    const a = p.values[column], b = q.values[column];
    if (missing(a) || missing(b)) return missing(a) - missing(b) || p.i - q.i;
    const order = typeof a === 'string' ? a.localeCompare(b) : a - b;
    return (down ? -order : order) || p.i - q.i;
  });
  const heads = all.map(([name, unitText], c) => element('th', { scope: 'col', 'aria-sort': c !== column ? 'none' : down ? 'descending' : 'ascending' },
    element('button', { type: 'button', click: () => { sortBy(c); } }, name, unitText ? `, ${unitText}` : '', c === column ? (down ? ' \u25bc' : ' \u25b2') : '')));
  table.replaceChildren(element('thead', {}, element('tr', {}, ...heads)), element('tbody', {}, ...rows.map(({ facts, i, values }) =>
    element('tr', { class: i === state.chosen ? 'chosen' : '', title: facts.reasons.join('; '), click: () => choose(i) },
      ...values.map((v, c) => (c === 1 ? element('td', { class: 'text' }, verdictMark(facts.verdict)) : element('td', {}, cellText(c, all[c][1], v))))))));
}

function sortBy(column) {
  sorting.down = sorting.column === column ? !sorting.down : column > 0;
  sorting.column = column;
  fillStructureTable();
  byId('structure-table').querySelectorAll('th button')[column].focus();
}
