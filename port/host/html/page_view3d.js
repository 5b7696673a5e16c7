/* page_view3d.js: draws the surfaces with WebGL2; letters, scale bar and the chosen point on a canvas above. */

const VERTEX_SHADER = `#version 300 es
in vec3 a_before, a_after, a_normal_before, a_normal_after;
in vec2 a_value;
uniform float u_blend;
uniform vec3 u_at, u_right, u_up, u_back;
uniform vec2 u_half;
uniform float u_depth;
out vec3 v_normal;
out float v_value;
void main() {
  vec3 p = mix(a_before, a_after, u_blend) - u_at;
  vec3 n = mix(a_normal_before, a_normal_after, u_blend);
  v_normal = vec3(dot(n, u_right), dot(n, u_up), dot(n, u_back));
  v_value = min(a_value.x, a_value.y) < 0.0 ? (u_blend < 0.5 ? a_value.x : a_value.y) : mix(a_value.x, a_value.y, u_blend);
  gl_Position = vec4(dot(p, u_right) / u_half.x, dot(p, u_up) / u_half.y, -dot(p, u_back) / u_depth, 1.0);
  gl_PointSize = 4.0;
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
in vec3 v_normal;
in float v_value;
uniform vec4 u_colour;
uniform bool u_by_value, u_chosen;
uniform float u_most, u_step;
uniform sampler2D u_map;
out vec4 colour;
void main() {
  vec3 n = normalize(v_normal);
  if (dot(v_normal, v_normal) < 1e-9) n = vec3(0.0, 0.0, 1.0);
  if (n.z < 0.0) n = -n;
  vec3 base = u_colour.rgb;
  if (u_by_value) {
    base = mod(gl_FragCoord.x + gl_FragCoord.y, 8.0) < 3.0 ? vec3(0.38) : vec3(0.62); /* hatched: not known */
    if (v_value >= 0.0) {
      base = texture(u_map, vec2(clamp(v_value / u_most, 0.0, 1.0), 0.5)).rgb;
      float at = v_value / u_step, wide = max(fwidth(at), 1e-6);
      float line = abs(fract(at - 0.5) - 0.5) / wide;
      if (v_value < u_most && at > 0.5 && wide < 0.4) base *= mix(0.45, 1.0, clamp(line, 0.0, 1.0));
    }
  }
  float light = 0.34 + 0.66 * max(dot(n, normalize(vec3(-0.35, 0.45, 0.82))), 0.0);
  float gloss = u_by_value ? 0.0 : 0.12 * pow(max(dot(n, normalize(vec3(-0.2, 0.3, 0.93))), 0.0), 24.0);
  float rim = pow(1.0 - n.z, 3.0);
  vec3 lit = base * light + gloss;
  lit = u_chosen ? mix(lit, vec3(1.0), 0.85 * rim) : lit * (1.0 - 0.45 * rim);
  colour = vec4(lit, u_colour.a);
}`;

const TARGET_COLOUR = [0.16, 0.66, 0.95];
const view = { gl: null, program: null, uniform: {}, meshes: [], targets: [], map: null };

function compile(gl, kind, source) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

function link(gl) {
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl, gl.VERTEX_SHADER, VERTEX_SHADER));
  gl.attachShader(program, compile(gl, gl.FRAGMENT_SHADER, FRAGMENT_SHADER));
  ['a_before', 'a_after', 'a_normal_before', 'a_normal_after', 'a_value'].forEach((name, i) => gl.bindAttribLocation(program, i, name));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

/* A mesh on the graphics card; a target stays where it is. */
function upload(gl, before, after, index, n) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  const attribute = (slot, data, size) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(slot);
    gl.vertexAttribPointer(slot, size, gl.FLOAT, false, 0, 0);
    return buffer;
  };
  const first = attribute(0, before, 3);
  const places = attribute(1, after, 3);
  const still = attribute(2, normalsOf(before, index), 3);
  const normals = attribute(3, normalsOf(after, index), 3);
  const values = attribute(4, new Float32Array(2 * n), 2);
  const list = gl.createBuffer();
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, list);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  return { array, before: first, places, still, normals, values, index: list, count: index.length, n };
}

function startView() {
  const gl = byId('gl').getContext('webgl2', { antialias: true, preserveDrawingBuffer: true });
  if (!gl) throw new Error('this browser has no WebGL2: the 3D view stays empty, all else works');
  view.gl = gl;
  view.program = link(gl);
  for (const name of ['blend', 'at', 'right', 'up', 'back', 'half', 'depth', 'colour', 'by_value', 'chosen', 'most', 'step', 'map']) {
    view.uniform[name] = gl.getUniformLocation(view.program, `u_${name}`);
  }
  view.meshes = structures.map((s) => upload(gl, s.place.before, s.place.after, s.index, s.n));
  view.targets = targets.map((t) => upload(gl, t.place, t.place, t.index, t.n));
  const map = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; i++) map.set([...mapColour(i / 255), 255], 4 * i);
  view.map = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, view.map);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, map);
  for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, side, gl.LINEAR);
  for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
}

/* The values that colour a structure's vertices: before and after side by side. */
function uploadValues() {
  const gl = view.gl;
  if (!gl || state.colour === 'structure') return;
  structures.forEach((s, i) => {
    const { before, after } = s.values[state.colour], both = new Float32Array(2 * s.n);
    for (let k = 0; k < s.n; k++) {
      both[2 * k] = before ? before[k] : -1;
      both[2 * k + 1] = after[k];
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, view.meshes[i].values);
    gl.bufferData(gl.ARRAY_BUFFER, both, gl.STATIC_DRAW);
  });
}

function fitCanvas(canvas) {
  const scale = Math.min(2, window.devicePixelRatio || 1);
  const width = Math.max(1, Math.round(canvas.clientWidth * scale)), height = Math.max(1, Math.round(canvas.clientHeight * scale));
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  return scale;
}

function drawMesh(mesh, rgba) {
  const gl = view.gl;
  gl.uniform4fv(view.uniform.colour, rgba);
  gl.bindVertexArray(mesh.array);
  if (mesh.count > 0) gl.drawElements(gl.TRIANGLES, mesh.count, gl.UNSIGNED_INT, 0);
  else gl.drawArrays(gl.POINTS, 0, mesh.n);
}

/* Half the width and height of what is seen, mm. */
function viewHalf() {
  const canvas = byId('gl'), ratio = (canvas.clientWidth || 1) / (canvas.clientHeight || 1);
  return ratio >= 1 ? [camera.half * ratio, camera.half] : [camera.half, camera.half / ratio];
}

function setUniforms() {
  const gl = view.gl, { right, up, back } = cameraAxes(), u = view.uniform;
  gl.uniform3fv(u.at, camera.at);
  gl.uniform3fv(u.right, right);
  gl.uniform3fv(u.up, up);
  gl.uniform3fv(u.back, back);
  gl.uniform2fv(u.half, viewHalf());
  gl.uniform1f(u.depth, sceneRadius * 2.2 + Math.hypot(...camera.at.map((v, c) => v - sceneCentre[c])));
  gl.uniform1f(u.blend, state.blend);
  gl.uniform1f(u.most, Math.max(1e-6, state.most));
  gl.uniform1f(u.step, Math.max(1e-6, state.most / 4));
  gl.uniform1i(u.map, 0);
}

/* What is transparent shows its nearest layer only: depth first, then colour. */
function drawTargets() {
  const gl = view.gl;
  gl.uniform1i(view.uniform.by_value, 0);
  gl.uniform1i(view.uniform.chosen, 0);
  const shown = view.targets.filter((_, i) => targetVisible(i));
  gl.colorMask(false, false, false, false);
  for (const mesh of shown) drawMesh(mesh, [0, 0, 0, 1]);
  gl.colorMask(true, true, true, true);
  gl.enable(gl.BLEND);
  gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE);
  gl.depthFunc(gl.LEQUAL);
  for (const mesh of shown) drawMesh(mesh, [...TARGET_COLOUR, state.opacity]);
  gl.disable(gl.BLEND);
  gl.depthFunc(gl.LESS);
}

/* A target with a structure's name is shown with it. */
function targetVisible(i) {
  const same = structures.find((s) => s.name === targets[i].name);
  return targets.length === 1 || !same || same.visible;
}

function drawView() {
  const gl = view.gl, canvas = byId('gl');
  fitCanvas(canvas);
  if (gl) {
    const back = getComputedStyle(canvas).backgroundColor.match(/[\d.]+/g).map(Number);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(back[0] / 255, back[1] / 255, back[2] / 255, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(view.program);
    gl.bindTexture(gl.TEXTURE_2D, view.map);
    setUniforms();
    structures.forEach((s, i) => {
      if (!s.visible) return;
      gl.uniform1i(view.uniform.by_value, state.colour === 'structure' ? 0 : 1);
      gl.uniform1i(view.uniform.chosen, i === state.chosen ? 1 : 0);
      drawMesh(view.meshes[i], [...s.colour, 1]);
    });
    if (state.showTarget) drawTargets();
    gl.bindVertexArray(null);
  }
  drawOver();
}

/* Text that reads on light and dark. */
function drawText(c, text, x, y, align, baseline) {
  c.textAlign = align;
  c.textBaseline = baseline;
  c.strokeText(text, x, y);
  c.fillText(text, x, y);
}

/* A bar of a round length at the lower right, in pixels of the canvas. */
function drawBar(c, x, y, mmPerPixel, most) {
  const mm = niceBelow(most * mmPerPixel), width = mm / mmPerPixel;
  for (const [colour, line] of [[c.strokeStyle, 5], [c.fillStyle, 2]]) {
    c.save();
    c.strokeStyle = colour;
    c.lineWidth = line * c.unit;
    c.beginPath();
    c.moveTo(x - width, y - 5 * c.unit);
    c.lineTo(x - width, y);
    c.lineTo(x, y);
    c.lineTo(x, y - 5 * c.unit);
    c.stroke();
    c.restore();
  }
  drawText(c, `${mm} mm`, x - width / 2, y - 6 * c.unit, 'center', 'bottom');
}

function drawOver() {
  const canvas = byId('gl-over'), scale = fitCanvas(canvas), c = canvas.getContext('2d');
  const style = getComputedStyle(document.documentElement);
  const { right, up } = cameraAxes(), { width, height } = canvas, [halfX, halfY] = viewHalf();
  c.unit = scale;
  c.clearRect(0, 0, width, height);
  c.font = `600 ${15 * scale}px system-ui, sans-serif`;
  c.lineJoin = 'round';
  c.lineWidth = 3 * scale;
  c.fillStyle = style.getPropertyValue('--text');
  c.strokeStyle = style.getPropertyValue('--view');
  const minus = (d) => d.map((v) => -v);
  drawText(c, letters(minus(right)), 10 * scale, height / 2, 'left', 'middle');
  drawText(c, letters(right), width - 10 * scale, height / 2, 'right', 'middle');
  drawText(c, letters(up), width / 2, 8 * scale, 'center', 'top');
  drawText(c, letters(minus(up)), width / 2, height - 8 * scale, 'center', 'bottom');
  c.font = `${13 * scale}px system-ui, sans-serif`;
  drawBar(c, width - 14 * scale, height - 46 * scale, 2 * halfX / width, width * 0.2);
  drawText(c, viewText(), 10 * scale, 8 * scale, 'left', 'top');
  const away = state.point.map((v, k) => v - camera.at[k]);
  const x = width * (0.5 + 0.5 * dot(away, right) / halfX), y = height * (0.5 - 0.5 * dot(away, up) / halfY);
  if (state.pointed) drawCross(c, x, y, scale);
}

function drawCross(c, x, y, scale) {
  c.save();
  for (const [colour, line] of [['#000', 4], ['#fff', 1.6]]) {
    c.strokeStyle = colour;
    c.lineWidth = line * scale;
    c.beginPath();
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      c.moveTo(x + 5 * dx * scale, y + 5 * dy * scale);
      c.lineTo(x + 13 * dx * scale, y + 13 * dy * scale);
    }
    c.stroke();
  }
  c.restore();
}

/* Places of a structure as it is shown. */
function shownPlaces(s) {
  if (state.blend >= 1) return s.place.after;
  if (state.blend <= 0) return s.place.before;
  return s.place.after.map((v, i) => s.place.before[i] + state.blend * (v - s.place.before[i]));
}

/* The nearest visible surface under a point of the view, in CSS pixels: {structure, vertex, point}, or null. */
function pick(px, py) {
  const canvas = byId('gl'), { right, up, back } = cameraAxes(), [halfX, halfY] = viewHalf();
  const x = (2 * px / canvas.clientWidth - 1) * halfX + dot(camera.at, right);
  const y = (1 - 2 * py / canvas.clientHeight) * halfY + dot(camera.at, up);
  let best = null;
  structures.forEach((s, which) => {
    if (!s.visible) return;
    const at = shownPlaces(s), u = new Float32Array(s.n), v = new Float32Array(s.n), w = new Float32Array(s.n);
    for (let i = 0; i < s.n; i++) {
      const p = at.subarray(3 * i, 3 * i + 3);
      u[i] = dot(p, right) - x;
      v[i] = dot(p, up) - y;
      w[i] = dot(p, back);
    }
    for (let t = 0; t < s.index.length; t += 3) {
      const [a, b, c] = [s.index[t], s.index[t + 1], s.index[t + 2]];
      const p = u[b] * v[c] - u[c] * v[b], q = u[c] * v[a] - u[a] * v[c], r = u[a] * v[b] - u[b] * v[a], sum = p + q + r;
      if (sum === 0 || p * sum < 0 || q * sum < 0 || r * sum < 0) continue;
      const depth = (p * w[a] + q * w[b] + r * w[c]) / sum;
      if (best && depth <= best.depth) continue;
      const share = [p / sum, q / sum, r / sum], corner = [a, b, c];
      const point = [0, 1, 2].map((k) => corner.reduce((m, i, j) => m + share[j] * at[3 * i + k], 0));
      best = { depth, structure: which, vertex: corner[share.indexOf(Math.max(...share))], point };
    }
  });
  return best;
}
