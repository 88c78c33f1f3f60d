//! What facets do to the light of a path, and how paths end.
//!
//! Below the surface paths are followed on its other side: heights upside down, seen from a frame whose z points down.

use glam::DVec3;

use crate::optics::facet;

/// How a path ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PathEnd {
    /// The surface sample is shadowed.
    Shadowed,
    /// It leaves along `wo` (sample's frame) after `order` facets.
    Out {
        /// Unit vector; below the horizon where the path ends on the other side than the light's.
        wo: DVec3,
        /// Number of facets that it met.
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

/// Where light goes on from a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Onward {
    /// Unit vector, away from the facet, in the frame of the side that the light came from.
    pub to: DVec3,
    /// Whether it goes through the surface: then `to` points below the facet.
    pub through: bool,
}

/// Mirrors, which tell of each bounce with directions `wi` (where the light comes from) and `wo`, away from the facet.
#[derive(Debug, Clone, Copy)]
pub struct Mirrors<F>(pub F);

impl<F: FnMut(DVec3, DVec3)> Scatter for Mirrors<F> {
    fn scatter(&mut self, back: DVec3, normal: DVec3, _: bool) -> Onward {
        let to = facet::mirrored(back, normal);
        (self.0)(back, to);
        Onward { to, through: false }
    }
}

/// Both parts of the light of a path at its first facet, a clear one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SplitEnd {
    /// The share that is reflected; the rest goes through.
    pub reflectance: f64,
    /// How the reflected part ends.
    pub reflected: PathEnd,
    /// How the rest ends; in total reflection it is nothing.
    pub refracted: PathEnd,
}

impl SplitEnd {
    /// Both parts end in this way.
    pub(super) fn both(end: PathEnd) -> Self {
        SplitEnd { reflectance: 0.0, reflected: end, refracted: end }
    }
}

/// Where both parts of light go at a clear facet of index `eta`, each in the frame of its side: below the horizon of that
/// side, and in total reflection, there is no direction.
pub(super) fn split_rays(back: DVec3, normal: DVec3, eta: f64) -> (f64, [Option<DVec3>; 2]) {
    let facet::Split { reflectance, refracted } = facet::split(back, normal, eta);
    let both = [Some(facet::mirrored(back, normal)), refracted.map(|t| upside_down_if(true, t))];
    (reflectance, both.map(|w| w.filter(|w| w.z > 0.0)))
}

/// What the facets of one path do to its light.
pub trait Scatter {
    /// Light at a facet: `back` (unit vector) is where it comes from, `normal` (of any length) the facet's on that side,
    /// both in that side's frame; `below`: whether this is not the side that the path began on.
    fn scatter(&mut self, back: DVec3, normal: DVec3, below: bool) -> Onward;
}

/// A direction in the frame of the other side, where `other` says so.
pub(crate) fn upside_down_if(other: bool, w: DVec3) -> DVec3 {
    if other { DVec3::new(w.x, w.y, -w.z) } else { w }
}

/// The end of a path whose ray along `wo` (the frame of its side; `seen` in that of the light's) leaves an open map after
/// `order` of at most `bounces` facets.
pub(crate) fn left_domain(wo: DVec3, seen: DVec3, order: u32, bounces: u32) -> PathEnd {
    PathEnd::LeftDomain { wo: (wo.z > 0.0).then_some(seen), order, further: order < bounces }
}
