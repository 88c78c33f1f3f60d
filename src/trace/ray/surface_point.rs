//! Facets, points on them, and what a ray meets.

use crate::surface::Heightfield;

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
pub struct SurfacePoint {
    /// The facet, never tested by rays that start here: a plane cannot be hit twice.
    pub facet: Facet,
    /// Along x inside the cell, [0, 1].
    pub u: f64,
    /// Along y inside the cell, [0, 1].
    pub v: f64,
    /// Height.
    pub z: f64,
}

impl SurfacePoint {
    /// The same point of the field upside down.
    pub fn upside_down(&self) -> Self {
        SurfacePoint { z: -self.z, ..*self }
    }

    /// The point (u, v) of a facet, its height from the facet's plane.
    pub fn on(field: &Heightfield, facet: Facet, u: f64, v: f64) -> Self {
        let c = field.corners(facet.x, facet.y);
        let z = if facet.upper {
            c.h11 + (1.0 - u) * (c.h01 - c.h11) + (1.0 - v) * (c.h10 - c.h11)
        } else {
            c.h00 + u * (c.h10 - c.h00) + v * (c.h01 - c.h00)
        };
        SurfacePoint { facet, u, v, z }
    }
}

/// Where a ray ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome<P = SurfacePoint> {
    /// Above every height: it hits nothing any more.
    Escaped,
    /// On the surface, from above.
    Hit(P),
    /// Over the edge of a field that does not continue itself.
    LeftDomain,
    /// After more steps than its slope allows: a fault of the program, counted and reported.
    Lost,
}
