//! Promise: SSDD is read in each of its three kinds of angles, with each of its symmetries, at the directions that the
//! specification gives them; what is not read is said.

use glam::DVec3;
use gonio::instrument::GridKind;
use gonio::interchange;
use gonio::interchange::content::half_difference::HalfDifference;
use gonio::interchange::text::ssdd;
use gonio::interchange::{Brdf, Format, Imported, Options};
use gonio::table::BrdfTable;

use crate::support::analytic::{Ggx, hemisphere, steps, table};
use crate::support::mutations;

/// A file of these lists whose values are `value` of the four indices, the first fastest.
fn file(heading: &str, lists: [&[f64]; 4], value: impl Fn([usize; 4]) -> f64) -> String {
    let mut text = format!("VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\n{heading}\n");
    for (k, list) in lists.iter().enumerate().filter(|(_, list)| !list.is_empty()) {
        let list: Vec<String> = list.iter().map(f64::to_string).collect();
        text += &format!("PARAM{k}_LIST {}\n", list.join(" "));
    }
    text += "DATA ascii\n";
    let [n0, n1, n2, n3] = lists.map(|list| list.len().max(1));
    for at in 0..n0 * n1 * n2 * n3 {
        let index = [at % n0, at / n0 % n1, at / (n0 * n1) % n2, at / (n0 * n1 * n2)];
        text += &format!("{}\n", value(index));
    }
    text
}

/// No two are alike; all are f32.
fn distinct([a, b, c, d]: [usize; 4]) -> f64 {
    1.0 + (a + 8 * b + 64 * c + 512 * d) as f64 / 4096.0
}

fn read(text: &str) -> (Imported, Vec<String>) {
    ssdd::read_with_notes(text.as_bytes()).expect("readable")
}

fn function(text: &str) -> Box<dyn Brdf> {
    match read(text).0 {
        Imported::Function { mut parts, wavelengths_nm, .. } if wavelengths_nm.is_empty() => parts.remove(0),
        Imported::Function { .. } => panic!("a spectrum"),
        Imported::Table(table) => panic!("a table: {:?}", table.grid),
    }
}

fn refusal(text: &str) -> String {
    ssdd::read_with_notes(text.as_bytes()).err().expect("refused").to_string()
}

/// A vector turned about y (z towards x) and then about z, degrees.
fn turned(v: DVec3, about_y: f64, about_z: f64) -> DVec3 {
    let ((s, c), (sin, cos)) = (about_y.to_radians().sin_cos(), about_z.to_radians().sin_cos());
    let v = DVec3::new(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
    DVec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
}

fn direction(theta: f64, phi: f64) -> DVec3 {
    turned(DVec3::Z, theta, phi)
}

/// Angles come back to 1e-13 degrees, and values change by less than 1 from node to node.
fn close(found: f64, wanted: f64) -> bool {
    (found - wanted).abs() < 1e-10
}

const SPECULAR: &str = "PARAM_TYPE specular_coordinate_system";
const HALF: &str = "PARAM_TYPE half_difference_coordinate_system";

/// "Spherical coordinates rotated toward the specular direction": those of the pole about y by -theta_i (away from the
/// light), then with the light's azimuth.
#[test]
fn specular_angles_are_spherical_ones_about_the_mirror_direction() {
    let lists: [&[f64]; 4] =
        [&[0.0, 40.0], &[0.0, 90.0, 180.0, 270.0], &[0.0, 10.0, 30.0], &[0.0, 45.0, 180.0, 300.0, 360.0]];
    // 0 and 360 are one azimuth.
    let value = |[a, b, c, d]: [usize; 4]| distinct([a, b, c, d % 4]);
    for (offsets, more) in [([0.0, 0.0], ""), ([0.0, -7.0], "\nPARAM4_LIST 0 -7")] {
        let brdf = function(&file(&format!("{SPECULAR}{more}"), lists, value));
        for (i, &theta_i) in lists[0].iter().enumerate() {
            for (j, &phi_i) in lists[1].iter().enumerate() {
                let wi = direction(theta_i, phi_i);
                for (k, &radial) in lists[2].iter().enumerate().skip(1) {
                    for (l, &azimuth) in lists[3].iter().enumerate() {
                        let wo = turned(direction(radial, azimuth), -theta_i - offsets[i], phi_i);
                        let (found, wanted) = (brdf.brdf(wi, wo)[0], value([i, j, k, l]));
                        // At the normal every azimuth of the light is the same direction.
                        if theta_i > 0.0 {
                            assert!(
                                close(found, wanted),
                                "{theta_i} {phi_i} {radial} {azimuth}: {found} {wanted}"
                            );
                        }
                    }
                }
            }
        }
    }
    let wrong = file(&format!("{SPECULAR}\nPARAM4_LIST 1 2 3"), lists, value);
    assert!(refusal(&wrong).contains("PARAM4_LIST"));
}

#[test]
fn specular_half_a_turn_is_mirrored_at_the_plane_of_incidence() {
    let lists: [&[f64]; 4] = [&[30.0, 50.0], &[], &[0.0, 20.0], &[0.0, 60.0, 180.0]];
    let brdf = function(&file(&format!("{SPECULAR}\nREDUCTION_TYPE bilateral_symmetry"), lists, distinct));
    for turn in [0.0, 75.0] {
        let wi = direction(50.0, turn);
        for (azimuth, l) in [(0.0, 0), (60.0, 1), (180.0, 2), (300.0, 1)] {
            let found = brdf.brdf(wi, turned(direction(20.0, azimuth), -50.0, turn))[0];
            assert!(close(found, distinct([1, 0, 1, l])), "{turn} {azimuth}: {found}");
        }
    }
    let forgotten = file(SPECULAR, lists, distinct);
    assert!(refusal(&forgotten).contains("REDUCTION_TYPE leaves out"));
    let wrong = file(&format!("{SPECULAR}\nREDUCTION_TYPE reciprocity"), lists, distinct);
    assert!(refusal(&wrong).contains("half_difference_coordinate_system needed"));
    let one = file(SPECULAR, [&[30.0], &[15.0], &[0.0, 20.0], &[0.0, 120.0, 240.0]], distinct);
    assert!(read(&one).1[0].contains("one azimuth"), "{:?}", read(&one).1);
}

/// wi and wo of half/difference angles (Rusinkiewicz 1998): the difference vector, which is the light seen from the half
/// vector, turned with it; wo its mirror image.
fn arms(theta_h: f64, phi_h: f64, theta_d: f64, phi_d: f64) -> (DVec3, DVec3) {
    let h = direction(theta_h, phi_h);
    let wi = turned(direction(theta_d, phi_d), theta_h, phi_h);
    (wi, 2.0 * wi.dot(h) * h - wi)
}

/// Every azimuth of the difference of `of` has the value of place `place` in the list, at all other angles.
fn holds(brdf: &dyn Brdf, lists: [&[f64]; 4], of: &[(f64, usize)]) {
    let azimuths = if lists[1].is_empty() { &[0.0] } else { lists[1] };
    for (i, &theta_h) in lists[0].iter().enumerate().skip(1) {
        for (j, &phi_h) in azimuths.iter().enumerate() {
            for (k, &theta_d) in lists[2].iter().enumerate().skip(1) {
                for &(phi_d, l) in of {
                    let (wi, wo) = arms(theta_h, phi_h, theta_d, phi_d);
                    let (found, wanted) = (brdf.brdf(wi, wo)[0], distinct([i, j, k, l]));
                    assert!(close(found, wanted), "{theta_h} {phi_h} {theta_d} {phi_d}: {found} {wanted}");
                }
            }
        }
    }
}

#[test]
fn half_difference_angles_of_a_reciprocal_file_are_a_table() {
    let lists: [&[f64]; 4] =
        [&[0.0, 20.0], &[0.0, 90.0, 180.0, 270.0], &[0.0, 30.0], &[0.0, 60.0, 90.0, 150.0]];
    let text = file(&format!("{HALF}\nREDUCTION_TYPE reciprocity"), lists, distinct);
    let table = ssdd::read(text.as_bytes()).expect("a table");
    assert_eq!((table.grid.kind, table.grid.phi_d_deg.as_slice()), (GridKind::HalfDifference, lists[3]));
    let brdf = HalfDifference::new(&table).expect("half/difference");
    let both = [(0.0, 0), (60.0, 1), (90.0, 2), (150.0, 3), (180.0, 0), (240.0, 1), (270.0, 2), (330.0, 3)];
    holds(&brdf, lists, &both);
    // Without the word, a whole turn whose halves are alike is the same; a seam at 360 too.
    let whole: [&[f64]; 4] =
        [lists[0], lists[1], lists[2], &[0.0, 60.0, 90.0, 150.0, 180.0, 240.0, 270.0, 330.0, 360.0]];
    let text = file(HALF, whole, |[a, b, c, d]| distinct([a, b, c, d % 4]));
    assert!(ssdd::read(text.as_bytes()).expect("a table") == table);
}

#[test]
fn half_difference_with_both_symmetries_is_a_quarter_of_a_turn() {
    let lists: [&[f64]; 4] = [&[0.0, 20.0], &[], &[0.0, 30.0], &[0.0, 40.0, 90.0]];
    let text = file(&format!("{HALF}\nREDUCTION_TYPE bilateral_symmetry reciprocity"), lists, distinct);
    let table = ssdd::read(text.as_bytes()).expect("a table");
    assert_eq!(table.grid.phi_d_deg, [0.0, 40.0, 90.0, 140.0]);
    let brdf = HalfDifference::new(&table).expect("half/difference");
    holds(&brdf, lists, &[(0.0, 0), (40.0, 1), (90.0, 2), (140.0, 1), (180.0, 0), (220.0, 1), (320.0, 1)]);
    let wrong = text.replace("PARAM3_LIST 0 40 90", "PARAM3_LIST 0 40 100");
    assert!(refusal(&wrong).contains("PARAM3_LIST: increasing angles in [0, 90] needed"));
}

#[test]
fn half_difference_that_is_not_reciprocal_is_a_function() {
    let lists: [&[f64]; 4] = [&[0.0, 20.0], &[], &[0.0, 30.0], &[0.0, 60.0, 130.0, 180.0]];
    let text = file(&format!("{HALF}\nREDUCTION_TYPE bilateral_symmetry"), lists, distinct);
    let brdf = function(&text);
    holds(brdf.as_ref(), lists, &[(0.0, 0), (60.0, 1), (130.0, 2), (180.0, 3), (230.0, 2), (300.0, 1)]);
    let forgotten = file(HALF, [lists[0], lists[1], lists[2], &[0.0, 60.0, 130.0, 170.0]], distinct);
    assert!(refusal(&forgotten).contains("REDUCTION_TYPE leaves out"));
}

#[test]
fn a_zero_below_the_horizon_is_no_value() {
    // theta_h = theta_d = 60, phi_d = 0: the light at 120 degrees.
    let lists: [&[f64]; 4] = [&[0.0, 60.0], &[], &[0.0, 60.0], &[0.0, 90.0]];
    let head = format!("{HALF}\nREDUCTION_TYPE bilateral_symmetry reciprocity");
    let below = |[a, _, c, d]: [usize; 4]| (a, c, d) == (1, 1, 0);
    let zero = file(&head, lists, |index| if below(index) { 0.0 } else { 0.5 });
    let found = ssdd::read(zero.as_bytes()).expect("a table");
    // Rows of theta_h, columns of theta_d and phi_d.
    assert_eq!(found.hits, [1, 1, 1, 1, 1, 1, 0, 1]);
    assert_eq!((found.is_gap(6), found.gaps()), (true, 1));
    let filled = file(&head, lists, |_| 0.5);
    assert_eq!(ssdd::read(filled.as_bytes()).expect("a table").hits, [1; 8]);
}

/// The specification's example of a material, its BRDF and its BTDF.
const MATERIAL: &str = "VERSION 0.2\n\n# Bluish diffuse BRDF\nDATA_TYPE brdf\nCOLOR_MODEL rgb\n\
    PARAM_TYPE half_difference_coordinate_system\nREDUCTION_TYPE bilateral_symmetry reciprocity\nPARAM0_LIST 0 90\n\
    PARAM2_LIST 0 90\nPARAM3_LIST 0 90\nDATA ascii\n# PARAM3: 0\n# PARAM2: 0\n0 0.0524275 0.159779\n0 0.0524275 0.159779\n\
    # PARAM2: 90\n0 0.0524275 0.159779\n0 0.0524275 0.159779\n# PARAM3: 90\n# PARAM2: 0\n0 0.0524275 0.159779\n\
    0 0.0524275 0.159779\n# PARAM2: 90\n0 0.0524275 0.159779\n0 0.0524275 0.159779\n\n# Orange diffuse BTDF\n\
    DATA_TYPE btdf\nCOLOR_MODEL xyz\nPARAM_TYPE specular_coordinate_system\nREDUCTION_TYPE bilateral_symmetry\n\
    PARAM0_LIST 0 90\nPARAM2_LIST 0 180\nPARAM3_LIST 0 180\nDATA ascii\n0.106 0.082 0.011\n0.106 0.082 0.011\n\
    0.106 0.082 0.011\n0.106 0.082 0.011\n0.106 0.082 0.011\n0.106 0.082 0.011\n0.106 0.082 0.011\n0.106 0.082 0.011\n";

fn imported(bytes: &[u8], like: Option<&BrdfTable>) -> (BrdfTable, Vec<String>) {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("t.ssdd");
    std::fs::write(&path, bytes).expect("written");
    let grid = like.map(|table| &table.grid);
    interchange::import(&path, Format::Ssdd, &Options::default(), grid).expect("imported")
}

#[test]
fn ssdd_says_what_it_does_not_read() {
    let like = table(&Ggx::new(0.3, 0.3), &hemisphere(vec![0.0, 60.0], None, 3, 4));
    let (found, notes) = imported(MATERIAL.as_bytes(), Some(&like));
    assert!(notes.iter().any(|note| note.contains("has gone through the surface is left out")), "{notes:?}");
    // A diffuse material is the same everywhere, up to the rounding of f32.
    for (colour, wanted) in found.colours.iter().zip([0.0f32, 0.0524275, 0.159779]) {
        assert!(
            colour.total.iter().all(|value| (value - wanted).abs() < 4.0 * f32::EPSILON * wanted + 1e-30)
        );
    }
    // Y of the BTDF, X = 0.106 and Z = 0.011 beside it, in linear R, G and B.
    let (whole, _) = imported(MATERIAL.as_bytes(), None);
    let through = whole.half(true).expect("below");
    let [r, g, b] = [0, 1, 2].map(|c| f64::from(through.colours[c].total[100]));
    assert!((0.2126 * r + 0.7152 * g + 0.0722 * b - 0.082).abs() < 1e-6, "{r} {g} {b}");
    let (head, _) = MATERIAL.split_once("ascii").expect("there");
    let values = [0.0f32, 0.0524275, 0.159779].map(f32::to_le_bytes).concat().repeat(8);
    let binary = |rest: &str| [head.as_bytes(), b"binary\n", &values, rest.as_bytes()].concat();
    let plain = ssdd::read_with_notes(&binary("")).expect("read");
    assert!(plain.1.is_empty(), "{:?}", plain.1);
    let further =
        ssdd::read_with_notes(&binary("\n# more\nDATA_TYPE specular_reflectance\nCOLOR_MODEL rgb\n"));
    assert!(further.expect("read").1[0].contains("`specular_reflectance`"));
    let junk = ssdd::read_with_notes(&binary("\u{7}\u{7}\u{7}\u{7}")).err().expect("refused");
    assert!(junk.to_string().contains("bytes after the 24 values"), "{junk}");
}

#[test]
fn a_spectrum_is_resampled_like_its_colours() {
    // Diffuse, five wavelengths, about the mirror direction.
    let nm = [400.0, 450.0, 500.5, 600.0, 700.0];
    let values = [0.1f32, 0.15, 0.2, 0.25, 0.3];
    let line = values.map(|value| value.to_string()).join(" ");
    let text = file(SPECULAR, [&[0.0, 45.0, 90.0], &[], &[0.0, 90.0, 180.0], &[0.0, 180.0, 360.0]], |_| 0.5)
        .replace("monochrome", "spectrum\nWAVELENGTH_LIST 400 450 500.5 600 700")
        .replace("\n0.5", &format!("\n{line}"));
    let (found, _) = imported(text.as_bytes(), None);
    assert_eq!(found.wavelengths_nm(), nm);
    assert!(found.grid.is_isotropic() && found.grid.kind == GridKind::Hemisphere);
    for (colour, wanted) in found.colours.iter().zip(values) {
        assert!(colour.total.iter().all(|value| (value - wanted).abs() <= 4.0 * f32::EPSILON * wanted));
    }
    // A table of wavelengths on another grid: each colour a multiple of the first, and stays one.
    let mut own = table(&Ggx::new(0.4, 0.4), &hemisphere(steps(15.0, 6), None, 18, 24));
    let first = own.colours.remove(0);
    own.colours = nm
        .into_iter()
        .zip(1u8..)
        .map(|(nm, k)| {
            let mut colour = first.clone();
            colour.wavelength_nm = Some(nm);
            colour.total.iter_mut().for_each(|value| *value *= f32::from(k));
            colour
        })
        .collect();
    let like = table(&Ggx::new(0.4, 0.4), &hemisphere(vec![20.0], None, 9, 12));
    let mut text = Vec::new();
    ssdd::write(&own, &mut text).expect("written");
    let (found, _) = imported(&text, Some(&like));
    assert_eq!(found.wavelengths_nm(), nm);
    for (k, colour) in (1u8..).zip(&found.colours) {
        for (value, first) in colour.total.iter().zip(&found.colours[0].total) {
            // Products of f32 and an interpolation in f64.
            assert!(
                (value - f32::from(k) * first).abs() <= 16.0 * f32::EPSILON * value,
                "{k}: {value} {first}"
            );
        }
    }
}

#[test]
fn ssdd_is_read_in_every_encoding_and_survives_damage() {
    let (brdf, _) = MATERIAL.split_once("\n# Orange").expect("two blocks");
    let wanted = ssdd::read(brdf.as_bytes()).expect("read");
    let wide = |mark: u16, bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        std::iter::once(mark).chain(brdf.encode_utf16()).flat_map(bytes).collect()
    };
    let latin = brdf.replace("Bluish", "Bl\u{e4}ulich").chars().map(|c| c as u8).collect();
    let marked = format!("\u{feff}{brdf}").into_bytes();
    for bytes in [marked, wide(0xfeff, u16::to_le_bytes), wide(0xfeff, u16::to_be_bytes), latin] {
        assert!(ssdd::read(&bytes).expect("read") == wanted);
    }
    assert!(mutations::survives(MATERIAL.as_bytes(), 20_000, ssdd::read_with_notes) > 2_000);
    let lists: [&[f64]; 4] = [&[0.0, 40.0], &[0.0, 90.0, 180.0, 270.0], &[0.0, 30.0], &[0.0, 180.0, 360.0]];
    let text = file(SPECULAR, lists, |_| 0.25);
    assert!(mutations::survives(text.as_bytes(), 20_000, ssdd::read_with_notes) > 2_000);
}
