//! How far a file is from the table that it was made of: the file's own reader, averaged over the table's bins.

use rayon::prelude::*;
use serde::Serialize;

use super::resample::mean;
use super::{Brdf, Colour};
use crate::error::Checked;
use crate::instrument::{Grid, GridKind, Region};
use crate::sphere;
use crate::table::BrdfTable;

/// Bins that are compared at most; of larger tables every k-th.
const MOST_BINS: usize = 400_000;

/// The error of reading a file back.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReadBack {
    /// Sum of |file - table| w over sum of table w, w the projected solid angle; mean over stops and colours.
    pub l1: f64,
    /// The worst bin: |file - table| over the largest value of its stop and colour.
    pub worst: f64,
    /// Its stop, (theta_i, phi_i) in degrees.
    pub worst_stop_deg: (f64, f64),
    /// The middle of the bin, (theta_r, phi_r) in degrees.
    pub worst_bin_deg: (f64, f64),
    /// Bins compared, of all colours once.
    pub bins: usize,
}

/// What one stop adds.
#[derive(Default)]
struct StopSums {
    distance: Colour,
    sum: Colour,
    worst: f64,
    worst_bin: usize,
    bins: usize,
}

/// Compares `brdf` with the totals of `table`. Points count with their cosine.
///
/// `None` where the table holds nothing but zeros.
pub fn read_back(table: &BrdfTable, brdf: &dyn Brdf) -> Option<ReadBack> {
    let (stops, bins) = (table.grid.stops(), table.grid.bins());
    // A stride that shares no factor with the bins visits all azimuths alike.
    let mut stride = (stops * bins).div_ceil(MOST_BINS);
    while stride > 1 && bins.is_multiple_of(stride) {
        stride += 1;
    }
    let sums: Vec<StopSums> =
        (0..stops).into_par_iter().map(|stop| stop_sums(table, brdf, stop, stride)).collect();
    let ratios: Vec<f64> = sums
        .iter()
        .flat_map(|s| (0..table.colours.len()).filter(|&c| s.sum[c] > 0.0).map(|c| s.distance[c] / s.sum[c]))
        .collect();
    let (stop, worst) = sums.iter().enumerate().max_by(|a, b| a.1.worst.total_cmp(&b.1.worst))?;
    let l1 = ratios.iter().sum::<f64>() / ratios.len() as f64;
    (!ratios.is_empty()).then(|| ReadBack {
        l1,
        worst: worst.worst,
        worst_stop_deg: table.grid.stop_deg(stop),
        worst_bin_deg: middles_deg(&table.grid, stop)[worst.worst_bin],
        bins: sums.iter().map(|s| s.bins).sum(),
    })
}

fn stop_sums(table: &BrdfTable, brdf: &dyn Brdf, stop: usize, stride: usize) -> StopSums {
    let (grid, bins) = (&table.grid, table.grid.bins());
    let (wi, regions) = (grid.wi(stop), grid.regions(stop));
    let values = |colour: usize| &table.colours[colour].total[stop * bins..][..bins];
    let largest = |colour| values(colour).iter().fold(0.0f64, |most, &v| most.max(f64::from(v)));
    let peaks: Vec<f64> = (0..table.colours.len()).map(largest).collect();
    let mut sums = StopSums::default();
    for bin in (stop % stride..bins).step_by(stride) {
        let region = &regions[bin];
        if wi.z <= 0.0 {
            continue;
        }
        let found = mean(brdf, wi, region);
        let size = size_of(region);
        for (colour, &peak) in peaks.iter().enumerate() {
            let value = f64::from(values(colour)[bin]);
            let distance = (found[colour.min(brdf.colours() - 1)] - value).abs();
            sums.distance[colour] += size * distance;
            sums.sum[colour] += size * value;
            if peak > 0.0 && distance / peak > sums.worst {
                (sums.worst, sums.worst_bin) = (distance / peak, bin);
            }
        }
        sums.bins += 1;
    }
    sums
}

/// Values that a reader finds at the table's own bins, in any order, compared with it as they come.
pub struct Listing<'a> {
    table: &'a BrdfTable,
    /// Of the bins of any stop.
    sizes: Vec<f64>,
    /// By stop and colour: largest value, sum of distances, sum of values.
    sums: Vec<[f64; 3]>,
    worst: (f64, usize, usize),
    count: usize,
}

impl<'a> Listing<'a> {
    /// Nothing found so far.
    pub fn new(table: &'a BrdfTable) -> Self {
        let (bins, colours) = (table.grid.bins(), &table.colours);
        let peak = |entry: usize| {
            let values = &colours[entry % colours.len()].total[entry / colours.len() * bins..][..bins];
            [values.iter().fold(0.0, |most, &v| f64::max(most, f64::from(v))), 0.0, 0.0]
        };
        Listing {
            sizes: table.grid.regions(0).iter().map(size_of).collect(),
            sums: (0..table.grid.stops() * colours.len()).map(peak).collect(),
            worst: (0.0, 0, 0),
            count: 0,
            table,
        }
    }

    /// Takes in a value of a stop, bin and colour; what stands for a gap is passed over.
    pub fn add(&mut self, stop: usize, bin: usize, colour: usize, found: f32) {
        let (colours, entry) = (self.table.colours.len(), stop * self.sizes.len() + bin);
        if self.table.is_gap(entry) {
            return;
        }
        let value = self.table.colours[colour].total[entry];
        let off = f64::from((found - value).abs());
        let [peak, distance, sum] = &mut self.sums[stop * colours + colour];
        *distance += self.sizes[bin] * off;
        *sum += self.sizes[bin] * f64::from(value);
        if *peak > 0.0 && off > self.worst.0 * *peak {
            self.worst = (off / *peak, stop, bin);
        }
        self.count += 1;
    }

    /// The measures; `None` as for [`read_back`]. Values that are missing, or are there twice, are a reason.
    pub fn finish(self) -> Checked<Option<ReadBack>> {
        let mut held = BandErrors::default();
        held.join(self)?;
        Ok(held.read_back())
    }
}

/// What the bands of a table showed, one after the other.
#[derive(Default)]
pub struct BandErrors {
    /// Distance over sum of every stop and colour with light.
    ratios: Vec<f64>,
    worst: f64,
    /// Stop and bin of the worst, degrees.
    place: [(f64, f64); 2],
    bins: usize,
}

impl BandErrors {
    /// Takes in a band that was read to its end.
    pub fn join(&mut self, band: Listing) -> Checked<()> {
        let grid = &band.table.grid;
        let bins = grid.stops() * grid.bins() - band.table.gaps();
        let wanted = bins * band.table.colours.len();
        if band.count != wanted {
            return Err(format!("{} values, {wanted} needed", band.count).into());
        }
        let lit = band.sums.iter().filter(|sums| sums[2] > 0.0);
        self.ratios.extend(lit.map(|[_, distance, sum]| distance / sum));
        let (worst, stop, bin) = band.worst;
        if self.bins == 0 || worst > self.worst {
            self.worst = worst;
            self.place = [grid.stop_deg(stop), middles_deg(grid, stop)[bin]];
        }
        self.bins += bins;
        Ok(())
    }

    /// The measures; `None` as for [`read_back`].
    pub fn read_back(self) -> Option<ReadBack> {
        (!self.ratios.is_empty()).then(|| ReadBack {
            l1: self.ratios.iter().sum::<f64>() / self.ratios.len() as f64,
            worst: self.worst,
            worst_stop_deg: self.place[0],
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
        Region::Cap { axis, half_angle: 0.0 } => axis.z,
        region => region.projected_solid_angle(),
    }
}

/// The middles of a stop's bins in degrees, azimuths absolute, to ten digits after the point. They are the grid's own
/// angles, not those of its unit vectors: the azimuth of an arm at the pole is kept, and so is a negative one. A
/// negative polar angle is the far side of its plane.
///
/// Held by: `an_arm_at_the_pole_keeps_its_azimuths` (tests/it/interchange/interchange_angles.rs).
pub fn middles_deg(grid: &Grid, stop: usize) -> Vec<(f64, f64)> {
    let turn = if grid.phi_r_relative { grid.stop_deg(stop).1 } else { 0.0 };
    let listed = match grid.kind {
        GridKind::Arm => {
            grid.theta_r_deg.iter().flat_map(|&t| grid.phi_r_deg.iter().map(move |&p| [t, p])).collect()
        }
        GridKind::Points => grid.points_deg.clone(),
        _ => return grid.regions(stop).iter().map(middle_deg).collect(),
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

/// To ten digits after the point.
fn digits(angle: f64) -> f64 {
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
