//! What lay on the stage, for the eye: a shaded piece of the first patch and its slopes against their law.

use glam::DVec2;

use super::quantiles::{self, SlopeQuantiles};
use super::relief::Relief;
use crate::campaign::{Campaign, SurfaceKind};
use crate::error::Result;
use crate::measure;
use crate::measure::patches::specimen::grains_of;
use crate::measure::{Patch, Patches};
use crate::report::plot::{Chart, ChartAxis, MEASURED, Marker, Series, SeriesStyle, model_style};
use crate::surface::{Certificate, Heightfield, SlopeLaw};

/// Cells along the longer side of the picture at most.
const MOST_CELLS: f64 = 224.0;
const FEWEST_CELLS: usize = 24;
/// Median slope that the picture is drawn with: the true one would show nothing, or nothing but shadow.
const SHOWN_SLOPE: f64 = 0.45;
/// Bins of the slope histogram, and their end in median slopes.
const SLOPE_BINS: usize = 40;
const LONGEST: f64 = 4.0;

/// The first patch, ready to be shown.
#[derive(Debug, Clone)]
pub struct PatchPicture {
    /// Columns and rows of the picture, in cells.
    pub cells: [usize; 2],
    /// Width of a cell over its height: 1/alpha_x to 1/alpha_y.
    pub aspect: f64,
    /// Grey values, row 0 on top (largest y).
    pub shades: Vec<u8>,
    /// Its heights.
    pub relief: Relief,
    /// What the patch really has.
    pub certificate: Certificate,
    /// Whether slopes are ratios of lengths, as those of a measured map are, and heights in the map's unit.
    pub of_map: bool,
    law: Option<SlopeLaw>,
    histogram: Vec<f64>,
    quantiles: Vec<SlopeQuantiles>,
    longest: f64,
}

/// The specimen, or why there is none.
pub type ShownSpecimen = std::result::Result<PatchPicture, String>;

/// The first patch of a campaign, made from its seed (or read from where its patches lie).
pub fn of_patches(patches: &Patches, campaign: &Campaign) -> Result<ShownSpecimen> {
    Ok(match patches.realisation(0)? {
        measure::Specimen::Patch(patch) => Ok(PatchPicture::of(&patch, campaign)),
        measure::Specimen::Grains(fields) => {
            let grains = grains_of(&fields, campaign.alphas().first().copied().flatten());
            Ok(PatchPicture::of(&Patch::of_grains(grains, campaign.surface.cells as usize), campaign))
        }
        measure::Specimen::Statistical { .. } => {
            Err("A statistical Smith surface has no heights: there is no patch to show.".into())
        }
    })
}

/// The first patch, made anew from campaign and seed alone where the surface follows from them.
pub fn remade(campaign: &Campaign) -> Result<ShownSpecimen> {
    match &campaign.surface.kind {
        SurfaceKind::File(map) if !map.resolved_path.is_file() => {
            Ok(Err(format!("The surface is the height map {}, which is not here.", map.path)))
        }
        _ => of_patches(&Patches::prepare(campaign, &mut Vec::new())?, campaign),
    }
}

impl PatchPicture {
    /// A patch as its campaign's roughness makes it.
    pub fn of(patch: &Patch, campaign: &Campaign) -> Self {
        let alpha = patch.alpha(campaign.alphas().first().copied().flatten());
        let grains = campaign.surface.kind.explicit_grains().and_then(|grains| grains.alphas[0].coverage);
        let law = grains.map(|coverage| SlopeLaw::Grains { coverage }).or_else(|| Patches::law(campaign));
        let of_map = matches!(campaign.surface.kind, SurfaceKind::File(_));
        // Slopes as they are shown, and what is left of the canonical ones' alpha for the picture.
        let (shown, left) = if of_map { (alpha, DVec2::ONE) } else { (DVec2::ONE, alpha) };
        let certificate = match law {
            None if of_map => Certificate::of_map(&patch.field, alpha),
            law => Certificate::of(&patch.field, law),
        };
        let cells = piece(&patch.field, alpha.x / alpha.y);
        // Of grains, the median without the plane is that of half-spheres.
        let median = if grains.is_some() { 1.0 } else { certificate.median_slope };
        let scale = SHOWN_SLOPE / (median.max(1e-9) * (left.x * left.y).sqrt());
        let shades = shades(&patch.field, cells, [alpha.x * scale, alpha.y * scale]);
        let longest = LONGEST * if median > 0.0 { median } else { 1.0 };
        let histogram = histogram(&patch.field, shown, longest);
        let pitch_um = match &campaign.surface.kind {
            SurfaceKind::File(map) => map.pitch_x_um,
            SurfaceKind::Psd(psd) => Some(psd.pitch_um),
            _ => campaign.scale.pitch_um,
        };
        let relief = Relief::new(&patch.field, cells, alpha.x, scale, pitch_um);
        let quantiles = law.map_or(Vec::new(), |law| quantiles::of(&patch.field, law));
        PatchPicture {
            cells,
            aspect: alpha.y / alpha.x,
            shades,
            relief,
            quantiles,
            certificate,
            of_map,
            law,
            histogram,
            longest,
        }
    }

    /// Share of the facets per unit of slope length, and the same of the law, bin by bin.
    pub fn slopes(&self) -> Chart {
        let width = self.longest / SLOPE_BINS as f64;
        let middle = |bin: usize| (bin as f64 + 0.5) * width;
        let points = self.histogram.iter().enumerate().map(|(bin, share)| [middle(bin), share / width]);
        let points: Vec<[f64; 2]> = points.collect();
        let mut highest = points.iter().map(|point| point[1]).fold(0.0, f64::max);
        let style = SeriesStyle { marker: Marker::Ring, line: false, ..MEASURED };
        let mut series = vec![Series::new("facets of patch 0", points, style)];
        if let Some(law) = self.law {
            let share = |bin: usize| {
                let [low, high] = [bin as f64 * width, (bin + 1) as f64 * width];
                [middle(bin), (law.length_cdf(high) - law.length_cdf(low)) / width]
            };
            let points: Vec<[f64; 2]> = (0..SLOPE_BINS).map(share).collect();
            highest = points.iter().map(|point| point[1]).fold(highest, f64::max);
            let label = format!("{law:?} law").to_lowercase();
            series.push(Series::new(label, points, SeriesStyle { dashes: "", ..model_style(1) }));
        }
        Chart {
            title: "Slopes of the patch".into(),
            x: ChartAxis::linear(
                if self.of_map { "slope" } else { "slope length, units of alpha" },
                [0.0, self.longest],
            ),
            y: ChartAxis::linear("density", [0.0, (1.08 * highest).max(1e-6)]),
            series,
        }
    }
}

impl PatchPicture {
    /// Quantiles of the slopes against the law's, where one is wanted.
    pub fn quantiles(&self) -> Option<Chart> {
        quantiles::chart(&self.quantiles)
    }
}

/// Cells along x and y that make a square piece of the world, as far as the patch has them.
fn piece(field: &Heightfield, x_over_y: f64) -> [usize; 2] {
    let [most_x, most_y] = [MOST_CELLS * x_over_y.min(1.0), MOST_CELLS / x_over_y.max(1.0)];
    let cells = |most: f64, there: usize| (most.round() as usize).max(FEWEST_CELLS).min(there);
    [cells(most_x, field.cells_x()), cells(most_y, field.cells_y())]
}

/// Lambert shading of the lower facets under a lamp at the upper left, 45 degrees high.
fn shades(field: &Heightfield, [columns, rows]: [usize; 2], scale: [f64; 2]) -> Vec<u8> {
    let lamp = glam::DVec3::new(-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2);
    let shade = |x: usize, y: usize| {
        let slope = field.corners(x, y).lower_slope();
        let normal = glam::DVec3::new(-slope.x * scale[0], -slope.y * scale[1], 1.0).normalize();
        (255.0 * normal.dot(lamp).max(0.0)).round() as u8
    };
    (0..rows).rev().flat_map(|y| (0..columns).map(move |x| shade(x, y))).collect()
}

/// Share of all facets by slope length; longer ones are in no bin. `alpha`: slope of one unit of height a cell.
fn histogram(field: &Heightfield, alpha: DVec2, longest: f64) -> Vec<f64> {
    let mut counts = vec![0u64; SLOPE_BINS];
    for y in 0..field.cells_y() {
        for x in 0..field.cells_x() {
            let corners = field.corners(x, y);
            for slope in [corners.lower_slope(), corners.upper_slope()] {
                if let Some(count) =
                    counts.get_mut(((slope * alpha).length() / longest * SLOPE_BINS as f64) as usize)
                {
                    *count += 1;
                }
            }
        }
    }
    let facets = 2.0 * (field.cells_x() * field.cells_y()) as f64;
    counts.into_iter().map(|count| count as f64 / facets).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ridges along y of slope +-1: every facet has slope length 1.
    #[test]
    fn the_histogram_counts_every_facet_once() {
        let field = Heightfield::new(8, 8, true, (0..64).map(|i| f64::from(i % 2)).collect());
        let shares = histogram(&field, DVec2::ONE, 4.0);
        // Slope 1 is the lower edge of bin 10 of 40 up to 4.
        assert_eq!((shares[10], shares.iter().sum::<f64>()), (1.0, 1.0));
    }

    #[test]
    fn a_brushed_piece_is_square_in_the_world() {
        let field = Heightfield::new(512, 512, true, vec![0.0; 512 * 512]);
        // Cells are 1/alpha_x by 1/alpha_y: four times as long along x for 0.1 x 0.4.
        assert_eq!(piece(&field, 0.25), [56, 224]);
        assert_eq!(piece(&field, 1.0), [224, 224]);
        assert_eq!(piece(&field, 4.0), [224, 56]);
    }
}
