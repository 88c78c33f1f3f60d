//! Starts as other programs find them: a beam falls on the whole patch, and what its rays meet first is where paths
//! start.

use glam::DVec3;
use gonio::rng;
use gonio::trace::{Facet, LONGEST, Outcome, SimdTraversal, SurfacePoint, Waves};
use rand_pcg::Pcg64Dxsm;

/// Rays that are followed together.
const WAVE: usize = 4096;
/// Rays start this many cells beside where they come down to the highest point, along their main axis: in another
/// cell, for a ray is never tested against the facet that it starts over.
const ASIDE: f64 = 1.5;

/// A beam of parallel rays, of equal flux each.
pub struct FromAbove<'a> {
    over: SimdTraversal<'a>,
    /// Towards the light, field coordinates.
    light: DVec3,
    /// From a point at the highest height back to where the ray starts; none for a beam from the zenith.
    back: Option<DVec3>,
}

impl<'a> FromAbove<'a> {
    /// A beam from `light` (canonical, field coordinates; light.z > 0) over a periodic field.
    pub fn new(over: SimdTraversal<'a>, light: DVec3) -> Self {
        let across = light.x.abs().max(light.y.abs());
        FromAbove { over, light, back: (across > 0.0).then(|| light * (ASIDE / across)) }
    }

    /// Calls `visit` with the first meeting points of `count` rays, row by row. The plan of the patch is cut into equal
    /// rows and these into equal parts, with a uniform point in each part: less noise than points anywhere.
    ///
    /// A beam from the zenith needs no rays: what it meets stands straight below. Returns the rays without an answer.
    pub fn each(&self, count: u64, rng: &mut Pcg64Dxsm, mut visit: impl FnMut(SurfacePoint)) -> u64 {
        let mut wave: Vec<SurfacePoint> = Vec::with_capacity(WAVE);
        let mut waves = Waves::default();
        let mut lost = 0;
        let rows = (count as f64).sqrt().floor().max(1.0) as u64;
        for row in 0..rows {
            let (begin, end) = (row * count / rows, (row + 1) * count / rows);
            for part in begin..end {
                let x = ((part - begin) as f64 + rng::uniform(rng)) / (end - begin) as f64;
                let y = (row as f64 + rng::uniform(rng)) / rows as f64;
                let start = self.start(x, y);
                if self.back.is_none() {
                    let SurfacePoint { facet, u, v, .. } = start;
                    visit(SurfacePoint::on(self.over.traversal().field(), facet, u, v));
                    continue;
                }
                wave.push(start);
                if wave.len() == WAVE {
                    lost += self.follow(&mut waves, &mut wave, &mut visit);
                }
            }
        }
        lost + self.follow(&mut waves, &mut wave, &mut visit)
    }

    /// The start of the ray that comes down to the highest height at (x, y), shares of the patch's sides.
    fn start(&self, x: f64, y: f64) -> SurfacePoint {
        let field = self.over.traversal().field();
        let back = self.back.unwrap_or(DVec3::ZERO);
        let of = |share: f64, cells: usize, back: f64| {
            let at = share * cells as f64 + back;
            ((at.floor() as i64).rem_euclid(cells as i64) as usize, at - at.floor())
        };
        let ((x, u), (y, v)) = (of(x, field.cells_x(), back.x), of(y, field.cells_y(), back.y));
        let z = self.over.traversal().range().1 + back.z;
        let facet = Facet { x, y, upper: u + v > 1.0 };
        SurfacePoint { z, ..SurfacePoint::on(field, facet, u, v) }
    }

    /// Follows the rays of `wave`, and empties it; returns how many have no answer.
    fn follow(
        &self,
        waves: &mut Waves,
        wave: &mut Vec<SurfacePoint>,
        visit: &mut impl FnMut(SurfacePoint),
    ) -> u64 {
        let mut lost = 0;
        let mut end = |outcome| match outcome {
            Outcome::Hit(place) => visit(place),
            _ => lost += 1,
        };
        let down = -self.light;
        let fits = self.back.is_some_and(|back| back.z < f64::from(LONGEST));
        if fits {
            waves.closest_hit(&self.over, wave.len(), |k| (&wave[k], down), |_, outcome| end(outcome));
        } else {
            // From far above f32 would not know where the ray comes down.
            wave.iter().for_each(|start| end(self.over.traverse_long(start, down)));
        }
        wave.clear();
        lost
    }
}
