//! Bins that a surface's symmetry makes alike under one light: what theory says of one holds for its images.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::grid::Grid;
use super::region::Region;
use crate::sphere;

/// What a surface's law does not change under.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfaceSymmetry {
    /// Turns, and mirror images.
    Isotropic,
    /// Mirror images about two axes, the first at this azimuth, radians.
    Axes(f64),
}

/// The bins of an incidence, one of those that are each other's images.
pub struct AlikeBins {
    /// These, as they are.
    pub regions: Vec<Region>,
    /// For each bin of the incidence the place of its image in `regions`.
    pub places: Vec<usize>,
}

/// Angles that differ by less are the same, radians.
const SAME: f64 = 1e-9;

impl AlikeBins {
    /// Of the bins at an incidence of a grid.
    // Tested by `alike_bins_are_found_once`, `alike_bins_have_the_means_of_each_by_itself` (tests/it/validate/bin_means.rs).
    pub fn of(grid: &Grid, incidence: usize, symmetry: SurfaceSymmetry) -> Self {
        let wi = grid.wi(incidence);
        let images = Images::of([sphere::theta(wi), sphere::phi(wi)], symmetry);
        let (mut known, mut regions) = (HashMap::new(), Vec::new());
        let place = |region: Region| {
            *known.entry(images.key(&region)).or_insert_with(|| {
                regions.push(region);
                regions.len() - 1
            })
        };
        let places = grid.regions(incidence).into_iter().map(place).collect();
        AlikeBins { regions, places }
    }
}

/// Which bins are images of each other, by the azimuth of their middles.
enum Images {
    /// None.
    None,
    /// Those on either side of this azimuth: the light's.
    Mirrored(f64),
    /// Those in each quarter from this azimuth on, with light along the normal.
    Quarters(f64),
    /// All, with light along the normal of an isotropic surface.
    Turned,
}

impl Images {
    fn of([theta, phi]: [f64; 2], symmetry: SurfaceSymmetry) -> Self {
        let normal = theta < SAME;
        match symmetry {
            SurfaceSymmetry::Isotropic if normal => Images::Turned,
            SurfaceSymmetry::Isotropic => Images::Mirrored(phi),
            SurfaceSymmetry::Axes(axis) if normal => Images::Quarters(axis),
            SurfaceSymmetry::Axes(axis) => {
                let quarters = (phi - axis) / FRAC_PI_2;
                let is_on_axis = (quarters - quarters.round()).abs() * FRAC_PI_2 < SAME;
                if is_on_axis { Images::Mirrored(phi) } else { Images::None }
            }
        }
    }

    /// What tells a bin from those that are not its images: polar angles, azimuth and size, rounded.
    fn key(&self, region: &Region) -> [i64; 4] {
        let rounded = |angle: f64| (angle / SAME).round() as i64;
        match *region {
            Region::Rectangle { theta: [low, high], phi: [from, to] } => {
                [low, high, self.azimuth(0.5 * (from + to)), 0.5 * (to - from)].map(rounded)
            }
            Region::Cap { axis, half_angle } => {
                [sphere::theta(axis), -1.0, self.azimuth(sphere::phi(axis)), half_angle].map(rounded)
            }
        }
    }

    fn azimuth(&self, phi: f64) -> f64 {
        // From 0 to pi, the same on both sides.
        let beside = |origin: f64| (phi - origin - TAU * ((phi - origin) / TAU).round()).abs();
        match *self {
            Images::None => phi,
            Images::Mirrored(origin) => beside(origin),
            Images::Quarters(origin) => beside(origin).min(PI - beside(origin)),
            Images::Turned => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 x 8 bins.
    fn grid(incidence_deg: [f64; 2], phi_r_relative: bool) -> Grid {
        Grid {
            incidences_deg: vec![incidence_deg],
            theta_r_edges_deg: vec![0.0, 30.0, 60.0, 90.0],
            phi_r_edges_deg: (0..=8).map(|k| 45.0 * f64::from(k) - 22.5).collect(),
            phi_r_relative,
            ..Grid::default()
        }
    }

    #[test]
    fn alike_bins_are_found_once() {
        let count = |grid: &Grid, symmetry| AlikeBins::of(grid, 0, symmetry).regions.len();
        // Middles at 0, 45, .., 315 degrees from the light: 0, 45, 90, 135, 180 and their mirror images. Along the normal one.
        let from_light = |incidence_deg| count(&grid(incidence_deg, true), SurfaceSymmetry::Isotropic);
        assert_eq!([[0.0, 0.0], [40.0, 0.0], [40.0, 77.0]].map(from_light), [3, 15, 15]);
        // Off the axes all; on an axis half and those on it; along the normal a quarter and those on both.
        let absolute = |incidence_deg| count(&grid(incidence_deg, false), SurfaceSymmetry::Axes(0.0));
        let lights = [[40.0, 30.0], [40.0, 0.0], [40.0, 90.0], [40.0, 180.0], [0.0, 0.0]];
        assert_eq!(lights.map(absolute), [24, 15, 15, 15, 9]);
        // Bins at multiples of 45 degrees are no images of each other about an axis at 10.
        assert_eq!(count(&grid([40.0, 10.0], false), SurfaceSymmetry::Axes(10f64.to_radians())), 24);
    }

    #[test]
    fn images_keep_the_angle_to_the_light() {
        // Lengths of differences of unit vectors; mirrored pairs differ by rounding, a few ulp of 2.
        for symmetry in [SurfaceSymmetry::Isotropic, SurfaceSymmetry::Axes(45f64.to_radians())] {
            for incidence_deg in [[50.0, 45.0], [50.0, 135.0], [50.0, -45.0], [50.0, 30.0], [0.0, 0.0]] {
                let grid = grid(incidence_deg, false);
                let alike = AlikeBins::of(&grid, 0, symmetry);
                for (region, &place) in grid.regions(0).iter().zip(&alike.places) {
                    let off = |region: &Region| (region.middle() - grid.wi(0)).length();
                    let (own, image) = (off(region), off(&alike.regions[place]));
                    assert!((own - image).abs() < 1e-14, "{symmetry:?} {incidence_deg:?}: {own} {image}");
                }
            }
        }
    }
}
