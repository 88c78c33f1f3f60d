// Puts the page together: what is there is drawn, what is not stays hidden.

function fill(select, options) {
  for (const [value, text] of options) select.append(new Option(text, value));
  select.parentElement.hidden = options.length < 2;
}

// The layer of a table that is chosen by name; a half that has not all of them shows its first.
function chosen(table, id) {
  const kind = id === "model" ? "model" : "measured", layers = table.layers.filter((layer) => layer.kind === kind);
  return layers.find((layer) => layer.name === element(id).value) || layers[0] || null;
}

// What is shown side by side, each a layer of every table: measured, model, best fit, where all tables have them.
function pairsOf(tables) {
  const fits = tables.map((table) => table.layers.find((layer) => layer.kind === "fit") || null);
  const kinds = [tables.map((table) => chosen(table, "layer")), tables.map((table) => chosen(table, "model")), fits];
  return kinds.filter((layers) => layers.every(Boolean));
}

function fromLeft(layers) {
  return `${layers.length > 1 ? "From left: " : ""}${layers.map((layer) => layer.name).join("; ")}.`;
}

// Names over the spheres.
function label(layers) {
  element("scene-labels").replaceChildren(...layers.map((layer) => {
    const text = document.createElement("span");
    text.textContent = layer.name;
    return text;
  }));
}

// The viewer's state from its controls.
function viewerState() {
  const number = (id) => Number(element(id).value);
  return {
    theta: number("theta"), phi: number("phi"), exposure: number("exposure"),
    log: element("radius").value === "log", which: element("which").value, light: element("lamp").value,
    two: element("halves").value === "two",
  };
}

function captions(state, lobe, inside) {
  element("theta-out").textContent = `${state.theta}°`;
  element("phi-out").textContent = `${state.phi}°`;
  element("exposure-out").textContent = `${state.exposure > 0 ? "+" : ""}${state.exposure} EV`;
  const names = lobe.lobes.map((shown) => shown.name).join(" (left), ");
  const through = lobe.drawsThrough() ? `${sidesInWords(lobe, inside)} ` : "";
  const peaks = [...new Set(lobe.peaks)].map((peak, k, all) => `${short(peak)} 1/sr${all.length > 1 ? ` for ${"RT"[k]}` : ""}`).join(", ");
  if (!lobe.gl) {
    const styles = lobe.lobes.map((shown, k) => `${shown.name} (${k ? "dashed" : "solid"})`).join(", ");
    element("lobe-caption").textContent = `${styles} in the plane of incidence, mirror's side to the right. ${through}The arc is ` +
      `${peaks}.`;
    return;
  }
  const radius = state.log ? `logarithmic, ${lobe.decades} decades` : "linear";
  const nearest = lobe.table.spots ? `Light at theta_i ${short(lobe.light.theta)}°, the nearest that was measured. ` : "";
  const onwards = !through ? "" : lobe.tables.some((table) => table.below && table.onwards(state.theta, 0))
    ? "; red-violet: refracted at the mean plane (Snell)" : (lobe.tables.some((table) => table.eta) ? "; the mean plane reflects all" : "");
  element("lobe-caption").textContent = `${nearest}${names}${lobe.lobes.length > 1 ? " (right)" : ""}. ${through}Radius ${radius}; 1 is ` +
    `${peaks}. ${through ? "Arrow" : "Solid line"}: light; dashed: mirror direction${onwards}; red: x, green: y.`;
}

const LIGHTS = {
  sky: "A soft sky by formula, brightest in the light's direction",
  both: "A soft sky by formula, brightest in the light's direction, and a lamp there",
  lamp: "One lamp in the light's direction",
};

// What the spheres show. `layers` are those of one table.
function sceneCaption(state, layers, scene, inside) {
  const glass = !scene.through ? ""
    : ` A sphere of ${inside ? "air in the medium" : `index ${scene.through.eta.toPrecision(4)}`}, rough (the table) towards the eye and smooth behind.`;
  const sent = scene.back ? "" : " What comes back is not in the table.";
  element("scene-caption").textContent = `${fromLeft(layers)} ${LIGHTS[state.light]}.${glass}${sent} On the sphere x runs level around it. ` +
    "One exposure for all: linear values become sRGB, cut off at white. `gonio render` makes the same picture.";
}

// What the halves of a lobe are.
function sidesInWords(lobe, inside) {
  const halves = lobe.tables.map((table) => `${table.below ? "T, what goes through" : "R, what comes back"}, is ` +
    `${lobe.side(table) > 0 ? "above" : "below"}`);
  return `${halves.join("; ")} the surface. The light comes from ${inside ? "inside, below it" : "outside"}.`;
}

// The spheres: of light that comes back, of light that goes through where the index is known, or both. Single directions say
// nothing of all the others that a sphere needs.
function startScene(back, through, sphere) {
  const whole = (table) => (table && !table.spots ? table : null);
  const clear = through && through.eta && through.eta !== 1 ? whole(through) : null;
  const scene = whole(back) || clear ? new SceneView(element("scene"), sphere, whole(back), clear) : { gl: null };
  element("scene-figure").hidden = !scene.gl;
  element("no-sphere").hidden = !scene.tooMany;
  // A lamp is seen in what comes back.
  element("lamp").parentElement.hidden = !scene.gl || !scene.back;
  element("exposure").parentElement.hidden = !scene.gl;
  return scene;
}

function startViewer(tables, inside, sphere) {
  element("viewer").hidden = false;
  const [table] = tables, back = tables.find((table) => !table.below), through = tables.find((table) => table.below);
  const names = (kind) => {
    const lists = tables.map(({ layers }) => layers.filter((layer) => layer.kind === kind).map(({ name }) => [name, name]));
    return lists.reduce((longest, list) => (list.length > longest.length ? list : longest));
  };
  fill(element("layer"), names("measured"));
  fill(element("model"), names("model"));
  const preferred = tables.find(({ chosen }) => chosen);
  if (preferred) element("model").value = preferred.chosen;
  const angles = table.theta_i, last = angles[angles.length - 1];
  element("theta").min = Math.floor(angles[0]);
  element("theta").max = Math.ceil(last);
  element("theta").value = angles.includes(45) ? 45 : angles.reduce((a, b) => (Math.abs(b - 45) < Math.abs(a - 45) ? b : a));
  element("phi").value = wrapped(table.phi_i[0], 360);
  const modelled = names("model").length > 0;
  for (const id of ["which", "halves"]) element(id).parentElement.hidden = !modelled;
  const lobe = new LobeView(element("lobe"), tables, inside);
  if (through) {
    const label = document.createElement("span");
    label.className = "sides";
    label.textContent = "above: outside, below: inside";
    element("lobe").before(label);
    const which = back ? "The lobes on both sides of the surface" : "The lobe beyond the surface";
    element("lobe").setAttribute("aria-label", `${which}. Arrow keys turn the view, plus and minus zoom.`);
  }
  const scene = startScene(back, through, sphere);
  const refraction = through && new Refraction(through, inside);
  element("no-webgl").hidden = Boolean(lobe.gl);
  element("turning").hidden = !lobe.gl;
  if (!scene.gl && !(lobe.gl && through)) element("halves").parentElement.hidden = true;
  let asked = false;
  const update = () => {
    asked = false;
    const state = viewerState();
    const of = (id) => tables.map((table) => chosen(table, id));
    const [measured, model] = [of("layer"), of("model")], both = [measured, model].filter((layers) => layers.every(Boolean));
    lobe.show({ ...state, lobes: { both, measured: [measured], model: both.slice(-1) }[state.which] });
    const pairs = pairsOf(tables), seen = pairs.map((layers) => layers[tables.indexOf(back || table)]);
    captions(state, lobe, inside);
    if (scene.gl) {
      const of = (layers, half) => (half ? layers[tables.indexOf(half)] : null);
      const shown = { ...state, pairs: pairs.map((layers) => [of(layers, scene.back), of(layers, scene.through)]) };
      label(seen);
      sceneCaption(state, seen, scene, inside);
      // At first the lobe and all that stands below come before the spheres, whose programs are long.
      if (scene.state) scene.show(shown);
      else setTimeout(() => scene.show(shown), 0);
    }
    document.body.dataset.drawn = String(Number(document.body.dataset.drawn || 0) + 1);
    // After the others are on the screen: it takes the longest.
    const layers = through && pairs.map((all) => all[tables.indexOf(through)]);
    if (through) setTimeout(() => refraction.show({ ...state, layers }), 0);
  };
  const ask = () => {
    if (!asked) requestAnimationFrame(update);
    asked = true;
  };
  element("controls").addEventListener("input", ask);
  window.addEventListener("resize", ask);
  update();
}

function startPictures(tables) {
  element("pictures").hidden = false;
  const pictures = new Pictures(tables);
  fill(element("azimuth"), tables[0].phi_i.map((phi, k) => [k, `${phi}°`]));
  element("picture-controls").addEventListener("input", () => {
    pictures.azimuth = Number(element("azimuth").value);
    pictures.log = element("scale").value === "log";
    pictures.draw();
  });
  pictures.draw();
}

function start() {
  const data = JSON.parse(element("data").textContent);
  if (data.specimen) {
    drawPatch(element("patch"), data.specimen);
    // After what stands above it.
    setTimeout(() => drawRelief(element("relief"), data.specimen), 0);
  }
  const { eta = null, inside = false } = data.interface || {};
  const halves = [data.table && new Table(data.table, false, eta), data.through && new Table(data.through, true, eta)].filter(Boolean);
  if (halves.length > 0) {
    startViewer(halves, inside, data.sphere);
    startPictures(halves);
  }
  offerDownloads();
  fillContents();
  unfoldForPrint();
}

start();
