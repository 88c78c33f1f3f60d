//! What lies on the stage: a specimen with everything that its stops and blocks share, and which stops are seen
//! together.

use glam::DVec2;

use super::arms::BlockArms;
use super::patches::{Patch, Specimen};
use super::plan::{Plan, is_swept};
use crate::campaign::{Alpha, Campaign};
use crate::trace::{
    FacetIndex, Kernel, LaneField, LaneWalker, Layout, Peaks, Sample, SmithWalk, Together, Walker,
};

/// Cells of a patch for each start that is followed together with others.
pub const CELLS_PER_START: u64 = 4;
/// Pieces of work that a thread gets at least.
const WORK_PER_THREAD: usize = 4;

/// A specimen, and the lanes' copy of its heights where they serve.
pub(super) struct Mounted {
    pub specimen: Specimen,
    lanes: Option<LaneField>,
    /// For the f64 walk, where there are no lanes.
    peaks: Option<Peaks>,
    index: Option<FacetIndex>,
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
    /// Its facets by slope, where few of them are wanted.
    pub index: Option<&'a FacetIndex>,
    /// World slope per canonical slope.
    pub alpha: DVec2,
}

/// Stops that are measured in one pass over the surface.
pub(super) struct Group {
    pub stops: Vec<usize>,
    pub way: Way,
}

/// How the starts of a group are found, and what the light sees of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// Both by a line sweep.
    Sweep,
    /// All along the facets of one stop, a ray towards the light for each.
    Rays,
    /// On the wanted facets of one stop alone, each with this share of the incident flux of a block.
    Index(f64),
    /// All along the facets of one stop in the order of their slopes, a ray towards the light for each.
    BySlope,
    /// Where rays from above come down, of one stop.
    Above,
}

impl Mounted {
    pub fn new(specimen: Specimen, campaign: &Campaign, plan: &Plan) -> Self {
        let index = match &specimen {
            Specimen::Patch(patch) if plan.indexed || plan.by_slope => FacetIndex::new(&patch.field),
            _ => None,
        };
        let lanes = match &specimen {
            Specimen::Patch(patch) if campaign.trace.visibility => LaneField::new(&patch.field),
            _ => None,
        };
        let peaks = match &specimen {
            Specimen::Patch(patch) if campaign.trace.visibility && lanes.is_none() => {
                Some(Peaks::new(&patch.field))
            }
            _ => None,
        };
        Mounted { specimen, lanes, peaks, index }
    }

    /// The stage for one roughness.
    pub fn stage(&self, alpha: Option<Alpha>, kernel: Kernel, campaign: &Campaign) -> Stage<'_> {
        match &self.specimen {
            Specimen::Patch(patch) => {
                let walker = Walker::new(&patch.field);
                let walker = self.peaks.as_ref().map_or(walker, |peaks| walker.with_peaks(peaks));
                let lanes = self.lanes.as_ref().map(|lanes| LaneWalker::new(walker, lanes, kernel));
                let index = self.index.as_ref();
                // Lines cross the whole of a field, start regions of a map are parts of it; and what they see goes
                // on through the lanes, which serve sides of a power of two.
                let random = campaign.surface.kind.is_random_heights();
                let swept = random && lanes.is_some() && index.is_none();
                let layout = if swept { Layout::new(&patch.field) } else { None };
                let alpha = patch.alpha(alpha);
                Stage::Heights(Heights { patch, walker, lanes, layout, index, alpha })
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
    pub fn groups(&self, open: &[usize], campaign: &Campaign, plan: &Plan, realisation: u64) -> Vec<Group> {
        let alone = |stop: usize, way| Group { stops: vec![stop], way };
        if plan.from_above {
            return open.iter().map(|&stop| alone(stop, Way::Above)).collect();
        }
        if let Stage::Heights(heights) = self
            && let Some(index) = heights.index
        {
            if plan.by_slope {
                return open.iter().map(|&stop| alone(stop, Way::BySlope)).collect();
            }
            let of = |&stop: &usize| {
                let arms = BlockArms::new(campaign, plan, stop, realisation, 0);
                alone(stop, Way::Index(heights.start_share(index, &arms, plan)))
            };
            return open.iter().map(of).collect();
        }
        let swept = |stop: usize| match self {
            Stage::Heights(heights) if heights.layout.is_some() => {
                is_swept(campaign, plan, stop, heights.walker.range(), heights.alpha)
            }
            _ => false,
        };
        // Stops of one azimuth in one pass; stops that are a list have no axis of azimuths to go by.
        let azimuth = |stop: usize| plan.grid.stop_deg(stop).1.to_bits();
        let mut groups: Vec<Group> = Vec::new();
        for &stop in open.iter().filter(|&&stop| swept(stop)) {
            match groups.iter_mut().find(|group| azimuth(group.stops[0]) == azimuth(stop)) {
                Some(group) => group.stops.push(stop),
                None => groups.push(Group { stops: vec![stop], way: Way::Sweep }),
            }
        }
        let others = open.iter().copied().filter(|&stop| !swept(stop));
        groups.extend(others.map(|stop| alone(stop, Way::Rays)));
        groups
    }
}

impl Stage<'_> {
    /// How many blocks of a stop are followed together, where `blocks` of all stops are to be followed on this patch:
    /// starts that are close enough for their rays to look at the same heights. Every thread has some of them.
    ///
    /// The answer changes no sum: each block draws from its own stream.
    pub fn blocks_together(&self, way: Way, blocks: usize, plan: &Plan) -> usize {
        let Stage::Heights(heights) = self else { return 1 };
        if way != Way::BySlope {
            return 1;
        }
        let close = heights.patch.window.cells() as u64 / CELLS_PER_START / plan.block_starts;
        let shared = blocks / (WORK_PER_THREAD * rayon::current_num_threads());
        (close as usize).min(shared).clamp(1, Together::MOST_BLOCKS)
    }
}

impl Heights<'_> {
    /// The patch as it lies on the stage for a block.
    pub fn sample(&self, arms: &BlockArms) -> Sample<'_> {
        Sample { walker: self.walker, alpha: self.alpha, image: arms.image }
    }

    /// The share of a block's incident flux that one of its starts has: about that of a block that starts on all
    /// facets, which is the area turned to the light over light.z x cells x starts. Any share is unbiased, as long
    /// as steps are of that size; it is the same for all blocks of a stop.
    fn start_share(&self, index: &FacetIndex, arms: &BlockArms, plan: &Plan) -> f64 {
        let light = self.sample(arms).to_field(arms.wi);
        index.turned_about(light) / (light.z * self.patch.window.cells() as f64 * plan.block_starts as f64)
    }
}
