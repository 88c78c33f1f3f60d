//! Where the arms stand for one block: the light's direction in the sample's frame, the patch's image, and how a
//! sample direction is turned into the frame of the bins.

use glam::DVec3;

use crate::campaign::Campaign;
use crate::instrument::direction_in_cone;
use crate::measure::plan::Plan;
use crate::rng;
use crate::rng::{PLASTIC, Purpose, StreamId};
use crate::sphere;
use crate::trace::PatchSymmetry;

/// Step of the additive sequence that spreads the blocks of a realisation over the azimuth: the golden ratio. (Over the
/// light's cone: the plastic number's.) One hashed offset each keeps them unbiased.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The arms of one block.
#[derive(Debug, Clone, Copy)]
pub struct BlockArms {
    /// To the light, sample's frame.
    pub wi: DVec3,
    /// Horizontally towards it: incidences of one azimuth have the same, whatever their polar angle.
    pub header: DVec3,
    /// Which mirror image of the patch lies in the instrument.
    pub image: PatchSymmetry,
    /// (sin, cos) of the turn from the sample's frame to the frame that the bins' azimuth counts in.
    pub to_bins: (f64, f64),
    /// (sin, cos) of twice the light's azimuth in the bins' frame: mirrors an arrival about the plane of incidence.
    pub mirror: (f64, f64),
    /// For the draws at the facets of the block's paths.
    pub facets_key: u64,
}

impl BlockArms {
    /// The arms of a block; a function of its address alone.
    pub fn new(campaign: &Campaign, plan: &Plan, incidence: usize, realisation: u64, block: u64) -> Self {
        let id =
            StreamId { seed: campaign.seed, purpose: Purpose::Arms, realisation, incidence: 0, block: 0 };
        let mut draws = rng::stream(id);
        let mut spread = |step: f64| (rng::uniform(&mut draws) + block as f64 * step).fract();
        let turn = spread(GOLDEN);
        let (u, v) = (spread(PLASTIC[0]), spread(PLASTIC[1]));
        let image = PatchSymmetry::nth(((spread(0.0) * plan.images as f64) as u64 + block) % plan.images);
        let (theta_i, phi_i) = plan.grid.incidence_deg(incidence);
        let phi_sample = if plan.averages_azimuth {
            360.0 * turn
        } else {
            sphere::reduced_deg(phi_i - campaign.surface.rotation_deg)
        };
        let axis = sphere::direction_deg(theta_i, phi_sample);
        let wi = direction_in_cone(axis, campaign.light.aperture_deg.to_radians(), u, v);
        let light_relative = plan.grid.phi_r_relative;
        let turn_to_bins = if light_relative { -phi_sample } else { campaign.surface.rotation_deg };
        let phi_in_bins = if light_relative { 0.0 } else { phi_i };
        BlockArms {
            wi,
            header: sphere::direction_deg(90.0, phi_sample),
            image,
            to_bins: sphere::sin_cos_deg(turn_to_bins),
            mirror: sphere::sin_cos_deg(2.0 * phi_in_bins),
            facets_key: rng::key(StreamId {
                purpose: Purpose::Facets,
                ..starts_stream(campaign, plan, incidence, realisation, block)
            }),
        }
    }

    /// A sample direction in the bins' frame.
    pub fn in_bins(&self, wo: DVec3) -> DVec3 {
        sphere::turned(wo, self.to_bins)
    }

    /// A direction of the bins' frame in the sample's.
    pub fn from_bins(&self, w: DVec3) -> DVec3 {
        let (sin, cos) = self.to_bins;
        sphere::turned(w, (-sin, cos))
    }

    /// A direction of the bins' frame mirrored about the plane of incidence: azimuth phi -> 2 phi_i - phi.
    pub fn mirrored(&self, wo: DVec3) -> DVec3 {
        sphere::turned(DVec3::new(wo.x, -wo.y, wo.z), self.mirror)
    }
}

/// The stream of a block's start points. The incidence enters by its angles in the sample's frame: a turned sample under
/// turned arms draws the same numbers, and a further incidence leaves the others as they were.
pub fn starts_stream(
    campaign: &Campaign,
    plan: &Plan,
    incidence: usize,
    realisation: u64,
    block: u64,
) -> StreamId {
    let (theta_i, phi_i) = plan.drawn_at.unwrap_or_else(|| plan.grid.incidence_deg(incidence));
    let phi =
        if plan.averages_azimuth { 0.0 } else { sphere::reduced_deg(phi_i - campaign.surface.rotation_deg) };
    StreamId {
        seed: campaign.seed,
        purpose: Purpose::Starts,
        realisation,
        incidence: rng::incidence_key(theta_i, phi),
        block,
    }
}
