//! The hemisphere that pictures and viewer draw, whatever the table's grid is.
//!
//! Input: a grid. Output: its light directions as a product of polar angles and azimuths, and its sensor either as rows
//! and columns, each with the bin that it shows, or as single directions. Values are never interpolated here.

use glam::DVec3;

use crate::instrument::grid::GridKind;
use crate::instrument::{Grid, Region, Sensor};
use crate::sphere;

/// Columns of patches whose rings have no azimuths in common, and rows and columns of scattered directions.
const COLUMNS: usize = 180;
const SCATTERED: [usize; 2] = [36, 72];
/// Columns of edges taken as they are at most.
const MOST_EDGES: usize = 240;
/// Widest gap between single directions that still make a hemisphere, degrees.
const WIDEST_GAP_DEG: f64 = 45.0;
/// Share of a hemisphere that scattered directions must come near to.
const COVERED: f64 = 0.8;

/// What is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnHemisphere {
    /// Polar angles of the light, increasing, and azimuths.
    pub theta_i_deg: Vec<f64>,
    /// Azimuths of the light.
    pub phi_i_deg: Vec<f64>,
    /// The table's incidence for each pair of them, azimuths fastest.
    pub incidences: Vec<usize>,
    /// Where the sensor's values are drawn.
    pub sensor: Places,
    /// What is left out or moved, in words.
    pub notes: Vec<String>,
}

/// Where values are drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Places {
    /// Rows and columns between edges.
    Bins(Raster),
    /// Single directions, (theta, phi) in degrees: too few to make a hemisphere.
    Spots {
        /// Directions.
        directions_deg: Vec<[f64; 2]>,
        /// Half-angle of the aperture.
        aperture_deg: f64,
        /// Directions from one to its neighbour of the same azimuth.
        step: usize,
    },
}

/// Rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// Edges of the rows, from 0 to 90 degrees or less.
    pub theta_deg: Vec<f64>,
    /// Edges of the columns, a whole turn.
    pub phi_deg: Vec<f64>,
    /// The table's bin that each cell shows, azimuths fastest; `None`: nothing was measured there.
    pub source: Vec<Option<usize>>,
    /// Directions of rows and columns, where they are not the middles between the edges.
    pub nodes_deg: Option<[Vec<f64>; 2]>,
}

/// What is drawn of a grid; `None` for kinds that are not known here. With gaps in its table nothing is drawn between
/// single directions.
// Tested by `klems_patches_are_drawn_where_they_lie`, `directions_in_rings_are_drawn_about_themselves`,
// `an_arm_in_a_plane_is_drawn_as_single_directions`.
pub fn shown(grid: &Grid, has_gaps: bool) -> Option<DrawnHemisphere> {
    if grid.kind == GridKind::HalfDifference {
        return None;
    }
    let mut notes = Vec::new();
    let (theta_i_deg, phi_i_deg, incidences) = light(grid, &mut notes);
    let sensor = if grid.kind == GridKind::Hemisphere {
        Places::Bins(Raster {
            theta_deg: grid.theta_r_edges_deg.clone(),
            phi_deg: grid.phi_r_edges_deg.clone(),
            source: (0..grid.bins()).map(Some).collect(),
            nodes_deg: None,
        })
    } else if grid.kind == GridKind::Patches {
        Places::Bins(patches(grid))
    } else {
        directions(grid, has_gaps, &mut notes)
    };
    Some(DrawnHemisphere { theta_i_deg, phi_i_deg, incidences, sensor, notes })
}

/// The light's directions as a product. Of a list only the azimuths stay that most polar angles share.
fn light(grid: &Grid, notes: &mut Vec<String>) -> (Vec<f64>, Vec<f64>, Vec<usize>) {
    let all: Vec<(f64, f64)> =
        (0..grid.incidences()).map(|incidence| grid.incidence_deg(incidence)).collect();
    let distinct = |values: &mut dyn Iterator<Item = f64>| {
        let mut values: Vec<f64> = values.collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let mut theta = distinct(&mut all.iter().map(|incidence| incidence.0));
    let find = |theta: f64, phi: f64| {
        // Light along the normal has no azimuth.
        let same = |incidence: &(f64, f64)| incidence.0 == theta && (incidence.1 == phi || theta == 0.0);
        all.iter().position(|incidence| *incidence == (theta, phi)).or_else(|| all.iter().position(same))
    };
    let azimuths = distinct(&mut all.iter().map(|incidence| incidence.1));
    let angles_at = |phi: f64| theta.iter().filter(|&&theta| find(theta, phi).is_some()).count();
    let most = azimuths.iter().map(|&phi| angles_at(phi)).max().unwrap_or(0);
    let phi: Vec<f64> = azimuths.iter().copied().filter(|&phi| angles_at(phi) == most).collect();
    theta.retain(|&theta| phi.iter().all(|&phi| find(theta, phi).is_some()));
    let incidences: Vec<usize> =
        theta.iter().flat_map(|&t| phi.iter().filter_map(move |&p| find(t, p))).collect();
    if grid.incidences() > incidences.len() {
        let (kept, all) = (incidences.len(), grid.incidences());
        notes.push(format!("the {kept} of {all} light directions whose azimuths all polar angles share"));
    }
    (theta, phi, incidences)
}

/// Patches between the edges that they have; where these are too many, columns of two degrees.
fn patches(grid: &Grid) -> Raster {
    let edges = |pick: &dyn Fn(&[f64; 4]) -> [f64; 2]| {
        let mut edges: Vec<f64> = grid.patches_deg.iter().flat_map(pick).collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        edges
    };
    let theta_deg = edges(&|patch| [patch[0], patch[1]]);
    let around = |phi: f64| if phi.rem_euclid(360.0) > 360.0 - 1e-9 { 0.0 } else { phi.rem_euclid(360.0) };
    let mut phi_deg = edges(&|patch| [around(patch[2]), around(patch[3])]);
    if phi_deg.len() > MOST_EDGES || phi_deg.len() < 2 {
        phi_deg = steps(COLUMNS, 360.0);
    } else {
        phi_deg.push(phi_deg[0] + 360.0);
    }
    let sensor = Sensor::new(grid);
    let holder = |theta: f64, phi: f64| {
        let mut found = None;
        sensor.each_bin(sphere::direction_deg(theta, phi), |bin| found = Some(bin));
        found
    };
    let source = cells(&theta_deg, &phi_deg).map(|[theta, phi]| holder(theta, phi)).collect();
    Raster { theta_deg, phi_deg, source, nodes_deg: None }
}

/// Single directions: rings of equal azimuths, a hemisphere of scattered ones, or spots.
fn directions(grid: &Grid, has_gaps: bool, notes: &mut Vec<String>) -> Places {
    let axes: Vec<DVec3> = grid.regions(0).iter().map(Region::middle).collect();
    let degrees = |axis: &DVec3| [sphere::theta(*axis).to_degrees(), sphere::phi(*axis).to_degrees()];
    let spots = || Places::Spots {
        directions_deg: axes.iter().map(degrees).collect(),
        aperture_deg: grid.aperture_deg.unwrap_or(0.0),
        step: if grid.kind == GridKind::Arm { grid.phi_r_deg.len() } else { 1 },
    };
    if has_gaps {
        notes.push("single directions alone, as not every light has all of them".into());
        return spots();
    }
    if let Some(rings) = rings(grid) {
        return Places::Bins(rings);
    }
    let (theta_deg, phi_deg) = (steps(SCATTERED[0], 90.0), steps(SCATTERED[1], 360.0));
    let nearest = |[theta, phi]: [f64; 2]| {
        let wo = sphere::direction_deg(theta, phi);
        let cosine = |axis: &DVec3| axis.dot(wo);
        let best = axes.iter().enumerate().max_by(|a, b| cosine(a.1).total_cmp(&cosine(b.1)))?;
        (cosine(best.1) >= (0.25 * WIDEST_GAP_DEG).to_radians().cos()).then_some(best.0)
    };
    let source: Vec<Option<usize>> = cells(&theta_deg, &phi_deg).map(nearest).collect();
    if source.iter().flatten().count() as f64 >= COVERED * source.len() as f64 {
        notes.push("in every direction the value of the nearest one that was measured".into());
        return Places::Bins(Raster { theta_deg, phi_deg, source, nodes_deg: None });
    }
    spots()
}

/// Directions that are all pairs of some polar angles and some azimuths all around: cells with edges midway.
fn rings(grid: &Grid) -> Option<Raster> {
    let pairs: Vec<[f64; 2]> = match grid.kind {
        GridKind::Points => grid.points_deg.clone(),
        _ => grid.theta_r_deg.iter().flat_map(|&t| grid.phi_r_deg.iter().map(move |&p| [t, p])).collect(),
    };
    let columns = pairs.iter().take_while(|pair| pair[0] == pairs[0][0]).count();
    let theta: Vec<f64> = pairs.chunks(columns).map(|ring| ring[0][0]).collect();
    let phi: Vec<f64> = pairs[..columns].iter().map(|pair| pair[1]).collect();
    let is_product = pairs.len() == theta.len() * columns
        && pairs.iter().enumerate().all(|(k, pair)| *pair == [theta[k / columns], phi[k % columns]]);
    let increasing = |values: &[f64]| values.windows(2).all(|pair| pair[0] < pair[1]);
    let gap = |pair: &[f64]| pair[1] - pair[0];
    let whole = phi[columns - 1] - phi[0] < 360.0
        && phi
            .windows(2)
            .map(gap)
            .chain([phi[0] + 360.0 - phi[columns - 1]])
            .all(|gap| gap <= WIDEST_GAP_DEG);
    if !is_product || theta.len() < 3 || theta[0] < 0.0 || !increasing(&theta) || !increasing(&phi) || !whole
    {
        return None;
    }
    let between = |pair: &[f64]| 0.5 * (pair[0] + pair[1]);
    let last = theta.len() - 1;
    let end = (theta[last] + 0.5 * (theta[last] - theta[last - 1])).min(90.0);
    let theta_deg = [0.0].into_iter().chain(theta.windows(2).map(between)).chain([end]).collect();
    let first = 0.5 * (phi[0] + phi[columns - 1] - 360.0);
    let phi_deg = [first].into_iter().chain(phi.windows(2).map(between)).chain([first + 360.0]).collect();
    let source = (0..pairs.len()).map(Some).collect();
    Some(Raster { theta_deg, phi_deg, source, nodes_deg: Some([theta, phi]) })
}

fn steps(count: usize, whole: f64) -> Vec<f64> {
    (0..=count).map(|k| whole * k as f64 / count as f64).collect()
}

/// The middles of cells, azimuths fastest.
fn cells<'a>(theta: &'a [f64], phi: &'a [f64]) -> impl Iterator<Item = [f64; 2]> + 'a {
    let between = |pair: &[f64]| 0.5 * (pair[0] + pair[1]);
    theta.windows(2).flat_map(move |t| phi.windows(2).map(move |p| [between(t), between(p)]))
}

impl Raster {
    /// Projected solid angle of every cell, sr.
    pub fn sizes(&self) -> Vec<f64> {
        let radians = |pair: &[f64]| [pair[0].to_radians(), pair[1].to_radians()];
        let row = |theta: &[f64]| {
            let theta = radians(theta);
            let size =
                move |phi: &[f64]| Region::Rectangle { theta, phi: radians(phi) }.projected_solid_angle();
            self.phi_deg.windows(2).map(size).collect::<Vec<_>>()
        };
        self.theta_deg.windows(2).flat_map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rings of 1 and 4 patches, the second centred on azimuth 0; light from the same patches.
    #[test]
    fn klems_patches_are_drawn_where_they_lie() {
        let ring = |k: f64| [30.0, 90.0, 90.0 * k - 45.0, 90.0 * k + 45.0];
        let grid = Grid {
            kind: GridKind::Patches,
            incidences_deg: vec![[0.0, 0.0], [60.0, 0.0], [60.0, 90.0], [60.0, 180.0], [60.0, 270.0]],
            patches_deg: [vec![[0.0, 30.0, -180.0, 180.0]], (0..4).map(|k| ring(f64::from(k))).collect()]
                .concat(),
            ..Grid::default()
        };
        let shown = shown(&grid, false).expect("known");
        assert_eq!(
            (&shown.theta_i_deg[..], &shown.phi_i_deg[..]),
            (&[0.0, 60.0][..], &[0.0, 90.0, 180.0, 270.0][..])
        );
        assert_eq!(shown.incidences, [0, 0, 0, 0, 1, 2, 3, 4]);
        let Places::Bins(raster) = shown.sensor else { panic!("patches fill the hemisphere") };
        assert_eq!(raster.theta_deg, [0.0, 30.0, 90.0]);
        assert_eq!(raster.phi_deg, [45.0, 135.0, 180.0, 225.0, 315.0, 405.0]);
        let of = |bins: &[usize]| bins.iter().map(|&bin| Some(bin)).collect::<Vec<_>>();
        assert_eq!(raster.source, [of(&[0; 5]), of(&[2, 3, 3, 4, 1])].concat());
    }

    #[test]
    fn directions_in_rings_are_drawn_about_themselves() {
        let pairs = |thetas: &[f64]| {
            thetas.iter().flat_map(|&t| (0..12).map(move |k| [t, 30.0 * f64::from(k)])).collect::<Vec<_>>()
        };
        let grid = Grid {
            kind: GridKind::Points,
            theta_i_deg: vec![0.0, 40.0],
            phi_i_deg: vec![0.0],
            points_deg: pairs(&[0.0, 30.0, 60.0]),
            ..Grid::default()
        };
        let Places::Bins(raster) = shown(&grid, false).expect("known").sensor else { panic!("rings") };
        assert_eq!(raster.theta_deg, [0.0, 15.0, 45.0, 75.0]);
        assert_eq!((raster.phi_deg[0], raster.phi_deg[1], raster.phi_deg[12]), (-15.0, 15.0, 345.0));
        assert_eq!(raster.nodes_deg.as_ref().map(|nodes| nodes[0].clone()), Some(vec![0.0, 30.0, 60.0]));
        assert_eq!(raster.source, (0..36).map(Some).collect::<Vec<_>>());
    }

    #[test]
    fn an_arm_in_a_plane_is_drawn_as_single_directions() {
        let grid = Grid {
            kind: GridKind::Arm,
            theta_i_deg: vec![30.0],
            phi_i_deg: vec![0.0],
            theta_r_deg: vec![-30.0, 0.0, 30.0],
            phi_r_deg: vec![180.0],
            aperture_deg: Some(2.0),
            ..Grid::default()
        };
        let Places::Spots { directions_deg, aperture_deg, step } = shown(&grid, false).expect("known").sensor
        else {
            panic!("three directions are no hemisphere");
        };
        assert_eq!((directions_deg.len(), aperture_deg, step), (3, 2.0, 1));
        // A negative polar angle is the other side of the plane.
        let far = [directions_deg[0][0] - 30.0, sphere::reduced_deg(directions_deg[0][1] + 180.0) - 180.0];
        assert!(far[0].abs() < 1e-9 && far[1].abs() < 1e-9, "{directions_deg:?}");
    }
}
