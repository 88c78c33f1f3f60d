//! The systematic steps of a block along the lines.

use super::beam::{Beam, LINES, Lanes};

/// The systematic steps of a light, dealt to its lines.
pub(super) struct Steps<'s> {
    /// The light.
    pub beam: &'s Beam,
    step: f64,
    offset: f64,
    /// `first[j]` = first step of line j; one entry more than lines.
    first: Vec<u64>,
}

impl<'s> Steps<'s> {
    pub fn new(beam: &'s Beam, count: u64, offset: f64) -> Self {
        let before = &beam.before;
        let lines = beam.turned.len();
        let step = before[lines] / count as f64;
        let mut steps = Steps { beam, step, offset, first: vec![0; lines + 1] };
        let mut next = 0;
        for line in 0..lines {
            while next < count && steps.at(next) < before[line + 1] {
                next += 1;
            }
            steps.first[line + 1] = next;
        }
        // Rounding may leave a step beyond the sum: it belongs to the last line that turns anything to the light.
        for line in (0..lines).rev() {
            steps.first[line + 1] = count;
            if before[line] < before[line + 1] {
                break;
            }
        }
        steps
    }

    /// Where step `k` lies in the sum over all lines.
    fn at(&self, k: u64) -> f64 {
        (k as f64 + self.offset) * self.step
    }
}

/// The next steps of a group of lines.
pub(super) struct Due {
    /// Each line's sum beyond which its next start lies.
    pub sums: Lanes,
    next: [u64; LINES],
}

impl Due {
    /// The first steps of the lines from `first` on.
    pub fn new(steps: &Steps, first: usize) -> Self {
        let mut due = Due { sums: [f64::INFINITY; LINES], next: [0; LINES] };
        for lane in 0..(steps.beam.turned.len() - first).min(LINES) {
            due.next[lane] = steps.first[first + lane];
            due.aim(steps, first, lane);
        }
        due
    }

    /// On to the next step of the line `first + lane`.
    pub fn advance(&mut self, steps: &Steps, first: usize, lane: usize) {
        self.next[lane] += 1;
        self.aim(steps, first, lane);
    }

    fn aim(&mut self, steps: &Steps, first: usize, lane: usize) {
        let (line, next) = (first + lane, self.next[lane]);
        self.sums[lane] = if next < steps.first[line + 1] {
            // A line's own sum and differences of the sum over all lines round differently: a step that was dealt
            // to the line must lie before its end.
            (steps.at(next) - steps.beam.before[line]).max(0.0).min(steps.beam.turned[line].next_down())
        } else {
            f64::INFINITY
        };
    }
}
