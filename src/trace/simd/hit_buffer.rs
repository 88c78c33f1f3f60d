//! The answers of the kernel: what became of each ray.

/// Edges that a ray crosses at most in f32 before its place is computed anew; one that is longer is `Beyond`.
///
/// A position t d is rounded twice (relative 2^-23 together): at 4096 edges to 5e-4 of a cell. A visibility answer
/// can change only where the ray passes a facet's edge that closely; heights vary over several cells, so that this
/// concerns a fraction below 5e-4/cells per ray even if every ray were so long.
pub const LONGEST: f32 = 4096.0;

/// What became of a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum RayOutcome {
    /// It rises above every height.
    Escaped,
    /// It hits a facet.
    Blocked,
    /// It is longer than f32 can follow: another segment or the f64 traversal must say.
    Beyond,
}

/// Where a ray meets a facet: cells from the start's cell, and the stretch of the ray over the facet, its parameter
/// with |dx| + |dy| = 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LaneHit {
    /// Cells along x from the start's cell.
    pub cells_x: i32,
    /// Cells along y from the start's cell.
    pub cells_y: i32,
    /// The upper facet.
    pub upper: bool,
    /// Where the ray comes over the facet.
    pub from: f32,
    /// Where its clearance is negative.
    pub to: f32,
}

/// The hits to a batch, in its order.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct HitBuffer {
    /// One for each ray.
    pub outcomes: Vec<RayOutcome>,
    /// Valid where the outcome is `Blocked`, if hits were asked for.
    pub hits: Vec<LaneHit>,
}
