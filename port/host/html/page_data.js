/* page_data.js: reads the data of a page: numbers and surfaces; texts, colours, elements. */

const page = JSON.parse(document.getElementById('page-data').textContent);

function byId(id) { return document.getElementById(id); }

/* An element with attributes and children; texts become text, never markup. */
function element(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (typeof value === 'function') made.addEventListener(key, value);
    else if (value !== undefined && value !== false) made.setAttribute(key, value === true ? '' : value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined).map((child) =>
    child instanceof Node ? child : String(child)));
  return made;
}

function svg(name, attributes, ...children) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes || {})) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/* A number with so many digits after the point; a dash for none. */
function digits(value, n = 2) {
  return typeof value === 'number' && Number.isFinite(value) ? value.toFixed(n) : '\u2013';
}

/* With three digits that count. */
function short(value) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '\u2013';
  const size = Math.abs(value);
  return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 0.1 || size === 0 ? 2 : 3);
}

/* Numbers come as base64 of little-endian bytes, which is every browser's order. */
function bytesOf(base64) {
  const text = atob(base64), out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) out[i] = text.charCodeAt(i);
  return out;
}

function wordsOf(base64) { return new Uint16Array(bytesOf(base64).buffer); }

function readPoints({ low, high, at }) {
  return Float32Array.from(wordsOf(at), (v, i) => low[i % 3] + v / 65535 * (high[i % 3] - low[i % 3]));
}

function readIndex(mesh) {
  return mesh.vertices <= 65536 ? Uint32Array.from(wordsOf(mesh.index)) : new Uint32Array(bytesOf(mesh.index).buffer);
}

/* Values of vertices, mm; -1 where they are not known. */
function readValues({ unit, at }) {
  return Float32Array.from(wordsOf(at), (v) => (v === 65535 ? -1 : v * unit));
}

/* Normals of vertices: sums over their triangles, which weighs them by area. */
function normalsOf(xyz, index) {
  const out = new Float32Array(xyz.length);
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [3 * index[t], 3 * index[t + 1], 3 * index[t + 2]];
    const ux = xyz[b] - xyz[a], uy = xyz[b + 1] - xyz[a + 1], uz = xyz[b + 2] - xyz[a + 2];
    const vx = xyz[c] - xyz[a], vy = xyz[c + 1] - xyz[a + 1], vz = xyz[c + 2] - xyz[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (const k of [a, b, c]) {
      out[k] += nx;
      out[k + 1] += ny;
      out[k + 2] += nz;
    }
  }
  for (let i = 0; i < out.length; i += 3) {
    const length = Math.hypot(out[i], out[i + 1], out[i + 2]) || 1;
    out[i] /= length;
    out[i + 1] /= length;
    out[i + 2] /= length;
  }
  return out;
}

/* Colours that differ, for any number of structures: hues by the golden angle, three lightnesses. */
function structureColour(i) {
  const hue = (i * 137.508 + 25) % 360, light = [0.62, 0.5, 0.72][i % 3], chroma = 0.3 * (1 - Math.abs(2 * light - 1));
  return [0, 8, 4].map((k) => {
    const part = (k + hue / 30) % 12;
    return light - chroma * Math.max(-1, Math.min(part - 3, 9 - part, 1));
  });
}

function cssColour(rgb) { return `rgb(${rgb.map((c) => Math.round(255 * c)).join(',')})`; }

/* Mean, 95th percentile and maximum of what is known, over vertices; null when nothing is. */
function statistics(list) {
  const known = [];
  for (const values of list) if (values) for (const v of values) if (v >= 0) known.push(v);
  if (known.length === 0) return null;
  const sorted = Float32Array.from(known).sort();
  const at = (share) => sorted[Math.min(sorted.length - 1, Math.ceil(share * sorted.length) - 1)];
  return { n: sorted.length, mean: sorted.reduce((a, b) => a + b, 0) / sorted.length, p95: at(0.95), max: at(1) };
}

function largestAt(values) {
  let best = 0;
  for (let i = 1; i < values.length; i++) if (values[i] > values[best]) best = i;
  return best;
}

/* The box of what is shown. */
const { frames = [], targets: pageTargets = [] } = page;
const boxes = [...frames.flatMap((f) => [...f.places, ...(f.target || [])]), ...pageTargets.map((t) => t.place)].filter((p) => p.at);
const scene = { low: [0, 1, 2].map((c) => Math.min(...boxes.map((p) => p.low[c]))), high: [0, 1, 2].map((c) => Math.max(...boxes.map((p) => p.high[c]))) };
const sceneSides = scene.low.map((low, c) => scene.high[c] - low);
const sceneCentre = scene.low.map((low, c) => 0.5 * (low + scene.high[c]));
const sceneSide = Math.max(...sceneSides) || 1;
const sceneRadius = 0.5 * Math.hypot(...sceneSides) || 1;

/* Light to dark with even steps, so that it reads in grey, too; what is small is pale. After magma (S. van der Walt,
 * N. Smith, 2015), without its darkest part, in which shading would be lost. */
const MAP = [[250, 242, 215], [254, 215, 160], [254, 183, 127], [251, 148, 104], [241, 107, 92], [214, 69, 108], [174, 51, 123], [131, 38, 129], [82, 19, 124]];
function mapColour(share) {
  const at = Math.max(0, Math.min(1, share)) * (MAP.length - 1);
  const k = Math.min(MAP.length - 2, Math.floor(at));
  return MAP[k].map((c, i) => c + (at - k) * (MAP[k + 1][i] - c));
}

/* The nearest of 1, 2, 5 times a power of ten that is not above. */
function niceBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].map((k) => k * power).find((v) => v <= value * 1.0001) || power;
}
function niceAbove(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 1.5, 2, 3, 5, 7.5, 10].map((k) => k * power).find((v) => v >= value * 0.9999) || 10 * power;
}

/* Where a direction leads in the patient: "L", "PI". Coordinates are LPS. */
function letters(d) {
  return [0, 1, 2].filter((c) => Math.abs(d[c]) > 0.4).sort((a, b) => Math.abs(d[b]) - Math.abs(d[a])).slice(0, 2)
    .map((c) => (d[c] > 0 ? 'LPS' : 'RAI')[c]).join('');
}
