//! The patches of a campaign: made, built or loaded, by realisation.

mod map_regions;
pub mod specimen;

use std::path::{Path, PathBuf};

use glam::DVec2;
use rayon::prelude::*;

use specimen::{Patch, Specimen};

use super::plan::KEPT_FRACTION;
use crate::campaign::{
    Campaign, GrainShape, HeightSpectrum, PsdSurface, SmithHeights, SmithNdf, SurfaceKind,
};
use crate::error::{Error, Result};
use crate::rng::{self, Purpose, StreamId};
use crate::surface::grains::{self, GrainField};
use crate::surface::io::import::{self, ImportedMap};
use crate::surface::{Heightfield, SlopeLaw, Synthesiser};
use crate::trace::Window;

/// Where a campaign's patches come from.
pub enum Patches {
    /// Random, one for each realisation.
    Random {
        /// Makes them.
        synthesiser: Box<Synthesiser>,
        /// The campaign's seed.
        seed: u64,
    },
    /// Those that `gonio surface` wrote, one file for each realisation.
    Files {
        /// Where `patch_000.exr` and the following ones are.
        folder: PathBuf,
        /// Cells along a side.
        cells: usize,
    },
    /// Random ones, made beforehand and kept for several runs.
    Held(Vec<Heightfield>),
    /// One exact shape for all realisations.
    Exact {
        /// The heights.
        field: Heightfield,
        /// World slope per canonical slope.
        alpha: DVec2,
    },
    /// Random grains, for each coverage of the campaign.
    Grains {
        /// The campaign's seed.
        seed: u64,
        /// In the order of the tables, each once.
        coverages: Vec<f64>,
        /// Side of a patch, radii.
        side: Option<f64>,
        /// Whether they are upside down.
        pits: bool,
        /// Cells of a side where they lie there as heights, those of the first coverage.
        as_heights: Option<usize>,
    },
    /// No heights at all.
    Statistical {
        /// Law of the slopes.
        law: SmithNdf,
        /// Whether a path leaves from a height drawn anew.
        independent_heights: bool,
    },
    /// One measured map; realisations are its sample regions.
    Map {
        /// The map.
        map: Box<ImportedMap>,
        /// tiles x tiles regions.
        tiles: usize,
        /// Cells kept free along an open edge.
        margin: usize,
    },
}

impl Patches {
    /// Prepares the patches of a campaign; `notes` gets what an imported map had to say.
    pub fn prepare(campaign: &Campaign, notes: &mut Vec<String>) -> Result<Self> {
        let surface = &campaign.surface;
        if let Some(law) = Self::law(campaign) {
            let (cells, correlation) = (surface.cells as usize, surface.correlation_cells);
            let synthesiser = match &surface.kind {
                SurfaceKind::Psd(PsdSurface { psd, pitch_um, .. }) => {
                    Synthesiser::with_psd(psd, *pitch_um, cells)
                }
                kind => Synthesiser::with_spectrum(law, cells, correlation, spectrum(kind)),
            };
            return Ok(Patches::Random { synthesiser: Box::new(synthesiser), seed: campaign.seed });
        }
        Ok(match &surface.kind {
            SurfaceKind::Smith(smith) => Patches::Statistical {
                law: smith.ndf,
                independent_heights: smith.heights == SmithHeights::Independent,
            },
            SurfaceKind::Grains(grains) => {
                // Heights have a law, and are random ones.
                let mut coverages: Vec<f64> =
                    grains.alphas.iter().filter_map(|alpha| alpha.coverage).collect();
                coverages.dedup();
                Patches::Grains {
                    seed: campaign.seed,
                    coverages,
                    side: grains.side,
                    pits: grains.shape == GrainShape::Pits,
                    as_heights: None,
                }
            }
            SurfaceKind::Ggx(_)
            | SurfaceKind::Beckmann { .. }
            | SurfaceKind::StudentT { .. }
            | SurfaceKind::BlinnPhong { .. }
            | SurfaceKind::Psd(_) => unreachable!("random heights have a law"),
            SurfaceKind::Mirror => Patches::Exact { field: flat(), alpha: DVec2::ONE },
            SurfaceKind::VGroove { slope } => {
                Patches::Exact { field: grooves(), alpha: DVec2::splat(*slope) }
            }
            SurfaceKind::File(height_map) => {
                let (map, margin) = map_regions::load(height_map, campaign, notes)?;
                Patches::Map { map: Box::new(map), tiles: height_map.tiles as usize, margin }
            }
        })
    }

    /// The patches of a random surface (ggx, beckmann), made now and kept: for several runs over the same ones.
    pub fn held(campaign: &Campaign) -> Result<Self> {
        let patches = Patches::prepare(campaign, &mut Vec::new())?;
        let make = |k: u64| match patches.realisation(k)? {
            Specimen::Patch(patch) => Ok(patch.field),
            Specimen::Grains(_) | Specimen::Statistical { .. } => {
                Err(Error::Internal("patches of a law without heights".into()))
            }
        };
        let all = (0..u64::from(campaign.surface.realisations)).into_par_iter();
        Ok(Patches::Held(all.map(make).collect::<Result<_>>()?))
    }

    /// Made once for all bands of a run, where they fit `limit` bytes well; else made again for each.
    pub fn for_bands(self, campaign: &Campaign, limit: u64) -> Result<Self> {
        let surface = &campaign.surface;
        let bytes = u128::from(surface.realisations) * u128::from(surface.cells).pow(2) * 8;
        if matches!(self, Patches::Random { .. }) && bytes <= u128::from(limit / KEPT_FRACTION) {
            return Patches::held(campaign);
        }
        Ok(self)
    }

    /// The patches of a random surface from a folder that `gonio surface` wrote, instead of making them: the same
    /// heights, so the same tables. Every file must be there; each is read when its realisation is measured.
    ///
    /// Errors: `Usage` where the surface is not random; `Io` for the first file that is missing.
    // Tested by `patches_from_a_folder_give_the_same_bytes` in `tests/it/cli.rs`.
    pub fn from_folder(campaign: &Campaign, folder: &Path) -> Result<Self> {
        let surface = &campaign.surface;
        if !surface.kind.is_random_heights() {
            let why = "--patches is for random surfaces (ggx, beckmann): this one is not made of patches";
            return Err(Error::Usage(format!("{}: {why}", campaign.name)));
        }
        for realisation in 0..u64::from(surface.realisations) {
            let path = folder.join(patch_name(realisation, "exr"));
            std::fs::metadata(&path).map_err(|e| Error::io(&path, e))?;
        }
        Ok(Patches::Files { folder: folder.into(), cells: surface.cells as usize })
    }

    /// What lies in the instrument for one realisation.
    pub fn realisation(&self, realisation: u64) -> Result<Specimen> {
        let patch = match self {
            Patches::Statistical { law, independent_heights } => {
                let (law, independent_heights) = (*law, *independent_heights);
                return Ok(Specimen::Statistical { law, independent_heights });
            }
            Patches::Grains { seed, coverages, side, pits, as_heights } => {
                let of = |&coverage: &f64| {
                    // The coverage is its own address: a further one leaves the others as they were.
                    let incidence = coverage.to_bits();
                    let id =
                        StreamId { seed: *seed, purpose: Purpose::Surface, realisation, incidence, block: 0 };
                    let side = side.unwrap_or_else(|| grains::usual_side(coverage));
                    (coverage, GrainField::random(side, coverage, *pits, &mut rng::stream(id)))
                };
                let Some(cells) = *as_heights else {
                    return Ok(Specimen::Grains(coverages.iter().map(of).collect()));
                };
                Patch::of_grains(&of(&coverages[0]).1, cells)
            }
            Patches::Random { synthesiser, seed } => {
                let id =
                    StreamId { seed: *seed, purpose: Purpose::Surface, realisation, incidence: 0, block: 0 };
                let field = synthesiser.patch(&mut rng::stream(id));
                Patch { window: Window::all(&field), own_alpha: None, excluded: None, field }
            }
            Patches::Files { folder, cells } => {
                let field = load(&folder.join(patch_name(realisation, "exr")), *cells)?;
                Patch { window: Window::all(&field), own_alpha: None, excluded: None, field }
            }
            Patches::Held(fields) => {
                let field = fields[realisation as usize].clone();
                Patch { window: Window::all(&field), own_alpha: None, excluded: None, field }
            }
            Patches::Exact { field, alpha } => {
                let (window, field) = (Window::all(field), field.clone());
                Patch { window, own_alpha: Some(*alpha), excluded: None, field }
            }
            Patches::Map { map, tiles, margin } => Patch {
                window: map_regions::tile(map, *tiles, *margin, realisation as usize),
                excluded: map.excluded.clone(),
                own_alpha: Some(DVec2::new(map.alpha_x, map.alpha_y)),
                field: map.field.clone(),
            },
        };
        Ok(Specimen::Patch(patch))
    }

    /// The slope law that the patches should follow.
    pub fn law(campaign: &Campaign) -> Option<SlopeLaw> {
        match campaign.surface.kind {
            SurfaceKind::Ggx(_) => Some(SlopeLaw::Ggx),
            SurfaceKind::Beckmann { .. } | SurfaceKind::Psd(_) => Some(SlopeLaw::Beckmann),
            SurfaceKind::StudentT { gamma, .. } => Some(SlopeLaw::student_t(gamma)),
            SurfaceKind::BlinnPhong { exponent, .. } => Some(SlopeLaw::blinn_phong(exponent)),
            SurfaceKind::Grains(ref grains) if grains.shape == GrainShape::Heights => {
                Some(SlopeLaw::Grains { coverage: grains.alphas[0].coverage? })
            }
            SurfaceKind::Smith(_)
            | SurfaceKind::Grains(_)
            | SurfaceKind::Mirror
            | SurfaceKind::VGroove { .. }
            | SurfaceKind::File(_) => None,
        }
    }
}

/// The spectrum of the Gaussian field that random heights are, or start from.
fn spectrum(kind: &SurfaceKind) -> HeightSpectrum {
    match kind {
        SurfaceKind::Beckmann { spectrum, .. } => *spectrum,
        _ => HeightSpectrum::Gaussian,
    }
}

/// The file of one realisation's patch.
pub fn patch_name(realisation: u64, end: &str) -> String {
    format!("patch_{realisation:03}.{end}")
}

/// A patch from its file: `cells` x `cells`, any pitch, for one canonical patch serves every roughness.
fn load(path: &Path, cells: usize) -> Result<Heightfield> {
    let field = import::load_patch(path)?.field;
    let (x, y) = (field.cells_x(), field.cells_y());
    if (x, y) != (cells, cells) {
        return Err(Error::format(path, format!("has {x} x {y} cells, surface.cells is {cells}")));
    }
    Ok(field)
}

fn flat() -> Heightfield {
    Heightfield::new(8, 8, true, vec![0.0; 64])
}

/// Ridges of canonical slope +-1 along y: heights 0 and 1 in turn.
fn grooves() -> Heightfield {
    Heightfield::new(8, 8, true, (0..64).map(|i| f64::from(i % 2)).collect())
}
