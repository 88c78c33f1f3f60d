// The lobe as a surface over the hemisphere: measured and model side by side under one view. Own WebGL 2 code.

// A view that pointer and keys turn; `changed` draws it again.
class Orbit {
  constructor(canvas, view, changed) {
    Object.assign(this, view);
    this.changed = changed;
    let last = null;
    canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (last === null) return;
      this.turn((last[0] - event.clientX) / 120, (event.clientY - last[1]) / 120);
      last = [event.clientX, event.clientY];
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { last = null; });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    const zooms = { "+": 1.1, "=": 1.1, "-": 1 / 1.1 };
    if (turns[event.key]) this.turn(...turns[event.key]);
    else if (zooms[event.key]) {
      this.zoom = Math.min(Math.max(this.zoom * zooms[event.key], 0.4), 4);
      this.changed();
    } else return;
    event.preventDefault();
  }

  turn(azimuth, height) {
    this.azimuth += azimuth;
    this.height = Math.min(Math.max(this.height + height, 0.03), 1.55);
    this.changed();
  }

  // Right, up and towards the eye.
  axes() {
    const towards = direction(Math.PI / 2 - this.height, this.azimuth);
    const right = [-Math.sin(this.azimuth), Math.cos(this.azimuth), 0];
    const up = [-towards[2] * right[1], towards[2] * right[0], towards[0] * right[1] - towards[1] * right[0]];
    return { right, up, towards };
  }
}

function program(gl, vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, `#version 300 es\nprecision highp float;\n${text}`);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  return made;
}

const LOBE_VERTEX = `
in vec3 place; in vec3 normal; in vec3 colour;
uniform vec3 right, up, towards; uniform vec2 scale;
out vec3 n; out vec3 c;
void main() {
  n = normal; c = colour;
  vec3 p = place - vec3(0., 0., .38);
  gl_Position = vec4(scale * vec2(dot(p, right), dot(p, up)), -dot(p, towards) * .3, 1.);
}`;
const LOBE_FRAGMENT = `
in vec3 n; in vec3 c; uniform vec3 right, up, towards; out vec4 colour;
void main() {
  float size = length(n);
  float shade = size > 0. ? .45 + .55 * abs(dot(n / size, normalize(towards + .5 * up - .4 * right))) : 1.;
  colour = vec4(c * shade, 1.);
}`;
const LOBE_ROWS = 72, LOBE_COLUMNS = 180;

class LobeView {
  constructor(canvas, table) {
    this.canvas = canvas;
    this.table = table;
    this.decades = 4;
    this.colour = Math.floor(table.colours.length / 2);
    this.gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!this.gl) return;
    const gl = this.gl;
    this.program = program(gl, LOBE_VERTEX, LOBE_FRAGMENT);
    this.orbit = new Orbit(canvas, { azimuth: -0.9, height: 0.45, zoom: 1.2 }, () => this.draw());
    this.index = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.index);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, LobeView.triangles(), gl.STATIC_DRAW);
  }

  static triangles() {
    const index = [];
    for (let row = 0; row < LOBE_ROWS; row += 1) {
      for (let k = 0; k < LOBE_COLUMNS; k += 1) {
        const [a, b] = [row * (LOBE_COLUMNS + 1) + k, (row + 1) * (LOBE_COLUMNS + 1) + k];
        index.push(a, b, a + 1, a + 1, b, b + 1);
      }
    }
    return new Uint32Array(index);
  }

  // Values over the hemisphere for a light direction, a lobe for each layer; one peak for all.
  show({ layers, theta, phi, log }) {
    const stop = this.table.spots ? this.table.nearestStop(theta, phi) : null;
    this.stop = stop;
    this.light = stop === null || this.table.relative ? { theta, phi } : this.table.lightOf(stop);
    if (stop !== null) this.light.theta = this.table.lightOf(stop).theta;
    const sample = (layer) => {
      if (stop !== null) {
        const first = this.table.at(this.colour, stop, 0);
        return Array.from(layer.values.subarray(first, first + this.table.bins));
      }
      const values = [];
      for (let row = 0; row <= LOBE_ROWS; row += 1) {
        for (let k = 0; k <= LOBE_COLUMNS; k += 1) {
          const wo = direction(row / LOBE_ROWS * 89.9 * RAD, 2 * Math.PI * k / LOBE_COLUMNS);
          values.push(this.table.value(layer, this.colour, theta, phi, wo));
        }
      }
      return values;
    };
    this.lobes = layers.map((layer) => ({ name: layer.name, values: sample(layer) }));
    this.peak = this.lobes.reduce((peak, lobe) => lobe.values.reduce((a, b) => Math.max(a, b), peak), 1e-30);
    this.log = log;
    if (this.gl) this.meshes = this.lobes.map((lobe) => (stop === null ? this.mesh(lobe.values) : this.fan(lobe.values)));
    this.draw();
  }

  radius(value) {
    if (!this.log) return value / this.peak;
    return value > 0 ? Math.max(0, 1 + Math.log10(value / this.peak) / this.decades) : 0;
  }

  // Interleaved place, normal, colour.
  mesh(values) {
    const wide = LOBE_COLUMNS + 1;
    const places = values.map((value, at) => {
      const wo = direction(Math.floor(at / wide) / LOBE_ROWS * 89.9 * RAD, 2 * Math.PI * (at % wide) / LOBE_COLUMNS);
      return wo.map((x) => x * this.radius(value));
    });
    const data = new Float32Array(9 * values.length);
    values.forEach((value, at) => {
      const [row, k] = [Math.floor(at / wide), at % wide];
      const near = (r, c) => places[Math.min(Math.max(r, 0), LOBE_ROWS) * wide + wrapped(c, LOBE_COLUMNS)];
      const [a, b, c, d] = [near(row + 1, k), near(row - 1, k), near(row, k + 1), near(row, k - 1)];
      const u = a.map((x, i) => x - b[i]), v = c.map((x, i) => x - d[i]);
      const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      data.set([...places[at], ...normal.map((x) => 1e3 * x), ...viridis(this.radius(value)).map((x) => x / 255)], 9 * at);
    });
    return data;
  }

  // Single directions: triangles from the middle to neighbours of one azimuth, and a pin for each.
  fan(values) {
    const spots = this.table.spotsAt(this.light.phi), step = this.table.spots.step;
    const data = [], pins = [];
    const colour = (k) => viridis(this.radius(values[k])).map((x) => x / 255);
    const place = (k) => spots[k].map((x) => x * this.radius(values[k]));
    const absent = (k) => this.table.isAbsent(this.stop, k);
    values.forEach((value, k) => {
      if (absent(k)) return;
      pins.push(0, 0, 0, 0, 0, 0, ...colour(k), ...place(k), 0, 0, 0, ...colour(k));
      const next = k + step;
      if (next >= values.length || absent(next) || dot(spots[k], spots[next]) < Math.cos(25 * RAD)) return;
      const [a, b] = [spots[k], spots[next]];
      const normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
      for (const corner of [[0, 0, 0], place(k), place(next)]) {
        data.push(...corner, ...normal, ...colour(k));
      }
    });
    return { triangles: new Float32Array(data), pins: new Float32Array(pins) };
  }

  // Horizon, rings, axes and the light, as line segments.
  lines() {
    const data = [];
    const line = (a, b, colour) => data.push(...a, 0, 0, 0, ...colour, ...b, 0, 0, 0, ...colour);
    for (const radius of [0.25, 0.5, 0.75, 1]) {
      for (let k = 0; k < 96; k += 1) {
        const at = (j) => direction(Math.PI / 2, 2 * Math.PI * j / 96).map((x) => radius * x);
        line(at(k), at(k + 1), [0.7, 0.7, 0.7]);
      }
    }
    line([0, 0, 0], [1.15, 0, 0], [0.8, 0.2, 0.2]);
    line([0, 0, 0], [0, 1.15, 0], [0.1, 0.5, 0.2]);
    line([0, 0, 0], [0, 0, 1.1], [0.5, 0.5, 0.5]);
    const wi = direction(this.light.theta * RAD, this.light.phi * RAD);
    line([0, 0, 0], wi.map((x) => 1.25 * x), [0.1, 0.1, 0.1]);
    const mirror = [-1.1 * wi[0], -1.1 * wi[1], 1.1 * wi[2]];
    for (let k = 0; k < 20; k += 2) line(mirror.map((x) => x * k / 20), mirror.map((x) => x * (k + 1) / 20), [0.1, 0.1, 0.1]);
    return new Float32Array(data);
  }

  draw() {
    if (!this.lobes) return;
    if (!this.gl) return this.cut();
    const { gl, canvas } = this;
    fitted(canvas, canvas.clientWidth, canvas.clientHeight);
    gl.clearColor(0.957, 0.957, 0.957, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(this.program);
    const axes = this.orbit.axes();
    for (const name of ["right", "up", "towards"]) gl.uniform3fv(gl.getUniformLocation(this.program, name), axes[name]);
    const count = this.meshes.length;
    this.meshes.forEach((mesh, k) => {
      const width = canvas.width / count;
      gl.viewport(k * width, 0, width, canvas.height);
      const size = 0.8 * this.orbit.zoom * Math.min(1, width / canvas.height);
      gl.uniform2f(gl.getUniformLocation(this.program, "scale"), size * canvas.height / width, size);
      this.buffer(this.lines());
      gl.drawArrays(gl.LINES, 0, this.lines().length / 9);
      if (mesh.pins) {
        for (const [kind, data] of [[gl.LINES, mesh.pins], [gl.TRIANGLES, mesh.triangles]]) {
          this.buffer(data);
          gl.drawArrays(kind, 0, data.length / 9);
        }
        return;
      }
      this.buffer(mesh);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.index);
      gl.drawElements(gl.TRIANGLES, 6 * LOBE_ROWS * LOBE_COLUMNS, gl.UNSIGNED_INT, 0);
    });
  }

  buffer(data) {
    const gl = this.gl;
    this.vertices = this.vertices || gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.vertices);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    ["place", "normal", "colour"].forEach((name, k) => {
      const at = gl.getAttribLocation(this.program, name);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 36, 12 * k);
    });
  }

  // Without WebGL: the lobes cut by the plane of incidence.
  cut() {
    const canvas = this.canvas;
    fitted(canvas, canvas.clientWidth, canvas.clientHeight);
    const g = canvas.getContext("2d");
    const [w, h] = [canvas.width, canvas.height], size = 0.42 * Math.min(w, 1.7 * h);
    g.fillStyle = "#f4f4f4";
    g.fillRect(0, 0, w, h);
    g.lineWidth = 2;
    g.strokeStyle = "#999";
    g.beginPath();
    g.arc(w / 2, 0.85 * h, size, Math.PI, 2 * Math.PI);
    g.stroke();
    this.lobes.forEach((lobe, k) => {
      g.strokeStyle = ["#111", "#d55e00"][k % 2];
      g.setLineDash(k ? [4, 4] : []);
      g.beginPath();
      for (const [theta, value] of this.table.spots ? this.spotsInPlane(lobe) : this.plane(lobe)) {
        const r = size * this.radius(value);
        g.lineTo(w / 2 + r * Math.sin(theta * RAD), 0.85 * h - r * Math.cos(theta * RAD));
      }
      g.stroke();
    });
    g.setLineDash([]);
  }

  // (theta, value) in the plane of incidence, the mirror's side positive.
  plane(lobe) {
    const layer = this.table.layers.find((layer) => layer.name === lobe.name);
    return Array.from({ length: 179 }, (_, k) => {
      const theta = k - 89;
      const wo = direction(Math.abs(theta) * RAD, (this.light.phi + (theta > 0 ? 180 : 0)) * RAD);
      return [theta, this.table.value(layer, this.colour, this.light.theta, this.light.phi, wo)];
    });
  }

  spotsInPlane(lobe) {
    const [c, s] = [Math.cos(this.light.phi * RAD), Math.sin(this.light.phi * RAD)];
    const found = this.table.spotsAt(this.light.phi).map((wo, k) => [wo, lobe.values[k], k])
      .filter(([, , k]) => !this.table.isAbsent(this.stop, k))
      .filter(([wo]) => Math.abs(wo[1] * c - wo[0] * s) < 0.03)
      .map(([wo, value]) => [Math.atan2(-(wo[0] * c + wo[1] * s), wo[2]) / RAD, value]);
    return found.sort((a, b) => a[0] - b[0]);
  }
}
