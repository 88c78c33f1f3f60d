//! Surface samples on those facets alone that can send light into one of a few cones.
//!
//! A facet and a direction of the light fix where it sends light, so a facet is wanted or not as a whole. The
//! directions of a cone about `a` of half-angle d lie in a ball of radius sin d about a cos d; wi + wo in the same ball
//! about wi + a cos d; and the normal, which is along wi + wo, in the cone that this ball fills as seen from the
//! origin. Bins of slopes that this cone meets are stepped along.

use glam::{DVec2, DVec3};
use rand_pcg::Pcg64Dxsm;

use super::areas::point_in;
use super::slope_index::{SlopeIndex, Slopes};
use super::systematic_steps::SystematicSteps;
use crate::rng;
use crate::trace::path::single::TracedPatch;
use crate::trace::ray::surface_point::{Facet, SurfacePoint};

/// Facets that are looked at together.
const TOGETHER: usize = 64;

/// The bins of an index that may send light from one direction into some cones.
pub struct ConeSampler<'a> {
    index: &'a SlopeIndex,
    sample: TracedPatch<'a>,
    /// Canonical light direction in field coordinates.
    light: DVec3,
    slots: Vec<Slots>,
}

/// One bin: a slot of equal length for each of its facets, none of which has a larger projected area.
struct Slots {
    bin: usize,
    length: f64,
    /// Sum of the slots up to the end of this bin.
    end: f64,
}

impl<'a> ConeSampler<'a> {
    /// The facets of `sample`, which `index` holds, that may send light from `wi` into a cone of `half_angle` about one
    /// of `axes` (all in the sample's frame). Conservative: some of them do not.
    ///
    /// - Domain: wi.z > 0; the cones lie above the horizon, half-angle below 90 degrees (radians).
    // Tested by `no_wanted_facet_is_left_out`, `the_facet_index_changes_nothing_but_noise`.
    pub fn new(
        index: &'a SlopeIndex,
        sample: TracedPatch<'a>,
        wi: DVec3,
        axes: impl Iterator<Item = DVec3>,
        half_angle: f64,
    ) -> Self {
        let light = sample.to_field(wi);
        let mut chosen = vec![0u64; index.bins() / 64];
        for axis in axes {
            let normals = Normals::new(wi + half_angle.cos() * axis, half_angle.sin());
            index.each_bin(&normals.slopes(&sample), |bin| {
                let word = &mut chosen[bin / 64];
                if *word & (1 << (bin % 64)) == 0 && normals.meet(&sample, &index.slopes(bin)) {
                    *word |= 1 << (bin % 64);
                }
            });
        }
        let mut selection = ConeSampler { index, sample, light, slots: Vec::new() };
        for (k, mut word) in chosen.into_iter().enumerate() {
            while word != 0 {
                selection.add(64 * k + word.trailing_zeros() as usize);
                word &= word - 1;
            }
        }
        selection
    }

    /// Appends a bin, unless it is empty or turned away.
    fn add(&mut self, bin: usize) {
        let [_, length] = self.index.slopes(bin).projected_areas(self.light);
        if length > 0.0 && self.index.count(bin) > 0 {
            let end = self.total() + length * self.index.count(bin) as f64;
            self.slots.push(Slots { bin, length, end });
        }
    }

    /// At least the projected area of the selected facets, in cells.
    pub fn total(&self) -> f64 {
        self.slots.last().map_or(0.0, |slots| slots.end)
    }

    /// Calls `visit` with the samples on the selected facets, one for every `step` of their projected
    /// area: what lies beyond a facet's own area in its slot is passed over. So the density of samples is 1/step on
    /// every facet, exactly, and no facet without a sample is looked at.
    pub fn each(&self, step: f64, rng: &mut Pcg64Dxsm, mut visit: impl FnMut(SurfacePoint)) {
        let mut steps = SystematicSteps::new(u64::MAX, step, rng::uniform(rng));
        let mut begin = 0.0;
        let mut candidates = Vec::with_capacity(TOGETHER);
        for slots in &self.slots {
            let last = self.index.count(slots.bin) - 1;
            while let Some(position) = steps.take(slots.end) {
                let slot = ((position - begin) / slots.length) as usize;
                let within = position - begin - slot as f64 * slots.length;
                candidates.push((self.index.facet(slots.bin, slot.min(last)), within));
                if candidates.len() == TOGETHER {
                    self.start(&mut candidates, rng, &mut visit);
                }
            }
            begin = slots.end;
        }
        self.start(&mut candidates, rng, &mut visit);
    }

    /// Samples on those of the candidates, each with a place in its slot, that reach so far, and drops them all.
    fn start(
        &self,
        candidates: &mut Vec<(Facet, f64)>,
        rng: &mut Pcg64Dxsm,
        visit: &mut impl FnMut(SurfacePoint),
    ) {
        let field = self.sample.traversal.field();
        // All heights are asked for before the first path is followed, so that the accesses to memory overlap.
        let mut reached = [false; TOGETHER];
        for (reached, (facet, within)) in reached.iter_mut().zip(&*candidates) {
            let slope = field.corners(facet.x, facet.y).slope(facet.upper);
            *reached = *within < 0.5 * (self.light.z - self.light.truncate().dot(slope));
        }
        for ((facet, _), _) in candidates.drain(..).zip(reached).filter(|(_, reached)| *reached) {
            let (u, v) = point_in(facet.upper, rng);
            visit(SurfacePoint::on(field, facet, u, v));
        }
    }
}

/// The normals along a ball, as seen from the origin: a cone.
struct Normals {
    /// Centre and radius of the ball.
    centre: DVec3,
    radius: f64,
    /// Unit vector to the centre, and the cone's half-angle.
    axis: DVec3,
    half_angle: f64,
}

impl Normals {
    fn new(centre: DVec3, radius: f64) -> Self {
        let distance = centre.length();
        Normals { centre, radius, axis: centre / distance, half_angle: (radius / distance).asin() }
    }

    /// Canonical slopes in field coordinates around all of the normals: tangents at the ball in the planes y = 0 and
    /// x = 0, x/z = (cx cz +- r sqrt(cx^2 + cz^2 - r^2))/(cz^2 - r^2).
    fn slopes(&self, sample: &TracedPatch) -> Slopes {
        let (c, r) = (self.centre, self.radius);
        let range = |x: f64| {
            let (wide, below) = (r * (x * x + c.z * c.z - r * r).sqrt(), (c.z - r) * (c.z + r));
            [-(x * c.z + wide) / below, -(x * c.z - wide) / below]
        };
        let ([left, right], [near, far]) = (range(c.x), range(c.y));
        let to_field = |p: f64, q: f64| sample.image.to_field(DVec2::new(p, q) / sample.alpha);
        let (a, b) = (to_field(left, near), to_field(right, far));
        Slopes { low: a.min(b), high: a.max(b) }
    }

    /// Whether some of the normals may have one of `slopes`: an angle changes by no more than the slope.
    fn meet(&self, sample: &TracedPatch, slopes: &Slopes) -> bool {
        let world = |slope: DVec2| sample.alpha * sample.image.from_field(slope);
        let (low, high) = (world(slopes.low), world(slopes.high));
        let middle = 0.5 * (low + high);
        let normal = DVec3::new(-middle.x, -middle.y, 1.0);
        let within = self.half_angle + 0.5 * (high - low).length();
        // cos x >= 1 - x^2/2.
        normal.dot(self.axis) >= (1.0 - 0.5 * within * within) * normal.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere;
    use crate::surface::Heightfield;
    use crate::trace::{GridTraversal, PatchSymmetry};

    /// Every facet of a rough field, for lights, images and cones of all kinds: those that send light into a cone are
    /// among the selected bins.
    #[test]
    fn no_wanted_facet_is_left_out() {
        let side = 40;
        let height = |k: usize| 2.0 * (0.37 * k as f64).sin() * (1.3 * k as f64).cos() * (1 + k % 5) as f64;
        let field = Heightfield::new(side, side, true, (0..side * side).map(height).collect());
        let index = SlopeIndex::new(&field).expect("periodic");
        let mut wanted = 0;
        for case in 0..400 {
            let turn = f64::from(case);
            let alpha = DVec2::new([0.02, 0.2, 1.0][case as usize % 3], [0.05, 0.3][case as usize % 2]);
            let image = PatchSymmetry::nth(case as u64 % 8);
            let sample = TracedPatch::opaque(GridTraversal::new(&field), alpha, image);
            let wi = sphere::direction_deg([0.0, 30.0, 60.0, 88.0][case as usize % 4], 37.0 * turn);
            let axis = sphere::direction_deg([0.0, 20.0, 50.0, 75.0][case as usize / 4 % 4], 61.0 * turn);
            let half_angle = [0.5f64, 3.0, 14.0][case as usize / 7 % 3].to_radians();
            let selection = ConeSampler::new(&index, sample, wi, std::iter::once(axis), half_angle);
            let mut selected = vec![false; 2 * side * side];
            for slots in &selection.slots {
                for k in 0..index.count(slots.bin) {
                    let facet = index.facet(slots.bin, k);
                    selected[2 * (facet.y * side + facet.x) + usize::from(facet.upper)] = true;
                }
            }
            for (k, selected) in selected.into_iter().enumerate() {
                let facet = Facet { x: k / 2 % side, y: k / 2 / side, upper: k % 2 == 1 };
                let slope = field.corners(facet.x, facet.y).slope(facet.upper);
                let turned = selection.light.z - selection.light.truncate().dot(slope);
                let wo = sample.reflected(wi, &SurfacePoint::on(&field, facet, 0.3, 0.3));
                if turned > 0.0 && wo.dot(axis) > half_angle.cos() {
                    assert!(selected, "case {case}: {facet:?} sends light to {wo}");
                    wanted += 1;
                }
            }
        }
        // Some facets of most cases.
        assert!(wanted > 1000, "{wanted}");
    }
}
