/* page_cohort.js: many results: a card for each, those that somebody must look at first, with a picture of its surfaces. */

const RANKS = {
  missing: 'these have no report: not computed, or not to the end',
  unreadable: 'these reports are damaged or of another version',
  failed: 'these cannot be relied on',
  look: 'somebody should look at these',
  good: 'nothing speaks against these',
};

/* The surfaces seen from the front: x to the right, z up; hidden parts removed, in greys. Structures whose verdict is not
 * good are hatched, so that they show in black and white, too. */
function drawPicture(surfaces) {
  const W = 192, H = 320, canvas = element('canvas', { width: W, height: H, role: 'img', 'aria-label': 'the surfaces from the front' });
  const places = surfaces.map((s) => s.place), low = (c) => Math.min(...places.map((p) => p.low[c])), high = (c) => Math.max(...places.map((p) => p.high[c]));
  const scale = Math.min((W - 8) / Math.max(high(0) - low(0), 1e-3), (H - 8) / Math.max(high(2) - low(2), 1e-3));
  const depth = new Float32Array(W * H).fill(Infinity), part = new Int16Array(W * H).fill(-1), tone = new Uint8Array(W * H);
  surfaces.forEach((surface, which) => {
    const xyz = readPoints(surface.place), index = readIndex(surface);
    const at = (v) => [W / 2 + scale * (xyz[3 * v] - (low(0) + high(0)) / 2), H / 2 - scale * (xyz[3 * v + 2] - (low(2) + high(2)) / 2), scale * xyz[3 * v + 1]];
    for (let t = 0; t < index.length; t += 3) fillTriangle([at(index[t]), at(index[t + 1]), at(index[t + 2])], which);
  });
  /* Light from the upper left behind the viewer, on either side of a triangle. */
  function fillTriangle([a, b, c], which) {
    const u = b.map((v, k) => v - a[k]), v = c.map((w, k) => w - a[k]), n = unit(cross(u, v)), area = u[0] * v[1] - u[1] * v[0];
    const light = Math.max(0, (n[2] > 0 ? -1 : 1) * dot(n, [-0.45, -0.45, -0.77]));
    if (area === 0) return;
    const edge = (p, q, x, y) => ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) / area;
    const ys = [a[1], b[1], c[1]], xs = [a[0], b[0], c[0]];
    for (let y = Math.max(0, Math.floor(Math.min(...ys))); y <= Math.min(H - 1, Math.max(...ys)); y++) {
      for (let x = Math.max(0, Math.floor(Math.min(...xs))); x <= Math.min(W - 1, Math.max(...xs)); x++) {
        const p = edge(b, c, x + 0.5, y + 0.5), q = edge(c, a, x + 0.5, y + 0.5), r = 1 - p - q, near = p * a[2] + q * b[2] + r * c[2], k = y * W + x;
        if (p < 0 || q < 0 || r < 0 || near >= depth[k]) continue;
        depth[k] = near;
        part[k] = which;
        tone[k] = 110 + 125 * light;
      }
    }
  }
  const picture = new ImageData(W, H), other = (k, j) => part[k] !== part[j];
  for (let k = 0; k < W * H; k++) {
    if (part[k] < 0) continue;
    const x = k % W, y = Math.floor(k / W), level = surfaces[part[k]].level, line = other(k, k + 1) || other(k, k + W) || other(k, k - 1) || other(k, k - W);
    const hatch = (level === 'failed' && (x + y) % 6 < 2) || (level === 'look' && (x + y) % 12 < 2);
    picture.data.set([...Array(3).fill(line || hatch ? 17 : tone[k]), 255], 4 * k);
  }
  canvas.getContext('2d').putImageData(picture, 0, 0);
  return canvas;
}

function cardOf(one) {
  const facts = element('dl', {}), add = (name, value) => value !== null && value !== undefined && facts.append(element('dt', {}, name), element('dd', {}, value));
  const mm = (value) => (value === null ? null : `${Number(value.toPrecision(3))} mm`);
  if ('iterations' in one) {
    add('expected error', mm(one.expected_error_mm));
    add('mean distance to', mm(one.mean_to_mm));
    add('mean distance from', mm(one.mean_from_mm));
    add('largest distance', mm(one.hausdorff_mm));
    add('look first at', one.worst);
    add('folds', one.folds > 0 ? one.folds : null);
    add('iterations', one.iterations);
  }
  const link = one.link && one.link.split('/').map(encodeURIComponent).join('/');
  return element('article', { class: `card ${one.verdict}` },
    element('div', {}, one.surfaces && one.surfaces.length > 0 ? drawPicture(one.surfaces) : element('span', { class: 'none' }, 'no surfaces')),
    element('div', {}, element('h3', {}, link ? element('a', { href: link }, one.path) : one.path), element('span', { class: 'mark' }, one.verdict),
      facts, element('ul', {}, ...one.reasons.map((text) => element('li', {}, text)))));
}

function tellCohort() {
  byId('page-title').textContent = document.title = `smr: ${page.cases.length} results`;
  byId('page-line').textContent = `smr ${page.version}`;
  for (const [rank, meaning] of Object.entries(RANKS)) {
    const of = page.cases.filter((one) => one.verdict === rank);
    if (of.length === 0) continue;
    byId('rank-links').append(element('a', { href: `#${rank}` }, `${of.length} ${rank}`), ' ');
    byId('ranks').append(element('section', { id: rank }, element('h2', {}, `${rank}: ${of.length}; ${meaning}`), element('div', { class: 'cards' }, ...of.map(cardOf))));
  }
}
