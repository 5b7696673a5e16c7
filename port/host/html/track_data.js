/* track_data.js: the frames of a tracking run, the model in those that are shown, and what the page shows of them. */

const report = page;
const { rows } = page;
const shown = page.scene.frames;
const slices = [];

/* Positions are read when a frame is shown. */
const structures = page.scene.structures.map((from, i) => {
  const n = from.vertices, first = readPoints(from.at[0], n), still = new Float32Array(n);
  return {
    name: from.name, n, index: readIndex(from), at: from.at, place: { before: first, after: first }, colour: structureColour(i), visible: true,
    values: { moved: { before: still, after: still } },
  };
});

/* A cloud: points of the target in the frame that is shown. */
const targets = [{ name: 'target', n: 0, index: new Uint32Array(0), place: new Float32Array(0) }];
const targetWord = 'target';

const state = {
  when: 'after', blend: 1, colour: 'structure', most: 1, showTarget: false, opacity: 1, chosen: -1, point: sceneCentre.slice(), frame: 0,
};

const COLOURS = {
  structure: { name: 'structure' },
  moved: { name: 'displacement', title: 'Displacement from the first frame, mm' },
};

/* How far each vertex is from where it was in the first frame. */
function movedAt(s, place) {
  const out = new Float32Array(s.n), { before } = s.place;
  for (let k = 0; k < s.n; k++) out[k] = Math.hypot(place[3 * k] - before[3 * k], place[3 * k + 1] - before[3 * k + 1], place[3 * k + 2] - before[3 * k + 2]);
  return out;
}

/* Four frames, evenly spread, stand for all. */
function allValues() {
  const some = [1, 2, 3, 4].map((k) => Math.floor((k * (shown.length - 1)) / 4));
  return structures.flatMap((s) => some.map((k) => movedAt(s, readPoints(s.at[k], s.n))));
}

/* The row of a shown frame: rows stand for several frames when there are very many. */
function rowOf(number) {
  let best = 0;
  rows.forEach((row, i) => { if (Math.abs(row.number - number) < Math.abs(rows[best].number - number)) best = i; });
  return rows[best];
}

/* Which of the shown frames is nearest to a frame. */
function nearestShown(number) {
  let best = 0;
  shown.forEach((one, k) => { if (Math.abs(one - number) < Math.abs(shown[best] - number)) best = k; });
  return best;
}

function isDoubtful(row) { return row.verdict !== 'good' || row.jumped || !row.settled; }
