//! The values of an SSDD file, and what follows them.

use std::io::BufRead;

use super::header::SsddHeader;
use super::lines::NumberLines;
use crate::error::wrong;
use crate::interchange::Checked;

/// The values of each colour by the four angles, the first slowest; and the kind of a further data block.
pub fn all(
    lines: &mut NumberLines<impl BufRead>,
    header: &SsddHeader,
    bytes: usize,
) -> Checked<(Vec<Vec<f32>>, Option<String>)> {
    let (sizes, colours) = (header.sizes(), header.colours);
    let pixels = sizes.iter().try_fold(1, |product: usize, &size| product.checked_mul(size));
    let pixels = pixels.filter(|pixels| pixels.checked_mul(colours).is_some_and(|values| values <= bytes));
    let pixels = pixels.ok_or_else(|| {
        let sizes = sizes.map(|size| size.to_string()).join(" x ");
        format!("the lists of angles make {sizes} values, more than the file holds")
    })?;
    let mut total = vec![vec![0.0f32; pixels]; colours];
    let columns = sizes[2] * sizes[3];
    let more = each(lines, header, |row, column, colour, value| {
        total[colour][row * columns + column] = value;
    })?;
    Ok((total, more))
}

/// Visits the values: row (the first two angles), column (the others), colour. Returns the kind of a further data
/// block.
// Tested by `ssdd_says_what_it_does_not_read` (tests/it/interchange/interchange_ssdd.rs).
pub fn each(
    lines: &mut NumberLines<impl BufRead>,
    header: &SsddHeader,
    mut visit: impl FnMut(usize, usize, usize, f32),
) -> Checked<Option<String>> {
    let ([n0, n1, n2, n3], colours) = (header.sizes(), header.colours);
    let pixels = n0 * n1 * n2 * n3;
    let place = |count: usize| {
        let (i0, i1, rest) = (count % n0, count / n0 % n1, count / (n0 * n1));
        (i0 * n1 + i1, rest % n2 * n3 + rest / n2)
    };
    let positive = |value: f32| if value < 0.0 { 0.0 } else { value };
    if header.binary {
        let mut bytes = [0; 4];
        for at in 0..pixels * colours {
            let short = |_| format!("{} values of 4 bytes needed after `DATA binary`", pixels * colours);
            lines.file.read_exact(&mut bytes).map_err(short)?;
            let (row, column) = place(at / colours);
            visit(row, column, at % colours, positive(f32::from_le_bytes(bytes)));
        }
        return match lines.next()? {
            None => Ok(None),
            Some((_, line)) => Ok(Some(further(&line).ok_or_else(|| {
                format!("bytes after the {} values of 4 bytes after `DATA binary`", pixels * colours)
            })?)),
        };
    }
    let mut count = 0;
    while let Some((number, line)) = lines.next()? {
        if count == pixels
            && let Some(kind) = further(&line)
        {
            return Ok(Some(kind));
        }
        let wrong = || format!("line {number}: {pixels} lines of {colours} values needed");
        let mut found = 0;
        for cell in line.split_whitespace() {
            let value: f32 = cell.parse().map_err(|_| format!("line {number}: no number"))?;
            if found == colours || count == pixels {
                return Err(wrong().into());
            }
            let (row, column) = place(count);
            visit(row, column, found, positive(value));
            found += 1;
        }
        if found != colours {
            return Err(wrong().into());
        }
        count += 1;
    }
    if count == pixels { Ok(None) } else { Err(wrong!("{count} lines of values, {pixels} needed")) }
}

/// What a data block that begins with this line holds.
fn further(line: &str) -> Option<String> {
    let (key, kind) = line.split_once(char::is_whitespace)?;
    (key == "DATA_TYPE").then(|| format!("{:.40}", kind.trim()))
}
