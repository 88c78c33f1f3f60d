// Promise: a page without a viewer (sweep, budget, law of a scan, list of tables) loads from a file without an error or a
// request, fits any window, and is read in the dark, on paper and aloud (AXE, see comfort.mjs).
//
//   node tests/browser/plain.mjs PAGE.html...
//
// SHOTS is a folder for pictures at 1400, 800 and 400 pixels, and of the dark page.

import { mkdirSync, writeFileSync } from "node:fs";
import { basename, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { Browser, WITHOUT_GL } from "./browser.mjs";
import { LAYOUT, readable } from "./comfort.mjs";

const shots = process.env.SHOTS;
const failures = [];

async function check(page) {
  const hold = (what, holds, found = "") => {
    if (!holds) failures.push(`${page}: ${what}: ${JSON.stringify(found).slice(0, 600)}`);
  };
  const picture = async (browser, name) => {
    if (shots) writeFileSync(join(shots, `${basename(page, ".html")}-${name}.png`), await browser.picture());
  };
  const url = pathToFileURL(resolve(page)).href;
  const browser = new Browser(process.env.CHROMIUM ?? "chromium", WITHOUT_GL);
  await browser.open(url, 1280, 900);
  await browser.until("document.readyState === 'complete'");
  for (const width of [1400, 800, 400]) {
    await browser.resize(width, 900);
    await browser.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
    const found = await browser.evaluate(LAYOUT);
    hold(`layout at ${width} px`, found.length === 0, found);
    await picture(browser, width);
  }
  const there = await browser.evaluate('["body", "#verdict", ".hint", "#contents a", "footer"].filter((selector) => document.querySelector(selector))');
  await readable(browser, hold, there);
  if (shots) {
    await browser.resize(1280, 900);
    await browser.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: "dark" }] });
    await picture(browser, "dark");
  }
  hold("no complaint", browser.complaints.length === 0, browser.complaints);
  const strange = browser.requests.filter((request) => request !== url && !request.startsWith("data:"));
  hold("no request but for the file itself", strange.length === 0, strange);
  await browser.close();
}

if (shots) mkdirSync(shots, { recursive: true });
for (const page of process.argv.slice(2)) await check(page);
for (const failure of failures) console.error(`failed: ${failure}`);
console.log(failures.length === 0 ? "browser: ok" : `browser: ${failures.length} failures`);
process.exit(failures.length === 0 ? 0 : 1);
