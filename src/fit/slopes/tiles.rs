//! The slopes of a surface's facets, tile by tile.

use glam::DVec2;

use super::SlopeDensity;
use crate::stats;
use crate::surface::Heightfield;
use crate::surface::io::prepare::cell_mask::CellMask;

/// Facets that are looked at at most, evenly picked.
const MOST_FACETS: usize = 1 << 18;
/// Tiles along each side.
const PER_SIDE: usize = 4;

/// Slopes, dz/dx and dz/dy, of the facets in each of `per_side` x `per_side` tiles.
#[derive(Debug, Clone)]
pub struct SlopeTiles {
    tiles: Vec<Vec<DVec2>>,
    per_side: usize,
}

impl SlopeTiles {
    /// Both facets of evenly picked cells.
    ///
    /// - `alpha`: slope of the surface for a slope of 1 of the field, along x and y.
    /// - `excluded`: cells that do not count.
    pub fn of(field: &Heightfield, alpha: DVec2, excluded: Option<&CellMask>) -> SlopeTiles {
        let [columns, rows] = [field.cells_x(), field.cells_y()];
        let per_side = PER_SIDE.min(columns).min(rows);
        let mut tiles = vec![Vec::new(); per_side * per_side];
        // Every step-th cell of every row, each row beginning elsewhere: no column is left out.
        let step = (2 * columns * rows).div_ceil(MOST_FACETS);
        for y in 0..rows {
            for x in ((y * 7) % step..columns).step_by(step) {
                if excluded.is_some_and(|excluded| excluded.holds(x, y)) {
                    continue;
                }
                let tile = y * per_side / rows * per_side + x * per_side / columns;
                tiles[tile].extend(field.corners(x, y).slopes().map(|slope| slope * alpha));
            }
        }
        SlopeTiles::from_tiles(tiles, per_side)
    }

    /// Slopes that lie in tiles already, those without any left out.
    pub fn from_tiles(mut tiles: Vec<Vec<DVec2>>, per_side: usize) -> SlopeTiles {
        tiles.retain(|tile| !tile.is_empty());
        SlopeTiles { tiles, per_side }
    }

    /// Tiles along each side.
    pub fn per_side(&self) -> usize {
        self.per_side
    }

    /// Tiles with facets.
    pub fn count(&self) -> usize {
        self.tiles.len()
    }

    /// Facets in all.
    pub fn facets(&self) -> usize {
        self.tiles.iter().map(Vec::len).sum()
    }

    /// Whether no facet is tilted, or there is none.
    pub fn is_flat(&self) -> bool {
        self.all().all(|slope| slope == DVec2::ZERO)
    }

    /// Every slope.
    pub fn all(&self) -> impl Iterator<Item = DVec2> {
        self.tiles.iter().flatten().copied()
    }

    /// The tiles.
    pub fn tiles(&self) -> &[Vec<DVec2>] {
        &self.tiles
    }

    /// Mean slopes, and roots of the mean squared ones.
    pub fn moments(&self) -> ([f64; 2], [f64; 2]) {
        let count = self.facets() as f64;
        let mean = self.all().sum::<DVec2>() / count;
        let square = self.all().map(|slope| slope * slope).sum::<DVec2>() / count;
        (mean.to_array(), [square.x.sqrt(), square.y.sqrt()])
    }

    /// The standard error of the mean of what tile k says; `None` of a single one.
    pub fn se_of_mean(&self, of: impl Fn(usize) -> f64) -> Option<f64> {
        let values: Vec<f64> = (0..self.count()).map(of).collect();
        stats::mean_and_se(values.iter().copied()).1
    }

    /// The facets' sqrt(q) under a law, sorted.
    pub fn lengths(&self, density: &SlopeDensity) -> Vec<f64> {
        let mut all: Vec<f64> = self.all().map(|slope| density.q(slope).sqrt()).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// The distance of Kolmogorov and Smirnov between these and the law's.
    pub fn ks(&self, density: &SlopeDensity) -> f64 {
        let (all, law) = (self.lengths(density), density.lengths());
        let count = all.len() as f64;
        let off = |(k, length): (usize, &f64)| {
            let share = law.length_cdf(*length);
            (share - k as f64 / count).abs().max(((k + 1) as f64 / count - share).abs())
        };
        all.iter().enumerate().map(off).fold(0.0, f64::max)
    }
}
