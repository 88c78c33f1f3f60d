//! The facets of a field by their slopes: which of them can send light to where it is wanted.
//!
//! Input: a periodic field. Output: its facets, both families, sorted into a grid over canonical slopes; one index
//! serves every roughness, every incidence and every block. Steep slopes are rare, so the grid is even in p/(1 + |p|).

use glam::{DVec2, DVec3};

use super::areas::copy_heights;
use crate::surface::Heightfield;
use crate::trace::ray::surface_point::Facet;

/// Bins along an axis of the grid: a bin's number has 16 bits.
const SIDE: usize = 256;
/// Half the bins, a little less: the steepest slope still falls into the last one.
const HALF: f64 = 127.999;
/// 2^52: added to a number of [0, 2^51], it leaves the nearest whole number in the low bits.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// Facets sorted by slope.
#[derive(Debug, Clone)]
pub struct SlopeIndex {
    /// Places of columns in the number of a facet: bits.
    log_columns: u32,
    /// Facets of bin b are `facets[first[b]..first[b + 1]]`.
    first: Vec<u32>,
    /// The row, the column, and 1 for the upper one, each in bits of its own; in a bin by row and column.
    facets: Vec<u32>,
    /// Sum of the slopes of each bin's facets.
    sums: Vec<DVec2>,
    /// Slopes between which the bins of a row or column lie; no facet is steeper than the outermost.
    edges: Vec<f64>,
}

/// A rectangle of slopes, canonical, in field coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Slopes {
    /// Lowest dz/dx and dz/dy.
    pub low: DVec2,
    /// Highest dz/dx and dz/dy.
    pub high: DVec2,
}

impl Slopes {
    /// The smallest and the largest projected area of facets with these slopes towards `light` (canonical, field
    /// coordinates), in cells: below 0 where they face away.
    pub fn projected_areas(&self, light: DVec3) -> [f64; 2] {
        let (low, high) = (light.truncate() * self.low, light.truncate() * self.high);
        [low.max(high), low.min(high)].map(|along| 0.5 * (light.z - along.element_sum()))
    }
}

impl SlopeIndex {
    /// Sorts the facets of `field`, by counting; `None` for an open field, or one whose facets have no numbers of 32 bits.
    // Tested by `every_facet_stands_in_the_bin_of_its_slope`.
    pub fn new(field: &Heightfield) -> Option<Self> {
        let (cells_x, cells_y) = (field.cells_x(), field.cells_y());
        let log_columns = cells_x.next_power_of_two().trailing_zeros();
        u32::try_from((2 * cells_y) << log_columns).ok().filter(|_| field.is_periodic())?;
        let mut bins = vec![[0u16; 2]; cells_x * cells_y];
        let (mut near, mut far) = (vec![0.0; cells_x + 1], vec![0.0; cells_x + 1]);
        copy_heights(field, 0, 0, &mut far);
        let mut sums = vec![DVec2::ZERO; SIDE * SIDE];
        let mut steepest = 0.0;
        for (y, row) in bins.chunks_exact_mut(cells_x).enumerate() {
            std::mem::swap(&mut near, &mut far);
            copy_heights(field, y + 1, 0, &mut far);
            steepest = positive_max(steepest, bins_of_row(&near, &far, row));
            for (k, &[lower, upper]) in row.iter().enumerate() {
                sums[usize::from(lower)] += DVec2::new(near[k + 1] - near[k], far[k] - near[k]);
                sums[usize::from(upper)] += DVec2::new(far[k + 1] - far[k], far[k + 1] - near[k + 1]);
            }
        }
        let mut first = vec![0u32; SIDE * SIDE + 1];
        for &bin in bins.as_flattened() {
            first[usize::from(bin) + 1] += 1;
        }
        for bin in 0..SIDE * SIDE {
            first[bin + 1] += first[bin];
        }
        let mut next = first.clone();
        let mut facets = vec![0u32; 2 * bins.len()];
        for (y, row) in bins.chunks_exact(cells_x).enumerate() {
            let first = 2 * ((y as u32) << log_columns);
            for (number, &bin) in (first..).zip(row.as_flattened()) {
                let at = &mut next[usize::from(bin)];
                facets[*at as usize] = number;
                *at += 1;
            }
        }
        let edges = (0..=SIDE).map(|k| edge(k).clamp(-steepest, steepest)).collect();
        Some(SlopeIndex { log_columns, first, facets, sums, edges })
    }

    /// Number of bins.
    pub fn bins(&self) -> usize {
        SIDE * SIDE
    }

    /// Bytes of its tables.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first) + size_of_val(&*self.facets) + size_of_val(&*self.sums)
    }

    /// Rows of bins.
    pub fn rows(&self) -> usize {
        SIDE
    }

    /// Facets of the bins of a row, and of those before it, have places below this.
    pub fn end_of_row(&self, row: usize) -> u32 {
        self.first[(row + 1) * SIDE]
    }

    /// Number of facets in a bin.
    #[inline]
    pub fn count(&self, bin: usize) -> usize {
        (self.first[bin + 1] - self.first[bin]) as usize
    }

    /// Facet `k` of a bin.
    #[inline]
    pub fn facet(&self, bin: usize, k: usize) -> Facet {
        self.at(self.number(self.place(bin, k)))
    }

    /// The place of facet `k` of a bin among all of them by slope.
    #[inline]
    pub fn place(&self, bin: usize, k: usize) -> u32 {
        self.first[bin] + k as u32
    }

    /// The number of the facet at a place.
    #[inline]
    pub fn number(&self, place: u32) -> u32 {
        self.facets[place as usize]
    }

    /// The facet of a number.
    #[inline]
    pub fn at(&self, number: u32) -> Facet {
        let cell = (number / 2) as usize;
        let x = cell & ((1 << self.log_columns) - 1);
        Facet { x, y: cell >> self.log_columns, upper: number % 2 == 1 }
    }

    /// Sum of the slopes of a bin's facets.
    #[inline]
    pub fn slope_sum(&self, bin: usize) -> DVec2 {
        self.sums[bin]
    }

    /// All bins, row after row, every other one backwards: neighbours follow each other.
    pub fn in_rows_there_and_back(&self) -> impl Iterator<Item = usize> {
        let along = |row: usize| {
            (0..SIDE).map(move |k| row * SIDE + if row.is_multiple_of(2) { k } else { SIDE - 1 - k })
        };
        (0..SIDE).flat_map(along)
    }

    /// The slopes that a bin holds; no facet is steeper than the outermost ones say.
    pub fn slopes(&self, bin: usize) -> Slopes {
        let (row, column, edges) = (bin / SIDE, bin % SIDE, &self.edges);
        Slopes {
            low: DVec2::new(edges[column], edges[row]),
            high: DVec2::new(edges[column + 1], edges[row + 1]),
        }
    }

    /// The largest and the smallest product of `part` with a slope, for each column or row.
    pub fn along(&self, part: f64) -> Vec<[f64; 2]> {
        let products = self.edges.windows(2).map(|ends| [part * ends[0], part * ends[1]]);
        products.map(|[low, high]| [low.max(high), low.min(high)]).collect()
    }

    /// What `by` has for the column and for the row of a bin.
    #[inline]
    pub fn across<T: Copy>(&self, bin: usize, [by_column, by_row]: &[Vec<T>; 2]) -> [T; 2] {
        [by_column[bin % SIDE], by_row[bin / SIDE]]
    }

    /// Calls `visit` with every bin that holds slopes of `wanted`.
    pub fn each_bin(&self, wanted: &Slopes, mut visit: impl FnMut(usize)) {
        let Slopes { low, high } = wanted;
        for row in position(low.y)..=position(high.y) {
            for column in position(low.x)..=position(high.x) {
                visit(row as usize * SIDE + column as usize);
            }
        }
    }

    /// About the projected area of all facets towards `light` (canonical, field coordinates), in cells: as if all
    /// slopes of a bin were its middle.
    pub fn turned_about(&self, light: DVec3) -> f64 {
        let filled = (0..self.bins()).filter(|&bin| self.count(bin) > 0);
        let turned = filled.map(|bin| {
            let Slopes { low, high } = self.slopes(bin);
            let middle = 0.5 * (low + high);
            let turned = light.z - light.truncate().dot(middle);
            if turned > 0.0 { 0.5 * turned * self.count(bin) as f64 } else { 0.0 }
        });
        turned.sum()
    }
}

/// The bins of the lower and of the upper facet of neighbouring cells, and the steepest slope among them.
fn bins_of_row(near: &[f64], far: &[f64], bins: &mut [[u16; 2]]) -> f64 {
    let cells = bins.len();
    let (near, far) = (&near[..=cells], &far[..=cells]);
    let mut steepest = 0.0;
    for k in 0..cells {
        let slopes = [near[k + 1] - near[k], far[k] - near[k], far[k + 1] - far[k], far[k + 1] - near[k + 1]];
        let [p, q, upper_p, upper_q] = slopes.map(position);
        bins[k] = [q << 8 | p, upper_q << 8 | upper_p];
        steepest = slopes.iter().fold(steepest, |steepest, slope| positive_max(steepest, slope.abs()));
    }
    steepest
}

/// The bin of a slope along one axis, rising with it.
#[inline]
fn position(slope: f64) -> u16 {
    let even = slope / (1.0 + slope.abs());
    // Counted from 1: below 2^52 the low bits would count halves.
    (HALF * even + (SIDE / 2) as f64 + 0.5 + WHOLE).to_bits() as u16 - 1
}

/// The slope where bin `k` begins along one axis.
fn edge(k: usize) -> f64 {
    let even = (k as f64 - (SIDE / 2) as f64) / HALF;
    if even.abs() < 1.0 { even / (1.0 - even.abs()) } else { even.signum() * f64::INFINITY }
}

/// The larger one, as one instruction: `f64::max` also looks for NaN.
#[inline]
fn positive_max(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_facet_stands_in_the_bin_of_its_slope() {
        // Slopes from 1e-3 to 1e3, either way.
        let height = |k: usize| (0.37 * k as f64).sin() * 10f64.powi((k % 7) as i32 - 3);
        let (nx, ny) = (37, 20);
        let field = Heightfield::new(nx, ny, true, (0..nx * ny).map(height).collect());
        let index = SlopeIndex::new(&field).expect("periodic");
        let mut seen = vec![false; 2 * nx * ny];
        for bin in 0..index.bins() {
            let Slopes { low, high } = index.slopes(bin);
            for k in 0..index.count(bin) {
                let facet = index.facet(bin, k);
                let slope = field.corners(facet.x, facet.y).slope(facet.upper);
                // Edges and bins round by an ulp of 128 in p/(1+|p|), of which a slope of 1e3 makes 1e6 times more.
                let rounding = 1e-13 * (1.0 + slope.abs()).powf(2.0);
                assert!(
                    slope.cmpge(low - rounding).all() && slope.cmple(high + rounding).all(),
                    "{slope} {low}"
                );
                seen[2 * (facet.y * nx + facet.x) + usize::from(facet.upper)] = true;
            }
        }
        assert!(seen.iter().all(|&seen| seen));
    }

    #[test]
    fn the_bins_of_a_rectangle_hold_its_slopes() {
        let field = Heightfield::new(2, 2, true, vec![0.0, 900.0, -900.0, 0.0]);
        let index = SlopeIndex::new(&field).expect("periodic");
        for (low, high) in [((-0.3, 2.0), (0.1, 2.5)), ((-900.0, -3.0), (-80.0, 900.0))] {
            let wanted = Slopes { low: DVec2::from(low), high: DVec2::from(high) };
            let mut found = Vec::new();
            index.each_bin(&wanted, |bin| found.push(bin));
            for bin in 0..index.bins() {
                let Slopes { low, high } = index.slopes(bin);
                let overlaps = low.cmplt(wanted.high).all() && high.cmpgt(wanted.low).all();
                assert_eq!(found.contains(&bin), overlaps, "{low} {high}");
            }
        }
    }
}
