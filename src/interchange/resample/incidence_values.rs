//! A table at its own incidences, as a function of the sensor's direction.
//!
//! Along the sensor's angles: cubic between the middles of the bins, with node values such that the means of the
//! interpolant over the bins are the table's. A cubic may swing below 0 next to a lobe; there the value is 0.

use std::f64::consts::PI;

use glam::DVec3;

use super::angles::{around, bin_axes, incidence_axes, increasing};
use super::axis::{AzimuthCircle, Polar, Taps, WIDEST_GAP_DEG};
use super::folds::{Fold, unfolded};
use super::gaps::not_measured;
use super::means::keep_means;
use crate::error::wrong;
use crate::instrument::GridKind;
use crate::interchange::{Checked, Colour};
use crate::sphere;
use crate::table::BrdfTable;

/// The values of a table at its own incidences.
pub struct IncidenceValues {
    theta_i: Vec<f64>,
    phi_i: Vec<f64>,
    /// Towards the light, [theta_i][phi_i]; at azimuth 0 where every azimuth is alike.
    wi: Vec<DVec3>,
    /// The measured azimuth that each of `phi_i` is, or is the mirror image of.
    folds: Vec<Fold>,
    /// Measured azimuths.
    azimuths: usize,
    incidences_polar: Polar,
    incidences_circle: AzimuthCircle,
    /// The azimuth is relative and has one value: every azimuth of the light is alike.
    isotropic: bool,
    relative: bool,
    rows: Polar,
    columns: AzimuthCircle,
    column_count: usize,
    row_count: usize,
    /// Per colour: [theta_i][measured phi_i][row][column] in increasing order of all angles.
    values: Vec<Vec<f32>>,
}

impl IncidenceValues {
    /// The totals of a table whose incidences and bins are products of polar angles and azimuths that
    /// go all the way round, or do with the mirror images that the law of the campaign's surface has.
    pub fn new(table: &BrdfTable) -> Checked<Self> {
        let grid = &table.grid;
        if table.gaps() > 0 {
            return Err(not_measured(table).into());
        }
        let (theta_i_deg, phi_i_deg) = incidence_axes(grid)?;
        let (theta_i, phi_i) = (increasing("theta_i", &theta_i_deg)?, around("phi_i", &phi_i_deg)?);
        let isotropic = grid.phi_r_relative && phi_i.angles.len() == 1;
        let (theta_r_deg, phi_r_deg) = bin_axes(grid)?;
        let (rows, columns) = (increasing("theta_r", &theta_r_deg)?, around("phi_r", &phi_r_deg)?);
        let gap = |circle: &AzimuthCircle| circle.widest_gap().to_degrees();
        let is_open = |angles: &[f64]| gap(&AzimuthCircle::new(angles.to_vec())) > WIDEST_GAP_DEG;
        let (all_phi_i, folds) = if !isotropic && is_open(&phi_i.angles) {
            unfolded(&phi_i.angles, table)
        } else {
            (phi_i.angles.clone(), Fold::none(phi_i.angles.len()))
        };
        let (incidences_circle, columns_circle) =
            (AzimuthCircle::new(all_phi_i.clone()), AzimuthCircle::new(columns.angles));
        if !isotropic && gap(&incidences_circle) > WIDEST_GAP_DEG {
            return Err(wrong!(
                "azimuths of the light leave a gap of {:.0} degrees",
                gap(&incidences_circle)
            ));
        }
        if grid.kind != GridKind::Hemisphere && gap(&columns_circle) > WIDEST_GAP_DEG {
            return Err(wrong!("azimuths of the sensor leave a gap of {:.0} degrees", gap(&columns_circle)));
        }
        let (row_count, column_count) = (rows.places.len(), columns.places.len());
        let mut found = IncidenceValues {
            incidences_polar: Polar::new(&theta_i.angles, false),
            rows: Polar::new(&rows.angles, true),
            columns: columns_circle,
            incidences_circle,
            isotropic,
            relative: grid.phi_r_relative,
            row_count,
            column_count,
            values: Vec::new(),
            wi: directions(&theta_i.angles, if isotropic { &[0.0] } else { &all_phi_i }),
            theta_i: theta_i.angles,
            phi_i: all_phi_i,
            folds,
            azimuths: phi_i.angles.len(),
        };
        for colour in &table.colours {
            let mut values = Vec::with_capacity(colour.total.len());
            for ti in &theta_i.places {
                for pi in &phi_i.places {
                    let incidence = &colour.total[(ti * phi_i_deg.len() + pi) * row_count * column_count..];
                    for row in &rows.places {
                        values.extend(
                            columns.places.iter().map(|column| incidence[row * column_count + column]),
                        );
                    }
                }
            }
            found.values.push(values);
        }
        if grid.kind == GridKind::Hemisphere {
            let axes = (&found.rows, &found.columns);
            keep_means(&mut found.values, axes, grid, &columns.places);
        }
        Ok(found)
    }

    /// Polar angles of the light, increasing, rad.
    pub fn theta_i(&self) -> &[f64] {
        &self.theta_i
    }

    /// Azimuths of the light, increasing in [0, 2 pi), rad; a single 0 where every azimuth is alike.
    pub fn phi_i(&self) -> &[f64] {
        &self.phi_i
    }

    /// The direction of the light at one of the incidences; at azimuth 0 where every azimuth is alike.
    pub fn wi(&self, ti: usize, pi: usize) -> DVec3 {
        self.wi[ti * self.phi_i.len() + pi]
    }

    /// The directions of the light of all incidences, [theta_i][phi_i].
    pub fn all_wi(&self) -> &[DVec3] {
        &self.wi
    }

    /// Whether every azimuth of the light is alike.
    pub fn is_isotropic(&self) -> bool {
        self.isotropic
    }

    /// The colour that stands for all.
    pub fn middle(&self) -> usize {
        self.values.len().min(3) / 2
    }

    /// The index of the last colour that values have.
    pub fn last_colour(&self) -> usize {
        self.values.len().min(3) - 1
    }

    /// Number of colours.
    pub fn colours(&self) -> usize {
        self.values.len()
    }

    /// Taps of the cubic over the incidences at a direction of the light.
    pub fn incidence_taps(&self, theta: f64, phi: f64) -> (Taps<'_>, Taps<'_>) {
        (self.incidences_polar.cubic(theta), self.incidences_circle.cubic(phi))
    }

    /// The value at one of the table's own incidences, or its mirror image (indices into [`Self::theta_i`],
    /// [`Self::phi_i`]), with the light at azimuth `phi_i`, which matters where every azimuth is alike.
    pub fn at_incidence(&self, (ti, pi): (usize, usize), phi_i: f64, wo: DVec3) -> Colour {
        let fold = &self.folds[pi];
        let phi_r = fold.azimuth(sphere::phi(wo)) - if self.relative { fold.azimuth(phi_i) } else { 0.0 };
        // `wo` is a unit vector: its angle needs no `hypot`, which is as dear as all taps together.
        let rows = self.rows.cubic((wo.x * wo.x + wo.y * wo.y).sqrt().atan2(wo.z));
        let near = self.columns.cubic(phi_r);
        // Only next to the pole is anything seen through it.
        let far = rows.iter().any(|row| row.reflected).then(|| self.columns.cubic(phi_r + PI));
        let size = self.row_count * self.column_count;
        let first = (ti * self.azimuths + fold.place) * size;
        let mut found = [0.0; 3];
        for (found, values) in found.iter_mut().zip(&self.values) {
            for row in rows.iter() {
                let line = &values[first + row.node * self.column_count..][..self.column_count];
                let columns = far.as_ref().filter(|_| row.reflected).unwrap_or(&near);
                let along: f64 = columns.iter().map(|tap| tap.weight * f64::from(line[tap.node])).sum();
                *found += row.weight * along;
            }
        }
        found.map(|value| value.max(0.0))
    }

    /// The value at the nearest incidence, with the light at these angles.
    pub fn nearest(&self, theta: f64, phi: f64, wo: DVec3) -> Colour {
        let best =
            |taps: Taps| taps.iter().max_by(|a, b| a.weight.total_cmp(&b.weight)).map_or(0, |tap| tap.node);
        let (ti, pi) = (best(self.incidences_polar.linear(theta)), best(self.incidences_circle.linear(phi)));
        self.at_incidence((ti, pi), if self.isotropic { phi } else { self.phi_i[pi] }, wo)
    }

    /// Taps of straight lines between the incidences at a direction of the light.
    pub fn linear_taps(&self, theta: f64, phi: f64) -> (Taps<'_>, Taps<'_>) {
        (self.incidences_polar.linear(theta), self.incidences_circle.linear(phi))
    }
}

fn directions(theta: &[f64], phi: &[f64]) -> Vec<DVec3> {
    theta.iter().flat_map(|&theta| phi.iter().map(move |&phi| sphere::direction(theta, phi))).collect()
}
