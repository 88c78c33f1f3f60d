//! A height map and a ray from bytes: the ray ends, where the plain walk ends, over tiles as cell by cell.
//!
//! The first bytes give the sides, whether the field continues itself, the start and the direction; the others the heights.

use glam::DVec3;
use gonio::surface::Heightfield;
use gonio::trace::{Facet, GridTraversal, SurfacePoint, TilePeaks};

/// Traces the ray both ways; panics where they differ.
pub fn trace(bytes: &[u8]) {
    let [nx, ny, flags, x, y, u, v, dx, dy, dz, heights @ ..] = bytes else { return };
    let (nx, ny, periodic) = (8 + usize::from(nx % 64), 8 + usize::from(ny % 64), flags & 1 == 0);
    let extra = usize::from(!periodic);
    let height = |k: usize| {
        let at = |byte: usize| heights.get((2 * k + byte) % heights.len().max(1)).copied().unwrap_or(0);
        // Sixteen powers of ten up to that of the largest map that is let in, with a sign.
        let size = f64::from(at(0)) * 10f64.powi(i32::from(at(1) % 16) - 12);
        if at(1) & 128 != 0 { -size } else { size }
    };
    let field = Heightfield::new(nx, ny, periodic, (0..(nx + extra) * (ny + extra)).map(height).collect());
    let facet = Facet { x: usize::from(*x) % nx, y: usize::from(*y) % ny, upper: flags & 2 != 0 };
    let (a, b) = (f64::from(*u) / 256.0, f64::from(*v) / 256.0);
    let (u, v) = if (a + b > 1.0) == facet.upper { (a, b) } else { (1.0 - a, 1.0 - b) };
    let place = SurfacePoint::on(&field, facet, u, v);
    let part = |byte: u8| f64::from(byte) - 128.0;
    let d = DVec3::new(part(*dx), part(*dy), part(*dz));
    let traversal = GridTraversal::new(&field);
    if traversal.step_limit(place.z, d) < 1 << 20 {
        let peaks = TilePeaks::new(&field);
        let (plain, tiles) =
            (traversal.traverse(&place, d), traversal.with_peaks(&peaks).traverse(&place, d));
        assert!(d.z == 0.0 || plain == tiles, "{plain:?} or {tiles:?}: {place:?} along {d:?}");
    }
}
