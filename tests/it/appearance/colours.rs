//! Promise: X, Y, Z and L*a*b* are those of colour-science from the same spectra; R, G, B are linear sRGB; one channel says no
//! colour.

use std::f64::consts::PI;
use std::fs;

use gonio::appearance::reflectance::Colour1976;
use gonio::appearance::{Appearance, appearance};
use gonio::interchange::content::foreign_table::{foreign_table, spectral_table};
use gonio::table::{BrdfTable, RealisationPart, Realisations};

use crate::support::analytic::hemisphere;

/// An even table of these reflectances under light at 45 degrees.
fn even(reflectances: &[f64], wavelengths_nm: &[f64]) -> BrdfTable {
    let grid = hemisphere(vec![45.0], None, 18, 36);
    let total = reflectances.iter().map(|r| vec![(r / PI) as f32; 18 * 36]).collect();
    let made = if wavelengths_nm.is_empty() {
        foreign_table(grid, total)
    } else {
        spectral_table(grid, total, wavelengths_nm)
    };
    made.unwrap_or_else(|why| panic!("{why}"))
}

fn of(table: &BrdfTable, parts: Option<&Realisations>) -> Appearance {
    appearance(table, parts).unwrap_or_else(|why| panic!("{why}"))
}

/// The colours of 45:0.
fn colours(found: &Appearance) -> Vec<Colour1976> {
    let reflected = &found.azimuths[0].reflectance[0];
    assert_eq!((reflected.geometry.as_str(), reflected.factor.note.as_deref()), ("45:0", None));
    reflected.colours.clone()
}

/// The spectra of `tests/data/cie_tables.py`.
fn spectrum(name: &str, nm: f64) -> f64 {
    match name {
        "half" => 0.5,
        "bell" => 0.1 + 0.7 * (-((nm - 600.0) / 40.0).powi(2)).exp(),
        "step" => 0.05 + 0.9 / (1.0 + (-(nm - 500.0) / 8.0).exp()),
        _ => 2.5 + 1.5 * (nm / 60.0).sin(),
    }
}

fn steps(from: f64, to: f64, step: f64) -> Vec<f64> {
    (0..).map(|k| from + step * f64::from(k)).take_while(|nm| *nm <= to).collect()
}

/// Largest differences of X, Y, Z and of L*, a*, b* from the reference, of one spectrum sampled at `nm`.
fn off(name: &str, nm: &[f64], rows: &[Vec<String>]) -> [f64; 2] {
    let values: Vec<f64> = nm.iter().map(|&nm| spectrum(name, nm)).collect();
    let found = colours(&of(&even(&values, nm), None));
    assert_eq!(found.len(), 6, "two observers under three lights");
    let mut off = [0.0f64; 2];
    for row in rows.iter().filter(|row| row[0] == name) {
        let is_it = |colour: &&Colour1976| {
            let words = serde_json::to_value(colour).expect("plain data");
            words["observer"] == row[1].as_str() && words["illuminant"] == row[2].as_str()
        };
        let colour = found.iter().find(is_it).expect("the observer and the light");
        let wanted: Vec<f64> = row[3..].iter().map(|word| word.parse().expect("a number")).collect();
        for k in 0..3 {
            off[0] = off[0].max((colour.xyz[k] - wanted[k]).abs());
            off[1] = off[1].max((colour.lab[k] - wanted[3 + k]).abs());
        }
    }
    off
}

fn reference() -> Vec<Vec<String>> {
    let text = fs::read_to_string("tests/data/lab_values.csv").expect("the reference");
    text.lines().skip(1).map(|line| line.split(',').map(String::from).collect()).collect()
}

#[test]
fn lab_is_that_of_colour_science() {
    let rows = reference();
    assert_eq!(rows.len(), 4 * 6);
    for name in ["half", "bell", "step", "bright"] {
        let [xyz, lab] = off(name, &steps(380.0, 780.0, 5.0), &rows);
        // f32 values: 6e-8 of 500; L*a*b* magnifies by less than 10.
        assert!(xyz < 1e-4 && lab < 1e-3, "{name}: {xyz} {lab}");
    }
    // Wavelengths 10 nm apart: the cubic's error on a bell of 40 nm is below 3/128 (10/40)^4 12 = 1e-3 of its height, and changes
    // its sign; ends beyond 700 nm weigh 1e-3.
    let [_, lab] = off("bell", &steps(400.0, 700.0, 10.0), &rows);
    assert!(lab < 0.1, "{lab}");
}

#[test]
fn rgb_is_taken_as_linear_srgb() {
    let one = |rgb: [f64; 3]| colours(&of(&even(&rgb, &[]), None));
    let white = one([1.0; 3]);
    assert_eq!(white.len(), 1, "D65 and 2 degrees alone");
    // White is the white point; values are f32.
    let near = |found: f64, wanted: f64, by: f64| assert!((found - wanted).abs() < by, "{found} {wanted}");
    (0..3).for_each(|k| near(white[0].lab[k], [100.0, 0.0, 0.0][k], 1e-4));
    // x, y of BT.709's primaries, and D65's.
    for (rgb, [x, y]) in
        [([0.5, 0.0, 0.0], [0.64, 0.33]), ([0.0, 0.5, 0.0], [0.30, 0.60]), ([0.0, 0.0, 0.5], [0.15, 0.06])]
    {
        let xyz = one(rgb)[0].xyz;
        let sum: f64 = xyz.iter().sum();
        near(xyz[0] / sum, x, 1e-6);
        near(xyz[1] / sum, y, 1e-6);
    }
    let sum: f64 = white[0].xyz.iter().sum();
    near(white[0].xyz[0] / sum, 0.3127, 1e-6);
    near(white[0].xyz[1] / sum, 0.3290, 1e-6);
}

#[test]
fn what_says_no_colour_has_none_and_says_why() {
    let grey = of(&even(&[0.5], &[]), None);
    assert!(colours(&grey).is_empty() && grey.colours.contains("one channel"));
    let few = of(&even(&[0.2, 0.5, 0.7], &[450.0, 550.0, 650.0]), None);
    assert!(colours(&few).is_empty() && few.colours.contains("from 400 to 700 nm"), "{}", few.colours);
    // The wavelength nearest to 555 nm stands for the luminance.
    let factor = few.azimuths[0].reflectance[0].factor.value.expect("a number");
    assert!((factor - 0.5).abs() < 1e-6);
}

#[test]
fn errors_of_colours_follow_from_the_realisations() {
    let made = even(&[0.3; 3], &[]);
    let (mean, half) = (0.3f64, 0.01f64);
    let part = |reflectance: f64| {
        let total = vec![vec![(reflectance / PI) as f32; 18 * 36]; 3];
        RealisationPart { single: total.clone(), total, schlick: None }
    };
    let parts = Realisations { parts: [mean - half, mean + half].map(part).into() };
    let colour = colours(&of(&made, Some(&parts))).remove(0);
    // Two values: the standard error of their mean is half their distance. dL*/dY = 116/3 Y^(-2/3), Y of white 1; the next term
    // of the jackknife is of relative size (half/mean)^2.
    let wanted = 116.0 / 3.0 * mean.powf(-2.0 / 3.0) * half;
    let found = colour.lab_se[0].expect("realisations");
    assert!((found / wanted - 1.0).abs() < 2e-3, "{found} {wanted}");
    assert!(colour.lab_se[1].expect("realisations") < 1e-4, "grey stays grey");
    assert!((colour.xyz_se[1].expect("realisations") - 100.0 * half).abs() < 1e-4);
}
