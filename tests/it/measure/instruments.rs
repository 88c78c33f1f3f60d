//! Promise: apertures do to a value what the model says, two of them tell the value without any, and presets stand for
//! the arms of their instruments.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use gonio::campaign::{self, Parsed};
use gonio::instrument::klems::FULL;
use gonio::instrument::{GridKind, Region, grid_of};
use gonio::interchange::{self, Options};
use gonio::measure::Measured;
use gonio::sphere::direction_deg;
use gonio::stats;
use gonio::theory::{Masking, Microfacet, Ndf};
use gonio::validate::prediction::aperture::{Cones, bias, extrapolate, richardson, worst};
use gonio::validate::two_tables::ComparedTable;

use crate::support::measuring::{measured_one, measured_with};
use crate::support::program::{gonio, json, stderr, stdout};

/// D G2/(4 cos cos) of GGX, alpha 0.1, at 30 degrees in the mirror direction: 60-digit arithmetic.
const MIRROR_AT_30: f64 = 10.592_689_744_152_706;

/// Half-angles in degrees of the known figures.
const HALF_ANGLES: [f64; 5] = [4.0, 2.0, 1.0, 0.5, 0.25];

/// (alpha, bias in per cent at each half-angle, half a unit of the last digit): GGX, height-correlated, F = 1, 30 degrees,
/// parallel light; found beforehand with another program, which divides flux by (solid angle x cosine of the axis).
const KNOWN: [(f64, [f64; 5], [f64; 5]); 4] = [
    (0.5, [-0.45, -0.11, -0.028, -0.007, -0.002], [0.005, 0.005, 5e-4, 5e-4, 5e-4]),
    (0.1, [-12.0, -3.4, -0.87, -0.22, -0.055], [0.5, 0.05, 0.005, 0.005, 5e-4]),
    (0.05, [-36.0, -12.0, -3.4, -0.88, -0.22], [0.5, 0.5, 0.05, 0.005, 0.005]),
    (0.01, [-93.0, -78.0, -47.0, -18.0, -5.0], [0.5, 0.5, 0.5, 0.5, 0.5]),
];

/// A bias against flux/projected solid angle, pi sin^2 a cos, in per cent of flux/(2 pi (1 - cos a) cos): the ratio of the
/// two is (1 + cos a)/2.
fn as_known(bias: f64, half_angle_deg: f64) -> f64 {
    100.0 * ((1.0 + bias) * 0.5 * (1.0 + half_angle_deg.to_radians().cos()) - 1.0)
}

fn ggx_bias(alpha: f64, light_deg: f64, sensor_deg: f64) -> f64 {
    let arms = [direction_deg(30.0, 0.0), direction_deg(30.0, 180.0)];
    let cones = Cones { light: light_deg.to_radians(), sensor: sensor_deg.to_radians() };
    bias(&Microfacet::isotropic(Ndf::Ggx, alpha), Masking::HeightCorrelated, arms, cones)
}

#[test]
fn the_aperture_bias_of_ggx_is_the_known_one() {
    for (alpha, known, half_unit) in KNOWN {
        for (k, half_angle) in HALF_ANGLES.into_iter().enumerate() {
            let found = as_known(ggx_bias(alpha, 0.0, half_angle), half_angle);
            // The figures' rounding; the cubature is right to 1e-4 per cent.
            assert!((found - known[k]).abs() <= half_unit[k] + 1e-4, "{alpha} {half_angle}: {found}");
        }
    }
    // Extrapolated from 4 and 2, 2 and 1, 1 and 0.5 degrees.
    for (pair, left, half_unit) in [(0, -0.42, 0.005), (1, -0.03, 0.005), (2, -0.002, 5e-4)] {
        let of = |k: usize| as_known(ggx_bias(0.1, 0.0, HALF_ANGLES[k]), HALF_ANGLES[k]);
        let found = richardson(of(pair + 1), of(pair));
        assert!((found - left).abs() <= half_unit + 1e-4, "{pair}: {found}");
    }
    // At equal angles reciprocity makes both arms alike: the cubature's 1e-6 beside a bias of 1e-3.
    let (light, sensor) = (ggx_bias(0.3, 1.0, 0.0), ggx_bias(0.3, 0.0, 1.0));
    assert!((light / sensor - 1.0).abs() < 2e-3, "{light} {sensor}");
}

/// The instrument's own surface, on which the formula is exact, seen by an arm in the mirror direction.
fn smith(aperture_deg: f64, light: &str) -> String {
    format!(
        "name = \"smith\"\n[surface]\nrealisations = 16\n[surface.smith]\nalpha = 0.1\n[light]\ntheta_i_deg = [30]\n\
         {light}\n[sensor.arm]\ntheta_r_deg = [30]\nphi_r_deg = [180]\naperture_deg = {aperture_deg}\n[stop]\n\
         samples = 262_144\n"
    )
}

/// Measured at the first three half-angles, once.
static MEASURED: LazyLock<[Measured; 3]> =
    LazyLock::new(|| std::array::from_fn(|k| measured_one(&smith(HALF_ANGLES[k], ""))));

/// (value, standard error) of the only bin.
fn value(measured: &Measured) -> (f64, f64) {
    let colour = &measured.table.colours[0];
    (f64::from(colour.total[0]), f64::from(colour.stderr[0]))
}

#[test]
fn measured_apertures_lower_a_lobe_as_much_as_is_known() {
    let limit = stats::student_limit(1e-3, 15);
    for (k, (half_angle, measured)) in HALF_ANGLES.into_iter().zip(&*MEASURED).enumerate() {
        let (value, se) = value(measured);
        let (found, se) = (as_known(value / MIRROR_AT_30 - 1.0, half_angle), 100.0 * se / MIRROR_AT_30);
        println!("{half_angle} degrees: {found:.2} +- {se:.2} %");
        // Student's limit of one in a thousand, and the figure's rounding; the errors are small enough to mean something.
        let (_, known, half_unit) = KNOWN[1];
        assert!((found - known[k]).abs() < limit * se + half_unit[k], "{half_angle}: {found} +- {se}");
        assert!(se < 0.9, "{se}");
    }
}

fn side(measured: &Measured) -> ComparedTable<'_> {
    ComparedTable {
        table: &measured.table,
        campaign: Some(&measured.campaign),
        parts: Some(&measured.realisations),
        errors_are_bounds: false,
    }
}

#[test]
fn two_apertures_give_the_value_without_one() {
    let [wide, narrow, _] = &*MEASURED;
    let rows = extrapolate(side(wide), side(narrow)).expect("half the aperture");
    let (row, (_, se_wide), (_, se_narrow)) = (rows[0], value(wide), value(narrow));
    assert_eq!((rows.len(), row.theta_r_deg, row.phi_r_deg), (1, 30.0, 180.0));
    let se = row.extrapolated_se.expect("sixteen realisations");
    // A statistical surface has no patches to pair: sqrt(16 se^2 + se^2)/3, in f32 tables.
    let expected = (16.0 * se_narrow * se_narrow + se_wide * se_wide).sqrt() / 3.0;
    assert!((se / expected - 1.0).abs() < 1e-6, "{se} {expected}");
    let off = row.extrapolated - MIRROR_AT_30;
    // What Richardson leaves, 0.42 per cent, and Student's limit of one in a thousand; the narrow table alone is off by
    // 3.4 per cent, more than that.
    let allowed = stats::student_limit(1e-3, 15) * se + 0.0042 * MIRROR_AT_30;
    assert!(off.abs() < allowed && allowed < 0.03 * MIRROR_AT_30, "{row:?}");
    let refused = |wide: &Measured, narrow: &Measured| {
        extrapolate(side(wide), side(narrow)).expect_err("must be refused")
    };
    assert!(refused(narrow, wide).contains("must be half of the other table's 2"));
    let lit = quickly_measured(&smith(2.0, "aperture_deg = 1"));
    assert!(refused(wide, &lit).contains("light.aperture_deg = 1: must be half of the other table's 0"));
}

fn parsed(text: &str) -> Parsed {
    campaign::parse(text, "c.toml", Path::new("")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

#[test]
fn check_says_what_the_apertures_do() {
    let text = smith(4.0, "");
    let found = worst(&parsed(&text).campaign).expect("an aperture");
    assert_eq!((found.theta_i_deg, found.incidences), (30.0, 1));
    assert!((found.bias - ggx_bias(0.1, 0.0, 4.0)).abs() < 1e-12);
    assert!((found.bias_of_half - ggx_bias(0.1, 0.0, 2.0)).abs() < 1e-12);
    let mirror = text.replace("[surface.smith]\nalpha = 0.1", "[surface.mirror]");
    assert_eq!(worst(&parsed(&mirror.replace("realisations = 16", "")).campaign), None);
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("c.toml"), &text).expect("written");
    let run = |words: &[&str]| gonio(folder.path(), words);
    let said = run(&["check", "c.toml"]);
    let text = stdout(&said);
    assert!(
        text.contains("apertures")
            && text.contains("-12.")
            && text.contains(" % on the value at theta_i 30, theta_r 30"),
        "{text}"
    );
    let warned = stderr(&said);
    assert!(warned.contains("exceeds a quarter of alpha (1.432 degrees)"), "{warned}");
    let json = json(&run(&["check", "c.toml", "--json"]));
    assert!(json["aperture_bias"]["bias"].as_f64().is_some_and(|bias| bias < -0.12), "{json}");
}

/// A campaign on a statistical surface with a preset.
fn with_preset(keys: &str, samples: u32) -> String {
    format!(
        "name = \"preset\"\n[surface]\nrealisations = 2\n[surface.smith]\nalpha = 0.5\n[preset]\n{keys}\n[stop]\n\
         samples = {samples}\n"
    )
}

#[test]
fn presets_stand_for_the_geometry_of_their_instruments() {
    let geometry = |keys: &str| {
        let parsed = parsed(&with_preset(keys, 1));
        let grid = grid_of(&parsed.campaign);
        // What the preset stands for is written out, and reads as the same campaign.
        let written = campaign::to_toml(&parsed.campaign);
        let again = campaign::parse(&written, "c.toml", Path::new("")).expect("resolved");
        assert_eq!((&again.campaign, again.preset), (&parsed.campaign, None), "{written}");
        let preset = parsed.preset.expect("named");
        assert!(preset.source.chars().any(|c| c.is_ascii_digit()) || preset.name == "in_plane");
        (grid.incidences(), grid.bins(), grid)
    };
    let (incidences, bins, utia) = geometry("name = \"utia\"");
    assert_eq!((incidences, bins, utia.phi_r_relative), (288, 288, false));
    assert_eq!((utia.incidence_deg(287), utia.aperture_deg), ((75.0, 352.5), Some(2.0)));
    let (incidences, bins, klems) = geometry("name = \"klems_full\"");
    assert_eq!((incidences, bins, klems.kind), (145, 145, GridKind::Patches));
    let sum: f64 = klems.regions(0).iter().map(Region::projected_solid_angle).sum();
    // 145 terms of size below 0.1, each right to a few ulp.
    assert!((sum - std::f64::consts::PI).abs() < 145.0 * f64::EPSILON, "{sum}");
    let middles: Vec<f64> = parsed(&with_preset("name = \"klems_full\"", 1)).campaign.light.theta_i_deg;
    assert!(FULL.iter().zip(&middles).skip(1).all(|(ring, middle)| 0.5 * (ring.0 + ring.1) == *middle));
    let (incidences, bins, onera) = geometry("name = \"onera\"");
    assert_eq!((incidences, bins, onera.phi_r_relative), (5, 7 * 13, true));
    assert_eq!((onera.theta_r_deg[6], onera.phi_r_deg[12]), (60.0, 180.0));
    let (incidences, bins, rosi) =
        geometry("name = \"rosi\"\ntheta_i_deg = [45]\ntheta_r_deg = [-45, 0]\nphi_r_deg = [90, 180]");
    assert_eq!((incidences, bins, rosi.aperture_deg), (1, 4, Some(0.5)));
    let (incidences, bins, _) = geometry("name = \"in_plane\"");
    assert_eq!((incidences, bins), (6, 171));
    let (incidences, bins, rgl) = geometry("name = \"rgl\"\ntheta_i_count = 5");
    assert_eq!((incidences, bins, rgl.theta_i_deg), (5, 46 * 120, vec![0.0, 5.0, 20.0, 45.0, 80.0]));
    let (incidences, bins, merl) = geometry("name = \"merl\"");
    assert_eq!((incidences, bins, merl.kind), (18, 46 * 180, GridKind::Hemisphere));
}

/// With 512 starts for each incidence: enough for a table that is not empty.
fn quickly_measured(text: &str) -> Measured {
    measured_with(text, |plan| {
        (plan.samples, plan.block_starts) = (512, 512);
    })
}

#[test]
fn a_klems_table_is_written_as_its_own_patches() {
    let patches = "[surface]\nrealisations = 2\ncells = 64\n[surface.ggx]";
    let text = with_preset("name = \"klems_full\"", 1)
        .replace("[surface]\nrealisations = 2\n[surface.smith]", patches);
    let measured = quickly_measured(&text);
    let hits: u64 = measured.table.hits.iter().map(|&hits| u64::from(hits)).sum();
    assert!(hits > 145 * 2 * 512 / 2, "{hits}");
    let xml =
        interchange::radiance::klems::write(&measured.table, &Options::default()).expect("its own basis").0;
    let read = interchange::radiance::klems::read(xml.as_bytes()).expect("a matrix");
    assert_eq!(read.grid, measured.table.grid);
    for (found, expected) in read.colours[0].total.iter().zip(&measured.table.colours[0].total) {
        // Eight digits are written.
        assert!((found - expected).abs() <= 1e-6 * expected, "{found} {expected}");
    }
}

#[test]
fn a_utia_table_is_written_as_it_was_measured() {
    let measured = quickly_measured(&with_preset("name = \"utia\"\naperture_deg = 5", 1));
    let bytes = interchange::utia::write(&measured.table).expect("its own directions");
    let read = interchange::utia::read(&bytes).expect("288 x 288 directions");
    assert_eq!(read.colours[1].total, measured.table.colours[0].total);
}
