//! From the campaign's materials to reflectances, and what a path carries besides its geometry: the angles at its
//! facets.

use glam::DVec3;
use smallvec::SmallVec;

use crate::campaign::{FresnelLaw, Medium, Optics, Polarisation, RefractiveIndex};
use crate::optics::FacetAngle;
use crate::optics::fresnel::Fresnel;
use crate::optics::reflectance::{Field, Reflectance};
use crate::trace::Bounce;

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

/// The light of one path: what it is weighed by once it has left.
#[derive(Debug, Clone)]
pub struct BounceRecorder {
    weighed: bool,
    angles: SmallVec<[FacetAngle; 2]>,
}

impl BounceRecorder {
    /// The light at a surface sample; angles are kept where `weighed`.
    pub fn new(weighed: bool) -> Self {
        BounceRecorder { weighed, angles: SmallVec::new() }
    }

    /// The angles at the facets of its bounces.
    pub fn angles(&self) -> &[FacetAngle] {
        &self.angles
    }
}

impl Bounce for BounceRecorder {
    fn bounce(&mut self, wi: DVec3, wo: DVec3) {
        if self.weighed {
            self.angles.push(FacetAngle::of_pair(wi, wo));
        }
    }
}
