//! Height maps as text, distinguished by how they begin: lines of x y z, a matrix of heights, an Arc grid, or the
//! points of a Zygo instrument.
//!
//! Text that has no byte order mark and is not UTF-8 is read as Latin-1, which is what older instruments write their
//! `µm` in.

mod fields;
mod head;
mod matrix;
mod xyz;

use super::{MapReader, UNKNOWN};
use crate::error::Checked;
use crate::files::memory;
use crate::surface::io::samples::MapSamples;
use crate::text_decoding::decode_text_or_latin1;
use fields::{fields, is_passed_over};

/// Lines looked at for the first numbers.
const LONGEST_HEADING: usize = 64;

pub struct Text;

impl MapReader for Text {
    fn name(&self) -> &'static str {
        "text"
    }

    fn accepts(&self, _: &[u8]) -> bool {
        true
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        // A text of another encoding, and a list of f64 that grows.
        Ok(2 * bytes.len() as u64 + 3 * 8 * memory::words(bytes))
    }

    fn read(&self, bytes: &[u8], _: Option<&str>) -> Checked<MapSamples> {
        Ok(read(&decode_text_or_latin1(bytes)?).ok_or(UNKNOWN)??)
    }
}

/// Reads a map from text; `None` where nothing in it looks like one.
fn read(text: &str) -> Option<Result<MapSamples, String>> {
    let beginning = text.trim_start();
    if beginning.starts_with("Zygo XYZ") {
        return Some(xyz::read_zygo(text));
    }
    if beginning.get(..5).is_some_and(|word| word.eq_ignore_ascii_case("ncols")) {
        return Some(matrix::read_arc_grid(text));
    }
    let heading = text.lines().take(LONGEST_HEADING).filter(|line| !is_passed_over(line));
    let mut lengths = heading.filter_map(|line| {
        let parsed: Option<Vec<f64>> = fields(line).map(|field| field.parse().ok()).collect();
        parsed.map(|numbers| numbers.len())
    });
    match lengths.find(|&length| length > 1) {
        Some(3) => Some(xyz::read(text)),
        Some(length) if length >= matrix::FEWEST_COLUMNS => Some(matrix::read(text)),
        Some(length) => Some(Err(format!(
            "lines of {length} numbers: neither x y z nor a matrix of {} columns or more",
            matrix::FEWEST_COLUMNS
        ))),
        None if has_decimal_commas(text) => {
            Some(Err("numbers with decimal commas; write them with points".into()))
        }
        None => None,
    }
}

fn has_decimal_commas(text: &str) -> bool {
    let decimal =
        |field: &str| field.matches(',').count() == 1 && field.replace(',', ".").parse::<f64>().is_ok();
    let mut lines = text.lines().take(LONGEST_HEADING).filter(|line| !is_passed_over(line));
    lines.any(|line| {
        fields(line).count() > 1 && fields(line).all(|field| field.parse::<f64>().is_ok() || decimal(field))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_that_is_no_map_is_told_what_it_is() {
        let reason = |text: &str| read(text).expect("text of numbers").expect_err("must be refused");
        assert!(reason("1 2 3 4\n5 6 7 8\n").contains("lines of 4 numbers: neither x y z nor a matrix"));
        assert!(reason("0,5\t1,0\t0,1\n").contains("decimal commas"));
        assert!(read("GIF89a, and so on\n").is_none());
    }
}
