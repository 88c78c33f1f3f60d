// Promise: a reader finds everything from the bar of contents, takes each plot along as a file, reads on a dark screen and on
// paper; with AXE (the path of axe-core's axe.min.js) nothing serious stands in the way of a screen reader.

import { readFileSync } from "node:fs";

// The WCAG contrast of the text of an element upon the page.
const CONTRAST = `((element) => {
  const part = (value) => (value <= 0.03928 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
  const luminance = (colour) => colour.match(/[0-9.]+/g).slice(0, 3).map((value) => part(value / 255))
    .reduce((sum, value, k) => sum + value * [0.2126, 0.7152, 0.0722][k], 0);
  const [a, b] = [getComputedStyle(element).color, getComputedStyle(document.documentElement).backgroundColor].map(luminance);
  return [(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), b];
})`;

// What a click on every button below the pictures would save: name, type and the beginning of each file.
const SAVED = `(async () => {
  const saved = [], original = window.download;
  window.download = (name, blob) => saved.push(blob.slice(0, 400).text().then((text) => [name, blob.type, text]));
  const buttons = [...document.querySelectorAll(".save button")];
  buttons.forEach((button) => button.click());
  // PNGs are made by and by.
  for (let k = 0; k < 600 && saved.length < buttons.length; k += 1) await new Promise((done) => setTimeout(done, 50));
  window.download = original;
  return Promise.all(saved);
})()`;

// What a picture must have at any width: nothing beyond the page, no text of a plot upon another, none too small.
export const LAYOUT = `(() => {
  const found = [];
  if (document.documentElement.scrollWidth > innerWidth) found.push("page wider than the window: " + document.documentElement.scrollWidth);
  for (const svg of document.querySelectorAll("svg.chart")) {
    const outer = svg.getBoundingClientRect(), name = svg.getAttribute("aria-label");
    const boxes = [...svg.querySelectorAll("text:not(.halo)")].map((text) => [text.textContent, text.getBoundingClientRect()]);
    boxes.forEach(([text, box], k) => {
      if (box.left < outer.left - 1 || box.right > outer.right + 1) found.push(name + ": beyond the picture: " + text);
      const other = boxes.slice(k + 1).find(([, b]) => b.left < box.right - 1 && b.right > box.left + 1 && b.top < box.bottom - 3 && b.bottom > box.top + 3);
      if (other) found.push(name + ": " + text + " over " + other[0]);
    });
    const size = 14 * outer.width / svg.viewBox.baseVal.width;
    if (size < 9.5) found.push(name + ": letters of " + size.toFixed(1) + " px");
  }
  return found;
})()`;

// A page with its pictures: contents, files, and what holds for every page.
export async function comfort(browser, hold) {
  const links = await browser.evaluate("[...document.querySelectorAll('#contents a')].map((a) => a.getAttribute('href').slice(1))");
  const sections = await browser.evaluate("[...document.querySelectorAll('main > section')].filter((s) => s.getClientRects().length).map((s) => s.id)");
  hold("every section has its link", links.length > 2 && JSON.stringify(links) === JSON.stringify(sections), [links, sections]);

  const files = await browser.evaluate(SAVED);
  const charts = await browser.evaluate("document.querySelectorAll('figure > svg.chart').length");
  const of = (ending) => files.filter(([name]) => name.endsWith(ending));
  hold("every plot is saved as SVG and CSV", of(".svg").length === charts && of(".csv").length === charts, [charts, files.length]);
  hold("every plot and picture is saved as PNG", of(".png").length > charts && of(".png").every(([, type]) => type === "image/png"));
  hold("names tell the files apart", new Set(files.map(([name]) => name)).size === files.length, files.map(([name]) => name));
  hold("CSV has its columns and numbers", of(".csv").every(([, , text]) => /^(series,|theta_i_deg,)[^\n]*\n[^\n]*[0-9]/.test(text)), of(".csv").slice(0, 2));
  hold("SVG stands alone", of(".svg").every(([, , text]) => text.startsWith("<svg") && text.includes("http://www.w3.org/2000/svg")), of(".svg").slice(0, 1));

  await readable(browser, hold, ["body", "#verdict", ".hint", "#contents a", "footer"]);
}

// Read in the dark, on paper and aloud; `texts` are looked at in the dark.
export async function readable(browser, hold, texts) {
  const media = (features, type = "") => browser.send("Emulation.setEmulatedMedia", { media: type, features });
  await media([{ name: "prefers-color-scheme", value: "dark" }]);
  for (const selector of texts) {
    const [contrast, paper] = await browser.evaluate(`${CONTRAST}(document.querySelector("${selector}"))`);
    hold(`${selector} is read in the dark`, contrast > 4.5 && paper < 0.05, [contrast, paper]);
  }
  await media([], "print");
  await browser.evaluate("window.dispatchEvent(new Event('beforeprint'))");
  const shown = "[...document.querySelectorAll('#contents, form, .save, details:not([open])')].filter((e) => e.getClientRects().length).map((e) => e.id || e.className)";
  hold("paper has no controls and nothing folded", (await browser.evaluate(shown)).length === 0, await browser.evaluate(shown));
  await browser.evaluate("window.dispatchEvent(new Event('afterprint'))");
  await media([]);

  if (process.env.AXE) {
    await browser.evaluate(`${readFileSync(process.env.AXE, "utf8")}; 0`);
    const found = await browser.evaluate("axe.run().then(({ violations }) => violations.map(({ id, impact, nodes }) => [id, impact, nodes.length, nodes[0].html.slice(0, 120)]))");
    const serious = found.filter(([, impact]) => ["serious", "critical"].includes(impact));
    hold("axe-core finds nothing serious", serious.length === 0, serious);
    console.log(`axe-core: ${found.length} findings, ${serious.length} serious ${JSON.stringify(found.map(([id]) => id))}`);
  }
}
