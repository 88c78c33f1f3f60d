// A sphere of the material in a soft sky, in the light of a lamp, or both: the picture that `gonio render` makes, for each layer.
//
// The eye is the table's light and the sky its sensor (reciprocity). The directions of the integral are fixed: mirror images, or
// refractions, of the eye at fixed normals, and even ones. Their weights, f cos over the density, are found once at nodes of the
// eye's direction and interpolated: no random numbers, the same picture every time.

// Directions of each kind; nodes of the eye's polar angle, and of its azimuth where azimuths differ.
const RULE_COUNT = 40, RULE_POLAR = 61, RULE_AROUND = 36;

// Pixels of the whole picture at first; from how long those take it is decided how many are drawn within so many milliseconds from
// then on, all of the canvas or, without a graphics processor, no fewer than a picture needs.
const FIRST_PIXELS = 24000, WITHIN_MS = 150, FEWEST_PIXELS = 12000;

const RULE_FRAGMENT = `
uniform ivec2 nodes; uniform vec4 entry; uniform bool below; uniform float count;

float ggx(vec3 h, vec2 a) {
  vec3 q = vec3(h.xy / a, h.z);
  return 1. / (PI * a.x * a.y * dot(q, q) * dot(q, q));
}

// Directions for a unit of solid angle about w, in all.
float density(vec3 eye, vec3 w) {
  vec3 h = below ? refracting(eye, upright(w)) : normalize(eye + w);
  float even = count * w.z / PI;
  if (h.z <= 0.) return even;
  float i = dot(eye, h), normals = below ? eta * eta * turning(i, dot(upright(w), h)) / i : 1. / (4. * i);
  return even + count * (ggx(h, alpha) + ggx(h, .25 * alpha)) * h.z * normals;
}

void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  float t = min(.5 * PI * float(texel.y) / float(nodes.y - 1), 1.562), p = 2. * PI * float(texel.x) / float(nodes.x);
  vec3 eye = vec3(sin(t) * cos(p), sin(t) * sin(p), cos(t)), w = entry.xyz;
  if (entry.w > 0.) w = below ? upright(refracted(eye, w)) : 2. * dot(eye, w) * w - eye;
  colour = vec4(0.);
  if (w.z <= 0. || (entry.w > 0. && dot(eye, entry.xyz) <= 0.)) return;
  float part = w.z / density(eye, w);
  if (!below) { colour = vec4(part * brdf(eye, w), part); return; }
  mat3 to_table = frame_of(eye);
  vec3 wi = to_table * eye, onwards = to_table * upright(w);
  find(wi);
  colour = vec4(part * btdf(wi, onwards, refracting(wi, onwards)), part);
}`;

// The rule of a table: where its directions go, and what a layer sends there.
class Rule {
  constructor(gl, table) {
    Object.assign(this, { gl, table, textures: new TableTextures(gl, table), slots: [] });
    this.program = program(gl, CORNERS_VERTEX, TABLE_FRAGMENT + RULE_FRAGMENT, "corner");
    this.nodes = [table.relative ? 1 : RULE_AROUND, RULE_POLAR];
    this.entries = Rule.entries(this.textures.alpha());
    this.pattern = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.pattern);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, this.entries.length, 1, 0, gl.RGBA, gl.FLOAT, new Float32Array(this.entries.flat()));
    for (const name of ["TEXTURE_MIN_FILTER", "TEXTURE_MAG_FILTER"]) gl.texParameteri(gl.TEXTURE_2D, gl[name], gl.NEAREST);
  }

  // Normals after a GGX and one a quarter as wide (the last number 1), and even directions (0).
  static entries(alpha) {
    const mirrored = (k) => { let x = 0; for (let bit = 0.5; k > 0; k >>= 1, bit /= 2) x += (k & 1) * bit; return x; };
    return Array.from({ length: RULE_COUNT }, (_, k) => k).flatMap((k) => {
      const u = (k + 0.5) / RULE_COUNT, a = 2 * Math.PI * mirrored(k), slope = Math.sqrt(u / (1 - u));
      const normal = (by) => [...normalised([by * alpha[0] * slope * Math.cos(a), by * alpha[1] * slope * Math.sin(a), 1]), 1];
      return [normal(1), normal(0.25), [Math.sqrt(u) * Math.cos(a), Math.sqrt(u) * Math.sin(a), Math.sqrt(1 - u), 0]];
    });
  }

  // The weights of a layer, [theta, phi] of the eye for each direction; the last channel is that of an even surface.
  of(slot, layer) {
    const { gl, slots, nodes: [wide, high] } = this, values = this.textures.of(slot, layer);
    if (slots[slot] && slots[slot].layer === layer) return slots[slot].texture;
    if (!slots[slot]) {
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
      gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA16F, wide, high, this.entries.length);
      smooth(gl);
      slots[slot] = { texture };
    }
    slots[slot].layer = layer;
    this.frame = this.frame || gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.disable(gl.SCISSOR_TEST);
    gl.viewport(0, 0, wide, high);
    gl.useProgram(this.program);
    const set = (name, kind, ...all) => gl[`uniform${kind}`](gl.getUniformLocation(this.program, name), ...all);
    this.textures.describe(set);
    set("nodes", "2i", wide, high);
    set("below", "1i", this.table.below ? 1 : 0);
    set("count", "1f", RULE_COUNT);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, values);
    const entry = gl.getUniformLocation(this.program, "entry");
    this.entries.forEach((numbers, k) => {
      gl.framebufferTextureLayer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, slots[slot].texture, 0, k);
      gl.uniform4fv(entry, numbers);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    });
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return slots[slot].texture;
  }
}

const SCENE_FRAGMENT = `
uniform sampler2DArray back_rule, through_rule; uniform sampler2D back_pattern, through_pattern;
uniform bvec2 has, alike; uniform bool with_sky, with_lamp;
uniform vec3 base, steps[4], lamp, lamp_light; uniform vec4 axes[4]; uniform float widths[4], exposure, distance_to, index;
const int ENTRIES = ${3 * RULE_COUNT};

// As in src/render/sky.rs: caps with soft edges. A direction that stands for a cone of half angle around sees edges softer by
// what they cross of it, so that few directions leave no traces of their own.
vec3 sky(vec3 w, float around) {
  vec3 sum = base;
  for (int k = 0; k < 4; k += 1) {
    if (widths[k] <= 0.) continue;
    float x = dot(w, axes[k].xyz), across = .6 * around * max(sqrt(max(1. - x * x, 0.)), .5 * around);
    sum += steps[k] / (1. + exp(min((axes[k].w - x) / length(vec2(widths[k], across)), 80.)));
  }
  return sum;
}

// The frame of a place: x level around the sphere or, where azimuths are alike, the eye's azimuth.
mat3 frame_at(vec3 n, vec3 eye, bool all_alike) {
  vec3 x = all_alike ? eye - dot(eye, n) * n : cross(vec3(0., 0., 1.), n);
  x = length(x) > 1e-4 ? normalize(x) : normalize(vec3(1., 0., 0.) - n.x * n);
  return mat3(x, cross(n, x), n);
}

// As in src/render/inside.rs: rough in front, smooth behind.
vec3 inside(vec3 place, vec3 w, float around) {
  vec3 sum = vec3(0.); float part = 1.;
  for (int k = 0; k < 3; k += 1) {
    float c = -dot(place, w);
    place = normalize(place + 2. * c * w);
    float squared = 1. - index * index * (1. - c * c), f = 1.;
    if (squared > 0.) {
      float t = sqrt(squared), s = (index * c - t) / (index * c + t), p = (c - index * t) / (c + index * t);
      f = .5 * (s * s + p * p);
      sum += part * (1. - f) * sky(normalize(index * w + (t - index * c) * place), index * around);
    }
    part *= f;
    w = normalize(w - 2. * dot(w, place) * place);
  }
  return sum;
}

vec2 node(vec3 eye, bool all_alike) {
  float rows = float(${RULE_POLAR}), columns = float(${RULE_AROUND});
  float t = atan(length(eye.xy), eye.z) / (.5 * PI);
  return vec2(all_alike ? .5 : atan(eye.y, eye.x) / (2. * PI) + .5 / columns, (t * (rows - 1.) + .5) / rows);
}

vec3 from_back(vec3 place, vec3 eye) {
  mat3 frame = frame_at(place, eye, alike.x);
  vec3 e = eye * frame, sum = vec3(0.); float whole = 0.;
  vec2 uv = node(e, alike.x);
  for (int k = 0; k < ENTRIES; k += 1) {
    vec4 entry = texelFetch(back_pattern, ivec2(k, 0), 0);
    vec3 w = entry.w > 0. ? 2. * dot(e, entry.xyz) * entry.xyz - e : entry.xyz;
    if (w.z <= 0.) continue;
    vec4 sent = texture(back_rule, vec3(uv, float(k)));
    whole += sent.a;
    sum += sent.rgb * sky(frame * w, sqrt(sent.a / (PI * w.z)));
  }
  return PI * sum / whole;
}

vec3 from_within(vec3 place, vec3 eye) {
  mat3 frame = frame_at(place, eye, alike.y);
  vec3 e = eye * frame, sum = vec3(0.); float whole = 0.;
  vec2 uv = node(e, alike.y);
  for (int k = 0; k < ENTRIES; k += 1) {
    vec4 entry = texelFetch(through_pattern, ivec2(k, 0), 0);
    vec3 w = entry.w > 0. ? refracted(e, entry.xyz) : upright(entry.xyz);
    if (w.z >= 0.) continue;
    vec4 sent = texture(through_rule, vec3(uv, float(k)));
    whole += sent.a;
    sum += sent.rgb * inside(place, frame * w, sqrt(sent.a / (PI * -w.z)));
  }
  return PI * sum / whole;
}

void main() {
  vec3 eye = distance_to * towards, ray = ray_here();
  float b = dot(eye, ray), root = b * b - dot(eye, eye) + 1.;
  vec3 light = vec3(0.);
  if (root <= 0.) {
    if (with_sky) light = sky(ray, 0.);
  } else {
    vec3 place = normalize(eye - (b + sqrt(root)) * ray);
    if (with_sky && has.x) light += from_back(place, -ray);
    if (with_sky && has.y) light += from_within(place, -ray);
    if (with_lamp && has.x) {
      mat3 frame = frame_at(place, -ray, alike.x);
      vec3 wi = lamp * frame;
      if (wi.z > 0.) light += lamp_light * wi.z * brdf(-ray * frame, wi);
    }
  }
  // sRGB, cut off at white.
  light = min(exposure * light, vec3(1.));
  colour = vec4(mix(12.92 * light, 1.055 * pow(light, vec3(1. / 2.4)) - .055, step(.0031308, light)), 1.);
}`;

class SceneView extends LayersView {
  // `scene`: sky, lamp and camera as src/render has them. Tables of light that comes back and that goes through; one may be missing.
  constructor(canvas, scene, back, through) {
    const { azimuth_deg, height_deg } = scene.camera, table = back || through;
    super(canvas, SCENE_FRAGMENT, { azimuth: (table.phi_i[0] + azimuth_deg) * RAD, height: height_deg * RAD, zoom: 1, lowest: -1.5 });
    Object.assign(this, { scene, back, through });
    // Weights are drawn into a texture of half floats.
    if (this.gl && !["EXT_color_buffer_float", "EXT_color_buffer_half_float"].some((name) => this.gl.getExtension(name))) this.gl = null;
    if (!this.gl) return;
    this.rules = [back, through].map((one) => one && new Rule(this.gl, one));
    this.tooMany = this.rules.some((rule) => rule && !rule.textures.fit());
    if (this.tooMany) this.gl = null;
  }

  // What the page sees of a layer: that of the half which comes back, and that which goes through.
  draw() {
    if (!this.gl || !this.state) return;
    const { state, scene } = this, all = () => this.drawEach(state.pairs.length, scene.camera.half, (k) => this.bind(k, state.pairs[k]));
    if (this.pixels) {
      all();
      return;
    }
    // Weights are made before the time is taken.
    state.pairs.forEach((pair, k) => this.bind(k, pair));
    const begin = this.finished();
    this.pixels = FIRST_PIXELS;
    all();
    this.pixels = Math.max(FIRST_PIXELS * WITHIN_MS / (this.finished() - begin), FEWEST_PIXELS);
    all();
  }

  // The time when all that was asked for is drawn.
  finished() {
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
    return performance.now();
  }

  bind(k, pair) {
    const { gl, scene, state, rules } = this;
    const shown = rules.map((rule, half) => (rule && pair[half] ? rule.of(k, pair[half]) : null));
    const first = rules.find(Boolean), values = first.textures.of(k, pair.find(Boolean));
    gl.useProgram(this.program);
    first.textures.describe((...all) => this.set(...all));
    // Samplers of different kinds have units of their own, used or not.
    const units = [["back_rule", "back_pattern"], ["through_rule", "through_pattern"]];
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, values);
    units.forEach(([rule, pattern], half) => {
      this.set(rule, "1i", 1 + 2 * half);
      this.set(pattern, "1i", 2 + 2 * half);
      if (!shown[half]) return;
      gl.activeTexture(gl.TEXTURE1 + 2 * half);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, shown[half]);
      gl.activeTexture(gl.TEXTURE2 + 2 * half);
      gl.bindTexture(gl.TEXTURE_2D, rules[half].pattern);
    });
    gl.activeTexture(gl.TEXTURE0);
    this.set("has", "2i", ...shown.map((rule) => (rule ? 1 : 0)));
    this.set("alike", "2i", ...rules.map((rule) => (rule && rule.table.relative ? 1 : 0)));
    const lamp = direction(state.theta * RAD, state.phi * RAD), steps = scene.sky.steps;
    this.set("with_sky", "1i", state.light === "lamp" ? 0 : 1);
    this.set("with_lamp", "1i", state.light === "sky" ? 0 : 1);
    this.set("base", "3fv", scene.sky.base);
    this.set("steps", "3fv", steps.flatMap((step) => step.colour));
    // The last step is the bright place, which follows the light.
    this.set("axes", "4fv", steps.flatMap((step, n) => [...(n < steps.length - 1 ? step.axis : lamp), step.centre]));
    this.set("widths", "1fv", steps.map((step) => step.width));
    this.set("lamp", "3fv", lamp);
    this.set("lamp_light", "3fv", scene.lamp);
    this.set("exposure", "1f", 2 ** state.exposure);
    this.set("distance_to", "1f", scene.camera.distance);
    this.set("index", "1f", (this.through && this.through.eta) || 1);
  }
}
