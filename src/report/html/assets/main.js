// Puts the page together: what is there is drawn, what is not stays hidden.

function element(id) {
  return document.getElementById(id);
}

function fill(select, options) {
  for (const [value, text] of options) select.append(new Option(text, value));
  select.parentElement.hidden = options.length < 2;
}

// The viewer's state from its controls.
function viewerState(table) {
  const layer = (id) => table.layers.find((layer) => layer.name === element(id).value);
  const number = (id) => Number(element(id).value);
  return {
    measured: layer("layer"), model: layer("model") || null,
    theta: number("theta"), phi: number("phi"), exposure: number("exposure"),
    log: element("radius").value === "log", which: element("which").value, sky: element("lamp").value === "sky",
    two: element("halves").value === "two",
  };
}

function captions(state, lobe) {
  element("theta-out").textContent = `${state.theta}°`;
  element("phi-out").textContent = `${state.phi}°`;
  element("exposure-out").textContent = `${state.exposure > 0 ? "+" : ""}${state.exposure} EV`;
  const names = lobe.lobes.map((shown) => shown.name).join(" (left), ");
  if (!lobe.gl) {
    const styles = lobe.lobes.map((shown, k) => `${shown.name} (${k ? "dashed" : "solid"})`).join(", ");
    element("lobe-caption").textContent = `${styles} in the plane of incidence, mirror's side to the right. The arc is ` +
      `${short(lobe.peak)} 1/sr.`;
    return;
  }
  const radius = state.log ? `logarithmic, ${lobe.decades} decades` : "linear";
  const nearest = lobe.table.spots ? `Light at theta_i ${short(lobe.light.theta)}°, the nearest that was measured. ` : "";
  element("lobe-caption").textContent = `${nearest}${names}${lobe.lobes.length > 1 ? " (right)" : ""}. Radius ${radius}; 1 is ` +
    `${short(lobe.peak)} 1/sr. Solid line: light; dashed: mirror direction; red: x, green: y.`;
  const halves = state.model ? `Left: ${state.measured.name}; right: ${state.model.name}.` : `${state.measured.name}.`;
  element("scene-caption").textContent = `${halves} ${state.sky ? "A soft sky, brightest in the light's direction." : "One lamp in the light's direction."} ` +
    "On the sphere x runs level around it.";
}

function startViewer(table) {
  element("viewer").hidden = false;
  const names = (kind) => table.layers.filter((layer) => layer.kind === kind).map((layer) => [layer.name, layer.name]);
  fill(element("layer"), names("measured"));
  fill(element("model"), names("model"));
  if (table.chosen) element("model").value = table.chosen;
  const angles = table.theta_i, last = angles[angles.length - 1];
  element("theta").min = Math.floor(angles[0]);
  element("theta").max = Math.ceil(last);
  element("theta").value = angles.includes(45) ? 45 : angles.reduce((a, b) => (Math.abs(b - 45) < Math.abs(a - 45) ? b : a));
  element("phi").value = wrapped(table.phi_i[0], 360);
  const modelled = table.layers.some((layer) => layer.kind === "model");
  for (const id of ["which", "halves"]) element(id).parentElement.hidden = !modelled;
  const lobe = new LobeView(element("lobe"), table);
  // Single directions say nothing of all the others that a sphere needs.
  const scene = table.spots ? { gl: null, show() {} } : new SceneView(element("scene"), table);
  element("no-webgl").hidden = Boolean(lobe.gl);
  element("turning").hidden = !lobe.gl;
  element("scene-figure").hidden = !scene.gl;
  element("no-sphere").hidden = !scene.tooMany;
  if (!scene.gl) for (const id of ["lamp", "exposure", "halves"]) element(id).parentElement.hidden = true;
  let asked = false;
  const update = () => {
    asked = false;
    const state = viewerState(table);
    const both = [state.measured, state.model].filter(Boolean);
    const layers = { both, measured: [state.measured], model: [state.model || state.measured] }[state.which];
    lobe.show({ layers, theta: state.theta, phi: state.phi, log: state.log });
    scene.show(state);
    captions(state, lobe);
    document.body.dataset.drawn = String(Number(document.body.dataset.drawn || 0) + 1);
  };
  const ask = () => {
    if (!asked) requestAnimationFrame(update);
    asked = true;
  };
  element("controls").addEventListener("input", ask);
  window.addEventListener("resize", ask);
  update();
}

function startPictures(table) {
  element("pictures").hidden = false;
  const pictures = new Pictures(table);
  fill(element("azimuth"), table.phi_i.map((phi, k) => [k, `${phi}°`]));
  element("picture-controls").addEventListener("input", () => {
    pictures.azimuth = Number(element("azimuth").value);
    pictures.scale.log = element("scale").value === "log";
    pictures.draw();
  });
  pictures.draw();
}

function start() {
  const data = JSON.parse(element("data").textContent);
  if (data.specimen) drawPatch(element("patch"), data.specimen);
  if (!data.table) return;
  const table = new Table(data.table);
  startViewer(table);
  startPictures(table);
}

start();
