//! Incidences and bins that a surface's symmetry makes alike: what theory says of one holds for all of them.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::grid::{Grid, GridKind, Region};
use crate::sphere;

/// What a surface's law does not change under.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfaceSymmetry {
    /// Turns, and mirror images.
    Isotropic,
    /// Mirror images about two axes, the first at this azimuth, radians.
    Axes(f64),
}

/// Incidences that are each other's images, brought to one place.
pub struct AlikeIncidences {
    /// The light there, unit vector, stage's frame.
    pub wi: DVec3,
    /// The bins there, one of those that are each other's images.
    pub regions: Vec<Region>,
    /// Each incidence, and for each of its bins the place of its image in `regions`.
    pub stops: Vec<(usize, Vec<usize>)>,
}

/// Angles that differ by less are the same, radians.
const SAME: f64 = 1e-9;

/// The incidences of a grid, those together that are alike.
// Tested by `alike_bins_are_found_once`, `alike_bins_have_the_means_of_each_by_itself` (tests/it/validate/bin_means.rs).
pub fn alike_incidences(grid: &Grid, symmetry: SurfaceSymmetry) -> Vec<AlikeIncidences> {
    let mut all: Vec<AlikeIncidences> = Vec::new();
    let mut known: Vec<HashMap<BinKey, usize>> = Vec::new();
    let mut places: HashMap<[i64; 2], usize> = HashMap::new();
    for stop in 0..grid.stops() {
        // Half vectors are no incidences.
        let image = match grid.kind {
            GridKind::HalfDifference => Image::itself(grid.wi(stop)),
            _ => Image::of(grid.wi(stop), symmetry),
        };
        let light = [image.theta, image.psi].map(rounded);
        let place = *places.entry(light).or_insert_with(|| {
            all.push(AlikeIncidences { wi: image.wi(), regions: vec![], stops: vec![] });
            known.push(HashMap::new());
            all.len() - 1
        });
        let (alike, known) = (&mut all[place], &mut known[place]);
        let of_bin = |region: &Region| {
            let (key, region) = image.region(region);
            *known.entry(key).or_insert_with(|| {
                alike.regions.push(region);
                alike.regions.len() - 1
            })
        };
        let bins = grid.regions(stop).iter().map(of_bin).collect();
        alike.stops.push((stop, bins));
    }
    all
}

/// Polar angles, azimuth of the middle and half of the width, rounded; of a cone its half-angle in place of the last, negative.
type BinKey = [i64; 4];

fn rounded(angle: f64) -> i64 {
    (angle / SAME).round() as i64
}

/// An azimuth in [-pi, pi); what is pi but for rounding is -pi.
fn wrapped(phi: f64) -> f64 {
    phi - TAU * ((phi + PI + SAME) / TAU).floor()
}

/// How an incidence is brought to its place.
struct Image {
    theta: f64,
    /// Azimuth of the light there, counted from `place`.
    psi: f64,
    /// What azimuths count from before and after, radians.
    origin: f64,
    place: f64,
    /// Whether azimuths are then mirrored about the first axis, and about the second.
    mirrored: [bool; 2],
    alike: AlikeBins,
}

/// Bins that are images of each other when the light is in its place.
#[derive(Clone, Copy)]
enum AlikeBins {
    /// None.
    Itself,
    /// About the first axis, on which the light lies, or the plane of incidence of an isotropic surface.
    First,
    /// About the second axis, on which the light lies.
    Second,
    /// About both, with light along the normal.
    Both,
    /// All azimuths, with light along the normal of an isotropic surface.
    Turned,
}

impl Image {
    fn itself(wi: DVec3) -> Self {
        let (theta, psi) = (sphere::theta(wi), sphere::phi(wi));
        Image { theta, psi, origin: 0.0, place: 0.0, mirrored: [false; 2], alike: AlikeBins::Itself }
    }

    fn of(wi: DVec3, symmetry: SurfaceSymmetry) -> Self {
        let (theta, phi) = (sphere::theta(wi), sphere::phi(wi));
        let normal = theta < SAME;
        let SurfaceSymmetry::Axes(axis) = symmetry else {
            let alike = if normal { AlikeBins::Turned } else { AlikeBins::First };
            return Image { theta, psi: 0.0, origin: phi, place: 0.0, mirrored: [false; 2], alike };
        };
        let psi = if normal { 0.0 } else { wrapped(phi - axis) };
        let mirrored = [psi < 0.0, psi.abs() > FRAC_PI_2];
        let psi = psi.abs().min(PI - psi.abs());
        let alike = match psi {
            _ if normal => AlikeBins::Both,
            _ if psi < SAME => AlikeBins::First,
            _ if FRAC_PI_2 - psi < SAME => AlikeBins::Second,
            _ => AlikeBins::Itself,
        };
        Image { theta, psi, origin: axis, place: axis, mirrored, alike }
    }

    /// The light in its place.
    fn wi(&self) -> DVec3 {
        sphere::direction(self.theta, self.place + self.psi)
    }

    /// Where a bin goes, and what tells it from bins that are not alike.
    fn region(&self, region: &Region) -> (BinKey, Region) {
        match *region {
            Region::Rectangle { theta, phi: [from, to] } => {
                let (middle, half) = (self.azimuth(0.5 * (from + to)), 0.5 * (to - from));
                let key = [rounded(theta[0]), rounded(theta[1]), rounded(middle), rounded(half)];
                let phi = [self.place + middle - half, self.place + middle + half];
                (key, Region::Rectangle { theta, phi })
            }
            Region::Cap { axis, half_angle } => {
                let (theta, middle) = (sphere::theta(axis), self.azimuth(sphere::phi(axis)));
                let key = [rounded(theta), -1, rounded(middle), rounded(half_angle)];
                (key, Region::Cap { axis: sphere::direction(theta, self.place + middle), half_angle })
            }
        }
    }

    /// Where the middle of a bin goes, counted from `place`.
    fn azimuth(&self, phi: f64) -> f64 {
        let about_first = |psi: f64| psi.abs();
        let about_second = |psi: f64| if psi.abs() > FRAC_PI_2 { wrapped(PI - psi) } else { psi };
        let [first, second] = self.mirrored;
        let psi = wrapped(phi - self.origin);
        let psi = if first { wrapped(-psi) } else { psi };
        let psi = if second { wrapped(PI - psi) } else { psi };
        match self.alike {
            AlikeBins::Itself => psi,
            AlikeBins::First => about_first(psi),
            AlikeBins::Second => about_second(psi),
            AlikeBins::Both => about_first(about_second(psi)),
            AlikeBins::Turned => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 x 8 bins from the light, or absolute.
    fn grid(stops_deg: &[[f64; 2]], phi_r_relative: bool) -> Grid {
        Grid {
            stops_deg: stops_deg.to_vec(),
            theta_r_edges_deg: vec![0.0, 30.0, 60.0, 90.0],
            phi_r_edges_deg: (0..=8).map(|k| 45.0 * f64::from(k) - 22.5).collect(),
            phi_r_relative,
            ..Grid::default()
        }
    }

    fn counts(grid: &Grid, symmetry: SurfaceSymmetry) -> Vec<(usize, usize)> {
        alike_incidences(grid, symmetry)
            .iter()
            .map(|alike| (alike.stops.len(), alike.regions.len()))
            .collect()
    }

    #[test]
    fn alike_bins_are_found_once() {
        // Middles at 0, 45, .., 315 degrees from the light: 0, 45, 90, 135, 180 and their mirror images. Along the normal one.
        let lights = grid(&[[0.0, 0.0], [40.0, 0.0], [40.0, 77.0]], true);
        assert_eq!(counts(&lights, SurfaceSymmetry::Isotropic), [(1, 3), (2, 15)]);
        // Of axes: all four images of one light; absolute bins are symmetric about axes at 0 and at 45 degrees.
        let lights = grid(&[[40.0, 30.0], [40.0, -30.0], [40.0, 150.0], [40.0, 210.0]], false);
        assert_eq!(counts(&lights, SurfaceSymmetry::Axes(0.0)), [(4, 24)]);
        // About an axis at 45 degrees 30 and -30 are at -15 and -75, 150 and 210 at 105 and 165, of which 15 and 75 are left.
        assert_eq!(counts(&lights, SurfaceSymmetry::Axes(PI / 4.0)), [(2, 24), (2, 24)]);
        // On an axis half of the bins, along the normal a quarter and those on the axes.
        let lights = grid(&[[40.0, 0.0], [40.0, 90.0], [0.0, 0.0]], false);
        assert_eq!(counts(&lights, SurfaceSymmetry::Axes(0.0)), [(1, 15), (1, 15), (1, 9)]);
    }

    #[test]
    fn images_keep_the_angles_to_the_light() {
        // 2 sin(angle/2) of unit vectors; turned and mirrored pairs differ by rounding, a few ulp of 2.
        for symmetry in [SurfaceSymmetry::Isotropic, SurfaceSymmetry::Axes(0.3)] {
            for stop_deg in [[50.0, 20.0], [50.0, 200.0], [50.0, 110.0], [50.0, -70.0], [0.0, 0.0]] {
                let grid = grid(&[stop_deg], false);
                let alike = &alike_incidences(&grid, symmetry)[0];
                for (region, &place) in grid.regions(0).iter().zip(&alike.stops[0].1) {
                    let before = (region.middle() - grid.wi(0)).length();
                    let after = (alike.regions[place].middle() - alike.wi).length();
                    assert!((before - after).abs() < 1e-8, "{symmetry:?} {stop_deg:?}: {before} {after}");
                }
            }
        }
    }
}
