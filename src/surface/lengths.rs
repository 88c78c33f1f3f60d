//! The physical lengths of a surface: rms height, pitch, correlation length and radius of curvature, um.

use std::f64::consts::FRAC_2_PI;

use glam::DVec2;

use super::heightfield::Heightfield;
use super::io::import;
use super::synthesis::Synthesiser;
use super::synthesis::slope_law::SlopeLaw;
use crate::campaign::{Alpha, HeightMap, HeightSpectrum, PsdSurface, Surface, SurfaceKind};
use crate::psd::PsdMoments;
use crate::rng::{self, Purpose, StreamId};

/// Cells a side of a patch that stands for larger ones, and its correlation length: 32 of them a side.
const CELLS: usize = 256;
const CORRELATION: f64 = 8.0;

/// Lengths of a surface, um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceLengths {
    /// Root mean square height.
    pub rms_height_um: f64,
    /// Distance of neighbouring heights: the width of a facet; the smaller of those along x and y.
    pub pitch_um: f64,
    /// Correlation length, along the axis where it is shorter; `None` for a measured map.
    pub correlation_um: Option<f64>,
    /// One over the mean of the heights' second derivative, its sign left out, along the axis where that is larger;
    /// infinite where nothing is curved.
    pub curvature_radius_um: f64,
}

/// Lengths of random heights in units of their cells and of their own roughness.
#[derive(Debug, Clone, Copy)]
struct CanonicalLengths {
    rms_height: f64,
    correlation: f64,
    /// Mean of the second difference along an axis, its sign left out.
    curvature: f64,
}

impl SurfaceLengths {
    /// Of a surface with one of its roughnesses; `pitch_um` where random heights have none of their own, `law` that of their
    /// slopes. `Err`: why they are not known, and what to add.
    ///
    /// Gaussian heights: sums over their waves. Other random heights: a patch of 256 x 256 cells with bumps of 8, scaled;
    /// rms and curvature of such a patch are within some per cent of those of all.
    // Tested by `lengths_of_gaussian_heights_are_closed_forms` (tests/it/validate/wave_limits.rs).
    pub fn of(
        surface: &Surface,
        law: Option<SlopeLaw>,
        alpha: Option<Alpha>,
        pitch_um: Option<f64>,
    ) -> Result<Self, String> {
        match &surface.kind {
            SurfaceKind::Psd(psd) => Ok(of_psd(psd, surface.cells)),
            SurfaceKind::File(map) => of_map(map),
            SurfaceKind::Mirror => Err("a flat mirror has no roughness".into()),
            SurfaceKind::Smith(_) => Err("a statistical surface has no heights".into()),
            kind => {
                let (Some(law), Some(alpha)) = (law, alpha) else {
                    return Err(format!("[surface.{}] has no size", kind.name()));
                };
                let pitch = pitch_um.ok_or("the cells have no size: add [scale] with pitch_um")?;
                Ok(of_heights(canonical(surface, law), DVec2::new(alpha.x, alpha.y), pitch))
            }
        }
    }
}

fn of_psd(psd: &PsdSurface, cells: u32) -> SurfaceLengths {
    let moments = PsdMoments::of(&psd.psd, cells, psd.pitch_um);
    SurfaceLengths {
        rms_height_um: moments.rms_um,
        pitch_um: psd.pitch_um,
        correlation_um: Some(moments.correlation_um()),
        curvature_radius_um: 1.0 / mean_of_gaussian(moments.curvature_per_um),
    }
}

/// The mean of |x| of a Gaussian x.
fn mean_of_gaussian(rms: f64) -> f64 {
    FRAC_2_PI.sqrt() * rms
}

/// Heights in um are canonical ones times alpha.x pitch_x, and as much as alpha.y pitch_y.
fn of_heights(canonical: CanonicalLengths, alpha: DVec2, pitch_x: f64) -> SurfaceLengths {
    let unit = alpha.x * pitch_x;
    let pitch = DVec2::new(pitch_x, unit / alpha.y);
    let shortest = pitch.min_element();
    SurfaceLengths {
        rms_height_um: unit * canonical.rms_height,
        pitch_um: shortest,
        correlation_um: Some(shortest * canonical.correlation),
        curvature_radius_um: shortest * shortest / (unit * canonical.curvature),
    }
}

fn canonical(surface: &Surface, law: SlopeLaw) -> CanonicalLengths {
    let (cells, correlation) = (surface.cells as usize, surface.correlation_cells);
    if let SurfaceKind::Beckmann { spectrum, .. } = surface.kind {
        let [rms_height, curvature] = Synthesiser::gaussian_moments(cells, correlation, spectrum);
        return CanonicalLengths { rms_height, correlation, curvature: mean_of_gaussian(curvature) };
    }
    let id = StreamId { seed: 0, purpose: Purpose::Surface, realisation: 0, incidence: 0, block: 0 };
    let small = cells as f64 / correlation < CELLS as f64 / CORRELATION;
    let (side, bumps) = if small { (cells, correlation) } else { (CELLS, CORRELATION) };
    let patch =
        Synthesiser::with_spectrum(law, side, bumps, HeightSpectrum::Gaussian).patch(&mut rng::stream(id));
    let [rms_height, curvature] = measured(&patch);
    // Bumps twice as wide are twice as high and half as curved.
    let scale = correlation / bumps;
    CanonicalLengths { rms_height: scale * rms_height, correlation, curvature: curvature / scale }
}

/// Rms height of a periodic patch, and the mean of its second differences along x and y, signs left out.
fn measured(patch: &Heightfield) -> [f64; 2] {
    let (columns, rows) = (patch.cells_x(), patch.cells_y());
    let heights = patch.heights();
    let at = |x: usize, y: usize| heights[y % rows * columns + x % columns];
    let count = heights.len() as f64;
    let mean = heights.iter().sum::<f64>() / count;
    let variance = heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / count;
    let second = |x: usize, y: usize| {
        let middle = 2.0 * at(x + 1, y + 1);
        let along_x = at(x, y + 1) + at(x + 2, y + 1) - middle;
        let along_y = at(x + 1, y) + at(x + 1, y + 2) - middle;
        0.5 * (along_x.abs() + along_y.abs())
    };
    let row = |y: usize| (0..columns).map(|x| second(x, y)).sum::<f64>();
    [variance.sqrt(), (0..rows).map(row).sum::<f64>() / count]
}

/// A measured map, prepared but not refined.
fn of_map(map: &HeightMap) -> Result<SurfaceLengths, String> {
    if !map.resolved_path.is_file() {
        return Err(format!("the height map {} is not here", map.path));
    }
    let steps = import::load_steps(map).map_err(|error| error.to_string())?;
    let unit =
        steps.unit_um.ok_or("heights have no unit: add height_unit_um and pitches under [surface.file]")?;
    let (heights, grid) = (&steps.after, &steps.grid);
    let (columns, rows) = (grid.columns, grid.rows(heights));
    let count = heights.len() as f64;
    let mean = heights.iter().sum::<f64>() / count;
    let variance = heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / count;
    let at = |x: usize, y: usize| heights[y * columns + x];
    let inner = |f: &dyn Fn(usize, usize) -> f64, first: [usize; 2]| {
        let places =
            (first[1]..rows - first[1]).flat_map(|y| (first[0]..columns - first[0]).map(move |x| (x, y)));
        let (sum, count) = places.fold((0.0, 0.0), |(sum, count), (x, y)| (sum + f(x, y).abs(), count + 1.0));
        sum / count
    };
    let [px, py] = grid.pitch;
    let along_x = inner(&|x, y| at(x - 1, y) + at(x + 1, y) - 2.0 * at(x, y), [1, 0]) / (px * px);
    let along_y = inner(&|x, y| at(x, y - 1) + at(x, y + 1) - 2.0 * at(x, y), [0, 1]) / (py * py);
    Ok(SurfaceLengths {
        rms_height_um: unit * variance.sqrt(),
        pitch_um: unit * px.min(py),
        correlation_um: None,
        curvature_radius_um: unit / along_x.max(along_y),
    })
}
