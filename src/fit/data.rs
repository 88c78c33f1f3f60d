//! What a fit is made to: order 1 of a table, its weights, and how far the realisations scatter.

use crate::campaign::{Azimuth, Campaign, LightSide, Optics};
use crate::instrument::Grid;
use crate::table::{BrdfTable, Realisations};

/// Share of a colour's mean BRDF that is added to every value and every model: no bin, however dark, counts for more
/// than a thousand times its share of the hemisphere.
pub(super) const FLOOR: f64 = 1e-3;

/// A table as a fit sees it. Values are [colour][incidence * bins + bin].
#[derive(Debug, Clone)]
pub struct FitData {
    /// Incidences and bins.
    pub grid: Grid,
    /// Half-angle of the light's cone, rad.
    pub aperture: f64,
    /// `single`, 1/sr.
    pub value: Vec<Vec<f64>>,
    /// Squared standard errors of `value`, 0 for bins without light; `None` where the table knows no errors.
    pub variance: Option<Vec<Vec<f64>>>,
    /// Projected solid angles, sr; 1 for arms without an aperture; 0 for gaps, which count nowhere.
    pub size: Vec<f64>,
    /// What is added to values and models of each colour, 1/sr, > 0.
    pub floor: Vec<f64>,
    /// What parameters of each colour end in: nothing, or `_r`, `_w550`.
    pub suffixes: Vec<String>,
    /// Whether F = 1 is known, so that no amplitude is fitted to physical models.
    pub perfect_mirror: bool,
    /// Sides that the light may come from where facets are clear: the campaign's, or both where none is known and light
    /// goes through; empty for mirrors.
    pub clear: Vec<LightSide>,
    /// Whether the table distinguishes azimuths.
    pub absolute: bool,
    /// The campaign's turn of the sample, rad: alpha_x is given for the axis within 45 degrees of it.
    pub rotation: f64,
    /// `value` of each realisation, \[realisation\]\[colour\]\[entry\]; empty where they are not known.
    pub parts: Vec<Vec<Vec<f64>>>,
}

impl FitData {
    /// Whether it holds no light at all.
    pub fn is_dark(&self) -> bool {
        self.value.iter().flatten().all(|&value| value == 0.0)
    }

    /// The data of a table; `campaign` is `None` for an imported one.
    pub fn new(table: &BrdfTable, campaign: Option<&Campaign>, parts: Option<&Realisations>) -> FitData {
        let grid = table.grid.clone();
        let regions = (0..grid.incidences()).flat_map(|incidence| grid.regions(incidence));
        let size = regions.enumerate().map(|(entry, region)| {
            let size = Some(region.projected_solid_angle()).filter(|size| *size > 0.0).unwrap_or(1.0);
            if table.is_gap(entry) { 0.0 } else { size }
        });
        let size: Vec<f64> = size.collect();
        let value: Vec<Vec<f64>> = table.colours.iter().map(|colour| wide(&colour.single)).collect();
        let parts: Vec<Vec<Vec<f64>>> = parts.map_or(Vec::new(), |all| {
            all.parts.iter().map(|part| part.single.iter().map(|v| wide(v)).collect()).collect()
        });
        let variance = if parts.len() > 1 { Some(scatter(&parts)) } else { known(table, &size) };
        let average = campaign.is_some_and(|c| c.light.azimuth == Azimuth::Relative);
        FitData {
            aperture: campaign.map_or(0.0, |c| c.light.aperture_deg.to_radians()),
            perfect_mirror: campaign.is_some_and(|c| c.optics == Optics::PerfectMirror),
            clear: match campaign {
                Some(campaign) if campaign.optics.lets_through() => campaign.optics.light_sides(),
                None if grid.looks_below() => vec![LightSide::Front, LightSide::Back],
                _ => vec![],
            },
            absolute: !average && (!grid.phi_r_relative || grid.azimuths() > 1),
            rotation: campaign.map_or(0.0, |c| c.surface.rotation_deg.to_radians()),
            // A table without any scatter at all has no errors either.
            variance: variance.filter(|all| all.iter().flatten().any(|&square| square > 0.0)),
            floor: floors(&value, &size),
            suffixes: suffixes(table),
            size,
            parts,
            grid,
            value,
        }
    }

    /// Number of values that count.
    pub fn len(&self) -> usize {
        self.size.iter().filter(|size| **size > 0.0).count() * self.value.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// (colour, entry) of every value that counts.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize)> {
        let of = |colour: usize| (0..self.size.len()).map(move |entry| (colour, entry));
        (0..self.value.len()).flat_map(of).filter(|&(_, entry)| self.size[entry] > 0.0)
    }
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&value| f64::from(value)).collect()
}

/// Squared standard errors of the mean from the realisations themselves.
fn scatter(parts: &[Vec<Vec<f64>>]) -> Vec<Vec<f64>> {
    let square = |colour: usize, entry: usize| {
        let values = parts.iter().map(move |part| part[colour][entry]);
        crate::stats::mean_and_se(values).1.unwrap_or(0.0).powi(2)
    };
    let colour = |colour: usize| (0..parts[0][colour].len()).map(|entry| square(colour, entry)).collect();
    (0..parts[0].len()).map(colour).collect()
}

/// The table's own errors, where every value that counts has one. The error of an empty bin is a bound, not a draw.
fn known(table: &BrdfTable, size: &[f64]) -> Option<Vec<Vec<f64>>> {
    let square = |stderr: f32, entry: usize| match (size[entry] > 0.0, table.hits[entry]) {
        (true, 1..) => (stderr >= 0.0).then(|| f64::from(stderr).powi(2)),
        (true, 0) if stderr < 0.0 => None,
        _ => Some(0.0),
    };
    let colour = |stderr: &Vec<f32>| stderr.iter().enumerate().map(|(k, &se)| square(se, k)).collect();
    table.colours.iter().map(|channels| colour(&channels.stderr_single)).collect()
}

/// [`FLOOR`] of each colour's mean; a black colour has that of the brightest.
fn floors(value: &[Vec<f64>], size: &[f64]) -> Vec<f64> {
    let whole: f64 = size.iter().sum();
    let mean = |values: &Vec<f64>| values.iter().zip(size).map(|(f, w)| f * w).sum::<f64>() / whole;
    let means: Vec<f64> = value.iter().map(mean).collect();
    let most = means.iter().copied().fold(0.0, f64::max);
    let floor = |mean: f64| FLOOR * if mean > 0.0 { mean } else { most };
    means.into_iter().map(|mean| Some(floor(mean)).filter(|floor| *floor > 0.0).unwrap_or(FLOOR)).collect()
}

fn suffixes(table: &BrdfTable) -> Vec<String> {
    match table.colours.len() {
        1 => vec![String::new()],
        _ => table.colour_names().iter().map(|name| format!("_{}", name.to_lowercase())).collect(),
    }
}
