// A pattern seen through the surface: half a ball or a pane of the far side's medium in contact with a chequered floor. The
// table describes one interface, so there is one: the floor lies in the medium.
//
// The eye stands where the table's light does. With f of the table, L/n^2 that it sees is the integral of f(eye -> w) |cos w|
// times L/n^2 of the floor where w meets it (Helmholtz's reciprocity): with a floor of 1 everywhere the picture is T.

const REFRACTION_FRAGMENT = `
uniform bool pane; uniform float depth, pixel;

// Mean of the pattern over a square of the width w.
float chequer(vec2 p, float w) {
  const float SQUARE = .25;
  p /= SQUARE; w = max(w / SQUARE, 1e-3);
  vec2 mean = 2. * (abs(fract((p - .5 * w) * .5) - .5) - abs(fract((p + .5 * w) * .5) - .5)) / w;
  return mix(.1, .9, .5 - .5 * mean.x * mean.y);
}

// The floor as it is met from a place within the medium; a solid angle sees a square of it.
float floor_from(vec3 place, vec3 w, float solid) {
  float below = pane ? depth : place.z;
  if (w.z >= 0.) return 0.;
  float way = below / -w.z;
  vec2 at_floor = place.xy + way * w.xy;
  // There the ball's own surface is in between.
  if (!pane && dot(at_floor, at_floor) > 1.) return 0.;
  return chequer(at_floor, max(way * sqrt(solid / -w.z), pixel));
}

// Half vectors after GGX and cosines together (balance heuristic), the same points everywhere.
vec3 seen(vec3 place, mat3 frame, vec3 eye) {
  const int FACETS = 56, COSINES = 12;
  mat3 to_table = frame_of(eye);
  vec3 wi = to_table * eye, sum = vec3(0.);
  find(wi);
  for (int k = 0; k < FACETS + COSINES; k += 1) {
    bool facet = k < FACETS;
    float count = float(facet ? FACETS : COSINES), index = float(facet ? k : k - FACETS);
    float u = (index + .5) / count, a = 2. * PI * fract(index * .6180339887);
    vec3 w;
    if (facet) {
      float slope = sqrt(u / (1. - u));
      w = refracted(eye, normalize(vec3(alpha * slope * vec2(cos(a), sin(a)), 1.)));
    } else {
      w = vec3(sqrt(u) * vec2(cos(a), sin(a)), -sqrt(1. - u));
    }
    if (w.z > -1e-3) continue;
    vec3 h = refracting(eye, w);
    float pdf = float(COSINES) * -w.z / PI;
    if (h.z > 0.) {
      vec2 s = h.xy / (alpha * h.z);
      float d = 1. / (PI * alpha.x * alpha.y * pow(1. + dot(s, s), 2.) * pow(h.z, 4.)), i = dot(eye, h);
      pdf += float(FACETS) * d * h.z * eta * eta * turning(i, dot(w, h)) / i;
    }
    sum += btdf(wi, to_table * w, to_table * h) * -w.z / pdf * floor_from(place, frame * w, 1.5 / pdf);
  }
  return sum;
}

void main() {
  vec3 eye = vec3(0., 0., pane ? 0. : .3) + 5.2 * towards;
  vec3 ray = ray_here();
  float b = dot(eye, ray), root = b * b - dot(eye, eye) + 1., ball = root > 0. ? -b - sqrt(root) : -1., plane = -eye.z / ray.z;
  bool on_ball = !pane && ball > 0. && eye.z + ball * ray.z > 0.;
  vec3 place = eye + (on_ball ? ball : plane) * ray;
  float edge = on_ball ? 0. : length(place.xy);
  if (!on_ball && (ray.z >= 0. || edge > 2.2)) { colour = vec4(vec3(.93), 1.); return; }
  vec3 n = on_ball ? place : vec3(0., 0., 1.);
  vec3 t = on_ball ? normalize(cross(vec3(0., 0., 1.), n) + vec3(1e-6, 0., 0.)) : vec3(1., 0., 0.);
  mat3 frame = mat3(t, cross(n, t), n);
  vec3 light = on_ball || pane ? seen(place, frame, -ray * frame) : vec3(chequer(place.xy, pixel));
  light = pow(min(light, vec3(1.)), vec3(1. / 2.2));
  colour = vec4(mix(light, vec3(.93), smoothstep(1.9, 2.2, edge)), 1.);
}`;

class RefractionView extends LayersView {
  constructor(canvas, table) {
    super(canvas, REFRACTION_FRAGMENT, { azimuth: table.phi_i[0] * RAD + 0.9, height: 0.8, zoom: 1 });
    if (this.gl) this.textures = new TableTextures(this.gl, table);
    if (this.gl && !this.textures.fit()) this.gl = null;
  }

  draw() {
    if (!this.gl || !this.state) return;
    const { gl, state, textures } = this, half = state.pane ? 0.3 : 0.27;
    this.drawEach(state.layers.length, half, (k) => {
      const values = textures.of(k, state.layers[k]);
      gl.useProgram(this.program);
      textures.describe((...all) => this.set(...all));
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D_ARRAY, values);
      this.set("pane", "1i", state.pane ? 1 : 0);
      this.set("depth", "1f", 0.25 * state.depth);
      this.set("pixel", "1f", 2 * 5.2 * half / this.orbit.zoom / this.canvas.height);
    });
  }
}

// The view through the surface with its own controls, or why there is none. It is made when it is first shown, as the
// browser takes a while over its program.
class Refraction {
  constructor(table, inside) {
    Object.assign(this, { table, inside });
    const known = table.eta && table.eta !== 1;
    const why = table.spots ? "Single directions say too little of all the others that a view through the surface needs."
      : known ? "" : "The table does not say of another index on the other side: there is no view through the surface.";
    if (why) this.hide(why);
    else element("refraction-controls").addEventListener("input", () => this.draw());
  }

  hide(why) {
    this.hidden = true;
    element("refraction-figure").hidden = true;
    element("no-refraction").hidden = false;
    element("no-refraction").textContent = why;
  }

  show(state) {
    if (this.hidden) return;
    this.view = this.view || new RefractionView(element("refraction"), this.table);
    if (!this.view.gl) {
      this.hide("This browser has no WebGL 2 for all of the table's light directions: there is no view through the surface.");
      return;
    }
    this.state = state;
    this.draw();
  }

  draw() {
    const pane = element("glass").value === "pane", squares = Number(element("depth").value);
    element("depth-out").textContent = `${squares} ${squares === 1 ? "square" : "squares"}`;
    element("depth").parentElement.hidden = !pane;
    element("refraction-caption").textContent = this.caption(pane);
    this.view.show({ ...this.state, pane, depth: squares });
  }

  caption(pane) {
    const { table, inside, state } = this;
    const names = `${fromLeft(state.layers)} `;
    const shape = pane ? "a pane" : "half a ball", index = (inside ? 1 / table.eta : table.eta).toPrecision(4);
    const what = inside ? `${shape} of air, seen out of a medium of index ${index}` : `${shape} of index ${index}, seen from outside`;
    return `${names}What goes through (T): ${what}, on a shining pattern that it touches. There is one interface, the table's, ` +
      `and light is traced back through it from the eye (L/n² by reciprocity). Left out: what comes back${pane ? "" : ", and light that would meet the ball twice"}. ` +
      `Seen at more than ${short(table.theta_i[table.theta_i.length - 1])}°, the last theta_i, the values are extrapolated.`;
  }
}
