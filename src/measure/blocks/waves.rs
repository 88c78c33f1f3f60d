//! Surface samples that are followed together, in waves through the lanes.

use std::cell::RefCell;

use super::tracer::BlockTracer;
use crate::measure::optics::{FacetWay, PathLight};
use crate::measure::prepared_patch::Heights;
use crate::rng::PathDraws;
use crate::trace::{PathEnd, PathWaves, SimdTraversal, SplitEnd, SurfacePoint, View, Wave};

/// Samples that are followed together: their rays fit the cache of a core.
const WAVE: usize = 2048;

thread_local! {
    static MEMORY: RefCell<WaveMemory> = RefCell::default();
}

/// Follows the samples that `each` takes, each under one of `views`, through the lanes where they serve.
pub(super) fn follow_all(
    blocks: &mut BlockTracer,
    heights: &Heights,
    views: &[View],
    each: impl FnOnce(&mut Samples),
) {
    MEMORY.with_borrow_mut(|memory| {
        let mut samples = Samples { blocks, views, over: heights.lanes.as_ref(), memory };
        each(&mut samples);
        samples.follow();
    });
}

/// Takes surface samples, to be followed in waves through the lanes `over` the patch, or one by one where there are none.
pub(super) struct Samples<'a, 'b> {
    blocks: &'a mut BlockTracer<'b>,
    /// One for each turn.
    views: &'a [View<'a>],
    over: Option<&'a [SimdTraversal<'a>; 2]>,
    memory: &'a mut WaveMemory,
}

/// What a thread uses for one wave after another.
#[derive(Default)]
struct WaveMemory {
    starts: Vec<SurfacePoint>,
    /// Which turn each surface sample belongs to.
    turns: Vec<u16>,
    /// What decides at the facets of its paths.
    draws: Vec<PathDraws>,
    paths: PathWaves,
    lights: Vec<PathLight>,
    splits: Vec<SplitEnd>,
}

impl Samples<'_, '_> {
    /// Takes a surface sample of a turn.
    #[inline]
    pub fn take(&mut self, turn: usize, start: SurfacePoint) {
        let Samples { blocks, views, memory, .. } = self;
        let View { sample, wi } = &views[turn];
        if self.over.is_none() {
            return blocks.follow(sample, turn, start);
        }
        blocks.at = turn;
        if blocks.misses(|| Some(sample.reflected(*wi, &start))) {
            return blocks.leave_out(1);
        }
        memory.starts.push(start);
        memory.turns.push(turn as u16);
        memory.draws.push(blocks.draws());
        if memory.starts.len() == WAVE {
            self.follow();
        }
    }

    /// Follows the samples of the wave.
    fn follow(&mut self) {
        if let Some(over) = self.over.filter(|_| !self.blocks.is_given_up()) {
            for (number, &way) in self.blocks.ways.iter().enumerate() {
                self.follow_way(over, way, number == 0);
            }
        }
        self.memory.starts.clear();
        self.memory.turns.clear();
        self.memory.draws.clear();
    }

    /// The same in one way; in the `first` it is noted what the light sees.
    fn follow_way(&mut self, over: &[SimdTraversal; 2], way: FacetWay, first: bool) {
        let Samples { blocks, views, memory, .. } = self;
        let WaveMemory { starts, turns, draws, paths, lights, splits } = &mut **memory;
        let kept = blocks.context.plan.sums.kept();
        for (path, &draws) in draws.iter().enumerate() {
            match lights.get_mut(path) {
                Some(light) => light.begin(way, draws, kept),
                None => lights.push(PathLight::new(way, draws, kept)),
            }
        }
        let lights = &mut lights[..starts.len()];
        let bounces = blocks.context.campaign.trace.bounces;
        let wave = Wave { surface_samples: starts, view_of: turns, views, bounces };
        // Sums are whole numbers: paths may end in any order.
        let look = |blocks: &mut BlockTracer, path: usize, ending: PathEnd| {
            blocks.at = usize::from(turns[path]);
            if first {
                let sample = &views[blocks.at].sample;
                blocks.look(|w| sample.to_field(w), starts[path].slope, ending);
            }
        };
        match blocks.split_eta(way) {
            Some(eta) => {
                paths.trace_split(over, &wave, eta, splits);
                for (path, (ends, light)) in splits.iter().zip(&*lights).enumerate() {
                    look(blocks, path, ends.reflected);
                    blocks.end_split(ends, light);
                }
            }
            None => paths.trace(over, &wave, lights, |path, light, ending| {
                look(blocks, path, ending);
                blocks.end(ending, light);
            }),
        }
    }
}
