//! The blocks of one incidence on one patch: surface samples as the plan's sampler chooses them, followed and tallied.

use glam::DVec3;

use super::arms::{BlockArms, starts_stream};
use super::tracer::{BlockTracer, Work};
use super::waves::follow_all;
use crate::measure::accumulate::tally::Tally;
use crate::measure::context::Context;
use crate::measure::prepared_patch::{Heights, IntoApertures, PatchSampler, PlacedGrains};
use crate::rng;
use crate::trace::{
    AreaSampler, BatchedStarts, ConeSampler, Facet, GrainSampler, RaysFromAbove, SlopeIndex, SlopeSampler,
    SmithWalk, Traced, View,
};

impl Context<'_> {
    /// Adds blocks of samples to the tally of their incidence.
    pub(in crate::measure) fn blocks(&self, work: &Work, tally: &mut Tally) {
        let each = |block: &mut dyn FnMut(u64)| work.blocks.iter().for_each(|&number| block(number));
        match work.sampler {
            PatchSampler::Law(walk) => each(&mut |block| self.block_by_law(work, block, walk, tally)),
            PatchSampler::Grains(grains) if grains.is_from_above(work.incidence) => {
                each(&mut |block| self.block_from_above(work, block, grains, tally));
            }
            PatchSampler::Grains(grains) => {
                each(&mut |block| self.block_on_grains(work, block, grains, tally));
            }
            PatchSampler::ByPlace(heights) => {
                each(&mut |block| self.block_by_place(work, block, heights, tally));
            }
            PatchSampler::BySlope(heights, index) => self.blocks_by_slope(work, heights, index, tally),
            PatchSampler::IntoApertures(into) => {
                each(&mut |block| self.block_into_apertures(work, block, into, tally));
            }
        }
    }

    /// Paths through a law.
    fn block_by_law(&self, work: &Work, block: u64, walk: &SmithWalk, tally: &mut Tally) {
        let arms = self.arms(work, block);
        let id = self.starts_stream(work, block);
        let mut rng = rng::stream(id);
        let flux = 1.0 / self.plan.block_starts as f64;
        let mut followed = BlockTracer::one(self, work, arms, flux, tally);
        for path in 0..self.plan.block_starts {
            if followed.is_given_up() {
                return;
            }
            if self.plan.drawn_at.is_some() {
                // Paths draw more or fewer numbers: each begins where it does under other angles.
                rng = rng::stream_of_path(id, path);
            }
            followed.follow_law(walk, &mut rng);
        }
    }

    /// Samples from grain to grain.
    fn block_on_grains(&self, work: &Work, block: u64, grains: &PlacedGrains, tally: &mut Tally) {
        let (count, arms) = (self.plan.block_starts, self.arms(work, block));
        let sample = grains.sample(&arms);
        let starts = GrainSampler::new(grains.field, sample.to_field(arms.wi));
        let mut followed = BlockTracer::one(self, work, arms, starts.flux_fraction(count), tally);
        let mut rng = rng::stream(self.starts_stream(work, block));
        starts.each(count, &mut rng, |start| match start.is_buried(grains.field) {
            true => followed.bury(),
            false => followed.follow(&sample, 0, start),
        });
    }

    /// Samples where rays from above meet grains.
    fn block_from_above(&self, work: &Work, block: u64, grains: &PlacedGrains, tally: &mut Tally) {
        let (count, arms) = (self.plan.block_starts, self.arms(work, block));
        let sample = grains.sample(&arms);
        let mut rng = rng::stream(self.starts_stream(work, block));
        let mut followed = BlockTracer::one(self, work, arms, 1.0 / count as f64, tally);
        let light = sample.to_field(arms.wi);
        RaysFromAbove { field: grains.field, light }
            .each(count, &mut rng, |met| followed.follow_lit(&sample, met));
    }

    /// Samples along all facets, row by row.
    fn block_by_place(&self, work: &Work, block: u64, heights: &Heights, tally: &mut Tally) {
        let plan = self.plan;
        let arms = self.arms(work, block);
        let mut rng = rng::stream(self.starts_stream(work, block));
        let sample = heights.sample(&arms);
        let light = sample.to_field(arms.wi);
        let patch = heights.patch;
        let starts = AreaSampler::outside(&patch.field, patch.window, light, patch.excluded.as_ref());
        let flux = starts.flux_fraction(plan.block_starts);
        let mut followed = BlockTracer::one(self, work, arms, flux, tally);
        if flux == 0.0 {
            // A part of an open map may lean away from the light with every facet: nothing falls on it.
            return followed.all_turned_away(plan.block_starts);
        }
        follow_all(&mut followed, heights, &[View { sample, wi: arms.wi }], |samples| {
            starts.each(plan.block_starts, &mut rng, |start| samples.take(0, start));
        });
    }

    /// Samples along all facets in the order of their slopes: blocks together.
    fn blocks_by_slope(&self, work: &Work, heights: &Heights, index: &SlopeIndex, tally: &mut Tally) {
        let (field, count) = (&heights.patch.field, self.plan.block_starts);
        let mut followed = BlockTracer::new(self, work, tally);
        let (mut views, mut together) = (Vec::new(), BatchedStarts::default());
        for &block in work.blocks {
            let arms = self.arms(work, block);
            let sample = heights.sample(&arms);
            let mut stream = rng::stream(self.starts_stream(work, block));
            let starts = SlopeSampler::new(index, field, sample.to_field(arms.wi), &mut stream);
            followed.take(arms, starts.flux_fraction(count));
            together.add(&starts, count, stream);
            views.push(View { sample, wi: arms.wi });
        }
        follow_all(&mut followed, heights, &views, |samples| {
            let corners = |facet: &Facet| heights.corners(facet);
            together.each(index, field, corners, |turn, start| samples.take(turn, start));
        });
    }

    /// Samples on the facets alone that can send light into an aperture; the rest of the block is counted without being
    /// made.
    fn block_into_apertures(&self, work: &Work, block: u64, into: &IntoApertures, tally: &mut Tally) {
        let IntoApertures { heights, index, apertures, flux_fractions } = into;
        let (plan, incidence, fraction) = (self.plan, work.incidence, flux_fractions[work.incidence]);
        let arms = self.arms(work, block);
        let sample = heights.sample(&arms);
        let light = sample.to_field(arms.wi);
        // Most apertures of a scan in the plane of incidence are their own mirror images.
        let mirrored = |axis: DVec3| {
            let image = arms.mirrored(axis);
            (plan.folded[incidence] && image.distance(axis) > f64::EPSILON).then_some(image)
        };
        let axes = apertures.axes.iter().flat_map(|&axis| std::iter::once(axis).chain(mirrored(axis)));
        let axes = axes.map(|axis| arms.from_bins(axis));
        let selection = ConeSampler::new(index, sample, arms.wi, axes, apertures.half_angle);
        let step = fraction * light.z * heights.patch.window.cells() as f64;
        if selection.total() > step * plan.block_starts as f64 {
            // Nearly everything is wanted. Decided by the arms alone: no bias.
            return self.block_by_place(work, block, heights, tally);
        }
        let mut rng = rng::stream(self.starts_stream(work, block));
        let mut followed = BlockTracer::one(self, work, arms, fraction, tally);
        follow_all(&mut followed, heights, &[View { sample, wi: arms.wi }], |samples| {
            selection.each(step, &mut rng, |start| samples.take(0, start));
        });
        followed.leave_out_up_to(plan.block_starts);
    }

    fn arms(&self, work: &Work, block: u64) -> BlockArms {
        BlockArms::new(self.campaign, self.plan, work.incidence, work.realisation, block)
    }

    fn starts_stream(&self, work: &Work, block: u64) -> rng::StreamId {
        starts_stream(self.campaign, self.plan, work.incidence, work.realisation, block)
    }
}
