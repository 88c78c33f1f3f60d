//! How far a file is from the table that it was made of: the file's own reader, averaged over the table's bins.

use rayon::prelude::*;
use serde::Serialize;

use super::Brdf;
use super::resample::mean;
use crate::error::{Checked, wrong};
use crate::instrument::{Grid, GridKind, Region};
use crate::sphere;
use crate::table::{BrdfTable, ColourChannels};

/// Bins that are compared at most; of larger tables every k-th.
const MOST_BINS: usize = 400_000;

/// The error of reading a file back.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReadBack {
    /// Sum of |file - table| w over sum of table w, w the projected solid angle; mean over incidences and colours.
    pub l1: f64,
    /// The worst bin: |file - table| over the largest value of its incidence and colour.
    pub worst: f64,
    /// Its incidence, (theta_i, phi_i) in degrees.
    #[serde(rename = "worst_stop_deg")]
    pub worst_incidence_deg: (f64, f64),
    /// The middle of the bin, (theta_r, phi_r) in degrees.
    pub worst_bin_deg: (f64, f64),
    /// Bins compared, of all colours once.
    pub bins: usize,
}

/// Compares `brdf` with the totals of `table`. Points count with their cosine.
///
/// `None` where the table holds nothing but zeros.
pub fn read_back(table: &BrdfTable, brdf: &dyn Brdf) -> Option<ReadBack> {
    let (incidences, bins) = (table.grid.incidences(), table.grid.bins());
    // A stride that shares no factor with the bins visits all azimuths alike.
    let mut stride = (incidences * bins).div_ceil(MOST_BINS);
    while stride > 1 && bins.is_multiple_of(stride) {
        stride += 1;
    }
    let found: Vec<IncidenceErrors> = (0..incidences)
        .into_par_iter()
        .map(|incidence| incidence_errors(table, brdf, incidence, stride))
        .collect();
    let mut errors = ReadErrors::default();
    found.iter().enumerate().for_each(|(incidence, found)| errors.add(&table.grid, incidence, found));
    errors.read_back()
}

fn incidence_errors(table: &BrdfTable, brdf: &dyn Brdf, incidence: usize, stride: usize) -> IncidenceErrors {
    let (grid, bins) = (&table.grid, table.grid.bins());
    let (wi, regions) = (grid.wi(incidence), grid.regions(incidence));
    let mut errors = IncidenceErrors::of(table, incidence);
    for bin in (incidence % stride..bins).step_by(stride).filter(|_| wi.z > 0.0) {
        let (found, size) = (mean(brdf, wi, &regions[bin]), size_of(&regions[bin]));
        for (colour, channels) in table.colours.iter().enumerate() {
            let value = f64::from(channels.total[incidence * bins + bin]);
            let off = (found[colour.min(brdf.colours() - 1)] - value).abs();
            errors.add(bin, colour, size, [off, value]);
        }
    }
    errors
}

/// How far the bins of one incidence are off.
struct IncidenceErrors {
    /// By colour: the largest value, the sum of distances, the sum of values.
    sums: Vec<[f64; 3]>,
    /// The largest distance over the largest value, and its bin.
    worst: (f64, usize),
    /// Values compared.
    count: usize,
}

impl IncidenceErrors {
    fn of(table: &BrdfTable, incidence: usize) -> Self {
        let bins = table.grid.bins();
        let peak = |colour: &ColourChannels| {
            let values = colour.total[incidence * bins..][..bins].iter();
            [values.fold(0.0, |most, &v| f64::max(most, f64::from(v))), 0.0, 0.0]
        };
        IncidenceErrors { sums: table.colours.iter().map(peak).collect(), worst: (0.0, 0), count: 0 }
    }

    fn add(&mut self, bin: usize, colour: usize, size: f64, [off, value]: [f64; 2]) {
        let [peak, distance, sum] = &mut self.sums[colour];
        *distance += size * off;
        *sum += size * value;
        if *peak > 0.0 && off > self.worst.0 * *peak {
            self.worst = (off / *peak, bin);
        }
        self.count += 1;
    }
}

/// Values that a reader finds at the table's own bins, in any order, compared with it as they come.
pub struct Listing<'a> {
    table: &'a BrdfTable,
    /// Of the bins of any incidence.
    sizes: Vec<f64>,
    incidences: Vec<IncidenceErrors>,
}

impl<'a> Listing<'a> {
    /// Nothing found so far.
    pub fn new(table: &'a BrdfTable) -> Self {
        let sizes = table.grid.regions(0).iter().map(size_of).collect();
        let incidences =
            (0..table.grid.incidences()).map(|incidence| IncidenceErrors::of(table, incidence)).collect();
        Listing { table, sizes, incidences }
    }

    /// Takes in a value of an incidence, bin and colour; what stands for a gap is passed over.
    pub fn add(&mut self, incidence: usize, bin: usize, colour: usize, found: f32) {
        let entry = incidence * self.sizes.len() + bin;
        if !self.table.is_gap(entry) {
            let value = self.table.colours[colour].total[entry];
            let off = f64::from((found - value).abs());
            self.incidences[incidence].add(bin, colour, self.sizes[bin], [off, value.into()]);
        }
    }

    /// The measures; `None` as for [`read_back`]. Values that are missing, or are there twice, are a reason.
    pub fn finish(self) -> Checked<Option<ReadBack>> {
        let mut errors = ReadErrors::default();
        errors.join(self)?;
        Ok(errors.read_back())
    }
}

/// How far a file is off, over the incidences that were compared so far.
#[derive(Default)]
pub struct ReadErrors {
    /// Distance over sum of every incidence and colour with light.
    ratios: Vec<f64>,
    worst: f64,
    /// Incidence and bin of the worst, degrees.
    place: [(f64, f64); 2],
    bins: usize,
}

impl ReadErrors {
    fn add(&mut self, grid: &Grid, incidence: usize, errors: &IncidenceErrors) {
        let with_light = errors.sums.iter().filter(|sums| sums[2] > 0.0);
        self.ratios.extend(with_light.map(|[_, distance, sum]| distance / sum));
        let (worst, bin) = errors.worst;
        if self.bins == 0 || worst > self.worst {
            self.worst = worst;
            self.place = [grid.incidence_deg(incidence), middles_deg(grid, incidence)[bin]];
        }
        self.bins += errors.count / errors.sums.len();
    }

    /// Takes in a band that was read to its end.
    pub fn join(&mut self, band: Listing) -> Checked<()> {
        let grid = &band.table.grid;
        let wanted = (grid.incidences() * grid.bins() - band.table.gaps()) * band.table.colours.len();
        let count: usize = band.incidences.iter().map(|errors| errors.count).sum();
        if count != wanted {
            return Err(wrong!("{count} values, {wanted} needed"));
        }
        band.incidences.iter().enumerate().for_each(|(incidence, errors)| self.add(grid, incidence, errors));
        Ok(())
    }

    /// The measures; `None` as for [`read_back`].
    pub fn read_back(self) -> Option<ReadBack> {
        (!self.ratios.is_empty()).then(|| ReadBack {
            l1: self.ratios.iter().sum::<f64>() / self.ratios.len() as f64,
            worst: self.worst,
            worst_incidence_deg: self.place[0],
            worst_bin_deg: self.place[1],
            bins: self.bins,
        })
    }
}

/// Compares totals in the table's own order with the table.
pub fn listed(table: &BrdfTable, totals: &[&[f32]]) -> Checked<Option<ReadBack>> {
    let (bins, mut listing) = (table.grid.bins(), Listing::new(table));
    for (colour, found) in totals.iter().enumerate().take(table.colours.len()) {
        found.iter().enumerate().for_each(|(k, &value)| listing.add(k / bins, k % bins, colour, value));
    }
    listing.finish()
}

/// What a bin counts with: its projected solid angle, of a single direction the cosine.
fn size_of(region: &Region) -> f64 {
    match region {
        Region::Cap { axis, half_angle: 0.0 } => axis.z.abs(),
        region => region.projected_solid_angle(),
    }
}

/// The middles of an incidence's bins in degrees, azimuths absolute, to ten digits after the point. They are the
/// grid's own angles, not those of its unit vectors: the azimuth of an arm at the pole is kept, and so is a negative
/// one. A negative polar angle is the far side of its plane.
// Tested by `an_arm_at_the_pole_keeps_its_azimuths` (tests/it/interchange/interchange_angles.rs).
pub fn middles_deg(grid: &Grid, incidence: usize) -> Vec<(f64, f64)> {
    let turn = if grid.phi_r_relative { grid.incidence_deg(incidence).1 } else { 0.0 };
    let listed = match grid.kind {
        GridKind::Arm => {
            grid.theta_r_deg.iter().flat_map(|&t| grid.phi_r_deg.iter().map(move |&p| [t, p])).collect()
        }
        GridKind::Points => grid.points_deg.clone(),
        _ => return grid.regions(incidence).iter().map(middle_deg).collect(),
    };
    let middle = |[theta, phi]: [f64; 2]| {
        let [theta, phi] = upper([theta, phi + turn]);
        (digits(theta), digits(phi))
    };
    listed.into_iter().map(middle).collect()
}

/// The same direction with a polar angle that is not negative and an azimuth in [-360, 360].
pub fn upper([theta, phi]: [f64; 2]) -> [f64; 2] {
    let phi = if theta < 0.0 { phi + 180.0 } else { phi };
    [theta.abs(), if phi.abs() > 360.0 { sphere::reduced_deg(phi) } else { phi }]
}

/// To ten digits after the point: what is left of decimal angles after a turn.
pub fn digits(angle: f64) -> f64 {
    (angle * 1e10).round() / 1e10
}

/// The middle of a bin in degrees, to ten digits after the point.
fn middle_deg(region: &Region) -> (f64, f64) {
    match *region {
        Region::Rectangle { theta: [t1, t2], phi: [p1, p2] } => {
            (digits(0.5 * (t1 + t2).to_degrees()), digits(0.5 * (p1 + p2).to_degrees()))
        }
        Region::Cap { axis, .. } => {
            (digits(sphere::theta(axis).to_degrees()), digits(sphere::phi(axis).to_degrees()))
        }
    }
}
