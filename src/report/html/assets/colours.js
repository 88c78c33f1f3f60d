// Colour maps, canvases of the right size, numbers in few characters.

// Viridis by the polynomial fit of Matt Zucker (shadertoy WlfXRN, CC0): dark to bright, also in grey.
function viridis(t) {
  const c = [[0.2777273, 0.0054073, 0.3340998], [0.1050930, 1.4046135, 1.3845902], [-0.3308618, 0.2148476, 0.0950952],
    [-4.6342305, -5.7991010, -19.3324410], [6.2282699, 14.1799334, 56.6905526], [4.7763850, -13.7451454, -65.3530326],
    [-5.4354559, 4.6458526, 26.3124352]];
  t = Math.min(Math.max(t, 0), 1);
  return [0, 1, 2].map((k) => 255 * Math.min(Math.max(c.reduceRight((sum, row) => sum * t + row[k], 0), 0), 1));
}

// Blue (below), white (equal), red-brown (above); -1 to 1.
function diverging(t) {
  t = Math.min(Math.max(t, -1), 1);
  const end = t < 0 ? [33, 82, 163] : [163, 45, 20];
  const part = Math.abs(t) ** 0.8;
  return end.map((x) => 250 + (x - 250) * part);
}

function short(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e-2 && size < 1e4 ? String(Number(value.toPrecision(3))) : value.toExponential(1);
}

// Sizes a canvas for its place on the page; true where that changed.
function fitted(canvas, width, height) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width === w && canvas.height === h) return false;
  canvas.width = w;
  canvas.height = h;
  return true;
}

// A bar of colours with numbers below it: marks are [place 0 to 1, text].
function drawLegend(canvas, colour, marks) {
  const [width, height] = [Math.min(320, document.body.clientWidth - 40), 42];
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  fitted(canvas, width, height);
  const g = canvas.getContext("2d");
  const ratio = canvas.width / width;
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, width, height);
  for (let x = 20; x < width - 20; x += 1) {
    g.fillStyle = `rgb(${colour((x - 20) / (width - 41)).map(Math.round)})`;
    g.fillRect(x, 2, 1.5, 18);
  }
  g.fillStyle = "#1a1a1a";
  g.font = "13px system-ui, 'Liberation Sans', sans-serif";
  g.textAlign = "center";
  for (const [place, text] of marks) {
    const x = 20 + place * (width - 41);
    g.fillRect(x, 20, 1, 4);
    const half = g.measureText(text).width / 2 + 1;
    g.fillText(text, Math.min(Math.max(x, half), width - half), 38);
  }
}
