//! Very long rays in f64: the answer of the plain walk, without the cells that it finds nothing in.
//!
//! A ray that climbs by a thousandth of a cell per edge crosses the field many times before it is above it, nearly
//! always far over everything. Such a ray is taken over whole tiles of 4^L x 4^L cells at once wherever it stays above
//! their highest corner by more than the walk's rounding; elsewhere it is followed cell by cell as in `walk`.

use glam::DVec3;

use super::lane_field::LaneField;
use super::walk::{Outcome, Place, Walker};
use super::way::{Axis, Way};

/// Where a ray leaves the tile that it is in.
struct Exit {
    t: f64,
    across_x: bool,
    /// Edges that it crosses along each axis.
    x: f64,
    y: f64,
}

/// Follows the ray from `start` along `d` to its end: bit for bit `Walker::walk`, of which `lanes` holds the field.
///
/// Held by: `tests/long_rays.rs`, ray by ray against `Walker::walk`.
pub(super) fn walk(walker: &Walker, lanes: &LaneField, start: &Place, d: DVec3) -> Outcome {
    let field = walker.field();
    let limit = walker.step_limit(start.z, d) as f64;
    let (lowest, highest) = walker.range();
    // Where the walk compares heights: 3 roundings of numbers up to the largest height, and a place on an edge that
    // is off by 3 roundings of the edges crossed, times the steepest slope. 2^-53 each; 2^-49 leaves room.
    let unit = 2f64.powi(-49) * (highest - lowest + highest.abs().max(lowest.abs()).max(start.z.abs()));
    let mut way = Way::new(walker, start, d);
    // The start's cell is left by the walk itself: the facet under the start is not tested.
    if let Some(outcome) = way.cross(field) {
        return outcome;
    }
    let mut level = 0;
    // After a jump, the axis across which the ray came into its cell: the walk goes on from that edge.
    let mut jumped = None;
    while way.x.crossed + way.y.crossed < limit {
        let exit = exit(&way, level);
        let low = way.height(if d.z < 0.0 { exit.t } else { way.entry.t });
        let margin = unit * (1.0 + exit.t * (d.x.abs() + d.y.abs()));
        let before = way.cell;
        if low > lanes.highest_in_tile(level, before) + margin {
            if exit.t >= way.clear_at {
                return Outcome::Escaped;
            }
            way.x.crossed += exit.x;
            way.y.crossed += exit.y;
            way.cell.0 = moved(&way.x, before.0, exit.x, field.cells_x());
            way.cell.1 = moved(&way.y, before.1, exit.y, field.cells_y());
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
        if level < lanes.top_level() && ((before.0 ^ way.cell.0) | (before.1 ^ way.cell.1)) >> next != 0 {
            level += 1;
        }
    }
    Outcome::Lost
}

/// The exit from the tile of 4^level x 4^level cells that the ray is in, and the edges that the walk crosses on the
/// way there: an edge across x before one across y only if it comes strictly first.
fn exit(way: &Way, level: usize) -> Exit {
    let (to_x, to_y) = (to_edge(&way.x, way.cell.0, level), to_edge(&way.y, way.cell.1, level));
    let (tx, ty) = (way.x.after(to_x - 1.0), way.y.after(to_y - 1.0));
    if tx < ty {
        Exit { t: tx, across_x: true, x: to_x, y: edges_until(&way.y, to_y, |t| t <= tx, tx) }
    } else {
        Exit { t: ty, across_x: false, x: edges_until(&way.x, to_x, |t| t < ty, ty), y: to_y }
    }
}

/// Edges from the present cell to the far side of its tile.
fn to_edge(axis: &Axis, cell: usize, level: usize) -> f64 {
    let side = 1usize << (2 * level);
    let within = cell & (side - 1);
    (if axis.forward { side - within } else { within + 1 }) as f64
}

/// How many of the next edges, fewer than `most`, are `passed`; `t` is the parameter where they cease to be.
fn edges_until(axis: &Axis, most: f64, passed: impl Fn(f64) -> bool, t: f64) -> f64 {
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

/// The cell `edges` further along an axis of a periodic field whose side is a power of two.
fn moved(axis: &Axis, cell: usize, edges: f64, cells: usize) -> usize {
    let by = edges as usize;
    (if axis.forward { cell.wrapping_add(by) } else { cell.wrapping_sub(by) }) & (cells - 1)
}
