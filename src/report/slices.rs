//! Cuts through a table: the bins in the plane of incidence, in the mirror direction, and their values.
//!
//! Input: a table, its prediction. Output: numbers by signed polar angle, the same bins for measurement and model.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::instrument::{Grid, Region};
use crate::stats;
use crate::table::{BrdfTable, ColourChannels};
use crate::validate::Prediction;

/// A table and its prediction.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The table.
    pub table: &'a BrdfTable,
    /// The models' means over its bins.
    pub prediction: Option<&'a Prediction>,
    /// Independent groups behind its error bars; fewer than 2: none.
    pub realisations: usize,
}

/// Incidences that share an angle of the light.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// The angle that they share, degrees.
    pub angle_deg: f64,
    /// The incidences by the other angle.
    pub incidences: Vec<usize>,
}

/// A bin in the plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// Its middle, degrees from the normal: positive on the mirror's side, negative on the light's.
    pub theta_deg: f64,
    /// The bin.
    pub bin: usize,
}

/// The bins that the plane of incidence cuts, from the light's horizon to the mirror's.
///
/// A bin between edges counts on the side whose azimuth its half-open interval holds; a circular aperture counts
/// where the plane passes through it.
// Tested by `the_plane_of_incidence_cuts_a_row_on_either_side`.
fn in_plane(grid: &Grid, incidence: usize) -> Vec<Cut> {
    let phi_i = grid.incidence_deg(incidence).1.to_radians();
    let mut cuts = Vec::new();
    for (bin, region) in grid.regions(incidence).iter().enumerate() {
        match *region {
            Region::Rectangle { theta, phi } => {
                let middle = 0.5 * (theta[0] + theta[1]).to_degrees();
                let sides = [(phi_i + PI, 1.0), (phi_i, -1.0)];
                let held = sides.into_iter().filter(|&(azimuth, _)| holds(phi, azimuth));
                cuts.extend(held.map(|(_, side)| Cut { theta_deg: side * middle, bin }));
            }
            Region::Cap { axis, half_angle } => {
                let (sin, cos) = phi_i.sin_cos();
                let across = axis.y * cos - axis.x * sin;
                let along = -(axis.x * cos + axis.y * sin);
                if across.abs() <= half_angle.sin().max(1e-9) {
                    cuts.push(Cut { theta_deg: along.atan2(axis.z).to_degrees(), bin });
                }
            }
        }
    }
    cuts.sort_by(|a, b| a.theta_deg.total_cmp(&b.theta_deg));
    cuts
}

/// Whether an interval of azimuths, [lower, upper), holds an azimuth up to whole turns.
fn holds(phi: [f64; 2], azimuth: f64) -> bool {
    let beyond = (azimuth - phi[0]).rem_euclid(TAU);
    // A lower edge that rounding has moved past the azimuth is still the azimuth.
    let beyond = if beyond > TAU - 1e-9 { 0.0 } else { beyond };
    beyond < phi[1] - phi[0] - 1e-9
}

/// The bin nearest to the mirror direction of an incidence.
pub fn mirror_bin(grid: &Grid, incidence: usize) -> Option<usize> {
    let wi = grid.wi(incidence);
    let mirror = DVec3::new(-wi.x, -wi.y, wi.z);
    let distance = |region: &Region| region.middle().distance_squared(mirror);
    let regions = grid.regions(incidence);
    let nearest = regions.iter().enumerate().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
    nearest.map(|(bin, _)| bin)
}

impl Scene<'_> {
    /// The bins of the plane of incidence that were measured.
    pub fn in_plane(&self, incidence: usize) -> Vec<Cut> {
        let first = incidence * self.table.grid.bins();
        in_plane(&self.table.grid, incidence)
            .into_iter()
            .filter(|cut| !self.table.is_gap(first + cut.bin))
            .collect()
    }

    /// The colour that the plots show: the only one, or green.
    pub fn colour(&self) -> usize {
        self.table.colours.len() / 2
    }

    /// Its name in captions.
    pub fn colour_note(&self) -> &'static str {
        match self.table.colours.len() {
            1 => "",
            _ if self.table.is_spectral() => " (the middle wavelength)",
            _ => " (green)",
        }
    }

    fn channels(&self) -> &ColourChannels {
        &self.table.colours[self.colour()]
    }

    /// Whether light of higher orders was measured.
    pub fn has_multiple(&self) -> bool {
        self.table.colours.iter().any(|colour| colour.multiple.iter().any(|&value| value > 0.0))
    }

    /// Order 1 of a bin, 1/sr.
    pub fn single(&self, incidence: usize, bin: usize) -> f64 {
        f64::from(self.channels().single[incidence * self.table.grid.bins() + bin])
    }

    /// All orders of a bin, 1/sr.
    pub fn total(&self, incidence: usize, bin: usize) -> f64 {
        f64::from(self.channels().total[incidence * self.table.grid.bins() + bin])
    }

    /// Half-width of the 95 % interval of a bin's order 1, 1/sr; `None` without error bars.
    pub fn half_width(&self, incidence: usize, bin: usize) -> Option<f64> {
        self.interval(f64::from(self.channels().stderr_single[incidence * self.table.grid.bins() + bin]))
    }

    /// The same of all orders.
    pub fn half_width_of_total(&self, incidence: usize, bin: usize) -> Option<f64> {
        self.interval(f64::from(self.channels().stderr[incidence * self.table.grid.bins() + bin]))
    }

    /// Half-width of the 95 % interval of what has the standard error `se` over the realisations; below 0: unknown.
    pub fn interval(&self, se: f64) -> Option<f64> {
        (se >= 0.0 && self.realisations > 1).then(|| se * stats::student_limit(0.05, self.realisations - 1))
    }

    /// The mean of the model with the masking `index` over a bin, 1/sr.
    pub fn model(&self, index: usize, incidence: usize, bin: usize) -> Option<f64> {
        Some(self.prediction?.means[incidence].values[index][self.colour()][bin])
    }

    /// Names of the maskings, in words.
    pub fn maskings(&self) -> Vec<String> {
        self.prediction.map_or(Vec::new(), |prediction| {
            prediction.model.maskings().iter().map(|name| name.replace('_', "-")).collect()
        })
    }

    /// The incidences of each azimuth of the light by theta_i; of a list of incidences the azimuths with the most of them.
    // Tested by `a_list_of_incidences_is_swept_where_most_angles_share_an_azimuth`.
    pub fn sweeps(&self) -> Vec<Sweep> {
        let sweeps = self.grouped(|(_, phi)| phi, |(theta, _)| theta);
        let most = sweeps.iter().map(|sweep| sweep.incidences.len()).max().unwrap_or(0);
        sweeps.into_iter().filter(|sweep| sweep.incidences.len() == most).collect()
    }

    /// The incidences of each polar angle of the light by azimuth.
    pub fn rounds(&self) -> Vec<Sweep> {
        self.grouped(|(theta, _)| theta, |(_, phi)| phi)
    }

    fn grouped(&self, by: fn((f64, f64)) -> f64, order: fn((f64, f64)) -> f64) -> Vec<Sweep> {
        let grid = &self.table.grid;
        let mut incidences: Vec<usize> = (0..grid.incidences()).collect();
        let key = |incidence: usize, of: fn((f64, f64)) -> f64| of(grid.incidence_deg(incidence));
        incidences.sort_by(|&a, &b| {
            key(a, by).total_cmp(&key(b, by)).then(key(a, order).total_cmp(&key(b, order)))
        });
        let groups = incidences.chunk_by(|&a, &b| key(a, by) == key(b, by));
        groups
            .map(|incidences| Sweep { angle_deg: key(incidences[0], by), incidences: incidences.to_vec() })
            .collect()
    }

    /// Whether the light comes from several azimuths.
    pub fn has_azimuths(&self) -> bool {
        let grid = &self.table.grid;
        (1..grid.incidences()).any(|incidence| grid.incidence_deg(incidence).1 != grid.incidence_deg(0).1)
    }

    /// The model's flux at an incidence over the incident one, the mean of all colours, as albedos of a summary are.
    // Tested by `albedos_of_colours_are_means_in_measurement_and_model` (tests/it/report.rs).
    pub fn model_albedo(&self, index: usize, incidence: usize) -> Option<f64> {
        let colours = &self.prediction?.means[incidence].values[index];
        let sizes = self.table.grid.sizes(incidence);
        let flux = |means: &Vec<f64>| means.iter().zip(&sizes).map(|(mean, size)| mean * size).sum::<f64>();
        Some(colours.iter().map(flux).sum::<f64>() / colours.len() as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::grid::GridKind;

    fn grid() -> Grid {
        Grid {
            kind: GridKind::Hemisphere,
            theta_i_deg: vec![30.0],
            phi_i_deg: vec![0.0, 45.0],
            phi_r_relative: false,
            theta_r_edges_deg: vec![0.0, 20.0, 40.0, 90.0],
            phi_r_edges_deg: (0..=8).map(|k| 45.0 * f64::from(k)).collect(),
            ..Grid::default()
        }
    }

    #[test]
    fn the_plane_of_incidence_cuts_a_row_on_either_side() {
        // Columns of 45 degrees: light at 0 lies on the lower edge of column 0, its mirror at 180 on that of 4.
        for (incidence, light, mirror) in [(0, 0, 4), (1, 1, 5)] {
            let cuts = in_plane(&grid(), incidence);
            let found: Vec<(i64, usize)> = cuts.iter().map(|c| (c.theta_deg.round() as i64, c.bin)).collect();
            let wanted = [
                (-65, 16 + light),
                (-30, 8 + light),
                (-10, light),
                (10, mirror),
                (30, 8 + mirror),
                (65, 16 + mirror),
            ];
            assert_eq!(found, wanted, "incidence {incidence}");
        }
    }

    #[test]
    fn apertures_of_an_arm_lie_in_the_plane_by_their_axes() {
        let arm = Grid {
            kind: GridKind::Arm,
            theta_r_edges_deg: vec![],
            phi_r_edges_deg: vec![],
            theta_r_deg: vec![-30.0, 10.0],
            phi_r_deg: vec![90.0, 180.0],
            aperture_deg: Some(1.0),
            phi_i_deg: vec![0.0],
            ..grid()
        };
        let cuts = in_plane(&arm, 0);
        assert_eq!(cuts.iter().map(|c| c.bin).collect::<Vec<_>>(), [1, 3]);
        assert!((cuts[0].theta_deg + 30.0).abs() < 1e-9 && (cuts[1].theta_deg - 10.0).abs() < 1e-9);
    }

    #[test]
    fn a_list_of_incidences_is_swept_where_most_angles_share_an_azimuth() {
        let list = Grid {
            theta_i_deg: vec![],
            phi_i_deg: vec![],
            incidences_deg: vec![[0.0, 180.0], [20.0, 180.0], [20.0, 0.0], [40.0, 270.0], [40.0, 180.0]],
            ..grid()
        };
        let bins = list.bins() * list.incidences();
        let table = BrdfTable {
            grid: list,
            campaign: String::new(),
            version: String::new(),
            seed: 0,
            patch_digest: String::new(),
            colours: vec![],
            hits: vec![0; bins],
            schlick: None,
        };
        let scene = Scene { table: &table, prediction: None, realisations: 0 };
        assert_eq!(scene.sweeps(), [Sweep { angle_deg: 180.0, incidences: vec![0, 1, 4] }]);
        let rounds: Vec<Vec<usize>> = scene.rounds().into_iter().map(|round| round.incidences).collect();
        assert_eq!(rounds, [vec![0], vec![2, 1], vec![4, 3]]);
        assert!(scene.has_azimuths());
    }
}
