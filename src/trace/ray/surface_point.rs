//! Facets, points on them, and what a ray meets.

use glam::DVec2;

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
pub struct SurfacePoint {
    /// The facet, never tested by rays that start here: a plane cannot be hit twice.
    pub facet: Facet,
    /// Along x inside the cell, [0, 1].
    pub u: f64,
    /// Along y inside the cell, [0, 1].
    pub v: f64,
    /// Height.
    pub z: f64,
    /// The facet's slope (dz/dx, dz/dy), canonical: whoever finds a point has its heights at hand.
    pub slope: DVec2,
}

impl SurfacePoint {
    /// The same point of the field upside down.
    pub fn upside_down(&self) -> Self {
        SurfacePoint { z: -self.z, slope: -self.slope, ..*self }
    }

    /// The point (u, v) of a facet, its height from the facet's plane.
    pub fn on(field: &Heightfield, facet: Facet, u: f64, v: f64) -> Self {
        SurfacePoint::between(field.corners(facet.x, facet.y), facet, u, v)
    }

    /// The same from the corner heights of the facet's cell.
    #[inline]
    pub fn between(corners: Corners, facet: Facet, u: f64, v: f64) -> Self {
        let slope = corners.slope(facet.upper);
        let z = if facet.upper {
            corners.h11 - (1.0 - u) * slope.x - (1.0 - v) * slope.y
        } else {
            corners.h00 + u * slope.x + v * slope.y
        };
        SurfacePoint { facet, u, v, z, slope }
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
