//! Promise: reflectance and scatter have the closed forms; errors are those of the realisations; an angle between two
//! incidences is interpolated and said to be; what bins do not resolve is not invented.

use std::f64::consts::PI;

use glam::DVec3;
use gonio::appearance::report::AppearanceAtAzimuth;
use gonio::appearance::{Quantity, appearance};
use gonio::instrument::{Grid, GridKind};
use gonio::interchange::{Brdf, Colour};
use gonio::table::{BrdfTable, RealisationPart, Realisations};

use crate::support::analytic::{Ggx, hemisphere, points, table};

const RHO: f64 = 0.6;

/// Even, times a factor for every polar angle of the light.
struct Even(fn(f64) -> f64);

impl Brdf for Even {
    fn colours(&self) -> usize {
        1
    }

    fn brdf(&self, wi: DVec3, _wo: DVec3) -> Colour {
        [(self.0)(gonio::sphere::theta(wi).to_degrees()) / PI; 3]
    }
}

fn of(table: &BrdfTable, parts: Option<&Realisations>) -> Vec<AppearanceAtAzimuth> {
    appearance(table, parts).unwrap_or_else(|why| panic!("{why}")).azimuths
}

fn value(quantity: &Quantity) -> f64 {
    quantity.value.unwrap_or_else(|| panic!("{quantity:?}"))
}

fn factor<'a>(at: &'a AppearanceAtAzimuth, geometry: &str, theta_i_deg: f64) -> &'a Quantity {
    let is_it = |r: &&gonio::appearance::reflectance::Reflected| {
        r.geometry == geometry && r.theta_i_deg == theta_i_deg
    };
    &at.reflectance.iter().find(is_it).unwrap_or_else(|| panic!("{geometry}")).factor
}

fn fine(theta_i_deg: Vec<f64>) -> Grid {
    hemisphere(theta_i_deg, None, 90, 360)
}

#[test]
fn a_lambert_table_has_the_closed_forms() {
    let at = of(&table(&Even(|_| RHO), &fine(vec![0.0, 15.0, 45.0, 60.0])), None).remove(0);
    // Values are f32, sums of 32,400 of them: 6e-8 each, and all alike.
    let same = |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-6, "{found} {wanted}");
    for scatter in &at.scatter {
        same(value(&scatter.reflectance), RHO);
        // A cone of half-angle a about the mirror direction has the projected solid angle pi sin^2 a cos theta.
        let cone = 2f64.to_radians().sin().powi(2) * scatter.theta_i_deg.to_radians().cos();
        // The cone's edge runs through bins in steps of a fortieth of its half-angle: 1e-2 of 1.2e-3 at most.
        assert!((value(&scatter.tis) - (1.0 - cone)).abs() < 1.3e-5, "{scatter:?}");
    }
    for (geometry, theta) in
        [("45:0", 45.0), ("0:45", 0.0), ("8:d", 8.0), ("45:as15", 45.0), ("45:as110", 45.0)]
    {
        same(value(factor(&at, geometry, theta)), RHO);
    }
    for theta in [0.0, 15.0, 45.0, 60.0] {
        same(value(factor(&at, "mirror", theta)), RHO);
    }
    // ARS is rho/pi times the mean cosine of the bin by solid angle, (c1 + c2)/2 between two polar angles; in the plane the rows
    // are passed once on either side.
    let angles = &at.ars[2].angles;
    assert_eq!(angles.len(), 180);
    for angle in angles {
        let row = angle.theta_r_deg.abs();
        let mean = 0.5 * ((row - 0.5).to_radians().cos() + (row + 0.5).to_radians().cos());
        same(angle.ars, RHO / PI * mean);
        same(angle.brdf, RHO / PI);
    }
    assert!(angles.windows(2).all(|pair| pair[0].theta_r_deg < pair[1].theta_r_deg));
}

#[test]
fn between_incidences_readings_are_interpolated_and_said_to_be() {
    // rho = 0.2 + theta/100 degrees: linear in the angle, so that its interpolation is it.
    let grid = fine(vec![0.0, 15.0, 30.0, 40.0, 50.0, 60.0, 75.0]);
    let at = of(&table(&Even(|theta| 0.2 + 0.01 * theta), &grid), None).remove(0);
    let eight = factor(&at, "8:d", 8.0);
    assert!((value(eight) - 0.28).abs() < 1e-6, "{eight:?}");
    assert_eq!(eight.note.as_deref(), Some("between theta_i 0 and 15"));
    let at_45 = factor(&at, "45:0", 45.0);
    assert!((value(at_45) - 0.65).abs() < 1e-6, "{at_45:?}");
    assert_eq!(at_45.note.as_deref(), Some("between theta_i 40 and 50"));
    assert_eq!((eight.se, at_45.se), (None, None));
    assert_eq!(factor(&at, "0:45", 0.0).note, None);
    // 85 degrees lie beyond all incidences, and 15 degrees are the widest gap.
    let gloss = &at.gloss[2].gloss;
    assert_eq!(
        (gloss.value, gloss.note.as_deref()),
        (None, Some("no incidence at theta_i 85, nor one on either side"))
    );
    let at = of(&table(&Even(|_| RHO), &fine(vec![0.0, 45.0])), None).remove(0);
    let eight = factor(&at, "8:d", 8.0);
    assert_eq!((eight.value, eight.note.as_deref()), (None, Some("no incidence between theta_i 0 and 45")));
}

#[test]
fn what_bins_do_not_resolve_is_not_invented() {
    let rough = |alpha: f64, rows: usize, columns: usize| {
        of(&table(&Ggx::new(alpha, alpha), &hemisphere(vec![20.0, 30.0, 60.0], None, rows, columns)), None)
            .remove(0)
    };
    // Bins of 5 x 10 degrees, at 60 degrees 8.7 to 9.1 across.
    let at = rough(0.2, 18, 36);
    let note = at.gloss[0].gloss.note.as_deref().unwrap_or_default();
    assert_eq!(note, "bins of 5.00 x 4.23 degrees (theta_r x phi_r) there, 0.90 x 1.80 at most would do");
    assert!(at.gloss.iter().all(|gloss| gloss.gloss.value.is_none()), "{:?}", at.gloss);
    assert!([&at.haze.reflection_haze, &at.haze.haze_2, &at.haze.doi].iter().all(|q| q.value.is_none()));
    assert!(at.scatter.iter().all(|s| s.tis.value.is_none() && s.reflectance.value.is_some()));
    // Bins of 2 degrees resolve the receptor at 60 and the lobe of alpha 0.2, but no lobe of 0.003.
    let at = rough(0.2, 45, 180);
    assert!(at.gloss[1].gloss.value.is_some(), "{:?}", at.gloss[1]);
    let narrow = &rough(0.003, 45, 180).gloss[1].gloss;
    assert!(
        narrow.value.is_none() && narrow.note.as_deref().is_some_and(|n| n.contains("too narrow")),
        "{narrow:?}"
    );
}

#[test]
fn errors_are_those_of_the_realisations() {
    let made = table(&Ggx::new(0.3, 0.3), &hemisphere(vec![8.0, 30.0, 45.0, 60.0], None, 45, 180));
    // Realisations are the table times these factors, whose mean is 1: their standard error is sqrt(sum (x - 1)^2/(n (n - 1))).
    let factors = [0.9f32, 1.05, 0.98, 1.07];
    let scaled = |factor: f32| {
        let total = vec![made.colours[0].total.iter().map(|value| factor * value).collect::<Vec<f32>>()];
        RealisationPart { single: total.clone(), total, schlick: None }
    };
    let parts = Realisations { parts: factors.iter().map(|&factor| scaled(factor)).collect() };
    let squares: f64 = factors.iter().map(|x| (f64::from(*x) - 1.0).powi(2)).sum();
    let relative = (squares / 12.0).sqrt();
    let at = of(&made, Some(&parts)).remove(0);
    let linear =
        [&at.gloss[1].gloss, &at.scatter[1].reflectance, factor(&at, "45:0", 45.0), factor(&at, "8:d", 8.0)];
    for quantity in linear {
        let found = quantity.se.expect("realisations") / value(quantity);
        // f32 factors and values: 1e-7 over an error of 4 %.
        assert!((found / relative - 1.0).abs() < 1e-4, "{found} {relative}");
    }
    // Without realisations nothing is known.
    assert!(of(&made, None)[0].gloss[1].gloss.se.is_none());
}

#[test]
fn ratios_of_readings_that_vary_together_do_not_vary() {
    let made = table(&Even(|_| RHO), &fine(vec![30.0]));
    let scaled = |factor: f32| {
        let total = vec![made.colours[0].total.iter().map(|value| factor * value).collect::<Vec<f32>>()];
        RealisationPart { single: total.clone(), total, schlick: None }
    };
    let parts = Realisations { parts: [0.5, 1.5, 1.0].map(scaled).into() };
    let tis = &of(&made, Some(&parts))[0].scatter[0].tis;
    // f32 roundings of values, 6e-8, where the factors differ by half.
    assert!(tis.se.expect("realisations") < 1e-7, "{tis:?}");
}

#[test]
fn azimuths_of_the_light_are_told_apart() {
    // Light along and across the brushing of an absolute table: each is what the other is after a quarter turn.
    let grid = |phi_i: Vec<f64>| hemisphere(vec![0.0, 60.0], Some(phi_i), 45, 180);
    let along = of(&table(&Ggx::new(0.1, 0.4), &grid(vec![0.0, 90.0])), None);
    let turned = of(&table(&Ggx::new(0.4, 0.1), &grid(vec![0.0, 90.0])), None);
    assert_eq!(along.iter().map(|at| at.phi_i_deg).collect::<Vec<_>>(), [0.0, 90.0]);
    let gloss = |at: &AppearanceAtAzimuth| value(&at.gloss[1].gloss);
    assert!(
        (gloss(&along[0]) / gloss(&along[1]) - 1.0).abs() > 0.2,
        "{} {}",
        gloss(&along[0]),
        gloss(&along[1])
    );
    // f32 values, and angles that differ by roundings.
    assert!((gloss(&along[0]) / gloss(&turned[1]) - 1.0).abs() < 1e-5);
    assert!((gloss(&along[1]) / gloss(&turned[0]) - 1.0).abs() < 1e-5);
}

#[test]
fn single_directions_say_colours_and_no_gloss() {
    let grid = points(vec![45.0], vec![0.0], &[0.0, 20.0, 30.0], &[0.0, 180.0]);
    assert_eq!(grid.kind, GridKind::Points);
    let at = of(&table(&Even(|_| RHO), &grid), None).remove(0);
    for geometry in ["45:0", "45:as15", "45:as25"] {
        assert!((value(factor(&at, geometry, 45.0)) / RHO - 1.0).abs() < 1e-6, "{geometry}");
    }
    assert_eq!(factor(&at, "45:as110", 45.0).note.as_deref(), Some("the sensor has no position there"));
    assert!(at.gloss.iter().all(|gloss| gloss.gloss.value.is_none()));
    assert_eq!(
        at.scatter[0].reflectance.note.as_deref(),
        Some("the sensor does not see the whole hemisphere")
    );
}

#[test]
fn bins_that_were_not_measured_are_no_darkness() {
    let mut made = table(&Even(|_| RHO), &fine(vec![45.0]));
    made.set_gap(3);
    let at = of(&made, None).remove(0);
    assert_eq!(factor(&at, "45:0", 45.0).note.as_deref(), Some("bins there were not measured"));
    assert!(at.scatter[0].reflectance.value.is_none());
    assert!((value(factor(&at, "45:as15", 45.0)) / RHO - 1.0).abs() < 1e-6);
}

#[test]
fn a_part_of_the_hemisphere_is_not_all_of_it() {
    let mut grid = fine(vec![45.0]);
    grid.theta_r_edges_deg.truncate(81);
    let at = of(&table(&Even(|_| RHO), &grid), None).remove(0);
    let why = Some("the sensor does not see the whole hemisphere");
    for quantity in [&at.scatter[0].reflectance, factor(&at, "45:0", 45.0), factor(&at, "mirror", 45.0)] {
        assert_eq!((quantity.value, quantity.note.as_deref()), (None, why));
    }
}
