//! Small tables for the unit tests of this folder.

use crate::instrument::Grid;
use crate::instrument::grid::GridKind;

use super::{BrdfTable, ColourChannels};

/// A 2 x 6 table of one or three colours.
pub(super) fn table(colours: usize) -> BrdfTable {
    let grid = Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: vec![0.0, 360.0 / 7.0],
        phi_i_deg: vec![0.0],
        phi_r_relative: true,
        theta_r_edges_deg: vec![0.0, 100.0 / 3.0, 90.0],
        phi_r_edges_deg: vec![-60.0, 60.0, 180.0, 300.0],
        ..Grid::default()
    };
    BrdfTable {
        grid,
        campaign: "name = \"µ\"\n".into(),
        version: "0.1.0".into(),
        seed: u64::MAX,
        patch_digest: "ab".into(),
        colours: (0..colours).map(|i| colour(1.0 + i as f32, 12)).collect(),
        hits: (0..12).collect(),
        schlick: None,
    }
}

/// Channels of `pixels` different values.
pub(super) fn colour(scale: f32, pixels: u16) -> ColourChannels {
    let ramp = |offset: f32| (0..pixels).map(|i| scale * (offset + f32::from(i)).sqrt()).collect::<Vec<_>>();
    ColourChannels {
        total: ramp(0.1),
        single: ramp(0.2),
        multiple: ramp(0.3),
        stderr: ramp(0.4),
        stderr_single: vec![-1.0; usize::from(pixels)],
        ..ColourChannels::default()
    }
}
