// The lobe as a surface over the hemisphere, and below it where light goes through: measured and model side by side under
// one view. Own WebGL 2 code.

const LOBE_VERTEX = `
in vec3 place; in vec3 normal; in vec3 colour;
uniform vec3 right, up, towards; uniform vec2 scale; uniform float middle;
out vec3 n; out vec3 c;
void main() {
  n = normal; c = colour;
  vec3 p = place - vec3(0., 0., middle);
  gl_Position = vec4(scale * vec2(dot(p, right), dot(p, up)), -dot(p, towards) * .3, 1.);
}`;
const LOBE_FRAGMENT = `
in vec3 n; in vec3 c; uniform vec3 right, up, towards; uniform float opacity; out vec4 colour;
void main() {
  float size = length(n);
  float shade = size > 0. ? .45 + .55 * abs(dot(n / size, normalize(towards + .5 * up - .4 * right))) : 1.;
  colour = vec4(c * shade, opacity);
}`;
const LOBE_ROWS = 72, LOBE_COLUMNS = 180;

class LobeView {
  // `tables`: of one half or of both. The side that is drawn above is the outside, so that light from inside comes from below.
  constructor(canvas, tables, inside) {
    this.canvas = canvas;
    this.tables = tables;
    this.table = tables[0];
    this.above = inside ? -1 : 1;
    this.decades = 4;
    this.colour = Math.floor(this.table.colours.length / 2);
    this.gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!this.gl) return;
    const gl = this.gl;
    this.program = program(gl, LOBE_VERTEX, LOBE_FRAGMENT);
    this.orbit = new Orbit(canvas, this.drawsThrough() ? { azimuth: -0.9, height: 0.22, zoom: 1, lowest: -1.55 }
      : { azimuth: -0.9, height: 0.45, zoom: 1.2 }, () => this.draw());
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

  // Whether light that has gone through is drawn, alone or below what comes back.
  drawsThrough() {
    return this.tables.some((table) => table.below);
  }

  // 1 where a half is drawn above the surface, -1 below.
  side(table) {
    return table.below ? -this.above : this.above;
  }

  // Values over the hemispheres for a light direction, a lobe for each of the `lobes`, which are a layer of each table. One
  // peak for all; with linear radius for each half, as what comes back and what goes through are far apart.
  show({ lobes, theta, phi, log }) {
    const stop = this.table.spots ? this.table.nearestStop(theta, phi) : null;
    this.stop = stop;
    this.light = stop === null || this.table.relative ? { theta, phi } : this.table.lightOf(stop);
    if (stop !== null) this.light.theta = this.table.lightOf(stop).theta;
    const sample = (table, layer) => {
      if (table.spots) {
        const first = table.at(this.colour, stop ?? table.nearestStop(theta, phi), 0);
        return Array.from(layer.values.subarray(first, first + table.bins));
      }
      const values = [];
      for (let row = 0; row <= LOBE_ROWS; row += 1) {
        for (let k = 0; k <= LOBE_COLUMNS; k += 1) {
          const wo = direction(row / LOBE_ROWS * 89.9 * RAD, 2 * Math.PI * k / LOBE_COLUMNS);
          values.push(table.value(layer, this.colour, theta, phi, wo));
        }
      }
      return values;
    };
    this.log = log;
    this.lobes = lobes.map((layers) => ({
      name: layers[0].name,
      parts: layers.map((layer, k) => ({ table: this.tables[k], layer, values: sample(this.tables[k], layer) })),
    }));
    const highest = (k) => this.lobes.reduce((peak, { parts }) => parts[k].values.reduce((a, b) => Math.max(a, b), peak), 1e-30);
    this.peaks = this.tables.map((_, k) => highest(k));
    if (log) this.peaks.fill(Math.max(...this.peaks));
    if (this.gl) this.meshes = this.lobes.map((lobe) => lobe.parts.map((part) => (part.table.spots ? this.fan(part) : this.mesh(part))));
    this.draw();
  }

  radius(value, table) {
    const peak = this.peaks[this.tables.indexOf(table)];
    if (!this.log) return value / peak;
    return value > 0 ? Math.max(0, 1 + Math.log10(value / peak) / this.decades) : 0;
  }

  // Interleaved place, normal, colour.
  mesh({ table, values }) {
    const wide = LOBE_COLUMNS + 1, side = this.side(table);
    const places = values.map((value, at) => {
      const wo = direction(Math.floor(at / wide) / LOBE_ROWS * 89.9 * RAD, 2 * Math.PI * (at % wide) / LOBE_COLUMNS);
      const radius = this.radius(value, table);
      return [wo[0] * radius, wo[1] * radius, side * wo[2] * radius];
    });
    const data = new Float32Array(9 * values.length);
    values.forEach((value, at) => {
      const [row, k] = [Math.floor(at / wide), at % wide];
      const near = (r, c) => places[Math.min(Math.max(r, 0), LOBE_ROWS) * wide + wrapped(c, LOBE_COLUMNS)];
      const [a, b, c, d] = [near(row + 1, k), near(row - 1, k), near(row, k + 1), near(row, k - 1)];
      const u = a.map((x, i) => x - b[i]), v = c.map((x, i) => x - d[i]);
      const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      data.set([...places[at], ...normal.map((x) => 1e3 * x), ...viridis(this.radius(value, table)).map((x) => x / 255)], 9 * at);
    });
    return data;
  }

  // Single directions: triangles from the middle to neighbours of one azimuth, and a pin for each.
  fan({ table, values }) {
    const side = this.side(table), step = table.spots.step;
    const spots = table.spotsAt(this.light.phi).map(([x, y, z]) => [x, y, side * z]);
    const data = [], pins = [];
    const colour = (k) => viridis(this.radius(values[k], table)).map((x) => x / 255);
    const place = (k) => spots[k].map((x) => x * this.radius(values[k], table));
    const stop = table.nearestStop(this.light.theta, this.light.phi);
    const absent = (k) => table.isAbsent(stop, k);
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
    const through = this.drawsThrough(), black = [0.1, 0.1, 0.1];
    line([0, 0, through ? -1.1 : 0], [0, 0, 1.1], [0.5, 0.5, 0.5]);
    const turned = ([x, y, z]) => [x, y, this.above * z];
    const wi = turned(direction(this.light.theta * RAD, this.light.phi * RAD));
    line([0, 0, 0], wi.map((x) => 1.25 * x), black);
    if (through) this.arrowHead(wi).forEach((end) => line(wi.map((x) => 0.98 * x), end, black));
    const dashed = (end, colour) => {
      for (let k = 0; k < 20; k += 2) line(end.map((x) => x * k / 20), end.map((x) => x * (k + 1) / 20), colour);
    };
    dashed([-1.1 * wi[0], -1.1 * wi[1], 1.1 * wi[2]], black);
    const below = this.tables.find((table) => table.below);
    const onwards = below && below.onwards(this.light.theta, this.light.phi);
    if (onwards) dashed(turned(onwards).map((x) => 1.25 * x), [0.75, 0.1, 0.45]);
    return new Float32Array(data);
  }

  // Ends of the strokes of an arrow that points at the surface, in the plane of incidence.
  arrowHead(wi) {
    const phi = this.light.phi * RAD, theta = this.light.theta * RAD;
    const across = [Math.cos(theta) * Math.cos(phi), Math.cos(theta) * Math.sin(phi), -this.above * Math.sin(theta)];
    return [-0.045, 0.045].map((size) => wi.map((x, k) => 1.1 * x + size * across[k]));
  }

  // The mean plane as a disc.
  plane() {
    const data = [];
    const at = (k) => [...direction(Math.PI / 2, 2 * Math.PI * k / 96), 0, 0, 0, 0.45, 0.62, 0.75];
    for (let k = 0; k < 96; k += 1) data.push(0, 0, 0, 0, 0, 0, 0.45, 0.62, 0.75, ...at(k), ...at(k + 1));
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
    const count = this.meshes.length, uniform = (name) => gl.getUniformLocation(this.program, name);
    gl.uniform1f(uniform("middle"), this.drawsThrough() ? 0 : 0.38);
    gl.uniform1f(uniform("opacity"), 1);
    this.meshes.forEach((parts, k) => {
      const width = canvas.width / count;
      gl.viewport(k * width, 0, width, canvas.height);
      const size = 0.8 * this.orbit.zoom * Math.min(1, width / canvas.height);
      gl.uniform2f(uniform("scale"), size * canvas.height / width, size);
      this.drawAs(gl.LINES, this.lines());
      for (const mesh of parts) {
        if (mesh.pins) {
          this.drawAs(gl.LINES, mesh.pins);
          this.drawAs(gl.TRIANGLES, mesh.triangles);
        } else {
          this.buffer(mesh);
          gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.index);
          gl.drawElements(gl.TRIANGLES, 6 * LOBE_ROWS * LOBE_COLUMNS, gl.UNSIGNED_INT, 0);
        }
      }
      if (this.drawsThrough()) this.drawPlane();
    });
  }

  // Over the rest, which shows through it.
  drawPlane() {
    const { gl } = this, opacity = gl.getUniformLocation(this.program, "opacity");
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ZERO, gl.ONE);
    gl.uniform1f(opacity, 0.3);
    this.drawAs(gl.TRIANGLES, this.plane());
    gl.uniform1f(opacity, 1);
    gl.disable(gl.BLEND);
  }

  drawAs(kind, data) {
    this.buffer(data);
    this.gl.drawArrays(kind, 0, data.length / 9);
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
    const canvas = this.canvas, through = this.drawsThrough();
    fitted(canvas, canvas.clientWidth, canvas.clientHeight);
    const g = canvas.getContext("2d");
    const [w, h] = [canvas.width, canvas.height], size = 0.42 * Math.min(w, (through ? 1.1 : 1.7) * h);
    const ground = (through ? 0.5 : 0.85) * h;
    g.fillStyle = "#f4f4f4";
    g.fillRect(0, 0, w, h);
    g.lineWidth = 2;
    g.strokeStyle = "#999";
    g.beginPath();
    g.arc(w / 2, ground, size, through ? 0 : Math.PI, 2 * Math.PI);
    if (through) { g.moveTo(w / 2 - size, ground); g.lineTo(w / 2 + size, ground); }
    g.stroke();
    this.lobes.forEach((lobe, k) => {
      g.strokeStyle = ["#111", "#d55e00"][k % 2];
      g.setLineDash(k ? [4, 4] : []);
      for (const part of lobe.parts) {
        g.beginPath();
        for (const [theta, value] of part.table.spots ? this.spotsInPlane(part) : this.inPlane(part)) {
          const r = size * this.radius(value, part.table);
          g.lineTo(w / 2 + r * Math.sin(theta * RAD), ground - this.side(part.table) * r * Math.cos(theta * RAD));
        }
        g.stroke();
      }
    });
    g.setLineDash([]);
  }

  // (theta, value) in the plane of incidence, the mirror's side positive.
  inPlane({ table, layer }) {
    return Array.from({ length: 179 }, (_, k) => {
      const theta = k - 89;
      const wo = direction(Math.abs(theta) * RAD, (this.light.phi + (theta > 0 ? 180 : 0)) * RAD);
      return [theta, table.value(layer, this.colour, this.light.theta, this.light.phi, wo)];
    });
  }

  spotsInPlane({ table, values }) {
    const [c, s] = [Math.cos(this.light.phi * RAD), Math.sin(this.light.phi * RAD)];
    const stop = table.nearestStop(this.light.theta, this.light.phi);
    const found = table.spotsAt(this.light.phi).map((wo, k) => [wo, values[k], k])
      .filter(([, , k]) => !table.isAbsent(stop, k))
      .filter(([wo]) => Math.abs(wo[1] * c - wo[0] * s) < 0.03)
      .map(([wo, value]) => [Math.atan2(-(wo[0] * c + wo[1] * s), wo[2]) / RAD, value]);
    return found.sort((a, b) => a[0] - b[0]);
  }
}
