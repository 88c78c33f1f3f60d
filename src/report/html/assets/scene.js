// A sphere on a plane, lit by one lamp or by a soft sky and shaded with the table; the other half with the model.

const SCENE_FRAGMENT = `
uniform bool sky; uniform vec3 lamp; uniform float exposure;

float reflected(vec3 w, vec3 h) { return eta > 0. ? fresnel(abs(dot(w, h))) : 1.; }

// BRDF between measured light directions: the same half vector at each neighbour, as table.js does it.
vec3 brdf(bool left, vec3 wi, vec3 wo) {
  if (acos(wi.z) > theta[angles - 1] && wo.z > wi.z) { vec3 swapped = wi; wi = wo; wo = swapped; }
  mat3 frame = frame_of(wi);
  wi = frame * wi; wo = frame * wo;
  vec3 h = normalize(wi + wo);
  find(wi);
  vec3 sum = vec3(0.); float weights = 0.;
  for (int k = 0; k < 4; k += 1) {
    if (weight[k] <= 0.) continue;
    vec3 w = 2. * dot(h, near[k]) * h - near[k];
    if (w.z <= 0.) continue;
    sum += weight[k] * bins(left, w, layer[k]) * projected(near[k]) * projected(w);
    weights += weight[k] * reflected(near[k], h);
  }
  return weights > 0. ? sum / weights / (projected(wi) * projected(wo)) * reflected(wi, h) : vec3(0.);
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
  float across = across_half(left);
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

class SceneView extends TableView {
  constructor(canvas, table) {
    super(canvas, table, SCENE_FRAGMENT, { azimuth: table.phi_i[0] * RAD + 0.9, height: 0.5, zoom: 1 });
  }

  draw() {
    if (!this.gl || !this.state) return;
    const { gl, state } = this;
    this.prepare(0.33);
    this.set("sky", "1i", state.sky ? 1 : 0);
    this.set("lamp", "3fv", direction(Math.max(state.theta, 0.5) * RAD, state.phi * RAD));
    this.set("exposure", "1f", 2 ** state.exposure);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}
