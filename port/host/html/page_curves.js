/* page_curves.js: residual and movement over the iterations of a registration; residual, ticks and verdicts over the
 * frames of a tracking run. */

/* A curve as a path; gaps where nothing was measured. */
function curve(points) {
  let path = '', open = false;
  for (const [x, y] of points) {
    if (y === null) open = false;
    else {
      path += `${open ? 'L' : 'M'}${x.toFixed(1)} ${y.toFixed(1)}`;
      open = true;
    }
  }
  return path;
}

function plotText(string, x, y, anchor) { return svg('text', { x, y, 'text-anchor': anchor }, string); }

/* Residual and movement over the iterations, on a logarithmic scale. */
function drawCourse() {
  const rows = page.course, W = 1100, H = 300, left = 62, right = 16, top = 26, bottom = 40;
  if (rows.length === 0) {
    byId('course').replaceChildren(element('p', {}, 'No iteration was made.'));
    return;
  }
  const series = [['residual_mm', 'residual', 'var(--accent)', ''], ['moved_max_mm', 'largest movement', 'var(--look)', '7 4']];
  const all = rows.flatMap((r) => series.map(([key]) => r[key])).filter((v) => v !== null && v > 0);
  const high = 10 ** Math.ceil(Math.log10(all.reduce((a, b) => Math.max(a, b), 0.01)));
  const low = Math.max(1e-4, 10 ** Math.floor(Math.log10(all.reduce((a, b) => Math.min(a, b), high / 10))));
  const last = rows[rows.length - 1].iteration, x = (i) => left + (W - left - right) * (last > 1 ? (i - 1) / (last - 1) : 0.5);
  const y = (v) => (v === null ? null : top + (H - top - bottom) * Math.log10(high / Math.max(low, v)) / Math.log10(high / low));
  const drawn = svg('svg', { viewBox: `0 0 ${W} ${H}`, role: 'img', 'aria-label': 'residual and largest movement over the iterations, in mm' });
  for (let v = high; v >= low * 0.99; v /= 10) {
    drawn.append(svg('line', { x1: left, x2: W - right, y1: y(v), y2: y(v), stroke: 'var(--line)' }), plotText(`${Number(v.toPrecision(1))} mm`, left - 8, y(v) + 4, 'end'));
  }
  rows.forEach((r, k) => {
    if (k > 0 && rows[k - 1].radius_mm === r.radius_mm) return;
    drawn.append(svg('line', { x1: x(r.iteration), x2: x(r.iteration), y1: top - 8, y2: H - bottom, stroke: 'var(--muted)', 'stroke-dasharray': '2 3' }),
      plotText(`${short(r.radius_mm)} mm`, x(r.iteration) + 3, top - 12, 'start'));
  });
  const step = Math.max(1, niceAbove(last / 12));
  for (let i = step; i <= last; i += step) drawn.append(plotText(String(Math.round(i)), x(Math.round(i)), H - bottom + 16, 'middle'));
  drawn.append(plotText('iteration; above: cluster radius', (left + W) / 2, H - 6, 'middle'));
  for (const [key, , colour, dash] of series) {
    drawn.append(svg('path', { d: curve(rows.map((r) => [x(r.iteration), y(r[key])])), fill: 'none', stroke: colour, 'stroke-width': 2.2, 'stroke-dasharray': dash }));
  }
  series.forEach(([, name, colour, dash], k) => {
    const px = W - right - 330 + 150 * k, py = H - 10;
    drawn.append(svg('line', { x1: px, x2: px + 30, y1: py - 4, y2: py - 4, stroke: colour, 'stroke-width': 2.2, 'stroke-dasharray': dash }), plotText(name, px + 36, py, 'start'));
  });
  byId('course').replaceChildren(drawn);
}

const plot = { width: 1100, left: 74, right: 16, top: 14, high: 170, ticks: 70, strip: 16, gap: 22 };

function plotX(time) {
  const last = rows[rows.length - 1].time_s;
  return plot.left + (plot.width - plot.left - plot.right) * (last > 0 ? time / last : 0.5);
}

/* A curve from 0 up to a round number. */
function drawAxis(drawn, key, name, top, height, colour) {
  const most = niceAbove(rows.reduce((m, r) => Math.max(m, r[key] ?? 0), 1e-3)), y = (v) => top + height * (1 - v / most);
  for (const share of [0, 0.5, 1]) {
    drawn.append(svg('line', { x1: plot.left, x2: plot.width - plot.right, y1: y(share * most), y2: y(share * most), stroke: 'var(--line)' }),
      plotText(short(share * most), plot.left - 8, y(share * most) + 4, 'end'));
  }
  const points = rows.map((r) => [plotX(r.time_s), r[key] === null ? null : y(r[key])]);
  drawn.append(plotText(name, plot.left + 4, top - 3, 'start'), svg('path', { d: curve(points), fill: 'none', stroke: colour, 'stroke-width': 2 }));
  if (rows.length > 80) return;
  for (const [x, at] of points) if (at !== null) drawn.append(svg('circle', { cx: x, cy: at, r: 2.6, fill: colour }));
}

/* Runs of frames for which `of` says the same, as boxes with a sign: also read without colours. */
function drawStrip(drawn, name, top, of) {
  const half = rows.length > 1 ? (plotX(rows[rows.length - 1].time_s) - plot.left) / (rows.length - 1) / 2 : 20;
  drawn.append(plotText(name, plot.left - 8, top + 12, 'end'));
  for (let i = 0, k = 0; i < rows.length; i = k) {
    const is = of(rows[i]);
    for (k = i + 1; k < rows.length && of(rows[k]).sign === is.sign; k++);
    const from = Math.max(plot.left, plotX(rows[i].time_s) - half), to = Math.min(plot.width - plot.right, plotX(rows[k - 1].time_s) + half);
    drawn.append(svg('rect', { x: from, y: top, width: Math.max(1.5, to - from), height: plot.strip, fill: is.colour, stroke: 'var(--panel)', 'stroke-width': 0.5 }));
    if (to - from > 12) drawn.append(svg('text', { x: (from + to) / 2, y: top + 12, 'text-anchor': 'middle', class: 'on-strip' }, is.sign));
  }
}

function drawTimes(drawn, y) {
  const last = rows[rows.length - 1].time_s, step = last > 0 ? niceAbove(last / 10) : 1;
  for (let t = 0; t <= last * 1.0001; t += step) drawn.append(plotText(Number(t.toPrecision(6)), plotX(t), y, 'middle'));
  drawn.append(plotText('time, s', (plot.left + plot.width) / 2, y + 18, 'middle'));
}

function drawCurves() {
  const strips = [
    ['verdict', (r) => ({ sign: VERDICTS[r.verdict].sign, colour: `var(--${r.verdict})` })],
    ['settled', (r) => (r.settled ? { sign: '\u2713', colour: 'var(--good)' } : { sign: '\u2013', colour: 'var(--muted)' })],
    ['jumped', (r) => (r.jumped ? { sign: '!', colour: 'var(--failed)' } : { sign: '', colour: 'var(--line)' })],
  ];
  const second = plot.top + plot.high + plot.gap, third = second + plot.ticks + 10, end = third + strips.length * (plot.strip + 4);
  const drawn = svg('svg', { viewBox: `0 0 ${plot.width} ${end + 40}`, role: 'img', 'aria-label': 'residual, ticks, verdict, settled and jumped over time' });
  drawAxis(drawn, 'residual_mm', 'residual, mm', plot.top, plot.high, 'var(--accent)');
  drawAxis(drawn, 'ticks', 'ticks', second, plot.ticks, 'var(--look)');
  strips.forEach(([name, of], i) => drawStrip(drawn, name, third + i * (plot.strip + 4), of));
  drawTimes(drawn, end + 14);
  drawn.append(svg('line', { id: 'now', x1: 0, x2: 0, y1: plot.top - 8, y2: end, stroke: 'var(--text)', 'stroke-width': 1.4, 'stroke-dasharray': '4 3' }));
  drawn.addEventListener('click', (event) => {
    const box = drawn.getBoundingClientRect(), x = (event.clientX - box.left) / (box.width || 1) * plot.width;
    const near = rows.reduce((a, b) => (Math.abs(plotX(b.time_s) - x) < Math.abs(plotX(a.time_s) - x) ? b : a));
    showFrame(nearestShown(near.number));
  });
  byId('curves').replaceChildren(drawn);
}

/* Where the shown frame is in the curves. */
function markFrame() {
  const line = byId('now'), x = plotX(shown[state.frame] / page.fps);
  if (!line) return;
  line.setAttribute('x1', x);
  line.setAttribute('x2', x);
}
