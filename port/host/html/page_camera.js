/* page_camera.js: an orthographic camera that turns about the patient's long axis; mouse, touch and keys move it. */

const camera = { turn: 0, rise: 0, half: sceneSide * 0.54, at: sceneCentre.slice() };

/* Views as a radiologist names them: the side that one looks from. */
const PRESETS = { A: [0, 0], P: [180, 0], L: [90, 0], R: [-90, 0], S: [0, 90], I: [0, -90] };

/* Unit vectors of the screen: right, up, and towards the viewer, in LPS. */
function cameraAxes() {
  const f = camera.turn * Math.PI / 180, e = camera.rise * Math.PI / 180;
  const right = [Math.cos(f), Math.sin(f), 0];
  const back = [Math.sin(f) * Math.cos(e), -Math.cos(f) * Math.cos(e), Math.sin(e)];
  const up = [back[1] * right[2] - back[2] * right[1], back[2] * right[0] - back[0] * right[2], back[0] * right[1] - back[1] * right[0]];
  return { right, up, back };
}

function dot(a, b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

function turnCamera(turn, rise) {
  camera.turn = ((camera.turn + turn + 540) % 360) - 180;
  camera.rise = Math.max(-90, Math.min(90, camera.rise + rise));
  redraw('view');
}

/* By a part of the view's height. */
function moveCamera(right, up) {
  const axes = cameraAxes();
  for (let c = 0; c < 3; c++) camera.at[c] += 2 * camera.half * (axes.right[c] * right + axes.up[c] * up);
  redraw('view');
}

function zoomCamera(factor) {
  camera.half = Math.max(sceneRadius / 200, Math.min(sceneRadius * 4, camera.half * factor));
  redraw('view');
}

function lookFrom(letter) {
  [camera.turn, camera.rise] = PRESETS[letter];
  redraw('view');
}

function resetCamera() {
  camera.at = sceneCentre.slice();
  camera.half = sceneSide * 0.54;
  lookFrom('A');
}

/* One pointer turns, two move and zoom; a press that does not move is a click. */
function listenToPointers(canvas, onClick) {
  const pointers = new Map();
  let travel = 0;
  const middle = () => {
    const all = [...pointers.values()];
    const x = all.reduce((s, p) => s + p.x, 0) / all.length, y = all.reduce((s, p) => s + p.y, 0) / all.length;
    return { x, y, spread: all.length > 1 ? Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) : 0 };
  };
  canvas.addEventListener('pointerdown', (event) => {
    if (pointers.size === 0) travel = 0;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    try { canvas.setPointerCapture(event.pointerId); } catch (e) { /* a pointer that has gone */ }
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!pointers.has(event.pointerId)) return;
    const before = middle();
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const now = middle(), dx = now.x - before.x, dy = now.y - before.y;
    travel += Math.abs(dx) + Math.abs(dy) + Math.abs(now.spread - before.spread);
    const height = canvas.clientHeight || 1;
    if (pointers.size > 1 || event.shiftKey || (event.buttons & 6) !== 0) moveCamera(-dx / height, dy / height);
    else turnCamera(-dx * 0.4, dy * 0.4);
    if (pointers.size > 1 && before.spread > 0 && now.spread > 0) zoomCamera(before.spread / now.spread);
  });
  const leave = (event) => {
    if (pointers.delete(event.pointerId) && event.type === 'pointerup' && pointers.size === 0 && travel < 4) {
      const box = canvas.getBoundingClientRect();
      onClick(event.clientX - box.left, event.clientY - box.top);
    }
  };
  for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, leave);
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoomCamera(Math.exp(Math.max(-0.3, Math.min(0.3, event.deltaY * 0.0015))));
  }, { passive: false });
}

function listenToKeys(canvas) {
  canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const far = event.shiftKey ? 0.05 : 6, act = event.shiftKey ? moveCamera : (x, y) => turnCamera(x, -y);
    const key = event.key.length === 1 ? event.key.toUpperCase() : event.key;
    if (key === 'ArrowLeft') act(-far, 0);
    else if (key === 'ArrowRight') act(far, 0);
    else if (key === 'ArrowUp') act(0, event.shiftKey ? far : -far);
    else if (key === 'ArrowDown') act(0, event.shiftKey ? -far : far);
    else if (key === '+' || key === '=') zoomCamera(1 / 1.15);
    else if (key === '-' || key === '_') zoomCamera(1.15);
    else if (key === '0') resetCamera();
    else if (key in PRESETS) lookFrom(key);
    else return;
    event.preventDefault();
  });
}
