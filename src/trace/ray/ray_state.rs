//! A ray on its way through the cells of a field, in f64: edges crossed, and the clearance where it comes in.
//!
//! Input: a start and a direction. Output: what the ray meets in the cell that it is in. Every number follows from
//! the start and from whole counts of edges, so that a ray put further along its way has the same bits there as one
//! that was followed cell by cell.

use glam::DVec3;

use super::field_range::FieldRange;
use super::surface_point::{Facet, Outcome, SurfacePoint};
use crate::surface::Heightfield;
use crate::surface::heightfield::Corners;

/// One axis of the traversal: where the next cell edge is.
#[derive(Clone)]
pub(crate) struct AxisSteps {
    pub forward: bool,
    speed: f64,
    /// 1/|d|, infinite for a ray that never crosses such an edge.
    inverse: f64,
    /// From the start to the first edge, in cells.
    first: f64,
    /// Edges crossed so far.
    pub crossed: f64,
}

impl AxisSteps {
    fn new(direction: f64, place: f64) -> Self {
        let forward = direction > 0.0;
        let first = if forward { 1.0 - place } else { place };
        let speed = direction.abs();
        AxisSteps { forward, speed, inverse: 1.0 / speed, first, crossed: 0.0 }
    }

    /// Ray parameter of the next edge.
    fn next(&self) -> f64 {
        self.after(0.0)
    }

    /// Ray parameter of the edge that comes after `more` others; grows with `more`, whatever rounding says.
    pub fn after(&self, more: f64) -> f64 {
        if self.inverse == f64::INFINITY {
            f64::INFINITY
        } else {
            (self.first + (self.crossed + more)) * self.inverse
        }
    }

    /// Ray parameter of the last edge that was crossed, if one was.
    fn last(&self) -> Option<f64> {
        (self.crossed > 0.0).then(|| self.after(-1.0))
    }

    /// About how many edges lie between the start and parameter `t`.
    pub fn edges_before(&self, t: f64) -> f64 {
        t * self.speed - self.first
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
pub(crate) struct Crossing {
    pub t: f64,
    clearance: f64,
}

/// How a ray leaves its cell, and what it clears there.
pub(crate) struct Outlook {
    pub across_x: bool,
    /// Along the edge, [0, 1].
    pub place: f64,
    /// Clearance on that edge.
    pub exit: f64,
    /// Clearance on the diagonal, infinite where that is not crossed.
    pub diagonal: f64,
}

impl Outlook {
    pub fn lowest(&self) -> f64 {
        self.exit.min(self.diagonal)
    }
}

/// A ray under way: the cell that it is in, and how it came in.
#[derive(Clone)]
pub(crate) struct RayState<'a> {
    start: &'a SurfacePoint,
    pub d: DVec3,
    pub cell: (usize, usize),
    pub x: AxisSteps,
    pub y: AxisSteps,
    /// From this parameter on the ray is above every height.
    pub clear_at: f64,
    pub entry: Crossing,
    /// The facet by which the cell was entered.
    upper: bool,
    /// Whether that is the start's own.
    own: bool,
}

impl<'a> RayState<'a> {
    pub fn new(over: &FieldRange, start: &'a SurfacePoint, d: DVec3) -> Self {
        RayState {
            start,
            d,
            cell: (start.facet.x, start.facet.y),
            x: AxisSteps::new(d.x, start.u),
            y: AxisSteps::new(d.y, start.v),
            clear_at: over.clear_at(start.z, d.z),
            // The clearance over the start's own facet is never negative, whatever rounding says.
            entry: Crossing { t: 0.0, clearance: 0.0 },
            upper: start.facet.upper,
            own: true,
        }
    }

    /// Follows the ray through its cell; `None` where it continues into the next one.
    #[inline(always)]
    pub fn cross(&mut self, field: &Heightfield) -> Option<Outcome> {
        let (tx, ty) = (self.x.next(), self.y.next());
        let along_x = tx < ty;
        let t = if along_x { tx } else { ty };
        if t == f64::INFINITY {
            return Some(if self.d.z > 0.0 { Outcome::Escaped } else { Outcome::Lost });
        }
        let corners = field.corners(self.cell.0, self.cell.1);
        let local = self.local();
        let leaves_upper = if along_x { self.x.forward } else { self.y.forward };
        let (mut entry, mut upper, mut own) = (self.entry, self.upper, self.own);
        if upper != leaves_upper {
            let diagonal = local.diagonal(&corners, entry.t, t);
            if !own && diagonal.clearance < 0.0 {
                return Some(self.hit(field, upper, entry, diagonal));
            }
            (entry, upper, own) = (diagonal, leaves_upper, false);
        }
        let exit = if along_x {
            local.x_edge(&corners, self.x.forward, t)
        } else {
            local.y_edge(&corners, self.y.forward, t)
        };
        if !own && exit.clearance < 0.0 {
            return Some(self.hit(field, upper, entry, exit));
        }
        if t >= self.clear_at {
            return Some(Outcome::Escaped);
        }
        let periodic = field.is_periodic();
        let next = if along_x {
            self.x.step(self.cell.0, field.cells_x(), periodic).map(|column| (column, self.cell.1))
        } else {
            self.y.step(self.cell.1, field.cells_y(), periodic).map(|row| (self.cell.0, row))
        };
        let Some(next) = next else { return Some(Outcome::LeftDomain) };
        // A cell is entered by the edge opposite to the one by which its neighbour was left.
        (self.cell, self.entry, self.upper, self.own) = (next, exit, !leaves_upper, false);
        None
    }

    /// Looks at the edge, across x or y, by which a ray that was put further along came into its cell: its clearance,
    /// and the facet there. Cell, edges crossed and `entry.t` are up to date.
    pub fn enter(&mut self, field: &Heightfield, across_x: bool) {
        let t = self.entry.t;
        let corners = field.corners(self.cell.0, self.cell.1);
        let local = self.local();
        // The near edge here is the far edge of the cell before: the same heights, so the same bits.
        (self.entry, self.upper) = if across_x {
            (local.x_edge(&corners, !self.x.forward, t), !self.x.forward)
        } else {
            (local.y_edge(&corners, !self.y.forward, t), !self.y.forward)
        };
        self.own = false;
    }

    /// How the ray will leave its cell; `None` where it never does.
    pub fn outlook(&self, field: &Heightfield) -> Option<Outlook> {
        let (tx, ty) = (self.x.next(), self.y.next());
        let across_x = tx < ty;
        let t = if across_x { tx } else { ty };
        if t == f64::INFINITY {
            return None;
        }
        let (corners, local) = (field.corners(self.cell.0, self.cell.1), self.local());
        let (u, v) = local.point(t);
        let (place, forward, exit) = if across_x {
            (v, self.x.forward, local.x_edge(&corners, self.x.forward, t))
        } else {
            (u, self.y.forward, local.y_edge(&corners, self.y.forward, t))
        };
        let diagonal = if self.upper == forward {
            f64::INFINITY
        } else {
            local.diagonal(&corners, self.entry.t, t).clearance
        };
        Some(Outlook { across_x, place, exit: exit.clearance, diagonal })
    }

    /// The ray after so many more edges of each axis, whole fields of them, at the edge by which it came into its cell;
    /// `None` where it crosses the edges before or after that one in another order.
    pub fn further(&self, field: &Heightfield, edges_x: f64, edges_y: f64) -> Option<Self> {
        let mut far = self.clone();
        far.x.crossed += edges_x;
        far.y.crossed += edges_y;
        // Of two edges at once the one across y comes first.
        let across_x = self.x.last() == Some(self.entry.t);
        let t = if across_x { far.x.last() } else { far.y.last() }?;
        let in_order = if across_x {
            far.y.last().is_none_or(|last| last <= t) && t < far.y.next()
        } else {
            far.x.last().is_none_or(|last| last < t) && t <= far.x.next()
        };
        far.entry.t = t;
        far.enter(field, across_x);
        in_order.then_some(far)
    }

    /// The ray's height at `t`: grows or falls with `t`, whatever rounding says.
    pub fn height(&self, t: f64) -> f64 {
        self.start.z + t * self.d.z
    }

    fn local(&self) -> RayInCell<'a> {
        RayInCell { start: self.start, d: self.d, offset: (self.x.offset(), self.y.offset()) }
    }

    /// The point of the present cell between `entry` (clearance >= 0) and `exit` (< 0) where the clearance is 0.
    fn hit(&self, field: &Heightfield, upper: bool, entry: Crossing, exit: Crossing) -> Outcome {
        // Rounding may leave a clearance of -1e-17 at the end of the start's own facet.
        let above = entry.clearance.max(0.0);
        let t = entry.t + (exit.t - entry.t) * (above / (above - exit.clearance));
        let (u, v) = self.local().point(t);
        let facet = Facet { x: self.cell.0, y: self.cell.1, upper };
        Outcome::Hit(SurfacePoint::on(field, facet, u, v))
    }
}

/// A ray as seen from the present cell.
struct RayInCell<'a> {
    start: &'a SurfacePoint,
    d: DVec3,
    offset: (f64, f64),
}

impl RayInCell<'_> {
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
