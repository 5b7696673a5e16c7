/* page_selftest.js: with #selftest behind its address a page tests itself and writes what came of it. */

const selftest = { errors: [], lines: [], failed: 0 };
window.addEventListener('error', (event) => selftest.errors.push(event.message));
window.addEventListener('unhandledrejection', (event) => selftest.errors.push(String(event.reason)));

function expect(name, good) {
  selftest.lines.push(`${good ? 'ok' : 'not ok'} ${name}`);
  selftest.failed += good ? 0 : 1;
}

/* All pixels of the 3D view, as they are after drawing. */
function viewPixels() {
  drawView();
  const gl = view.gl, pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return pixels;
}

function slicePixels(slice) {
  drawSlice(slice);
  return slice.canvas.getContext('2d').getImageData(0, 0, slice.canvas.width, slice.canvas.height).data;
}

/* How many pixels differ by more than a little. */
function different(a, b) {
  let n = a.length === b.length ? 0 : Infinity;
  for (let i = 0; i < a.length; i += 4) {
    if (Math.abs(a[i] - b[i]) + Math.abs(a[i + 1] - b[i + 1]) + Math.abs(a[i + 2] - b[i + 2]) > 12) n++;
  }
  return n;
}

function press(target, key, shiftKey = false) {
  target.dispatchEvent(new KeyboardEvent('keydown', { key, shiftKey, bubbles: true, cancelable: true }));
}

function change(control, value) {
  if (control.type === 'checkbox' || control.type === 'radio') control.checked = value;
  else control.value = value;
  control.dispatchEvent(new Event('input', { bubbles: true }));
  control.dispatchEvent(new Event('change', { bubbles: true }));
}

/* Does something, looks whether the view changed, undoes it and looks whether it is as before. */
function changesView(name, act, undo) {
  const before = viewPixels();
  act();
  const then = viewPixels();
  expect(`${name} changes the view`, different(before, then) > 20);
  undo();
  expect(`${name}: and back`, different(before, viewPixels()) === 0);
}

function testMoves() {
  const canvas = byId('gl');
  changesView('an arrow', () => press(canvas, 'ArrowRight'), () => press(canvas, 'ArrowLeft'));
  changesView('Shift and an arrow', () => press(canvas, 'ArrowUp', true), () => press(canvas, '0'));
  changesView('plus', () => press(canvas, '+'), () => press(canvas, '0'));
  for (const letter of ['P', 'L', 'S']) changesView(`looking from ${letter}`, () => press(canvas, letter), () => press(canvas, 'A'));
  const drag = (from, to, type, id) => {
    const send = (name, [x, y]) => canvas.dispatchEvent(new PointerEvent(name, { pointerId: id, pointerType: type, clientX: x, clientY: y, buttons: 1, bubbles: true }));
    send('pointerdown', from);
    send('pointermove', to);
    send('pointerup', to);
  };
  changesView('a drag', () => drag([200, 200], [260, 230], 'mouse', 1), () => press(canvas, 'A'));
  changesView('a finger', () => drag([200, 200], [150, 200], 'touch', 7), () => press(canvas, 'A'));
  changesView('the wheel', () => canvas.dispatchEvent(new WheelEvent('wheel', { deltaY: 240, cancelable: true })), () => press(canvas, '0'));
}

function testColours() {
  const seen = [];
  for (const option of byId('colour').options) {
    change(byId('colour'), option.value);
    const pixels = viewPixels();
    expect(`colour: ${option.value} differs`, seen.every((other) => different(other, pixels) > 100));
    seen.push(pixels);
    expect(`colour: ${option.value} has its legend`, byId('legend').hidden === (option.value === 'structure'));
  }
  if (byId('colour').options.length > 1) {
    const most = byId('legend-max').value;
    changesView('the end of the colours', () => change(byId('legend-max'), String(0.2 * Number(most))), () => change(byId('legend-max'), most));
  }
  change(byId('colour'), 'structure');
}

function runSelftest() {
  for (const part of SELFTESTS) {
    try { part(); } catch (error) { expect(`${part.name} ends: ${error && error.stack}`, false); }
  }
  expect(`no error: ${selftest.errors.join('; ')}`, selftest.errors.length === 0 && byId('failure').hidden);
  const result = `selftest: ${selftest.failed === 0 ? 'passed' : 'failed'}, ${selftest.lines.length} checks, ${selftest.failed} failed`;
  byId('selftest-result').textContent = `${selftest.lines.join('\n')}\n${result}`;
  byId('selftest-result').hidden = false;
  document.title = result;
}

window.addEventListener('load', () => { if (location.hash === '#selftest') setTimeout(runSelftest, 50); });
