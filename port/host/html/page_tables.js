/* page_tables.js: verdicts, figures and curves; the tables of settings and inputs. */

const VERDICTS = {
  good: { word: 'good', sign: '\u2713', text: 'Nothing that was measured speaks against this result.' },
  look: { word: 'look at it', sign: '!', text: 'Something speaks against this result. Look at what is listed before you use it.' },
  failed: { word: 'failed', sign: '\u2717', text: 'Do not use this result.' },
};

function verdictMark(level) {
  const verdict = VERDICTS[level] || VERDICTS.look;
  return element('span', { class: level, title: verdict.word }, `${verdict.sign} ${verdict.word}`);
}

function figure(name, value, unitText, more) {
  return element('div', {}, element('dt', {}, name), element('dd', {}, value, unitText ? ` ${unitText}` : '', more ? element('small', {}, more) : null));
}

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

function fillSettings() {
  const only = byId('changed-only').checked, rows = [];
  let group = null;
  for (const s of page.settings) {
    const changed = s.value !== s.default;
    if (only && !changed) continue;
    if (s.group !== group) rows.push(element('tr', { class: 'group' }, element('th', { colspan: 4, scope: 'colgroup' }, s.group)));
    ({ group } = s);
    rows.push(element('tr', { class: changed ? 'changed' : '' }, element('td', {}, s.name),
      element('td', { class: 'text' }, `${s.value}${s.unit ? ` ${s.unit}` : ''}${changed ? ' *' : ''}`), element('td', { class: 'text' }, s.default),
      element('td', { class: 'wrap' }, s.text)));
  }
  if (rows.length === 0) rows.push(element('tr', {}, element('td', { colspan: 4 }, 'All settings are the defaults.')));
  const heads = ['setting', 'value', 'default', 'meaning'].map((name) => element('th', { scope: 'col', class: 'text' }, name));
  byId('settings-table').replaceChildren(element('thead', {}, element('tr', {}, ...heads)), element('tbody', {}, ...rows));
  byId('settings-note').textContent = '* differs from the default. n_workers, n_landmarks and n_target_vertices follow from the machine and the inputs; search and radii that are chosen by the library show as the default.' +
    (page.prepared ? ' The model was prepared before: what it was prepared with is not known here.' : '');
}

/* As it would be typed. */
function commandText() {
  return report.command.map((word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`)).join(' ');
}

function fillInputs() {
  byId('command').textContent = commandText();
  byId('copy').addEventListener('click', () => {
    const range = document.createRange();
    range.selectNodeContents(byId('command'));
    getSelection().removeAllRanges();
    getSelection().addRange(range);
    document.execCommand('copy');
  });
  const heads = ['file', 'bytes', 'CRC-32'].map((name) => element('th', { scope: 'col' }, name));
  byId('inputs-table').append(element('thead', {}, element('tr', {}, ...heads)), element('tbody', {}, ...report.inputs.map((file) =>
    element('tr', {}, element('td', {}, file.path), element('td', {}, String(file.bytes)), element('td', {}, element('code', {}, file.crc32))))));
}
