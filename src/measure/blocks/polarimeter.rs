//! Mueller matrices of paths: the frames of both arms, and what each path adds to the bins that it arrives in.
//!
//! The light's frame has its s across the plane of the lamp's arm and the normal. The sensor's has it along the azimuth's
//! circle: of an aperture, at its middle; of a bin, where the path arrives, but of a cap all about the normal as the
//! light has it, since every azimuth meets there.

use glam::DVec3;
use smallvec::SmallVec;

use super::arms::BlockArms;
use crate::campaign::LightSide;
use crate::instrument::{Grid, GridKind};
use crate::measure::accumulate::fresnel_sums::path_weights::PathWeights;
use crate::measure::accumulate::fresnel_sums::{ELEMENTS, FresnelSums};
use crate::measure::accumulate::tally::to_signed_units;
use crate::measure::optics::{FacetMet, PathLight};
use crate::measure::plan::Plan;
use crate::optics::FacetKind;
use crate::optics::fresnel::{FacetAngle, Fresnel};
use crate::optics::mueller::{Frame, MuellerPath, PolarisedFacet, mirror_sign};
use crate::sphere;

/// What lies across the sensor's frame of a bin.
#[derive(Debug, Clone, Copy)]
enum Across {
    /// The circle of the azimuth where the path arrives.
    Arrival,
    /// The plane of the light.
    Light,
    /// A direction in the bins' frame.
    Aperture(DVec3),
}

/// What turns the paths of a campaign into Mueller matrices.
pub(in crate::measure) struct Polarimeter<'a> {
    sums: &'a FresnelSums,
    across: Vec<Across>,
}

/// A path that leaves, with its matrix in each colour.
pub(super) struct PolarisedLight<'a> {
    across: &'a [Across],
    arms: &'a BlockArms,
    wo: DVec3,
    /// Light from the back is seen in a mirror: its frame's z points down.
    back: bool,
    /// Colour, share of the path's flux, matrix over its first element at each facet.
    colours: SmallVec<[(usize, f64, MuellerPath); 1]>,
}

impl<'a> Polarimeter<'a> {
    /// Of a campaign's colours and bins.
    pub fn new(plan: &'a Plan) -> Self {
        Polarimeter { sums: &plan.sums, across: across_of(&plan.grid) }
    }

    /// A path that leaves along `wo`, in the sample's frame; `weights` are its weights by colour.
    pub(super) fn light_of<'b>(
        &'b self,
        light: &PathLight,
        arms: &'b BlockArms,
        wo: DVec3,
        weights: &PathWeights,
    ) -> PolarisedLight<'b> {
        let way = light.way();
        let begin = MuellerPath::new(Frame::near(across_the_light(arms), -arms.wi));
        let single;
        let (facets, colours) = match way.kind {
            FacetKind::Dielectric { eta } => {
                single = [single_facet(arms.wi, wo, eta)];
                let met = if light.facets().is_empty() { &single } else { light.facets() };
                (met, std::iter::once((way.place, Fresnel::Dielectric { eta })).collect())
            }
            FacetKind::Mirror | FacetKind::Diffuse | FacetKind::Layered { .. } => {
                let fresnels = self.sums.reflectances().iter().map(|one| one.fresnel);
                (light.facets(), fresnels.enumerate().collect::<SmallVec<[_; 3]>>())
            }
        };
        let of_colour = |((place, fresnel), weight): ((usize, Fresnel), &f64)| {
            (place, *weight, matrix(begin, facets, &fresnel))
        };
        let colours = colours.into_iter().zip(&weights.order).map(of_colour).collect();
        let back = way.light == LightSide::Back;
        PolarisedLight { across: &self.across, arms, wo, back, colours }
    }
}

impl PolarisedLight<'_> {
    /// Adds the matrix of a path of this flux to a bin that it, or its mirror image, arrives in.
    pub fn add(&self, bin: usize, mirrored: bool, flux: f64, sums: &mut [Vec<i128>]) {
        let around = DVec3::new(-self.wo.y, self.wo.x, 0.0);
        let across = match self.across[bin] {
            Across::Arrival if around.length_squared() > 0.0 => around,
            Across::Arrival | Across::Light => across_the_light(self.arms),
            // A mirrored arrival has the mirrored aperture's frame.
            Across::Aperture(w) if mirrored => self.arms.from_bins(self.arms.mirrored(w)),
            Across::Aperture(w) => self.arms.from_bins(w),
        };
        for (place, share, path) in &self.colours {
            let planes = sums[place * ELEMENTS..].iter_mut();
            for (element, (value, plane)) in path.seen(across).into_iter().zip(planes).enumerate() {
                let sign = if mirrored == self.back { 1.0 } else { mirror_sign(element) };
                plane[bin] += to_signed_units(flux * share * sign * value);
            }
        }
    }
}

fn across_the_light(arms: &BlockArms) -> DVec3 {
    DVec3::new(-arms.header.y, arms.header.x, 0.0)
}

fn across_of(grid: &Grid) -> Vec<Across> {
    let of_azimuth = |phi_deg: f64| {
        let (sin, cos) = sphere::sin_cos_deg(phi_deg);
        Across::Aperture(DVec3::new(-sin, cos, 0.0))
    };
    let of_patch = |[t1, t2, p1, p2]: [f64; 4]| {
        let pole = t1 == 0.0 || t2 == 180.0;
        if pole && p2 - p1 >= 360.0 { Across::Light } else { Across::Arrival }
    };
    match grid.kind {
        GridKind::Arm => {
            let each = grid.theta_r_deg.iter().flat_map(|_| grid.phi_r_deg.iter().copied());
            each.map(of_azimuth).collect()
        }
        GridKind::Points => grid.points_deg.iter().map(|point| of_azimuth(point[1])).collect(),
        GridKind::Patches => grid.patches_deg.iter().copied().map(of_patch).collect(),
        GridKind::Hemisphere => {
            let columns = |t: &[f64]| {
                grid.phi_r_edges_deg.windows(2).map(|p| of_patch([t[0], t[1], p[0], p[1]])).collect()
            };
            grid.theta_r_edges_deg.windows(2).flat_map(|t: &[f64]| -> Vec<Across> { columns(t) }).collect()
        }
        GridKind::HalfDifference => vec![],
    }
}

/// The only facet of a path from `wi` to `wo` at clear facets.
fn single_facet(wi: DVec3, wo: DVec3, eta: f64) -> FacetMet {
    let through = wo.z < 0.0;
    let half = if through { wi + eta * wo } else { wi + wo };
    FacetMet { back: wi, to: wo, normal: half.normalize(), below: false, through }
}

/// The matrix of a path over its facets.
fn matrix(begin: MuellerPath, facets: &[FacetMet], fresnel: &Fresnel) -> MuellerPath {
    facets.iter().fold(begin, |mut path, met| {
        path.meet(met.normal, met.to, polarised(met, fresnel));
        path
    })
}

fn polarised(met: &FacetMet, fresnel: &Fresnel) -> PolarisedFacet {
    let fresnel = match *fresnel {
        Fresnel::Dielectric { eta } if met.below => Fresnel::Dielectric { eta: 1.0 / eta },
        other => other,
    };
    match fresnel {
        Fresnel::Dielectric { eta } if met.through => {
            let cos = met.back.dot(met.normal).abs().min(1.0);
            let angle = FacetAngle { cos, sin2: (1.0 - cos) * (1.0 + cos) };
            PolarisedFacet::transmission(angle, eta)
        }
        other => PolarisedFacet::reflection(&other, FacetAngle::of_pair(met.back, met.to)),
    }
}
