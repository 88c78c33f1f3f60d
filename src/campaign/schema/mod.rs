//! A campaign, checked: plain data, angles in degrees as the user wrote them, no physics types.
//!
//! `campaign::read` is the only place that makes a `Campaign`; whoever holds one may rely on every range below.

mod alpha;
mod height_map;
pub(crate) mod optics;
pub(crate) mod psd;
pub(crate) mod sample;
pub(crate) mod uncertainty;

use serde::Serialize;

pub use alpha::Alpha;
pub use height_map::{Detrend, Gaps, HeightMap, Outliers, Preparation};
pub use optics::{Dielectric, FresnelLaw, LightSide, Medium, Optics, Polarisation, RefractiveIndex};
pub use psd::{PhysicalScale, PsdSurface};
pub use sample::*;
pub use uncertainty::{Correlation, Distribution, InputQuantity, QUANTITIES, Quantity, Uncertainty};

/// A whole campaign file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Campaign {
    /// Names the output folder and files: letters, digits, `_`, `-`, `.`; at most 100 characters.
    pub name: String,
    /// Everything random follows from it.
    pub seed: u64,
    /// The sample.
    pub surface: Surface,
    /// The light arm.
    pub light: LightArm,
    /// The sensor arm.
    pub sensor: SensorArm,
    /// What a facet does to light.
    pub optics: Optics,
    /// How paths are followed.
    pub trace: Trace,
    /// When the measurement ends.
    pub stop: Stop,
    /// What `validate` holds the table to, where the defaults do not fit.
    pub expect: Expect,
    /// Lengths by which geometric optics is judged, where surface and optics say none.
    pub scale: PhysicalScale,
    /// What `bench` varies in place of sample counts. `None`: those.
    pub bench: Option<Resolution>,
}

/// The light arm.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightArm {
    /// Polar angles of the incidences, each in [0, 90), increasing.
    pub theta_i_deg: Vec<f64>,
    /// Azimuths of the incidences.
    pub azimuth: Azimuth,
    /// Whether azimuths of a surface that is not isotropic may be averaged.
    pub average_azimuth: bool,
    /// Half-angle of the source cone; the cone stays above the horizon. 0: parallel light.
    pub aperture_deg: f64,
}

/// How the light's azimuth is treated.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Azimuth {
    /// Averaged; the sensor's azimuth counts from the light's: a 3-D table.
    Relative,
    /// Incidences at these azimuths, each in [0, 360), increasing: a 4-D table.
    Absolute(Vec<f64>),
    /// An incidence in the middle of each patch of the Klems full basis; `theta_i_deg` holds the middles of its rings.
    KlemsFull,
}

/// The sensor arm.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorArm {
    /// Bins over a whole hemisphere, or both.
    Hemisphere {
        /// Which of both.
        side: SensorSide,
        /// Rows of a hemisphere: the step is 90/rows degrees, 1 to 9000.
        theta_r_bins: u32,
        /// Columns: the step is 360/columns degrees, 1 to 36000.
        phi_r_bins: u32,
        /// Where the edges are.
        bins: BinLayout,
    },
    /// Single positions with a circular aperture: every pair of the two lists.
    Arm {
        /// Polar angles in (-90, 90); negative ones lie on the far side of the azimuth. Of clear facets those in (90, 180]
        /// too: light that has gone through.
        theta_r_deg: Vec<f64>,
        /// Azimuths in [0, 360).
        phi_r_deg: Vec<f64>,
        /// Half-angle of the aperture, > 0; it stays off the horizon.
        aperture_deg: f64,
        /// What the azimuths count from.
        phi_r_from: PhiFrom,
    },
    /// The 145 patches of the Klems full basis, on the stage's azimuths.
    KlemsFull {
        /// Of which hemisphere, or of both.
        side: SensorSide,
    },
}

/// Which light a sensor over hemispheres collects, seen from the side of the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensorSide {
    /// What comes back: theta_r below 90.
    Reflection,
    /// What has gone through: theta_r beyond 90.
    Transmission,
    /// Both: theta_r from 0 to 180.
    Both,
}

/// Where the edges of the hemisphere's bins are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BinLayout {
    /// Bins centred on the multiples of the step; theta has one row more, its first and last half as wide.
    Centred,
    /// Edges on the multiples of the step.
    Aligned,
}

/// What a sensor azimuth counts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PhiFrom {
    /// The light's azimuth.
    Light,
    /// The stage's x axis.
    Sample,
}

/// How paths are followed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trace {
    /// Highest order that is followed, 1 to 10,000.
    pub bounces: u32,
    /// Whether shadowing and masking happen.
    pub visibility: bool,
    /// Mirror symmetry of the surface's law as extra samples.
    pub fold: bool,
    /// Whether every order above 1 has channels of its own, not only all of them together.
    pub by_order: bool,
}

/// When the measurement ends.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stop {
    /// Surface samples per incidence and realisation, at least 1; rounded up to whole blocks. A maximum where another
    /// rule is given.
    pub samples: u64,
    /// An incidence ends when the median standard error of its bins above 1 % of its peak is at most this part of the
    /// bin, 1e-4 to 1; at least two realisations.
    pub relative_error: Option<f64>,
    /// The run ends at the first block boundary after so many seconds, 1 to 1e6.
    pub seconds: Option<f64>,
}

/// What `validate` holds the table to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Expect {
    /// The masking that `l1_model` speaks of. `None`: height_correlated.
    pub masking: Option<ExpectedMasking>,
    /// Largest allowed `l1_model` of the campaign. `None`: 1.3 times the known discrepancy of the surface.
    pub l1_model: Option<f64>,
}

/// What `bench` varies on random heights: every patch size with every correlation length.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Resolution {
    /// Cells per side, at least one number.
    pub cells: Vec<u32>,
    /// Correlation lengths in cells, at least one; none beyond an eighth of the smallest patch.
    pub correlation_cells: Vec<f64>,
}

/// The maskings by the names of the summary.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExpectedMasking {
    /// G1 times G1.
    Separable,
    /// 1/(1 + Li + Lo).
    HeightCorrelated,
    /// 1/(1 + max + lambda min).
    DirectionCorrelated,
}

impl Campaign {
    /// The roughnesses, one table each; `None` stands for a surface that has no roughness.
    pub fn alphas(&self) -> Vec<Option<Alpha>> {
        match self.surface.kind.alphas() {
            Some(alphas) => alphas.iter().copied().map(Some).collect(),
            None => vec![None],
        }
    }

    /// The same campaign for one of its roughnesses: what a table of several stores.
    pub fn with_alpha(&self, alpha: Alpha) -> Campaign {
        let mut one = self.clone();
        if let Some(alphas) = one.surface.kind.alphas_mut() {
            *alphas = vec![alpha];
        }
        one
    }

    /// The same campaign for one of its materials: what a table of several stores.
    pub fn with_optics(&self, optics: &Optics) -> Campaign {
        Campaign { optics: optics.clone(), ..self.clone() }
    }

    /// Whether the law of the surface is the same at every azimuth.
    pub fn is_isotropic(&self) -> bool {
        self.surface.kind.is_isotropic()
    }
}
