//! One light of a sweep, and the loops over lines that carry depth and turned measure through a strip.

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
        Beam { reach, rise, run_in, turned: Vec::new(), before: vec![0.0] }
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
        let rises = self.rises(strip);
        match strip.segments().len() {
            1 => sink::<1>(self.reach, &rises, heights, depths),
            2 => sink::<2>(self.reach, &rises, heights, depths),
            3 => sink::<3>(self.reach, &rises, heights, depths),
            _ => sink::<4>(self.reach, &rises, heights, depths),
        }
    }

    /// Adds the measure that the lines turn to the light in the strip.
    pub fn sum(&self, strip: &Strip, heights: &Heights, sums: &mut Lanes) {
        let rises = self.rises(strip);
        match strip.segments().len() {
            1 => sum::<1>(self.reach, &rises, heights, sums),
            2 => sum::<2>(self.reach, &rises, heights, sums),
            3 => sum::<3>(self.reach, &rises, heights, sums),
            _ => sum::<4>(self.reach, &rises, heights, sums),
        }
    }

    /// Both at once, from `before` into `after`.
    pub fn carry(&self, strip: &Strip, heights: &Heights, before: &Carried, after: &mut Carried) {
        let rises = self.rises(strip);
        match strip.segments().len() {
            1 => carry::<1>(self.reach, &rises, heights, before, after),
            2 => carry::<2>(self.reach, &rises, heights, before, after),
            3 => carry::<3>(self.reach, &rises, heights, before, after),
            _ => carry::<4>(self.reach, &rises, heights, before, after),
        }
    }

    fn rises(&self, strip: &Strip) -> [f64; MOST] {
        let mut rises = [0.0; MOST];
        for (rise, segment) in rises.iter_mut().zip(strip.segments()) {
            *rise = self.rise_over(segment);
        }
        rises
    }
}

fn sink<const N: usize>(reach: f64, rises: &[f64; MOST], heights: &Heights, depths: &mut Lanes) {
    for (lane, depth) in depths.iter_mut().enumerate() {
        for k in 0..N {
            let change = reach * (heights[k + 1][lane] - heights[k][lane]) + rises[k];
            *depth = positive(*depth - change);
        }
    }
}

fn sum<const N: usize>(reach: f64, rises: &[f64; MOST], heights: &Heights, sums: &mut Lanes) {
    for (lane, sum) in sums.iter_mut().enumerate() {
        for k in 0..N {
            let change = reach * (heights[k + 1][lane] - heights[k][lane]) + rises[k];
            *sum += positive(change);
        }
    }
}

fn carry<const N: usize>(
    reach: f64,
    rises: &[f64; MOST],
    heights: &Heights,
    before: &Carried,
    after: &mut Carried,
) {
    for (lane, (depth, sum)) in after.depths.iter_mut().zip(&mut after.sums).enumerate() {
        (*depth, *sum) = (before.depths[lane], before.sums[lane]);
        for k in 0..N {
            let change = reach * (heights[k + 1][lane] - heights[k][lane]) + rises[k];
            *sum += positive(change);
            *depth = positive(*depth - change);
        }
    }
}

/// max(0, x) as one instruction: `f64::max` also looks for NaN.
#[inline(always)]
pub(super) fn positive(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}
