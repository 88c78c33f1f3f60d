//! What lies in the instrument for one realisation: a patch of heights, grains, or nothing but a law.

use glam::DVec2;
use sha2::{Digest, Sha256};

use crate::campaign::{Alpha, SmithNdf};
use crate::surface::Heightfield;
use crate::surface::grains::GrainField;
use crate::surface::io::prepare::cell_mask::CellMask;
use crate::trace::Window;

/// What lies in the instrument for one realisation.
#[derive(Debug, Clone)]
pub enum Specimen {
    /// Heights.
    Patch(Patch),
    /// Grains, for each coverage.
    Grains(Vec<(f64, GrainField)>),
    /// Nothing but a law; groups of paths stand for realisations.
    Statistical {
        /// Law of the slopes.
        law: SmithNdf,
        /// Whether a path leaves from a height drawn anew.
        independent_heights: bool,
    },
}

impl Specimen {
    /// The other side of the same surface, in a frame whose z points down.
    pub fn upside_down(&self) -> Self {
        match self {
            Specimen::Patch(patch) => {
                Specimen::Patch(Patch { field: patch.field.upside_down(), ..patch.clone() })
            }
            Specimen::Grains(fields) => Specimen::Grains(
                fields.iter().map(|(coverage, field)| (*coverage, field.upside_down())).collect(),
            ),
            Specimen::Statistical { .. } => self.clone(),
        }
    }
}

/// One realisation's patch.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Canonical heights.
    pub field: Heightfield,
    /// World slope per canonical slope where the surface itself says so; else the campaign's alpha counts.
    pub own_alpha: Option<DVec2>,
    /// Where paths start.
    pub window: Window,
    /// Cells of the window where none does.
    pub excluded: Option<CellMask>,
}

impl Specimen {
    /// SHA-256 over the heights, or over the grains; `None` where there are none.
    pub fn digest(&self) -> Option<[u8; 32]> {
        match self {
            Specimen::Patch(patch) => Some(patch.digest()),
            Specimen::Grains(fields) => {
                let mut hash = Sha256::new();
                fields.iter().for_each(|(_, field)| hash.update(field.digest()));
                Some(hash.finalize().into())
            }
            Specimen::Statistical { .. } => None,
        }
    }
}

/// Of the grains of all coverages those of a roughness.
pub fn grains_of(fields: &[(f64, GrainField)], alpha: Option<Alpha>) -> &GrainField {
    let coverage = alpha.and_then(|alpha| alpha.coverage);
    let of_table = fields.iter().find(|(known, _)| Some(*known) == coverage);
    &of_table.unwrap_or(&fields[0]).1
}

/// World slope per canonical slope: the surface's own, else that of a campaign's `alpha`.
pub fn world_slope(own: Option<DVec2>, alpha: Option<Alpha>) -> DVec2 {
    own.unwrap_or_else(|| alpha.map_or(DVec2::ONE, |alpha| DVec2::new(alpha.x, alpha.y)))
}

impl Patch {
    /// Grains as heights of `cells` x `cells` cells.
    pub fn of_grains(grains: &GrainField, cells: usize) -> Self {
        let field = grains.as_heights(cells);
        Patch { window: Window::all(&field), own_alpha: None, excluded: None, field }
    }

    /// World slope per canonical slope, with the campaign's `alpha` where the surface has none of its own.
    pub fn alpha(&self, alpha: Option<Alpha>) -> DVec2 {
        world_slope(self.own_alpha, alpha)
    }

    /// SHA-256 over the heights, little-endian f64 bits, row by row.
    pub fn digest(&self) -> [u8; 32] {
        let mut hash = Sha256::new();
        for height in self.field.heights() {
            hash.update(height.to_le_bytes());
        }
        hash.finalize().into()
    }
}
