//! A patch in the instrument: what its roughnesses, incidences and blocks share, and how surface samples are chosen on it.

use glam::DVec2;

use super::blocks::arms::BlockArms;
use super::context::Context;
use super::optics::FacetWay;
use super::patches::specimen::{Patch, Specimen, grains_of};
use super::plan::{Apertures, Plan, StartSampler};
use crate::campaign::{Alpha, Campaign, LightSide};
use crate::surface::grains::GrainField;
use crate::surface::heightfield::Corners;
use crate::trace::{
    BatchedStarts, Facet, GridTraversal, MaxPyramid, SimdTraversal, SlopeIndex, SmithWalk, TilePeaks,
    TracedGrains, TracedPatch,
};

/// Cells of a patch for each surface sample that is followed together with others.
pub const CELLS_PER_START: u64 = 4;
/// Pieces of work that a thread gets at least.
const WORK_PER_THREAD: usize = 4;

/// A specimen, with what tracing makes of its heights.
pub(super) struct PreparedPatch {
    pub specimen: Specimen,
    front: PreparedSide,
    /// The specimen upside down, where light goes through its facets.
    back: Option<(Specimen, PreparedSide)>,
}

/// What tracing makes of one side of a specimen.
#[derive(Default)]
struct PreparedSide {
    lanes: Option<MaxPyramid>,
    /// For the f64 walk, where there are no lanes.
    peaks: Option<TilePeaks>,
    index: Option<SlopeIndex>,
}

/// The sampler of a side of a patch that the light comes from, and the ways in which its paths are followed.
pub(super) type LitSampler<'a> = (PatchSampler<'a>, Vec<FacetWay>);

/// The plan's sampler on one patch, for one roughness.
pub(super) enum PatchSampler<'a> {
    Law(SmithWalk),
    Grains(PlacedGrains<'a>),
    ByPlace(Heights<'a>),
    BySlope(Heights<'a>, &'a SlopeIndex),
    IntoApertures(IntoApertures<'a>),
}

/// Grains to follow paths on.
pub(super) struct PlacedGrains<'a> {
    pub field: &'a GrainField,
    alpha: DVec2,
    mirror_base: bool,
    /// Of which incidences rays come from above.
    from_above: &'a [bool],
}

/// Heights to walk over.
pub(super) struct Heights<'a> {
    pub patch: &'a Patch,
    pub traversal: GridTraversal<'a>,
    /// The other side; the same where no path goes there.
    below: GridTraversal<'a>,
    /// Both in lanes, where they serve.
    pub lanes: Option<[SimdTraversal<'a>; 2]>,
    /// World slope per canonical slope.
    pub alpha: DVec2,
}

/// Surface samples on those facets alone that can send light into apertures.
pub(super) struct IntoApertures<'a> {
    pub heights: Heights<'a>,
    pub index: &'a SlopeIndex,
    pub apertures: &'a Apertures,
    /// For each incidence, the fraction of a block's incident flux that one sample carries.
    pub flux_fractions: Vec<f64>,
}

impl PreparedPatch {
    pub fn new(specimen: Specimen, campaign: &Campaign, plan: &Plan) -> Self {
        let lit = campaign.optics.light_sides();
        let prepared =
            |specimen: &Specimen, side| PreparedSide::new(specimen, campaign, plan, lit.contains(&side));
        let back = campaign.optics.lets_through().then(|| specimen.upside_down());
        let back = back.map(|back| {
            let prepared = prepared(&back, LightSide::Back);
            (back, prepared)
        });
        PreparedPatch { front: prepared(&specimen, LightSide::Front), back, specimen }
    }

    /// The samplers of the run's plan for one roughness of this realisation: one for each side that light comes from.
    pub fn samplers<'a>(
        &'a self,
        context: &'a Context,
        alpha: Option<Alpha>,
        realisation: u64,
    ) -> Vec<LitSampler<'a>> {
        let of_side = |light: LightSide| {
            let ways = context.ways.iter().copied().filter(|way| way.light == light).collect();
            (self.sampler(context, light, alpha, realisation), ways)
        };
        context.campaign.optics.light_sides().into_iter().map(of_side).collect()
    }

    /// The sampler of the run's plan for one roughness of this realisation, under light from one side.
    fn sampler<'a>(
        &'a self,
        context: &'a Context,
        light: LightSide,
        alpha: Option<Alpha>,
        realisation: u64,
    ) -> PatchSampler<'a> {
        let front = (&self.specimen, &self.front);
        let back = self.back.as_ref().map_or(front, |(specimen, side)| (specimen, side));
        let ((specimen, side), other) = if light == LightSide::Front { (front, back) } else { (back, front) };
        let patch = match specimen {
            Specimen::Patch(patch) => patch,
            Specimen::Statistical { law, independent_heights } => {
                let (law, independent_heights) = (*law, *independent_heights);
                return PatchSampler::Law(SmithWalk { law, alpha: slope_scales(alpha), independent_heights });
            }
            Specimen::Grains(fields) => {
                let table = context.campaign.alphas().iter().position(|known| *known == alpha);
                let from_above = match (&context.plan.start_sampler, table) {
                    (StartSampler::Grains { from_above }, Some(table)) => &from_above[table][..],
                    _ => &[],
                };
                return PatchSampler::Grains(PlacedGrains {
                    field: grains_of(fields, alpha),
                    alpha: slope_scales(alpha),
                    mirror_base: !context.campaign.surface.kind.has_absorbing_base(),
                    from_above,
                });
            }
        };
        let traversal = side.traversal(patch);
        let (below, below_side) = match other {
            (Specimen::Patch(below), below_side) => (below_side.traversal(below), below_side),
            _ => (traversal, side),
        };
        let lanes = |side: &'a PreparedSide, traversal| {
            side.lanes.as_ref().map(|lanes| SimdTraversal::new(traversal, lanes, context.kernel))
        };
        let lanes = lanes(side, traversal).zip(lanes(below_side, below)).map(<[SimdTraversal; 2]>::from);
        let heights = Heights { patch, traversal, below, lanes, alpha: patch.alpha(alpha) };
        match (&context.plan.start_sampler, &side.index) {
            (StartSampler::BySlope, Some(index)) => PatchSampler::BySlope(heights, index),
            (StartSampler::IntoApertures(apertures), Some(index)) => {
                let of_incidence = |incidence: usize| {
                    let arms = BlockArms::new(context.campaign, context.plan, incidence, realisation, 0);
                    heights.flux_fraction(index, &arms, context.plan)
                };
                let flux_fractions = (0..context.plan.incidences).map(of_incidence).collect();
                PatchSampler::IntoApertures(IntoApertures { heights, index, apertures, flux_fractions })
            }
            _ => PatchSampler::ByPlace(heights),
        }
    }
}

impl PreparedSide {
    /// Of a specimen on whose facets paths start (`lit`), or only go on.
    fn new(specimen: &Specimen, campaign: &Campaign, plan: &Plan, lit: bool) -> Self {
        let Specimen::Patch(patch) = specimen else { return PreparedSide::default() };
        let visibility = campaign.trace.visibility;
        let indexed = lit && plan.start_sampler.is_indexed();
        let index = if indexed { SlopeIndex::new(&patch.field) } else { None };
        let lanes = if visibility { MaxPyramid::new(&patch.field) } else { None };
        let peaks = (visibility && lanes.is_none()).then(|| TilePeaks::new(&patch.field));
        PreparedSide { lanes, peaks, index }
    }

    fn traversal<'a>(&'a self, patch: &'a Patch) -> GridTraversal<'a> {
        let traversal = GridTraversal::new(&patch.field);
        self.peaks.as_ref().map_or(traversal, |peaks| traversal.with_peaks(peaks))
    }
}

/// World slope per canonical slope of a roughness.
fn slope_scales(alpha: Option<Alpha>) -> DVec2 {
    alpha.map_or(DVec2::ONE, |alpha| DVec2::new(alpha.x, alpha.y))
}

impl PlacedGrains<'_> {
    /// The grains as they lie in the instrument for a block.
    pub fn sample(&self, arms: &BlockArms) -> TracedGrains<'_> {
        let PlacedGrains { field, alpha, mirror_base, .. } = *self;
        TracedGrains { field, alpha, image: arms.image, mirror_base }
    }

    /// Whether the samples of an incidence are found from above.
    pub fn is_from_above(&self, incidence: usize) -> bool {
        self.from_above.get(incidence).is_some_and(|&above| above)
    }
}

impl PatchSampler<'_> {
    /// How many blocks of an incidence are followed together, where `blocks` of all of them are to be followed on this
    /// patch: samples that are close enough for their rays to look at the same heights. Every thread has some of them.
    ///
    /// The answer changes no sum: each block draws from its own stream.
    pub fn blocks_together(&self, blocks: usize, plan: &Plan) -> usize {
        let PatchSampler::BySlope(heights, _) = self else { return 1 };
        let close = heights.patch.window.cells() as u64 / CELLS_PER_START / plan.block_starts;
        let shared = blocks / (WORK_PER_THREAD * rayon::current_num_threads());
        (close as usize).min(shared).clamp(1, BatchedStarts::MOST_BLOCKS)
    }
}

impl Heights<'_> {
    /// The patch as it lies in the instrument for a block.
    pub fn sample(&self, arms: &BlockArms) -> TracedPatch<'_> {
        TracedPatch { traversal: self.traversal, below: self.below, alpha: self.alpha, image: arms.image }
    }

    /// The corner heights of a facet's cell: from the lanes' smaller copy where there is one, whose rays read it next.
    #[inline]
    pub fn corners(&self, facet: &Facet) -> Corners {
        match &self.lanes {
            Some([over, _]) => over.corners(facet),
            None => self.patch.field.corners(facet.x, facet.y),
        }
    }

    /// The fraction of a block's incident flux that one of its samples carries: about that of a block whose samples lie
    /// on all facets, which is the projected area over light.z x cells x samples. Any fraction is unbiased, as long as
    /// steps are of that size; it is the same for all blocks of an incidence.
    fn flux_fraction(&self, index: &SlopeIndex, arms: &BlockArms, plan: &Plan) -> f64 {
        let light = self.sample(arms).to_field(arms.wi);
        index.turned_about(light) / (light.z * self.patch.window.cells() as f64 * plan.block_starts as f64)
    }
}
