//! The grid as an attribute of the table's files, and the checks of its axes.

use crate::error::{Checked, wrong};
use crate::files::image::ImagePart;
use crate::instrument::Grid;
use crate::instrument::grid::GridKind;

/// Name of the grid's attribute.
pub(super) const GRID: &str = "gonio.grid";

/// Incidences and bins of a grid; an axis that no instrument has is a reason to refuse it.
// Tested by `axes_that_no_instrument_has_are_refused`.
pub fn check_grid(grid: &Grid) -> Checked<(usize, usize)> {
    if grid.kind == GridKind::HalfDifference {
        return half_difference(grid);
    }
    if grid.incidences_deg.is_empty() {
        axis("theta_i_deg", &grid.theta_i_deg, 1, 0.0..=90.0)?;
        axis("phi_i_deg", &grid.phi_i_deg, 1, -360.0..=360.0)?;
    } else {
        if !grid.theta_i_deg.is_empty() || !grid.phi_i_deg.is_empty() {
            return Err(wrong!(
                "{GRID}: stops_deg next to the axes theta_i_deg and phi_i_deg: only one is allowed"
            ));
        }
        directions("stops_deg", &grid.incidences_deg, 90.0)?;
    }
    match grid.kind {
        GridKind::Hemisphere => {
            axis("theta_r_edges_deg", &grid.theta_r_edges_deg, 2, 0.0..=180.0)?;
            increasing("theta_r_edges_deg", &grid.theta_r_edges_deg)?;
            off_horizon("theta_r_edges_deg", &grid.theta_r_edges_deg)?;
            axis("phi_r_edges_deg", &grid.phi_r_edges_deg, 2, -720.0..=720.0)?;
            increasing("phi_r_edges_deg", &grid.phi_r_edges_deg)?;
        }
        GridKind::Arm => {
            axis("theta_r_deg", &grid.theta_r_deg, 1, -180.0..=180.0)?;
            axis("phi_r_deg", &grid.phi_r_deg, 1, -360.0..=360.0)?;
            axis("aperture_deg", grid.aperture_deg.as_slice(), 1, 0.0..=90.0)?;
        }
        GridKind::Points => directions("points_deg", &grid.points_deg, 180.0)?,
        GridKind::Patches => patches(&grid.patches_deg)?,
        GridKind::HalfDifference => {}
    }
    Ok((grid.incidences(), grid.bins()))
}

/// Axes of half vectors and differences; others are of no use next to them.
fn half_difference(grid: &Grid) -> Checked<(usize, usize)> {
    if !(grid.theta_i_deg.is_empty() && grid.phi_i_deg.is_empty() && grid.incidences_deg.is_empty()) {
        return Err(wrong!("{GRID}: incidences next to half/difference angles: only one is allowed"));
    }
    let axes = [
        ("theta_h_deg", &grid.theta_h_deg, 90.0),
        ("phi_h_deg", &grid.phi_h_deg, 360.0),
        ("theta_d_deg", &grid.theta_d_deg, 90.0),
        ("phi_d_deg", &grid.phi_d_deg, 180.0),
    ];
    for (name, values, most) in axes {
        axis(name, values, 1, 0.0..=most)?;
        increasing(name, values)?;
        if most > 90.0 && values.last() == Some(&most) {
            return Err(wrong!("{GRID}: {name} = {most} already exists, as 0"));
        }
    }
    Ok((grid.incidences(), grid.bins()))
}

fn axis(name: &str, values: &[f64], least: usize, range: std::ops::RangeInclusive<f64>) -> Checked<()> {
    if values.len() < least {
        return Err(wrong!("{GRID}: {name} has {} values, at least {least} needed", values.len()));
    }
    match values.iter().find(|value| !range.contains(value)) {
        Some(value) => {
            Err(wrong!("{GRID}: {name} = {value} lies outside [{}, {}]", range.start(), range.end()))
        }
        None => Ok(()),
    }
}

/// A bin on both sides of the surface has no meaning.
fn off_horizon(name: &str, edges: &[f64]) -> Checked<()> {
    match edges.windows(2).find(|pair| pair[0] < 90.0 && 90.0 < pair[1]) {
        Some(pair) => {
            Err(wrong!("{GRID}: {name}: the horizon, 90, lies between {} and {}", pair[0], pair[1]))
        }
        None => Ok(()),
    }
}

/// Polar angles up to `most`, and azimuths.
fn directions(name: &str, values: &[[f64; 2]], most: f64) -> Checked<()> {
    axis(name, &values.iter().map(|d| d[0]).collect::<Vec<_>>(), 1, 0.0..=most)?;
    axis(name, &values.iter().map(|d| d[1]).collect::<Vec<_>>(), 1, -360.0..=360.0)
}

fn patches(values: &[[f64; 4]]) -> Checked<()> {
    axis("patches_deg", &values.iter().flat_map(|p| [p[0], p[1]]).collect::<Vec<_>>(), 2, 0.0..=180.0)?;
    values.iter().try_for_each(|patch| off_horizon("patches_deg", &patch[..2]))?;
    axis("patches_deg", &values.iter().flat_map(|p| [p[2], p[3]]).collect::<Vec<_>>(), 2, -720.0..=720.0)?;
    match values.iter().find(|p| p[0] >= p[1] || p[2] >= p[3] || p[3] - p[2] > 360.0) {
        Some(p) => Err(wrong!("{GRID}: the patch {p:?} is empty or wider than a turn")),
        None => Ok(()),
    }
}

fn increasing(name: &str, values: &[f64]) -> Checked<()> {
    match values.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => Err(wrong!("{GRID}: {name} does not increase from {} to {}", pair[0], pair[1])),
        None => Ok(()),
    }
}

/// The grid as the text of its attribute.
pub(super) fn grid_text(grid: &Grid) -> Checked<String> {
    serde_json::to_string(grid).map_err(|e| wrong!("{GRID}: {e}"))
}

/// The grid that a part carries; its size must be the part's.
pub(super) fn read_grid(part: &ImagePart) -> Checked<Grid> {
    let text = part.text(GRID).ok_or_else(|| format!("no {GRID} attribute: not a table of this program"))?;
    let grid: Grid = serde_json::from_str(text).map_err(|e| format!("{GRID}: {e}"))?;
    let (incidences, bins) = check_grid(&grid)?;
    if (incidences, bins) == (part.height, part.width) {
        return Ok(grid);
    }
    let (width, height) = (part.width, part.height);
    Err(wrong!(
        "{GRID} says {incidences} incidences and {bins} bins, the image is {width} wide and {height} high"
    ))
}

#[cfg(test)]
mod tests {
    use super::super::test_tables::table;
    use super::*;

    #[test]
    fn angles_come_back_from_the_grid_text_bit_for_bit() {
        let mut grid = table(1).grid;
        let mut state = 1_u64;
        grid.theta_i_deg = (0..20_000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 11) as f64 / (1_u64 << 53) as f64 * 90.0
            })
            .collect();
        let back: Grid = serde_json::from_str(&grid_text(&grid).expect("prints")).expect("parses");
        assert!(back == grid);
    }

    #[test]
    fn axes_that_no_instrument_has_are_refused() {
        let reason = |change: fn(&mut Grid)| {
            let mut grid = table(1).grid;
            change(&mut grid);
            check_grid(&grid).expect_err("must be refused").to_string()
        };
        assert!(reason(|g| g.phi_r_edges_deg.clear()).contains("phi_r_edges_deg has 0 values"));
        assert!(reason(|g| g.theta_r_edges_deg.swap(0, 1)).contains("does not increase"));
        assert!(reason(|g| g.theta_i_deg[0] = f64::NAN).contains("theta_i_deg = NaN"));
        assert!(reason(|g| g.kind = GridKind::Arm).contains("theta_r_deg has 0 values"));
    }
}
