//! A patch of grains: half-spheres of radius 1 on a plane in the canonical frame, their centres a Poisson process on a
//! torus, found through a grid of cells.
//!
//! Input: coverage, side, stream. Output: centres, and for each cell the grains that reach into it. The expected values
//! on the torus are those of the plane as long as no ray runs round it: the number of grains is drawn, not fixed.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use rand_pcg::Pcg64Dxsm;
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::heightfield::Heightfield;
use crate::rng;

/// Grains of a patch where no side is given.
const GRAINS: f64 = 1000.0;
/// Shortest side, radii: a grain does not meet itself across the torus, nor does a ray of 75 degrees.
pub const SHORTEST_SIDE: f64 = 8.0;

/// Centres in a unit of area: -ln(1 - coverage)/pi, coverage in (0, 1).
pub fn density(coverage: f64) -> f64 {
    -(-coverage).ln_1p() / PI
}

/// About the side of a cell, radii: a ray's ascent to the top crosses a few cells of a few grains each, and among few
/// grains it crosses few cells between them.
pub fn cell_side(density: f64) -> f64 {
    (0.5 / density.sqrt()).max(1.0)
}

/// The side of a patch where none is given, radii: room for 1,000 grains.
pub fn usual_side(coverage: f64) -> f64 {
    (GRAINS / density(coverage)).sqrt().max(SHORTEST_SIDE)
}

/// How many grains a patch has in the mean; `side` as a campaign gives it.
pub fn mean_count(side: Option<f64>, coverage: f64) -> f64 {
    density(coverage) * side.unwrap_or_else(|| usual_side(coverage)).powi(2)
}

/// The share that a canonical direction `light` (any length, above the horizon) sees of what grains and plane would show
/// it each by itself: 1 over 1 + lambda pi/2 (1 + |light|/light.z).
pub fn share_seen(light: DVec3, coverage: f64) -> f64 {
    1.0 / (1.0 + 0.5 * PI * density(coverage) * (1.0 + light.length() / light.z))
}

/// A patch of grains.
#[derive(Debug, Clone)]
pub struct GrainField {
    side: f64,
    /// 1 of grains, -1 of pits: which half of each sphere is the surface.
    up: f64,
    /// Of all grains, in [0, side).
    centres: Vec<DVec2>,
    /// Cells along a side.
    cells: usize,
    /// `first[c]` to `first[c + 1]`: the places in `placed` that cell c has.
    first: Vec<u32>,
    placed: Vec<PlacedGrain>,
}

/// What a patch of grains really is.
#[derive(Debug, Clone, Serialize)]
pub struct GrainFigures {
    /// How many there are.
    pub grains: usize,
    /// The share of the plane that they cover.
    pub coverage: f64,
    /// What they should cover in the mean of all patches.
    pub wanted: f64,
    /// Kolmogorov-Smirnov distance of the heights (canonical normals have their cosines) from the law.
    pub ks: f64,
}

/// A grain as a cell sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedGrain {
    /// The copy that reaches into the cell: up to a radius outside the patch.
    pub centre: DVec2,
    /// Its number.
    pub grain: u32,
}

impl GrainField {
    /// Random grains of a Poisson process.
    pub fn random(side: f64, coverage: f64, pits: bool, rng: &mut Pcg64Dxsm) -> Self {
        let wanted = density(coverage) * side * side;
        // A Poisson number: as many exponential steps as fit.
        let mut count = 0;
        let mut reached = 0.0;
        loop {
            reached -= (1.0 - rng::uniform(rng)).ln();
            if reached > wanted {
                break;
            }
            count += 1;
        }
        let centre = |_| DVec2::new(rng::uniform(rng), rng::uniform(rng)) * side;
        GrainField::new(side, pits, (0..count).map(centre).collect())
    }

    /// Grains, or pits, at these centres of [0, side) x [0, side), side >= 8.
    pub fn new(side: f64, pits: bool, centres: Vec<DVec2>) -> Self {
        let up = if pits { -1.0 } else { 1.0 };
        let density = centres.len().max(1) as f64 / (side * side);
        let cells = ((side / cell_side(density)) as usize).max(1);
        let field = GrainField { side, up, centres, cells, first: vec![], placed: vec![] };
        let mut counts = vec![0u32; cells * cells + 1];
        field.each_place(|cell, _| counts[cell + 1] += 1);
        for cell in 0..cells * cells {
            counts[cell + 1] += counts[cell];
        }
        let (mut next, total) = (counts.clone(), counts[cells * cells] as usize);
        let mut placed = vec![PlacedGrain { centre: DVec2::ZERO, grain: 0 }; total];
        field.each_place(|cell, grain| {
            placed[next[cell] as usize] = grain;
            next[cell] += 1;
        });
        GrainField { first: counts, placed, ..field }
    }

    /// Pits of these grains, grains of these pits: the other side of the same surface.
    pub fn upside_down(&self) -> Self {
        GrainField { up: -self.up, ..self.clone() }
    }

    /// Calls `visit` with every cell that a grain's disc reaches into.
    fn each_place(&self, mut visit: impl FnMut(usize, PlacedGrain)) {
        let size = self.cell_side();
        // A little more than the disc: a hit on a cell's edge is found from both sides, whatever rounding says.
        let reach = 1.0 + 1e-9 * self.side;
        for (grain, &centre) in self.centres.iter().enumerate() {
            let low = ((centre - reach) / size).floor();
            let high = ((centre + reach) / size).floor();
            for y in low.y as i64..=high.y as i64 {
                for x in low.x as i64..=high.x as i64 {
                    let corner = DVec2::new(x as f64, y as f64) * size;
                    let nearest = centre.clamp(corner, corner + size);
                    if nearest.distance_squared(centre) <= reach * reach {
                        let (cell, shift) = self.wrapped(x, y);
                        visit(cell, PlacedGrain { centre: centre - shift, grain: grain as u32 });
                    }
                }
            }
        }
    }

    /// The cell of the patch that stands at column x and row y of the plane, and how far from it.
    pub fn wrapped(&self, x: i64, y: i64) -> (usize, DVec2) {
        let cells = self.cells as i64;
        let (inside_x, inside_y) = (x.rem_euclid(cells), y.rem_euclid(cells));
        let turns = DVec2::new(((x - inside_x) / cells) as f64, ((y - inside_y) / cells) as f64);
        ((inside_y * cells + inside_x) as usize, turns * self.side)
    }

    /// The grains that reach into a cell.
    pub fn in_cell(&self, cell: usize) -> &[PlacedGrain] {
        &self.placed[self.first[cell] as usize..self.first[cell + 1] as usize]
    }

    /// 1 of grains, -1 of pits.
    pub fn up(&self) -> f64 {
        self.up
    }

    /// Side of the patch, radii.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Side of a cell, radii.
    pub fn cell_side(&self) -> f64 {
        self.side / self.cells as f64
    }

    /// All centres.
    pub fn centres(&self) -> &[DVec2] {
        &self.centres
    }

    /// A place of the plane on the patch.
    pub fn on_patch(&self, at: DVec2) -> DVec2 {
        let inside = at - self.side * (at / self.side).floor();
        // A hair below 0 becomes the side itself.
        DVec2::select(inside.cmplt(DVec2::splat(self.side)), inside, DVec2::ZERO)
    }

    /// The grains that may lie over a place of the patch, copies next to it.
    pub fn near(&self, at: DVec2) -> &[PlacedGrain] {
        let column = |place: f64| ((place / self.cell_side()) as usize).min(self.cells - 1);
        self.in_cell(column(at.y) * self.cells + column(at.x))
    }

    /// The height of the surface over the plane, of pits the depth below it, at a place of the patch.
    pub fn height(&self, at: DVec2) -> f64 {
        let square = |grain: &PlacedGrain| 1.0 - at.distance_squared(grain.centre);
        self.near(at).iter().map(square).fold(0.0, f64::max).sqrt()
    }

    /// The heights at the corners of `cells` x `cells` equal squares, in their sides: slopes stay canonical.
    pub fn as_heights(&self, cells: usize) -> Heightfield {
        let size = self.side / cells as f64;
        let place = |k: usize| DVec2::new((k % cells) as f64, (k / cells) as f64) * size;
        let at = |k: usize| self.up * self.height(place(k)) / size;
        Heightfield::new(cells, cells, true, (0..cells * cells).map(at).collect())
    }

    /// What the grains really cover, looked at on `cells` x `cells` places.
    ///
    /// No centre lies within sqrt(1 - h^2) of a place that is lower than h: squares of heights are below t with
    /// probability (1 - coverage)^(1 - t).
    // Tested by `grains_have_the_wanted_heights`.
    pub fn figures(&self, coverage: f64, cells: usize) -> GrainFigures {
        let size = self.side / cells as f64;
        let place = |k: usize| DVec2::new((k % cells) as f64 + 0.5, (k / cells) as f64 + 0.5) * size;
        let mut squares: Vec<f64> = (0..cells * cells).map(|k| self.height(place(k)).powi(2)).collect();
        radsort::sort(&mut squares);
        let count = squares.len() as f64;
        let bare = squares.partition_point(|&square| square == 0.0);
        let law = |t: f64| ((-coverage).ln_1p() * (1.0 - t)).exp();
        let distance = |(k, &t): (usize, &f64)| {
            (law(t) - k as f64 / count).abs().max((law(t) - (k + 1) as f64 / count).abs())
        };
        // The plane is a step of the law: looked at from its upper end.
        let above = squares.iter().enumerate().skip(bare).map(distance);
        let ks = above.fold((law(0.0) - bare as f64 / count).abs(), f64::max);
        GrainFigures { grains: self.centres.len(), coverage: 1.0 - bare as f64 / count, wanted: coverage, ks }
    }

    /// Whether a point at `height` over a place of the patch lies inside a grain other than its own.
    pub fn buries(&self, at: DVec2, height: f64, own: Option<u32>) -> bool {
        let covers = |grain: &PlacedGrain| {
            at.distance_squared(grain.centre) + height * height < 1.0 && Some(grain.grain) != own
        };
        self.near(at).iter().any(covers)
    }

    /// SHA-256 over the side and the centres, little-endian f64 bits.
    pub fn digest(&self) -> [u8; 32] {
        let mut hash = Sha256::new();
        hash.update((self.up * self.side).to_le_bytes());
        for centre in &self.centres {
            hash.update(centre.x.to_le_bytes());
            hash.update(centre.y.to_le_bytes());
        }
        hash.finalize().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, StreamId, stream};

    fn patch(coverage: f64, realisation: u64) -> GrainField {
        let id = StreamId { seed: 3, purpose: Purpose::Test, realisation, incidence: 0, block: 0 };
        GrainField::random(usual_side(coverage), coverage, false, &mut stream(id))
    }

    #[test]
    fn grains_have_the_wanted_heights() {
        for coverage in [0.2, 0.5, 0.9, 0.99] {
            let figures: Vec<GrainFigures> =
                (0..40).map(|k| patch(coverage, k).figures(coverage, 64)).collect();
            let (mean, se) = crate::stats::mean_and_se(figures.iter().map(|figures| figures.coverage));
            // Forty patches: Student's t at 1e-4, two-sided, is 4.3.
            assert!((mean - coverage).abs() < 4.3 * se.expect("forty"), "{coverage}: {mean} +- {se:?}");
            let (grains, se) = crate::stats::mean_and_se(figures.iter().map(|figures| figures.grains as f64));
            assert!((grains - 1000.0).abs() < 4.3 * se.expect("forty"), "{grains} +- {se:?}");
            // Of a Poisson number the variance is the mean: 40 numbers of 1000, chi-squared with 39 degrees, 1e-4 each.
            let variance = 40.0 * se.expect("forty").powi(2) / 1000.0;
            assert!((0.35..2.05).contains(&variance), "{coverage}: {variance}");
            // A patch of 1000 grains is some 300 independent places: Kolmogorov's 2.2/sqrt(300) has probability 1e-4.
            assert!(figures.iter().all(|figures| figures.ks < 0.13), "{figures:?}");
        }
    }

    #[test]
    fn a_grain_is_found_from_every_cell_that_it_reaches_into() {
        let field = patch(0.5, 0);
        let mut places =
            stream(StreamId { seed: 4, purpose: Purpose::Test, realisation: 0, incidence: 0, block: 0 });
        for _ in 0..2000 {
            let at = DVec2::new(rng::uniform(&mut places), rng::uniform(&mut places)) * field.side();
            let square = |&centre: &DVec2| {
                let apart = at - centre;
                let apart = apart - field.side() * (apart / field.side()).round();
                1.0 - apart.length_squared()
            };
            let expected = field.centres().iter().map(square).fold(0.0, f64::max).sqrt();
            // The copy's place rounds at the size of the patch, 50 radii; the root at a rim magnifies that.
            assert!((field.height(at) - expected).abs() < 1e-6, "{at}: {} {expected}", field.height(at));
        }
    }
}
