//! Very long rays along a corridor of a periodic field: along a wall, between ridges, along a groove.
//!
//! Such a ray comes round the field thousands of times, each time a little further aside and a little higher or
//! lower, and the wall keeps it below the highest corner of every tile. Of two passes round the field that cross the
//! same edges in the same order, every pass in between crosses those edges as well: the place on an edge and the
//! clearance there change by the same amount from pass to pass. Where both passes clear the field by more than the
//! traversal's rounding, all in between do, and are taken at once. What ends that is a corner of the grid or the
//! surface, so that a ray costs some passes for each of them instead of one for each time that it comes round.

use glam::DVec3;

use super::ray_state::{Outlook, RayState};
use crate::surface::Heightfield;

/// Times round the field among which the one is chosen that comes back closest to where it began.
const TIMES_ROUND: u32 = 16;
/// Passes that are worth it: to look at two and to traverse two more takes as long as this.
const FEWEST: f64 = 4.0;

/// A pass of a ray round its field, back to about the same place.
#[derive(Debug, Clone, Copy)]
struct Pass {
    /// Edges crossed along each axis: whole fields.
    x: f64,
    y: f64,
    /// What it adds to the ray's parameter.
    t: f64,
}

impl Pass {
    /// The best one for a direction; `None` where no ray comes round.
    fn of(field: &Heightfield, d: DVec3) -> Option<Self> {
        let (dx, dy) = (d.x.abs(), d.y.abs());
        if !field.is_periodic() || dx + dy == 0.0 {
            return None;
        }
        let (cells_x, cells_y) = (field.cells_x() as f64, field.cells_y() as f64);
        let along_x = dx >= dy;
        let (along, across, ratio) =
            if along_x { (cells_x, cells_y, dy / dx) } else { (cells_y, cells_x, dx / dy) };
        let pass = |times: u32| {
            let edges = f64::from(times) * along;
            let whole = (edges * ratio / across).round() * across;
            ((edges * ratio - whole).abs(), edges, whole)
        };
        let passes = (1..=TIMES_ROUND).map(pass);
        // The shorter one of two that come back equally close.
        let (_, edges, whole) = passes.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let (x, y) = if along_x { (edges, whole) } else { (whole, edges) };
        Some(Pass { x, y, t: edges / dx.max(dy) })
    }

    fn edges(&self) -> f64 {
        self.x + self.y
    }
}

/// Looks for corridors along one ray, not more often than that pays.
pub(crate) struct Corridors {
    pass: Option<Pass>,
    /// Steps of the traversal until it is looked again, and how many those were at the last time.
    left: f64,
    wait: f64,
}

impl Corridors {
    pub fn new(field: &Heightfield, d: DVec3) -> Self {
        let pass = Pass::of(field, d);
        // Rays that end in this time are not held up; from then on looking takes as long as walking at most.
        let wait = pass.map_or(f64::INFINITY, |pass| 2.0 * pass.edges());
        Corridors { pass, left: wait, wait }
    }

    /// Counts a step of the traversal: whether it is time to look.
    pub fn is_due(&mut self) -> bool {
        self.left -= 1.0;
        self.left < 0.0
    }

    /// Takes `way` over as many passes as are free of the field: `limit` is the number of edges it may cross in all,
    /// `margin` the traversal's rounding at a ray parameter.
    pub fn take(&mut self, way: &mut RayState, field: &Heightfield, limit: f64, margin: impl Fn(f64) -> f64) {
        let Some(pass) = self.pass else { return };
        match free(way, field, pass, limit, margin) {
            // Past what ended it the next corridor may begin.
            Some(further) => (*way, self.wait) = (further, 2.0 * pass.edges()),
            None => self.wait *= 2.0,
        }
        self.left = self.wait;
    }
}

/// `way` after all passes that are seen to be free; `None` where they are fewer than it is worth.
fn free<'a>(
    way: &RayState<'a>,
    field: &Heightfield,
    pass: Pass,
    limit: f64,
    margin: impl Fn(f64) -> f64,
) -> Option<RayState<'a>> {
    // The last of them ends below the height from which on the ray is clear, and within its limit.
    let below = (way.clear_at - way.entry.t) / pass.t;
    let most = below.min((limit - way.x.crossed - way.y.crossed) / pass.edges()).floor() - 1.0;
    let margin = |passes: f64| margin(way.entry.t + (passes + 1.0) * pass.t);
    if most < FEWEST {
        return None;
    }
    let (_, until) = side_by_side(way, field, pass, 1.0, margin(1.0))?;
    // One less: where the last one ends is rounded.
    let mut passes = most.min(until.floor() - 1.0);
    while passes >= FEWEST {
        if let Some((further, _)) = side_by_side(way, field, pass, passes, margin(passes)) {
            return Some(further);
        }
        passes = (passes / 2.0).floor();
    }
    None
}

/// Traverses the pass that `way` is about to begin and the one that comes `passes` later: that one's end, and after
/// how many passes the first change comes, if all changes as from the one to the other. `None` where they cross other
/// edges or either comes within `margin` of the surface.
fn side_by_side<'a>(
    way: &RayState<'a>,
    field: &Heightfield,
    pass: Pass,
    passes: f64,
    margin: f64,
) -> Option<(RayState<'a>, f64)> {
    let mut near = way.clone();
    let mut far = way.further(field, passes * pass.x, passes * pass.y)?;
    let mut until = f64::INFINITY;
    for _ in 0..pass.edges() as u64 {
        let (here, there) = (near.outlook(field)?, far.outlook(field)?);
        if here.across_x != there.across_x || here.lowest().min(there.lowest()) <= margin {
            return None;
        }
        until = until.min(change(&here, &there, margin));
        if near.cross(field).is_some() || far.cross(field).is_some() || near.cell != far.cell {
            return None;
        }
    }
    Some((far, passes * until))
}

/// How many times what changes from one outlook to the other may change until the ray leaves the cell by another edge or
/// comes within `margin` of the surface.
fn change(here: &Outlook, there: &Outlook, margin: f64) -> f64 {
    let by = there.place - here.place;
    let to_corner = if by > 0.0 { (1.0 - here.place) / by } else { here.place / -by };
    let to_surface = |here: f64, there: f64| (here - margin) / (here - there);
    let falls = |here: f64, there: f64| if there < here { to_surface(here, there) } else { f64::INFINITY };
    let to_corner = if by == 0.0 { f64::INFINITY } else { to_corner };
    to_corner.min(falls(here.exit, there.exit)).min(falls(here.diagonal, there.diagonal))
}
