//! Starts in the order of the facets' slopes: equal steps along the running sum of the area turned to the light, as in
//! `starts`, but from facet to facet of like slope instead of from neighbour to neighbour.
//!
//! A facet and a direction of the light fix where it sends light. Facets of like slope send it into the same bin of a
//! sensor, so that equal steps in this order give every bin its share of the starts to within a few, where steps from
//! place to place give it a random number: what is left of the noise is what is seen of the facets.

use glam::DVec3;
use rand_pcg::Pcg64Dxsm;

use super::facet_index::{FacetIndex, Slopes};
use super::starts::point_in;
use super::walk::{Facet, Place};
use crate::rng;
use crate::surface::Heightfield;

/// The facets of a field, sorted by slope, under one light.
pub struct BySlope<'a> {
    index: &'a FacetIndex,
    field: &'a Heightfield,
    /// Canonical light direction in field coordinates.
    light: DVec3,
    bins: Vec<Bin>,
}

/// A bin of the index that is turned to the light, at least in part.
struct Bin {
    bin: usize,
    /// No facet of it turns more of a cell's area to the light.
    most: f64,
    /// Nor less.
    least: f64,
    /// Running sum of the area up to its end.
    end: f64,
}

impl<'a> BySlope<'a> {
    /// Sums what the facets of `field`, which `index` holds, turn to `light` (canonical, field coordinates), bin by bin:
    /// exactly, from the sums of their slopes, and facet by facet where a bin is turned away in part.
    pub fn new(index: &'a FacetIndex, field: &'a Heightfield, light: DVec3) -> Self {
        let mut starts = BySlope { index, field, light, bins: Vec::new() };
        for bin in index.in_rows_there_and_back() {
            let count = index.count(bin);
            let Slopes { low, high } = index.slopes(bin);
            let across = light.truncate();
            let most = 0.5 * (light.z - (across * low).min(across * high).element_sum());
            if count == 0 || most <= 0.0 {
                continue;
            }
            let least = 0.5 * (light.z - (across * low).max(across * high).element_sum());
            let area = if least >= 0.0 {
                0.5 * (count as f64 * light.z - across.dot(index.slope_sum(bin)))
            } else {
                (0..count).map(|k| starts.turned(&index.facet(bin, k))).sum()
            };
            if area > 0.0 {
                let end = starts.total() + area;
                starts.bins.push(Bin { bin, most, least, end });
            }
        }
        starts
    }

    /// The area that a facet turns to the light, in cells.
    fn turned(&self, facet: &Facet) -> f64 {
        let slope = self.field.corners(facet.x, facet.y).slope(facet.upper);
        (0.5 * (self.light.z - self.light.truncate().dot(slope))).max(0.0)
    }

    fn total(&self) -> f64 {
        self.bins.last().map_or(0.0, |bin| bin.end)
    }

    /// The flux of one start of a block of `count`, as in `Starts::share`.
    pub fn share(&self, count: u64) -> f64 {
        let cells = self.field.cells_x() * self.field.cells_y();
        self.total() / (self.light.z * cells as f64 * count as f64)
    }

    /// Calls `visit` with `count` start points of equal flux, in the order of the places. How many of them a bin gets
    /// follows from equal steps; which of its facets, from their areas, by rejection.
    pub fn each(&self, count: u64, rng: &mut Pcg64Dxsm, mut visit: impl FnMut(Place)) {
        let mut facets = self.facets(count, rng);
        // Rays from neighbours look at the same heights.
        radsort::sort(&mut facets);
        for facet in facets {
            let facet = self.index.at(facet);
            let (u, v) = point_in(facet.upper, rng);
            visit(Place::on(self.field, facet, u, v));
        }
    }

    /// The facets of `count` starts, by slope.
    fn facets(&self, count: u64, rng: &mut Pcg64Dxsm) -> Vec<u32> {
        let step = self.total() / count as f64;
        let offset = rng::uniform(rng);
        let mut facets = Vec::with_capacity(count as usize);
        let mut begin = 0.0;
        for (k, bin) in self.bins.iter().enumerate() {
            // Rounding may leave a step beyond the sum: it belongs to the last bin.
            let last = k + 1 == self.bins.len();
            while (facets.len() as u64) < count {
                let position = (facets.len() as f64 + offset) * step;
                if position >= bin.end && !last {
                    break;
                }
                facets.push(self.facet(bin, (position - begin) / (bin.end - begin), rng));
            }
            begin = bin.end;
        }
        facets
    }

    /// A facet of a bin with a chance in proportion to its area; `share` in [0, 1) chooses the first candidate.
    fn facet(&self, bin: &Bin, share: f64, rng: &mut Pcg64Dxsm) -> u32 {
        let count = self.index.count(bin.bin);
        let mut share = share;
        loop {
            let candidate = self.index.number(bin.bin, ((share * count as f64) as usize).min(count - 1));
            let wanted = rng::uniform(rng) * bin.most;
            // Most are taken unseen.
            if wanted < bin.least || wanted < self.turned(&self.index.at(candidate)) {
                return candidate;
            }
            share = rng::uniform(rng);
        }
    }
}
