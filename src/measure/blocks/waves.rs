//! Surface samples that are followed together, in waves through the lanes.

use std::cell::RefCell;

use super::tracer::BlockTracer;
use crate::measure::optics::{FacetWay, PathLight};
use crate::rng::PathDraws;
use crate::trace::{PathEnd, PathWaves, SimdTraversal, SplitEnd, SurfacePoint, Traced, View, Wave};

/// Samples that are followed together: their rays fit the cache of a core.
const WAVE: usize = 4096;

thread_local! {
    static WAVES: RefCell<Vec<WaveMemory>> = RefCell::default();
}

/// Calls `work` with the thread's memory for the waves of `count` incidences at once.
pub(in crate::measure) fn with_waves<T>(count: usize, work: impl FnOnce(&mut [WaveMemory]) -> T) -> T {
    WAVES.with_borrow_mut(|waves| {
        if waves.len() < count {
            waves.resize_with(count, WaveMemory::default);
        }
        work(&mut waves[..count])
    })
}

/// What a thread uses for one wave after another.
#[derive(Default)]
pub(in crate::measure) struct WaveMemory {
    starts: Vec<SurfacePoint>,
    /// Which turn each surface sample belongs to.
    turns: Vec<u16>,
    /// What decides at the facets of its paths.
    draws: Vec<PathDraws>,
    paths: PathWaves,
    lights: Vec<PathLight>,
    endings: Vec<PathEnd>,
    splits: Vec<SplitEnd>,
}

impl BlockTracer<'_> {
    /// Takes a surface sample of a turn for the next wave, which is followed through the lanes when it is full; paths end in
    /// the order in which they start. `views` has one for each turn.
    pub fn follow_later(
        &mut self,
        views: &[View],
        over: &[SimdTraversal; 2],
        (turn, start): (usize, SurfacePoint),
        wave: &mut WaveMemory,
    ) {
        self.at = turn;
        let View { sample, wi } = &views[turn];
        if self.misses(|| Some(sample.reflected(*wi, &start))) {
            return self.leave_out(1);
        }
        wave.starts.push(start);
        wave.turns.push(turn as u16);
        wave.draws.push(self.draws());
        if wave.starts.len() == WAVE {
            self.follow_wave(views, over, wave);
        }
    }

    /// Follows the samples that `memory` holds.
    pub fn follow_wave(&mut self, views: &[View], over: &[SimdTraversal; 2], memory: &mut WaveMemory) {
        if !self.is_given_up() {
            for (number, &way) in self.ways.iter().enumerate() {
                self.follow_way(views, over, (way, number == 0), memory);
            }
        }
        memory.starts.clear();
        memory.turns.clear();
        memory.draws.clear();
    }

    /// The same in one way; in the `first` it is noted what the light sees.
    fn follow_way(
        &mut self,
        views: &[View],
        over: &[SimdTraversal; 2],
        (way, first): (FacetWay, bool),
        memory: &mut WaveMemory,
    ) {
        let WaveMemory { starts, turns, draws, paths, lights, endings, splits } = memory;
        lights.clear();
        lights.extend(draws.iter().map(|&draws| self.light(way, draws)));
        let bounces = self.context.campaign.trace.bounces;
        let wave = Wave { surface_samples: starts, view_of: turns, views, bounces };
        let split = self.split_eta(way);
        match split {
            Some(eta) => paths.trace_split(over, &wave, eta, splits),
            None => paths.trace(over, &wave, lights, endings),
        }
        for (k, ((start, &turn), light)) in starts.iter().zip(&*turns).zip(&*lights).enumerate() {
            self.at = usize::from(turn);
            let ending = if split.is_some() { splits[k].reflected } else { endings[k] };
            if first {
                let sample = &views[self.at].sample;
                self.look(|w| sample.to_field(w), sample.slope(start), ending);
            }
            match split {
                Some(_) => self.end_split(&splits[k], light),
                None => self.end(ending, light),
            }
        }
    }
}
