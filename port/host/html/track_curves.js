/* track_curves.js: residual and ticks over the frames; strips of verdicts, of what did not settle, and of jumps. */

const plot = { width: 1100, left: 74, right: 16, top: 14, high: 170, ticks: 70, strip: 16, gap: 22 };

function plotX(time) {
  const last = rows[rows.length - 1].time_s;
  return plot.left + (plot.width - plot.left - plot.right) * (last > 0 ? time / last : 0.5);
}

function plotText(string, x, y, anchor) { return svg('text', { x, y, 'text-anchor': anchor }, string); }

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
