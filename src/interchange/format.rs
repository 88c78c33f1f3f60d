//! The one list of formats.

use std::path::Path;
use std::str::FromStr;

use super::codec::Codec;
use super::mitsuba::rgl;
use super::numpy::{npy, npz};
use super::radiance::{klems, tensor_tree};
use super::text::{astm, bird, csv, fred, openmaterial, pabopto, speos, ssdd, zemax};
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
    /// Look-up table of OpenMATERIAL 3D, isotropic.
    OpenMaterial,
    /// Universal BRDF JSON of BiRD.
    Bird,
    /// FRED's tabulated BSDF, isotropic.
    Fred,
    /// Anisotropic BSDF of Ansys Speos.
    Speos,
}

impl Format {
    /// All of them.
    pub const ALL: [Format; 17] = [
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
        Format::OpenMaterial,
        Format::Bird,
        Format::Fred,
        Format::Speos,
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
            Format::OpenMaterial => &openmaterial::OpenMaterial,
            Format::Bird => &bird::Bird,
            Format::Fred => &fred::Fred,
            Format::Speos => &speos::Speos,
        }
    }

    /// What it is, in a line.
    pub fn about(self) -> &'static str {
        match self {
            Format::Npz => "NumPy arrays of all channels, with the axes",
            Format::Npy => "one NumPy array of the totals",
            Format::Csv => "a line a bin: angles, values, errors",
            Format::Merl => "90 x 90 x 180 half and difference angles, isotropic (MERL database)",
            Format::Rgl => "the adaptive tensor file of Mitsuba's `measured` (EPFL RGL database)",
            Format::Utia => "288 x 288 directions (UTIA database); FILE.exr: the image form",
            Format::ExrParts => "one EXR part for each incidence",
            Format::Klems => "Radiance XML, a matrix of Klems patches (WINDOW, pyradiance)",
            Format::TensorTree => "Radiance XML, a tree of rank 3 or 4 that divides where it pays",
            Format::Zemax => "Zemax BSDF text about the mirror direction",
            Format::Astm => "ASTM E1392 and E2387 text, a line a pair of directions",
            Format::Ssdd => "SSDD text of libbsdf, lists of angles",
            Format::Pabopto => "a folder of pab-opto gonio files",
            Format::OpenMaterial => "a JSON look-up table of ASAM OpenMATERIAL 3D, by wavelength, isotropic",
            Format::Bird => "universal BRDF JSON of EURAMET's BiRD, with standard uncertainties",
            Format::Fred => "FRED's tabulated BSDF text, isotropic",
            Format::Speos => "anisotropic BSDF text of Ansys Speos",
        }
    }

    /// How names of its files end.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Format::Npz => &["npz"],
            Format::Npy => &["npy"],
            Format::Csv => &["csv"],
            Format::Merl => &["binary"],
            Format::Rgl => &["bsdf"],
            Format::Utia => &["bin"],
            Format::ExrParts => &["exr"],
            Format::Klems | Format::TensorTree => &["xml"],
            Format::Zemax => &["bsdf"],
            Format::Astm => &["astm"],
            Format::Ssdd => &["ssdd"],
            Format::Pabopto | Format::Fred => &[],
            Format::OpenMaterial => &["xompt"],
            Format::Bird => &["brdf"],
            Format::Speos => &["anisotropicbsdf"],
        }
    }

    /// Whether its files are read.
    pub fn is_read(self) -> bool {
        !matches!(self, Format::Npy | Format::Pabopto | Format::Speos)
    }

    /// The formats whose files have names that end like this one.
    pub fn of_name(path: &Path) -> Vec<Format> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
        Self::ALL.into_iter().filter(|format| format.endings().contains(&ending.as_str())).collect()
    }

    /// Whether a file that begins like this may be one, of formats whose names end alike.
    pub fn begins(self, head: &[u8]) -> bool {
        let has = |word: &[u8]| head.windows(word.len()).any(|part| part == word);
        match self {
            Format::Rgl => head.starts_with(b"tensor_file"),
            Format::Zemax => !head.starts_with(b"tensor_file"),
            Format::TensorTree => has(b"TensorTree"),
            Format::Klems => !has(b"TensorTree"),
            _ => true,
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
