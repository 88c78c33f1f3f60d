//! The ways to start a block: by a line sweep, along all facets with a ray for each, on the wanted facets alone, from
//! a law without heights, or, for comparison, by rays from above.

use glam::DVec3;

use super::arms::{BlockArms, starts_stream};
use super::block::{Block, with_waves};
use super::optics::Light;
use super::run::Context;
use super::stage::{Group, Heights, Stage, Way};
use super::tally::Tally;
use crate::rng;
use crate::trace::{BySlope, FromAbove, Place, Sample, Selection, SmithWalk, Starts, Sweep};

impl Context<'_> {
    /// One block of starts of every stop of a group.
    pub(super) fn block(&self, work: &Work, tallies: &mut [Tally]) {
        match work.stage {
            Stage::Heights(heights) => match work.group.way {
                Way::Sweep => self.swept_block(work, heights, tallies),
                Way::Rays => self.ray_block(work, heights, &mut tallies[0]),
                Way::Index(share) => self.indexed_block(work, heights, share, &mut tallies[0]),
                Way::BySlope => self.block_by_slope(work, heights, &mut tallies[0]),
                Way::Above => self.block_from_above(work, heights, &mut tallies[0]),
            },
            Stage::Statistical(walk) => self.walked_block(work, walk, &mut tallies[0]),
        }
        (self.session.progress)(self.plan.block_starts * work.group.stops.len() as u64);
    }

    /// Paths through a law.
    fn walked_block(&self, work: &Work, walk: &SmithWalk, tally: &mut Tally) {
        let stop = work.group.stops[0];
        let arms = self.arms(work, stop);
        let mut rng = rng::stream(self.starts_stream(work, stop));
        let flux = 1.0 / self.plan.block_starts as f64;
        let mut block = Block::new(self, arms, stop, flux, false, tally);
        for _ in 0..self.plan.block_starts {
            let mut light = Light::new(self.plan.weighing.needs_angles());
            let ending = walk.trace(arms.wi, self.campaign.trace.bounces, &mut rng, &mut light);
            block.end(ending, &light);
        }
    }

    /// Starts on the facets, and a ray towards the light for each.
    fn ray_block(&self, work: &Work, heights: &Heights, tally: &mut Tally) {
        let (plan, stop) = (self.plan, work.group.stops[0]);
        let arms = self.arms(work, stop);
        let mut rng = rng::stream(self.starts_stream(work, stop));
        let sample = heights.sample(&arms);
        let light = sample.to_field(arms.wi);
        let starts = Starts::new(&heights.patch.field, heights.patch.window, light);
        let flux = starts.share(plan.block_starts);
        let mut block = Block::new(self, arms, stop, flux, false, tally);
        follow_all(&mut block, heights, &sample, |visit| {
            starts.each(plan.block_starts, &mut rng, visit);
        });
    }

    /// Starts on the facets in the order of their slopes, and a ray towards the light for each.
    fn block_by_slope(&self, work: &Work, heights: &Heights, tally: &mut Tally) {
        let Some(index) = heights.index else {
            unreachable!("only stages with an index are walked by slope")
        };
        let (plan, stop) = (self.plan, work.group.stops[0]);
        let arms = self.arms(work, stop);
        let mut rng = rng::stream(self.starts_stream(work, stop));
        let sample = heights.sample(&arms);
        let light = sample.to_field(arms.wi);
        let starts = BySlope::new(index, &heights.patch.field, light);
        let flux = starts.share(plan.block_starts);
        let mut block = Block::new(self, arms, stop, flux, false, tally);
        follow_all(&mut block, heights, &sample, |visit| {
            starts.each(plan.block_starts, &mut rng, visit);
        });
    }

    /// Starts on the facets alone that can send light into an aperture; the rest of the block is counted without
    /// being made.
    fn indexed_block(&self, work: &Work, heights: &Heights, share: f64, tally: &mut Tally) {
        let (Some(index), Some((axes, half_angle))) = (heights.index, self.sensor.cones()) else {
            unreachable!("only stages with an index are sparse, and only arms have one");
        };
        let (plan, stop) = (self.plan, work.group.stops[0]);
        let arms = self.arms(work, stop);
        let sample = heights.sample(&arms);
        let light = sample.to_field(arms.wi);
        // Most apertures of a scan in the plane of incidence are their own mirror images.
        let mirrored = |axis: DVec3| {
            let image = arms.mirrored(axis);
            (plan.folded[stop] && image.distance(axis) > f64::EPSILON).then_some(image)
        };
        let axes = axes.flat_map(|axis| std::iter::once(axis).chain(mirrored(axis)));
        let axes = axes.map(|axis| arms.from_bins(axis));
        let selection = Selection::new(index, sample, arms.wi, axes, half_angle);
        let step = share * light.z * heights.patch.window.cells() as f64;
        if selection.total() > step * plan.block_starts as f64 {
            // Nearly everything is wanted. Decided by the arms alone: no bias.
            return self.ray_block(work, heights, tally);
        }
        let mut rng = rng::stream(self.starts_stream(work, stop));
        let mut block = Block::new(self, arms, stop, share, false, tally);
        follow_all(&mut block, heights, &sample, |visit| selection.each(step, &mut rng, visit));
        block.leave_out_up_to(plan.block_starts);
    }

    /// Starts along the lines of a sweep, which says as well which of them the light sees.
    fn swept_block(&self, work: &Work, heights: &Heights, tallies: &mut [Tally]) {
        let (Some(over), Some(layout)) = (&heights.lanes, &heights.layout) else {
            unreachable!("only fields with both are swept");
        };
        let (plan, stops) = (self.plan, &work.group.stops);
        let arms: Vec<BlockArms> = stops.iter().map(|&stop| self.arms(work, stop)).collect();
        let sample = heights.sample(&arms[0]);
        let lights: Vec<_> = arms.iter().map(|arms| sample.to_field(arms.wi)).collect();
        let heading = sample.to_field(arms[0].heading).truncate();
        let sweep = Sweep::new(layout, heading, &lights, arms[0].line);
        let offset = |&stop: &usize| rng::uniform(&mut rng::stream(self.starts_stream(work, stop)));
        let offsets: Vec<f64> = stops.iter().map(offset).collect();
        let of_stop = |(k, tally): (usize, _)| {
            let flux = sweep.share(k, plan.block_starts);
            Block::new(self, arms[k], stops[k], flux, true, tally)
        };
        let mut blocks: Vec<Block> = tallies.iter_mut().enumerate().map(of_stop).collect();
        with_waves(blocks.len(), |waves| {
            sweep.each(plan.block_starts, &offsets, |k, start, lit| {
                if lit {
                    blocks[k].follow_later(&sample, over, start, &mut waves[k]);
                } else {
                    blocks[k].hide(&sample, &start);
                }
            });
            for (block, wave) in blocks.iter_mut().zip(waves) {
                block.follow_wave(&sample, over, wave);
            }
        });
    }

    /// Starts where rays from above come down: all that it takes is done by rays, and the light sees every start.
    fn block_from_above(&self, work: &Work, heights: &Heights, tally: &mut Tally) {
        let Some(over) = heights.lanes else { unreachable!("only fields with lanes are compared") };
        let (plan, stop) = (self.plan, work.group.stops[0]);
        let arms = self.arms(work, stop);
        let mut rng = rng::stream(self.starts_stream(work, stop));
        let sample = heights.sample(&arms);
        let beam = FromAbove::new(over, sample.to_field(arms.wi));
        let flux = 1.0 / plan.block_starts as f64;
        let mut block = Block::new(self, arms, stop, flux, true, tally);
        let (rays, lost) = with_waves(1, |waves| {
            let sent = beam.each(plan.block_starts, &mut rng, |start| {
                block.follow_later(&sample, &over, start, &mut waves[0]);
            });
            block.follow_wave(&sample, &over, &mut waves[0]);
            sent
        });
        block.end_primaries(rays, lost);
    }

    fn arms(&self, work: &Work, stop: usize) -> BlockArms {
        BlockArms::new(self.campaign, self.plan, stop, work.realisation, work.block)
    }

    fn starts_stream(&self, work: &Work, stop: usize) -> rng::StreamId {
        starts_stream(self.campaign, self.plan, stop, work.realisation, work.block)
    }
}

/// Follows the starts that `each` visits, through the lanes where they serve.
fn follow_all(
    block: &mut Block,
    heights: &Heights,
    sample: &Sample,
    each: impl FnOnce(&mut dyn FnMut(Place)),
) {
    match heights.lanes {
        Some(over) => with_waves(1, |waves| {
            each(&mut |start| block.follow_later(sample, &over, start, &mut waves[0]));
            block.follow_wave(sample, &over, &mut waves[0]);
        }),
        None => each(&mut |start| block.follow(sample, start)),
    }
}

/// The address of a block, and the surface that it is measured on.
pub(super) struct Work<'a> {
    pub stage: &'a Stage<'a>,
    pub group: &'a Group,
    pub realisation: u64,
    pub block: u64,
}
