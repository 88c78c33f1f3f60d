//! Gwyddion simple field (`.gsf`): a text header, NUL bytes up to a multiple of four, then f32 samples.
//!
//! The header is the line `Gwyddion Simple Field 1.0` and lines `name = value`: XRes, YRes (samples), XReal, YReal
//! (size of the field), XYUnits, ZUnits. Source: the format's specification in Gwyddion's user guide.

use super::{MapReader, units};
use crate::error::Checked;
use crate::surface::io::samples::{MapSamples, Stored};
use crate::text_decoding::decode_text_or_latin1;

/// The first line.
const MAGIC: &[u8] = b"Gwyddion Simple Field 1.0\n";
/// The keys that are read.
const KEYS: [&str; 6] = ["XRes", "YRes", "XReal", "YReal", "XYUnits", "ZUnits"];
/// Longest header that is looked through.
const LONGEST_HEADER: usize = 1 << 16;

pub struct Gsf;

impl MapReader for Gsf {
    fn name(&self) -> &'static str {
        "GSF"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(MAGIC)
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        Ok(4 * bytes.len() as u64)
    }

    fn read(&self, bytes: &[u8], _: Option<&str>) -> Checked<MapSamples> {
        Ok(read(bytes)?)
    }
}

/// Reads a field; row 0 of the file is y = 0.
///
/// Pitches are XReal/XRes and YReal/YRes in the unit of the heights: both units must be lengths (with an SI prefix), or
/// both be left out.
// Tested by `a_gwyddion_field_reads_with_its_pitches`.
fn read(bytes: &[u8]) -> Result<MapSamples, String> {
    let head = &bytes[..bytes.len().min(LONGEST_HEADER)];
    let end = head.iter().position(|&byte| byte == 0).ok_or("GSF: the header does not end")?;
    let text = decode_text_or_latin1(&head[..end])?;
    // Titles and notes of other programs may come several times: nothing follows from them.
    let values = |name: &'static str| {
        let lines = text.lines().skip(1).filter_map(|line| line.split_once('='));
        lines.filter(move |(key, _)| key.trim() == name).map(|(_, value)| value.trim())
    };
    for name in KEYS {
        let mut values = values(name);
        if let (Some(first), Some(second)) = (values.next(), values.next()) {
            return Err(format!("GSF: {name} is there twice: {first:.40} and {second:.40}; leave one"));
        }
    }
    let value = |name: &'static str| values(name).next();
    let samples = |name: &'static str| {
        let given = value(name).ok_or_else(|| format!("GSF: no {name}"))?;
        let count: usize =
            given.parse().map_err(|_| format!("GSF: {name} = {given:.40}: must be a whole number"))?;
        if count > 0 { Ok(count) } else { Err(format!("GSF: {name} = 0")) }
    };
    let (columns, rows) = (samples("XRes")?, samples("YRes")?);
    // One to four NULs: the data begin at a multiple of four.
    let start = end + 4 - end % 4;
    let data = bytes.get(start..).unwrap_or_default();
    let expected = columns.checked_mul(rows).and_then(|count| count.checked_mul(4));
    if expected != Some(data.len()) {
        return Err(format!("GSF: {} bytes of data do not make {columns} x {rows} f32 samples", data.len()));
    }
    let (lateral, height) = (value("XYUnits").unwrap_or(""), value("ZUnits").unwrap_or(""));
    let size = |name: &'static str, count: usize| -> Result<Option<f64>, String> {
        let Some(given) = value(name) else { return Ok(None) };
        let size: f64 = given.parse().map_err(|_| format!("GSF: {name} = {given:.40}: must be a number"))?;
        Ok(Some(size / count as f64))
    };
    let sizes = [("XReal", size("XReal", columns)?), ("YReal", size("YReal", rows)?)];
    let missing = sizes.iter().find(|(_, size)| size.is_none()).map(|(name, _)| format!("GSF: no {name}"));
    let (ratio, no_pitch) = match (missing, units::ratio(lateral, height)) {
        (None, Ok(ratio)) => (Some(ratio), None),
        (Some(why), _) => (None, Some(why)),
        (None, Err(why)) => {
            (None, Some(format!("GSF: XYUnits `{lateral:.40}`, ZUnits `{height:.40}`: {why}")))
        }
    };
    let pitch = sizes.map(|(_, size)| Some(size? * ratio?));
    let unit_um = units::metres(height).map(|metres| 1e6 * metres);
    let heights = data.as_chunks::<4>().0.iter().map(|chunk| f64::from(f32::from_le_bytes(*chunk))).collect();
    Ok(MapSamples { pitch, unit_um, no_pitch, ..MapSamples::new(columns, rows, heights, Stored::Single) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(header: &str, data: &[f32]) -> Vec<u8> {
        let mut bytes = [MAGIC, header.as_bytes()].concat();
        bytes.resize(bytes.len() + 4 - bytes.len() % 4, 0);
        bytes.extend(data.iter().flat_map(|value| value.to_le_bytes()));
        bytes
    }

    #[test]
    fn a_gwyddion_field_reads_with_its_pitches() {
        let data = [1.0f32, 2.0, 3.0, 4.0, 5.0, 6.0];
        // Headers of every length modulo four.
        for title in ["", "a", "ab", "abc"] {
            let header = format!(
                "XRes = 3\nYRes = 2\nXReal = 6e-6\nYReal=1e-6\nXYUnits = m\nZUnits = nm\nTitle = {title}\n"
            );
            let map = read(&field(&header, &data)).expect("a field");
            assert_eq!((map.columns, map.rows, map.stored), (3, 2, Stored::Single));
            assert_eq!(map.heights, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
            // 2 um and 0.5 um in nm; a quotient and two products round.
            for (found, expected) in map.pitch.iter().zip([2000.0, 500.0]) {
                assert!((found.expect("a pitch") - expected).abs() < 4.0 * f64::EPSILON * expected);
            }
        }
        let bare = read(&field("XRes = 3\nYRes = 2\nXReal = 6\nYReal = 4\n", &data)).expect("a field");
        assert_eq!(bare.pitch, [Some(2.0), Some(2.0)]);
        let volts =
            read(&field("XRes = 3\nYRes = 2\nXReal = 6\nYReal = 4\nXYUnits = m\nZUnits = V\n", &data));
        let volts = volts.expect("a field");
        assert_eq!(volts.pitch, [None, None]);
        assert!(volts.no_pitch.is_some_and(|why| why.contains("ZUnits `V`: V is no length")));
        let half =
            read(&field("XRes = 3\nYRes = 2\nXReal = 6\nYReal = 4\nXYUnits = m\n", &data)).expect("a field");
        assert!(half.no_pitch.is_some_and(|why| why.contains("one unit is given and the other is not")));
        let unsized_ = read(&field("XRes = 3\nYRes = 2\nXReal = 6\n", &data)).expect("a field");
        assert_eq!((unsized_.pitch, unsized_.no_pitch.as_deref()), ([None, None], Some("GSF: no YReal")));
    }

    #[test]
    fn damaged_fields_are_refused_with_a_reason() {
        let reason = |bytes: &[u8]| read(bytes).expect_err("must be refused");
        assert!(reason(&[MAGIC, b"XRes = 3\n"].concat()).contains("does not end"));
        assert!(reason(&field("YRes = 2\n", &[])).contains("no XRes"));
        assert!(reason(&field("XRes = -3\nYRes = 2\n", &[])).contains("whole number"));
        assert!(
            reason(&field("XRes = 3\nYRes = 2\n", &[0.0; 5])).contains("20 bytes of data do not make 3 x 2")
        );
        let twice = reason(&field("XRes = 3\nYRes = 2\nXRes = 4\n", &[0.0; 6]));
        assert!(twice.contains("XRes is there twice: 3 and 4"), "{twice}");
        let huge = "XRes = 4294967296\nYRes = 4294967296\n";
        assert!(reason(&field(huge, &[0.0])).contains("do not make"));
        assert!(reason(&field("XRes = 1\nYRes = 1\nXReal = wide\n", &[0.0])).contains("XReal = wide"));
    }
}
