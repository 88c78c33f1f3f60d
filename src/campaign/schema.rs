//! What a campaign says, checked: plain data, angles in degrees as the user wrote them, no physics types.
//!
//! `campaign::read` is the only place that makes a `Campaign`; whoever holds one may rely on every range below.

use serde::Serialize;

pub use super::optics_schema::{Index, Law, Medium, Optics, Polarisation};

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
    pub light: Light,
    /// The sensor arm.
    pub sensor: Sensor,
    /// What a facet reflects.
    pub optics: Optics,
    /// How paths are followed.
    pub trace: Trace,
    /// When the measurement ends.
    pub stop: Stop,
    /// What `validate` holds the table to, where the defaults do not fit.
    pub expect: Expect,
    /// What `bench` varies in place of sample counts. `None`: those.
    pub bench: Option<Resolution>,
}

/// The sample on the stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Surface {
    /// Independent patches, 1 to 4096. A height map has one patch, and its tiles x tiles groups are counted here.
    pub realisations: u32,
    /// Cells per side of a patch, 8 to 16384. Means something for a random surface only.
    pub cells: u32,
    /// Correlation length of the heights in cells, 2 to cells/8 (cells/8 itself below 16 cells). Means something
    /// for a random surface only.
    pub correlation_cells: f64,
    /// The sample turned counter-clockwise seen from +z, in [0, 360).
    pub rotation_deg: f64,
    /// Mirrored arms as extra samples inside a realisation; false where the surface is not random.
    pub mirror_images: bool,
    /// What the surface is.
    pub kind: SurfaceKind,
}

/// The kinds of surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceKind {
    /// Random heights with the GGX slope law; one table for each roughness.
    Ggx(Vec<Alpha>),
    /// Random Gaussian heights: the Beckmann slope law; one table for each roughness.
    Beckmann(Vec<Alpha>),
    /// A statistical Smith surface: heights and normals independent.
    Smith(Smith),
    /// A flat mirror.
    Mirror,
    /// Symmetric grooves along y with level ridges.
    VGroove {
        /// Slope of both sides, 1e-4 to 10.
        slope: f64,
    },
    /// A measured height map.
    File(HeightMap),
}

/// Slope scales of a surface along its own x and y, each in [1e-4, 10].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Alpha {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
}

/// A statistical Smith surface: `[surface.smith]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Smith {
    /// Law of the normals.
    pub ndf: SmithNdf,
    /// One table for each roughness.
    pub alphas: Vec<Alpha>,
    /// Whether a path leaves from the height at which it collided.
    pub heights: SmithHeights,
}

/// Laws of the normals of a statistical surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SmithNdf {
    /// GGX.
    Ggx,
    /// Beckmann.
    Beckmann,
}

/// The height from which a path leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SmithHeights {
    /// The one of the collision: height-correlated masking.
    Correlated,
    /// Drawn anew: separable masking.
    Independent,
}

/// A measured height map: `[surface.file]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeightMap {
    /// The file as the campaign names it.
    pub path: String,
    /// The file as it is opened: `path` relative to the campaign file's folder.
    #[serde(skip)]
    pub resolved_path: std::path::PathBuf,
    /// Distance of neighbouring columns, um. `None`: the file's own `pitch_x`.
    pub pitch_x_um: Option<f64>,
    /// Distance of neighbouring rows, um. `None`: the file's own `pitch_y`.
    pub pitch_y_um: Option<f64>,
    /// Height in um of one unit of the file. `None`: heights and the file's own pitches share one unit.
    pub height_unit_um: Option<f64>,
    /// Whether the map continues itself.
    pub periodic: bool,
    /// Whether the mean plane is taken off.
    pub detrend: Detrend,
    /// tiles x tiles start regions are the groups for the error bars, 1 to 64.
    pub tiles: u32,
}

/// What is taken off a measured height map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Detrend {
    /// The least-squares plane.
    Plane,
    /// Nothing but the mean.
    None,
}

/// The light arm.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Light {
    /// Polar angles of the stops, each in [0, 90), increasing.
    pub theta_i_deg: Vec<f64>,
    /// Azimuths of the stops.
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
    /// Stops at these azimuths, each in [0, 360), increasing: a 4-D table.
    Absolute(Vec<f64>),
}

/// The sensor arm.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sensor {
    /// Bins over the whole hemisphere.
    Hemisphere {
        /// Rows: the step is 90/rows degrees, 1 to 9000.
        theta_r_bins: u32,
        /// Columns: the step is 360/columns degrees, 1 to 36000.
        phi_r_bins: u32,
        /// Where the edges are.
        bins: BinLayout,
    },
    /// Single positions with a circular aperture: every pair of the two lists.
    Arm {
        /// Polar angles in (-90, 90); negative ones lie on the far side of the azimuth.
        theta_r_deg: Vec<f64>,
        /// Azimuths in [0, 360).
        phi_r_deg: Vec<f64>,
        /// Half-angle of the aperture, > 0; it stays above the horizon.
        aperture_deg: f64,
        /// What the azimuths count from.
        phi_r_from: PhiFrom,
    },
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
    /// Start points per stop and realisation, at least 1; rounded up to whole blocks. With another rule beside it: a
    /// maximum.
    pub samples: u64,
    /// A stop ends when the median standard error of its bins above 1 % of its peak is at most this share of the
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

impl SurfaceKind {
    /// Whether the law of the surface is the same at every azimuth.
    pub fn is_isotropic(&self) -> bool {
        match self {
            SurfaceKind::Mirror => true,
            kind => kind.alphas().is_some_and(|alphas| alphas.iter().all(|a| a.x == a.y)),
        }
    }

    /// The roughnesses of a surface that has a law.
    pub fn alphas(&self) -> Option<&Vec<Alpha>> {
        match self {
            SurfaceKind::Ggx(alphas) | SurfaceKind::Beckmann(alphas) => Some(alphas),
            SurfaceKind::Smith(smith) => Some(&smith.alphas),
            SurfaceKind::Mirror | SurfaceKind::VGroove { .. } | SurfaceKind::File(_) => None,
        }
    }

    /// The same, to be narrowed.
    pub fn alphas_mut(&mut self) -> Option<&mut Vec<Alpha>> {
        match self {
            SurfaceKind::Ggx(alphas) | SurfaceKind::Beckmann(alphas) => Some(alphas),
            SurfaceKind::Smith(smith) => Some(&mut smith.alphas),
            SurfaceKind::Mirror | SurfaceKind::VGroove { .. } | SurfaceKind::File(_) => None,
        }
    }

    /// Whether patches of random heights are made for it.
    pub fn is_random_heights(&self) -> bool {
        matches!(self, SurfaceKind::Ggx(_) | SurfaceKind::Beckmann(_))
    }
}
