//! One light of a sweep, and the loops over lines that carry depth and turned measure through a strip.

use pulp::{Arch, NullaryFnOnce};

use super::strip::{MOST, Segment, Strip};

/// Lines that go through a pass together: their state stays in the first cache.
pub(super) const LINES: usize = 128;

/// One number for each line of a group.
pub(super) type Lanes = [f64; LINES];

/// The lines' heights at the begin of a strip and at the end of each of its segments.
pub(super) type Heights = [Lanes; MOST + 1];

/// What a group of lines carries along for one light.
#[derive(Clone, Copy)]
pub(super) struct Carried {
    /// How deep each line runs below the light's edge.
    pub depths: Lanes,
    /// Measure that it has turned to the light so far.
    pub sums: Lanes,
}

impl Carried {
    /// Lines in the light that have turned nothing yet.
    pub const START: Carried = Carried { depths: [0.0; LINES], sums: [0.0; LINES] };
}

/// One light.
pub(super) struct Beam {
    /// What the processor offers.
    arch: Arch,
    /// Component along the lines' axis.
    pub reach: f64,
    /// Component upwards.
    pub rise: f64,
    /// Strips before the counted ones in which something may shade them.
    pub run_in: i64,
    /// Measure that each line turns to the light, as it sums it.
    pub turned: Vec<f64>,
    /// `before[j]` = measure that the lines before j turn to the light; one entry more than lines.
    pub before: Vec<f64>,
}

impl Beam {
    /// A light of which nothing is summed yet.
    pub fn new(reach: f64, rise: f64, height_range: f64) -> Self {
        let run_in = (height_range * reach / rise).ceil() as i64;
        Beam { arch: Arch::new(), reach, rise, run_in, turned: Vec::new(), before: vec![0.0] }
    }

    /// Appends the sums of further lines.
    pub fn add_lines(&mut self, turned: &[f64]) {
        for &turned in turned {
            self.turned.push(turned);
            self.before.push(self.before[self.before.len() - 1] + turned);
        }
    }

    /// How far light falls over a segment.
    pub fn rise_over(&self, segment: &Segment) -> f64 {
        self.rise * (segment.to - segment.from)
    }

    /// The lines' depths after the strip.
    pub fn sink(&self, strip: &Strip, heights: &Heights, depths: &mut Lanes) {
        self.arch.dispatch(Sink { way: self.way(strip, heights), depths });
    }

    /// Adds the measure that the lines turn to the light in the strip.
    pub fn sum(&self, strip: &Strip, heights: &Heights, sums: &mut Lanes) {
        self.arch.dispatch(Sum { way: self.way(strip, heights), sums });
    }

    /// Both at once, from `before` into `after`.
    pub fn carry(&self, strip: &Strip, heights: &Heights, before: &Carried, after: &mut Carried) {
        self.arch.dispatch(Carry { way: self.way(strip, heights), before, after });
    }

    fn way<'s>(&self, strip: &Strip, heights: &'s Heights) -> Way<'s> {
        Way { reach: self.reach, rises: self.rises(strip), segments: strip.segments().len(), heights }
    }

    fn rises(&self, strip: &Strip) -> [f64; MOST] {
        let mut rises = [0.0; MOST];
        for (rise, segment) in rises.iter_mut().zip(strip.segments()) {
            *rise = self.rise_over(segment);
        }
        rises
    }
}

/// A light's lines on their way through a strip.
struct Way<'s> {
    reach: f64,
    rises: [f64; MOST],
    segments: usize,
    heights: &'s Heights,
}

impl Way<'_> {
    /// Change of sheared height of line `lane` over segment `k`.
    #[inline(always)]
    fn change(&self, k: usize, lane: usize) -> f64 {
        self.reach * (self.heights[k + 1][lane] - self.heights[k][lane]) + self.rises[k]
    }
}

// The loops are compiled for each kind of processor, and the one that runs is chosen by `pulp`: structs, because
// closures are not inlined there. No operation is contracted, so results are the same on all of them.

struct Sink<'s> {
    way: Way<'s>,
    depths: &'s mut Lanes,
}

impl Sink<'_> {
    #[inline(always)]
    fn run<const N: usize>(self) {
        for (lane, depth) in self.depths.iter_mut().enumerate() {
            for k in 0..N {
                *depth = positive(*depth - self.way.change(k, lane));
            }
        }
    }
}

struct Sum<'s> {
    way: Way<'s>,
    sums: &'s mut Lanes,
}

impl Sum<'_> {
    #[inline(always)]
    fn run<const N: usize>(self) {
        for (lane, sum) in self.sums.iter_mut().enumerate() {
            for k in 0..N {
                *sum += positive(self.way.change(k, lane));
            }
        }
    }
}

struct Carry<'s> {
    way: Way<'s>,
    before: &'s Carried,
    after: &'s mut Carried,
}

impl Carry<'_> {
    #[inline(always)]
    fn run<const N: usize>(self) {
        let Carried { depths, sums } = self.after;
        for (lane, (depth, sum)) in depths.iter_mut().zip(sums).enumerate() {
            let (mut deep, mut turned) = (self.before.depths[lane], self.before.sums[lane]);
            for k in 0..N {
                let change = self.way.change(k, lane);
                turned += positive(change);
                deep = positive(deep - change);
            }
            (*depth, *sum) = (deep, turned);
        }
    }
}

macro_rules! by_segments {
    ($($name:ident)*) => {$(
        impl NullaryFnOnce for $name<'_> {
            type Output = ();

            #[inline(always)]
            fn call(self) {
                match self.way.segments {
                    1 => self.run::<1>(),
                    2 => self.run::<2>(),
                    3 => self.run::<3>(),
                    _ => self.run::<4>(),
                }
            }
        }
    )*};
}

by_segments!(Sink Sum Carry);

/// max(0, x) as one instruction: `f64::max` also looks for NaN.
#[inline(always)]
pub(super) fn positive(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}
