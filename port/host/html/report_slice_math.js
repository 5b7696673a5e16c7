/* report_slice_math.js: planes through the image, what the image has there, and where surfaces cut them. */

const image = page.image === null ? null : { ...page.image, voxels: bytesOf('voxel-bytes') };

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
      corners.push(pick.map((high, c) => (high ? page.scene.high[c] + 10 : page.scene.low[c] - 10)));
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
