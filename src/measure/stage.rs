//! What lies on the stage: a specimen with everything that its stops and blocks share, and which stops are seen
//! together.

use glam::DVec2;

use super::patches::{Patch, Specimen};
use super::plan::{Plan, is_swept};
use crate::campaign::{Alpha, Campaign};
use crate::trace::{Kernel, LaneField, LaneWalker, Layout, SmithWalk, Walker};

/// A specimen, and the lanes' copy of its heights where they serve.
pub(super) struct Mounted {
    pub specimen: Specimen,
    lanes: Option<LaneField>,
}

/// The surface of one realisation and roughness.
pub(super) enum Stage<'a> {
    /// Heights to walk over.
    Heights(Heights<'a>),
    /// A law to draw from.
    Statistical(SmithWalk),
}

/// Heights, as they are walked over, by rays or by lines.
pub(super) struct Heights<'a> {
    pub patch: &'a Patch,
    pub walker: Walker<'a>,
    /// The same in lanes.
    pub lanes: Option<LaneWalker<'a>>,
    /// The same for line sweeps.
    pub layout: Option<Layout<'a>>,
    /// World slope per canonical slope.
    pub alpha: DVec2,
}

/// Stops that are measured in one pass over the surface.
pub(super) struct Group {
    pub stops: Vec<usize>,
    /// Whether starts and what the light sees of them come from a line sweep; else there is one stop, and a ray for
    /// each start.
    pub swept: bool,
}

impl Mounted {
    pub fn new(specimen: Specimen, campaign: &Campaign) -> Self {
        let lanes = match &specimen {
            Specimen::Patch(patch) if campaign.trace.visibility => LaneField::new(&patch.field),
            _ => None,
        };
        Mounted { specimen, lanes }
    }

    /// The stage for one roughness.
    pub fn stage(&self, alpha: Option<Alpha>, kernel: Kernel, campaign: &Campaign) -> Stage<'_> {
        match &self.specimen {
            Specimen::Patch(patch) => {
                let walker = Walker::new(&patch.field);
                let lanes = self.lanes.as_ref().map(|lanes| LaneWalker::new(walker, lanes, kernel));
                // Lines cross the whole of a field, start regions of a map are parts of it.
                let whole = campaign.surface.kind.is_random_heights() && campaign.trace.visibility;
                let layout = if whole { Layout::new(&patch.field) } else { None };
                Stage::Heights(Heights { patch, walker, lanes, layout, alpha: patch.alpha(alpha) })
            }
            Specimen::Statistical { law, independent_heights } => Stage::Statistical(SmithWalk {
                law: *law,
                alpha: alpha.map_or(DVec2::ONE, |alpha| DVec2::new(alpha.x, alpha.y)),
                independent_heights: *independent_heights,
            }),
        }
    }
}

impl Stage<'_> {
    /// The `open` stops in groups: those that a sweep sees together by their azimuth, the others each alone.
    pub fn groups(&self, open: &[usize], campaign: &Campaign, plan: &Plan) -> Vec<Group> {
        let swept = |stop: usize| match self {
            Stage::Heights(heights) if heights.layout.is_some() => {
                is_swept(campaign, plan, stop, heights.walker.range(), heights.alpha)
            }
            _ => false,
        };
        let azimuths = plan.grid.phi_i_deg.len();
        let mut groups: Vec<Group> = (0..azimuths)
            .map(|azimuth| {
                let stops = open.iter().copied().filter(|&stop| stop % azimuths == azimuth && swept(stop));
                Group { stops: stops.collect(), swept: true }
            })
            .filter(|group| !group.stops.is_empty())
            .collect();
        let alone = open.iter().copied().filter(|&stop| !swept(stop));
        groups.extend(alone.map(|stop| Group { stops: vec![stop], swept: false }));
        groups
    }
}
