//! From the campaign's materials to reflectances and to what facets do, and what a path carries besides its geometry.

use glam::DVec3;
use smallvec::SmallVec;

use crate::campaign::{FresnelLaw, LightSide, Medium, Optics, Polarisation, RefractiveIndex};
use crate::optics::facet;
use crate::optics::fresnel::Fresnel;
use crate::optics::reflectance::{Field, Reflectance};
use crate::optics::{FacetAngle, FacetKind};
use crate::rng::PathDraws;
use crate::trace::{Onward, Scatter};

/// The reflectance of a facet in each colour of a material's table.
pub fn reflectances_of(optics: &Optics) -> Vec<Reflectance> {
    match optics {
        Optics::PerfectMirror => vec![Reflectance::unpolarised(Fresnel::Perfect)],
        Optics::Schlick { f0, .. } => {
            f0.iter().map(|&f0| Reflectance::unpolarised(Fresnel::Schlick { f0 })).collect()
        }
        Optics::Index(index) => {
            index.by_colour().into_iter().map(|medium| of_medium(medium, index)).collect()
        }
        Optics::Dielectric(clear) => {
            let media = clear.by_colour().into_iter();
            media
                .map(|medium| {
                    Reflectance::unpolarised(Fresnel::Dielectric { eta: seen(medium.eta, clear.light) })
                })
                .collect()
        }
        Optics::Diffuse { albedo } => {
            albedo.iter().map(|&albedo| Reflectance::unpolarised(Fresnel::Diffuse { albedo })).collect()
        }
        Optics::Several(all) => all.iter().flat_map(reflectances_of).collect(),
    }
}

fn of_medium(medium: Medium, index: &RefractiveIndex) -> Reflectance {
    let field = match index.polarisation {
        Polarisation::None => Field::Both,
        Polarisation::S => Field::Across,
        Polarisation::P => Field::Along,
    };
    let exact = fresnel_of(medium);
    let fresnel = if index.law == FresnelLaw::Exact { exact } else { Fresnel::Schlick { f0: exact.f0() } };
    Reflectance { fresnel, field }
}

/// Fresnel's equations for a medium.
pub fn fresnel_of(medium: Medium) -> Fresnel {
    let Medium { eta, k, .. } = medium;
    if k == 0.0 { Fresnel::Dielectric { eta } } else { Fresnel::Conductor { eta, k } }
}

/// The index of the far side over the near one, for light from `side`.
fn seen(eta: f64, side: LightSide) -> f64 {
    if side == LightSide::Front { eta } else { 1.0 / eta }
}

/// One way in which paths are followed from the surface samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacetWay {
    /// What facets do.
    pub kind: FacetKind,
    /// The side that the light comes from.
    pub light: LightSide,
    /// Its place among the colours of all materials; 0 where one way serves them all.
    pub place: usize,
}

/// The ways that the colours of a campaign need: clear facets send each colour elsewhere, others all alike.
pub fn ways_of(optics: &Optics) -> Vec<FacetWay> {
    let mut ways = Vec::new();
    for one in optics.each() {
        match one {
            Optics::Dielectric(clear) => {
                for medium in clear.by_colour() {
                    let kind = FacetKind::Dielectric { eta: seen(medium.eta, clear.light) };
                    ways.push(FacetWay { kind, light: clear.light, place: ways.len() });
                }
            }
            Optics::Diffuse { .. } => return vec![FacetWay::alike(FacetKind::Diffuse)],
            _ => return vec![FacetWay::alike(FacetKind::Mirror)],
        }
    }
    ways
}

impl FacetWay {
    fn alike(kind: FacetKind) -> Self {
        FacetWay { kind, light: LightSide::Front, place: 0 }
    }
}

/// The light of one path: what its facets do, and what it is weighed by once it has left.
#[derive(Debug, Clone)]
pub struct PathLight {
    way: FacetWay,
    draws: PathDraws,
    weighed: bool,
    angles: SmallVec<[FacetAngle; 2]>,
}

impl PathLight {
    /// The light at a surface sample; angles are kept where `weighed`.
    pub fn new(way: FacetWay, draws: PathDraws, weighed: bool) -> Self {
        PathLight { way, draws, weighed, angles: SmallVec::new() }
    }

    /// The angles at the facets of its bounces.
    pub fn angles(&self) -> &[FacetAngle] {
        &self.angles
    }

    /// The colour that it is of, as [`FacetWay`] has it.
    pub fn place(&self) -> usize {
        self.way.place
    }
}

impl Scatter for PathLight {
    fn scatter(&mut self, back: DVec3, normal: DVec3, below: bool) -> Onward {
        match self.way.kind {
            FacetKind::Mirror => {
                let to = facet::mirrored(back, normal);
                if self.weighed {
                    self.angles.push(FacetAngle::of_pair(back, to));
                }
                Onward { to, through: false }
            }
            FacetKind::Dielectric { eta } => {
                let split = facet::split(back, normal, if below { 1.0 / eta } else { eta });
                match split.refracted {
                    Some(to) if self.draws.uniform() >= split.reflectance => Onward { to, through: true },
                    _ => Onward { to: facet::mirrored(back, normal), through: false },
                }
            }
            FacetKind::Diffuse => {
                // A matt facet reflects the same at every angle: any will do.
                self.angles.push(FacetAngle { cos: 1.0, sin2: 0.0 });
                let (u, v) = (self.draws.uniform(), self.draws.uniform());
                Onward { to: facet::lambert_direction(normal, u, v), through: false }
            }
        }
    }
}
