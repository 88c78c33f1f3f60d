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

// The viewer's state from its controls.
function viewerState() {
  const number = (id) => Number(element(id).value);
  return {
    theta: number("theta"), phi: number("phi"), exposure: number("exposure"),
    log: element("radius").value === "log", which: element("which").value, sky: element("lamp").value === "sky",
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
  const halves = state.model ? `Left: ${state.measured.name}; right: ${state.model.name}.` : `${state.measured.name}.`;
  element("scene-caption").textContent = `${halves} ${state.sky ? "A soft sky, brightest in the light's direction." : "One lamp in the light's direction."} ` +
    `On the sphere x runs level around it.${inside ? " Eye and lamp are in the medium." : through ? " What comes back of the light (R)." : ""}`;
}

// What the halves of a lobe are.
function sidesInWords(lobe, inside) {
  const halves = lobe.tables.map((table) => `${table.below ? "T, what goes through" : "R, what comes back"}, is ` +
    `${lobe.side(table) > 0 ? "above" : "below"}`);
  return `${halves.join("; ")} the surface. The light comes from ${inside ? "inside, below it" : "outside"}.`;
}

function startViewer(tables, inside) {
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
  element("lobe").closest(".views").classList.toggle("halves", Boolean(back && through));
  if (through) {
    const label = document.createElement("span");
    label.className = "sides";
    label.textContent = "above: outside, below: inside";
    element("lobe").before(label);
    const which = back ? "The lobes on both sides of the surface" : "The lobe beyond the surface";
    element("lobe").setAttribute("aria-label", `${which}. Arrow keys turn the view, plus and minus zoom.`);
  }
  // Single directions say nothing of all the others that a sphere needs.
  const scene = !back || back.spots ? { gl: null, show() {} } : new SceneView(element("scene"), back);
  const refraction = through && new Refraction(through, inside);
  element("no-webgl").hidden = Boolean(lobe.gl);
  element("turning").hidden = !lobe.gl;
  element("scene-figure").hidden = !scene.gl;
  element("no-sphere").hidden = !scene.tooMany;
  if (!scene.gl) for (const id of ["lamp", "exposure"]) element(id).parentElement.hidden = true;
  if (!scene.gl && !(lobe.gl && through)) element("halves").parentElement.hidden = true;
  // Clear surfaces send little back.
  if (through && scene.gl) element("exposure").value = 3;
  let asked = false;
  const update = () => {
    asked = false;
    const state = viewerState();
    const of = (id) => tables.map((table) => chosen(table, id));
    const [measured, model] = [of("layer"), of("model")], both = [measured, model].filter((layers) => layers.every(Boolean));
    lobe.show({ ...state, lobes: { both, measured: [measured], model: both.slice(-1) }[state.which] });
    const layersOf = (table) => ({ measured: measured[tables.indexOf(table)], model: model[tables.indexOf(table)] });
    const shaded = { ...state, ...layersOf(back || table) };
    scene.show(shaded);
    captions(shaded, lobe, inside);
    document.body.dataset.drawn = String(Number(document.body.dataset.drawn || 0) + 1);
    // After the others are on the screen: it takes the longest.
    if (through) setTimeout(() => refraction.show({ ...state, ...layersOf(through) }), 0);
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
  if (data.specimen) drawPatch(element("patch"), data.specimen);
  const { eta = null, inside = false } = data.interface || {};
  const halves = [data.table && new Table(data.table, false, eta), data.through && new Table(data.through, true, eta)].filter(Boolean);
  if (halves.length > 0) {
    startViewer(halves, inside);
    startPictures(halves);
  }
  offerDownloads();
  fillContents();
  unfoldForPrint();
}

start();
