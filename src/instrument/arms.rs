//! The arms as a campaign describes them: lists of angles in, a `Grid` out.

use super::grid::{Grid, GridKind};
use super::klems::{FULL, middles, patches, patches_of_side};
use crate::campaign::{Azimuth, BinLayout, Campaign, PhiFrom, SensorArm, SensorSide};

/// The geometry of the table that a campaign asks for.
pub fn grid_of(campaign: &Campaign) -> Grid {
    let relative = campaign.light.azimuth == Azimuth::Relative;
    let theta_i_deg = campaign.light.theta_i_deg.clone();
    let incidences = match &campaign.light.azimuth {
        Azimuth::Relative => Grid { theta_i_deg, phi_i_deg: vec![0.0], ..Grid::default() },
        Azimuth::Absolute(phi_i_deg) => Grid { theta_i_deg, phi_i_deg: phi_i_deg.clone(), ..Grid::default() },
        Azimuth::KlemsFull => Grid { incidences_deg: middles(&patches(&FULL)), ..Grid::default() },
    };
    let empty = Grid { kind: GridKind::Hemisphere, phi_r_relative: relative, ..incidences };
    match &campaign.sensor {
        SensorArm::Hemisphere { side, theta_r_bins, phi_r_bins, bins } => Grid {
            theta_r_edges_deg: edges_of_side(theta_edges(*theta_r_bins, *bins), *side),
            phi_r_edges_deg: phi_edges(*phi_r_bins, *bins),
            ..empty
        },
        SensorArm::Arm { theta_r_deg, phi_r_deg, aperture_deg, phi_r_from } => Grid {
            kind: GridKind::Arm,
            phi_r_relative: relative || *phi_r_from == PhiFrom::Light,
            theta_r_deg: theta_r_deg.clone(),
            phi_r_deg: phi_r_deg.clone(),
            aperture_deg: Some(*aperture_deg),
            ..empty
        },
        SensorArm::KlemsFull { side } => {
            Grid { kind: GridKind::Patches, patches_deg: patches_of_side(&FULL, *side), ..empty }
        }
    }
}

impl Grid {
    /// The same rows of a hemisphere above the horizon, in the same distances from the pole below it, or both.
    pub fn of_side(self, side: SensorSide) -> Grid {
        Grid { theta_r_edges_deg: edges_of_side(self.theta_r_edges_deg, side), ..self }
    }
}

/// The edges of a hemisphere above, those below it in the same distances from the pole, or both.
fn edges_of_side(above: Vec<f64>, side: SensorSide) -> Vec<f64> {
    let below = above.iter().rev().map(|edge| 180.0 - edge);
    match side {
        SensorSide::Reflection => above,
        SensorSide::Transmission => below.collect(),
        SensorSide::Both => above.iter().copied().chain(below.skip(1)).collect(),
    }
}

/// `rows` + 1 edges on the multiples of 90/rows, or `rows` + 2 half way between them and at both ends.
fn theta_edges(rows: u32, layout: BinLayout) -> Vec<f64> {
    let at = |k: f64| 90.0 * k / f64::from(rows);
    match layout {
        BinLayout::Aligned => (0..=rows).map(|k| at(f64::from(k))).collect(),
        BinLayout::Centred => {
            let inner = (0..rows).map(|k| at(f64::from(k) + 0.5));
            std::iter::once(0.0).chain(inner).chain([90.0]).collect()
        }
    }
}

fn phi_edges(columns: u32, layout: BinLayout) -> Vec<f64> {
    let shift = if layout == BinLayout::Centred { 0.5 } else { 0.0 };
    (0..=columns).map(|k| 360.0 * (f64::from(k) - shift) / f64::from(columns)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centred_bins_hold_the_multiples_of_the_step_in_their_middle() {
        assert_eq!(theta_edges(18, BinLayout::Centred)[..3], [0.0, 2.5, 7.5]);
        assert_eq!(theta_edges(18, BinLayout::Centred)[18..], [87.5, 90.0]);
        assert_eq!(theta_edges(18, BinLayout::Aligned)[17..], [85.0, 90.0]);
        assert_eq!(phi_edges(36, BinLayout::Centred)[..2], [-5.0, 5.0]);
        assert_eq!(phi_edges(36, BinLayout::Aligned)[36], 360.0);
    }
}
