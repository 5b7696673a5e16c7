/* page_model.js: the structures and targets of a registration or of a tracking run, and what the page shows of them. */

const { report } = page;
const isTrack = page.kind === 'track';
const { rows = [] } = page; /* a tracking run's table */
const shown = frames.map((f) => f.number); /* the numbers of the frames that the view has */

/* How far each vertex is from where it was before, mm. */
function movedFrom(before, after) {
  return Float32Array.from({ length: before.length / 3 }, (_, k) => Math.hypot(after[3 * k] - before[3 * k], after[3 * k + 1] - before[3 * k + 1], after[3 * k + 2] - before[3 * k + 2]));
}

/* Before and after of a registration; the first and the shown frame of a tracking run. */
const structures = (page.structures || []).map((from, i) => {
  const before = readPoints(frames[0].places[i]), after = isTrack ? before : readPoints(frames[1].places[i]), moved = movedFrom(before, after);
  const values = { moved: { before: moved, after: moved } };
  if (!isTrack) {
    values.distance = { before: readValues(from.distance_before), after: readValues(from.distance_after) };
    values.expected = { before: null, after: readValues(from.expected) };
  }
  return { name: from.name, n: from.vertices, index: readIndex(from), place: { before, after }, colour: structureColour(i), visible: true, facts: report.per_structure?.[i], values };
});

/* A tracking run has one cloud: points of the target in the shown frame. */
const targets = isTrack ? [{ name: 'target', n: 0, index: new Uint32Array(0), place: new Float32Array(0) }] :
  pageTargets.map((from) => ({ name: from.name, path: from.path, n: from.vertices, index: readIndex(from), place: readPoints(from.place) }));

const targetWord = page.image_target ? 'truth' : 'target';

/* What the page shows now. */
const state = {
  when: 'after', blend: 1, colour: 'structure', most: 1, showTarget: false, opacity: isTrack ? 1 : 0.35, chosen: -1, point: sceneCentre.slice(), frame: 0,
  outline: { before: true, after: true, target: targets.length > 0 },
};

const COLOURS = { structure: { name: 'structure' } };
if (!isTrack) {
  COLOURS.distance = { name: `distance to the ${targetWord}`, title: `Distance to the ${targetWord}, mm` };
  COLOURS.expected = { name: 'expected error', title: 'Expected error, mm' };
}
COLOURS.moved = { name: 'displacement', title: isTrack ? 'Displacement from the first frame, mm' : 'Displacement from before to after, mm' };

/* The values that a colour's range is chosen from; of a tracking run four frames, evenly spread. */
function allValues(colour) {
  if (!isTrack) return structures.map((s) => s.values[colour].after);
  const some = [1, 2, 3, 4].map((k) => Math.floor((k * (shown.length - 1)) / 4));
  return structures.flatMap((s, i) => some.map((k) => movedFrom(s.place.before, readPoints(frames[k].places[i]))));
}

/* The index of the entry whose number is nearest. */
function nearestIndex(list, number) {
  return list.reduce((best, one, k) => (Math.abs(one - number) < Math.abs(list[best] - number) ? k : best), 0);
}

/* Rows stand for several frames when there are very many. */
function rowOf(number) { return rows[nearestIndex(rows.map((row) => row.number), number)]; }
function nearestShown(number) { return nearestIndex(shown, number); }

function isDoubtful(row) { return row.verdict !== 'good' || row.jumped || !row.settled; }
