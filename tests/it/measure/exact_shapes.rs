//! Promise: where the answer is known exactly (the mirror, the V-groove) the tool finds it, and nothing else.

use glam::DVec3;
use gonio::instrument::{Grid, Sensor};
use gonio::measure::Measured;
use gonio::rng;
use gonio::sphere;
use gonio::theory::v_cavity::{GrooveLobe, v_groove_lobes};

use crate::support::measuring::{hits_of, measured_one, test_rng};

const SAMPLES: f64 = 65_536.0;

/// 8 x 5 incidences at random angles, increasing.
fn angles(seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut rng = test_rng(seed);
    let mut sorted = |count: usize, scale: f64| {
        let mut values: Vec<f64> = (0..count).map(|_| scale * rng::uniform(&mut rng)).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    (sorted(8, 88.0), sorted(5, 360.0))
}

fn shape(kind: &str, rotation_deg: f64, seed: u64, optics: &str) -> Measured {
    let (theta_i, phi_i) = angles(seed);
    measured_one(&format!(
        "name = \"shape\"\n[surface]\nrotation_deg = {rotation_deg:?}\n[surface.{kind}\n\
         [light]\ntheta_i_deg = {theta_i:?}\nazimuth = \"absolute\"\nphi_i_deg = {phi_i:?}\n\
         [sensor.hemisphere]\n{optics}\n[stop]\nsamples = {SAMPLES}\n"
    ))
}

/// The bin of a direction, which must not lie so near an edge that rounding decides.
fn bin_of(sensor: &Sensor, grid: &Grid, wo: DVec3) -> usize {
    let (theta, phi) = (sphere::theta(wo).to_degrees(), sphere::phi(wo).to_degrees());
    let apart = |edges: &[f64], x: f64| edges.iter().all(|edge| (x - edge).abs() > 1e-9);
    assert!(apart(&grid.theta_r_edges_deg, theta) && apart(&grid.phi_r_edges_deg, phi), "{theta} {phi}");
    let mut found = Vec::new();
    sensor.each_bin(wo, |bin| found.push(bin));
    assert_eq!(found.len(), 1);
    found[0]
}

/// Flux in each bin of an incidence from the table's colour.
fn flux(measured: &Measured, incidence: usize, colour: usize) -> Vec<f64> {
    let grid = &measured.table.grid;
    let values =
        &measured.table.colours[colour].single[incidence * grid.bins()..(incidence + 1) * grid.bins()];
    let bins = grid.regions(incidence);
    values.iter().zip(&bins).map(|(&f, bin)| f64::from(f) * bin.projected_solid_angle()).collect()
}

/// Checks every incidence of a groove table; returns the largest deviation in binomial standard errors.
fn check_groove(measured: &Measured, slope: f64, rotation_deg: f64) -> f64 {
    let grid = &measured.table.grid;
    let sensor = Sensor::new(grid);
    let mut largest = 0.0f64;
    for incidence in 0..grid.incidences() {
        let wi = grid.wi(incidence);
        let lobes = v_groove_lobes(slope, rotation_deg.to_radians(), wi);
        // Flux that the starts stand for, lit or not: the area turned to the light over the area seen.
        let across = slope * sphere::turned(wi, (-rotation_deg).to_radians().sin_cos()).x.abs();
        let started = (0.5 * ((wi.z + across) + (wi.z - across).max(0.0))) / wi.z;
        let mut expected = vec![0.0; grid.bins()];
        for lobe in lobes.iter().filter(|lobe| lobe.flux > 0.0) {
            expected[bin_of(&sensor, grid, lobe.wo)] += lobe.flux;
        }
        for (bin, (&found, &expected)) in flux(measured, incidence, 0).iter().zip(&expected).enumerate() {
            if expected == 0.0 {
                assert_eq!(
                    (found, hits_of(measured, incidence)[bin]),
                    (0.0, 0),
                    "incidence {incidence}, bin {bin}"
                );
                continue;
            }
            let share = (expected / started).min(1.0);
            let sigma = started * (share * (1.0 - share) / SAMPLES).sqrt();
            // Rounding to f32 and back.
            let rounding = 2e-7 * expected;
            let off = (found - expected).abs();
            assert!(
                off <= 4.0 * sigma + rounding,
                "slope {slope}, incidence {incidence}: {found} {expected} +- {sigma}"
            );
            if share < 1.0 - 1e-9 {
                largest = largest.max(off / sigma);
            }
        }
    }
    largest
}

/// 320 lobes at 4 sigma: by chance 0.02 (less, since starts are stratified). A lobe that is off by 2 % of the
/// incident flux is found.
#[test]
fn the_groove_sends_each_sides_light_into_the_bin_of_its_mirror_direction() {
    for (seed, slope, rotation_deg) in [(1, 0.2, 0.0), (2, 0.5, 33.25), (3, 1.0, 90.0), (4, 2.0, 211.5)] {
        let measured = shape(&format!("v_groove]\nslope = {slope}"), rotation_deg, seed, "");
        let largest = check_groove(&measured, slope, rotation_deg);
        println!("slope {slope}, turned by {rotation_deg}: largest deviation {largest:.2} sigma");
    }
}

#[test]
fn the_mirror_sends_everything_into_one_bin() {
    let measured = shape("mirror]", 17.0, 5, "");
    let grid = &measured.table.grid;
    let sensor = Sensor::new(grid);
    for incidence in 0..grid.incidences() {
        let wi = grid.wi(incidence);
        let specular = bin_of(&sensor, grid, DVec3::new(-wi.x, -wi.y, wi.z));
        for (bin, found) in flux(&measured, incidence, 0).into_iter().enumerate() {
            let expected = if bin == specular { 1.0 } else { 0.0 };
            // All starts, so no statistics: rounding to f32 and back.
            assert!((found - expected).abs() <= 2e-7 * expected, "incidence {incidence}, bin {bin}: {found}");
        }
        assert_eq!(hits_of(&measured, incidence)[specular], 65_536);
    }
}

/// Light across the grooves: at 20 degrees it sees every side; at 75 the far ones are turned away and the near ones are
/// seen by 2 (n.m)(n.l)/(m.l) = 2/(1 + s tan theta) (Torrance and Sparrow 1967).
#[test]
fn the_light_sees_a_groove_as_torrance_and_sparrow_say() {
    let slope = 0.6f64;
    let measured = measured_one(&format!(
        "name = \"seen\"\n[surface]\n[surface.v_groove]\nslope = {slope}\n\
         [light]\ntheta_i_deg = [20, 75]\nazimuth = \"absolute\"\nphi_i_deg = [0, 180]\n\
         [sensor.hemisphere]\n[stop]\nsamples = {SAMPLES}\n"
    ));
    for (incidence, result) in measured.incidences.iter().enumerate() {
        let tan = measured.table.grid.incidence_deg(incidence).0.to_radians().tan();
        let classes = result.seen_by_slope.as_ref().expect("heights are started on everywhere");
        let starts: u64 = classes.iter().map(|class| class.starts).sum();
        assert_eq!(starts, result.samples * measured.realisations.parts.len() as u64);
        for far in [false, true] {
            let side = classes
                .iter()
                .filter(|class| class.slope[usize::from(!far)].is_some_and(|edge| (edge > 0.0) == far));
            let (starts, seen) = side.fold((0.0, 0.0), |(starts, seen), class| {
                let more = class.starts as f64;
                (starts + more, seen + more * class.share.unwrap_or(0.0))
            });
            if far && slope * tan > 1.0 {
                assert_eq!(starts, 0.0, "incidence {incidence}");
                continue;
            }
            let expected = if slope * tan > 1.0 { 2.0 / (1.0 + slope * tan) } else { 1.0 };
            let sigma = (expected * (1.0 - expected) / starts).sqrt();
            // 6 sides at 4 binomial standard errors; where all is seen, exactly that, up to the means' rounding.
            let share = seen / starts;
            assert!(
                (share - expected).abs() <= 4.0 * sigma + 1e-12,
                "incidence {incidence}: {share} {expected} +- {sigma}"
            );
        }
    }
}

/// Sides at 45 degrees: light from the zenith crosses the groove level and goes back, all of it at order 2.
#[test]
fn the_right_angled_groove_sends_light_from_the_zenith_back_at_order_two() {
    for rotation_deg in [0.0, 90.0, 33.25] {
        let measured = measured_one(&format!(
            "name = \"corner\"\n[surface]\nrotation_deg = {rotation_deg:?}\n[surface.v_groove]\nslope = 1\n\
             [light]\ntheta_i_deg = [0]\nazimuth = \"absolute\"\nphi_i_deg = [0]\n\
             [sensor.hemisphere]\n[trace]\nbounces = 4\n[stop]\nsamples = {SAMPLES}\n"
        ));
        let incidence = &measured.incidences[0];
        // A side's start within rounding (1e-16 of a cell) of the ridge may pass it level.
        assert_eq!(
            (incidence.orders.as_slice(), incidence.cut, incidence.hidden),
            ([0, 65_536, 0, 0].as_slice(), 0, 0)
        );
        let around_the_zenith: u32 = hits_of(&measured, 0)[..36].iter().sum();
        assert_eq!(around_the_zenith, 65_536);
    }
}

/// The lobes of an incidence, where each has a bin of its own.
fn lobes_apart(
    grid: &Grid,
    sensor: &Sensor,
    incidence: usize,
    slope: f64,
    rotation_deg: f64,
) -> Vec<(usize, DVec3)> {
    let lobes = v_groove_lobes(slope, rotation_deg.to_radians(), grid.wi(incidence));
    let seen: Vec<&GrooveLobe> = lobes.iter().filter(|lobe| lobe.flux > 1e-3).collect();
    let bins: Vec<(usize, DVec3)> =
        seen.iter().map(|lobe| (bin_of(sensor, grid, lobe.wo), lobe.wo)).collect();
    if bins.len() == 2 && bins[0].0 == bins[1].0 { Vec::new() } else { bins }
}

#[test]
fn schlick_weighs_each_side_by_its_own_angle() {
    let f0 = [0.04, 0.5, 1.0];
    let kind = "v_groove]\nslope = 0.5";
    let white = shape(kind, 33.25, 7, "");
    let material = shape(kind, 33.25, 7, &format!("[optics]\nf0 = {f0:?}"));
    let grid = &white.table.grid;
    let sensor = Sensor::new(grid);
    let mut compared = 0;
    for incidence in 0..grid.incidences() {
        for (bin, wo) in lobes_apart(grid, &sensor, incidence, 0.5, 33.25) {
            let wi = grid.wi(incidence);
            // Independent of the program's form: c from the half vector by acos and cos.
            let c = (0.5 * wi.dot(wo).clamp(-1.0, 1.0).acos()).cos();
            for (colour, f0) in f0.into_iter().enumerate() {
                let expected = f0 + (1.0 - f0) * (1.0 - c).powi(5);
                // The same hits, so no statistics: the ratio of two values rounded to f32.
                let found = flux(&material, incidence, colour)[bin] / flux(&white, incidence, 0)[bin];
                assert!(
                    (found / expected - 1.0).abs() < 4e-7,
                    "incidence {incidence}, f0 {f0}: {found} {expected}"
                );
                compared += 1;
            }
        }
    }
    assert!(compared >= 3 * 40, "{compared} values compared");
}
