//! The two halves of a sensor that looks at both sides of the surface.

use super::grid::{Grid, GridKind};

/// A part of a sensor, or its mirror image.
pub struct Half {
    /// Its bins.
    pub grid: Grid,
    /// The place of each of them in the whole.
    pub bins: Vec<usize>,
}

impl Half {
    /// What `values` of the whole sensor, incidence by incidence, say of this half; a channel that is empty stays so.
    pub fn of<T: Copy>(&self, values: &[T], incidences: usize) -> Vec<T> {
        if values.is_empty() {
            return Vec::new();
        }
        let bins = values.len() / incidences.max(1);
        (0..incidences)
            .flat_map(|incidence| self.bins.iter().map(move |bin| values[incidence * bins + bin]))
            .collect()
    }
}

impl Grid {
    /// The bins above the horizon, or those `below` it as a mirror in the horizon shows them; `None` where there are
    /// none.
    // Tested by `halves_are_the_bins_of_one_side`.
    pub fn half(&self, below: bool) -> Option<Half> {
        let side = self.side(below)?;
        if !below {
            return Some(side);
        }
        let image = side.grid.mirrored()?;
        Some(Half { bins: image.bins.iter().map(|&bin| side.bins[bin]).collect(), grid: image.grid })
    }

    /// The bins above the horizon, or `below` it, where they are; `None` where there are none.
    pub fn side(&self, below: bool) -> Option<Half> {
        let side = match self.kind {
            GridKind::Hemisphere => {
                let edges = &self.theta_r_edges_deg;
                let rows = places(&edges[..edges.len() - 1], |edge| (*edge >= 90.0) == below);
                let kept = edges.iter().copied().filter(|&edge| (edge >= 90.0) == below || edge == 90.0);
                let grid = Grid { theta_r_edges_deg: kept.collect(), ..self.clone() };
                Half { bins: self.of_rows(&rows), grid }
            }
            GridKind::Arm => {
                let rows = places(&self.theta_r_deg, |theta| (theta.abs() > 90.0) == below);
                let theta_r_deg = rows.iter().map(|&row| self.theta_r_deg[row]).collect();
                Half { bins: self.of_rows(&rows), grid: Grid { theta_r_deg, ..self.clone() } }
            }
            GridKind::Patches => {
                let bins = places(&self.patches_deg, |patch| (patch[0] >= 90.0) == below);
                let patches_deg = bins.iter().map(|&bin| self.patches_deg[bin]).collect();
                Half { grid: Grid { patches_deg, ..self.clone() }, bins }
            }
            GridKind::Points => {
                let bins = places(&self.points_deg, |point| (point[0] > 90.0) == below);
                let points_deg = bins.iter().map(|&bin| self.points_deg[bin]).collect();
                Half { grid: Grid { points_deg, ..self.clone() }, bins }
            }
            GridKind::HalfDifference if below => return None,
            GridKind::HalfDifference => Half { grid: self.clone(), bins: (0..self.bins()).collect() },
        };
        (!side.bins.is_empty()).then_some(side)
    }

    /// The sensor as a mirror in the horizon shows it: rows of bins run from the pole above, as everywhere. `None` for
    /// half/difference angles.
    pub fn mirrored(&self) -> Option<Half> {
        let same = 0..self.bins();
        let (grid, bins) = match self.kind {
            GridKind::Hemisphere => {
                let edges = self.theta_r_edges_deg.iter().rev().map(|edge| 180.0 - edge);
                let rows: Vec<usize> = (0..self.theta_r_edges_deg.len() - 1).rev().collect();
                (Grid { theta_r_edges_deg: edges.collect(), ..self.clone() }, self.of_rows(&rows))
            }
            GridKind::Arm => {
                let theta_r_deg = self.theta_r_deg.iter().map(|&theta| across(theta)).collect();
                (Grid { theta_r_deg, ..self.clone() }, same.collect())
            }
            GridKind::Patches => {
                let image = |&[t1, t2, p1, p2]: &[f64; 4]| [180.0 - t2, 180.0 - t1, p1, p2];
                let patches_deg = self.patches_deg.iter().map(image).collect();
                (Grid { patches_deg, ..self.clone() }, same.collect())
            }
            GridKind::Points => {
                let points_deg = self.points_deg.iter().map(|&[theta, phi]| [across(theta), phi]).collect();
                (Grid { points_deg, ..self.clone() }, same.collect())
            }
            GridKind::HalfDifference => return None,
        };
        Some(Half { grid, bins })
    }

    /// The bins of some rows of polar angles, in their order.
    fn of_rows(&self, rows: &[usize]) -> Vec<usize> {
        let columns =
            if self.kind == GridKind::Arm { self.phi_r_deg.len() } else { self.phi_r_edges_deg.len() - 1 };
        rows.iter().flat_map(|row| (0..columns).map(move |column| row * columns + column)).collect()
    }
}

fn places<T>(all: &[T], is_wanted: impl Fn(&T) -> bool) -> Vec<usize> {
    all.iter().enumerate().filter(|(_, one)| is_wanted(one)).map(|(place, _)| place).collect()
}

/// A polar angle as a mirror in the horizon shows it; a negative one is the far side of its plane and stays that.
fn across(theta_deg: f64) -> f64 {
    (180.0 - theta_deg.abs()).copysign(theta_deg)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn check(grid: &Grid) {
        let whole = grid.regions(0);
        let mut found = 0;
        for below in [false, true] {
            let half = grid.half(below).expect("both sides are looked at");
            found += half.bins.len();
            for (region, &bin) in half.grid.regions(0).iter().zip(&half.bins) {
                assert_eq!(whole[bin].is_below(), below);
                let middle = whole[bin].middle();
                let expected = DVec3 { z: middle.z.abs(), ..middle };
                // Angles of a degree or so rounded: 180 - t, to radians, a sine.
                assert!(region.middle().distance(expected) < 1e-14, "{region:?}");
                let sizes = region.projected_solid_angle() / whole[bin].projected_solid_angle();
                assert!((sizes - 1.0).abs() < 1e-12, "{region:?}");
            }
        }
        assert_eq!(found, grid.bins());
    }

    #[test]
    fn halves_are_the_bins_of_one_side() {
        let incidences = Grid { theta_i_deg: vec![30.0], phi_i_deg: vec![20.0], ..Grid::default() };
        let edges = vec![0.0, 20.0, 90.0, 120.0, 175.0, 180.0];
        check(&Grid {
            theta_r_edges_deg: edges,
            phi_r_edges_deg: vec![-10.0, 100.0, 350.0],
            ..incidences.clone()
        });
        check(&Grid {
            kind: GridKind::Arm,
            theta_r_deg: vec![-170.0, -120.0, -30.0, 10.0, 95.0],
            phi_r_deg: vec![0.0, 33.0],
            aperture_deg: Some(2.0),
            ..incidences.clone()
        });
        let patches_deg = vec![[0.0, 5.0, 0.0, 360.0], [100.0, 130.0, 10.0, 40.0]];
        check(&Grid { kind: GridKind::Patches, patches_deg, ..incidences.clone() });
        let above =
            Grid { theta_r_edges_deg: vec![0.0, 90.0], phi_r_edges_deg: vec![0.0, 360.0], ..incidences };
        assert!(above.half(true).is_none());
        assert_eq!(above.half(false).expect("one half").grid, above);
    }
}
