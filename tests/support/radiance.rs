//! Small files of Radiance: blocks of light that comes back on the +z side.

use gonio::interchange::radiance::sample_side::SampleSide;
use gonio::interchange::radiance::xml_writer::{Block, write};

/// A file with a block for each channel: its wavelength, and its values as text.
pub fn reflection(structure: &str, basis: &str, bases: &str, channels: &[(&'static str, String)]) -> String {
    let block = |(wavelength, data): &(&'static str, String)| Block {
        light: SampleSide::Back,
        through: false,
        bases: bases.into(),
        wavelength,
        data: data.clone(),
    };
    write(structure, basis, &channels.iter().map(block).collect::<Vec<_>>())
}
