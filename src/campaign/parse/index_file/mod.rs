//! Files of n and k over wavelengths, as people have them: columns of text, refractiveindex.info's CSV and YAML, and
//! the `X.eta.spd` and `X.k.spd` pairs of renderers.
//!
//! What the columns are follows from their headings; a file whose meaning is not plain is refused, never guessed at.

mod columns;
mod dispersion;
mod yaml;

use std::path::{Path, PathBuf};

use super::reader::Bounds;
use super::short_text;

pub(crate) use dispersion::Dispersion;

/// Wavelengths, nm.
pub(crate) const WAVELENGTH: Bounds = Bounds::closed(1.0, 1e6);
/// Real part of an index.
pub(crate) const ETA: Bounds =
    Bounds::closed(0.0, 100.0).low_open().advice("eta is relative to air, k its imaginary part", "");
/// Imaginary part of an index.
pub(crate) const K: Bounds = Bounds::closed(0.0, 100.0).advice("absorption is positive here", "");

/// More than any table of a material has.
const MOST_LINES: usize = 10_000;
/// Wavelengths below this are none of light in nm, but those of light in um.
const SHORTEST_NM: f64 = 100.0;

/// Ends of the names of a pair of files.
const PAIR: [&str; 2] = [".eta.spd", ".k.spd"];

/// What the file at `path` says; of a pair, either file names both.
pub(crate) fn read(path: &Path) -> Result<Dispersion, String> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = PAIR.iter().find_map(|end| name.strip_suffix(end));
    if let Some(stem) = stem {
        return pair(PAIR.map(|end| path.with_file_name(format!("{stem}{end}"))));
    }
    let text = text_of(path)?;
    if yaml::looks_like(&text) { yaml::parse(&text) } else { columns::parse(&text) }
}

/// n from one file and k from the other: two columns each, wavelengths in nm.
fn pair(files: [PathBuf; 2]) -> Result<Dispersion, String> {
    let read = |file: &Path, quantity: &str| {
        let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let text =
            text_of(file).map_err(|why| format!("{name}: {why}; both files of the pair are needed"))?;
        columns::spectrum(&text, quantity).map_err(|why| format!("{name}: {why}"))
    };
    let [eta, k] = &files;
    Dispersion::new(read(eta, "n")?, Some(read(k, "k")?))
}

fn text_of(path: &Path) -> Result<String, String> {
    short_text::read(path, "list of n and k")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_in_every_encoding() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("n_k.csv");
        let text = "wavelength_\u{b5}m,n,k\n# 25 \u{b0}C\n0.4,1.25,2\n0.7,1.75,3\n";
        let wide = |bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
            std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(bytes).collect()
        };
        let latin1 = text.chars().map(|c| c as u8).collect();
        let marked = format!("\u{feff}{text}").into_bytes();
        for bytes in [marked, wide(u16::to_le_bytes), wide(u16::to_be_bytes), latin1] {
            std::fs::write(&path, bytes).expect("file");
            let medium = read(&path).expect("a list").at(550.0).expect("within");
            assert_eq!((medium.eta, medium.k), (1.5, 2.5));
        }
        std::fs::write(&path, b"v/1\x01\x02\x00\x00\x00").expect("file");
        assert_eq!(read(&path).expect_err("an image"), "is no text");
    }

    #[test]
    fn a_pair_of_spectra_is_read_by_either_name_and_needs_both() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("Cu.eta.spd"), "# copper\n400 1.25\n500 1.0\n600 0.5\n").expect("file");
        assert!(read(&path("Cu.eta.spd")).expect_err("half a pair").contains("Cu.k.spd: cannot be read"));
        std::fs::write(path("Cu.k.spd"), "350 2\n450 2.5\n650 3.5\n").expect("file");
        for name in ["Cu.eta.spd", "Cu.k.spd"] {
            let found = read(&path(name)).expect("a pair");
            // Straight lines of each file between its own wavelengths.
            let medium = found.at(550.0).expect("within both");
            assert_eq!((medium.eta, medium.k), (0.75, 3.0));
            assert_eq!(found.ends(), [400.0, 600.0]);
        }
        std::fs::write(path("Cu.k.spd"), "0.35 2\n0.65 3\n").expect("file");
        assert!(read(&path("Cu.eta.spd")).expect_err("um").contains("look like micrometres"));
    }
}
