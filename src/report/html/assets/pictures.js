// Images of images: a hemisphere for each light direction, measured, model and difference; all slices in one.

// How values become colours: one scale for the whole table.
class Scale {
  constructor(table, colour) {
    this.highest = 0;
    for (const layer of table.layers) {
      const [from, to] = [table.at(colour, 0, 0), table.at(colour, table.stops, 0)];
      for (let k = from; k < to; k += 1) this.highest = Math.max(this.highest, layer.values[k]);
    }
    this.highest = this.highest || 1;
    this.log = true;
    this.decades = 4;
  }

  place(value) {
    if (!this.log) return value / this.highest;
    return value > 0 ? 1 + Math.log10(value / this.highest) / this.decades : 0;
  }

  marks() {
    if (!this.log) return [0, 0.5, 1].map((t) => [t, short(t * this.highest)]);
    return [0, 0.25, 0.5, 0.75, 1].map((t) => [t, short(this.highest * 10 ** (this.decades * (t - 1)))]);
  }

  // Difference as a colour's place: shares of the stop's peak, or factors up to 2.
  difference(measured, model, peak) {
    if (!this.log) return (measured - model) / (0.2 * peak);
    return measured > 0 && model > 0 ? Math.log2(measured / model) : 0;
  }
}

class Pictures {
  constructor(table) {
    this.table = table;
    this.colour = Math.floor(table.colours.length / 2);
    this.scale = new Scale(table, this.colour);
    this.azimuth = 0;
    this.measured = table.layers[0];
    const models = table.layers.filter((layer) => layer.kind === "model");
    this.model = models.find((layer) => layer.name === table.chosen) || models[0];
  }

  draw() {
    const channel = this.table.colours.length > 1 ? " (green)" : "";
    drawLegend(document.getElementById("legend"), viridis, this.scale.marks());
    document.getElementById("legend-caption").textContent = `BRDF${channel}, 1/sr`;
    document.getElementById("difference-figure").hidden = !this.model;
    const marks = this.scale.log ? ["½", "1", "2"] : ["−20 %", "0", "+20 %"];
    drawLegend(document.getElementById("difference-legend"), (t) => diverging(2 * t - 1), marks.map((m, k) => [k / 2, m]));
    document.getElementById("difference-caption").textContent =
      this.scale.log ? "measured / model" : "(measured − model) / peak of the light direction";
    const place = document.getElementById("hemispheres");
    place.replaceChildren();
    place.classList.toggle("measured-only", !this.model);
    this.table.theta_i.forEach((theta, row) => place.append(this.hemisphere(theta, row)));
    this.slices(document.getElementById("slices"));
  }

  hemisphere(theta, row) {
    const stop = row * this.table.phi_i.length + this.azimuth;
    const box = document.createElement("div");
    box.className = "hemisphere";
    const title = document.createElement("h3");
    const phi = this.table.phi_i[this.azimuth];
    title.textContent = `theta_i ${theta}°` + (this.table.phi_i.length > 1 ? `, phi_i ${phi}°` : "");
    box.append(title);
    const [measured, model] = [this.measured, this.model];
    const value = (layer, bin) => layer.values[this.table.at(this.colour, stop, bin)];
    let peak = 1e-30;
    for (let bin = 0; bin < this.table.bins; bin += 1) peak = Math.max(peak, value(measured, bin));
    box.append(this.disc(measured.name, stop, (bin) => viridis(this.scale.place(value(measured, bin)))));
    if (model) {
      box.append(this.disc(model.name, stop, (bin) => viridis(this.scale.place(value(model, bin)))));
      const difference = (bin) => diverging(this.scale.difference(value(measured, bin), value(model, bin), peak));
      box.append(this.disc("difference", stop, difference));
    }
    return box;
  }

  // One disc: every pixel shows the bin that its direction falls into.
  disc(name, stop, colour) {
    const figure = document.createElement("figure");
    const canvas = document.createElement("canvas");
    const caption = document.createElement("figcaption");
    caption.textContent = name.replace("model, ", "");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${name}, light direction ${stop + 1}. Arrow keys read values.`);
    canvas.tabIndex = 0;
    const n = 200;
    canvas.width = canvas.height = n;
    const g = canvas.getContext("2d");
    g.fillStyle = "#e4e4e4";
    g.beginPath();
    g.arc(n / 2, n / 2, n / 2, 0, 2 * Math.PI);
    g.fill();
    if (this.table.spots) this.spots(g, n, stop, colour);
    else this.pixels(g, n, stop, colour);
    this.marks(g, n, stop);
    canvas.addEventListener("pointermove", (event) => {
      const box = canvas.getBoundingClientRect();
      const place = (part, size) => 2 * part / size - 1;
      this.read(place(event.clientX - box.left, box.width), -place(event.clientY - box.top, box.height), stop);
    });
    canvas.addEventListener("keydown", (event) => this.key(event, stop));
    figure.append(canvas, caption);
    return figure;
  }

  // Every direction as a dot in its colour.
  spots(g, n, stop, colour) {
    const size = Math.max(this.table.spots.aperture / 90 * n / 2, 3.5);
    this.table.spotsAt(this.table.lightOf(stop).phi).forEach((wo, bin) => {
      if (this.table.isAbsent(stop, bin)) return;
      const [x, y] = discPlace(wo);
      g.fillStyle = `rgb(${colour(bin).map(Math.round)})`;
      g.beginPath();
      g.arc(n / 2 * (1 + x), n / 2 * (1 - y), size, 0, 2 * Math.PI);
      g.fill();
    });
  }

  pixels(g, n, stop, colour) {
    const image = g.createImageData(n, n);
    for (let y = 0; y < n; y += 1) {
      for (let x = 0; x < n; x += 1) {
        const bin = this.binAt((2 * x + 1) / n - 1, 1 - (2 * y + 1) / n, stop);
        if (bin !== null) image.data.set([...colour(bin), 255], 4 * (y * n + x));
      }
    }
    const over = document.createElement("canvas");
    over.width = over.height = n;
    over.getContext("2d").putImageData(image, 0, 0);
    g.drawImage(over, 0, 0);
  }

  // The bin of a place in the unit disc; the radius is theta_r over 90 degrees.
  binAt(x, y, stop) {
    const radius = Math.hypot(x, y);
    if (this.table.spots) return this.spotAt(x, y, stop);
    if (90 * radius >= this.table.end()) return null;
    const origin = this.table.relative ? this.table.lightOf(stop).phi : 0;
    const phi = Math.atan2(y, x) / RAD - origin;
    const bin = this.table.row(90 * radius) * this.table.columns + this.table.column(phi);
    return this.table.isAbsent(stop, bin) ? null : bin;
  }

  // The single direction that is drawn at a place.
  spotAt(x, y, stop) {
    let best = null, least = Math.max(this.table.spots.aperture, 4) / 90;
    this.table.spotsAt(this.table.lightOf(stop).phi).forEach((wo, bin) => {
      const [u, v] = discPlace(wo), distance = Math.hypot(x - u, y - v);
      if (distance < least && !this.table.isAbsent(stop, bin)) [best, least] = [bin, distance];
    });
    return best;
  }

  marks(g, n, stop) {
    const light = this.table.lightOf(stop), theta = light.theta, phi = light.phi * RAD;
    const at = (sign) => [n / 2 * (1 + sign * theta / 90 * Math.cos(phi)), n / 2 * (1 - sign * theta / 90 * Math.sin(phi))];
    const stroke = (path) => {
      for (const [colour, width] of [["#000", 4], ["#fff", 2]]) {
        g.strokeStyle = colour;
        g.lineWidth = width;
        g.beginPath();
        path();
        g.stroke();
      }
    };
    g.strokeStyle = "rgba(128, 128, 128, .8)";
    g.lineWidth = 1;
    for (const ring of [30, 60, 89.5]) {
      g.beginPath();
      g.arc(n / 2, n / 2, ring / 180 * n, 0, 2 * Math.PI);
      g.stroke();
    }
    const [lx, ly] = at(1), [mx, my] = at(-1);
    stroke(() => g.arc(lx, ly, 6, 0, 2 * Math.PI));
    stroke(() => { g.moveTo(mx - 6, my); g.lineTo(mx + 6, my); g.moveTo(mx, my - 6); g.lineTo(mx, my + 6); });
  }

  // The arrow keys walk over the disc, from its middle on.
  key(event, stop) {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const step = steps[event.key];
    if (!step) return;
    event.preventDefault();
    const from = this.reader && this.reader.stop === stop ? this.reader.at : [0, 0];
    const at = from.map((x, k) => x + step[k] / 30);
    if (Math.hypot(...at) >= 1) return;
    this.reader = { stop, at };
    this.read(...at, stop);
  }

  read(x, y, stop) {
    const bin = this.binAt(x, y, stop);
    if (bin === null) return;
    const [row, column] = [Math.floor(bin / this.table.columns), bin % this.table.columns];
    const value = (layer) => short(layer.values[this.table.at(this.colour, stop, bin)]);
    const range = (edges, k) => `${short(edges[k])}° to ${short(edges[k + 1])}°`;
    const spot = this.table.spots ? this.table.spots.directions[bin] : null;
    const where = spot ? `theta_r ${short(spot[0])}°, phi_r ${short(spot[1])}°`
      : `theta_r ${range(this.table.theta_edges, row)}, phi_r ${range(this.table.phi_edges, column)}`;
    document.getElementById("readout").textContent =
      `${where}: measured ` +
      `${value(this.measured)}${this.model ? `, model ${value(this.model)}` : ""} 1/sr.`;
  }

  slices(canvas) {
    const { rows, columns } = this.table;
    const angles = this.table.theta_i.length, azimuths = this.table.phi_i.length;
    // Single directions are a line each: one below the other.
    const wide = this.table.spots ? 1 : azimuths > 1 ? angles : Math.min(angles, 3);
    const single = this.table.spots || azimuths === 1;
    const lines = single ? Math.ceil(this.table.stops / wide) : azimuths;
    const [width, height] = [wide * (columns + 1) - 1, lines * (rows + 1) - 1];
    canvas.width = width;
    canvas.height = height;
    const zoom = Math.max(1, Math.floor(Math.min(1100 / width, 480 / height)));
    canvas.style.width = `${zoom * width}px`;
    const g = canvas.getContext("2d");
    const image = g.createImageData(width, height);
    for (let stop = 0; stop < this.table.stops; stop += 1) {
      const tile = single ? [stop % wide, Math.floor(stop / wide)] : [Math.floor(stop / azimuths), stop % azimuths];
      for (let bin = 0; bin < this.table.bins; bin += 1) {
        const x = tile[0] * (columns + 1) + bin % columns, y = tile[1] * (rows + 1) + Math.floor(bin / columns);
        const value = this.measured.values[this.table.at(this.colour, stop, bin)];
        const colour = this.table.isAbsent(stop, bin) ? [228, 228, 228] : viridis(this.scale.place(value));
        image.data.set([...colour, 255], 4 * (y * width + x));
      }
    }
    g.putImageData(image, 0, 0);
    document.getElementById("slices-caption").textContent = this.table.spots
      ? "A line for each light direction (theta_i downwards): the sensor's directions in the order of the table. Colours as above."
      : `A tile for each light direction (${azimuths > 1 ? "theta_i from left to right, phi_i downwards" : "theta_i from left to right, then downwards"}): ` +
        `rows are theta_r from 0° to ${short(this.table.end())}°, columns phi_r. Colours as above.`;
  }
}

// Where a direction lies in the unit disc: the radius is its angle from the normal over 90 degrees.
function discPlace(wo) {
  const across = Math.hypot(wo[0], wo[1]);
  const radius = Math.atan2(across, wo[2]) / (90 * RAD);
  return across > 0 ? [radius * wo[0] / across, radius * wo[1] / across] : [0, 0];
}

// The shaded patch: grey values as they are.
function drawPatch(canvas, patch) {
  canvas.width = patch.columns;
  canvas.height = patch.rows;
  canvas.style.aspectRatio = `${patch.columns * patch.aspect} / ${patch.rows}`;
  const g = canvas.getContext("2d");
  const image = g.createImageData(patch.columns, patch.rows);
  bytesOf(patch.shades).forEach((grey, k) => image.data.set([grey, grey, grey, 255], 4 * k));
  g.putImageData(image, 0, 0);
}
