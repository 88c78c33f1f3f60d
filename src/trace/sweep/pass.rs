//! A group of lines carried through the strips: heights at the crossings, and the starts found there.

use pulp::{Arch, NullaryFnOnce};

use super::beam::{Carried, Heights, LINES, positive};
use super::lines::Sweep;
use super::steps::{Due, Steps};
use super::strip::{MARGIN, MOST, Segment, Strip};
use crate::trace::walk::{Facet, Place};

/// Lines that are looked at together for a start that is due.
const GROUP: usize = 16;

/// A group of neighbouring lines on their way.
pub(super) struct Pass<'s> {
    sweep: &'s Sweep<'s>,
    arch: Arch,
    first: usize,
    /// Heights along the two edges of the present column.
    edges: [[f64; LINES + MARGIN]; 2],
    /// Heights of the lines at the begin of the present strip and at the end of each of its segments.
    pub heights: Heights,
}

impl<'s> Pass<'s> {
    /// The lines from `first` on, before strip `index`. Their heights there are those at the end of the strip
    /// before, as in a pass that comes from further away: rounding must not tell the two apart.
    pub fn new(sweep: &'s Sweep<'s>, first: usize, index: i64) -> Self {
        let edges = [[0.0; LINES + MARGIN]; 2];
        let mut pass = Pass { sweep, arch: Arch::new(), first, edges, heights: [[0.0; LINES]; MOST + 1] };
        let strip = pass.enter(index - 1);
        pass.leave(&strip);
        pass
    }

    /// Computes the heights at the ends of the segments of strip `index`.
    pub fn enter(&mut self, index: i64) -> Strip {
        let course = &self.sweep.course;
        let strip = course.strip(index);
        let (columns, across) = course.cells;
        // From the cell before the base.
        let left = (self.first + strip.base + across - 1) % across;
        for (edge, column) in self.edges.iter_mut().zip([strip.column, (strip.column + 1) % columns]) {
            copy_wrapped(self.sweep.layout.column(column, across, self.sweep.along_x), left, edge);
        }
        let (edges, heights) = (&self.edges, &mut self.heights);
        self.arch.dispatch(Interpolate { edges, strip: &strip, heights });
        strip
    }

    /// The end of this strip is the begin of the next.
    pub fn leave(&mut self, strip: &Strip) {
        self.heights.swap(0, strip.segments().len());
    }

    /// Visits the starts that lie in this strip, which takes a light's lines from `before` to `after`.
    pub fn take_due(
        &self,
        strip: &Strip,
        (steps, due): (&Steps, &mut Due),
        before: &Carried,
        after: &Carried,
        visit: &mut impl FnMut(Place, bool),
    ) {
        for group in (0..LINES).step_by(GROUP) {
            let pairs = after.sums[group..group + GROUP].iter().zip(&due.sums[group..group + GROUP]);
            let mut found =
                pairs.enumerate().fold(0, |found, (k, (sum, due))| found | (u32::from(sum > due) << k));
            while found != 0 {
                let lane = group + found.trailing_zeros() as usize;
                self.starts_of_line((strip, lane), (steps, due), before, visit);
                found &= found - 1;
            }
        }
    }

    /// Follows one line through the strip once more, and visits its starts.
    fn starts_of_line(
        &self,
        (strip, lane): (&Strip, usize),
        (steps, due): (&Steps, &mut Due),
        before: &Carried,
        visit: &mut impl FnMut(Place, bool),
    ) {
        let beam = steps.beam;
        let (mut sum, mut depth) = (before.sums[lane], before.depths[lane]);
        for (k, segment) in strip.segments().iter().enumerate() {
            let change =
                beam.reach * (self.heights[k + 1][lane] - self.heights[k][lane]) + beam.rise_over(segment);
            let end = sum + positive(change);
            while due.sums[lane] < end {
                let beyond = due.sums[lane] - sum;
                visit(self.place((strip, k), lane, beyond / change), beyond >= depth);
                due.advance(steps, self.first, lane);
            }
            sum = end;
            depth = positive(depth - change);
        }
    }

    /// The point of line `lane` after the share `part` of segment `k`.
    fn place(&self, (strip, k): (&Strip, usize), lane: usize, part: f64) -> Place {
        let Sweep { along_x, course, .. } = self.sweep;
        let segment = &strip.segments()[k];
        let across = course.cells.1;
        let cell =
            (strip.base + self.first + lane + across).wrapping_add_signed(segment.cell as isize) % across;
        let t = segment.from + (segment.to - segment.from) * part;
        // Rounding may put the ends of a segment a little outside.
        let along = course.along(t).clamp(0.0, 1.0);
        let beside = course.across(strip, segment.cell, t).clamp(0.0, 1.0);
        let z = self.heights[k][lane] + part * (self.heights[k + 1][lane] - self.heights[k][lane]);
        let (x, y, u, v) =
            if *along_x { (strip.column, cell, along, beside) } else { (cell, strip.column, beside, along) };
        Place { facet: Facet { x, y, upper: segment.upper }, u, v, z }
    }
}

/// The heights at the ends of a strip's segments.
struct Interpolate<'s> {
    edges: &'s [[f64; LINES + MARGIN]; 2],
    strip: &'s Strip,
    heights: &'s mut Heights,
}

impl NullaryFnOnce for Interpolate<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (Segment { end, .. }, heights) in self.strip.segments().iter().zip(&mut self.heights[1..]) {
            let near = &self.edges[end.near.0][end.near.1..][..LINES];
            let far = &self.edges[end.far.0][end.far.1..][..LINES];
            for ((height, near), far) in heights.iter_mut().zip(near).zip(far) {
                *height = near + end.weight * (far - near);
            }
        }
    }
}

fn copy_wrapped(row: &[f64], first: usize, into: &mut [f64]) {
    let (mut from, mut done) = (first, 0);
    while done < into.len() {
        let length = (row.len() - from).min(into.len() - done);
        into[done..done + length].copy_from_slice(&row[from..from + length]);
        done += length;
        from = 0;
    }
}
