/* report_tables.js: the verdict in words, figures, the tables and the curve of convergence. */

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

function tellVerdict() {
  const level = report.verdict in VERDICTS ? report.verdict : 'look', verdict = VERDICTS[level];
  byId('verdict-badge').classList.add(level);
  byId('verdict-sign').textContent = verdict.sign;
  byId('verdict-word').textContent = verdict.word;
  const others = structures.filter((s) => s.facts.verdict !== 'good').length;
  byId('verdict-text').textContent = verdict.text + (others > 0 ? ` ${others} of ${structures.length} structures are not good.` : '') +
    (level === 'good' ? ' Where to look first, all the same:' : ' Where to look:');
  byId('look-list').append(...lookItems().map((parts) => element('li', {}, ...parts)));
}

function tellFigures() {
  const distance = report.distance_mm && report.distance_mm.model_to_target, back = report.distance_mm && report.distance_mm.target_to_model;
  const start = statistics(structures.map((s) => s.values.distance.before)), end = statistics(structures.map((s) => s.values.distance.after));
  const vertex = report.truth && report.truth.vertex_to_vertex_mm, made = [];
  if (distance) made.push(figure(`model to ${targetWord}`, digits(distance.mean), 'mm', `mean; 95 % below ${digits(distance.p95)}, largest ${digits(distance.max)}`));
  if (back) made.push(figure(`${targetWord} to model`, digits(back.mean), 'mm', `mean; 95 % below ${digits(back.p95)}, largest ${digits(back.max)}`));
  if (start && end) made.push(figure('before \u2192 after', `${digits(start.mean, 1)}\u2009\u2192\u2009${digits(end.mean)}`, 'mm', `mean over vertices, to the ${targetWord}\u2019s surface`));
  if (vertex) made.push(figure('vertex to its true place', digits(vertex.mean), 'mm', `mean; largest ${digits(vertex.max)}`));
  made.push(figure('expected error', digits(report.expected_error_mm), report.expected_error_mm === null ? '' : 'mm', 'mean; what the registration itself says'));
  const moved = statistics(structures.map((s) => s.values.moved.after));
  if (moved) made.push(figure('moved from the start', digits(moved.mean, 1), 'mm', `mean; largest ${digits(moved.max, 1)}`));
  made.push(figure('structures', `${structures.filter((s) => s.facts.verdict === 'good').length} of ${structures.length}`, '', 'are good'));
  made.push(figure('folds', String(report.folds), '', 'edges that turned over'));
  made.push(figure('time', digits(report.time_s.total, 1), 's', `${report.iterations} iterations, ${report.threads} threads, ${report.vertices} vertices`));
  byId('figures').append(...made);
}

function tellHead() {
  const names = structures.map((s) => s.name), what = names.length === 1 ? names[0] : `${names.length} structures`;
  const onto = page.image_target ? 'into the image' : 'onto';
  const target = page.image_target && image ? image.path : targets.length === 1 ? targets[0].path : targets.length > 1 ? `${targets.length} targets` : 'landmarks';
  byId('page-title').textContent = `${what} ${onto} ${target}`;
  document.title = `${VERDICTS[report.verdict] ? VERDICTS[report.verdict].word : ''}: ${what} ${onto} ${target}`;
  byId('page-line').textContent = `smr ${report.version} \u00b7 ${report.converged ? 'converged' : 'not converged'} after ${report.iterations} iterations \u00b7 ` +
    `state ${report.state_hash}${page.resumed ? ' \u00b7 resumed: \u201cbefore\u201d is where it went on' : ''}`;
  byId('footer').textContent = `Written by smr ${report.version}. Coordinates: LPS, millimetres. This file holds all that it shows and asks no network.`;
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

/* Residual and movement over the iterations, on a logarithmic scale. */
function drawCourse() {
  const rows = page.course, W = 1100, H = 300, left = 62, right = 16, top = 26, bottom = 40;
  if (rows.length === 0) {
    byId('course').append(element('p', {}, 'No iteration was made.'));
    return;
  }
  const series = [['residual_mm', 'residual', 'var(--accent)', ''], ['moved_max_mm', 'largest movement', 'var(--look)', '7 4']];
  const all = rows.flatMap((r) => series.map(([key]) => r[key])).filter((v) => v !== null && v > 0);
  const high = 10 ** Math.ceil(Math.log10(all.reduce((a, b) => Math.max(a, b), 0.01)));
  const low = Math.max(1e-4, 10 ** Math.floor(Math.log10(all.reduce((a, b) => Math.min(a, b), high / 10))));
  const last = rows[rows.length - 1].iteration, x = (i) => left + (W - left - right) * (last > 1 ? (i - 1) / (last - 1) : 0.5);
  const y = (v) => (v === null ? null : top + (H - top - bottom) * Math.log10(high / Math.max(low, v)) / Math.log10(high / low));
  const drawn = svg('svg', { viewBox: `0 0 ${W} ${H}`, role: 'img', 'aria-label': 'residual and largest movement over the iterations, in mm' });
  const text = (string, px, py, anchor) => svg('text', { x: px, y: py, 'text-anchor': anchor }, string);
  for (let v = high; v >= low * 0.99; v /= 10) {
    drawn.append(svg('line', { x1: left, x2: W - right, y1: y(v), y2: y(v), stroke: 'var(--line)' }), text(`${Number(v.toPrecision(1))} mm`, left - 8, y(v) + 4, 'end'));
  }
  rows.forEach((r, k) => {
    if (k > 0 && rows[k - 1].radius_mm === r.radius_mm) return;
    drawn.append(svg('line', { x1: x(r.iteration), x2: x(r.iteration), y1: top - 8, y2: H - bottom, stroke: 'var(--muted)', 'stroke-dasharray': '2 3' }),
      text(`${short(r.radius_mm)} mm`, x(r.iteration) + 3, top - 12, 'start'));
  });
  const step = Math.max(1, niceAbove(last / 12));
  for (let i = step; i <= last; i += step) drawn.append(text(String(Math.round(i)), x(Math.round(i)), H - bottom + 16, 'middle'));
  drawn.append(text('iteration; above: cluster radius', (left + W) / 2, H - 6, 'middle'));
  for (const [key, , colour, dash] of series) {
    drawn.append(svg('path', { d: curve(rows.map((r) => [x(r.iteration), y(r[key])])), fill: 'none', stroke: colour, 'stroke-width': 2.2, 'stroke-dasharray': dash }));
  }
  series.forEach(([, name, colour, dash], k) => {
    const px = W - right - 330 + 150 * k, py = H - 10;
    drawn.append(svg('line', { x1: px, x2: px + 30, y1: py - 4, y2: py - 4, stroke: colour, 'stroke-width': 2.2, 'stroke-dasharray': dash }), text(name, px + 36, py, 'start'));
  });
  byId('course').append(drawn);
}

function tellTables() {
  tellHead();
  tellVerdict();
  tellFigures();
  fillStructureTable();
  drawCourse();
  fillSettings();
  fillInputs();
  byId('changed-only').addEventListener('change', fillSettings);
  const low = page.scene.low, high = page.scene.high, step = Math.max(...low.map((v, c) => (high[c] - v) / 65535));
  const thin = page.scene.triangles_shown < page.scene.triangles_whole;
  byId('table-note').textContent = `Distances in this table integrate over the area of the whole surfaces; moved: over what is shown. ` +
    `In the views places are rounded to ${digits(1000 * step, 0)} \u00b5m` +
    `${thin ? `, and ${page.scene.triangles_shown} of ${page.scene.triangles_whole} triangles are shown, of vertices ${digits(page.scene.cell_mm)} mm apart` : ''}. ` +
    'goals: vertices with a goal at the end.';
}
