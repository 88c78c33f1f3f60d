//! One path from its start to its end: shadow test, facet after facet, exit.

use glam::{DVec2, DVec3};

use super::scatter::{Onward, PathEnd, Scatter, SplitEnd, left_domain, split_rays, upside_down_if};
use crate::optics::facet;
use crate::trace::ray::grid_traversal::GridTraversal;
use crate::trace::ray::surface_point::{Outcome, SurfacePoint};
use crate::trace::symmetry::PatchSymmetry;

/// A patch as it lies on the stage: the field, its slope scales and which image of it. World directions are in the
/// sample's frame (x along alpha_x).
#[derive(Debug, Clone, Copy)]
pub struct TracedPatch<'a> {
    /// Traverses the canonical field.
    pub traversal: GridTraversal<'a>,
    /// Traverses it upside down; that of the field itself where no path goes there.
    pub below: GridTraversal<'a>,
    /// World slope per canonical slope.
    pub alpha: DVec2,
    /// Which mirror image of the field lies there.
    pub image: PatchSymmetry,
}

/// A surface that paths are followed on, one ray at a time. World directions are in the sample's frame.
pub trait Traced {
    /// A point of it.
    type Point: Copy;

    /// A world direction in canonical field coordinates: (ax wx, ay wy, wz), seen from the field.
    fn to_field(&self, w: DVec3) -> DVec3;

    /// The slope at a point, canonical, in field coordinates.
    fn slope(&self, place: &Self::Point) -> DVec2;

    /// A normal at a point of any length, on the point's side; `None` where light ends.
    fn normal(&self, place: &Self::Point, below: bool) -> Option<DVec3>;

    /// The same point, seen from the other side of the surface.
    fn other_side(&self, place: &Self::Point) -> Self::Point;

    /// What a ray from a point along a direction meets; point, direction and answer are those of one side.
    fn traverse(&self, from: &Self::Point, w: DVec3, below: bool) -> Outcome<Self::Point>;

    /// The mirror direction of `back` at a point of the upper side; `None` where nothing is reflected.
    fn reflect(&self, back: DVec3, place: &Self::Point) -> Option<DVec3> {
        self.normal(place, false).map(|normal| facet::mirrored(back, normal))
    }

    /// Follows a path from `start` under light from `wi` through at most `bounces` orders.
    ///
    /// Where the light's ray leaves an open map the path is followed as one that the light may see: it ends as
    /// [`PathEnd::LeftDomain`] with all that is known of it.
    fn trace(&self, start: Self::Point, wi: DVec3, bounces: u32, facets: &mut impl Scatter) -> PathEnd {
        match self.is_perhaps_lit(&start, wi) {
            Ok(perhaps) => self.trace_lit(start, wi, (bounces, perhaps), facets),
            Err(end) => end,
        }
    }

    /// Whether the light sees a start as far as the map reaches, not for certain; `Err`: how paths from it end at once.
    fn is_perhaps_lit(&self, start: &Self::Point, wi: DVec3) -> Result<bool, PathEnd> {
        match self.traverse(start, wi, false) {
            Outcome::Escaped => Ok(false),
            Outcome::LeftDomain => Ok(true),
            Outcome::Hit(_) => Err(PathEnd::Shadowed),
            Outcome::Lost => Err(PathEnd::Lost),
        }
    }

    /// The same from a start that the light sees; `perhaps`: as far as the map reaches.
    fn trace_lit(
        &self,
        start: Self::Point,
        wi: DVec3,
        (bounces, perhaps): (u32, bool),
        facets: &mut impl Scatter,
    ) -> PathEnd {
        let cut = |down: bool| match perhaps {
            true => PathEnd::LeftDomain { wo: None, order: bounces, further: false },
            false => PathEnd::Truncated { down },
        };
        let (mut place, mut back, mut below) = (start, wi, false);
        for order in 1..=bounces {
            let Some(normal) = self.normal(&place, below) else {
                return PathEnd::Absorbed { order: order - 1 };
            };
            let Onward { to, through } = facets.scatter(back, normal, below);
            if through {
                (place, below) = (self.other_side(&place), !below);
            }
            let wo = upside_down_if(through, to);
            // A path that goes down must hit again: at the last order there is nothing left to find out.
            if order == bounces && wo.z <= 0.0 {
                return cut(true);
            }
            let seen = upside_down_if(below, wo);
            match self.traverse(&place, wo, below) {
                Outcome::Escaped if perhaps => {
                    return PathEnd::LeftDomain { wo: Some(seen), order, further: false };
                }
                Outcome::Escaped => return PathEnd::Out { wo: seen, order },
                Outcome::Hit(next) => place = next,
                Outcome::LeftDomain => return left_domain(wo, seen, order, bounces),
                Outcome::Lost => return PathEnd::Lost,
            }
            back = -wo;
        }
        cut(false)
    }

    /// Both parts of the light of a start at its own facet, a clear one: order 1 without chance.
    fn trace_split(&self, start: &Self::Point, wi: DVec3, eta: f64) -> SplitEnd {
        match self.is_perhaps_lit(start, wi) {
            Ok(perhaps) => self.split_lit(start, wi, eta, perhaps),
            Err(end) => SplitEnd::both(end),
        }
    }

    /// The same of a start that the light sees; `perhaps`: as far as the map reaches.
    fn split_lit(&self, start: &Self::Point, wi: DVec3, eta: f64, perhaps: bool) -> SplitEnd {
        let Some(normal) = self.normal(start, false) else {
            return SplitEnd::both(PathEnd::Absorbed { order: 0 });
        };
        let (reflectance, rays) = split_rays(wi, normal, eta);
        let end = |w: Option<DVec3>, below: bool| {
            let left = |wo| PathEnd::LeftDomain { wo, order: 1, further: false };
            let Some(w) = w else {
                return if perhaps { left(None) } else { PathEnd::Truncated { down: true } };
            };
            let place = if below { &self.other_side(start) } else { start };
            let seen = upside_down_if(below, w);
            match self.traverse(place, w, below) {
                Outcome::Escaped if !perhaps => PathEnd::Out { wo: seen, order: 1 },
                Outcome::Escaped | Outcome::LeftDomain => left(Some(seen)),
                Outcome::Hit(_) if perhaps => left(None),
                Outcome::Hit(_) => PathEnd::Truncated { down: false },
                Outcome::Lost => PathEnd::Lost,
            }
        };
        let [up, down] = rays;
        SplitEnd { reflectance, reflected: end(up, false), refracted: end(down, true) }
    }

    /// The same with shadowing and masking switched off.
    fn split_unobstructed(&self, start: &Self::Point, wi: DVec3, eta: f64) -> SplitEnd {
        let Some(normal) = self.normal(start, false) else {
            return SplitEnd::both(PathEnd::Absorbed { order: 0 });
        };
        let (reflectance, [up, down]) = split_rays(wi, normal, eta);
        let end = |w: Option<DVec3>| {
            w.map_or(PathEnd::Truncated { down: true }, |wo| PathEnd::Out { wo, order: 1 })
        };
        let refracted = end(down.map(|w| upside_down_if(true, w)));
        SplitEnd { reflectance, reflected: end(up), refracted }
    }

    /// The first facet with shadowing and masking switched off.
    fn trace_unobstructed(&self, start: &Self::Point, wi: DVec3, facets: &mut impl Scatter) -> PathEnd {
        let Some(normal) = self.normal(start, false) else { return PathEnd::Absorbed { order: 0 } };
        let Onward { to, through } = facets.scatter(wi, normal, false);
        let leaves = if through { to.z < 0.0 } else { to.z > 0.0 };
        if leaves { PathEnd::Out { wo: to, order: 1 } } else { PathEnd::Truncated { down: true } }
    }
}

impl Traced for TracedPatch<'_> {
    type Point = SurfacePoint;

    fn to_field(&self, w: DVec3) -> DVec3 {
        TracedPatch::to_field(self, w)
    }

    fn slope(&self, place: &SurfacePoint) -> DVec2 {
        place.slope
    }

    fn normal(&self, place: &SurfacePoint, _: bool) -> Option<DVec3> {
        Some(self.facet_normal(place))
    }

    fn other_side(&self, place: &SurfacePoint) -> SurfacePoint {
        place.upside_down()
    }

    fn traverse(&self, from: &SurfacePoint, w: DVec3, below: bool) -> Outcome {
        let traversal = if below { &self.below } else { &self.traversal };
        traversal.traverse(from, self.to_field(w))
    }
}

impl<'a> TracedPatch<'a> {
    /// A patch that no light goes through.
    pub fn opaque(traversal: GridTraversal<'a>, alpha: DVec2, image: PatchSymmetry) -> Self {
        TracedPatch { traversal, below: traversal, alpha, image }
    }

    /// A world direction in canonical field coordinates: (ax wx, ay wy, wz), seen from the field.
    pub fn to_field(&self, w: DVec3) -> DVec3 {
        let xy = self.image.to_field(self.alpha * DVec2::new(w.x, w.y));
        DVec3::new(xy.x, xy.y, w.z)
    }

    /// N = (-ax p, -ay q, 1) in the frame of the point's side, not normalised.
    pub fn facet_normal(&self, place: &SurfacePoint) -> DVec3 {
        (-self.alpha * self.image.from_field(place.slope)).extend(1.0)
    }

    /// The mirror direction of `wi` at a facet.
    pub fn reflected(&self, wi: DVec3, place: &SurfacePoint) -> DVec3 {
        facet::mirrored(wi, self.facet_normal(place))
    }
}
