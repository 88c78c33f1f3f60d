//! The one list of formats.

use std::str::FromStr;

use super::codec::Codec;
use super::mitsuba::rgl;
use super::numpy::{npy, npz};
use super::radiance::{klems, tensor_tree};
use super::text::{astm, csv, pabopto, ssdd, zemax};
use super::{exr_parts, merl, utia};

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
    /// One EXR part an incidence.
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

impl Format {
    /// All of them.
    pub const ALL: [Format; 13] = [
        Format::Npz,
        Format::Npy,
        Format::Csv,
        Format::Merl,
        Format::Rgl,
        Format::Utia,
        Format::ExrParts,
        Format::Klems,
        Format::TensorTree,
        Format::Zemax,
        Format::Astm,
        Format::Ssdd,
        Format::Pabopto,
    ];

    /// What writes and reads its files.
    pub fn codec(self) -> &'static dyn Codec {
        match self {
            Format::Npz => &npz::Npz,
            Format::Npy => &npy::Npy,
            Format::Csv => &csv::Csv,
            Format::Merl => &merl::MerlFile,
            Format::Rgl => &rgl::RglFile,
            Format::Utia => &utia::Utia,
            Format::ExrParts => &exr_parts::ExrParts,
            Format::Klems => &klems::Klems,
            Format::TensorTree => &tensor_tree::TensorTreeFile,
            Format::Zemax => &zemax::ZemaxFile,
            Format::Astm => &astm::Astm,
            Format::Ssdd => &ssdd::Ssdd,
            Format::Pabopto => &pabopto::Pabopto,
        }
    }

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        self.codec().traits().name
    }
}

impl FromStr for Format {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|format| format.name() == name)
            .ok_or_else(|| format!("known formats are {}", Self::ALL.map(Format::name).join(", ")))
    }
}
