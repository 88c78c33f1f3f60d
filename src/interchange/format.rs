//! Which formats there are, and what may be chosen about them.

use std::str::FromStr;

use super::Reason;
use super::merl::Sampling;
use super::radiance::xml::SampleSide;
use crate::instrument::klems::Basis;

/// The formats that other programs read or write.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Every array for NumPy.
    Npz,
    /// The totals for NumPy.
    Npy,
    /// One line a bin.
    Csv,
    /// Half/difference cells, isotropic.
    Merl,
    /// Mitsuba's `measured`.
    Rgl,
    /// 288 x 288 directions.
    Utia,
    /// One EXR part a stop.
    ExrParts,
    /// Radiance's matrix.
    Klems,
    /// Radiance's tensor tree.
    TensorTree,
    /// Zemax's table about the mirror direction.
    Zemax,
    /// ASTM E1392/E2387 text.
    Astm,
    /// SSDD text.
    Ssdd,
    /// pab-opto text, a folder of files.
    Pabopto,
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
    /// Klems matrices that are written: the basis; the table's own, else the full one, if none is asked for.
    pub klems: Option<Basis>,
    /// How far the albedo of a file of other directions may be off between the table's incidences, relative; `None`: 1 %.
    pub albedo_error: Option<f64>,
    /// A file with a single azimuth of the light is isotropic: the user's word.
    pub isotropic: bool,
}

impl Format {
    /// All, by name.
    pub const ALL: [(&'static str, Format); 13] = [
        ("npz", Format::Npz),
        ("npy", Format::Npy),
        ("csv", Format::Csv),
        ("merl", Format::Merl),
        ("rgl", Format::Rgl),
        ("utia", Format::Utia),
        ("exr_parts", Format::ExrParts),
        ("klems", Format::Klems),
        ("tensor_tree", Format::TensorTree),
        ("zemax", Format::Zemax),
        ("astm", Format::Astm),
        ("ssdd", Format::Ssdd),
        ("pabopto", Format::Pabopto),
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, format)| *format == self).map_or("", |(name, _)| name)
    }

    /// Whether the file can hold half/difference angles as they are.
    pub fn holds_half_difference(self) -> bool {
        matches!(self, Format::Npz | Format::Npy | Format::Merl)
    }

    /// Whether the file can leave out a pair of directions that was not measured.
    pub fn holds_gaps(self) -> bool {
        matches!(self, Format::Npz | Format::Csv | Format::ExrParts | Format::Astm | Format::Pabopto)
    }

    /// Whether the file has one channel: the luminance of a table of three colours.
    pub fn has_one_channel(self) -> bool {
        matches!(self, Format::Zemax | Format::Pabopto)
    }

    /// Whether a table larger than memory is written in it, a band of stops after the other.
    pub fn goes_by_rows(self) -> bool {
        matches!(self, Format::Npy | Format::Csv)
    }

    /// Whether the format has directions of its own, on which the table is interpolated.
    pub fn is_resampled(self) -> bool {
        use Format::{Klems, Merl, Rgl, TensorTree, Utia, Zemax};
        matches!(self, Merl | Rgl | Utia | Klems | TensorTree | Zemax)
    }

    /// Whether the file holds totals alone: no error bars, no orders.
    pub fn holds_totals_alone(self) -> bool {
        !matches!(self, Format::Npz | Format::Csv | Format::ExrParts | Format::Merl)
    }

    /// Whether the file can hold more colours than R, G and B.
    pub fn holds_wavelengths(self) -> bool {
        matches!(
            self,
            Format::Npz | Format::Npy | Format::Csv | Format::ExrParts | Format::Astm | Format::Ssdd
        )
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(name: &str) -> Reason<Self> {
        let known = Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, format)| *format);
        known.ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.iter().map(|(name, _)| *name).collect();
            format!("known formats are {}", names.join(", "))
        })
    }
}
