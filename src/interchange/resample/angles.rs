//! The axes of a table's incidences and bins, where those are products of polar angles and azimuths.

use std::f64::consts::TAU;

use crate::error::wrong;
use crate::instrument::{Grid, GridKind};
use crate::interchange::Checked;
use crate::sphere;

/// Angles of one arm: values in increasing order, and where the table has each.
pub(crate) struct Ordered {
    pub angles: Vec<f64>,
    pub places: Vec<usize>,
}

/// Polar angles and azimuths whose product the incidences are, degrees.
pub(crate) fn incidence_axes(grid: &Grid) -> Checked<(Vec<f64>, Vec<f64>)> {
    if grid.kind == GridKind::HalfDifference {
        return Err("half/difference angles are no incidences and bins".into());
    }
    if grid.incidences_deg.is_empty() {
        return Ok((grid.theta_i_deg.clone(), grid.phi_i_deg.clone()));
    }
    product(&grid.incidences_deg)
        .ok_or_else(|| "the incidences are no product of polar angles and azimuths".into())
}

/// Polar angles and azimuths whose product the middles of the bins are, degrees.
pub(crate) fn bin_axes(grid: &Grid) -> Checked<(Vec<f64>, Vec<f64>)> {
    let middles = |edges: &[f64]| edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let points = match grid.kind {
        GridKind::Hemisphere => {
            return Ok((middles(&grid.theta_r_edges_deg), middles(&grid.phi_r_edges_deg)));
        }
        GridKind::Arm => return Ok((grid.theta_r_deg.clone(), grid.phi_r_deg.clone())),
        GridKind::Points => grid.points_deg.clone(),
        GridKind::Patches => {
            grid.patches_deg.iter().map(|p| [0.5 * (p[0] + p[1]), 0.5 * (p[2] + p[3])]).collect()
        }
        GridKind::HalfDifference => return Err("half/difference angles are no incidences and bins".into()),
    };
    product(&points)
        .ok_or_else(|| "the sensor's directions are no product of polar angles and azimuths".into())
}

/// The axes of a list in which the azimuth runs fastest.
fn product(list: &[[f64; 2]]) -> Option<(Vec<f64>, Vec<f64>)> {
    let columns = list.iter().take_while(|pair| pair[0] == list[0][0]).count();
    let theta: Vec<f64> = list.chunks(columns).map(|row| row[0][0]).collect();
    let phi: Vec<f64> = list[..columns].iter().map(|pair| pair[1]).collect();
    let fits = list.len() == theta.len() * columns
        && list.iter().enumerate().all(|(k, pair)| *pair == [theta[k / columns], phi[k % columns]]);
    fits.then_some((theta, phi))
}

/// Polar angles of an arm that sees the hemisphere.
pub(crate) fn increasing(name: &str, deg: &[f64]) -> Checked<Ordered> {
    if let Some(negative) = deg.iter().find(|&&angle| angle < 0.0) {
        return Err(wrong!("{name} = {negative}: an arm in one plane does not see the hemisphere"));
    }
    ordered(name, deg.iter().map(|angle| angle.to_radians()).collect())
}

/// Azimuths in [0, 2 pi).
pub(crate) fn around(name: &str, deg: &[f64]) -> Checked<Ordered> {
    ordered(name, deg.iter().map(|&angle| sphere::reduced_deg(angle).to_radians() % TAU).collect())
}

fn ordered(name: &str, angles: Vec<f64>) -> Checked<Ordered> {
    let mut places: Vec<usize> = (0..angles.len()).collect();
    places.sort_by(|&a, &b| angles[a].total_cmp(&angles[b]));
    let sorted: Vec<f64> = places.iter().map(|&place| angles[place]).collect();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(wrong!("{name} = {} is there twice", pair[0].to_degrees())),
        None => Ok(Ordered { angles: sorted, places }),
    }
}
