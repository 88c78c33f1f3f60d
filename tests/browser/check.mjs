// Promise: the page loads from a file without an error or a request, its controls work, and its numbers are the
// summary's.
//
//   node tests/browser/check.mjs PAGE.html SUMMARY.json [FOLDER]
//
// SUMMARY.json may be -: the page of a table that has none, on a grid of any kind. Writes screenshots at 1400, 800 and 400
// pixels to FOLDER. CHROMIUM names another program than `chromium`.
//
// Where light goes through the surface there are a disc of it for every light direction, a lobe on both sides, and a pattern
// seen through the surface, as bright as the summary's T.

import { readFileSync, writeFileSync, mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { Browser, WITH_GL, WITHOUT_GL } from "./browser.mjs";
import { comfort, LAYOUT } from "./comfort.mjs";

const [page, summaryFile, folder] = process.argv.slice(2);
const url = pathToFileURL(resolve(page)).href;
const summary = summaryFile === "-" ? null : JSON.parse(readFileSync(summaryFile, "utf8"));
const program = process.env.CHROMIUM ?? "chromium";
const failures = [];

function hold(what, holds, found = "") {
  if (!holds) failures.push(`${what}${found === "" ? "" : `: ${JSON.stringify(found).slice(0, 600)}`}`);
}

function quiet(browser, when) {
  hold(`${when}: no complaint`, browser.complaints.length === 0, browser.complaints);
  const strange = browser.requests.filter((request) => request !== url && !request.startsWith("data:"));
  hold(`${when}: no request but for the file itself`, strange.length === 0, strange);
}

// Every number of a table on the page, by row and key.
const TABLE = (id) => `[...document.querySelectorAll("#${id} tbody tr")].map((row) =>
  [...row.querySelectorAll("td[data-key]")].map((cell) => [cell.dataset.key, cell.textContent]))`;

async function numbers(browser) {
  // The figures of light that has gone through alone.
  const alone = await browser.evaluate("!JSON.parse(document.getElementById('data').textContent).table");
  const share = (stop, key) => summary.stops[stop][alone ? key.replace("albedo", "transmittance") : key];
  // Light that has gone through has tables of its own further down.
  const maskings = summary.comparisons.filter((c) => c.scope === summary.comparisons[0].scope);
  const shown = await browser.evaluate(TABLE("comparisons"));
  const all = maskings[0].stops.length;
  hold("all light directions are listed", shown.length === Math.min(all, 48), shown.length);
  if (shown.length === all) {
    shown.forEach((row, stop) => {
      const wanted = [["theta_i_deg", maskings[0].stops[stop].theta_i_deg.toFixed(1)]];
      if (row.some(([key]) => key === "phi_i_deg")) wanted.push(["phi_i_deg", maskings[0].stops[stop].phi_i_deg.toFixed(1)]);
      wanted.push(["l1_noise", maskings[0].stops[stop].l1_noise?.toFixed(4) ?? "–"]);
      maskings.forEach((masking) => wanted.push(["l1_model", masking.stops[stop].l1_model.toFixed(4)]));
      hold(`figures of stop ${stop}`, JSON.stringify(row) === JSON.stringify(wanted), [row, wanted]);
    });
    const albedos = await browser.evaluate(TABLE("albedos"));
    albedos.forEach((row, stop) => row.filter(([key]) => key.startsWith("albedo")).forEach(([key, text]) => {
      hold(`${key} of stop ${stop}`, text === share(stop, key).toFixed(5), [text, share(stop, key)]);
    }));
    hold("albedos are there", albedos.length === summary.stops.length);
  }
  const cost = await browser.evaluate("document.getElementById('cost').textContent");
  const { wall_s, cpu_s, samples } = summary.cost;
  const figures = [`${wall_s.toFixed(1)} s`, `${cpu_s.toFixed(1)} s of`, `${(samples / 1e6).toFixed(2)} million samples`];
  hold("the cost is the summary's", figures.every((text) => cost.includes(text)), [cost, figures]);
  const verdict = await browser.evaluate("document.getElementById('verdict').textContent");
  const nearest = maskings.find((masking) => masking.masking === summary.nearest_masking);
  hold("the verdict is the summary's", verdict.includes(summary.verdict), verdict);
  const laws = await browser.evaluate("document.getElementById('judgements').textContent");
  hold("every law has its line", summary.judgements.every(({ law, reason }) => laws.includes(law) && laws.includes(reason)), laws);
  hold("the verdict names the nearest masking and its distance", !nearest
    || (verdict.includes(nearest.masking.replace("_", "-")) && verdict.includes(nearest.l1_model.toFixed(4))), verdict);
}

const shot = (id) => `document.getElementById("${id}").toDataURL()`;

// Sets a control as a hand would, and waits for the picture.
async function set(browser, id, value) {
  const drawn = await browser.evaluate("Number(document.body.dataset.drawn)");
  await browser.evaluate(`(() => { const control = document.getElementById("${id}"); control.value = ${JSON.stringify(value)};
    control.dispatchEvent(new Event("input", { bubbles: true })); })()`);
  await browser.until(`Number(document.body.dataset.drawn) > ${drawn}`);
}

async function changes(browser, id, value, pictures) {
  const before = await Promise.all(pictures.map((picture) => browser.evaluate(shot(picture))));
  const old = await browser.evaluate(`document.getElementById("${id}").value`);
  await set(browser, id, value);
  for (const [k, picture] of pictures.entries()) {
    hold(`${id} = ${value} changes ${picture}`, (await browser.evaluate(shot(picture))) !== before[k]);
  }
  await set(browser, id, old);
  for (const [k, picture] of pictures.entries()) {
    hold(`${id} = ${old} brings ${picture} back`, (await browser.evaluate(shot(picture))) === before[k]);
  }
}

async function controls(browser) {
  const shown = await browser.evaluate("!document.getElementById('scene-figure').hidden");
  const lit = await browser.evaluate("!document.getElementById('lamp').parentElement.hidden");
  const both = shown ? ["lobe", "scene"] : ["lobe"];
  await changes(browser, "theta", "15", both);
  await changes(browser, "phi", "40", both);
  await changes(browser, "radius", "linear", ["lobe"]);
  if (shown) {
    for (const light of lit ? ["lamp", "both"] : []) await changes(browser, "lamp", light, ["scene"]);
    await labels(browser);
    await changes(browser, "halves", "one", ["scene"]);
    await changes(browser, "exposure", "2", ["scene"]);
  }
  await changes(browser, "which", "model", ["lobe"]);
  for (const id of both) await arrow(browser, `document.getElementById("${id}")`, id);
  await reading(browser);
  const hemispheres = "[...document.querySelectorAll('#hemispheres canvas')].map((c) => c.toDataURL()).join()";
  const before = await browser.evaluate(hemispheres);
  await browser.evaluate(`(() => { const scale = document.getElementById("scale"); scale.value = "linear";
    scale.dispatchEvent(new Event("input", { bubbles: true })); })()`);
  hold("the scale changes the hemispheres", (await browser.evaluate(hemispheres)) !== before);
}

// Each sphere has its name over it: measurement, model, best fit.
async function labels(browser) {
  const names = await browser.evaluate("[...document.getElementById('scene-labels').children].map((name) => name.textContent)");
  const kinds = await browser.evaluate(`(({ table, through }) => ["measured", "model", "fit"].filter((kind) =>
    [table, through].filter(Boolean).every(({ layers }) => layers.some((layer) => layer.kind === kind))))(JSON.parse(document.getElementById("data").textContent))`);
  hold("every sphere is named", names.length === kinds.length && names[0].startsWith("measured")
    && (!kinds.includes("fit") || names[names.length - 1].startsWith("best fit, ")), [names, kinds]);
  const caption = await browser.evaluate("document.getElementById('scene-caption').textContent");
  hold("the caption says which light, and that the exposure is one", caption.includes("soft sky") && caption.includes("One exposure for all"), caption);
}

const READY = "new Promise((done) => setTimeout(() => requestAnimationFrame(() => setTimeout(done, 0)), 0))";

// Both half-spheres: their discs, legends and lobes.
async function halves(browser, data) {
  const known = [data.table, data.through].filter(Boolean);
  const discs = known.reduce((sum, { layers }) => {
    const models = layers.filter(({ kind }) => kind === "model").length;
    return sum + (models > 0 ? 3 : 1);
  }, 0) * known[0].theta_i.length;
  const labels = await browser.evaluate("[...document.querySelectorAll('#hemispheres canvas')].map((c) => c.getAttribute('aria-label'))");
  hold("every light direction has its discs", labels.length === discs, [labels.length, discs]);
  const of = (words) => labels.filter((label) => label.includes(words)).length;
  hold("discs say which light they show", of("gone through") === discs / known.length
    && of("comes back") === discs - discs / known.length, labels);
  const legends = await browser.evaluate("[...document.querySelectorAll('.legends figcaption')].map((c) => c.textContent)");
  for (const letter of [data.table && "R, what comes back", "T, what goes through"].filter(Boolean)) {
    hold(`a legend of ${letter}`, legends.filter((text) => text.startsWith(letter)).length === 1, legends);
  }
  const titles = await browser.evaluate("[...document.querySelectorAll('.hemisphere h3')].map((title) => title.textContent)");
  known[0].theta_i.forEach((theta, k) => {
    // Snell's law at the mean plane.
    const sine = Math.sin(theta * Math.PI / 180) / data.interface.eta;
    const wanted = sine < 1 ? `theta_r ${(180 - Math.asin(sine) * 180 / Math.PI).toFixed(1)}°` : "total reflection";
    hold(`refraction at ${theta}°`, titles[k].includes(wanted), [titles[k], wanted]);
  });
  await browser.evaluate("[...document.querySelectorAll('#hemispheres canvas')].find((c) => c.getAttribute('aria-label').includes('gone through')).focus()");
  await press(browser, "ArrowRight", 39);
  const text = await browser.evaluate("document.getElementById('readout').textContent");
  const [low, high] = (/^T, theta_r ([0-9.]+)° to ([0-9.]+)°/.exec(text) || []).slice(1).map(Number);
  // Single directions may not lie there.
  if (!data.through.spots) hold("a disc of T reads the table's angles", low >= 90 && high > low && high <= 180, text);
  const caption = await browser.evaluate("document.getElementById('lobe-caption').textContent");
  const side = data.interface.inside ? "T, what goes through, is above" : "T, what goes through, is below";
  hold("the lobe's caption says where T is", caption.includes(side), caption);
  // The eye goes below the surface.
  const lobe = shot("lobe");
  await browser.evaluate("document.getElementById('lobe').focus()");
  for (let k = 0; k < 4; k += 1) await press(browser, "ArrowDown", 40);
  const before = await browser.evaluate(lobe);
  await press(browser, "ArrowDown", 40);
  hold("the lobe is seen from below, too", (await browser.evaluate(lobe)) !== before);
}

// Sets a control of the view through the surface.
async function glass(browser, id, value) {
  await browser.evaluate(`(() => { const control = document.getElementById("${id}"); control.value = "${value}";
    control.dispatchEvent(new Event("input", { bubbles: true })); })()`);
  return browser.evaluate(shot("refraction"));
}

// The light of the brightest pixels in the middle of the first picture from the left, as a share of that of a white square (0.9).
const WHITE = `(() => {
  const view = document.getElementById("refraction"), copy = document.createElement("canvas");
  [copy.width, copy.height] = [view.width, view.height];
  const g = copy.getContext("2d");
  g.drawImage(view, 0, 0);
  const first = copy.width / document.getElementById("scene-labels").children.length;
  const [w, h] = [Math.round(first / 5), Math.round(copy.height / 5)];
  const { data } = g.getImageData(Math.round(first / 2 - w / 2), Math.round(copy.height / 2 - h / 2), w, h);
  const greens = Array.from({ length: w * h }, (_, k) => data[4 * k + 1]).sort((a, b) => a - b);
  return (greens[Math.floor(0.9 * greens.length)] / 255) ** 2.2 / 0.9;
})()`;

async function refraction(browser, data) {
  await browser.evaluate(READY);
  const dome = await browser.evaluate(shot("refraction"));
  await arrow(browser, "document.getElementById('refraction')", "the view through the surface");
  const pane = await glass(browser, "glass", "pane");
  hold("a pane is another picture than half a ball", pane !== dome);
  hold("the pattern's depth changes the picture", (await glass(browser, "depth", "3")) !== pane);
  await glass(browser, "depth", "0");
  const caption = await browser.evaluate("document.getElementById('refraction-caption').textContent");
  const index = data.interface.inside ? 1 / data.interface.eta : data.interface.eta;
  hold("the view says what it shows", caption.includes(`index ${index.toPrecision(4)}`) && caption.includes("one interface"), caption);
  if (!summary || data.interface.inside) return;
  // The eye is about 45 degrees from the normal. T of one bounce falls from angle to angle; 68 directions of one pixel, 8 bits
  // and a power of 2.2 are good for 2 %.
  const near = summary.stops.filter(({ theta_i_deg }) => theta_i_deg >= 15 && theta_i_deg <= 75).map((stop) => stop.transmittance_single);
  const found = await browser.evaluate(WHITE);
  hold("white squares are as bright as T", found > Math.min(...near) - 0.02 && found < Math.max(...near) + 0.02, [found, near]);
  console.log(`white through the surface: ${found.toFixed(3)}, T ${near.map((t) => t.toFixed(3)).join(", ")}`);
  await glass(browser, "glass", "dome");
}

// Height over width of the highlight on the measured sphere, the first from the left, by second moments of its bright pixels,
// with the lamp over the viewer's shoulder.
const HIGHLIGHT = `(() => {
  const scene = document.getElementById("scene"), copy = document.createElement("canvas");
  [copy.width, copy.height] = [scene.width, scene.height];
  const g = copy.getContext("2d");
  g.drawImage(scene, 0, 0);
  const { width, height } = copy, { data } = g.getImageData(0, 0, width, height);
  const first = width / document.getElementById("scene-labels").children.length, radius = .5 * Math.min(first, height);
  const bright = [];
  let most = 0;
  const grey = (k) => data[4 * k + 1];
  // A disc within the sphere, whose radius is 0.78 of half of the picture.
  const inside = (x, y) => (x - first / 2) ** 2 + (y - height / 2) ** 2 < (.72 * radius) ** 2;
  for (let y = 0; y < height; y += 1) for (let x = 0; x < first; x += 1) if (inside(x, y)) most = Math.max(most, grey(y * width + x));
  for (let y = 0; y < height; y += 1) for (let x = 0; x < first; x += 1) if (inside(x, y) && grey(y * width + x) > .75 * most) bright.push([x, y]);
  const spread = (axis) => {
    const mean = bright.reduce((sum, p) => sum + p[axis], 0) / bright.length;
    return Math.sqrt(bright.reduce((sum, p) => sum + (p[axis] - mean) ** 2, 0) / bright.length);
  };
  return spread(1) / spread(0);
})()`;

// Pictures of a table of another kind: the light's slider moves the lobe, an arrow key turns it and reads a hemisphere.
async function otherGrid(browser) {
  const [low, high] = await browser.evaluate('["min", "max"].map((end) => document.getElementById("theta")[end])');
  await set(browser, "theta", low);
  await changes(browser, "theta", high, ["lobe"]);
  await arrow(browser, "document.getElementById('lobe')", "the lobe");
  const inks = "[...document.querySelectorAll('#hemispheres canvas')].map((c) => new Set(c.getContext('2d').getImageData(0, 0, 200, 200).data).size)";
  const colours = await browser.evaluate(inks);
  // A disc of one colour has three values beside its marks and the soft edges of these.
  hold("every hemisphere shows values", colours.length > 0 && colours.every((count) => count > 12), colours);
}

async function arrow(browser, place, what) {
  const picture = `${place}.toDataURL()`;
  const before = await browser.evaluate(picture);
  await browser.evaluate(`${place}.focus()`);
  await press(browser, "ArrowLeft", 37);
  hold(`an arrow key turns ${what}`, (await browser.evaluate(picture)) !== before);
}

async function press(browser, key, windowsVirtualKeyCode) {
  for (const type of ["keyDown", "keyUp"]) {
    await browser.send("Input.dispatchKeyEvent", { type, key, code: key, windowsVirtualKeyCode });
  }
}

// The arrow keys read a hemisphere: what they say is a bin of the table.
async function reading(browser) {
  await browser.evaluate("document.querySelector('#hemispheres canvas').focus()");
  await press(browser, "ArrowRight", 39);
  const text = await browser.evaluate("document.getElementById('readout').textContent");
  hold("an arrow key reads a hemisphere", /theta_r .*phi_r .*measured .* 1\/sr/.test(text), text);
}

async function highlight(browser) {
  const alpha = await browser.evaluate("JSON.parse(document.getElementById('data').textContent).table.alpha");
  await set(browser, "phi", "50");
  await set(browser, "theta", await browser.evaluate("document.getElementById('theta').max"));
  await set(browser, "lamp", "lamp");
  // Nothing is cut off at white.
  await set(browser, "exposure", "-4");
  const ratio = await browser.evaluate(HIGHLIGHT);
  // Brushed along x: facets tilt alpha_y / alpha_x times as far across it. A round highlight is wider than high or
  // higher than wide by the light's height alone.
  if (alpha[1] >= 3 * alpha[0]) hold("brushed metal has a long highlight", ratio > 2, ratio);
  if (alpha[1] === alpha[0]) hold("an isotropic surface has a round highlight", ratio > 1 / 1.5 && ratio < 1.5, ratio);
  console.log(`highlight: ${ratio.toFixed(2)} times as high as wide`);
  await set(browser, "exposure", "0");
  await set(browser, "lamp", "sky");
}

async function withViewer() {
  const browser = new Browser(program, WITH_GL);
  await browser.open(url, 1280, 900);
  await browser.until("document.body.dataset.drawn > 0");
  hold("WebGL 2 is there", await browser.evaluate("document.getElementById('no-webgl').hidden"));
  const drawn = await browser.evaluate("window.firstDrawn");
  console.log(`first picture after ${Math.round(drawn)} ms`);
  for (const width of [1400, 800, 400]) {
    await browser.resize(width, 900);
    // The pictures follow the window.
    await browser.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
    await browser.evaluate(READY);
    const found = await browser.evaluate(LAYOUT);
    hold(`layout at ${width} px`, found.length === 0, found);
    if (folder) writeFileSync(join(folder, `page-${width}.png`), await browser.picture());
  }
  await browser.resize(1280, 900);
  await browser.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
  const data = await browser.evaluate("(({ table, through, interface: two }) => ({ table, through, interface: two }))(JSON.parse(document.getElementById('data').textContent))");
  hold("what light goes through has its view", Boolean(data.through) === (await browser.evaluate("Boolean(document.getElementById('refraction'))")));
  if (data.through) {
    await halves(browser, data);
    if (await browser.evaluate("document.getElementById('no-refraction').hidden")) await refraction(browser, data);
  }
  if (summary) {
    await numbers(browser);
    if (await browser.evaluate("!document.getElementById('lamp').parentElement.hidden")) await highlight(browser);
    await set(browser, "phi", "0");
    await controls(browser);
  } else {
    await otherGrid(browser);
  }
  await comfort(browser, hold);
  quiet(browser, "with WebGL");
  await browser.close();
}

async function withoutWebGl() {
  const browser = new Browser(program, WITHOUT_GL);
  await browser.open(url, 800, 900);
  await browser.until("document.body.dataset.drawn > 0");
  hold("the fallback says so", !(await browser.evaluate("document.getElementById('no-webgl').hidden")));
  hold("no sphere without WebGL", await browser.evaluate("document.getElementById('scene-figure').hidden"));
  const other = "(({ value, min, max }) => (value === max ? min : max))(document.getElementById('theta'))";
  await changes(browser, "theta", summary ? "15" : await browser.evaluate(other), ["lobe"]);
  quiet(browser, "without WebGL");
  if (folder) writeFileSync(join(folder, "no-webgl.png"), await browser.picture("#viewer"));
  await browser.close();
}

if (folder) mkdirSync(folder, { recursive: true });
await withViewer();
await withoutWebGl();
for (const failure of failures) console.error(`failed: ${failure}`);
console.log(failures.length === 0 ? "browser: ok" : `browser: ${failures.length} failures`);
process.exit(failures.length === 0 ? 0 : 1);
