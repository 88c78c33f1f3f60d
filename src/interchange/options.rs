//! What a user may choose about a foreign file.

use std::ops::RangeInclusive;
use std::sync::Arc;

use super::radiance::sample_side::SampleSide;
use crate::instrument::klems::Basis;
use crate::table::BrdfTable;

/// Wavelengths that a user may give, nm.
pub const NANOMETRES: RangeInclusive<f64> = 100.0..=1e6;

/// Where in a MERL cell its value lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// At the lower corner: for readers that interpolate. theta_h = 0 is stored exactly.
    #[default]
    Node,
    /// In the middle of the index: for readers that take the cell as it is.
    Centre,
}

/// What a user may choose about a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Where in a MERL cell its value lies.
    pub merl_sampling: Sampling,
    /// UTIA as an image.
    pub utia_image: bool,
    /// RGL files with wavelengths instead of rgb: one for each colour of the table, nm. Empty for rgb.
    pub wavelengths_nm: Vec<f64>,
    /// Radiance XML that is read: the side of the sample; +z where the file has it, if none is asked for.
    pub side: Option<SampleSide>,
    /// Of a table that holds both, what is written: light that has gone through (true), or that comes back.
    pub through: Option<bool>,
    /// Radiance XML that is written: the table of the same surface under light from the back.
    pub back: Option<Arc<BrdfTable>>,
    /// Klems matrices that are written: the basis; the table's own, else the full one, if none is asked for.
    pub klems: Option<Basis>,
    /// How far the albedo of a file of other directions may be off between the table's incidences, relative; `None`:
    /// 1 %.
    pub albedo_error: Option<f64>,
    /// A file with a single azimuth of the light is isotropic: the user's word.
    pub isotropic: bool,
}
