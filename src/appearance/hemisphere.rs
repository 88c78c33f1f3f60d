//! The weights of a receptor over a hemisphere of bins.
//!
//! Within a bin f is a plane in theta and phi whose mean is the bin's and whose slopes are the central differences of its
//! neighbours. Next to these weights stand those of an f even within each bin, those of bins twice as large, and those of all light
//! of a bin where the receptor collects least or most: how much the bins leave open.

use std::collections::BTreeMap;
use std::ops::Range;

use super::reading::{BinWeights, Reading};
use super::receptor::Receptor;
use crate::instrument::{Grid, Region};
use crate::sphere;

/// Steps within a bin along each angle, at most.
const MOST_STEPS: usize = 64;

/// The sensor's angles: bins in rows of equal polar angles, columns of equal azimuths.
struct BinRows {
    regions: Vec<Region>,
    columns: usize,
    /// Rows above the horizon.
    above: Range<usize>,
}

/// The angles of a bin: edges, and mean polar angle by projected solid angle.
struct BinAngles {
    theta: [f64; 2],
    phi: [f64; 2],
    centre: f64,
}

/// The shares within a bin: mean, moments about its middle, extremes.
struct BinShares {
    mean: f64,
    /// Mean of share times (theta - centre), and of share times (phi - middle).
    slopes: [f64; 2],
    extremes: [f64; 2],
}

/// Whether the bins begin at the pole, reach the horizon and go all the way round.
pub fn is_whole(grid: &Grid) -> bool {
    let (rows, columns) = (&grid.theta_r_edges_deg, &grid.phi_r_edges_deg);
    rows[0] == 0.0 && rows.contains(&90.0) && (columns[columns.len() - 1] - columns[0] - 360.0).abs() < 1e-9
}

/// The reading of a receptor at an incidence of a hemisphere.
pub fn reading(grid: &Grid, incidence: usize, receptor: &Receptor) -> Reading {
    let rows = BinRows::new(grid, incidence);
    let mut found = rows.reading(receptor);
    let coarse = doubled(grid);
    let coarse_rows = BinRows::new(&coarse, incidence);
    let mut weights: BTreeMap<usize, BinWeights> = found.terms.into_iter().collect();
    for (bin, weight) in coarse_rows.reading(receptor).terms {
        let (row, column) = (bin / coarse_rows.columns, bin % coarse_rows.columns);
        // A bin twice as large has the mean of its parts.
        let size = coarse_rows.regions[bin].projected_solid_angle();
        for row in (2 * row..2 * row + 2).filter(|row| rows.above.contains(row)) {
            for column in (2 * column..2 * column + 2).filter(|column| *column < rows.columns) {
                let part = row * rows.columns + column;
                let share = rows.regions[part].projected_solid_angle() / size;
                weights.entry(part).or_default().coarse += share * weight.plane;
            }
        }
    }
    let first = incidence * grid.bins();
    found.terms = weights.into_iter().map(|(bin, weights)| (first + bin, weights)).collect();
    found
}

/// The bins above the horizon by twos in each angle.
fn doubled(grid: &Grid) -> Grid {
    let by_twos = |edges: &[f64]| {
        let last = edges.len() - 1;
        let even = edges.iter().copied().step_by(2);
        even.chain((last % 2 == 1).then(|| edges[last])).collect::<Vec<f64>>()
    };
    let above = grid.theta_r_edges_deg.partition_point(|&edge| edge < 90.0);
    Grid {
        theta_r_edges_deg: by_twos(&grid.theta_r_edges_deg[..=above]),
        phi_r_edges_deg: by_twos(&grid.phi_r_edges_deg),
        ..grid.clone()
    }
}

impl BinRows {
    fn new(grid: &Grid, incidence: usize) -> Self {
        let above = 0..grid.theta_r_edges_deg.partition_point(|&edge| edge < 90.0);
        BinRows { regions: grid.regions(incidence), columns: grid.phi_r_edges_deg.len() - 1, above }
    }

    /// The weights by bin; `coarse` is left out.
    fn reading(&self, receptor: &Receptor) -> Reading {
        let columns = self.columns;
        let mut weights: BTreeMap<usize, BinWeights> = BTreeMap::new();
        let mut reading = Reading::default();
        for row in self.above.clone().filter(|row| self.is_within(*row, receptor)) {
            for column in 0..columns {
                let Some(angles) = self.angles(row, column) else { continue };
                let Some(shares) = shares(&angles, receptor) else { continue };
                let bin = row * columns + column;
                let size = self.regions[bin].projected_solid_angle();
                let own = weights.entry(bin).or_default();
                own.plane += size * shares.mean;
                own.even += size * shares.mean;
                (0..2).for_each(|k| own.bounds[k] += size * shares.extremes[k]);
                reading.measure += size * shares.mean;
                // A bin that is collected whole says its light, however large it is.
                if shares.extremes[0] < 1.0 {
                    let extent = angles.extent_deg();
                    reading.bins_deg = [0, 1].map(|k| reading.bins_deg[k].max(extent[k]));
                }
                for (k, pair) in self.neighbours(row, column).into_iter().enumerate() {
                    let Some(([low, high], distance)) = pair else { continue };
                    let slope = size * shares.slopes[k] / distance;
                    weights.entry(high).or_default().plane += slope;
                    weights.entry(low).or_default().plane -= slope;
                }
            }
        }
        reading.terms = weights.into_iter().collect();
        reading
    }

    fn angles(&self, row: usize, column: usize) -> Option<BinAngles> {
        match self.regions[row * self.columns + column] {
            Region::Rectangle { theta, phi } => Some(BinAngles { theta, phi, centre: centre(theta) }),
            Region::Cap { .. } => None,
        }
    }

    /// Whether a row has polar angles of directions that a receptor collects.
    fn is_within(&self, row: usize, receptor: &Receptor) -> bool {
        let [from, to] = receptor.polar_range();
        self.angles(row, 0).is_some_and(|bin| bin.theta[0] <= to && from <= bin.theta[1])
    }

    /// The bins between which the slopes along theta and along phi are taken, and how far they are from each other.
    fn neighbours(&self, row: usize, column: usize) -> [Option<([usize; 2], f64)>; 2] {
        let columns = self.columns;
        let (below, above) = (row.saturating_sub(1), (row + 1).min(self.above.end - 1));
        let angle = |row: usize| self.angles(row, column).map_or(0.0, |bin| bin.centre);
        let along = (above > below)
            .then(|| ([below * columns + column, above * columns + column], angle(above) - angle(below)));
        let (left, right) = ((column + columns - 1) % columns, (column + 1) % columns);
        let width = |column: usize| self.angles(row, column).map_or(0.0, |bin| bin.phi[1] - bin.phi[0]);
        let around = (columns > 2).then(|| {
            let distance = 0.5 * (width(left) + width(right)) + width(column);
            ([row * columns + left, row * columns + right], distance)
        });
        [along, around]
    }
}

impl BinAngles {
    /// Its size in the plane of incidence and across, degrees.
    fn extent_deg(&self) -> [f64; 2] {
        let sin = self.theta[1].sin();
        let across = (sin * (self.phi[1] - self.phi[0])).min(2.0 * sin);
        [(self.theta[1] - self.theta[0]).to_degrees(), across.to_degrees()]
    }
}

/// Mean of theta by projected solid angle: integral of theta sin(2 theta) over that of sin(2 theta).
fn centre([t1, t2]: [f64; 2]) -> f64 {
    let primitive = |t: f64| 0.25 * (2.0 * t).sin() - 0.5 * t * (2.0 * t).cos();
    let size = (t2 + t1).sin() * (t2 - t1).sin();
    let middle = 0.5 * (t1 + t2);
    // Of a bin as narrow as this the primitives keep no digits, and it is its middle to (t2 - t1)^2.
    if t2 - t1 < 1e-4 { middle } else { (primitive(t2) - primitive(t1)) / size }
}

/// The shares of a receptor within a bin; `None` where it collects nothing of it.
fn shares(bin: &BinAngles, receptor: &Receptor) -> Option<BinShares> {
    let [[t1, t2], [p1, p2]] = [bin.theta, bin.phi];
    let middle = sphere::direction(0.5 * (t1 + t2), 0.5 * (p1 + p2));
    let radius = 0.5 * ((t2 - t1) + t2.sin() * (p2 - p1));
    if middle.angle_between(receptor.axis()) > receptor.reach() + radius {
        return None;
    }
    let extents = [t2 - t1, t2.sin() * (p2 - p1)];
    let steps = |k: usize| ((extents[k] / receptor.steps()[k]).ceil() as usize).clamp(2, MOST_STEPS);
    let (rows, columns) = (steps(0), steps(1));
    let (mut sum, mut sums, mut extremes) = (0.0, [0.0; 3], [1.0f64, 0.0]);
    for i in 0..rows {
        let theta = t1 + (t2 - t1) * (i as f64 + 0.5) / rows as f64;
        let weight = (2.0 * theta).sin();
        for j in 0..columns {
            let from_middle = (p2 - p1) * ((j as f64 + 0.5) / columns as f64 - 0.5);
            let share = receptor.share(sphere::direction(theta, 0.5 * (p1 + p2) + from_middle));
            sum += weight;
            let moments = [1.0, theta - bin.centre, from_middle];
            (0..3).for_each(|k| sums[k] += weight * share * moments[k]);
            extremes = [extremes[0].min(share), extremes[1].max(share)];
        }
    }
    let [mean, along, around] = sums.map(|s| s / sum);
    // Of a bin that is collected whole the moments are 0 but for the steps.
    let slopes = if extremes[0] == 1.0 { [0.0; 2] } else { [along, around] };
    (extremes[1] > 0.0).then_some(BinShares { mean, slopes, extremes })
}
