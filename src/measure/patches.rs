//! The patches of a campaign: made, built or loaded, by realisation.

use std::path::{Path, PathBuf};

use glam::DVec2;
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use super::gap_crossings;
use super::plan::KEPT_FRACTION;
use crate::campaign::{
    Alpha, Campaign, GrainShape, HeightSpectrum, PsdSurface, SmithHeights, SmithNdf, SurfaceKind,
};
use crate::error::{Error, Result};
use crate::rng::{self, Purpose, StreamId};
use crate::surface::grains::{self, GrainField};
use crate::surface::io::import;
use crate::surface::io::import::ImportedMap;
use crate::surface::io::prepare::cell_mask::CellMask;
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
                let mut map = import::load(height_map)?;
                notes.append(&mut map.notes);
                let (low, high) = map.field.range();
                let steepest = campaign.light.theta_i_deg.iter().copied().fold(0.0, f64::max);
                let slope = (steepest + campaign.light.aperture_deg).to_radians().tan();
                let reach = (high - low) * map.alpha_x.max(map.alpha_y) * slope;
                let shortest = map.field.cells_x().min(map.field.cells_y());
                let wanted = if map.field.is_periodic() { 0.0 } else { reach.ceil() };
                let margin = (wanted as usize).min(shortest / 4);
                if wanted > margin as f64 {
                    notes.push(format!(
                        "{}: shadows reach {wanted} cells, starts keep only {margin} from the edge: see `left_map`",
                        height_map.path
                    ));
                }
                let tiles = height_map.tiles as usize;
                if (shortest - 2 * margin) < tiles {
                    return Err(Error::format(
                        &height_map.resolved_path,
                        format!("{shortest} cells are too few for {tiles} x {tiles} start regions"),
                    ));
                }
                let empty = (0..tiles * tiles)
                    .find(|&k| tile(&map, tiles, margin, k).cells_outside(map.excluded.as_ref()) == 0);
                if let Some(empty) = empty {
                    let why = format!(
                        "start region {empty} of {tiles} x {tiles} is all gaps: lower surface.file.tiles, or set \
                         surface.file.gaps = \"interpolate\""
                    );
                    return Err(Error::format(&height_map.resolved_path, why));
                }
                notes.extend(gap_crossings::note(&map, margin, campaign));
                Patches::Map { map: Box::new(map), tiles, margin }
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
                window: tile(map, *tiles, *margin, realisation as usize),
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

impl Patch {
    /// Grains as heights of `cells` x `cells` cells.
    pub fn of_grains(grains: &GrainField, cells: usize) -> Self {
        let field = grains.as_heights(cells);
        Patch { window: Window::all(&field), own_alpha: None, excluded: None, field }
    }

    /// World slope per canonical slope, with the campaign's `alpha` where the surface has none of its own.
    pub fn alpha(&self, alpha: Option<Alpha>) -> DVec2 {
        self.own_alpha.unwrap_or_else(|| alpha.map_or(DVec2::ONE, |alpha| DVec2::new(alpha.x, alpha.y)))
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

/// Start region `index` of tiles x tiles inside the margin: equal ones, or where cells are excluded ones of about as many
/// cells that are left, so that each group of paths stands for as much of the map.
fn tile(map: &ImportedMap, tiles: usize, margin: usize, index: usize) -> Window {
    let field = &map.field;
    let Some(excluded) = &map.excluded else {
        let part = |cells: usize, k: usize| {
            let inner = cells - 2 * margin;
            (margin + k * inner / tiles, margin + (k + 1) * inner / tiles)
        };
        return Window { x: part(field.cells_x(), index % tiles), y: part(field.cells_y(), index / tiles) };
    };
    let whole = Window { x: (margin, field.cells_x() - margin), y: (margin, field.cells_y() - margin) };
    let row = |y: usize| Window { y: (y, y + 1), ..whole }.cells_outside(Some(excluded));
    let band = Window { y: share(whole.y, tiles, index / tiles, row), ..whole };
    let column = |x: usize| Window { x: (x, x + 1), ..band }.cells_outside(Some(excluded));
    Window { x: share(band.x, tiles, index % tiles, column), ..band }
}

/// Part `k` of `parts` of a range of lines, all of about as many cells as `cells` says that each line has.
fn share(
    (first, end): (usize, usize),
    parts: usize,
    k: usize,
    cells: impl Fn(usize) -> usize,
) -> (usize, usize) {
    let counts: Vec<usize> = (first..end).map(cells).collect();
    let all: usize = counts.iter().sum();
    let cut = |k: usize| {
        let mut before = 0;
        let line = counts.iter().position(|count| {
            before += count;
            before * parts > k * all
        });
        first + if k == 0 { 0 } else { line.unwrap_or(counts.len()) }
    };
    (cut(k), if k + 1 == parts { end } else { cut(k + 1) })
}
