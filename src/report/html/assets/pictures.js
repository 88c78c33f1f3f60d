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

// Cells along a side of the relief that are drawn one by one.
const RELIEF_CELLS = 128;

// The relief seen from above the corner of the smallest x and y, from the back to the front, in grey values of the shaded patch.
function drawRelief(canvas, patch) {
  const { columns, rows, high } = patch, deep = rows / patch.aspect, [cos, sin] = [Math.cos(Math.PI / 6), 0.5];
  const [heights, shades] = [bytesOf(patch.heights), bytesOf(patch.shades)], step = Math.ceil(Math.max(columns, rows) / RELIEF_CELLS);
  const margin = 30, scale = 540 / ((columns + deep) * cos), width = 540 + 2 * margin;
  const height = ((columns + deep) * sin + high) * scale + 2 * margin, ratio = 2;
  canvas.style.aspectRatio = `${width} / ${height}`;
  [canvas.width, canvas.height] = [ratio * width, ratio * height];
  const g = canvas.getContext("2d");
  g.scale(ratio, ratio);
  g.fillStyle = "#fff";
  g.fillRect(0, 0, width, height);
  const place = (x, y, z) => [margin + (x - y + deep) * cos * scale, height - margin - ((x + y) * sin + z) * scale];
  const z = (column, row) => heights[row * columns + column] / 255 * high;
  const corner = (column, row) => place(column, (rows - 1 - row) / patch.aspect, z(column, row));
  const fill = (points, grey) => {
    g.fillStyle = g.strokeStyle = `rgb(${grey},${grey},${grey})`;
    g.beginPath();
    points.forEach(([x, y]) => g.lineTo(x, y));
    g.closePath();
    g.fill();
    // Neighbours leave no seam.
    g.stroke();
  };
  g.lineWidth = 0.7;
  for (let row = 0; row + step < rows; row += step) {
    for (let column = Math.floor((columns - 1) / step) * step - step; column >= 0; column -= step) {
      const [c, r] = [column + step, row + step];
      fill([corner(column, row), corner(c, row), corner(c, r), corner(column, r)], Math.round(45 + 0.8 * shades[row * columns + column]));
    }
  }
  // The sides that face the eye, down to the lowest place.
  const [lastRow, lastColumn] = [rows - 1, columns - 1].map((last) => Math.floor(last / step) * step);
  const front = (rows - 1 - lastRow) / patch.aspect;
  const along = Array.from({ length: lastColumn / step + 1 }, (_, k) => corner(k * step, lastRow));
  fill([...along, place(lastColumn, front, 0), place(0, front, 0)], 120);
  const across = Array.from({ length: lastRow / step + 1 }, (_, k) => corner(0, k * step));
  fill([...across, place(0, front, 0), place(0, (rows - 1) / patch.aspect, 0)], 165);
  const gap = 10 / (cos * scale), [from, to] = [place(0, -gap, 0), place(patch.bar, -gap, 0)];
  g.strokeStyle = g.fillStyle = "#1a1a1a";
  g.lineWidth = 2.5;
  g.beginPath();
  g.moveTo(...from);
  g.lineTo(...to);
  g.stroke();
  g.font = "13px system-ui, 'Liberation Sans', sans-serif";
  g.fillText(patch.bar_text, 0.5 * (from[0] + to[0]) + 8, 0.5 * (from[1] + to[1]) + 14);
  for (const [name, end] of [["x", place(columns, 0, 0)], ["y", place(0, deep, 0)]]) g.fillText(name, end[0] - 4, end[1] + 18);
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
