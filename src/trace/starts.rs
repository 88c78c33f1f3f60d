//! Where paths start: on the facets, in proportion to the area that they turn to the light.
//!
//! A block is one systematic pass over the patch: equal steps along the running sum of max(0, wi.m) A over all
//! facets, one offset, a uniform point in the facet. All starts of a block carry the same flux.

use glam::{DVec2, DVec3};
use rand_pcg::Pcg64Dxsm;

use super::walk::{Facet, Place};
use crate::rng;
use crate::surface::Heightfield;

/// Starts in a block.
pub const BLOCK: u64 = 65_536;

/// A rectangle of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Columns [first, end).
    pub x: (usize, usize),
    /// Rows [first, end).
    pub y: (usize, usize),
}

impl Window {
    /// The whole field.
    pub fn all(field: &Heightfield) -> Self {
        Window { x: (0, field.cells_x()), y: (0, field.cells_y()) }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        (self.x.1 - self.x.0) * (self.y.1 - self.y.0)
    }
}

/// The areas that the facets of a window turn to one light direction, summed by rows of cells: what a block steps
/// along.
pub struct Starts<'a> {
    field: &'a Heightfield,
    window: Window,
    /// Canonical light direction in field coordinates.
    light: DVec3,
    /// `rows[k]` = area of the window's rows before row k; one entry more than rows.
    rows: Vec<f64>,
}

impl<'a> Starts<'a> {
    /// Sums the areas that `field`'s facets in `window` turn to `light` (canonical, field coordinates): a facet of
    /// slope (p, q) turns max(0, light.z - light.x p - light.y q)/2 of a cell's area to it.
    pub fn new(field: &'a Heightfield, window: Window, light: DVec3) -> Self {
        let mut sum = 0.0;
        let below = (window.y.0..window.y.1).map(|y| {
            sum += row_area(field, window, y, light);
            sum
        });
        let rows = std::iter::once(0.0).chain(below).collect();
        Starts { field, window, light, rows }
    }

    /// The flux of one start of a block of `count`, as a share of the flux that falls on the window: the turned
    /// area over light.z x cells x count. Over all starts it sums to at least 1: those that the light does not see
    /// are counted, and dropped.
    pub fn share(&self, count: u64) -> f64 {
        self.total() / (self.light.z * self.window.cells() as f64 * count as f64)
    }

    fn total(&self) -> f64 {
        self.rows[self.rows.len() - 1]
    }

    /// Calls `visit` with `count` start points of equal flux, in the order of the facets.
    pub fn each(&self, count: u64, rng: &mut Pcg64Dxsm, mut visit: impl FnMut(Place)) {
        let step = self.total() / count as f64;
        let offset = rng::uniform(rng);
        let mut due = Due { next: 0, count, step, offset };
        let mut start = |facet: Facet| {
            let (u, v) = point_in(facet.upper, rng);
            visit(Place::on(self.field, facet, u, v));
        };
        let mut last_lit = None;
        for (row, y) in (self.window.y.0..self.window.y.1).enumerate() {
            if due.before(self.rows[row + 1]) {
                last_lit = self.starts_in_row(y, self.rows[row], &mut due, &mut start).or(last_lit);
            }
        }
        // The sums by row and by facet round differently: what is left belongs to the last facet.
        if let Some(facet) = last_lit {
            while due.take(f64::INFINITY) {
                start(facet);
            }
        }
    }

    /// Visits the starts of one row, whose running sum begins at `sum`; returns its last facet turned to the light.
    fn starts_in_row(
        &self,
        y: usize,
        mut sum: f64,
        due: &mut Due,
        start: &mut impl FnMut(Facet),
    ) -> Option<Facet> {
        let mut last_lit = None;
        for x in self.window.x.0..self.window.x.1 {
            let corners = self.field.corners(x, y);
            for (upper, slope) in [(false, corners.lower_slope()), (true, corners.upper_slope())] {
                let area = turned_area(slope, self.light);
                if area > 0.0 {
                    sum += area;
                    let facet = Facet { x, y, upper };
                    last_lit = Some(facet);
                    while due.take(sum) {
                        start(facet);
                    }
                }
            }
        }
        last_lit
    }
}

/// The systematic steps still to come.
struct Due {
    next: u64,
    count: u64,
    step: f64,
    offset: f64,
}

impl Due {
    /// Whether a step lies before `sum`.
    fn before(&self, sum: f64) -> bool {
        self.next < self.count && (self.next as f64 + self.offset) * self.step < sum
    }

    /// Takes the next step if it lies before `sum`.
    fn take(&mut self, sum: f64) -> bool {
        let taken = self.before(sum);
        self.next += u64::from(taken);
        taken
    }
}

fn turned_area(slope: DVec2, light: DVec3) -> f64 {
    0.5 * (light.z - (light.x * slope.x + light.y * slope.y)).max(0.0)
}

fn row_area(field: &Heightfield, window: Window, y: usize, light: DVec3) -> f64 {
    let cell = |x| {
        let corners = field.corners(x, y);
        turned_area(corners.lower_slope(), light) + turned_area(corners.upper_slope(), light)
    };
    (window.x.0..window.x.1).map(cell).sum()
}

/// A uniform point of the lower (u + v <= 1) or of the upper facet: the square folded over its diagonal.
fn point_in(upper: bool, rng: &mut Pcg64Dxsm) -> (f64, f64) {
    let (a, b) = (rng::uniform(rng), rng::uniform(rng));
    let (u, v) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
    if upper { (1.0 - u, 1.0 - v) } else { (u, v) }
}
