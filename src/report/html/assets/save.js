// What a reader takes along: each plot as SVG, PNG and the numbers behind it, each picture as PNG; and the contents bar.

function element(id) {
  return document.getElementById(id);
}

// Pixels of a saved picture for each of the plot's.
const SAVED_SCALE = 3;

function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// A name for a file: the page's, and what the picture shows.
function fileName(title, ending) {
  const plain = `${document.title} ${title}`.normalize("NFKD").replace(/[^A-Za-z0-9.]+/g, "_").replace(/^_+|_+$/g, "");
  return `${plain.slice(0, 80)}.${ending}`;
}

// A plot as a file of its own: with a background, and the page's rules for it.
function standalone(svg) {
  const copy = svg.cloneNode(true), [, , width, height] = svg.getAttribute("viewBox").split(" ");
  const rules = [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules]);
  const style = document.createElementNS(svg.namespaceURI, "style");
  style.textContent = rules.filter((rule) => rule.selectorText && rule.selectorText.startsWith(".chart")).map((rule) => rule.cssText).join("\n");
  copy.prepend(style);
  for (const [name, value] of Object.entries({ xmlns: svg.namespaceURI, width, height, style: "background: #fff" })) copy.setAttribute(name, value);
  return new XMLSerializer().serializeToString(copy);
}

async function saveSvgAsPng(svg, title) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(standalone(svg))}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [image.width * SAVED_SCALE, image.height * SAVED_SCALE];
  const g = canvas.getContext("2d");
  g.fillStyle = "#fff";
  g.fillRect(0, 0, canvas.width, canvas.height);
  g.drawImage(image, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((blob) => download(fileName(title, "png"), blob));
}

// The ways to save a picture, below it.
function offer(figure, ways) {
  const line = document.createElement("p");
  line.className = "save";
  line.append("save as");
  for (const [text, label, act] of ways) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = text;
    button.setAttribute("aria-label", `${label} as ${text}`);
    button.addEventListener("click", act);
    line.append(button);
  }
  figure.append(line);
}

function offerDownloads() {
  for (const svg of document.querySelectorAll("figure > svg.chart")) {
    // Both halves have plots of the same names.
    const title = svg.getAttribute("aria-label") + (svg.closest("#through") ? ", through" : ""), data = svg.querySelector("metadata");
    const text = (ending, type, content) => [ending.toUpperCase(), title, () => download(fileName(title, ending), new Blob([content()], { type }))];
    const ways = [text("svg", "image/svg+xml", () => standalone(svg)), ["PNG", title, () => saveSvgAsPng(svg, title)]];
    if (data) ways.push(text("csv", "text/csv", () => data.textContent.trimStart()));
    offer(svg.parentElement, ways);
  }
  for (const id of ["relief", "patch", "lobe", "scene", "refraction", "slices", "slices-1"]) {
    const canvas = element(id);
    if (!canvas || !canvas.closest("figure")) continue;
    const title = (canvas.getAttribute("aria-label") || id).split(".")[0];
    offer(canvas.closest("figure"), [["PNG", title, () => canvas.toBlob((blob) => download(fileName(title, "png"), blob))]]);
  }
}

// Links to the sections that are shown.
function fillContents() {
  const links = [...document.querySelectorAll("main > section[id]:not([hidden])")].map((section) => {
    const link = document.createElement("a");
    link.href = `#${section.id}`;
    link.textContent = section.querySelector("h2").textContent;
    return link;
  });
  element("contents").append(...links);
  element("contents").hidden = links.length < 2;
}

// A sheet of paper has nothing to click on: what is folded is shown.
function unfoldForPrint() {
  const folded = () => document.querySelectorAll("details:not([open])");
  let opened = [];
  window.addEventListener("beforeprint", () => {
    opened = [...folded()];
    opened.forEach((details) => (details.open = true));
  });
  window.addEventListener("afterprint", () => opened.forEach((details) => (details.open = false)));
}
