// Promise: between measured light directions the page's values send back as much light as the law that was tabulated.
//
//   node tests/browser/between.mjs
//
// GGX 0.1 and brushed GGX 0.1 x 0.3 (F = 1, separable Smith; Walter et al. 2007) under light every 15 degrees.

import { readFileSync } from "node:fs";
import vm from "node:vm";

const source = readFileSync(new URL("../../src/report/assets/table.js", import.meta.url), "utf8");
const { Table, RAD, direction } = vm.runInNewContext(`${source}; ({ Table, RAD, direction })`, {
  atob: (text) => Buffer.from(text, "base64").toString("latin1"), Math, Uint8Array, Uint16Array, Float32Array, Array, Object,
});

function ggx(wi, wo, [x, y]) {
  const h = wi.map((a, k) => a + wo[k]), length = Math.hypot(...h);
  const q = ((h[0] / x) ** 2 + (h[1] / y) ** 2 + h[2] ** 2) / length ** 2;
  const arm = (w) => 0.5 * (w[2] + Math.hypot(w[2], x * w[0], y * w[1]));
  return 1 / (Math.PI * x * y * q * q) / (4 * arm(wi) * arm(wo));
}

// IEEE half of a positive number.
function half(value) {
  if (value < 2 ** -14) return Math.round(value * 2 ** 24);
  const exponent = Math.floor(Math.log2(value)), fraction = Math.round((value / 2 ** exponent - 1) * 1024);
  return ((exponent + 15) << 10) + fraction;
}

function tabulated(alpha, phi_i) {
  const edges = (step, count) => Array.from({ length: count + 1 }, (_, k) => k * step);
  const data = {
    theta_i: edges(15, 5), phi_i: phi_i || [0], relative: !phi_i, mirrored: Boolean(phi_i), rotation: 0, alpha, scale: 1,
    theta_edges: edges(1, 90), phi_edges: edges(2, 180), colours: ["Y"], layers: [],
  };
  const bits = [];
  for (const theta of data.theta_i) for (const phi of data.phi_i) {
    const wi = direction(theta * RAD, phi * RAD);
    for (let row = 0; row < 90; row += 1) for (let column = 0; column < 180; column += 1) {
      bits.push(half(ggx(wi, direction((row + 0.5) * RAD, (2 * column + 1) * RAD), alpha)));
    }
  }
  data.layers.push({ data: Buffer.from(Uint16Array.from(bits).buffer).toString("base64") });
  return new Table(data);
}

// Half vectors after the law's own lobe, in a fixed lattice.
function albedo(f, theta, phi, [x, y]) {
  const wi = direction(theta * RAD, phi * RAD), count = 20000;
  let sum = 0;
  for (let k = 0; k < count; k += 1) {
    const u = (k + 0.5) / count, slope = Math.sqrt(u / (1 - u)), a = 2 * Math.PI * ((k * 0.6180339887498949) % 1);
    const m = [x * slope * Math.cos(a), y * slope * Math.sin(a), 1], length = Math.hypot(...m), h = m.map((c) => c / length);
    const dot = wi[0] * h[0] + wi[1] * h[1] + wi[2] * h[2];
    const wo = h.map((c, j) => 2 * dot * c - wi[j]);
    if (dot <= 0 || wo[2] <= 0) continue;
    const q = ((h[0] / x) ** 2 + (h[1] / y) ** 2 + h[2] ** 2), d = 1 / (Math.PI * x * y * q * q);
    sum += f(wi, wo) * wo[2] * 4 * dot / (d * h[2]);
  }
  return sum / count;
}

let failed = false;
for (const [alpha, phi_i] of [[[0.1, 0.1], null], [[0.1, 0.3], [0, 22.5, 45, 67.5, 90]]]) {
  const table = tabulated(alpha, phi_i);
  for (const theta of [7.5, 22.5, 37.5, 52.5, 60, 67.5]) for (const phi of phi_i ? [11.25, 78.75, 191.25] : [0]) {
    const found = albedo((wi, wo) => table.value(table.layers[0], 0, theta, phi, wo), theta, phi, alpha);
    const wanted = albedo((wi, wo) => ggx(wi, wo, alpha), theta, phi, alpha);
    // The bar of exports. At 60 degrees, a stop, straight lines between bins alone are off by as much as 0.4 %.
    const off = Math.abs(found / wanted - 1);
    failed ||= off > 0.01;
    console.log(`${off > 0.01 ? "MISS" : "ok  "} ${alpha} light ${theta} ${phi}: ${found.toFixed(4)} ${wanted.toFixed(4)}`);
  }
}
process.exit(failed ? 1 : 0);
