//! The samples of a height map's file, untouched, whatever its format.

use super::readers;
use super::samples::MapSamples;
use crate::error::Checked;

/// The most bytes of memory that reading these bytes may take, besides themselves: heights in f64, and a copy of them that
/// is sorted for outliers.
// Tested by tests/process/bombs.rs.
pub fn needed(bytes: &[u8]) -> Checked<u64> {
    readers::of(bytes)?.needed(bytes)
}

/// Reads the only map of a file from its bytes, NaN where there are no data; the error is a reason, to be completed with
/// the path.
pub fn read(bytes: &[u8]) -> Checked<MapSamples> {
    read_channel(bytes, None)
}

/// The same of a file that may hold several maps, of which `channel` names one.
pub fn read_channel(bytes: &[u8], channel: Option<&str>) -> Checked<MapSamples> {
    let reader = readers::of(bytes)?;
    match channel {
        Some(channel) if !reader.has_channels() => Err(format!(
            "surface.file.channel = {channel:?}: {} holds one map; leave the key out",
            reader.name()
        )
        .into()),
        _ => reader.read(bytes, channel),
    }
}
