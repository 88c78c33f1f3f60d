//! The result of a measurement: BRDF values, error bars and hits over (stop, bin).

use crate::instrument::Grid;

/// A measured (or imported) BRDF table. Every channel is row-major: `stop * bins + bin`.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfTable {
    /// Which stops and bins.
    pub grid: Grid,
    /// The resolved campaign, TOML.
    pub campaign: String,
    /// Program version that made it.
    pub version: String,
    /// The campaign's seed.
    pub seed: u64,
    /// SHA-256 over the patches' heights, hex; empty where there are none.
    pub patch_digest: String,
    /// One entry per colour: one (Y) or three (R, G, B).
    pub colours: Vec<ColourChannels>,
    /// Arrivals in the bin, folded and mirrored ones once each.
    pub hits: Vec<u32>,
    /// The bin's sum of (1-c)^5 as a BRDF: Schlick campaigns of order 1.
    pub schlick: Option<Vec<f32>>,
}

/// The channels of one colour, BRDF in 1/sr without cosine.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ColourChannels {
    /// All orders together.
    pub total: Vec<f32>,
    /// Order 1.
    pub single: Vec<f32>,
    /// Orders above 1.
    pub multiple: Vec<f32>,
    /// Standard error of the mean of `total` over the realisations; -1: not available.
    pub stderr: Vec<f32>,
    /// The same of `single`.
    pub stderr_single: Vec<f32>,
}

/// The table of every realisation (or group of realisations), for pairing and jackknife.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Realisations {
    /// One entry per realisation.
    pub parts: Vec<RealisationPart>,
}

/// One realisation's values, a vector per colour.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RealisationPart {
    /// All orders together.
    pub total: Vec<Vec<f32>>,
    /// Order 1.
    pub single: Vec<Vec<f32>>,
}

impl BrdfTable {
    /// Channel names of the colours: `["Y"]` or `["R", "G", "B"]`.
    pub fn colour_names(&self) -> &'static [&'static str] {
        if self.colours.len() == 1 { &["Y"] } else { &["R", "G", "B"] }
    }
}
