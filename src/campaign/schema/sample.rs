//! The sample of a campaign, checked: the kinds of surface and their roughnesses.

use serde::Serialize;

use super::alpha::Alpha;
use super::height_map::HeightMap;
use super::psd::PsdSurface;

/// The sample on the stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Surface {
    /// Independent patches, 1 to 4096. A height map has one patch, and its tiles x tiles groups are counted here.
    pub realisations: u32,
    /// Cells per side of a patch, 8 to 16384. Means something for a random surface only; for grains, where they are
    /// written or shown as heights.
    pub cells: u32,
    /// Correlation length of the heights in cells, 2 to cells/8 (cells/8 itself below 16 cells). Means something
    /// for a random surface only; by a power spectral density it follows from that.
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
    /// Random Gaussian heights: the Beckmann slope law.
    Beckmann {
        /// One table for each roughness.
        alphas: Vec<Alpha>,
        /// The wave lengths that the heights are made of.
        spectrum: HeightSpectrum,
    },
    /// Random heights whose slopes follow Student's t: GGX is gamma = 2, Beckmann the limit of large ones.
    StudentT {
        /// One table for each roughness.
        alphas: Vec<Alpha>,
        /// Half the power of the tails, 2 to 100.
        gamma: f64,
    },
    /// Random heights with the normals of Blinn and Phong, D = (n + 2)/(2 pi) cos^n.
    BlinnPhong {
        /// n, 0 to 20,000.
        exponent: f64,
        /// The one roughness that belongs to it, sqrt(2/(n + 2)).
        alphas: Vec<Alpha>,
    },
    /// Random Gaussian heights of a power spectral density: the Beckmann slope law.
    Psd(PsdSurface),
    /// A statistical Smith surface: heights and normals independent.
    Smith(Smith),
    /// Random half-ellipsoids on a plane.
    Grains(Grains),
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

/// Power spectra of Gaussian heights: the slope law is Beckmann's with each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum HeightSpectrum {
    /// Covariance exp(-(r/L)^2): bumps of one size.
    Gaussian,
    /// Covariance near exp(-r/L) from L down to two cells: bumps of all sizes between.
    Exponential,
}

/// Half-ellipsoids whose centres are a Poisson process on a plane: `[surface.grains]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Grains {
    /// One table for each roughness and coverage.
    pub alphas: Vec<Alpha>,
    /// Side of a patch in radii of the canonical grains, 8 to 10,000. `None`: room for 1,000 grains.
    pub side: Option<f64>,
    /// What the plane between them does.
    pub base: GrainBase,
    /// What has the normals of grains.
    pub shape: GrainShape,
}

/// Surfaces with the normals of grains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GrainShape {
    /// Half-ellipsoids on the plane.
    Grains,
    /// The same upside down: pits in the plane.
    Pits,
    /// Random heights whose slopes follow the same law, the plane's among them.
    Heights,
}

/// The plane between grains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GrainBase {
    /// It reflects as the grains do.
    Mirror,
    /// Light ends there.
    Absorbing,
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
            SurfaceKind::Ggx(alphas)
            | SurfaceKind::Beckmann { alphas, .. }
            | SurfaceKind::StudentT { alphas, .. }
            | SurfaceKind::BlinnPhong { alphas, .. } => Some(alphas),
            SurfaceKind::Psd(psd) => Some(&psd.alphas),
            SurfaceKind::Smith(smith) => Some(&smith.alphas),
            SurfaceKind::Grains(grains) => Some(&grains.alphas),
            SurfaceKind::Mirror | SurfaceKind::VGroove { .. } | SurfaceKind::File(_) => None,
        }
    }

    /// The same, to be narrowed.
    pub fn alphas_mut(&mut self) -> Option<&mut Vec<Alpha>> {
        match self {
            SurfaceKind::Ggx(alphas)
            | SurfaceKind::Beckmann { alphas, .. }
            | SurfaceKind::StudentT { alphas, .. }
            | SurfaceKind::BlinnPhong { alphas, .. } => Some(alphas),
            SurfaceKind::Psd(psd) => Some(&mut psd.alphas),
            SurfaceKind::Smith(smith) => Some(&mut smith.alphas),
            SurfaceKind::Grains(grains) => Some(&mut grains.alphas),
            SurfaceKind::Mirror | SurfaceKind::VGroove { .. } | SurfaceKind::File(_) => None,
        }
    }

    /// Grains or pits themselves, not heights with their normals.
    pub fn explicit_grains(&self) -> Option<&Grains> {
        match self {
            SurfaceKind::Grains(grains) if grains.shape != GrainShape::Heights => Some(grains),
            _ => None,
        }
    }

    /// Whether light ends on a plane between grains.
    pub fn has_absorbing_base(&self) -> bool {
        self.explicit_grains().is_some_and(|grains| grains.base == GrainBase::Absorbing)
    }

    /// Whether it is a measured height map.
    pub fn is_map(&self) -> bool {
        matches!(self, SurfaceKind::File(_))
    }

    /// Whether it ends at an edge that light may leave by.
    pub fn is_open_map(&self) -> bool {
        matches!(self, SurfaceKind::File(map) if !map.periodic)
    }

    /// Whether its patches are random, each realisation another.
    pub fn has_random_patches(&self) -> bool {
        self.is_random_heights() || self.explicit_grains().is_some()
    }

    /// Whether patches of random heights are made for it.
    pub fn is_random_heights(&self) -> bool {
        matches!(
            self,
            SurfaceKind::Ggx(_)
                | SurfaceKind::Beckmann { .. }
                | SurfaceKind::StudentT { .. }
                | SurfaceKind::BlinnPhong { .. }
                | SurfaceKind::Psd(_)
        ) || matches!(self, SurfaceKind::Grains(grains) if grains.shape == GrainShape::Heights)
    }

    /// Whether its correlation length is a number of the campaign, in cells.
    pub fn has_own_correlation(&self) -> bool {
        self.is_random_heights() && !matches!(self, SurfaceKind::Psd(_))
    }

    /// The name of its table in a campaign.
    pub fn name(&self) -> &'static str {
        match self {
            SurfaceKind::Ggx(_) => "ggx",
            SurfaceKind::Beckmann { .. } => "beckmann",
            SurfaceKind::StudentT { .. } => "student_t",
            SurfaceKind::BlinnPhong { .. } => "blinn_phong",
            SurfaceKind::Psd(_) => "psd",
            SurfaceKind::Smith(_) => "smith",
            SurfaceKind::Grains(_) => "grains",
            SurfaceKind::Mirror => "mirror",
            SurfaceKind::VGroove { .. } => "v_groove",
            SurfaceKind::File(_) => "file",
        }
    }
}
