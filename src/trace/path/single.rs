//! One path from its start to its end: shadow test, mirror bounces, exit.

use glam::{DVec2, DVec3};

use crate::trace::ray::grid_traversal::GridTraversal;
use crate::trace::ray::surface_point::{Outcome, SurfacePoint};
use crate::trace::symmetry::PatchSymmetry;

/// A patch as it lies on the stage: the field, its slope scales and which image of it. World directions are in the
/// sample's frame (x along alpha_x).
#[derive(Debug, Clone, Copy)]
pub struct TracedPatch<'a> {
    /// Traverses the canonical field.
    pub traversal: GridTraversal<'a>,
    /// World slope per canonical slope.
    pub alpha: DVec2,
    /// Which mirror image of the field lies there.
    pub image: PatchSymmetry,
}

/// How a path ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathEnd {
    /// The surface sample is shadowed.
    Shadowed,
    /// It leaves along `wo` (sample's frame) after `order` bounces.
    Out {
        /// Unit vector, above the horizon.
        wo: DVec3,
        /// Number of bounces.
        order: u32,
    },
    /// It has more bounces than the last order.
    Truncated {
        /// It goes down: its last ray was not needed.
        down: bool,
    },
    /// A ray of it leaves an open map by its edge: what that meets beyond is not known.
    LeftDomain {
        /// Where the path arrives if nothing lies beyond the edge, sample's frame; `None` where it does not.
        wo: Option<DVec3>,
        /// Bounces on the map.
        order: u32,
        /// Whether it may go on from something beyond the edge, and arrive anywhere.
        further: bool,
    },
    /// It ends where nothing is reflected: on the plane between grains.
    Absorbed {
        /// Bounces before.
        order: u32,
    },
    /// A fault of the program.
    Lost,
}

/// What happens to a path's light at each bounce.
pub trait Bounce {
    /// A bounce with directions `wi` (where the light comes from) and `wo`, both away from the facet.
    fn bounce(&mut self, wi: DVec3, wo: DVec3);
}

/// A surface that paths are followed on, one ray at a time. World directions are in the sample's frame.
pub trait Traced {
    /// A point of it.
    type Point;

    /// A world direction in canonical field coordinates: (ax wx, ay wy, wz), seen from the field.
    fn to_field(&self, w: DVec3) -> DVec3;

    /// The slope at a point, canonical, in field coordinates.
    fn slope(&self, place: &Self::Point) -> DVec2;

    /// The mirror direction of `back` at a point; `None` where nothing is reflected.
    fn reflect(&self, back: DVec3, place: &Self::Point) -> Option<DVec3>;

    /// What a ray from a point along a world direction meets.
    fn traverse(&self, from: &Self::Point, w: DVec3) -> Outcome<Self::Point>;

    /// Follows a path from `start` under light from `wi` through at most `bounces` orders.
    ///
    /// Where the light's ray leaves an open map the path is followed as one that the light may see: it ends as
    /// [`PathEnd::LeftDomain`] with all that is known of it.
    fn trace(&self, start: Self::Point, wi: DVec3, bounces: u32, visit: &mut impl Bounce) -> PathEnd {
        let perhaps_unshadowed = match self.traverse(&start, wi) {
            Outcome::Escaped => false,
            Outcome::Hit(_) => return PathEnd::Shadowed,
            Outcome::LeftDomain => true,
            Outcome::Lost => return PathEnd::Lost,
        };
        self.trace_lit(start, wi, (bounces, perhaps_unshadowed), visit)
    }

    /// The same from a start that the light sees; `perhaps`: as far as the map reaches.
    fn trace_lit(
        &self,
        start: Self::Point,
        wi: DVec3,
        (bounces, perhaps): (u32, bool),
        visit: &mut impl Bounce,
    ) -> PathEnd {
        let cut = |down: bool| match perhaps {
            true => PathEnd::LeftDomain { wo: None, order: bounces, further: false },
            false => PathEnd::Truncated { down },
        };
        let mut place = start;
        let mut back = wi;
        for order in 1..=bounces {
            let Some(wo) = self.reflect(back, &place) else {
                return PathEnd::Absorbed { order: order - 1 };
            };
            visit.bounce(back, wo);
            // A path that goes down must hit again: at the last order there is nothing left to find out.
            if order == bounces && wo.z <= 0.0 {
                return cut(true);
            }
            match self.traverse(&place, wo) {
                Outcome::Escaped if perhaps => {
                    return PathEnd::LeftDomain { wo: Some(wo), order, further: false };
                }
                Outcome::Escaped => return PathEnd::Out { wo, order },
                Outcome::Hit(next) => place = next,
                Outcome::LeftDomain => return left_domain(wo, order, bounces),
                Outcome::Lost => return PathEnd::Lost,
            }
            back = -wo;
        }
        cut(false)
    }

    /// The first bounce with shadowing and masking switched off.
    fn trace_unobstructed(&self, start: &Self::Point, wi: DVec3, visit: &mut impl Bounce) -> PathEnd {
        let Some(wo) = self.reflect(wi, start) else { return PathEnd::Absorbed { order: 0 } };
        visit.bounce(wi, wo);
        if wo.z > 0.0 { PathEnd::Out { wo, order: 1 } } else { PathEnd::Truncated { down: true } }
    }
}

impl Traced for TracedPatch<'_> {
    type Point = SurfacePoint;

    fn to_field(&self, w: DVec3) -> DVec3 {
        TracedPatch::to_field(self, w)
    }

    fn slope(&self, place: &SurfacePoint) -> DVec2 {
        self.traversal.field().corners(place.facet.x, place.facet.y).slope(place.facet.upper)
    }

    fn reflect(&self, back: DVec3, place: &SurfacePoint) -> Option<DVec3> {
        Some(self.reflected(back, place))
    }

    fn traverse(&self, from: &SurfacePoint, w: DVec3) -> Outcome {
        self.traversal.traverse(from, self.to_field(w))
    }
}

impl TracedPatch<'_> {
    /// A world direction in canonical field coordinates: (ax wx, ay wy, wz), seen from the field.
    pub fn to_field(&self, w: DVec3) -> DVec3 {
        let xy = self.image.to_field(self.alpha * DVec2::new(w.x, w.y));
        DVec3::new(xy.x, xy.y, w.z)
    }

    /// The mirror direction of `wi` at a facet: 2 (wi.N) N/(N.N) - wi with N = (-ax p, -ay q, 1), not normalised.
    pub fn reflected(&self, wi: DVec3, place: &SurfacePoint) -> DVec3 {
        let world = self.alpha * self.image.from_field(self.slope(place));
        let normal = DVec3::new(-world.x, -world.y, 1.0);
        (2.0 * wi.dot(normal) / normal.length_squared()) * normal - wi
    }
}

/// The end of a path whose ray along `wo` leaves an open map after `order` of at most `bounces` bounces.
pub(crate) fn left_domain(wo: DVec3, order: u32, bounces: u32) -> PathEnd {
    PathEnd::LeftDomain { wo: (wo.z > 0.0).then_some(wo), order, further: order < bounces }
}
