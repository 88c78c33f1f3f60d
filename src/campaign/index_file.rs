//! Files of (n, k) over wavelengths: lines `wavelength_nm,n,k`, increasing.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::reader::{Bounds, plain};
use super::schema::Medium;

/// Wavelengths, nm.
pub(super) const WAVELENGTH: Bounds = Bounds::closed(1.0, 1e6);
/// Real part of an index.
pub(super) const ETA: Bounds =
    Bounds::closed(0.0, 100.0).low_open().advice("eta is relative to air, k its imaginary part", "");
/// Imaginary part of an index.
pub(super) const K: Bounds = Bounds::closed(0.0, 100.0).advice("absorption is positive here", "");

/// More than any table of a material has.
const MOST_LINES: usize = 10_000;
const LARGEST_FILE: u64 = 1 << 20;

/// The lines of the file at `path`.
pub(super) fn read(path: &Path) -> Result<Vec<Medium>, String> {
    let failed = |e: std::io::Error| format!("cannot be read: {e}");
    // A pipe might never begin.
    if !std::fs::metadata(path).map_err(failed)?.is_file() {
        return Err("cannot be read: is not a regular file".into());
    }
    let file = File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err("is larger than 1 MiB; this is no list of n and k".into());
    }
    parse(&String::from_utf8(bytes).map_err(|_| "is not UTF-8 text".to_string())?)
}

/// Numbers between commas or blanks. Empty lines and those that begin with # are left out; so is a first line of words.
///
/// Held by: `lists_of_n_and_k_are_read_or_refused_by_line`.
fn parse(text: &str) -> Result<Vec<Medium>, String> {
    let mut media: Vec<Medium> = Vec::new();
    let mut heading = true;
    for (number, line) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words: Vec<&str> = line.split([',', ';', ' ', '\t']).filter(|word| !word.is_empty()).collect();
        let numbers: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
        if std::mem::replace(&mut heading, false) && numbers.is_empty() {
            continue;
        }
        let [nm, eta, k] = numbers[..] else {
            return Err(format!("line {number}: `{line}` is not wavelength_nm,n,k"));
        };
        if words.len() != 3 {
            return Err(format!("line {number}: `{line}` is not wavelength_nm,n,k"));
        }
        for (name, value, bounds) in [("wavelength_nm", nm, &WAVELENGTH), ("n", eta, &ETA), ("k", k, &K)] {
            if let Some(fault) = bounds.fault(value) {
                return Err(format!("line {number}: {name} = {} {fault}", plain(value)));
            }
        }
        if let Some(before) = media.last().and_then(|last| last.wavelength_nm).filter(|&before| before >= nm)
        {
            return Err(format!(
                "line {number}: {} nm after {} nm; wavelengths increase",
                plain(nm),
                plain(before)
            ));
        }
        media.push(Medium { wavelength_nm: Some(nm), eta, k });
        if media.len() > MOST_LINES {
            return Err(format!("has more than {MOST_LINES} lines"));
        }
    }
    if media.is_empty() { Err("holds no line wavelength_nm,n,k".into()) } else { Ok(media) }
}

/// The medium at a wavelength, between two lines by straight lines; `None` beyond the first or the last.
pub(super) fn at(media: &[Medium], nm: f64) -> Option<Medium> {
    let place = |medium: &Medium| medium.wavelength_nm.unwrap_or(nm);
    let after = media.partition_point(|medium| place(medium) < nm);
    let above = media.get(after)?;
    if place(above) == nm {
        return Some(*above);
    }
    let below = &media[after.checked_sub(1)?];
    let t = (nm - place(below)) / (place(above) - place(below));
    let between = |a: f64, b: f64| a + t * (b - a);
    Some(Medium { wavelength_nm: Some(nm), eta: between(below.eta, above.eta), k: between(below.k, above.k) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_n_and_k_are_read_or_refused_by_line() {
        let medium = |nm, eta, k| Medium { wavelength_nm: Some(nm), eta, k };
        let two = vec![medium(450.0, 1.5, 2.5), medium(550.5, 0.25, 0.0)];
        assert_eq!(parse("# gold\nwavelength_nm,n,k\n450,1.5,2.5\n\n550.5, 0.25, 0\n"), Ok(two.clone()));
        assert_eq!(parse("450 1.5 2.5\r\n550.5\t0.25\t0\r\n"), Ok(two.clone()));
        assert_eq!(at(&two, 450.0), Some(two[0]));
        // Half way: exact in binary.
        assert_eq!(at(&two, 500.25), Some(medium(500.25, 0.875, 1.25)));
        assert_eq!((at(&two, 449.0), at(&two, 551.0)), (None, None));
        for (text, phrase) in [
            ("", "holds no line"),
            ("450,1.5\n", "line 1: `450,1.5` is not"),
            ("450,1.5,2,3\n", "line 1"),
            ("450,1.5,2\n460,1.5,x\n", "line 2"),
            ("450,1.5,-1\n", "line 1: k = -1 must lie in [0, 100]"),
            ("450,0,1\n", "line 1: n = 0 must lie in (0, 100]"),
            ("450,nan,1\n", "line 1: n = NaN must be finite"),
            ("0.45,1,1\n", "line 1: wavelength_nm = 0.45 must lie in [1, 1e6]"),
            ("450,1,1\n450,1,1\n", "line 2: 450 nm after 450 nm"),
        ] {
            let found = parse(text).expect_err(text);
            assert!(found.contains(phrase), "{text:?}: {found}");
        }
    }
}
