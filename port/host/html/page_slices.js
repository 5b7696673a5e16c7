/* page_slices.js: slices of the image with the outlines of model and truth, their sliders, window and level. */

const image = page.image ? { ...page.image, voxels: bytesOf(page.image.voxels) } : null;

function cross(a, b) { return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]; }
function unit(a) { const n = Math.hypot(...a) || 1; return a.map((v) => v / n); }
function along(a, b, share) { return a.map((v, c) => v + share * b[c]); }

/* The image's axes as unit vectors, columns of its direction; the patient's own without an image. */
function frameAxes() {
  if (!image) return [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  return [0, 1, 2].map((j) => [0, 1, 2].map((r) => image.direction[3 * r + j]));
}

/* From millimetres to voxels: rows of the inverse of [axis times spacing]. */
const toVoxel = (() => {
  if (!image) return null;
  const [a, b, c] = frameAxes().map((axis, j) => axis.map((v) => v * image.spacing[j]));
  const det = dot(a, cross(b, c));
  return [cross(b, c), cross(c, a), cross(a, b)].map((row) => row.map((v) => v / det));
})();

/* Corners of the image's box, or of the scene's with some room. */
function boxCorners() {
  const corners = [];
  for (let k = 0; k < 8; k++) {
    const pick = [k & 1, k >> 1 & 1, k >> 2];
    if (image) {
      let p = image.first;
      frameAxes().forEach((axis, j) => { p = along(p, axis, (pick[j] * image.size[j] - 0.5) * image.spacing[j]); });
      corners.push(p);
    } else {
      corners.push(pick.map((high, c) => (high ? scene.high[c] + 10 : scene.low[c] - 10)));
    }
  }
  return corners;
}

function rangeOf(points, direction) {
  const all = points.map((p) => dot(p, direction));
  return [Math.min(...all), Math.max(...all)];
}

/* For each axis of the frame, which of the patient's it is most like: 0 left, 1 back, 2 up; each once. */
function anatomicalAxes(axes) {
  const to = [-1, -1, -1], all = [];
  axes.forEach((axis, j) => axis.forEach((v, c) => all.push({ j, c, size: Math.abs(v) })));
  all.sort((p, q) => q.size - p.size);
  for (const { j, c } of all) if (to[j] < 0 && !to.includes(c)) to[j] = c;
  return to;
}

/* A plane: right and down on the screen and the normal are unit vectors, ranges in mm along them; step: of its slider. */
function makePlane(title, right, down, points, step) {
  const normal = cross(right, down);
  return {
    title, right, down, normal, step, rangeRight: rangeOf(points, right), rangeDown: rangeOf(points, down), range: rangeOf(points, normal),
  };
}

/* The three planes along the frame, as a radiologist looks at them: the patient's left is on the right. */
function mainPlanes() {
  const axes = frameAxes(), names = anatomicalAxes(axes), points = boxCorners();
  const axis = (c) => axes[names.indexOf(c)], spacing = (c) => (image ? image.spacing[names.indexOf(c)] : 1);
  const plane = (title, across, downwards, normal) => {
    let right = axis(across), down = axis(downwards);
    if (right[across] < 0) right = right.map((v) => -v);
    if ((downwards === 2) === (down[downwards] > 0)) down = down.map((v) => -v);
    down = unit(along(down, right, -dot(down, right)));
    return makePlane(title, right, down, points, spacing(normal));
  };
  return [plane('axial', 0, 1, 2), plane('coronal', 0, 2, 1), plane('sagittal', 1, 2, 0)];
}

/* The eigenvector of the largest eigenvalue of what spreads points about their mean, by powers of the matrix. */
function longAxis(xyz) {
  const n = xyz.length / 3, mean = [0, 0, 0], m = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  for (let i = 0; i < xyz.length; i++) mean[i % 3] += xyz[i] / n;
  for (let i = 0; i < xyz.length; i += 3) {
    for (let r = 0; r < 3; r++) for (let c = 0; c < 3; c++) m[r][c] += (xyz[i + r] - mean[r]) * (xyz[i + c] - mean[c]);
  }
  let axis = [0.31, 0.22, 0.93];
  for (let k = 0; k < 200; k++) axis = unit(m.map((row) => dot(row, axis)));
  return { mean, axis: axis[2] < 0 ? axis.map((v) => -v) : axis };
}

/* The plane through a structure's long axis, turned about it. */
function planeAlong(s, degrees) {
  const { mean, axis } = longAxis(s.place.after), down = axis.map((v) => -v);
  const side = unit(cross(Math.abs(axis[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0], axis)), front = cross(side, down);
  const angle = degrees * Math.PI / 180;
  const right = unit(side.map((v, c) => Math.cos(angle) * v + Math.sin(angle) * front[c]));
  const points = [];
  for (let i = 0; i < s.n; i++) points.push(s.place.after.subarray(3 * i, 3 * i + 3));
  const plane = { title: 'along', right, down, normal: cross(right, down), step: 1 };
  const widen = ([a, b], by) => [a - by, b + by];
  /* The same width for all angles: the picture turns and does not jump. */
  let radius = 0;
  for (const p of points) radius = Math.max(radius, Math.hypot(...cross(along(p, mean, -1), axis)));
  plane.rangeDown = widen(points.reduce(([a, b], p) => { const d = dot(p, down); return [Math.min(a, d), Math.max(b, d)]; }, [Infinity, -Infinity]), 20);
  /* And not narrower than the canvas is. */
  const half = Math.max(radius + 20, 0.4 * (plane.rangeDown[1] - plane.rangeDown[0])), middle = dot(mean, right);
  plane.rangeRight = [middle - half, middle + half];
  plane.at = dot(mean, plane.normal);
  return plane;
}

/* mm: a place on the plane. */
function placeOn(plane, at, right, down) {
  return [0, 1, 2].map((c) => plane.right[c] * right + plane.down[c] * down + plane.normal[c] * at);
}

/* Voxels of the image on the plane, every mm: {width, height, grey}; 0 outside. Between voxels they are interpolated. */
function sampleImage(plane, at, mm) {
  const width = Math.max(1, Math.ceil((plane.rangeRight[1] - plane.rangeRight[0]) / mm));
  const height = Math.max(1, Math.ceil((plane.rangeDown[1] - plane.rangeDown[0]) / mm));
  const grey = new Uint8ClampedArray(width * height), { size, voxels } = image;
  const voxel = (p) => toVoxel.map((row) => dot(row, along(p, image.first, -1)));
  const start = voxel(placeOn(plane, at, plane.rangeRight[0] + mm / 2, plane.rangeDown[0] + mm / 2));
  const stepRight = toVoxel.map((row) => mm * dot(row, plane.right)), stepDown = toVoxel.map((row) => mm * dot(row, plane.down));
  const [nx, ny, nz] = size, row = nx, slab = nx * ny;
  for (let j = 0, k = 0; j < height; j++) {
    for (let i = 0; i < width; i++, k++) {
      let x = start[0] + i * stepRight[0] + j * stepDown[0], y = start[1] + i * stepRight[1] + j * stepDown[1];
      let z = start[2] + i * stepRight[2] + j * stepDown[2];
      if (x < -0.5 || y < -0.5 || z < -0.5 || x > nx - 0.5 || y > ny - 0.5 || z > nz - 0.5) continue;
      x = Math.max(0, Math.min(nx - 1, x));
      y = Math.max(0, Math.min(ny - 1, y));
      z = Math.max(0, Math.min(nz - 1, z));
      const x0 = Math.min(nx - 1, Math.floor(x)), y0 = Math.min(ny - 1, Math.floor(y)), z0 = Math.min(nz - 1, Math.floor(z));
      const fx = x - x0, fy = y - y0, fz = z - z0;
      const right = x0 + 1 < nx ? 1 : 0, down = y0 + 1 < ny ? row : 0, deep = z0 + 1 < nz ? slab : 0;
      const base = z0 * slab + y0 * row + x0;
      const line = (o) => voxels[o] + fx * (voxels[o + right] - voxels[o]);
      const layer = (o) => { const a = line(o); return a + fy * (line(o + down) - a); };
      const near = layer(base);
      grey[k] = near + fz * (layer(base + deep) - near);
    }
  }
  return { width, height, grey };
}

/* Where a surface cuts a plane: lines of [right, down, right, down ...] in mm. */
function cutSurface(xyz, index, plane, at) {
  const n = xyz.length / 3, height = new Float32Array(n), segments = [], [a0, b0, c0] = plane.normal;
  for (let i = 0; i < n; i++) height[i] = a0 * xyz[3 * i] + b0 * xyz[3 * i + 1] + c0 * xyz[3 * i + 2] - at;
  const point = (i, j) => {
    const share = height[i] / (height[i] - height[j]);
    const p = [0, 1, 2].map((c) => xyz[3 * i + c] + share * (xyz[3 * j + c] - xyz[3 * i + c]));
    return [dot(p, plane.right), dot(p, plane.down)];
  };
  for (let t = 0; t < index.length; t += 3) {
    const corner = [index[t], index[t + 1], index[t + 2]], cuts = [];
    const above = corner.map((i) => height[i] >= 0);
    if (above[0] === above[1] && above[1] === above[2]) continue;
    for (let k = 0; k < 3; k++) {
      const i = Math.min(corner[k], corner[(k + 1) % 3]), j = Math.max(corner[k], corner[(k + 1) % 3]);
      if ((height[i] >= 0) !== (height[j] >= 0)) cuts.push({ key: i * n + j, at: point(i, j) });
    }
    segments.push(cuts);
  }
  return chain(segments);
}

/* Puts segments together that share an edge of the surface. */
function chain(segments) {
  const at = new Map(), used = new Uint8Array(segments.length), lines = [];
  segments.forEach((cuts, i) => cuts.forEach(({ key }) => { const list = at.get(key); if (list) list.push(i); else at.set(key, [i]); }));
  const follow = (line, key, push) => {
    for (;;) {
      const next = at.get(key).find((i) => !used[i]);
      if (next === undefined) return;
      used[next] = 1;
      const other = segments[next][0].key === key ? segments[next][1] : segments[next][0];
      push(line, other.at);
      ({ key } = other);
    }
  };
  segments.forEach((cuts, i) => {
    if (used[i]) return;
    used[i] = 1;
    const line = [cuts[0].at, cuts[1].at];
    follow(line, cuts[1].key, (l, p) => l.push(p));
    follow(line, cuts[0].key, (l, p) => l.unshift(p));
    lines.push(line.flat());
  });
  return lines;
}

/* Told apart by dashes as well as by colour. */
const OUTLINES = {
  before: { name: 'before', colour: '#ff7ad9', dash: [7, 5], width: 1.5 },
  after: { name: 'after', colour: '#ffc233', dash: [], width: 2 },
  target: { name: targetWord, colour: '#43d0ff', dash: [1, 4], width: 2.2 },
};

const slices = [];
/* Its own tests read pixels often; then the browser is not to keep them on the graphics card. */
const READ_OFTEN = { willReadFrequently: location.hash === '#selftest' };
const grey = { low: image ? image.low : 0, high: image ? image.high : 1, level: 0, window: 1 };

function makeSlice(plane) {
  const slice = { plane, at: 0, sampled: null, sampledFor: '' };
  slice.title = element('strong', {}, plane.title);
  slice.value = element('span', { class: 'muted' });
  slice.canvas = element('canvas', { tabindex: '0', role: 'img', 'aria-label': `${plane.title} slice` });
  slice.slider = element('input', { type: 'range', 'aria-label': `place of the ${plane.title} slice` });
  slice.extra = element('span', {});
  slice.box = element('div', { class: 'slice' },
    element('div', { class: 'title' }, element('span', {}, slice.title, ' ', slice.extra), slice.value), slice.canvas, slice.slider);
  slice.slider.addEventListener('input', () => moveSlice(slice, Number(slice.slider.value)));
  slice.canvas.addEventListener('keydown', (event) => stepSlice(slice, event));
  slice.canvas.addEventListener('wheel', (event) => {
    if (!event.ctrlKey && document.activeElement !== slice.canvas) return;
    event.preventDefault();
    moveSlice(slice, Number(slice.slider.value) + Math.sign(event.deltaY) * Number(slice.slider.step));
  }, { passive: false });
  slice.canvas.addEventListener('click', (event) => clickSlice(slice, event));
  slices.push(slice);
  return slice;
}

function setSlider(slider, low, high, step, value) {
  slider.min = low;
  slider.max = high;
  slider.step = step;
  slider.value = value;
}

function stepSlice(slice, event) {
  const step = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[event.key];
  if (step === undefined) return;
  event.preventDefault();
  moveSlice(slice, Number(slice.slider.value) + step * Number(slice.slider.step));
}

/* By its slider: places of a main plane, degrees of the one along a structure. */
function moveSlice(slice, value) {
  const held = Math.max(Number(slice.slider.min), Math.min(Number(slice.slider.max), value));
  slice.slider.value = held;
  if (slice.along) {
    slice.degrees = held;
    slice.plane = planeAlong(structures[slice.structure], held);
    slice.at = slice.plane.at;
  } else {
    slice.at = held;
    const shift = held - dot(state.point, slice.plane.normal);
    state.point = along(state.point, slice.plane.normal, shift);
  }
  redraw('slices', 'view');
}

/* The main planes go through a point, or as near as the layers of the image are. */
function slicesTo(point) {
  state.point = Array.from(point);
  for (const slice of slices) {
    if (slice.along) continue;
    slice.slider.value = dot(state.point, slice.plane.normal);
    slice.at = Number(slice.slider.value);
  }
  redraw('slices', 'view');
}

function chooseAlong(which) {
  const slice = slices.find((s) => s.along);
  slice.structure = which;
  slice.select.value = String(which);
  moveSlice(slice, Number(slice.slider.value));
}

/* How the plane lies in the canvas: pixels per mm, and where its corner is. */
function layoutOf(slice) {
  const { canvas, plane } = slice, wide = plane.rangeRight[1] - plane.rangeRight[0], high = plane.rangeDown[1] - plane.rangeDown[0];
  const scale = Math.min(canvas.width / wide, canvas.height / high);
  return { scale, x: 0.5 * (canvas.width - scale * wide), y: 0.5 * (canvas.height - scale * high), wide, high };
}

function clickSlice(slice, event) {
  const box = slice.canvas.getBoundingClientRect(), to = layoutOf(slice), ratio = slice.canvas.width / box.width;
  const right = slice.plane.rangeRight[0] + ((event.clientX - box.left) * ratio - to.x) / to.scale;
  const down = slice.plane.rangeDown[0] + ((event.clientY - box.top) * ratio - to.y) / to.scale;
  const point = placeOn(slice.plane, slice.at, right, down);
  state.pointed = true;
  slicesTo(point);
  readNearest(point);
}

/* The pixels of the image, sampled anew when the plane moved. */
function sampled(slice) {
  const { plane } = slice, key = [...plane.normal, ...plane.right, slice.at, ...plane.rangeRight, ...plane.rangeDown].join();
  if (slice.sampledFor !== key) {
    const wide = Math.max(plane.rangeRight[1] - plane.rangeRight[0], plane.rangeDown[1] - plane.rangeDown[0]);
    const mm = Math.max(wide / 600, Math.min(...image.spacing));
    slice.sampled = { mm, ...sampleImage(plane, slice.at, mm) };
    slice.sampledFor = key;
  }
  return slice.sampled;
}

function drawGrey(slice, c, to) {
  const { width, height, mm, grey: from } = sampled(slice);
  const picture = new ImageData(width, height), table = new Uint8Array(256);
  for (let v = 0; v < 256; v++) {
    const value = grey.low + v / 255 * (grey.high - grey.low);
    table[v] = Math.max(0, Math.min(255, 255 * ((value - grey.level) / grey.window + 0.5)));
  }
  for (let i = 0, k = 0; i < from.length; i++, k += 4) {
    picture.data[k] = picture.data[k + 1] = picture.data[k + 2] = table[from[i]];
    picture.data[k + 3] = 255;
  }
  slice.room = slice.room || document.createElement('canvas');
  [slice.room.width, slice.room.height] = [width, height];
  slice.room.getContext('2d').putImageData(picture, 0, 0);
  c.imageSmoothingEnabled = true;
  c.imageSmoothingQuality = 'high';
  c.drawImage(slice.room, to.x, to.y, to.scale * mm * width, to.scale * mm * height);
}

/* One kind of outline: a dark one below makes it readable on any grey. */
function drawOutline(slice, c, to, lines, kind, chosen, unitPixel) {
  const path = new Path2D();
  for (const line of lines) {
    for (let i = 0; i < line.length; i += 2) {
      const x = to.x + to.scale * (line[i] - slice.plane.rangeRight[0]), y = to.y + to.scale * (line[i + 1] - slice.plane.rangeDown[0]);
      if (i === 0) path.moveTo(x, y);
      else path.lineTo(x, y);
    }
  }
  const width = kind.width * (chosen ? 1.8 : 1) * unitPixel;
  c.lineJoin = 'round';
  c.lineCap = kind.dash[0] === 1 ? 'round' : 'butt';
  c.setLineDash([]);
  c.globalAlpha = 0.45;
  c.strokeStyle = '#000';
  c.lineWidth = width + 1.6 * unitPixel;
  if (image && kind.dash.length === 0) c.stroke(path);
  c.globalAlpha = 1;
  c.setLineDash(kind.dash.map((d) => d * unitPixel));
  c.strokeStyle = kind.colour;
  c.lineWidth = width;
  c.stroke(path);
  c.setLineDash([]);
}

function drawOutlines(slice, c, to, unitPixel) {
  const { plane, at } = slice;
  const model = { before: state.outline.before, after: state.outline.after };
  if (blinking.timer !== 0) model.before = !(model.after = state.when === 'after');
  if (state.outline.target) {
    targets.forEach((t, i) => {
      if (targetVisible(i)) drawOutline(slice, c, to, cutSurface(t.place, t.index, plane, at), OUTLINES.target, false, unitPixel);
    });
  }
  for (const kind of ['before', 'after']) {
    if (!model[kind]) continue;
    structures.forEach((s, i) => {
      if (s.visible) drawOutline(slice, c, to, cutSurface(s.place[kind], s.index, plane, at), OUTLINES[kind], i === state.chosen, unitPixel);
    });
  }
}

function drawSlice(slice) {
  const { canvas, plane } = slice, unitPixel = fitCanvas(canvas), c = canvas.getContext('2d', READ_OFTEN), to = layoutOf(slice);
  c.setTransform(1, 0, 0, 1, 0, 0);
  c.fillStyle = image ? '#000' : '#14191e';
  c.fillRect(0, 0, canvas.width, canvas.height);
  c.save();
  c.beginPath();
  c.rect(to.x, to.y, to.scale * to.wide, to.scale * to.high);
  c.clip();
  if (image) drawGrey(slice, c, to);
  drawOutlines(slice, c, to, unitPixel);
  c.restore();
  c.unit = unitPixel;
  c.font = `600 ${13 * unitPixel}px system-ui, sans-serif`;
  c.fillStyle = '#fff';
  c.strokeStyle = '#000';
  c.lineWidth = 3 * unitPixel;
  const minus = (d) => d.map((v) => -v), { width, height } = canvas;
  drawText(c, letters(minus(plane.right)), 6 * unitPixel, height / 2, 'left', 'middle');
  drawText(c, letters(plane.right), width - 6 * unitPixel, height / 2, 'right', 'middle');
  drawText(c, letters(minus(plane.down)), width / 2, 5 * unitPixel, 'center', 'top');
  drawText(c, letters(plane.down), width / 2, height - 5 * unitPixel, 'center', 'bottom');
  c.font = `${12 * unitPixel}px system-ui, sans-serif`;
  drawBar(c, width - 10 * unitPixel, height - 10 * unitPixel, 1 / to.scale, width * 0.28);
  if (state.pointed && Math.abs(dot(state.point, plane.normal) - slice.at) < 2) {
    drawCross(c, to.x + to.scale * (dot(state.point, plane.right) - plane.rangeRight[0]),
      to.y + to.scale * (dot(state.point, plane.down) - plane.rangeDown[0]), unitPixel);
  }
  tellSlice(slice);
}

/* Where it is, in the letters of its direction. */
function tellSlice(slice) {
  if (slice.along) {
    slice.value.textContent = `turned ${slice.degrees}\u00b0`;
    return;
  }
  const c = [0, 1, 2].sort((a, b) => Math.abs(slice.plane.normal[b]) - Math.abs(slice.plane.normal[a]))[0];
  const value = slice.at * slice.plane.normal[c];
  slice.value.textContent = `${'LPS'[c]} ${digits(value, 1)} mm`;
}

function windowText() {
  byId('level-value').textContent = short(grey.level);
  byId('window-value').textContent = short(grey.window);
}

function resetWindow() {
  grey.level = 0.5 * (grey.low + grey.high);
  grey.window = grey.high - grey.low;
  const step = (grey.high - grey.low) / 256;
  setSlider(byId('level'), grey.low, grey.high, step, grey.level);
  setSlider(byId('window'), step, 1.5 * grey.window, step, grey.window);
  windowText();
}

function startWindow() {
  for (const made of document.querySelectorAll('.windowing')) made.hidden = !image;
  if (!image) {
    for (const made of document.querySelectorAll('.windowing')) made.style.display = 'none';
    return;
  }
  resetWindow();
  byId('level').addEventListener('input', () => { grey.level = Number(byId('level').value); windowText(); redraw('slices'); });
  byId('window').addEventListener('input', () => { grey.window = Number(byId('window').value); windowText(); redraw('slices'); });
  byId('window-reset').addEventListener('click', () => { resetWindow(); redraw('slices'); });
}

function startOutlines() {
  for (const [kind, { name, colour, dash }] of Object.entries(OUTLINES)) {
    if (kind === 'target' && targets.length === 0) continue;
    const box = element('input', { type: 'checkbox', id: `outline-${kind}` });
    box.checked = state.outline[kind];
    box.addEventListener('change', () => { state.outline[kind] = box.checked; redraw('slices'); });
    const style = dash.length === 0 ? 'solid' : dash[0] === 1 ? 'dotted' : 'dashed';
    byId('outline-switches').append(element('label', { class: 'inline' }, box, ` ${name} `,
      element('span', { class: 'key', style: `border-top-style:${style};border-color:${colour}` })));
  }
}

function startAlong() {
  const slice = makeSlice({ title: 'along', normal: [1, 0, 0] });
  slice.along = true;
  slice.degrees = 0;
  slice.select = element('select', { 'aria-label': 'structure that the slice lies along' },
    ...structures.map((s, i) => element('option', { value: i }, s.name)));
  slice.select.addEventListener('change', () => chooseAlong(Number(slice.select.value)));
  slice.extra.append(slice.select);
  setSlider(slice.slider, 0, 180, 1, 0);
  slice.slider.setAttribute('aria-label', 'turns the slice along the structure');
  const largest = structures.reduce((best, s, i) => (s.n > structures[best].n ? i : best), 0);
  chooseAlong(largest);
}

function startSlices() {
  startWindow();
  startOutlines();
  for (const plane of mainPlanes()) {
    const slice = makeSlice(plane), [low, high] = plane.range;
    const first = image ? low + 0.5 * plane.step : low;
    setSlider(slice.slider, first, high, plane.step, dot(state.point, plane.normal));
    slice.at = Number(slice.slider.value);
  }
  startAlong();
  byId('slice-grid').append(...slices.map((s) => s.box));
  tellSliceNote();
}

function tellSliceNote() {
  const note = byId('slice-note');
  if (!image) {
    note.textContent = 'No image: outlines of the surfaces in planes of the patient\u2019s axes. Click to read values; arrow keys move a slice.';
    return;
  }
  const sides = (v) => v.map((s) => digits(s, 2)).join(' \u00d7 ');
  const coarse = image.spacing.some((s, j) => s > 1.01 * image.whole_spacing[j]);
  note.textContent = `${image.path}: ${image.whole_size.join(' \u00d7 ')} voxels of ${sides(image.whole_spacing)} mm. Here what lies around the model` +
    `${coarse ? `, as means in voxels of ${sides(image.spacing)} mm` : ', voxel by voxel'}, in 256 greys from ${short(image.low)} to ${short(image.high)}. ` +
    'Click to read values; arrow keys move a slice, as the wheel does once it is clicked.';
}
