/* report_data.js: the report, its structures before and after, its targets, and what the page shows of them. */

const report = JSON.parse(byId('report-data').textContent);

const structures = page.scene.structures.map((from, i) => {
  const n = from.vertices;
  const index = readIndex(from);
  const before = readPoints(from.before, n), after = readPoints(from.after, n);
  const moved = new Float32Array(n);
  for (let k = 0; k < n; k++) {
    moved[k] = Math.hypot(after[3 * k] - before[3 * k], after[3 * k + 1] - before[3 * k + 1], after[3 * k + 2] - before[3 * k + 2]);
  }
  return {
    name: from.name, n, index, place: { before, after }, colour: structureColour(i), visible: true,
    facts: report.per_structure[i],
    values: {
      distance: { before: readValues(from.distance_before, n), after: readValues(from.distance_after, n) },
      expected: { before: null, after: readValues(from.expected, n) },
      moved: { before: moved, after: moved },
    },
  };
});

const targets = page.scene.targets.map((from) => ({
  name: from.name, n: from.vertices, index: readIndex(from), place: readPoints(from.at, from.vertices),
}));

const targetWord = page.image_target ? 'truth' : 'target';

/* What the page shows now. */
const state = {
  when: 'after', blend: 1, colour: 'structure', most: 1, showTarget: false, opacity: 0.35, chosen: -1, point: sceneCentre.slice(),
  outline: { before: true, after: true, target: targets.length > 0 },
};

const COLOURS = {
  structure: { name: 'structure' },
  distance: { name: `distance to the ${targetWord}`, title: `Distance to the ${targetWord}, mm` },
  expected: { name: 'expected error', title: 'Expected error, mm' },
  moved: { name: 'displacement', title: 'Displacement from before to after, mm' },
};
