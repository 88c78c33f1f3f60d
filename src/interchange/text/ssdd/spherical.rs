//! SSDD in spherical coordinates as a table of points.

use super::header::SsddHeader;
use crate::error::wrong;
use crate::instrument::{Grid, GridKind};
use crate::interchange::{Checked, spectral_table};
use crate::table::{BrdfTable, check_grid};

/// The table of a file's values, the other half of symmetric ones filled in.
pub fn table(header: &SsddHeader, mut total: Vec<Vec<f32>>) -> Checked<BrdfTable> {
    let grid = grid(header)?;
    let grid = if header.bilateral { mirrored(grid, &mut total) } else { grid };
    spectral_table(grid, total, &header.wavelengths_nm)
}

/// The incidences and directions that a file lists.
pub fn grid(header: &SsddHeader) -> Checked<Grid> {
    let [theta_i, phi_i, theta_r, phi_r] = &header.lists;
    for (list, angles) in [(0, theta_i), (2, theta_r)] {
        if let Some(angle) = angles.iter().find(|angle| !(0.0..=90.0).contains(*angle)) {
            return Err(wrong!("PARAM{list}_LIST: polar angle {angle} lies outside [0, 90]"));
        }
    }
    // Azimuths of the light are needed of anisotropic data: without them there is one kind of azimuth, from the light.
    let phi_r_relative = !header.anisotropic;
    if header.bilateral && (phi_i != &[0.0] || phi_r.iter().any(|phi| !(0.0..=180.0).contains(phi))) {
        return Err("bilateral_symmetry: PARAM3_LIST in [0, 180] and no azimuths of the light needed".into());
    }
    if header.reciprocal {
        return Err("REDUCTION_TYPE reciprocity: half_difference_coordinate_system needed".into());
    }
    let grid = Grid {
        kind: GridKind::Points,
        theta_i_deg: theta_i.clone(),
        phi_i_deg: phi_i.clone(),
        phi_r_relative,
        points_deg: theta_r.iter().flat_map(|&t| phi_r.iter().map(move |&p| [t, p])).collect(),
        ..Grid::default()
    };
    check_grid(&grid)?;
    Ok(grid)
}

/// The other half of a table that is its own mirror image at the plane of incidence.
fn mirrored(grid: Grid, total: &mut [Vec<f32>]) -> Grid {
    let (bins, points) = (grid.bins(), &grid.points_deg);
    let half: Vec<usize> = (0..bins).filter(|&bin| points[bin][1] > 0.0 && points[bin][1] < 180.0).collect();
    // Azimuths run fastest and up within a polar angle: the mirrored ones follow, down from 360.
    let rows = points.chunk_by(|a, b| a[0] == b[0]).scan(0, |first, row| {
        let begin = *first;
        *first += row.len();
        Some(begin..*first)
    });
    let order: Vec<(usize, bool)> = rows
        .flat_map(|row| {
            let back = row.clone().rev().filter(|bin| half.contains(bin)).map(|bin| (bin, true));
            row.map(|bin| (bin, false)).chain(back.collect::<Vec<_>>())
        })
        .collect();
    for values in total.iter_mut() {
        *values =
            values.chunks(bins).flat_map(|incidence| order.iter().map(|(bin, _)| incidence[*bin])).collect();
    }
    let point = |&(bin, back): &(usize, bool)| {
        let [theta, phi] = points[bin];
        [theta, if back { 360.0 - phi } else { phi }]
    };
    Grid { points_deg: order.iter().map(point).collect(), ..grid }
}
