//! Very long rays in f64: the answer of the plain traversal, without the cells that it finds nothing in.
//!
//! A ray that climbs by a thousandth of a cell per edge crosses the field many times before it is above it, nearly
//! always far over everything. Such a ray is taken over whole tiles of 4^L x 4^L cells at once wherever it stays
//! above their highest corner by more than the traversal's rounding; elsewhere it is followed cell by cell as in
//! `traverse`, but along a corridor (`corridor`) over many passes round the field at once.

use glam::DVec3;

use super::corridor::Corridors;
use super::field_range::FieldRange;
use super::ray_state::{AxisSteps, RayState};
use super::surface_point::{Outcome, SurfacePoint};
use super::tile_peaks::Tiles;
use crate::surface::Heightfield;

/// Where a ray leaves the tile that it is in.
struct TileExit {
    t: f64,
    across_x: bool,
    /// Edges that it crosses along each axis.
    x: f64,
    y: f64,
}

/// Follows the ray from `start` along `d` to its end: bit for bit `GridTraversal::traverse`, of whose field `tiles` are.
// Tested by `tests/it/trace/long_rays.rs`, ray by ray against `GridTraversal::traverse`.
pub(crate) fn traverse(over: &FieldRange, tiles: &impl Tiles, start: &SurfacePoint, d: DVec3) -> Outcome {
    let mut way = RayState::new(over, start, d);
    // The start's cell is left by the plain traversal: the facet under the start is not tested.
    if let Some(outcome) = way.cross(over.field) {
        return outcome;
    }
    traverse_rest(over, tiles, start, way)
}

/// Follows a ray that has left its start's cell to its end.
pub(crate) fn traverse_rest(
    over: &FieldRange,
    tiles: &impl Tiles,
    start: &SurfacePoint,
    mut way: RayState,
) -> Outcome {
    let (field, d) = (over.field, way.d);
    let limit = over.step_limit(start.z, d) as f64;
    let FieldRange { lowest, highest, .. } = *over;
    // Where the traversal compares heights: 3 roundings of numbers up to the largest height, and a place on an edge that
    // is off by 3 roundings of the edges crossed, times the steepest slope. 2^-53 each; 2^-49 leaves room.
    let unit = 2f64.powi(-49) * (highest - lowest + highest.abs().max(lowest.abs()).max(start.z.abs()));
    // Edges after which a ray along an axis comes back to where it is now.
    let round = round(field, d).unwrap_or(f64::INFINITY);
    let begin = way.x.crossed + way.y.crossed;
    let rise = d.z * (round / (d.x.abs() + d.y.abs()));
    let mut level = 0;
    let margin_at = |t: f64| unit * (1.0 + t * (d.x.abs() + d.y.abs()));
    let mut corridors = Corridors::new(field, d);
    // After a jump, the axis across which the ray came into its cell: it continues from that edge.
    let mut jumped = None;
    while way.x.crossed + way.y.crossed < limit {
        if corridors.is_due() {
            if let Some(across_x) = jumped.take() {
                way.enter(field, across_x);
            }
            corridors.take(&mut way, field, limit, margin_at);
        }
        let exit = exit(&way, field, level);
        let low = way.height(if d.z < 0.0 { exit.t } else { way.entry.t });
        let margin = margin_at(exit.t);
        // One round later over the same heights, higher by more than rounding, or level: nothing blocked it and
        // nothing will.
        let been_round = way.x.crossed + way.y.crossed > begin + round;
        if been_round && (d.z == 0.0 || rise > margin) {
            return Outcome::Escaped;
        }
        let before = way.cell;
        if low > tiles.highest_in_tile(level, before) + margin {
            if exit.t >= way.clear_at {
                return Outcome::Escaped;
            }
            way.x.crossed += exit.x;
            way.y.crossed += exit.y;
            let moved = [
                moved(&way.x, before.0, exit.x, field.cells_x()),
                moved(&way.y, before.1, exit.y, field.cells_y()),
            ];
            if !field.is_periodic() && moved.iter().any(|&(_, over_the_edge)| over_the_edge) {
                return Outcome::LeftDomain;
            }
            way.cell = (moved[0].0, moved[1].0);
            way.entry.t = exit.t;
            jumped = Some(exit.across_x);
        } else if level > 0 {
            level -= 1;
            continue;
        } else {
            if let Some(across_x) = jumped.take() {
                way.enter(field, across_x);
            }
            if let Some(outcome) = way.cross(field) {
                return outcome;
            }
        }
        // Up where a tile of the next level is left.
        let next = 2 * (level + 1);
        if level < tiles.top_level() && ((before.0 ^ way.cell.0) | (before.1 ^ way.cell.1)) >> next != 0 {
            level += 1;
        }
    }
    Outcome::Lost
}

/// The edges that a ray along an axis of a periodic field crosses on its way once round it, if it is one that does
/// not go down.
fn round(field: &Heightfield, d: DVec3) -> Option<f64> {
    if !field.is_periodic() || d.z < 0.0 {
        return None;
    }
    match (d.x == 0.0, d.y == 0.0) {
        (false, true) => Some(field.cells_x() as f64),
        (true, false) => Some(field.cells_y() as f64),
        _ => None,
    }
}

/// The exit from the tile of 4^level x 4^level cells that the ray is in, and the edges that the traversal crosses on the
/// way there: an edge across x before one across y only if it comes strictly first.
fn exit(way: &RayState, field: &Heightfield, level: usize) -> TileExit {
    let to_x = to_edge(&way.x, way.cell.0, level, field.cells_x());
    let to_y = to_edge(&way.y, way.cell.1, level, field.cells_y());
    let (tx, ty) = (way.x.after(to_x - 1.0), way.y.after(to_y - 1.0));
    if tx < ty {
        TileExit { t: tx, across_x: true, x: to_x, y: edges_until(&way.y, to_y, |t| t <= tx, tx) }
    } else {
        TileExit { t: ty, across_x: false, x: edges_until(&way.x, to_x, |t| t < ty, ty), y: to_y }
    }
}

/// Edges from the present cell to the far side of its tile, which ends with the field.
fn to_edge(axis: &AxisSteps, cell: usize, level: usize, cells: usize) -> f64 {
    let side = 1usize << (2 * level);
    let within = cell & (side - 1);
    (if axis.forward { (side - within).min(cells - cell) } else { within + 1 }) as f64
}

/// How many of the next edges, fewer than `most`, are `passed`; `t` is the parameter where they cease to be.
fn edges_until(axis: &AxisSteps, most: f64, passed: impl Fn(f64) -> bool, t: f64) -> f64 {
    let guess = (axis.edges_before(t).ceil() - axis.crossed).clamp(0.0, most - 1.0);
    let mut edges = if guess.is_finite() { guess } else { 0.0 };
    // The guess is rounded; parameters of edges grow with their number.
    while edges + 1.0 < most && passed(axis.after(edges)) {
        edges += 1.0;
    }
    while edges > 0.0 && !passed(axis.after(edges - 1.0)) {
        edges -= 1.0;
    }
    edges
}

/// The cell `edges` further along an axis, no further than just over the field's edge, and whether it lies there: of a
/// periodic field it is the first cell on the other side.
fn moved(axis: &AxisSteps, cell: usize, edges: f64, cells: usize) -> (usize, bool) {
    let by = edges as usize;
    match axis.forward {
        true if cell + by < cells => (cell + by, false),
        true => (0, true),
        false if by <= cell => (cell - by, false),
        false => (cells - 1, true),
    }
}
