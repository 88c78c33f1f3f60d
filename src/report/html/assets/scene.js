// A sphere on a plane, lit by one lamp or by a soft sky and shaded with the table; the other half with the model.

const SCENE_VERTEX = "in vec2 corner; out vec2 at; void main() { at = corner; gl_Position = vec4(corner, 0., 1.); }";
const SCENE_FRAGMENT = `
precision highp sampler2DArray;
in vec2 at; out vec4 colour;
uniform sampler2DArray measured, model;
uniform int angles, azimuths; uniform bool relative, mirrored, sky, split, two;
uniform float theta[64], phi[64];
uniform vec3 right, up, towards, lamp;
uniform vec2 view, alpha, slopes, size; uniform float exposure, turn;
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

// BRDF between measured light directions: the same half vector at each neighbour, as table.js does it.
vec3 brdf(bool left, vec3 wi, vec3 wo) {
  if (acos(wi.z) > theta[angles - 1] && wo.z > wi.z) { vec3 swapped = wi; wi = wo; wo = swapped; }
  float turned = relative ? atan(wi.y, wi.x) : turn;
  mat2 back = mat2(cos(turned), -sin(turned), sin(turned), cos(turned));
  wi.xy = back * wi.xy; wo.xy = back * wo.xy;
  if (mirrored) {
    if (wi.x < 0.) { wi.x = -wi.x; wo.x = -wo.x; }
    if (wi.y < 0.) { wi.y = -wi.y; wo.y = -wo.y; }
  }
  vec3 h = normalize(wi + wo);
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
  vec3 sum = vec3(0.); float weights = 0.;
  for (int k = 0; k < 4; k += 1) {
    bool far = k > 1, next = k % 2 == 1;
    float weight = (far ? across : 1. - across) * (next ? around : 1. - around);
    if (weight <= 0.) continue;
    int row = far ? high : low, column = next ? second : first;
    float azimuth = relative ? 0. : phi[column];
    vec3 there = vec3(sin(theta[row]) * cos(azimuth), sin(theta[row]) * sin(azimuth), cos(theta[row]));
    vec3 w = 2. * dot(h, there) * h - there;
    if (w.z <= 0.) continue;
    sum += weight * bins(left, w, row * azimuths + column) * projected(there) * projected(w);
    weights += weight;
  }
  return weights > 0. ? sum / weights / (projected(wi) * projected(wo)) : vec3(0.);
}

vec3 radiance(vec3 w) {
  if (w.z < 0.) return vec3(.10, .10, .11);
  vec3 box = vec3(1.7, 1.6, 1.45) * exp(7. * (dot(w, lamp) - 1.));
  return mix(vec3(.30, .33, .38), vec3(.62, .70, .85), sqrt(w.z)) + box;
}

bool blocked(vec3 from, vec3 w) {
  vec3 to = from - vec3(0., 0., 1.);
  float b = dot(to, w), c = dot(to, to) - 1.;
  return b < 0. && b * b > c;
}

// Light of the sky: half vectors after GGX and cosines together (balance heuristic), the same points everywhere.
vec3 under_sky(bool left, vec3 place, bool on_plane, mat3 frame, vec3 wo) {
  const int FACETS = 40, COSINES = 32;
  vec3 sum = vec3(0.);
  for (int k = 0; k < FACETS + COSINES; k += 1) {
    bool facet = k < FACETS;
    float count = float(facet ? FACETS : COSINES), index = float(facet ? k : k - FACETS);
    float u = (index + .5) / count, a = 2. * PI * fract(index * .6180339887);
    vec3 wi;
    if (facet) {
      float slope = sqrt(u / (1. - u));
      vec3 h = normalize(vec3(alpha * slope * vec2(cos(a), sin(a)), 1.));
      wi = 2. * dot(h, wo) * h - wo;
    } else {
      wi = vec3(sqrt(u) * vec2(cos(a), sin(a)), sqrt(1. - u));
    }
    if (wi.z <= 1e-3) continue;
    vec3 h = normalize(wi + wo);
    vec2 s = h.xy / (alpha * h.z);
    float d = 1. / (PI * alpha.x * alpha.y * pow(1. + dot(s, s), 2.) * pow(h.z, 4.));
    float pdf = float(FACETS) * d * h.z / (4. * dot(wo, h)) + float(COSINES) * wi.z / PI;
    vec3 w = frame * wi;
    vec3 arriving = on_plane && blocked(place, w) ? vec3(.16) : radiance(w);
    sum += brdf(left, wi, wo) * wi.z / pdf * arriving;
  }
  return sum;
}

void main() {
  bool left = !split || at.x < 0.;
  float across = two ? 2. * at.x + (left ? 1. : -1.) : at.x;
  vec3 eye = vec3(0., 0., .75) + 5.2 * towards;
  vec3 ray = normalize(across * view.x * right + at.y * view.y * up - towards);
  vec3 to = eye - vec3(0., 0., 1.);
  float b = dot(to, ray), c = dot(to, to) - 1., root = b * b - c;
  float sphere = root > 0. ? -b - sqrt(root) : -1., plane = ray.z < 0. ? -eye.z / ray.z : -1.;
  bool on_sphere = sphere > 0.;
  vec3 back = vec3(.93);
  vec3 place = eye + (on_sphere ? sphere : plane) * ray;
  float edge = on_sphere ? 0. : length(place.xy);
  if (!on_sphere && (plane < 0. || edge > 2.6)) { colour = vec4(back, 1.); return; }
  vec3 n = on_sphere ? place - vec3(0., 0., 1.) : vec3(0., 0., 1.);
  vec3 t = on_sphere ? normalize(cross(vec3(0., 0., 1.), n) + vec3(1e-6, 0., 0.)) : vec3(1., 0., 0.);
  mat3 frame = mat3(t, cross(n, t), n);
  vec3 wo = -ray * frame;
  if (wo.z <= 0.) { colour = vec4(0., 0., 0., 1.); return; }
  vec3 light = vec3(0.);
  if (sky) {
    light = under_sky(left, place, !on_sphere, frame, wo);
  } else {
    vec3 wi = lamp * frame;
    bool dark = wi.z <= 0. || (!on_sphere && blocked(place, lamp));
    if (!dark) light = PI * brdf(left, wi, wo) * wi.z;
    light += vec3(.012);
  }
  light = vec3(1.) - exp(-exposure * light);
  light = pow(light, vec3(1. / 2.2));
  colour = vec4(mix(light, back, smoothstep(2.3, 2.6, edge)), 1.);
  if (split && abs(at.x) < .004) colour = vec4(1., 1., 1., 1.);
}`;

class SceneView {
  constructor(canvas, table) {
    this.canvas = canvas;
    this.table = table;
    this.gl = canvas.getContext("webgl2", { preserveDrawingBuffer: true });
    if (!this.gl) return;
    const gl = this.gl;
    this.tooMany = table.stops > gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS);
    if (this.tooMany) this.gl = null;
    if (this.tooMany) return;
    this.program = program(gl, SCENE_VERTEX, SCENE_FRAGMENT);
    this.orbit = new Orbit(canvas, { azimuth: table.phi_i[0] * RAD + 0.9, height: 0.5, zoom: 1 }, () => this.draw());
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

  draw() {
    if (!this.gl || !this.state) return;
    const { gl, canvas, table, state } = this;
    const ratio = canvas.clientHeight / canvas.clientWidth;
    fitted(canvas, canvas.clientWidth, canvas.clientHeight);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.useProgram(this.program);
    this.load(0, state.measured);
    this.load(1, state.model || state.measured);
    const at = (name) => gl.getUniformLocation(this.program, name);
    const axes = this.orbit.axes();
    for (const name of ["right", "up", "towards"]) gl.uniform3fv(at(name), axes[name]);
    const azimuths = table.relative ? [0] : table.azimuths.map((a) => a.phi * RAD);
    gl.uniform1i(at("measured"), 0);
    gl.uniform1i(at("model"), 1);
    gl.uniform1i(at("angles"), table.theta_i.length);
    gl.uniform1i(at("azimuths"), azimuths.length);
    gl.uniform1fv(at("theta"), table.theta_i.map((t) => t * RAD));
    gl.uniform1fv(at("phi"), azimuths);
    const flags = { relative: table.relative, mirrored: table.mirrored, sky: state.sky, split: Boolean(state.model), two: this.two() };
    for (const [name, flag] of Object.entries(flags)) gl.uniform1i(at(name), flag ? 1 : 0);
    gl.uniform3fv(at("lamp"), direction(Math.max(state.theta, 0.5) * RAD, state.phi * RAD));
    // The sphere fits the narrower side of what each of them has.
    const width = (this.two() ? 0.5 : 1) / ratio, half = 0.33 / this.orbit.zoom / Math.min(1, width);
    gl.uniform2f(at("view"), half * width, half);
    gl.uniform2fv(at("alpha"), this.alpha());
    gl.uniform2fv(at("slopes"), this.table.slopes);
    gl.uniform2fv(at("size"), this.size);
    gl.uniform1f(at("exposure"), 2 ** state.exposure);
    gl.uniform1f(at("turn"), table.rotation * RAD);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
