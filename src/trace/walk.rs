//! The plain cell walk in f64: exact order, watertight, no epsilon. The reference for every faster kernel.
//!
//! A ray is followed from cell to cell. In a cell it crosses at most two facets, and which ones follows from the
//! edges by which it enters and leaves, without arithmetic. The clearance (ray height minus surface height) is
//! linear over a facet, so a facet is hit if and only if the clearance is negative where the ray leaves it; the
//! clearance on an edge is computed once and counts for both sides, so that no ray slips through a seam.
//! Coordinates are relative to the present cell; cells are integers.

use glam::DVec3;

use crate::surface::Heightfield;
use crate::surface::heightfield::Corners;

/// One facet of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Facet {
    /// Column of the cell.
    pub x: usize,
    /// Row of the cell.
    pub y: usize,
    /// The facet with corner (x+1, y+1), else the one with corner (x, y).
    pub upper: bool,
}

/// A point on a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The facet, never tested by rays that start here: a plane cannot be hit twice.
    pub facet: Facet,
    /// Along x inside the cell, [0, 1].
    pub u: f64,
    /// Along y inside the cell, [0, 1].
    pub v: f64,
    /// Height.
    pub z: f64,
}

impl Place {
    /// The point (u, v) of a facet, its height from the facet's plane.
    pub fn on(field: &Heightfield, facet: Facet, u: f64, v: f64) -> Self {
        let c = field.corners(facet.x, facet.y);
        let z = if facet.upper {
            c.h11 + (1.0 - u) * (c.h01 - c.h11) + (1.0 - v) * (c.h10 - c.h11)
        } else {
            c.h00 + u * (c.h10 - c.h00) + v * (c.h01 - c.h00)
        };
        Place { facet, u, v, z }
    }
}

/// Where a ray ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// Above every height: it hits nothing any more.
    Escaped,
    /// On a facet, from above.
    Hit(Place),
    /// Over the edge of a field that does not continue itself.
    LeftMap,
    /// After more steps than its slope allows: a fault of the program, counted and reported.
    Lost,
}

/// Walks rays over one field.
#[derive(Debug, Clone, Copy)]
pub struct Walker<'a> {
    field: &'a Heightfield,
    lowest: f64,
    highest: f64,
}

/// One axis of the walk: where the next cell edge is.
struct Axis {
    forward: bool,
    /// 1/|d|, infinite for a ray that never crosses such an edge.
    inverse: f64,
    /// From the start to the first edge, in cells.
    first: f64,
    /// Edges crossed so far.
    crossed: f64,
}

impl Axis {
    fn new(direction: f64, place: f64) -> Self {
        let forward = direction > 0.0;
        let first = if forward { 1.0 - place } else { place };
        Axis { forward, inverse: 1.0 / direction.abs(), first, crossed: 0.0 }
    }

    /// Ray parameter of the next edge.
    fn next(&self) -> f64 {
        if self.inverse == f64::INFINITY { f64::INFINITY } else { (self.first + self.crossed) * self.inverse }
    }

    /// Cells from the start's cell to the present one.
    fn offset(&self) -> f64 {
        if self.forward { self.crossed } else { -self.crossed }
    }

    /// The neighbour of cell `at`, `None` over the edge of an open field.
    fn step(&mut self, at: usize, cells: usize, periodic: bool) -> Option<usize> {
        self.crossed += 1.0;
        match self.forward {
            true if at + 1 < cells => Some(at + 1),
            true => periodic.then_some(0),
            false if at > 0 => Some(at - 1),
            false => periodic.then_some(cells - 1),
        }
    }
}

/// A point of the ray on an edge or diagonal: ray parameter and clearance.
#[derive(Clone, Copy)]
struct Crossing {
    t: f64,
    clearance: f64,
}

impl<'a> Walker<'a> {
    /// A walker over `field`.
    pub fn new(field: &'a Heightfield) -> Self {
        let (lowest, highest) = field.range();
        Walker { field, lowest, highest }
    }

    /// The field.
    pub fn field(&self) -> &'a Heightfield {
        self.field
    }

    /// Lowest and highest height.
    pub fn range(&self) -> (f64, f64) {
        (self.lowest, self.highest)
    }

    /// Follows the ray from `start` along `d` (any length, field coordinates) to its end.
    ///
    /// Held by: `tests/watertight.rs` against a loop over all facets.
    pub fn walk(&self, start: &Place, d: DVec3) -> Outcome {
        self.walk_counted(start, d, &mut 0)
    }

    /// As `walk`, and adds the cells that the ray meets, the first one included, to `cells`.
    ///
    /// Held by: `a_ray_crosses_as_many_cells_as_its_rise_over_the_patch_says`.
    #[inline]
    pub fn walk_counted(&self, start: &Place, d: DVec3, cells: &mut u64) -> Outcome {
        let mut cell = (start.facet.x, start.facet.y);
        let (mut x, mut y) = (Axis::new(d.x, start.u), Axis::new(d.y, start.v));
        let clear_at = self.clear_at(start.z, d.z);
        // The clearance over the start's own facet is never negative, whatever rounding says.
        let mut entry = Crossing { t: 0.0, clearance: 0.0 };
        let mut upper = start.facet.upper;
        let mut own = true;
        for _ in 0..self.step_limit(start.z, d) {
            *cells += 1;
            let (tx, ty) = (x.next(), y.next());
            let along_x = tx < ty;
            let t = if along_x { tx } else { ty };
            if t == f64::INFINITY {
                return if d.z > 0.0 { Outcome::Escaped } else { Outcome::Lost };
            }
            let corners = self.field.corners(cell.0, cell.1);
            let local = Local { start, d, offset: (x.offset(), y.offset()) };
            let leaves_upper = if along_x { x.forward } else { y.forward };
            if upper != leaves_upper {
                let diagonal = local.diagonal(&corners, entry.t, t);
                if !own && diagonal.clearance < 0.0 {
                    return self.hit(&local, Facet { x: cell.0, y: cell.1, upper }, entry, diagonal);
                }
                (entry, upper, own) = (diagonal, leaves_upper, false);
            }
            let exit = if along_x {
                local.x_edge(&corners, x.forward, t)
            } else {
                local.y_edge(&corners, y.forward, t)
            };
            if !own && exit.clearance < 0.0 {
                return self.hit(&local, Facet { x: cell.0, y: cell.1, upper }, entry, exit);
            }
            if t >= clear_at {
                return Outcome::Escaped;
            }
            let periodic = self.field.is_periodic();
            let next = if along_x {
                x.step(cell.0, self.field.cells_x(), periodic).map(|column| (column, cell.1))
            } else {
                y.step(cell.1, self.field.cells_y(), periodic).map(|row| (cell.0, row))
            };
            let Some(next) = next else { return Outcome::LeftMap };
            // A cell is entered by the edge opposite to the one by which its neighbour was left.
            (cell, entry, upper, own) = (next, exit, !leaves_upper, false);
        }
        Outcome::Lost
    }

    /// Ray parameter from which the ray is above every height.
    fn clear_at(&self, z: f64, dz: f64) -> f64 {
        if dz > 0.0 {
            (self.highest - z) / dz
        } else if dz == 0.0 && z >= self.highest {
            0.0
        } else {
            f64::INFINITY
        }
    }

    /// Largest number of cells that a ray from height `z` along `d` can cross between the highest and the lowest
    /// height; a level ray is bounded by the field.
    pub fn step_limit(&self, z: f64, d: DVec3) -> u64 {
        let height = if d.z >= 0.0 { self.highest - z } else { z - self.lowest };
        let crossed = height / d.z.abs() * (d.x.abs() + d.y.abs());
        // Rounding of the last edges: a handful of cells. Casts saturate. A level ray over a periodic field has met
        // every cell after cells x diagonal steps.
        let (nx, ny) = (self.field.cells_x() as u64, self.field.cells_y() as u64);
        if crossed.is_finite() { (crossed as u64).saturating_add(8) } else { nx * ny * (nx + ny) }
    }

    /// The point between `entry` (clearance >= 0) and `exit` (< 0) where the clearance is 0.
    fn hit(&self, local: &Local, facet: Facet, entry: Crossing, exit: Crossing) -> Outcome {
        // Rounding may leave a clearance of -1e-17 at the end of the start's own facet.
        let above = entry.clearance.max(0.0);
        let t = entry.t + (exit.t - entry.t) * (above / (above - exit.clearance));
        let (u, v) = local.point(t);
        Outcome::Hit(Place::on(self.field, facet, u, v))
    }
}

/// A ray as seen from the present cell.
struct Local<'a> {
    start: &'a Place,
    d: DVec3,
    offset: (f64, f64),
}

impl Local<'_> {
    fn point(&self, t: f64) -> (f64, f64) {
        (self.start.u + (t * self.d.x - self.offset.0), self.start.v + (t * self.d.y - self.offset.1))
    }

    fn over(&self, t: f64, surface: f64) -> Crossing {
        Crossing { t, clearance: self.start.z + t * self.d.z - surface }
    }

    /// The crossing of the cell's right or left edge.
    fn x_edge(&self, c: &Corners, right: bool, t: f64) -> Crossing {
        let v = self.point(t).1;
        let (near, far) = if right { (c.h10, c.h11) } else { (c.h00, c.h01) };
        self.over(t, near + v * (far - near))
    }

    /// The crossing of the cell's far or near edge in y.
    fn y_edge(&self, c: &Corners, far: bool, t: f64) -> Crossing {
        let u = self.point(t).0;
        let (left, right) = if far { (c.h01, c.h11) } else { (c.h00, c.h10) };
        self.over(t, left + u * (right - left))
    }

    /// The crossing of the diagonal u + v = 1 between `t0` and `t1`.
    fn diagonal(&self, c: &Corners, t0: f64, t1: f64) -> Crossing {
        let missing = 1.0 - (self.start.u - self.offset.0) - (self.start.v - self.offset.1);
        let t = missing / (self.d.x + self.d.y);
        // Rounding may put the crossing a little outside; for a ray along the diagonal any point of it will do.
        let t = if t > t0 { t.min(t1) } else { t0 };
        let v = self.point(t).1;
        self.over(t, c.h10 + v * (c.h01 - c.h10))
    }
}
