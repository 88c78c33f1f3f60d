// The table: half floats out of base64, bins by direction, values between measured light directions.

const RAD = Math.PI / 180;

function bytesOf(base64) {
  return Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
}

// IEEE half, without its infinities: the page holds finite values only.
function fromHalf(bits) {
  const exponent = (bits >> 10) & 31, fraction = bits & 1023;
  const size = exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15);
  return bits & 0x8000 ? -size : size;
}

function decoded(base64, scale) {
  const bytes = bytesOf(base64);
  const halfs = new Uint16Array(bytes.buffer), values = new Float32Array(halfs.length);
  for (let k = 0; k < halfs.length; k += 1) values[k] = scale * fromHalf(halfs[k]);
  return values;
}

function direction(theta, phi) {
  return [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function normalised(a) {
  const length = Math.hypot(a[0], a[1], a[2]);
  return a.map((x) => x / length);
}

// The share of unpolarised light that a facet reflects (Fresnel), the index behind it over that before it being eta:
// 1 where the reflection is total.
function fresnel(cosine, eta) {
  const squared = eta * eta - 1 + cosine * cosine;
  if (squared <= 0) return 1;
  const g = Math.sqrt(squared), a = (g - cosine) / (g + cosine), b = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1);
  return 0.5 * a * a * (1 + b * b);
}

// Where light of the direction `w` (from the facet to the light) goes at a facet of normal h, by Snell's law; null where
// all of it is reflected or the facet is seen from behind.
function refracted(w, h, eta) {
  const cosine = dot(w, h), squared = 1 - (1 - cosine * cosine) / (eta * eta);
  if (cosine <= 0 || squared <= 0) return null;
  const along = cosine / eta - Math.sqrt(squared);
  return w.map((x, k) => along * h[k] - x / eta);
}

// x modulo m, in [0, m).
function wrapped(x, m) {
  return x - m * Math.floor(x / m);
}

// A half of a table: light that comes back or, `below`, light that has gone through as a mirror in the horizon shows it.
// `eta` is the index of the far side over that of the light's; null: not known.
class Table {
  constructor(data, below = false, eta = null) {
    Object.assign(this, data, { below, eta });
    // Single directions are one row: nothing lies between them.
    this.rows = data.spots ? 1 : data.theta_edges.length - 1;
    this.columns = data.spots ? data.spots.directions.length : data.phi_edges.length - 1;
    this.bins = this.rows * this.columns;
    this.stops = data.theta_i.length * data.phi_i.length;
    const middles = (edges) => edges.slice(1).map((edge, k) => (edge + edges[k]) / 2);
    this.theta_middles = data.theta_nodes || middles(data.theta_edges || []);
    this.phi_middles = data.phi_nodes || middles(data.phi_edges || []);
    for (const layer of this.layers) layer.values = decoded(layer.data, data.scale);
    // Below 0: nothing was measured there.
    this.absent = Array.from(this.layers[0].values.subarray(0, this.stops * this.bins), (value) => value < 0);
    for (const layer of this.layers) layer.values.forEach((value, k) => { if (value < 0) layer.values[k] = 0; });
    // Azimuths between which the light is interpolated, in the sample's frame; a mirrored law needs a quarter only.
    const azimuths = data.phi_i.map((phi, index) => ({ phi: this.folded(phi - data.rotation).phi, index, raw: phi }));
    const sorted = azimuths.sort((a, b) => a.phi - b.phi);
    this.azimuths = sorted.filter((a, k) => k === 0 || a.phi > sorted[k - 1].phi + 1e-6);
    this.slopes = this.guide();
  }

  // Alphas of the GGX whose masking and cosines guide from light to light: the surface's, or by the highest value. One
  // for all azimuths where the table has one frame for all of them.
  guide() {
    let [x, y] = this.alpha || [0, 0];
    if (!this.alpha) {
      const peak = this.layers[0].values.subarray(0, this.bins).reduce((most, value) => Math.max(most, value), 1e-3);
      // Of a facet's solid angle in that of the light which it sends on: 1/4, or that of refraction.
      const part = this.below && this.eta ? (1 - fresnel(1, this.eta)) * (this.eta / (1 - this.eta)) ** 2 : 1 / 4;
      x = y = Math.sqrt(part / (Math.PI * peak));
    }
    return this.relative ? [Math.sqrt(x * y), Math.sqrt(x * y)] : [x, y];
  }

  // Cosine over masking of an arm (sample's frame), after Smith: f times that of both arms changes slowly.
  projected(w) {
    return 0.5 * (w[2] + Math.hypot(w[2], this.slopes[0] * w[0], this.slopes[1] * w[1]));
  }

  // An azimuth in degrees brought into the measured range: `x`, `y` are -1 where the sample is mirrored.
  folded(phi) {
    phi = wrapped(phi, 360);
    if (!this.mirrored || this.relative) return { phi, x: 1, y: 1 };
    const y = phi > 180 ? -1 : 1;
    phi = y < 0 ? 360 - phi : phi;
    const x = phi > 90 ? -1 : 1;
    return { phi: x < 0 ? 180 - phi : phi, x, y };
  }

  // Index of the bin row that holds theta, in degrees.
  row(theta) {
    let row = 0;
    while (row + 1 < this.rows && theta >= this.theta_edges[row + 1]) row += 1;
    return row;
  }

  column(phi) {
    const first = this.phi_edges[0];
    phi = first + wrapped(phi - first, 360);
    let column = 0;
    while (column + 1 < this.columns && phi >= this.phi_edges[column + 1]) column += 1;
    return column;
  }

  // Where a bin of a stop lies among a layer's values.
  at(colour, stop, bin) {
    return (colour * this.stops + stop) * this.bins + bin;
  }

  isAbsent(stop, bin) {
    return this.absent[this.at(0, stop, bin)];
  }

  // The two rows whose middles enclose theta (degrees), and how far it is from the lower one.
  rowsAt(theta) {
    const rows = this.theta_middles;
    let low = this.row(theta);
    if (theta < rows[low] && low > 0) low -= 1;
    const high = Math.min(low + 1, this.rows - 1);
    const t = high === low ? 0 : Math.min(Math.max((theta - rows[low]) / (rows[high] - rows[low]), 0), 1);
    return { low, high, t };
  }

  columnsAt(phi) {
    const columns = this.phi_middles;
    let left = this.column(phi);
    if (wrapped(phi - columns[left] + 180, 360) < 180) left = (left + this.columns - 1) % this.columns;
    const right = (left + 1) % this.columns;
    const width = wrapped(columns[right] - columns[left], 360) || 360;
    return { left, right, s: Math.min(wrapped(phi - columns[left], 360) / width, 1) };
  }

  // Bilinear between the middles of bins.
  mixed(layer, first, { low, high, t }, { left, right, s }) {
    const values = layer.values, n = this.columns;
    const line = (row) => values[first + row * n + left] * (1 - s) + values[first + row * n + right] * s;
    return line(low) * (1 - t) + line(high) * t;
  }

  // Where the sensor's directions end: beyond, nothing was measured.
  end() {
    return this.theta_edges[this.rows];
  }

  // The stop nearest to a direction of the light, for tables that are not interpolated.
  nearestStop(theta, phi) {
    const wi = direction(theta * RAD, this.relative ? 0 : phi * RAD);
    const cosine = (stop) => {
      const { theta: t, phi: p } = this.lightOf(stop);
      return dot(wi, direction(t * RAD, this.relative ? 0 : p * RAD));
    };
    let best = 0;
    for (let stop = 1; stop < this.stops; stop += 1) if (cosine(stop) > cosine(best) + 1e-12) best = stop;
    return best;
  }

  lightOf(stop) {
    const columns = this.phi_i.length;
    return { theta: this.theta_i[Math.floor(stop / columns)], phi: this.phi_i[stop % columns] };
  }

  // The single directions as unit vectors of the stage, for light from the azimuth phi.
  spotsAt(phi) {
    const origin = this.relative ? phi : 0;
    return this.spots.directions.map(([theta, azimuth]) => direction(theta * RAD, (azimuth + origin) * RAD));
  }

  smooth(layer, colour, stop, theta, phi) {
    if (theta > this.end() + 1e-6) return 0;
    return this.mixed(layer, this.at(colour, stop, 0), this.rowsAt(theta), this.columnsAt(phi));
  }

  // Neighbouring light directions of (theta, phi) in the sample's frame, degrees, with weights.
  neighbours(theta, phi) {
    const angles = this.theta_i;
    let low = 0;
    while (low + 1 < angles.length - 1 && theta >= angles[low + 1]) low += 1;
    const high = Math.min(low + 1, angles.length - 1);
    const t = high === low ? 0 : Math.min(Math.max((theta - angles[low]) / (angles[high] - angles[low]), 0), 1);
    const around = this.relative ? [{ azimuth: null, weight: 1 }] : this.between(phi);
    const found = [];
    for (const [row, weight] of [[low, 1 - t], [high, t]]) {
      for (const { azimuth, weight: part } of around) {
        if (weight * part > 0) found.push({ row, azimuth, weight: weight * part });
      }
    }
    return found;
  }

  between(phi) {
    const all = this.azimuths;
    let left = all.length - 1;
    for (let k = 0; k < all.length; k += 1) if (all[k].phi <= phi) left = k;
    const wraps = !this.mirrored;
    if (phi < all[0].phi) left = wraps ? all.length - 1 : 0;
    const right = wraps ? (left + 1) % all.length : Math.min(left + 1, all.length - 1);
    const width = wrapped(all[right].phi - all[left].phi, 360) || 360;
    const s = right === left ? 0 : Math.min(wrapped(phi - all[left].phi, 360) / width, 1);
    return [{ azimuth: all[left], weight: 1 - s }, { azimuth: all[right], weight: s }];
  }

  // BRDF for any two directions (stage's frame, angles of the light in degrees).
  value(layer, colour, theta_i, phi_i, wo) {
    const turn = this.relative ? phi_i : this.rotation;
    const fold = this.relative ? { phi: 0, x: 1, y: 1 } : this.folded(phi_i - this.rotation);
    const [c, s] = [Math.cos(turn * RAD), Math.sin(turn * RAD)];
    const out = [fold.x * (wo[0] * c + wo[1] * s), fold.y * (wo[1] * c - wo[0] * s), wo[2]];
    const wi = direction(theta_i * RAD, fold.phi * RAD);
    const near = this.neighbours(theta_i, fold.phi);
    return this.below ? this.through(layer, colour, wi, out, near) : this.back(layer, colour, wi, out, near);
  }

  lightThere(near) {
    return direction(this.theta_i[near.row] * RAD, near.azimuth === null ? 0 : near.azimuth.phi * RAD);
  }

  // Neighbouring stops are looked up at the same half vector, so that the lobe moves instead of doubling; f
  // `projected(wi)` `projected(wo)`, over what a clear facet reflects, is what changes slowly.
  back(layer, colour, wi, out, neighbours) {
    const h = normalised([wi[0] + out[0], wi[1] + out[1], wi[2] + out[2]]);
    const reflected = (w) => (this.eta ? fresnel(Math.abs(dot(w, h)), this.eta) : 1);
    let sum = 0, weights = 0;
    for (const near of neighbours) {
      const there = this.lightThere(near);
      const twice = 2 * dot(h, there);
      const w = [twice * h[0] - there[0], twice * h[1] - there[1], twice * h[2] - there[2]];
      if (w[2] <= 0) continue;
      sum += near.weight * this.lookUp(layer, colour, near, w) * this.projected(there) * this.projected(w);
      weights += near.weight * reflected(there);
    }
    return weights > 0 ? sum / weights / (this.projected(wi) * this.projected(out)) * reflected(wi) : 0;
  }

  // The same of light that goes through, at the half vector of refraction h along -(wi + eta wo). What is slow there is f
  // over the `share` of facets of one normal, and as that becomes 0 sums are divided, not their parts. Where no facet
  // refracts wi to wo light has met several, or the index is unknown: neighbours of which the same holds are mixed. Near total
  // reflection bins are wider than what happens there: nothing is scaled up more than tenfold.
  through(layer, colour, wi, out, neighbours) {
    const h = this.refracting(wi, out);
    let sum = 0, shares = 0;
    for (const near of neighbours) {
      const there = this.lightThere(near), to = h && refracted(there, h, this.eta);
      if (h ? !to || to[2] >= 0 : this.refracting(there, out)) continue;
      const w = h ? [to[0], to[1], -to[2]] : out;
      sum += near.weight * this.lookUp(layer, colour, near, w);
      shares += near.weight * (h ? this.share(there, w, h) : 1);
    }
    const own = h ? this.share(wi, out, h) : 1;
    return shares > 0 ? sum / Math.max(shares, 0.1 * own) * own : 0;
  }

  // Where the mean plane refracts light from an angle (degrees, stage's frame); null where it does not, or is not known.
  onwards(theta, phi) {
    return this.eta ? refracted(direction(theta * RAD, phi * RAD), [0, 0, 1], this.eta) : null;
  }

  // The normal of the facets that refract wi to `out`, as a mirror in the horizon shows it; null: none do.
  refracting(wi, out) {
    if (!this.eta) return null;
    const sign = this.eta > 1 ? -1 : 1, [x, y, z] = wi.map((a, k) => sign * (a + this.eta * (k < 2 ? out[k] : -out[k])));
    const h = normalised([x, y, z]);
    return h[2] > 0 && dot(wi, h) > 0 && h[0] * out[0] + h[1] * out[1] - h[2] * out[2] < 0 ? h : null;
  }

  // What facets of normal h send from wi to `out`, but for how many of them there are.
  share(wi, out, h) {
    const i = dot(wi, h), o = h[0] * out[0] + h[1] * out[1] - h[2] * out[2];
    const turning = i * -o / (i + this.eta * o) ** 2 * (1 - fresnel(i, this.eta));
    return turning / (this.projected(wi) * this.projected(out));
  }

  // A direction of the sample's frame in the bins of a neighbour.
  lookUp(layer, colour, near, w) {
    const theta = Math.atan2(Math.hypot(w[0], w[1]), w[2]) / RAD;
    const phi = Math.atan2(w[1], w[0]) / RAD;
    const azimuth = near.azimuth;
    const stop = near.row * this.phi_i.length + (azimuth === null ? 0 : azimuth.index);
    if (azimuth === null) return this.smooth(layer, colour, stop, theta, phi);
    // Where the stop itself was folded into the quarter, the sensor is mirrored with it.
    const fold = this.folded(azimuth.raw - this.rotation);
    const turned = Math.atan2(fold.y * Math.sin(phi * RAD), fold.x * Math.cos(phi * RAD)) / RAD;
    return this.smooth(layer, colour, stop, theta, turned + this.rotation);
  }
}
