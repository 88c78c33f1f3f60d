//! Height maps as a matrix of numbers: a row a line, as Gwyddion, SPIP and many other programs write them, and Arc grids.
//!
//! The comments of Gwyddion and SPIP (`head`) give size and unit; without them the campaign must. An Arc grid has its size at
//! the head (`ncols`, `nrows`, `cellsize` or `dx`, `dy`, `NODATA_value`); its first row is the one of largest y, and its cell
//! size is in the unit of its heights. Cells without data become NaN.

use super::fields::{cells, is_passed_over};
use super::head::Head;
use crate::surface::io::samples::{MapSamples, Stored};

/// Fewest columns of a matrix: fewer are no map.
pub const FEWEST_COLUMNS: usize = 8;

/// Names at the head of an Arc grid at most.
const MOST_NAMES: usize = 32;

/// Reads a matrix; the first line is y = 0.
pub fn read(text: &str) -> Result<MapSamples, String> {
    let (columns, heights) = rows(text)?;
    let rows = heights.len() / columns;
    let head = Head::of(text);
    head.check(columns, rows).map_err(|why| format!("matrix: {why}"))?;
    let mut map = MapSamples::new(columns, rows, heights, Stored::Exact);
    match head.sizes() {
        Ok(Some((size, unit_um))) => {
            map.pitch = [Some(size[0] / columns as f64), Some(size[1] / rows as f64)];
            map.unit_um = Some(unit_um);
        }
        Ok(None) => {
            map.no_pitch =
                Some(format!("a matrix of {columns} x {rows} heights without x y columns or sizes"))
        }
        Err(why) => map.no_pitch = Some(format!("a matrix of {columns} x {rows} heights: {why}")),
    }
    if let Some(voids) = head.voids() {
        map.notes.push(format!(
            "matrix: {voids} heights are void (voidpixels), which ones is not said: they count as they are"
        ));
    }
    Ok(map)
}

/// The columns and the heights of all rows.
fn rows(text: &str) -> Result<(usize, Vec<f64>), String> {
    let (mut heights, mut columns) = (Vec::new(), 0);
    // Whether a mark ends every row: nothing follows it.
    let mut ended = true;
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !is_passed_over(line)) {
        let before = heights.len();
        let mut last_is_empty = false;
        for field in cells(line) {
            last_is_empty = field.is_empty();
            match height(field) {
                Ok(height) => heights.push(height),
                // Words above the first row.
                Err(_) if columns == 0 => break,
                Err(_) => return Err(format!("matrix: line {}: `{field:.40}` is no number", index + 1)),
            }
        }
        let found = heights.len() - before;
        if columns == 0 && found < FEWEST_COLUMNS {
            heights.truncate(before);
            continue;
        }
        if columns > 0 && found != columns {
            return Err(format!("matrix: line {}: {found} numbers, the first row has {columns}", index + 1));
        }
        (columns, ended) = (found, ended && last_is_empty);
    }
    if columns == 0 {
        return Err("matrix: no row of numbers".into());
    }
    if ended {
        let mut column = 0;
        heights.retain(|_| {
            column = column % columns + 1;
            column != columns
        });
        columns -= 1;
    }
    Ok((columns, heights))
}

/// A height, or NaN where a cell is empty or says that it has none.
fn height(field: &str) -> Result<f64, std::num::ParseFloatError> {
    const NONE: [&str; 5] = ["", "bad", "n/a", "nodata", "no data"];
    if NONE.iter().any(|word| word.eq_ignore_ascii_case(field)) { Ok(f64::NAN) } else { field.parse() }
}

/// Reads an Arc grid.
pub fn read_arc_grid(text: &str) -> Result<MapSamples, String> {
    let mut words = text.split_whitespace().peekable();
    let mut head = Vec::new();
    while let Some(name) = words.next_if(|word| word.starts_with(|c: char| c.is_ascii_alphabetic())) {
        let name = name.to_ascii_lowercase();
        let text = words.next().unwrap_or("");
        let value: f64 =
            text.parse().map_err(|_| format!("Arc grid: {name:.40} = {text:.40}: must be a number"))?;
        head.push((name, value));
        if head.len() > MOST_NAMES {
            return Err(format!("Arc grid: more than {MOST_NAMES} names before the heights"));
        }
    }
    let value = |name: &str| head.iter().find(|(key, _)| key == name).map(|(_, value)| *value);
    let count = |name: &str| match value(name) {
        Some(count) if count >= 1.0 && count <= f64::from(u32::MAX) && count.fract() == 0.0 => {
            Ok(count as usize)
        }
        Some(count) => Err(format!("Arc grid: {name} = {count}: must be a whole number")),
        None => Err(format!("Arc grid: no {name}")),
    };
    let (columns, rows) = (count("ncols")?, count("nrows")?);
    let gap = value("nodata_value").unwrap_or(-9999.0);
    let mut heights = Vec::new();
    for (k, word) in words.enumerate() {
        let (row, column) = (k / columns, k % columns);
        let height: f64 = word
            .parse()
            .map_err(|_| format!("Arc grid: row {row}, column {column}: `{word:.40}` is no number"))?;
        heights.push(if height == gap { f64::NAN } else { height });
    }
    if columns.checked_mul(rows) != Some(heights.len()) {
        return Err(format!("Arc grid: {} heights do not make {columns} x {rows}", heights.len()));
    }
    let heights = heights.chunks(columns).rev().flatten().copied().collect();
    let pitch = [value("dx"), value("dy")].map(|own| own.or(value("cellsize")));
    let no_pitch = pitch.contains(&None).then(|| "Arc grid: no cellsize".into());
    Ok(MapSamples { pitch, no_pitch, ..MapSamples::new(columns, rows, heights, Stored::Exact) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 8 columns, 2 rows, height 10 row + column.
    fn rows(separator: &str) -> [String; 2] {
        [0, 10].map(|first| {
            (0..8).map(|column| (first + column).to_string()).collect::<Vec<_>>().join(separator)
        })
    }

    fn expected() -> Vec<f64> {
        [0, 10].into_iter().flat_map(|first| (0..8).map(move |column| f64::from(first + column))).collect()
    }

    #[test]
    fn a_matrix_reads_with_the_sizes_of_its_comments() {
        let [first, second] = rows("\t");
        let head = "# Channel: Height\n# Width: 12.00 \u{b5}m\n# Height: 4 um\n# Value units: m\n";
        let map = read(&format!("{head}{first}\n{second}\n")).expect("a matrix");
        assert_eq!((map.columns, map.rows, map.heights), (8, 2, expected()));
        // 1.5 um and 2 um in metres; two quotients round.
        for (found, expected) in map.pitch.iter().zip([1.5e-6, 2e-6]) {
            assert!((found.expect("a pitch") - expected).abs() < 4.0 * f64::EPSILON * expected);
        }
        assert_eq!(map.unit_um, Some(1e6));
        let bare = read(&format!("height map\n{first}\n{second}\n")).expect("a matrix");
        assert_eq!((bare.pitch, bare.rows), ([None, None], 2));
        assert!(bare.no_pitch.is_some_and(|why| why.contains("8 x 2 heights without x y columns")));
        let volts = read(&format!("{}{first}\n{second}\n", head.replace(": m", ": V"))).expect("a matrix");
        assert!(volts.no_pitch.is_some_and(|why| why.contains("`V` is no length")));
        let ragged = read(&format!("{first}\n{second} 3\n")).expect_err("ragged");
        assert!(ragged.contains("line 2: 9 numbers, the first row has 8"), "{ragged}");
    }

    #[test]
    fn a_matrix_of_spip_has_the_sizes_of_its_head() {
        // SPIP ends each row with a tab; its lengths are nm.
        let [first, second] = rows("\t").map(|row| row + "\t");
        let head = "# File Format = ASCII\n# x-pixels = 8\n# y-pixels = 2\n# x-length = 2000\n# y-length = 1000\n\
                    # z-unit = nm\n# voidpixels =0\n# description =0:\n# Start of Data:\n";
        let text = format!("{head}{first}\n{second}\n");
        let map = read(&text).expect("a matrix");
        assert_eq!((map.columns, map.rows, &map.heights), (8, 2, &expected()));
        assert_eq!((map.pitch, map.unit_um), ([Some(250.0), Some(500.0)], Some(1e-3)));
        assert!(map.notes.is_empty());
        // Pitches of 0.25 um and 0.5 um in m, and in steps of 0.5 nm: a few quotients and products round.
        for (unit, lengths, unit_um) in
            [("# z-unit = m", [0.25e-6, 0.5e-6], 1e6), ("# Bit2nm = 0.5", [500.0, 1000.0], 5e-4)]
        {
            let map = read(&text.replace("# z-unit = nm", unit)).expect("a matrix");
            let found = [map.pitch[0], map.pitch[1], map.unit_um].map(|value| value.expect("said"));
            for (found, wanted) in found.iter().zip([lengths[0], lengths[1], unit_um]) {
                assert!((found - wanted).abs() < 8.0 * f64::EPSILON * wanted, "{unit}: {found} {wanted}");
            }
        }
        let void = read(&text.replace("voidpixels =0", "voidpixels = 3")).expect("a matrix");
        assert!(void.notes[0].contains("3 heights are void"), "{:?}", void.notes);
        for (from, to, wanted) in [
            ("# z-unit = nm", "# z-unit = V", "z-unit `V` is no length"),
            ("# z-unit = nm\n", "", "no line `# z-unit =`"),
            ("x-length = 2000", "x-length = 0", "x-length = 0, y-length = 1000: not positive"),
            ("x-length = 2000", "x-length = 2,5", "x-length = 2,5: must be a number"),
        ] {
            let why = read(&text.replace(from, to)).expect("a matrix").no_pitch.expect("says so");
            assert!(why.contains(wanted), "{why}");
        }
        for (from, to, wanted) in [
            ("x-pixels = 8", "x-pixels = 9", "says x-pixels = 9, but 8 columns follow"),
            ("y-pixels = 2", "y-pixels = 3", "says y-pixels = 3, but 2 rows follow: the file is cut off"),
        ] {
            let why = read(&text.replace(from, to)).expect_err("must be refused");
            assert!(why.contains(wanted), "{why}");
        }
    }

    #[test]
    fn a_mark_at_the_end_of_every_row_ends_it() {
        for mark in ["\t", ";", ","] {
            let [first, second] = rows(mark).map(|row| row + mark);
            let map = read(&format!("{first}\r\n{second}\r\n")).expect("a matrix");
            assert_eq!((map.columns, map.rows, map.heights), (8, 2, expected()), "{mark:?}");
        }
    }

    #[test]
    fn cells_without_data_are_gaps() {
        for (line, gaps) in [
            ("0,1,,3,4,5,6,7", vec![2]),
            ("0;1;2;NaN;4;5;6;", vec![3, 7]),
            ("0\t1\tno data\t3\t4\tBAD\t6\t7", vec![2, 5]),
            ("0 1 nan 3 4 5 n/a 7", vec![2, 6]),
        ] {
            let map = read(&format!("{}\n{line}\n", rows(",")[0])).expect("a matrix");
            let found: Vec<usize> = (0..8).filter(|at| map.heights[8 + at].is_nan()).collect();
            assert_eq!((found, map.rows), (gaps, 2), "{line}");
        }
    }

    #[test]
    fn an_arc_grid_begins_at_the_top_and_names_its_gaps() {
        let [first, second] = rows(" ");
        let head = "ncols 8\nNROWS 2\nxllcorner 0\nyllcorner 0\ncellsize 0.5\nNODATA_value -9999\n";
        let map = read_arc_grid(&format!("{head}{second}\n{first}\n")).expect("a grid");
        assert_eq!((map.heights, map.pitch), (expected(), [Some(0.5), Some(0.5)]));
        let reason = |text: String| read_arc_grid(&text).expect_err("must be refused");
        // The grid begins at the top: row 1 of the map.
        let gap =
            read_arc_grid(&format!("{head}{}\n{first}\n", second.replace("13", "-9999"))).expect("a grid");
        let gaps: Vec<usize> = (0..16).filter(|at| gap.heights[*at].is_nan()).collect();
        assert_eq!(gaps, [8 + 3]);
        assert!(reason(format!("{head}{second}\n")).contains("8 heights do not make 8 x 2"));
        assert!(reason(format!("ncols 8\ncellsize 1\n{first}\n")).contains("no nrows"));
        assert!(reason("ncols 1e300\nnrows 2\n1\n".into()).contains("must be a whole number"));
    }
}
