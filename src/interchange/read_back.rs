//! How far a file is from the table that it was made of: the file's own reader, averaged over the table's bins.

use rayon::prelude::*;
use serde::Serialize;

use super::resample::mean;
use super::{Brdf, Colour};
use crate::instrument::Region;
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
struct Sums {
    distance: Colour,
    sum: Colour,
    worst: f64,
    worst_bin: usize,
    bins: usize,
}

/// Holds `brdf` to the totals of `table`. Points count with their cosine.
///
/// `None` where the table holds nothing but zeros.
pub fn read_back(table: &BrdfTable, brdf: &dyn Brdf) -> Option<ReadBack> {
    let (stops, bins) = (table.grid.stops(), table.grid.bins());
    // A stride that shares no factor with the bins visits all azimuths alike.
    let mut stride = (stops * bins).div_ceil(MOST_BINS);
    while stride > 1 && bins.is_multiple_of(stride) {
        stride += 1;
    }
    let sums: Vec<Sums> =
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
        worst_bin_deg: middle_deg(&table.grid.regions(stop)[worst.worst_bin]),
        bins: sums.iter().map(|s| s.bins).sum(),
    })
}

fn stop_sums(table: &BrdfTable, brdf: &dyn Brdf, stop: usize, stride: usize) -> Sums {
    let (grid, bins) = (&table.grid, table.grid.bins());
    let (wi, regions) = (grid.wi(stop), grid.regions(stop));
    let values = |colour: usize| &table.colours[colour].total[stop * bins..][..bins];
    let largest = |colour| values(colour).iter().fold(0.0f64, |most, &v| most.max(f64::from(v)));
    let peaks: Vec<f64> = (0..table.colours.len()).map(largest).collect();
    let mut sums = Sums::default();
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

/// Holds totals in the table's own order to the table; `None` as for [`read_back`].
pub fn listed(table: &BrdfTable, totals: &[Vec<f32>]) -> Option<ReadBack> {
    let (stops, bins) = (table.grid.stops(), table.grid.bins());
    let (mut ratios, mut worst, mut place) = (Vec::new(), 0.0, (0, 0));
    for stop in 0..stops {
        let regions = table.grid.regions(stop);
        for (colour, found) in table.colours.iter().zip(totals) {
            let (values, found) = (&colour.total[stop * bins..][..bins], &found[stop * bins..][..bins]);
            let peak = values.iter().fold(0.0f32, |most, &v| most.max(v));
            let (mut distance, mut sum) = (0.0, 0.0);
            for (bin, (&value, &back)) in values.iter().zip(found).enumerate() {
                let off = f64::from((back - value).abs());
                distance += size_of(&regions[bin]) * off;
                sum += size_of(&regions[bin]) * f64::from(value);
                if off > worst * f64::from(peak) {
                    (worst, place) = (off / f64::from(peak), (stop, bin));
                }
            }
            ratios.extend((sum > 0.0).then(|| distance / sum));
        }
    }
    (!ratios.is_empty()).then(|| ReadBack {
        l1: ratios.iter().sum::<f64>() / ratios.len() as f64,
        worst,
        worst_stop_deg: table.grid.stop_deg(place.0),
        worst_bin_deg: middle_deg(&table.grid.regions(place.0)[place.1]),
        bins: stops * bins,
    })
}

/// What a bin counts with: its projected solid angle, of a single direction the cosine.
fn size_of(region: &Region) -> f64 {
    match region {
        Region::Cap { axis, half_angle: 0.0 } => axis.z,
        region => region.projected_solid_angle(),
    }
}

/// The middle of a bin in degrees, to ten digits after the point.
pub fn middle_deg(region: &Region) -> (f64, f64) {
    let digits = |angle: f64| (angle * 1e10).round() / 1e10;
    match *region {
        Region::Rectangle { theta: [t1, t2], phi: [p1, p2] } => {
            (digits(0.5 * (t1 + t2).to_degrees()), digits(0.5 * (p1 + p2).to_degrees()))
        }
        Region::Cap { axis, .. } => {
            (digits(sphere::theta(axis).to_degrees()), digits(sphere::phi(axis).to_degrees()))
        }
    }
}
