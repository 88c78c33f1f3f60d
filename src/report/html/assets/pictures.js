// Images of images: a hemisphere for each light direction, measured, model and difference; all slices in one.

// How values become colours: one scale for a whole table, or for a half of it.
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

// The pictures of all halves.
class Pictures {
  constructor(tables) {
    this.halves = tables.map((table) => new HalfPictures(table, tables.length > 1 || table.below));
    this.table = tables[0];
    this.azimuth = 0;
    this.log = true;
  }

  draw() {
    for (const { scale } of this.halves) scale.log = this.log;
    this.legends();
    const place = document.getElementById("hemispheres"), hasModel = this.halves.some((half) => half.model);
    place.replaceChildren();
    place.classList.toggle("measured-only", !hasModel && this.halves.length === 1);
    place.classList.toggle("pairs", !hasModel && this.halves.length > 1);
    this.table.theta_i.forEach((theta, row) => place.append(this.hemispheres(theta, row)));
    this.halves.forEach((half, k) => half.slices(k));
  }

  legends() {
    this.halves.forEach((half, k) => half.legend(k));
    const { model, scale } = this.halves.find((half) => half.model) || this.halves[0];
    document.getElementById("difference-figure").hidden = !model;
    const marks = scale.log ? ["½", "1", "2"] : ["−20 %", "0", "+20 %"];
    drawLegend(document.getElementById("difference-legend"), (t) => diverging(2 * t - 1), marks.map((m, k) => [k / 2, m]));
    document.getElementById("difference-caption").textContent =
      scale.log ? "measured / model" : "(measured − model) / peak of the light direction";
  }

// All discs of a light direction: a row for each half.
  hemispheres(theta, row) {
    const stop = row * this.table.phi_i.length + this.azimuth;
    const box = document.createElement("div");
    box.className = "hemisphere";
    const title = document.createElement("h3");
    const phi = this.table.phi_i[this.azimuth];
    title.textContent = `theta_i ${theta}°` + (this.table.phi_i.length > 1 ? `, phi_i ${phi}°` : "") +
      this.halves.map((half) => half.note(theta)).join("");
    box.append(title);
    if (this.halves.length === 1) {
      box.append(...this.halves[0].discs(stop));
      return box;
    }
    for (const half of this.halves) {
      const line = document.createElement("div");
      line.className = "half";
      line.append(...half.discs(stop));
      box.append(line);
    }
    return box;
  }
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

// The figure of the half at a place among the halves: that of the first is on the page, another is made after its likeness.
function figureOf(place, id, label) {
  const first = document.getElementById(id).parentElement, made = document.getElementById(`${id}-${place}`);
  const figure = place === 0 ? first : made ? made.parentElement : first.cloneNode(true);
  const [canvas, caption] = figure.children;
  if (figure !== first && !made) {
    canvas.id = `${id}-${place}`;
    canvas.setAttribute("aria-label", label);
    caption.removeAttribute("id");
    first.after(figure);
  }
  return [canvas, caption];
}
