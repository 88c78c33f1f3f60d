//! Height maps as text: a line `x y z` for each sample of a regular grid, in a row-by-row or column-by-column order.
//!
//! Numbers are parted by blanks, tabs, commas or semicolons; empty lines and those that begin with # are passed over,
//! and so is a first line of words. All three share one unit. The text is read twice, and only heights are kept.

use super::map_file::{MapFile, Stored};

/// How far, in pitches, a point may lie from its place on the grid.
const OFF_GRID: f64 = 0.01;

/// The grid that the order of the points spells out.
struct Layout {
    /// First point.
    origin: [f64; 2],
    /// Points in a run along the fast axis, and number of runs.
    fast: usize,
    slow: usize,
    /// 0: x runs fastest, 1: y.
    axis: usize,
    /// Steps along x and y.
    step: [f64; 2],
}

/// Whether the file's beginning reads as a line of three numbers.
pub fn looks_like(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    let text = String::from_utf8_lossy(head);
    text.lines().take(20).any(|line| numbers(line).is_some())
}

/// Reads a map; rows are turned so that x and y grow. Held by: `every_order_of_the_points_is_one_map`.
pub fn read(bytes: &[u8]) -> Result<MapFile, String> {
    let text =
        std::str::from_utf8(bytes).map_err(|e| format!("XYZ: byte {} is not UTF-8", e.valid_up_to()))?;
    let layout = layout(text)?;
    let (columns, rows) =
        if layout.axis == 0 { (layout.fast, layout.slow) } else { (layout.slow, layout.fast) };
    let mut heights = vec![0.0; columns * rows];
    for (k, point) in points(text).enumerate() {
        let (line, [x, y, z]) = point?;
        let (along, run) = (k % layout.fast, k / layout.fast);
        let (column, row) = if layout.axis == 0 { (along, run) } else { (run, along) };
        let off = |value: f64, index: usize, axis: usize| {
            let expected = layout.origin[axis] + index as f64 * layout.step[axis];
            (value - expected).abs() > OFF_GRID * layout.step[axis].abs()
        };
        if off(x, column, 0) || off(y, row, 1) {
            return Err(format!(
                "XYZ: line {line}: {x} {y} is not where a grid of {columns} x {rows} points has one"
            ));
        }
        let column = if layout.step[0] < 0.0 { columns - 1 - column } else { column };
        let row = if layout.step[1] < 0.0 { rows - 1 - row } else { row };
        heights[row * columns + column] = z;
    }
    let pitch = layout.step.map(|step| Some(step.abs()));
    Ok(MapFile { columns, rows, heights, stored: Stored::Exact, pitch })
}

/// Finds the grid: how long the first run is, and where the last point lies.
fn layout(text: &str) -> Result<Layout, String> {
    let mut all = points(text);
    let mut next = || all.next().transpose();
    let (Some((_, first)), Some((_, second))) = (next()?, next()?) else {
        return Err("XYZ: fewer than two points".into());
    };
    let axis = if second[0] != first[0] { 0 } else { 1 };
    // Along a run the other coordinate stays within a hundredth of the step.
    let slack = OFF_GRID * (second[axis] - first[axis]).abs();
    let (mut count, mut fast, mut last) = (2usize, None, second);
    let mut last_of_run = second;
    while let Some((_, point)) = next()? {
        if fast.is_none() {
            if (point[1 - axis] - first[1 - axis]).abs() > slack {
                fast = Some(count);
            } else {
                last_of_run = point;
            }
        }
        (count, last) = (count + 1, point);
    }
    let fast = fast.unwrap_or(count);
    if !count.is_multiple_of(fast) || fast < 2 || count == fast {
        return Err(format!("XYZ: {count} points are no whole number of runs of {fast}, or a single run"));
    }
    let slow = count / fast;
    let mut step = [0.0; 2];
    step[axis] = (last_of_run[axis] - first[axis]) / (fast - 1) as f64;
    step[1 - axis] = (last[1 - axis] - first[1 - axis]) / (slow - 1) as f64;
    match step.iter().find(|step| !step.is_finite() || **step == 0.0) {
        Some(_) => Err("XYZ: the points lie on one line".into()),
        None => Ok(Layout { origin: [first[0], first[1]], fast, slow, axis, step }),
    }
}

/// The points with their lines.
fn points(text: &str) -> impl Iterator<Item = Result<(usize, [f64; 3]), String>> + '_ {
    let lines = text.lines().enumerate().filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let read = |(k, (index, line)): (usize, (usize, &str))| match numbers(line) {
        Some(point) if point.iter().all(|value| value.is_finite()) => Some(Ok((index + 1, point))),
        None if k == 0 && !line.trim().starts_with(|c: char| c.is_ascii_digit() || c == '-') => None,
        _ => Some(Err(format!("XYZ: line {}: three finite numbers x y z are expected", index + 1))),
    };
    lines.enumerate().filter_map(read)
}

/// A line of exactly three numbers.
fn numbers(line: &str) -> Option<[f64; 3]> {
    let parted = |c: char| c.is_whitespace() || c == ',' || c == ';';
    let mut fields = line.split(parted).filter(|field| !field.is_empty());
    let mut number = || fields.next()?.parse::<f64>().ok();
    let point = [number()?, number()?, number()?];
    fields.next().is_none().then_some(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 columns by 2 rows, pitches 0.5 and 2, height = 10 row + column.
    fn expected() -> MapFile {
        let heights = vec![0.0, 1.0, 2.0, 10.0, 11.0, 12.0];
        MapFile { columns: 3, rows: 2, heights, stored: Stored::Exact, pitch: [Some(0.5), Some(2.0)] }
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
        let backwards = [(2, 1), (2, 0), (1, 1), (1, 0), (0, 1), (0, 0)];
        for (order, separator) in [(rows, " "), (columns, "\t"), (downwards, ", "), (backwards, ";")] {
            assert_eq!(read(text(&order, separator).as_bytes()), Ok(expected()));
        }
        let dressed = format!("x [um], y, z\n\n# a comment\n{}\r\n\n", text(&rows, " "));
        assert_eq!(read(dressed.as_bytes()), Ok(expected()));
        assert!(looks_like(dressed.as_bytes()) && !looks_like(b"GIF89a"));
    }

    #[test]
    fn points_that_are_no_grid_are_refused_with_their_line() {
        let good = text(&[(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)], " ");
        let reason = |text: &str| read(text.as_bytes()).expect_err("must be refused");
        assert!(reason(&good.replace("7.5 0 11", "7.6 0 11")).contains("line 5: 7.6 0 is not where"));
        assert!(reason(&good.replace("8 0 12", "8 0")).contains("line 6: three finite numbers"));
        assert!(reason(&good.replace("12", "inf")).contains("line 6"));
        assert!(reason(&good.replace("\n8 0 12", "")).contains("5 points are no whole number of runs of 3"));
        assert!(reason("1 2 3").contains("fewer than two"));
        assert!(reason("1 2 3\n1 2 4\n1 2 5").contains("runs"));
        assert!(reason("0 0 1\n1 0 1\n2 0 1").contains("single run"));
        assert!(read(b"0 0 1\n\xff").expect_err("no text").contains("byte 6 is not UTF-8"));
    }
}
