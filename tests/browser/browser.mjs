// Headless Chromium over its debugging pipe, with nothing but Node: start, evaluate, take pictures, stop.

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const FLAGS = ["--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run", "--hide-scrollbars",
  "--disable-background-networking", "--disable-dev-shm-usage"];
export const WITH_GL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
export const WITHOUT_GL = ["--disable-3d-apis", "--disable-gpu"];
// Notes when a page says for the first time that it has drawn, ms after its start.
const FIRST_DRAWN = `new MutationObserver((_, observer) => {
  window.firstDrawn = performance.now();
  observer.disconnect();
}).observe(document, { subtree: true, attributeFilter: ["data-drawn"] });`;
const PATIENCE_MS = 120_000;

export class Browser {
  constructor(program, flags) {
    this.profile = mkdtempSync(join(tmpdir(), "gonio-browser-"));
    const words = [...FLAGS, ...flags, `--user-data-dir=${this.profile}`, "about:blank"];
    this.process = spawn(program, words, { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    this.waiting = new Map();
    this.listeners = [];
    this.count = 0;
    let text = "";
    this.process.stdio[4].on("data", (bytes) => {
      text += bytes;
      const messages = text.split("\0");
      text = messages.pop();
      messages.forEach((message) => this.receive(JSON.parse(message)));
    });
  }

  receive(message) {
    if (message.id === undefined) {
      this.listeners.forEach((listener) => listener(message));
      return;
    }
    const { resolve, reject } = this.waiting.get(message.id);
    this.waiting.delete(message.id);
    if (message.error) reject(new Error(message.error.message));
    else resolve(message.result);
  }

  send(method, params = {}) {
    this.count += 1;
    const id = this.count;
    this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId: this.session })}\0`);
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      setTimeout(() => reject(new Error(`${method}: no answer`)), PATIENCE_MS).unref();
    });
  }

  // Opens a page; complaints (console errors, exceptions) and requests are kept from its first moment on.
  // `first`: a script of the caller's that runs before the page's.
  async open(url, width, height, first = "") {
    this.complaints = [];
    this.requests = [];
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
    this.session = (await this.send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
    this.listeners = [(event) => this.note(event)];
    for (const domain of ["Page", "Runtime", "Network", "Log"]) await this.send(`${domain}.enable`);
    await this.resize(width, height);
    await this.send("Page.addScriptToEvaluateOnNewDocument", { source: FIRST_DRAWN + first });
    await this.send("Page.navigate", { url });
    await this.until("document.readyState === 'complete'");
  }

  note({ method, params }) {
    if (method === "Runtime.exceptionThrown") {
      this.complaints.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    }
    if (method === "Runtime.consoleAPICalled" && ["error", "warning", "assert"].includes(params.type)) {
      this.complaints.push(params.args.map((arg) => arg.value).join(" "));
    }
    if (method === "Log.entryAdded" && params.entry.level === "error") this.complaints.push(params.entry.text);
    if (method === "Network.requestWillBeSent") this.requests.push(params.request.url);
  }

  resize(width, height) {
    return this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
  }

  async evaluate(expression) {
    const answer = await this.send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
    if (answer.exceptionDetails) throw new Error(answer.exceptionDetails.exception?.description ?? expression);
    return answer.result.value;
  }

  async until(condition) {
    const end = Date.now() + PATIENCE_MS;
    while (!(await this.evaluate(condition))) {
      if (Date.now() > end) throw new Error(`never true: ${condition}`);
      await new Promise((wait) => setTimeout(wait, 50));
    }
  }

  // The whole page, or the box of one element, as PNG.
  async picture(selector = "html") {
    const box = await this.evaluate(`(() => {
      const box = document.querySelector(${JSON.stringify(selector)}).getBoundingClientRect();
      return { x: box.x + scrollX, y: box.y + scrollY, width: box.width, height: box.height };
    })()`);
    const clip = { ...box, scale: 1 };
    const { data } = await this.send("Page.captureScreenshot", { format: "png", clip, captureBeyondViewport: true });
    return Buffer.from(data, "base64");
  }

  async close() {
    this.session = undefined;
    const ended = new Promise((resolve) => this.process.once("exit", resolve));
    await this.send("Browser.close").catch(() => this.process.kill());
    await ended;
    rmSync(this.profile, { recursive: true, force: true, maxRetries: 5 });
  }
}
