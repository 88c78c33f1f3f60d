//! What a fit is made to: order 1 of a table, and how far off each value may be.

use crate::campaign::{Azimuth, Campaign, Optics};
use crate::instrument::{Grid, Region};
use crate::table::{BrdfTable, Realisations};

/// Share of a value, and of the stop's peak, that stands for the error where a table says nothing of errors.
const UNKNOWN_ERROR: f64 = 0.01;

/// A table as a fit sees it. Values are [colour][stop * bins + bin].
#[derive(Debug, Clone)]
pub struct Data {
    /// Stops and bins.
    pub grid: Grid,
    /// Half-angle of the light's cone, rad.
    pub aperture: f64,
    /// `single`, 1/sr.
    pub value: Vec<Vec<f64>>,
    /// What residuals are divided by, 1/sr, > 0.
    pub sigma: Vec<Vec<f64>>,
    /// Projected solid angles, sr; 1 for arms without an aperture.
    pub size: Vec<f64>,
    /// Whether `sigma` comes from the table's errors.
    pub has_errors: bool,
    /// Whether F = 1 is known, so that no amplitude is fitted to physical models.
    pub perfect_mirror: bool,
    /// Whether the table tells azimuths apart.
    pub absolute: bool,
    /// The campaign's turn of the sample, rad: alpha_x is given for the axis within 45 degrees of it.
    pub rotation: f64,
    /// `value` of each realisation, [realisation][colour][entry]; empty where they are not known.
    pub parts: Vec<Vec<Vec<f64>>>,
}

impl Data {
    /// The data of a table; `campaign` is `None` for an imported one.
    ///
    /// sigma^2 = stderr^2 + q^2, q the BRDF of one hit: the standard error of a bin of few hits is itself a draw, and
    /// bins that drew a small one would pull the fit down. An empty bin has the value 0 and its stderr of 1.5 hits.
    pub fn new(table: &BrdfTable, campaign: Option<&Campaign>, parts: Option<&Realisations>) -> Data {
        let grid = table.grid.clone();
        let regions = (0..grid.stops()).flat_map(|stop| grid.regions(stop));
        let size = regions
            .map(|region| Some(Region::projected_solid_angle(&region)).filter(|w| *w > 0.0).unwrap_or(1.0));
        let value: Vec<Vec<f64>> = table.colours.iter().map(|colour| wide(&colour.single)).collect();
        let errors = table.colours.iter().zip(&value);
        let (sigma, known): (Vec<_>, Vec<bool>) = errors
            .map(|(colour, value)| sigmas(value, &colour.stderr_single, &table.hits, grid.bins()))
            .unzip();
        let average = campaign.is_some_and(|c| c.light.azimuth == Azimuth::Relative);
        Data {
            aperture: campaign.map_or(0.0, |c| c.light.aperture_deg.to_radians()),
            perfect_mirror: campaign.is_some_and(|c| c.optics == Optics::PerfectMirror),
            absolute: !average && (!grid.phi_r_relative || grid.phi_i_deg.len() > 1),
            rotation: campaign.map_or(0.0, |c| c.surface.rotation_deg.to_radians()),
            size: size.collect(),
            has_errors: known.iter().all(|&known| known),
            parts: parts.map_or(Vec::new(), |all| {
                all.parts.iter().map(|part| part.single.iter().map(|v| wide(v)).collect()).collect()
            }),
            grid,
            value,
            sigma,
        }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.value.iter().map(Vec::len).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The table without one realisation: (R f - f_k)/(R - 1), R f the sum of the realisations themselves.
    pub fn without(&self, left_out: usize) -> Vec<Vec<f64>> {
        let others = (self.parts.len() - 1) as f64;
        let mean = |colour: usize, entry: usize| {
            let rest = self.parts.iter().enumerate().filter(|(k, _)| *k != left_out);
            rest.map(|(_, part)| part[colour][entry]).sum::<f64>() / others
        };
        let colour = |colour: usize| (0..self.value[colour].len()).map(|entry| mean(colour, entry)).collect();
        (0..self.value.len()).map(colour).collect()
    }
}

fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&value| f64::from(value)).collect()
}

/// The errors of one colour, and whether the table knows them.
fn sigmas(value: &[f64], stderr: &[f32], hits: &[u32], bins: usize) -> (Vec<f64>, bool) {
    let of = |(entry, (&value, &stderr)): (usize, (&f64, &f32))| {
        let (stderr, hits) = (f64::from(stderr), f64::from(hits[entry]));
        let one_hit = if hits > 0.0 { value / hits } else { 0.0 };
        let known = (stderr * stderr + one_hit * one_hit).sqrt();
        (stderr >= 0.0 && known > 0.0).then_some(known)
    };
    let all: Option<Vec<f64>> = value.iter().zip(stderr).enumerate().map(of).collect();
    if let Some(sigma) = all {
        return (sigma, true);
    }
    let peaks = value.chunks(bins).map(|stop| stop.iter().copied().fold(0.0, f64::max));
    let peaks: Vec<f64> = peaks.map(|peak| if peak > 0.0 { peak } else { 1.0 }).collect();
    let guess =
        |(entry, value): (usize, &f64)| UNKNOWN_ERROR * value.hypot(UNKNOWN_ERROR * peaks[entry / bins]);
    (value.iter().enumerate().map(guess).collect(), false)
}
