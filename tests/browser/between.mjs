// Promise: between measured light directions the page's values send back as much light as the law that was tabulated.
//
//   node tests/browser/between.mjs
//
// GGX 0.1 and brushed GGX 0.1 x 0.3 (F = 1, separable Smith; Walter et al. 2007) under light every 15 degrees, and what clear
// facets of them reflect and let through, from outside and from inside.

import { readFileSync } from "node:fs";
import vm from "node:vm";

const source = readFileSync(new URL("../../src/report/html/assets/table.js", import.meta.url), "utf8");
const { Table, RAD, direction, dot } = vm.runInNewContext(`${source}; ({ Table, RAD, direction, dot })`, {
  atob: (text) => Buffer.from(text, "base64").toString("latin1"), Math, Uint8Array, Uint16Array, Float32Array, Array, Object,
});

function ggx(wi, wo, [x, y]) {
  const h = wi.map((a, k) => a + wo[k]), length = Math.hypot(...h);
  const q = ((h[0] / x) ** 2 + (h[1] / y) ** 2 + h[2] ** 2) / length ** 2;
  const arm = (w) => 0.5 * (w[2] + Math.hypot(w[2], x * w[0], y * w[1]));
  return 1 / (Math.PI * x * y * q * q) / (4 * arm(wi) * arm(wo));
}

// F of a facet and both cosines, by Fresnel's equations for s and p.
function fresnel(i, eta) {
  const t = Math.sqrt(1 - (1 - i * i) / eta ** 2);
  if (!(t > 0)) return 1;
  return (((i - eta * t) / (i + eta * t)) ** 2 + ((eta * i - t) / (eta * i + t)) ** 2) / 2;
}

// BTDF, Walter et al. 2007, equation 21, for wo below the horizon (its mirror image is given).
function through(wi, out, [x, y], eta) {
  const wo = [out[0], out[1], -out[2]], sum = wi.map((a, k) => a + eta * wo[k]), length = Math.hypot(...sum);
  const h = sum.map((a) => (eta > 1 ? -1 : 1) * a / length), [i, o] = [dot(wi, h), dot(wo, h)];
  if (h[2] <= 0 || i <= 0 || o >= 0) return 0;
  const q = ((h[0] / x) ** 2 + (h[1] / y) ** 2 + h[2] ** 2), d = 1 / (Math.PI * x * y * q * q);
  const arm = (w) => 0.5 * (w[2] + Math.hypot(w[2], x * w[0], y * w[1]));
  return i * -o * eta ** 2 * (1 - fresnel(i, eta)) * d / (arm(wi) * arm(out) * (i + eta * o) ** 2);
}

function reflected(wi, wo, alpha, eta) {
  const h = wi.map((a, k) => a + wo[k]), i = dot(wi, h) / Math.hypot(...h);
  return ggx(wi, wo, alpha) * (eta === null ? 1 : fresnel(i, eta));
}

// IEEE half of a positive number.
function half(value) {
  if (value < 2 ** -14) return Math.round(value * 2 ** 24);
  const exponent = Math.floor(Math.log2(value)), fraction = Math.round((value / 2 ** exponent - 1) * 1024);
  return ((exponent + 15) << 10) + fraction;
}

function tabulated(f, alpha, phi_i, below, eta) {
  const edges = (step, count) => Array.from({ length: count + 1 }, (_, k) => k * step);
  const data = {
    theta_i: edges(15, 5), phi_i: phi_i || [0], relative: !phi_i, mirrored: Boolean(phi_i), rotation: 0, alpha, scale: 1,
    theta_edges: edges(1, 90), phi_edges: edges(2, 180), colours: ["Y"], layers: [],
  };
  const bits = [];
  for (const theta of data.theta_i) for (const phi of data.phi_i) {
    const wi = direction(theta * RAD, phi * RAD);
    for (let row = 0; row < 90; row += 1) for (let column = 0; column < 180; column += 1) {
      bits.push(half(f(wi, direction((row + 0.5) * RAD, (2 * column + 1) * RAD))));
    }
  }
  data.layers.push({ data: Buffer.from(Uint16Array.from(bits).buffer).toString("base64") });
  return new Table(data, below, eta);
}

// Half vectors after the law's own lobe, in a fixed lattice; where light goes through, refracted at them.
function albedo(f, theta, phi, [x, y], below, eta) {
  const wi = direction(theta * RAD, phi * RAD), count = 20000;
  let sum = 0;
  for (let k = 0; k < count; k += 1) {
    const u = (k + 0.5) / count, slope = Math.sqrt(u / (1 - u)), a = 2 * Math.PI * ((k * 0.6180339887498949) % 1);
    const m = [x * slope * Math.cos(a), y * slope * Math.sin(a), 1], length = Math.hypot(...m), h = m.map((c) => c / length);
    const i = dot(wi, h), squared = 1 - (1 - i * i) / eta ** 2;
    if (i <= 0 || (below && squared <= 0)) continue;
    const cosine = Math.sqrt(squared), to = h.map((c, j) => (below ? (i / eta - cosine) * c - wi[j] / eta : 2 * i * c - wi[j]));
    const out = below ? [to[0], to[1], -to[2]] : to;
    if (out[2] <= 0) continue;
    const q = ((h[0] / x) ** 2 + (h[1] / y) ** 2 + h[2] ** 2), d = 1 / (Math.PI * x * y * q * q);
    // Solid angle of the light over that of the half vectors.
    const wide = below ? (i - eta * cosine) ** 2 / (eta ** 2 * cosine) : 4 * i;
    sum += f(wi, out) * out[2] * wide / (d * h[2]);
  }
  return sum / count;
}

const brushed = [0, 22.5, 45, 67.5, 90], angles = [7.5, 22.5, 37.5, 52.5, 60, 67.5];
// The bar of exports is 1 %: at 60 degrees, a stop, straight lines between bins alone are off by as much as 0.4 %. About the
// pole, where half of what is found at 7.5 degrees comes from, straight lines over bins of the width w add w^2/(6 a^2) to a
// lobe of the width a: w = 1 degree, a = alpha |1 - 1/eta| of refracted light.
function bar(theta, alpha, below, eta) {
  const a = Math.min(...alpha) / RAD * Math.abs(1 - 1 / eta);
  return 0.01 + (below && theta < 15 ? 0.5 / (6 * a * a) : 0);
}

// alpha, azimuths, index (null: F = 1), whether light goes through, angles of the light.
const CASES = [
  [[0.1, 0.1], null, null, false, angles],
  [[0.1, 0.3], brushed, null, false, angles],
  [[0.1, 0.1], null, 1.5, false, angles],
  [[0.1, 0.1], null, 1.5, true, angles],
  [[0.1, 0.3], brushed, 1.5, true, angles],
  [[0.3, 0.3], null, 1.5, true, angles],
  // From inside, away from the critical angle of 41.8 degrees, whose edge is sharper than the bins.
  [[0.1, 0.1], null, 1 / 1.5, true, [7.5, 15, 22.5]],
];
let failed = false;
for (const [alpha, phi_i, eta, below, thetas] of CASES) {
  const f = (wi, wo) => (below ? through(wi, wo, alpha, eta) : reflected(wi, wo, alpha, eta));
  const table = tabulated(f, alpha, phi_i, below, eta);
  for (const theta of thetas) for (const phi of phi_i ? [11.25, 78.75, 191.25] : [0]) {
    const found = albedo((wi, wo) => table.value(table.layers[0], 0, theta, phi, wo), theta, phi, alpha, below, eta);
    const wanted = albedo(f, theta, phi, alpha, below, eta);
    const off = Math.abs(found / wanted - 1);
    const fits = off <= bar(theta, alpha, below, eta);
    failed ||= !fits;
    const what = `${alpha}${eta === null ? "" : ` index ${eta.toFixed(3)}`}${below ? " through" : ""}`;
    console.log(`${fits ? "ok  " : "MISS"} ${what} light ${theta} ${phi}: ${found.toFixed(4)} ${wanted.toFixed(4)}`);
  }
}
process.exit(failed ? 1 : 0);
