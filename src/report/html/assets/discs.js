// A hemisphere as a disc for each light direction, and all slices as one picture.

// The pictures of a table, or of a half: R, T.
class HalfPictures {
  constructor(table, named) {
    this.table = table;
    this.letter = named ? (table.below ? "T" : "R") : "";
    this.colour = Math.floor(table.colours.length / 2);
    this.scale = new Scale(table, this.colour);
    this.measured = table.layers[0];
    const models = table.layers.filter((layer) => layer.kind === "model");
    this.model = models.find((layer) => layer.name === table.chosen) || models[0];
  }

  legend(place) {
    const [canvas, caption] = figureOf(place, "legend", "Colours of light that has gone through");
    drawLegend(canvas, viridis, this.scale.marks());
    const what = { R: "R, what comes back: BRDF", T: "T, what goes through: BTDF" }[this.letter] || "BRDF";
    caption.textContent = `${what}${this.table.colours.length > 1 ? " (green)" : ""}, 1/sr`;
  }

  // Where the mean plane sends light through, in words.
  note(theta) {
    if (!this.table.below || !this.table.eta) return "";
    const onwards = this.table.onwards(theta, 0);
    const below = onwards && Math.atan2(Math.hypot(onwards[0], onwards[1]), -onwards[2]) / RAD;
    return onwards ? `: refracted to theta_r ${(180 - below).toFixed(1)}°` : ": total reflection at the mean plane";
  }

  discs(stop) {
    const [measured, model] = [this.measured, this.model];
    const value = (layer, bin) => layer.values[this.table.at(this.colour, stop, bin)];
    let peak = 1e-30;
    for (let bin = 0; bin < this.table.bins; bin += 1) peak = Math.max(peak, value(measured, bin));
    const discs = [this.disc(measured.name, stop, (bin) => viridis(this.scale.place(value(measured, bin))))];
    if (model) {
      discs.push(this.disc(model.name, stop, (bin) => viridis(this.scale.place(value(model, bin)))));
      const difference = (bin) => diverging(this.scale.difference(value(measured, bin), value(model, bin), peak));
      discs.push(this.disc("difference", stop, difference));
    }
    return discs;
  }

  // One disc: every pixel shows the bin that its direction falls into.
  disc(name, stop, colour) {
    const figure = document.createElement("figure");
    const canvas = document.createElement("canvas");
    const caption = document.createElement("figcaption");
    const letter = this.letter ? `${this.letter}, ` : "";
    caption.textContent = letter + name.replace("model, ", "");
    const way = { R: ", light that comes back", T: ", light that has gone through" }[this.letter] || "";
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${name}${way}, light direction ${stop + 1}. Arrow keys read values.`);
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
    const cross = (x, y, slant) => {
      for (const sign of [1, -1]) {
        const [u, v] = slant ? [4.5, 4.5 * sign] : sign > 0 ? [6, 0] : [0, 6];
        g.moveTo(x - u, y - v);
        g.lineTo(x + u, y + v);
      }
    };
    if (this.table.below) {
      const onwards = this.table.onwards(theta, light.phi);
      if (!onwards) return;
      const [u, v] = discPlace([onwards[0], onwards[1], -onwards[2]]);
      stroke(() => cross(n / 2 * (1 + u), n / 2 * (1 - v), true));
      return;
    }
    const [lx, ly] = at(1), [mx, my] = at(-1);
    stroke(() => g.arc(lx, ly, 6, 0, 2 * Math.PI));
    stroke(() => cross(mx, my, false));
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
    const range = ([from, to]) => `${short(from)}° to ${short(to)}°`, around = (edges, k) => [edges[k], edges[k + 1]];
    // As the table has it.
    const theta = (degrees) => (this.table.below ? 180 - degrees : degrees);
    const thetas = () => around(this.table.theta_edges, row).map(theta).sort((a, b) => a - b);
    const spot = this.table.spots ? this.table.spots.directions[bin] : null;
    const where = spot ? `theta_r ${short(theta(spot[0]))}°, phi_r ${short(spot[1])}°`
      : `theta_r ${range(thetas())}, phi_r ${range(around(this.table.phi_edges, column))}`;
    document.getElementById("readout").textContent =
      `${this.letter ? `${this.letter}, ` : ""}${where}: measured ` +
      `${value(this.measured)}${this.model ? `, model ${value(this.model)}` : ""} 1/sr.`;
  }

  // The `place`th picture of all slices.
  slices(place) {
    const [canvas, caption] = figureOf(place, "slices", "All slices of light that has gone through");
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
    const ends = () => [0, this.table.end()].map((theta) => `${short(this.table.below ? 180 - theta : theta)}°`);
    caption.textContent = (this.letter ? `${this.letter}: ` : "") + (this.table.spots
      ? "A line for each light direction (theta_i downwards): the sensor's directions in the order of the table. Colours as above."
      : `A tile for each light direction (${azimuths > 1 ? "theta_i from left to right, phi_i downwards" : "theta_i from left to right, then downwards"}): ` +
        `rows are theta_r from ${ends().join(" to ")}, columns phi_r. Colours as above.`);
  }
}

// Where a direction lies in the unit disc: the radius is its angle from the normal over 90 degrees.
function discPlace(wo) {
  const across = Math.hypot(wo[0], wo[1]);
  const radius = Math.atan2(across, wo[2]) / (90 * RAD);
  return across > 0 ? [radius * wo[0] / across, radius * wo[1] / across] : [0, 0];
}
