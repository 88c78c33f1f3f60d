//! The files that height maps come in: a reader for each format, told apart by how a file begins.

mod exr;
mod gsf;
mod gwy;
mod npy;
mod picture;
mod raw;
mod sdf;
mod sur;
mod text;
pub(crate) mod units;
mod x3p;
mod zygo;

use super::samples::MapSamples;
use crate::error::Checked;

/// A format of height maps.
pub trait MapReader: Sync {
    /// What messages call it.
    fn name(&self) -> &'static str;

    /// Whether a file is one, by its first bytes.
    fn accepts(&self, bytes: &[u8]) -> bool;

    /// The most bytes of memory that reading takes, besides the file's, with the copy of the heights that is sorted for
    /// outliers.
    // Tested by tests/process/bombs.rs.
    fn needed(&self, bytes: &[u8]) -> Checked<u64>;

    /// Whether a file may hold several maps, of which `channel` names one.
    fn has_channels(&self) -> bool {
        false
    }

    /// The map; samples without data are NaN.
    fn read(&self, bytes: &[u8], channel: Option<&str>) -> Checked<MapSamples>;
}

/// All of them; the last takes every text.
const READERS: [&dyn MapReader; 11] = [
    &exr::Exr,
    &npy::Npy,
    &gsf::Gsf,
    &gwy::Gwy,
    &x3p::X3p,
    &sur::Sur,
    &sdf::Sdf,
    &zygo::MetroPro,
    &picture::Tiff,
    &picture::Png,
    &text::Text,
];

/// Formats that are known and not read: how they begin, and what to do.
const NOT_READ: [(&[u8], &str); 3] = [
    (
        b"\x89HDF\r\n\x1a\n",
        "an HDF5 file, as .datx and .plux are, is not read: save the map as .x3p, .sur, .xyz or .npy",
    ),
    (b"\x1f\x8b", "a compressed file (gzip) is not read: gunzip it first"),
    (b"GWYO", "a file of Gwyddion 1 is not read: save it as .gwy with Gwyddion 2"),
];

/// What a file is that no reader takes.
const UNKNOWN: &str = "none of the height maps that are read: EXR, NPY, GSF, GWY, X3P, SUR, SDF, Zygo's .dat, TIFF, PNG, an \
                       Arc grid, a matrix, or lines of x y z";

/// The reader of a file.
pub fn of(bytes: &[u8]) -> Checked<&'static dyn MapReader> {
    if bytes.is_empty() {
        return Err("the file is empty".into());
    }
    if let Some((_, why)) = NOT_READ.iter().find(|(begin, _)| bytes.starts_with(begin)) {
        return Err((*why).into());
    }
    READERS.iter().find(|reader| reader.accepts(bytes)).copied().ok_or_else(|| UNKNOWN.into())
}
