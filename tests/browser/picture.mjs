// Takes a picture of one element of a page, after setting some controls.
//
//   node tests/browser/picture.mjs PAGE.html SELECTOR WIDTH FILE.png [control=value ...]

import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { Browser, WITH_GL } from "./browser.mjs";

const [page, selector, width, file, ...settings] = process.argv.slice(2);
const browser = new Browser(process.env.CHROMIUM ?? "chromium", WITH_GL);
// The page draws as finely as graphics can in 150 ms; here no time passes, and it draws every pixel.
await browser.open(pathToFileURL(resolve(page)).href, Number(width), 900, "; performance.now = () => 0;");
await browser.until("document.body.dataset.drawn > 0");
for (const setting of settings) {
  const [id, value] = setting.split("=");
  await browser.evaluate(`(() => { const control = document.getElementById("${id}"); control.value = "${value}";
    control.dispatchEvent(new Event("input", { bubbles: true })); })()`);
}
await browser.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))");
writeFileSync(file, await browser.picture(selector));
await browser.close();
