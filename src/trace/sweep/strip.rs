//! What parallel lines cross between two neighbouring columns: the same for all of them.
//!
//! Lines one cell apart pass every column at the same fraction of a cell, so they cross edges and diagonals at the
//! same places, each shifted by whole cells. One list of segments serves all lines of a sweep.

/// Most segments between two columns: a row edge is crossed at most once, and a diagonal in each of the two cells.
pub(super) const MOST: usize = 4;
/// Heights that a row of a strip needs beyond one for each line: from the cell before the base to the end of the
/// cell after it.
pub(super) const MARGIN: usize = 3;

/// The way of a line from one column (in the axis that it runs along) to the next.
///
/// "Along" is the axis that lines run along, "across" the other one; line j lies j cells across from line 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strip {
    /// Column of cells, along.
    pub column: usize,
    /// The cell across in which line 0 begins.
    pub base: usize,
    /// Where it begins in that cell, [0, 1).
    pub begin: f64,
    segments: [Segment; MOST],
    count: usize,
}

/// A straight piece of a line over one facet.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Segment {
    /// Its cell across, relative to the base: -1, 0 or 1.
    pub cell: i32,
    /// Whether its facet is the upper one.
    pub upper: bool,
    /// Share of the strip at its begin and at its end.
    pub from: f64,
    /// See `from`.
    pub to: f64,
    /// The point where it ends.
    pub end: Crossing,
}

/// A point on an edge or diagonal, between two heights.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Crossing {
    /// (0: the column's lower edge, 1: its upper edge; heights across from the cell before the base).
    pub near: (usize, usize),
    /// The other end.
    pub far: (usize, usize),
    /// Share of `far`.
    pub weight: f64,
}

/// How lines run through the columns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    /// Whether they run to growing columns.
    pub forward: bool,
    /// Cells across per column, [-1, 1].
    pub slope: f64,
    /// Where line 0 crosses the edge of column 0, across.
    pub offset: f64,
    /// Columns of the field, and cells across.
    pub cells: (usize, usize),
}

impl Course {
    /// The strip number `index`; negative ones come before the counted ones.
    pub fn strip(&self, index: i64) -> Strip {
        let across = self.offset + index as f64 * self.slope;
        let base = across.floor();
        let column = if self.forward { index } else { -1 - index };
        let begin = across - base;
        let mut strip = Strip {
            column: column.rem_euclid(self.cells.0 as i64) as usize,
            base: (base as i64).rem_euclid(self.cells.1 as i64) as usize,
            begin,
            segments: [Segment::default(); MOST],
            count: 0,
        };
        let end = begin + self.slope;
        let last = column_edge(usize::from(self.forward), 0, end);
        if end > 1.0 {
            let t = (1.0 - begin) / self.slope;
            self.cross_cell(&mut strip, 0, (0.0, t), row_edge(1, self.along(t)));
            self.cross_cell(&mut strip, 1, (t, 1.0), column_edge(usize::from(self.forward), 1, end - 1.0));
        } else if end < 0.0 {
            let t = begin / -self.slope;
            self.cross_cell(&mut strip, 0, (0.0, t), row_edge(0, self.along(t)));
            self.cross_cell(&mut strip, -1, (t, 1.0), column_edge(usize::from(self.forward), -1, end + 1.0));
        } else {
            self.cross_cell(&mut strip, 0, (0.0, 1.0), last);
        }
        strip
    }

    /// Where a line is in its column, [0, 1], after the share `t` of the strip.
    pub fn along(&self, t: f64) -> f64 {
        if self.forward { t } else { 1.0 - t }
    }

    /// Where it is across in the cell `cell` of the strip.
    pub fn across(&self, strip: &Strip, cell: i32, t: f64) -> f64 {
        strip.begin + t * self.slope - f64::from(cell)
    }

    /// Adds the one or two segments of a cell.
    fn cross_cell(&self, strip: &mut Strip, cell: i32, (from, to): (f64, f64), end: Crossing) {
        // Beyond the diagonal where positive.
        let side = |t: f64| self.along(t) + self.across(strip, cell, t) - 1.0;
        let (enters, leaves) = (side(from), side(to));
        let upper = enters > 0.0 || (enters == 0.0 && leaves > 0.0);
        if (enters < 0.0 && leaves > 0.0) || (enters > 0.0 && leaves < 0.0) {
            let t = from + (to - from) * (enters / (enters - leaves));
            let diagonal = diagonal(cell, self.across(strip, cell, t));
            strip.push(Segment { cell, upper, from, to: t, end: diagonal });
            strip.push(Segment { cell, upper: !upper, from: t, to, end });
        } else {
            strip.push(Segment { cell, upper, from, to, end });
        }
    }
}

impl Strip {
    /// Its segments in order.
    pub fn segments(&self) -> &[Segment] {
        &self.segments[..self.count]
    }

    fn push(&mut self, segment: Segment) {
        self.segments[self.count] = segment;
        self.count += 1;
    }
}

fn column_edge(edge: usize, cell: i32, weight: f64) -> Crossing {
    let at = (cell + 1) as usize;
    Crossing { near: (edge, at), far: (edge, at + 1), weight }
}

/// The edge between the cells across `cell` - 1 and `cell`.
fn row_edge(cell: i32, weight: f64) -> Crossing {
    let at = (cell + 1) as usize;
    Crossing { near: (0, at), far: (1, at), weight }
}

fn diagonal(cell: i32, weight: f64) -> Crossing {
    let at = (cell + 1) as usize;
    Crossing { near: (1, at), far: (0, at + 1), weight }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Segments follow each other without a gap, and each lies in the facet that it names: its middle says so.
    #[test]
    fn segments_lie_in_the_facets_that_they_name() {
        for slope in [0.0, 1.0, -1.0, 0.3, -0.7, 1e-17, -1e-17, 0.999_999_9] {
            for (forward, offset) in
                [(true, 0.0), (true, 0.37), (false, 0.37), (false, 0.999_999_999), (true, 1e-18)]
            {
                let course = Course { forward, slope, offset, cells: (7, 5) };
                for index in -20..20 {
                    let strip = course.strip(index);
                    let mut at = 0.0;
                    for segment in strip.segments() {
                        assert_eq!(segment.from, at);
                        at = segment.to;
                        let t = 0.5 * (segment.from + segment.to);
                        let (u, v) = (course.along(t), course.across(&strip, segment.cell, t));
                        // Coordinates below 20: a few roundings.
                        let rounding = 64.0 * f64::EPSILON;
                        assert!(v >= -rounding && v <= 1.0 + rounding, "{v}");
                        let beyond = u + v - 1.0;
                        assert!(
                            if segment.upper { beyond >= -rounding } else { beyond <= rounding },
                            "{beyond}"
                        );
                    }
                    assert_eq!(at, 1.0);
                }
            }
        }
    }
}
