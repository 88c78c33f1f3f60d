//! What lay on the stage, for the eye: a shaded piece of the first patch and its slopes against their law.

mod facts;
pub mod quantiles;
mod relief;

use std::sync::{Arc, OnceLock};

use glam::DVec2;

pub use facts::PatchFacts;

use facts::{MOST_CELLS, SLOPE_BINS};
use relief::Relief;

use crate::campaign::{Campaign, SurfaceKind};
use crate::error::Result;
use crate::measure::patches::specimen::{grains_of, world_slope};
use crate::measure::{Patch, Patches, Specimen};
use crate::report::plot::{Chart, ChartAxis, MEASURED, Marker, Series, SeriesStyle, model_style};
use crate::surface::Heightfield;

const FEWEST_CELLS: usize = 24;
/// Median slope that the picture is drawn with: the true one would show nothing, or nothing but shadow.
const SHOWN_SLOPE: f64 = 0.45;

/// The first patch, ready to be shown under the roughness of a table.
#[derive(Debug, Clone)]
pub struct PatchPicture {
    /// What is the same under every roughness.
    pub facts: Arc<PatchFacts>,
    /// Columns and rows of the picture, in cells.
    pub cells: [usize; 2],
    /// Width of a cell over its height: 1/alpha_x to 1/alpha_y.
    pub aspect: f64,
    /// Grey values, row 0 on top (largest y).
    pub shades: Vec<u8>,
    /// Its heights.
    pub relief: Relief,
}

/// The specimen, or why there is none.
pub type ShownSpecimen = std::result::Result<PatchPicture, String>;

/// The first patch of a run, for the pages of all its tables: those of several roughnesses show the same heights, and making
/// these again would take longer than all else of a page.
#[derive(Debug, Default)]
pub struct FirstPatch(OnceLock<Arc<PatchFacts>>);

impl FirstPatch {
    /// Looks at the first specimen of a campaign while it is there. Grains and laws are made again in no time.
    pub fn look(&self, specimen: &Specimen, campaign: &Campaign) {
        if let Specimen::Patch(patch) = specimen {
            self.0.get_or_init(|| Arc::new(PatchFacts::of(patch, campaign)));
        }
    }

    /// What a table's page shows; what was not looked at is made from its seed (or read from where the patches lie).
    pub fn shown(&self, patches: &Patches, campaign: &Campaign) -> Result<ShownSpecimen> {
        if let Some(picture) = self.looked_at(campaign) {
            return Ok(Ok(picture));
        }
        let specimen = patches.realisation(0)?;
        self.look(&specimen, campaign);
        let picture = match specimen {
            Specimen::Patch(_) => self.looked_at(campaign),
            Specimen::Grains(fields) => {
                let grains = grains_of(&fields, campaign.alphas().first().copied().flatten());
                let patch = Patch::of_grains(grains, campaign.surface.cells as usize);
                Some(PatchPicture::of(PatchFacts::of(&patch, campaign).into(), campaign))
            }
            Specimen::Statistical { .. } => None,
        };
        let why = "A statistical Smith surface has no heights: there is no patch to show.";
        Ok(picture.ok_or(why.into()))
    }

    fn looked_at(&self, campaign: &Campaign) -> Option<PatchPicture> {
        self.0.get().map(|facts| PatchPicture::of(Arc::clone(facts), campaign))
    }

    /// The same where campaign and seed are all there is.
    pub fn remade(&self, campaign: &Campaign) -> Result<ShownSpecimen> {
        match (self.looked_at(campaign), &campaign.surface.kind) {
            (Some(picture), _) => Ok(Ok(picture)),
            (None, SurfaceKind::File(map)) if !map.resolved_path.is_file() => {
                Ok(Err(format!("The surface is the height map {}, which is not here.", map.path)))
            }
            (None, _) => self.shown(&Patches::prepare(campaign, &mut Vec::new())?, campaign),
        }
    }
}

impl PatchPicture {
    /// A patch as its campaign's roughness makes it.
    pub fn of(facts: Arc<PatchFacts>, campaign: &Campaign) -> Self {
        let alpha = world_slope(facts.own_alpha, campaign.alphas().first().copied().flatten());
        // What of it the median does not have yet.
        let left = if facts.of_map { DVec2::ONE } else { alpha };
        let cells = piece(&facts.corner, alpha.x / alpha.y);
        let scale = SHOWN_SLOPE / (facts.median.max(1e-9) * (left.x * left.y).sqrt());
        let shades = shades(&facts.corner, cells, [alpha.x * scale, alpha.y * scale]);
        let pitch_um = match &campaign.surface.kind {
            SurfaceKind::File(map) => map.pitch_x_um,
            SurfaceKind::Psd(psd) => Some(psd.pitch_um),
            _ => campaign.scale.pitch_um,
        };
        let relief = Relief::new(&facts.corner, cells, alpha.x, scale, pitch_um);
        PatchPicture { cells, aspect: alpha.y / alpha.x, shades, relief, facts }
    }

    /// Share of the facets per unit of slope length, and the same of the law, bin by bin.
    pub fn slopes(&self) -> Chart {
        let PatchFacts { histogram, longest, law, of_map, .. } = &*self.facts;
        let width = longest / SLOPE_BINS as f64;
        let middle = |bin: usize| (bin as f64 + 0.5) * width;
        let points = histogram.iter().enumerate().map(|(bin, share)| [middle(bin), share / width]);
        let points: Vec<[f64; 2]> = points.collect();
        let mut highest = points.iter().map(|point| point[1]).fold(0.0, f64::max);
        let style = SeriesStyle { marker: Marker::Ring, line: false, ..MEASURED };
        let mut series = vec![Series::new("facets of patch 0", points, style)];
        if let Some(law) = law {
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
                if *of_map { "slope" } else { "slope length, units of alpha" },
                [0.0, *longest],
            ),
            y: ChartAxis::linear("density", [0.0, (1.08 * highest).max(1e-6)]),
            series,
        }
    }

    /// Quantiles of the slopes against the law's, where one is wanted.
    pub fn quantiles(&self) -> Option<Chart> {
        quantiles::chart(&self.facts.quantiles)
    }
}

/// Cells along x and y that make a square piece of the world, as far as the patch has them.
fn piece(field: &Heightfield, x_over_y: f64) -> [usize; 2] {
    let [most_x, most_y] = [x_over_y.min(1.0), 1.0 / x_over_y.max(1.0)].map(|part| MOST_CELLS as f64 * part);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_brushed_piece_is_square_in_the_world() {
        let field = Heightfield::new(512, 512, true, vec![0.0; 512 * 512]);
        // Cells are 1/alpha_x by 1/alpha_y: four times as long along x for 0.1 x 0.4.
        assert_eq!(piece(&field, 0.25), [56, 224]);
        assert_eq!(piece(&field, 1.0), [224, 224]);
        assert_eq!(piece(&field, 4.0), [224, 56]);
    }
}
