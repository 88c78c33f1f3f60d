//! From the campaign's materials to reflectances and to what facets do, and what a path carries besides its geometry.

use glam::DVec3;
use smallvec::SmallVec;

use crate::campaign::{FresnelLaw, LightSide, Medium, Optics, Polarisation, RefractiveIndex};
use crate::optics::facet;
use crate::optics::fresnel::Fresnel;
use crate::optics::layered;
use crate::optics::reflectance::{Field, Reflectance};
use crate::optics::{FacetAngle, FacetKind};
use crate::rng::PathDraws;
use crate::trace::{Onward, Scatter, upside_down_if};

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
        // What of the light that goes in leaves again; what is mirrored weighs 1 in every colour.
        Optics::Layered { albedo, eta } => {
            let base = albedo.map(|albedo| layered::base_reflectance(albedo, *eta));
            base.map(|albedo| Reflectance::unpolarised(Fresnel::Diffuse { albedo })).to_vec()
        }
        Optics::Several(all) => all.iter().flat_map(reflectances_of).collect(),
    }
}

fn of_medium(medium: Medium, index: &RefractiveIndex) -> Reflectance {
    let field = match index.polarisation {
        Polarisation::None | Polarisation::Mueller => Field::Both,
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
            Optics::Layered { eta, .. } => return vec![FacetWay::alike(FacetKind::Layered { eta: *eta })],
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
    kept: Kept,
    angles: SmallVec<[FacetAngle; 2]>,
    facets: Vec<FacetMet>,
}

/// What a path keeps of its facets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Kept {
    /// The angles at mirrors.
    pub angles: bool,
    /// Everything, for Mueller matrices.
    pub facets: bool,
}

/// A facet that a path met, in the frame that it began in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacetMet {
    /// Unit vector back to where the light came from.
    pub back: DVec3,
    /// Unit vector along which it went on.
    pub to: DVec3,
    /// Its normal, a unit vector of either sign.
    pub normal: DVec3,
    /// Whether the light came from the other side than that which the path began on.
    pub below: bool,
    /// Whether it went through.
    pub through: bool,
}

impl PathLight {
    /// The light at a surface sample.
    pub fn new(way: FacetWay, draws: PathDraws, kept: Kept) -> Self {
        PathLight { way, draws, kept, angles: SmallVec::new(), facets: Vec::new() }
    }

    /// Begins anew at a surface sample, with the memory that it has.
    pub fn begin(&mut self, way: FacetWay, draws: PathDraws, kept: Kept) {
        (self.way, self.draws, self.kept) = (way, draws, kept);
        self.angles.clear();
        self.facets.clear();
    }

    /// The facets that it met, where they are kept; at order 1 without chance none is.
    pub fn facets(&self) -> &[FacetMet] {
        &self.facets
    }

    /// How it is followed.
    pub fn way(&self) -> FacetWay {
        self.way
    }

    /// The angles at the facets of its bounces; of layered facets at those where it met the base, which may be none.
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
        let onward = self.onward(back, normal, below);
        if self.kept.facets {
            let [back, to, normal] = [back, onward.to, normal.normalize()].map(|w| upside_down_if(below, w));
            self.facets.push(FacetMet { back, to, normal, below, through: onward.through });
        }
        onward
    }
}

/// A matt facet, or a base, reflects the same at every angle: any will do.
const ANY_ANGLE: FacetAngle = FacetAngle { cos: 1.0, sin2: 0.0 };

impl PathLight {
    fn onward(&mut self, back: DVec3, normal: DVec3, below: bool) -> Onward {
        match self.way.kind {
            FacetKind::Mirror => {
                let to = facet::mirrored(back, normal);
                if self.kept.angles {
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
                self.angles.push(ANY_ANGLE);
                let (u, v) = (self.draws.uniform(), self.draws.uniform());
                Onward { to: facet::lambert_direction(normal, u, v), through: false }
            }
            FacetKind::Layered { eta } => {
                if self.draws.uniform() < facet::split(back, normal, eta).reflectance {
                    return Onward { to: facet::mirrored(back, normal), through: false };
                }
                self.angles.push(ANY_ANGLE);
                let to = layered::leaving_direction(normal, eta, || self.draws.uniform());
                Onward { to, through: false }
            }
        }
    }
}
