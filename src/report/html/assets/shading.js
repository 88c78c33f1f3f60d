// What pictures shaded with a table share: the table as textures, its values between measured light directions, the eye.

const CORNERS_VERTEX = "in vec2 corner; out vec2 at; void main() { at = corner; gl_Position = vec4(corner, 0., 1.); }";
const TABLE_FRAGMENT = `
precision highp sampler2DArray; precision highp sampler2D;
in vec2 at; out vec4 colour;
uniform sampler2DArray values;
uniform int angles, azimuths; uniform bool relative, mirrored;
uniform float theta[64], phi[64];
uniform vec3 right, up, towards;
uniform vec2 view, alpha, slopes, size; uniform float turn, eta;
const float PI = 3.14159265358979;

// A stop's bins in a direction of the sample's frame.
vec3 bins(vec3 w, int stop) {
  vec2 uv = vec2(atan(w.y, w.x) / (2. * PI) + .5 / size.x, (atan(length(w.xy), w.z) / (.5 * PI) * (size.y - 1.) + .5) / size.y);
  return texture(values, vec3(uv, float(stop))).rgb;
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

float reflected(vec3 w, vec3 h) { return eta > 0. ? fresnel(abs(dot(w, h))) : 1.; }

// BRDF between measured light directions: the same half vector at each neighbour, as table.js does it. Where an arm is beyond
// the last light, both change places (reciprocity).
vec3 brdf(vec3 wi, vec3 wo) {
  if (acos(min(wi.z, 1.)) > theta[angles - 1] && wo.z > wi.z) { vec3 swapped = wi; wi = wo; wo = swapped; }
  mat3 frame = frame_of(wi);
  wi = frame * wi; wo = frame * wo;
  vec3 h = normalize(wi + wo);
  find(wi);
  vec3 sum = vec3(0.); float weights = 0.;
  for (int k = 0; k < 4; k += 1) {
    if (weight[k] <= 0.) continue;
    vec3 w = 2. * dot(h, near[k]) * h - near[k];
    if (w.z <= 0.) continue;
    sum += weight[k] * bins(w, layer[k]) * projected(near[k]) * projected(w);
    weights += weight[k] * reflected(near[k], h);
  }
  return weights > 0. ? sum / weights / (projected(wi) * projected(wo)) * reflected(wi, h) : vec3(0.);
}

// Below the horizon; z = 0 where nothing goes there.
vec3 refracted(vec3 w, vec3 h) {
  float c = dot(w, h), squared = 1. - (1. - c * c) / (eta * eta);
  return c > 0. && squared > 0. ? (c / eta - sqrt(squared)) * h - w / eta : vec3(0.);
}

vec3 upright(vec3 w) { return vec3(w.xy, -w.z); }

float turning(float i, float o) {
  float whole = i + eta * o;
  return i * -o / (whole * whole);
}

float share(vec3 wi, vec3 w, vec3 h) {
  float i = dot(wi, h);
  return turning(i, dot(w, h)) * (1. - fresnel(i)) / (projected(wi) * projected(upright(w)));
}

// Half vector of refraction; z = 0 where no facet refracts wi to w.
vec3 refracting(vec3 wi, vec3 w) {
  vec3 h = normalize((eta > 1. ? -1. : 1.) * (wi + eta * w));
  return h.z > 0. && dot(wi, h) > 0. && dot(w, h) < 0. ? h : vec3(0.);
}

// What a light that \`find\` was asked for sends to w, in the table's frame.
vec3 btdf(vec3 wi, vec3 w, vec3 h) {
  bool facet = h.z > 0.;
  vec3 sum = vec3(0.); float shares = 0.;
  for (int k = 0; k < 4; k += 1) {
    if (weight[k] <= 0.) continue;
    vec3 to = facet ? refracted(near[k], h) : w;
    if (facet ? to.z >= 0. : refracting(near[k], w).z > 0.) continue;
    sum += weight[k] * bins(upright(to), layer[k]);
    shares += weight[k] * (facet ? share(near[k], to, h) : 1.);
  }
  float own = facet ? share(wi, w, h) : 1.;
  return shares > 0. ? sum / max(shares, .1 * own) * own : vec3(0.);
}

vec3 ray_here() { return normalize(at.x * view.x * right + at.y * view.y * up - towards); }
`;

// Layers of a table as textures over (phi, theta) of the sample's frame, one slice for each stop; folded stops are unfolded here.
class TableTextures {
  constructor(gl, table) {
    Object.assign(this, { gl, table });
    // Many light directions are taken coarser: all of them lie in the memory of the graphics.
    this.size = table.stops > 300 ? [90, 46] : [180, 91];
    this.slots = [];
  }

  // The texture of a layer, kept in one of a few slots.
  of(slot, layer) {
    const { gl, slots } = this;
    slots[slot] = slots[slot] || { texture: gl.createTexture(), layer: null };
    if (slots[slot].layer !== layer) this.load(slots[slot].texture, layer);
    slots[slot].layer = layer;
    return slots[slot].texture;
  }

  load(texture, layer) {
    const { gl, table } = this, [wide, high] = this.size;
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
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    const layers = table.theta_i.length * azimuths.length;
    gl.texImage3D(gl.TEXTURE_2D_ARRAY, 0, gl.RGB16F, wide, high, layers, 0, gl.RGB, gl.FLOAT, data);
    smooth(gl);
  }

  // The azimuth of the table's bins for one of the folded sample's frame.
  stored(azimuth, phi) {
    if (azimuth === null) return phi;
    const fold = this.table.folded(azimuth.raw - this.table.rotation);
    return Math.atan2(fold.y * Math.sin(phi * RAD), fold.x * Math.cos(phi * RAD)) / RAD + this.table.rotation;
  }

  // Whether the graphics take so many stops.
  fit() {
    return this.table.stops <= this.gl.getParameter(this.gl.MAX_ARRAY_TEXTURE_LAYERS);
  }

  // Width of the lobe for the choice of directions.
  alpha() {
    return this.table.slopes.map((alpha) => Math.min(Math.max(alpha, 0.02), 1));
  }

  // What a program is told of the table.
  describe(set) {
    const { table } = this;
    const azimuths = table.relative ? [0] : table.azimuths.map((a) => a.phi * RAD);
    set("values", "1i", 0);
    set("angles", "1i", table.theta_i.length);
    set("azimuths", "1i", azimuths.length);
    set("theta", "1fv", table.theta_i.map((t) => t * RAD));
    set("phi", "1fv", azimuths);
    set("relative", "1i", table.relative ? 1 : 0);
    set("mirrored", "1i", table.mirrored ? 1 : 0);
    set("alpha", "2fv", this.alpha());
    set("slopes", "2fv", table.slopes);
    set("size", "2fv", this.size);
    set("turn", "1f", table.rotation * RAD);
    set("eta", "1f", table.eta || 0);
  }
}

// Linear between the texels of the bound array, round in the azimuth.
function smooth(gl) {
  const set = (name, value) => gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl[name], gl[value]);
  set("TEXTURE_MIN_FILTER", "LINEAR");
  set("TEXTURE_MAG_FILTER", "LINEAR");
  set("TEXTURE_WRAP_S", "REPEAT");
  set("TEXTURE_WRAP_T", "CLAMP_TO_EDGE");
}

// Two triangles over everything, for all programs of a context.
function corners(gl) {
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
}

// Pictures of the same thing in several layers, side by side or in strips of one.
class LayersView {
  constructor(canvas, fragment, orbit) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { preserveDrawingBuffer: true });
    if (!this.gl) return;
    this.program = program(this.gl, CORNERS_VERTEX, TABLE_FRAGMENT + fragment, "corner");
    this.orbit = new Orbit(canvas, orbit, () => this.draw());
    corners(this.gl);
  }

  show(state) {
    this.state = state;
    this.draw();
  }

  set(name, kind, ...values) {
    this.gl[`uniform${kind}`](this.gl.getUniformLocation(this.program, name), ...values);
  }

  // Draws every layer in its place after `bind(k)`; `half` is the half height of what the eye sees.
  drawEach(count, half, bind) {
    const { gl, canvas } = this, side = this.state.two && count > 1;
    const share = Math.min(1, Math.sqrt((this.pixels ?? Infinity) / (canvas.clientWidth * canvas.clientHeight * Math.min(window.devicePixelRatio || 1, 2) ** 2)));
    fitted(canvas, share * canvas.clientWidth, share * canvas.clientHeight);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    const at = (k) => Math.round(k * canvas.width / count);
    for (let k = 0; k < count; k += 1) {
      bind(k);
      gl.enable(gl.SCISSOR_TEST);
      // A white line between neighbours.
      const [from, to] = [at(k) + (k > 0 ? 1 : 0), at(k + 1) - (k < count - 1 ? 1 : 0)];
      gl.scissor(from, 0, to - from, canvas.height);
      const [left, wide] = side ? [at(k), at(k + 1) - at(k)] : [0, canvas.width];
      gl.viewport(left, 0, wide, canvas.height);
      gl.useProgram(this.program);
      const axes = this.orbit.axes();
      for (const name of ["right", "up", "towards"]) this.set(name, "3fv", axes[name]);
      // What is drawn fits the narrower side.
      const width = wide / canvas.height, size = half / this.orbit.zoom / Math.min(1, width);
      this.set("view", "2f", size * width, size);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
    gl.disable(gl.SCISSOR_TEST);
  }
}
