// What pictures shaded with a table share: the table as textures, its values between measured light directions, the eye.

const CORNERS_VERTEX = "in vec2 corner; out vec2 at; void main() { at = corner; gl_Position = vec4(corner, 0., 1.); }";
const TABLE_FRAGMENT = `
precision highp sampler2DArray;
in vec2 at; out vec4 colour;
uniform sampler2DArray measured, model;
uniform int angles, azimuths; uniform bool relative, mirrored, split, two;
uniform float theta[64], phi[64];
uniform vec3 right, up, towards;
uniform vec2 view, alpha, slopes, size; uniform float turn, eta;
const float PI = 3.14159265358979;

// A stop's bins in a direction of the sample's frame.
vec3 bins(bool left, vec3 w, int stop) {
  vec2 uv = vec2(atan(w.y, w.x) / (2. * PI) + .5 / size.x, (atan(length(w.xy), w.z) / (.5 * PI) * (size.y - 1.) + .5) / size.y);
  return left ? texture(measured, vec3(uv, float(stop))).rgb : texture(model, vec3(uv, float(stop))).rgb;
}

// As in table.js.
float projected(vec3 w) {
  return .5 * (w.z + length(vec3(w.z, slopes * w.xy)));
}

// As in table.js.
float fresnel(float c) {
  float squared = eta * eta - 1. + c * c;
  if (squared <= 0.) return 1.;
  float g = sqrt(squared), a = (g - c) / (g + c), b = (c * (g + c) - 1.) / (c * (g - c) + 1.);
  return .5 * a * a * (1. + b * b);
}

// The table's frame for light from wi.
mat3 frame_of(vec3 wi) {
  float turned = !relative ? turn : length(wi.xy) > 0. ? atan(wi.y, wi.x) : 0., c = cos(turned), s = sin(turned);
  mat3 m = mat3(c, -s, 0., s, c, 0., 0., 0., 1.);
  vec3 there = m * wi;
  vec2 fold = mirrored ? vec2(there.x < 0. ? -1. : 1., there.y < 0. ? -1. : 1.) : vec2(1.);
  return mat3(fold.x, 0., 0., 0., fold.y, 0., 0., 0., 1.) * m;
}

// Measured light directions around wi, of weight 0 where there are fewer: where they are, and their textures.
vec3 near[4]; float weight[4]; int layer[4];
void find(vec3 wi) {
  float t = acos(min(wi.z, 1.)), p = mod(atan(wi.y, wi.x), 2. * PI);
  int low = 0;
  for (int k = 1; k < 63; k += 1) if (k < angles - 1 && t >= theta[k]) low = k;
  int high = min(low + 1, angles - 1);
  float across = high == low ? 0. : clamp((t - theta[low]) / (theta[high] - theta[low]), 0., 1.);
  int first = 0, second = 0; float around = 0.;
  if (azimuths > 1) {
    first = mirrored ? 0 : azimuths - 1;
    for (int k = 0; k < 64; k += 1) if (k < azimuths && phi[k] <= p) first = k;
    second = mirrored ? min(first + 1, azimuths - 1) : (first + 1) % azimuths;
    float width = mod(phi[second] - phi[first], 2. * PI);
    around = second == first ? 0. : min(mod(p - phi[first], 2. * PI) / width, 1.);
  }
  for (int k = 0; k < 4; k += 1) {
    bool far = k > 1, next = k % 2 == 1;
    weight[k] = (far ? across : 1. - across) * (next ? around : 1. - around);
    int row = far ? high : low, column = next ? second : first;
    float azimuth = relative ? 0. : phi[column];
    near[k] = vec3(sin(theta[row]) * cos(azimuth), sin(theta[row]) * sin(azimuth), cos(theta[row]));
    layer[k] = row * azimuths + column;
  }
}

// Where the picture of one of two halves is looked at, from -1 to 1.
float across_half(bool left) {
  return two ? 2. * at.x + (left ? 1. : -1.) : at.x;
}
`;

// A picture of a table's layers, the model's on the right.
class TableView {
  constructor(canvas, table, fragment, orbit) {
    this.canvas = canvas;
    this.table = table;
    this.gl = canvas.getContext("webgl2", { preserveDrawingBuffer: true });
    if (!this.gl) return;
    const gl = this.gl;
    this.tooMany = table.stops > gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS);
    if (this.tooMany) this.gl = null;
    if (this.tooMany) return;
    this.program = program(gl, CORNERS_VERTEX, TABLE_FRAGMENT + fragment);
    this.orbit = new Orbit(canvas, orbit, () => this.draw());
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.bindAttribLocation(this.program, 0, "corner");
    gl.vertexAttribPointer(gl.getAttribLocation(this.program, "corner"), 2, gl.FLOAT, false, 0, 0);
    // Many light directions are taken coarser: all of them lie in the memory of the graphics.
    this.size = table.stops > 300 ? [90, 46] : [180, 91];
    this.textures = [gl.createTexture(), gl.createTexture()];
    this.loaded = [null, null];
  }

  // A layer as textures over (phi, theta) of the sample's frame, one for each stop; folded stops are unfolded here.
  load(unit, layer) {
    const { gl, table } = this;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, this.textures[unit]);
    if (this.loaded[unit] === layer) return;
    this.loaded[unit] = layer;
    const [wide, high] = this.size;
    const azimuths = table.relative ? [null] : table.azimuths;
    const data = new Float32Array(3 * wide * high * table.theta_i.length * azimuths.length);
    const rows = Array.from({ length: high }, (_, k) => table.rowsAt(90 * k / (high - 1)));
    let next = 0;
    for (let angle = 0; angle < table.theta_i.length; angle += 1) {
      for (const azimuth of azimuths) {
        const columns = Array.from({ length: wide }, (_, k) => table.columnsAt(this.stored(azimuth, 360 * k / wide)));
        const stop = angle * table.phi_i.length + (azimuth === null ? 0 : azimuth.index);
        const starts = [0, 1, 2].map((c) => table.at(Math.min(c, table.colours.length - 1), stop, 0));
        for (const row of rows) {
          for (const column of columns) {
            for (const start of starts) {
              // Half floats end at 65,504.
              data[next] = Math.min(table.mixed(layer, start, row, column), 60000);
              next += 1;
            }
          }
        }
      }
    }
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    const layers = table.theta_i.length * azimuths.length;
    gl.texImage3D(gl.TEXTURE_2D_ARRAY, 0, gl.RGB16F, wide, high, layers, 0, gl.RGB, gl.FLOAT, data);
    const set = (name, value) => gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl[name], gl[value]);
    set("TEXTURE_MIN_FILTER", "LINEAR");
    set("TEXTURE_MAG_FILTER", "LINEAR");
    set("TEXTURE_WRAP_S", "REPEAT");
    set("TEXTURE_WRAP_T", "CLAMP_TO_EDGE");
  }

  // The azimuth of the table's bins for one of the folded sample's frame.
  stored(azimuth, phi) {
    if (azimuth === null) return phi;
    const fold = this.table.folded(azimuth.raw - this.table.rotation);
    return Math.atan2(fold.y * Math.sin(phi * RAD), fold.x * Math.cos(phi * RAD)) / RAD + this.table.rotation;
  }

  // Width of the lobe for the choice of points.
  alpha() {
    return this.table.slopes.map((alpha) => Math.min(Math.max(alpha, 0.02), 1));
  }

  two() {
    return Boolean(this.state.model) && this.state.two;
  }

  show(state) {
    this.state = state;
    this.draw();
  }

  set(name, kind, ...values) {
    this.gl[`uniform${kind}`](this.gl.getUniformLocation(this.program, name), ...values);
  }

  // What both pictures set before they draw; `half` is the half height of what the eye sees.
  prepare(half) {
    const { gl, canvas, table, state } = this;
    const ratio = canvas.clientHeight / canvas.clientWidth;
    fitted(canvas, canvas.clientWidth, canvas.clientHeight);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.useProgram(this.program);
    this.load(0, state.measured);
    this.load(1, state.model || state.measured);
    const axes = this.orbit.axes();
    for (const name of ["right", "up", "towards"]) this.set(name, "3fv", axes[name]);
    const azimuths = table.relative ? [0] : table.azimuths.map((a) => a.phi * RAD);
    this.set("measured", "1i", 0);
    this.set("model", "1i", 1);
    this.set("angles", "1i", table.theta_i.length);
    this.set("azimuths", "1i", azimuths.length);
    this.set("theta", "1fv", table.theta_i.map((t) => t * RAD));
    this.set("phi", "1fv", azimuths);
    const flags = { relative: table.relative, mirrored: table.mirrored, split: Boolean(state.model), two: this.two() };
    for (const [name, flag] of Object.entries(flags)) this.set(name, "1i", flag ? 1 : 0);
    // What is drawn fits the narrower side of what each of them has.
    const width = (this.two() ? 0.5 : 1) / ratio, size = half / this.orbit.zoom / Math.min(1, width);
    this.set("view", "2f", size * width, size);
    this.set("alpha", "2fv", this.alpha());
    this.set("slopes", "2fv", table.slopes);
    this.set("size", "2fv", this.size);
    this.set("turn", "1f", table.rotation * RAD);
    this.set("eta", "1f", table.eta || 0);
  }
}
