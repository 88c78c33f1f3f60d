//! Bins between polar angles and azimuths that are unions of other such bins.

use super::incidences::SAME_DEG;
use super::totals::Sources;
use crate::instrument::{Grid, GridKind, Region};

/// How far the bins of a union may miss its size, as a share of it: rounding of edges in degrees.
const SAME_SIZE: f64 = 1e-9;

/// A sensor's bins ring by ring, degrees.
pub struct Rings {
    rings: Vec<Ring>,
    bins: usize,
}

/// Bins between the same polar angles.
struct Ring {
    theta: [f64; 2],
    /// The number of the first bin; the others follow.
    first: usize,
    phi: Vec<[f64; 2]>,
}

impl Rings {
    /// The bins of a hemisphere or a list of patches, turned by `turn_deg`.
    pub fn of(grid: &Grid, turn_deg: f64) -> Self {
        let mut found = Rings { rings: Vec::new(), bins: 0 };
        let mut add = |theta: [f64; 2], phi: [f64; 2]| {
            let phi = phi.map(|angle| angle + turn_deg);
            match found.rings.last_mut() {
                Some(ring) if ring.theta == theta => ring.phi.push(phi),
                _ => found.rings.push(Ring { theta, first: found.bins, phi: vec![phi] }),
            }
            found.bins += 1;
        };
        if grid.kind == GridKind::Patches {
            grid.patches_deg.iter().for_each(|&[t1, t2, p1, p2]| add([t1, t2], [p1, p2]));
        } else {
            for theta in grid.theta_r_edges_deg.windows(2) {
                grid.phi_r_edges_deg.windows(2).for_each(|phi| add([theta[0], theta[1]], [phi[0], phi[1]]));
            }
        }
        found
    }
}

/// For each bin of `coarse`, the bins of `fine` that it is the union of, weighted by projected solid angle; none where
/// `fine` has nothing there, as on the other side of the surface. `None` where a bin is no union, or none is one.
// Tested by `unions_of_bins_are_found`.
pub fn nested(fine: &Rings, coarse: &Rings) -> Option<Vec<Sources>> {
    let mut found: Vec<Sources> = vec![Vec::new(); coarse.bins];
    let mut meet = false;
    for ring in &fine.rings {
        let [low, high] = ring.theta;
        let overlaps = |other: &&Ring| low < other.theta[1] - SAME_DEG && other.theta[0] + SAME_DEG < high;
        let mut over = coarse.rings.iter().filter(overlaps);
        let Some(around) = over.next() else { continue };
        let inside = low >= around.theta[0] - SAME_DEG && high <= around.theta[1] + SAME_DEG;
        if !inside || over.next().is_some() {
            return None;
        }
        meet = true;
        for (k, &phi) in ring.phi.iter().enumerate() {
            let column = around.phi.iter().position(|&around| holds(around, phi))?;
            let size = size_of(ring.theta, phi);
            found[around.first + column].push((ring.first + k, size));
        }
    }
    for ring in &coarse.rings {
        for (k, &phi) in ring.phi.iter().enumerate() {
            let (sources, size) = (&mut found[ring.first + k], size_of(ring.theta, phi));
            let sum: f64 = sources.iter().map(|source| source.1).sum();
            if !sources.is_empty() && (sum / size - 1.0).abs() > SAME_SIZE {
                return None;
            }
            sources.iter_mut().for_each(|source| source.1 /= sum);
        }
    }
    meet.then_some(found)
}

/// Whether one range of azimuths lies in another, whole turns apart.
fn holds([low, high]: [f64; 2], [first, last]: [f64; 2]) -> bool {
    let after = (first - low + SAME_DEG).rem_euclid(360.0) - SAME_DEG;
    after + (last - first) <= high - low + SAME_DEG
}

fn size_of(theta: [f64; 2], phi: [f64; 2]) -> f64 {
    let region = Region::Rectangle { theta: theta.map(f64::to_radians), phi: phi.map(f64::to_radians) };
    region.projected_solid_angle()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hemisphere(theta: &[f64], phi: &[f64]) -> Grid {
        Grid { theta_r_edges_deg: theta.into(), phi_r_edges_deg: phi.into(), ..Grid::default() }
    }

    #[test]
    fn unions_of_bins_are_found() {
        let coarse = hemisphere(&[0.0, 30.0, 90.0], &[0.0, 180.0, 360.0]);
        let fine = hemisphere(&[0.0, 20.0, 30.0, 90.0], &[-90.0, 0.0, 90.0, 180.0, 270.0]);
        let found = nested(&Rings::of(&fine, 0.0), &Rings::of(&coarse, 0.0)).expect("unions");
        let numbers = |sources: &Sources| sources.iter().map(|source| source.0).collect::<Vec<_>>();
        // Columns of the fine grid: -90 .. 0 is 270 .. 360, the second half.
        assert_eq!(
            found.iter().map(numbers).collect::<Vec<_>>(),
            [vec![1, 2, 5, 6], vec![0, 3, 4, 7], vec![9, 10], vec![8, 11]]
        );
        // sin^2 20 against sin^2 30 = 1/4, in two columns each.
        let inner = 2.0 * 20f64.to_radians().sin().powi(2);
        assert!((found[0][0].1 - inner).abs() < 1e-15 && (found[0][2].1 - (0.5 - inner)).abs() < 1e-15);
        // Turned by a column they still nest, by half a one they do not, and edges at 25 never do.
        assert!(nested(&Rings::of(&fine, 90.0), &Rings::of(&coarse, 0.0)).is_some());
        assert!(nested(&Rings::of(&fine, 45.0), &Rings::of(&coarse, 0.0)).is_none());
        let off = hemisphere(&[0.0, 25.0, 90.0], &[0.0, 180.0, 360.0]);
        assert!(nested(&Rings::of(&fine, 0.0), &Rings::of(&off, 0.0)).is_none());
        // One side of both: nothing below the horizon; nothing at all on the other side alone.
        let both = hemisphere(&[0.0, 30.0, 90.0, 180.0], &[0.0, 180.0, 360.0]);
        let found = nested(&Rings::of(&fine, 0.0), &Rings::of(&both, 0.0)).expect("one side");
        assert!(found[3].len() == 2 && found[4].is_empty() && found[5].is_empty());
        let below = hemisphere(&[90.0, 180.0], &[0.0, 360.0]);
        assert!(nested(&Rings::of(&fine, 0.0), &Rings::of(&below, 0.0)).is_none());
    }
}
