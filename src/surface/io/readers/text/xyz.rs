//! Height maps as text: a line `x y z` for each sample of a regular grid, row by row or column by column, to and fro or
//! not.
//!
//! Fields are parted as `fields` says; empty lines and those that begin with # are passed over, and so is a
//! first line of words. All three share one unit. The text is read twice, and only heights are kept. Files of Zygo's
//! `XYZ Data File` have a head and count pixels in x and y. Points that are not there, or have no data, become NaN.

use super::fields::{fields, is_passed_over};
use crate::surface::io::samples::{MapSamples, Stored};

/// How far, in pitches, a point may lie from its place on the grid.
const OFF_GRID: f64 = 0.01;
/// Lines of a Zygo head at most.
const LONGEST_HEAD: usize = 40;

/// The grid that the points spell out.
struct PointGrid {
    /// Columns and rows.
    counts: [usize; 2],
    /// Smallest x and y.
    origin: [f64; 2],
    /// Steps along x and y.
    step: [f64; 2],
}

/// Reads a map; rows are turned so that x and y grow.
// Tested by `every_order_of_the_points_is_one_map`.
pub fn read(text: &str) -> Result<MapSamples, String> {
    gridded("XYZ", points(text, 0))
}

/// Reads the points of a Zygo instrument: column, row, height, or `No Data`.
pub fn read_zygo(text: &str) -> Result<MapSamples, String> {
    let heads = text.lines().take(LONGEST_HEAD);
    let is_point = |line: &str| point(line).is_some();
    // The head ends with a line #, or where the points begin.
    let marked = heads.clone().position(|line| line.trim() == "#").map(|index| index + 1);
    let begin = marked.or_else(|| heads.clone().position(is_point)).ok_or("Zygo XYZ: no points")?;
    let map = gridded("Zygo XYZ", points(text, begin))?;
    // Line 8: source, scale, wavelength, aperture, obliquity, magnification, metres a pixel.
    let camera = text.lines().nth(7).and_then(|line| line.split_whitespace().nth(6)).filter(|_| begin > 7);
    Ok(match camera.and_then(|text| text.parse::<f64>().ok()) {
        Some(pitch) if pitch > 0.0 => map.with_units("Zygo XYZ", [pitch; 2], ["m", "m"], "um"),
        _ => {
            let no_pitch = Some("Zygo XYZ: x and y count pixels, of which the head has no size".into());
            MapSamples { pitch: [None, None], no_pitch, unit_um: Some(1.0), ..map }
        }
    })
}

/// Puts points on the grid that they spell out; `kind` begins every reason.
fn gridded(
    kind: &str,
    all: impl Iterator<Item = Result<(usize, [f64; 3]), String>> + Clone,
) -> Result<MapSamples, String> {
    let PointGrid { counts: [columns, rows], origin, step } =
        layout(all.clone()).map_err(|why| format!("{kind}: {why}"))?;
    let cells = columns.checked_mul(rows).ok_or_else(|| format!("{kind}: the points are no grid"))?;
    let mut lines = vec![0u32; cells];
    let mut heights = vec![f64::NAN; cells];
    for found in all {
        let (line, [x, y, z]) = found.map_err(|why| format!("{kind}: {why}"))?;
        let place = |value: f64, axis: usize| {
            let at = (value - origin[axis]) / step[axis];
            let near = (at - at.round()).abs() <= OFF_GRID;
            (near && at.round() < counts_of(axis, columns, rows)).then_some(at.round() as usize)
        };
        let (Some(column), Some(row)) = (place(x, 0), place(y, 1)) else {
            return Err(format!(
                "{kind}: line {line}: {x} {y} is not where a grid of {columns} x {rows} points has one"
            ));
        };
        let at = row * columns + column;
        if lines[at] != 0 {
            return Err(format!("{kind}: line {line}: {x} {y} is there twice, as in line {}", lines[at]));
        }
        (lines[at], heights[at]) = (u32::try_from(line).unwrap_or(u32::MAX), z);
    }
    let pitch = step.map(Some);
    Ok(MapSamples { pitch, ..MapSamples::new(columns, rows, heights, Stored::Exact) })
}

fn counts_of(axis: usize, columns: usize, rows: usize) -> f64 {
    [columns, rows][axis] as f64
}

/// Finds the grid: how many runs there are along the fast axis, how long the longest is, and how far all reach.
fn layout(all: impl Iterator<Item = Result<(usize, [f64; 3]), String>>) -> Result<PointGrid, String> {
    let mut all = all;
    let mut next = || all.next().transpose();
    let (Some((_, first)), Some((_, second))) = (next()?, next()?) else {
        return Err("fewer than two points".into());
    };
    let axis = if second[0] != first[0] { 0 } else { 1 };
    // Along a run the other coordinate stays within a hundredth of the step.
    let slack = OFF_GRID * (second[axis] - first[axis]).abs();
    let (mut low, mut high) =
        ([0, 1].map(|k| first[k].min(second[k])), [0, 1].map(|k| first[k].max(second[k])));
    let (mut count, mut run, mut runs, mut longest) = (2usize, 2usize, 1usize, 2usize);
    let mut of_run = first[1 - axis];
    while let Some((_, point)) = next()? {
        if (point[1 - axis] - of_run).abs() > slack {
            (of_run, run, runs) = (point[1 - axis], 0, runs + 1);
        }
        run += 1;
        longest = longest.max(run);
        count += 1;
        for k in [0, 1] {
            (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
        }
    }
    if runs == 1 {
        return Err(format!("{count} points are a single run, no grid of several runs"));
    }
    // Each run may lack a few points, not most of them: else they are no grid at all.
    if longest * runs > 2 * count {
        return Err(format!("{count} points are no grid: {runs} runs, the longest of {longest}"));
    }
    let mut counts = [longest, runs];
    if axis == 1 {
        counts.swap(0, 1);
    }
    let step = [0, 1].map(|k| (high[k] - low[k]) / (counts[k].max(2) - 1) as f64);
    match step.iter().find(|step| !step.is_finite() || **step == 0.0) {
        Some(_) => Err("the points lie on one line".into()),
        None => Ok(PointGrid { counts, origin: low, step }),
    }
}

/// The points with their lines, from line `begin` on (the first is 0).
fn points(text: &str, begin: usize) -> impl Iterator<Item = Result<(usize, [f64; 3]), String>> + Clone + '_ {
    let lines = text.lines().enumerate().skip(begin).filter(|(_, line)| !is_passed_over(line));
    let read = |(k, (index, line)): (usize, (usize, &str))| match point(line) {
        Some([x, y, z]) if x.is_finite() && y.is_finite() && !z.is_infinite() => {
            Some(Ok((index + 1, [x, y, z])))
        }
        None if k == 0 && !line.trim().starts_with(|c: char| c.is_ascii_digit() || c == '-') => None,
        _ => Some(Err(format!("line {}: three finite numbers x y z are expected", index + 1))),
    };
    lines.enumerate().filter_map(read)
}

/// A line of exactly three numbers, of which the last may be missing: `No Data` and `BAD` are NaN.
fn point(line: &str) -> Option<[f64; 3]> {
    let line = line.trim_end();
    if let Some(place) = ["No Data", "BAD"].iter().find_map(|word| line.strip_suffix(word)) {
        let mut fields = fields(place);
        let mut number = || fields.next()?.parse::<f64>().ok();
        let point = [number()?, number()?, f64::NAN];
        return fields.next().is_none().then_some(point);
    }
    let mut fields = fields(line);
    let mut number = || fields.next()?.parse::<f64>().ok();
    let point = [number()?, number()?, number()?];
    fields.next().is_none().then_some(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 columns by 2 rows, pitches 0.5 and 2, height = 10 row + column.
    fn expected() -> MapSamples {
        let heights = vec![0.0, 1.0, 2.0, 10.0, 11.0, 12.0];
        MapSamples { pitch: [Some(0.5), Some(2.0)], ..MapSamples::new(3, 2, heights, Stored::Exact) }
    }

    fn text(order: &[(usize, usize)], separator: &str) -> String {
        let line = |&(column, row): &(usize, usize)| {
            let numbers = [7.0 + 0.5 * column as f64, -2.0 + 2.0 * row as f64, (10 * row + column) as f64];
            numbers.map(|value| value.to_string()).join(separator)
        };
        order.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn every_order_of_the_points_is_one_map() {
        let rows = [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)];
        let columns = [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)];
        let downwards = [(0, 1), (1, 1), (2, 1), (0, 0), (1, 0), (2, 0)];
        let to_and_fro = [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1)];
        let backwards = [(2, 1), (2, 0), (1, 1), (1, 0), (0, 1), (0, 0)];
        for (order, separator) in
            [(rows, " "), (columns, "\t"), (downwards, ", "), (backwards, ";"), (to_and_fro, ",")]
        {
            assert_eq!(read(&text(&order, separator)), Ok(expected()));
        }
        let dressed = format!("x [um], y, z\n\n# a comment\n{}\r\n\n", text(&rows, " "));
        assert_eq!(read(&dressed), Ok(expected()));
    }

    #[test]
    fn points_that_are_no_grid_are_refused_with_their_line() {
        let good = text(&[(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)], " ");
        let reason = |text: &str| read(text).expect_err("must be refused");
        assert!(reason(&good.replace("7.5 0 11", "7.6 0 11")).contains("line 5: 7.6 0 is not where"));
        assert!(reason(&good.replace("8 0 12", "8 0")).contains("line 6: three finite numbers"));
        assert!(reason(&good.replace("12", "inf")).contains("line 6"));
        assert!(
            reason(&good.replace("8 0 12", "7.5 0 12"))
                .contains("line 6: 7.5 0 is there twice, as in line 5")
        );
        assert!(reason("1 2 3").contains("fewer than two"));
        assert!(reason("1 2 3\n1 2 4\n1 2 5").contains("runs"));
        assert!(reason("0 0 1\n1 0 1\n2 0 1").contains("single run"));
        assert!(reason("0,5 0,5 1\n1,0 0,5 1").contains("line 1: three finite numbers"));
    }

    #[test]
    fn points_that_are_not_there_are_gaps() {
        let good = text(&[(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)], " ");
        for (from, to, at) in [
            ("\n8 0 12", "", 5),
            ("\n7.5 -2 1", "", 1),
            ("7.5 0 11", "7.5 0 nan", 4),
            ("7 0 10", "7 0 No Data", 3),
        ] {
            let map = read(&good.replace(from, to)).expect("a grid");
            let gaps: Vec<usize> = (0..6).filter(|at| map.heights[*at].is_nan()).collect();
            assert_eq!(gaps, [at], "{from:?} -> {to:?}");
        }
    }

    #[test]
    fn the_points_of_a_zygo_instrument_count_pixels_and_have_gaps() {
        let head = "Zygo XYZ Data File - Format 1\n0 0 0 0 \"\"\n0 0 3 2\n\"text\"\n";
        let points = "0 0 0.5\n1 0 1\n2 0 2\n0 1 10\n1 1 11\n2 1 12\n";
        for end in ["", "#\n"] {
            let map = read_zygo(&format!("{head}{end}{points}{end}")).expect("points");
            assert_eq!((map.columns, map.rows, map.pitch), (3, 2, [None, None]));
            assert_eq!(map.heights, [0.5, 1.0, 2.0, 10.0, 11.0, 12.0]);
            assert!(map.no_pitch.is_some_and(|why| why.contains("count pixels")));
        }
        let gap = read_zygo(&format!("{head}{}", points.replace("1 1 11", "1 1 No Data"))).expect("points");
        assert!(gap.heights[4].is_nan() && gap.heights[5] == 12.0);
    }
}
