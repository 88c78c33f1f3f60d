//! The ways to start a block: by a line sweep, along all facets with a ray for each, on the wanted facets alone, from
//! a law without heights, or, for comparison, by rays from above.

use glam::DVec3;

use super::arms::{BlockArms, starts_stream};
use super::followed::{Followed, with_waves};
use super::optics::Light;
use super::run::Context;
use super::stage::{Group, Heights, Stage, Way};
use super::tally::Tally;
use crate::rng;
use crate::trace::{BySlope, FromAbove, Place, Selection, SmithWalk, Starts, Sweep, Together, View};

impl Context<'_> {
    /// The blocks of starts of every stop of a group.
    pub(super) fn blocks(&self, work: &Work, tallies: &mut [Tally]) {
        match work.stage {
            Stage::Heights(heights) if work.group.way == Way::BySlope => {
                self.blocks_by_slope(work, heights, &mut tallies[0]);
            }
            _ => work.blocks.iter().for_each(|&block| self.block(work, block, tallies)),
        }
        let starts = self.plan.block_starts * (work.group.stops.len() * work.blocks.len()) as u64;
        (self.session.progress)(starts);
    }

    /// One block of starts of every stop of a group.
    fn block(&self, work: &Work, block: u64, tallies: &mut [Tally]) {
        match work.stage {
            Stage::Heights(heights) => match work.group.way {
                Way::Sweep => self.swept_block(work, block, heights, tallies),
                Way::Rays => self.ray_block(work, block, heights, &mut tallies[0]),
                Way::Index(share) => self.indexed_block(work, block, (heights, share), &mut tallies[0]),
                Way::Above => self.block_from_above(work, block, heights, &mut tallies[0]),
                Way::BySlope => unreachable!("blocks by slope are followed together"),
            },
            Stage::Statistical(walk) => self.walked_block(work, block, walk, &mut tallies[0]),
        }
    }

    /// Paths through a law.
    fn walked_block(&self, work: &Work, block: u64, walk: &SmithWalk, tally: &mut Tally) {
        let stop = work.group.stops[0];
        let arms = self.arms(work, block, stop);
        let mut rng = rng::stream(self.starts_stream(work, block, stop));
        let flux = 1.0 / self.plan.block_starts as f64;
        let mut followed = Followed::one(self, (arms, stop), flux, false, tally);
        for _ in 0..self.plan.block_starts {
            if followed.is_given_up() {
                return;
            }
            let mut light = Light::new(self.plan.weighing.needs_angles());
            let ending = walk.trace(arms.wi, self.campaign.trace.bounces, &mut rng, &mut light);
            followed.end(ending, &light);
        }
    }

    /// Starts on the facets, and a ray towards the light for each.
    fn ray_block(&self, work: &Work, block: u64, heights: &Heights, tally: &mut Tally) {
        let (plan, stop) = (self.plan, work.group.stops[0]);
        let arms = self.arms(work, block, stop);
        let mut rng = rng::stream(self.starts_stream(work, block, stop));
        let sample = heights.sample(&arms);
        let light = sample.to_field(arms.wi);
        let starts = Starts::new(&heights.patch.field, heights.patch.window, light);
        let flux = starts.share(plan.block_starts);
        let mut followed = Followed::one(self, (arms, stop), flux, false, tally);
        if flux == 0.0 {
            // A part of an open map may lean away from the light with every facet: nothing falls on it.
            return followed.all_turned_away(plan.block_starts);
        }
        follow_all(&mut followed, heights, &[View { sample, wi: arms.wi }], |visit| {
            starts.each(plan.block_starts, &mut rng, |start| visit(0, start));
        });
    }

    /// Starts on the facets in the order of their slopes, and a ray towards the light for each: blocks together.
    fn blocks_by_slope(&self, work: &Work, heights: &Heights, tally: &mut Tally) {
        let Some(index) = heights.index else {
            unreachable!("only stages with an index are walked by slope")
        };
        let (field, count, stop) = (&heights.patch.field, self.plan.block_starts, work.group.stops[0]);
        let mut followed = Followed::new(self, stop, false, tally);
        let (mut views, mut together) = (Vec::new(), Together::default());
        for &block in work.blocks {
            let arms = self.arms(work, block, stop);
            let sample = heights.sample(&arms);
            let mut stream = rng::stream(self.starts_stream(work, block, stop));
            let starts = BySlope::new(index, field, sample.to_field(arms.wi), &mut stream);
            followed.take(arms, starts.share(count));
            together.add(&starts, count, stream);
            views.push(View { sample, wi: arms.wi });
        }
        follow_all(&mut followed, heights, &views, |visit| together.each(index, field, visit));
    }

    /// Starts on the facets alone that can send light into an aperture; the rest of the block is counted without
    /// being made.
    fn indexed_block(&self, work: &Work, block: u64, (heights, share): (&Heights, f64), tally: &mut Tally) {
        let (Some(index), Some((axes, half_angle))) = (heights.index, self.sensor.cones()) else {
            unreachable!("only stages with an index are sparse, and only arms have one");
        };
        let (plan, stop) = (self.plan, work.group.stops[0]);
        let arms = self.arms(work, block, stop);
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
            return self.ray_block(work, block, heights, tally);
        }
        let mut rng = rng::stream(self.starts_stream(work, block, stop));
        let mut followed = Followed::one(self, (arms, stop), share, false, tally);
        follow_all(&mut followed, heights, &[View { sample, wi: arms.wi }], |visit| {
            selection.each(step, &mut rng, |start| visit(0, start));
        });
        followed.leave_out_up_to(plan.block_starts);
    }

    /// Starts along the lines of a sweep, which says as well which of them the light sees.
    fn swept_block(&self, work: &Work, block: u64, heights: &Heights, tallies: &mut [Tally]) {
        let (Some(over), Some(layout)) = (&heights.lanes, &heights.layout) else {
            unreachable!("only fields with both are swept");
        };
        let (plan, stops) = (self.plan, &work.group.stops);
        let arms: Vec<BlockArms> = stops.iter().map(|&stop| self.arms(work, block, stop)).collect();
        let sample = heights.sample(&arms[0]);
        let lights: Vec<_> = arms.iter().map(|arms| sample.to_field(arms.wi)).collect();
        let heading = sample.to_field(arms[0].heading).truncate();
        let sweep = Sweep::new(layout, heading, &lights, arms[0].line);
        let offset = |&stop: &usize| rng::uniform(&mut rng::stream(self.starts_stream(work, block, stop)));
        let offsets: Vec<f64> = stops.iter().map(offset).collect();
        let of_stop = |(k, tally): (usize, _)| {
            let flux = sweep.share(k, plan.block_starts);
            Followed::one(self, (arms[k], stops[k]), flux, true, tally)
        };
        let mut followed: Vec<Followed> = tallies.iter_mut().enumerate().map(of_stop).collect();
        let views: Vec<View> = arms.iter().map(|arms| View { sample, wi: arms.wi }).collect();
        with_waves(stops.len(), |waves| {
            sweep.each(plan.block_starts, &offsets, |k, start, lit| {
                if lit {
                    followed[k].follow_later(&views[k..=k], over, (0, start), &mut waves[k]);
                } else {
                    followed[k].hide(&sample, &start);
                }
            });
            for ((followed, wave), view) in followed.iter_mut().zip(waves).zip(views.chunks(1)) {
                followed.follow_wave(view, over, wave);
            }
        });
    }

    /// Starts where rays from above come down: all that it takes is done by rays, and the light sees every start.
    fn block_from_above(&self, work: &Work, block: u64, heights: &Heights, tally: &mut Tally) {
        let Some(over) = heights.lanes else { unreachable!("only fields with lanes are compared") };
        let (plan, stop) = (self.plan, work.group.stops[0]);
        let arms = self.arms(work, block, stop);
        let mut rng = rng::stream(self.starts_stream(work, block, stop));
        let sample = heights.sample(&arms);
        let beam = FromAbove::new(over, sample.to_field(arms.wi));
        let flux = 1.0 / plan.block_starts as f64;
        let mut followed = Followed::one(self, (arms, stop), flux, true, tally);
        let views = [View { sample, wi: arms.wi }];
        let (rays, lost) = with_waves(1, |waves| {
            let sent = beam.each(plan.block_starts, &mut rng, |start| {
                followed.follow_later(&views, &over, (0, start), &mut waves[0]);
            });
            followed.follow_wave(&views, &over, &mut waves[0]);
            sent
        });
        followed.end_primaries(rays, lost);
    }

    fn arms(&self, work: &Work, block: u64, stop: usize) -> BlockArms {
        BlockArms::new(self.campaign, self.plan, stop, work.realisation, block)
    }

    fn starts_stream(&self, work: &Work, block: u64, stop: usize) -> rng::StreamId {
        starts_stream(self.campaign, self.plan, stop, work.realisation, block)
    }
}

/// Follows the starts that `each` visits, each under one of `views`, through the lanes where they serve.
fn follow_all(
    blocks: &mut Followed,
    heights: &Heights,
    views: &[View],
    each: impl FnOnce(&mut dyn FnMut(usize, Place)),
) {
    match heights.lanes {
        Some(over) => with_waves(1, |waves| {
            each(&mut |turn, start| blocks.follow_later(views, &over, (turn, start), &mut waves[0]));
            blocks.follow_wave(views, &over, &mut waves[0]);
        }),
        None => each(&mut |turn, start| blocks.follow(&views[turn].sample, turn, start)),
    }
}

/// The address of some blocks, and the surface that they are measured on.
pub(super) struct Work<'a> {
    pub stage: &'a Stage<'a>,
    pub group: &'a Group,
    pub realisation: u64,
    pub blocks: &'a [u64],
}
