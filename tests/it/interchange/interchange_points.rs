//! Promise: UTIA files and EXR parts hold the table's values exactly, and damaged ones are refused.

use gonio::files::image::{self, ImagePart, Samples};
use gonio::interchange::{self, Brdf, Format, Options, exr_parts, utia};
use gonio::sphere;

use crate::support::analytic::{Ggx, hemisphere, measured_looking, points, steps, table};
use crate::support::mutations;

fn coloured() -> Ggx {
    let mut ggx = Ggx::new(0.4, 0.7);
    ggx.tint = vec![1.0, 0.5, 0.25];
    ggx
}

#[test]
fn utia_comes_back_exactly() {
    let ggx = coloured();
    let (theta, phi) = (steps(15.0, 6), steps(7.5, 48));
    let native = table(&ggx, &points(theta.clone(), phi.clone(), &theta, &phi));
    let bytes = utia::write(&native).expect("written");
    assert_eq!(bytes.len(), 1_990_656);
    // The value of (theta_i 30, phi_i 15; theta_v 45, phi_v 187.5), green, where the layout has it.
    let at = 8 * (82_944 + (48 * 2 + 2) * 288 + (48 * 3 + 25));
    let found = f64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight"));
    let wanted = ggx.brdf(sphere::direction_deg(30.0, 15.0), sphere::direction_deg(45.0, 187.5))[1];
    assert!((found / wanted - 1.0).abs() < 1e-7, "stored as f32 in the table: {found} {wanted}");
    let back = utia::read(&bytes).expect("readable");
    assert!(back.colours == native.colours && back.grid == native.grid);
    assert_eq!(utia::write(&back).expect("written"), bytes);
}

#[test]
fn the_image_form_of_utia_comes_back() {
    let (theta, phi) = (steps(15.0, 6), steps(7.5, 48));
    let native = table(&coloured(), &points(theta.clone(), phi.clone(), &theta, &phi));
    let bytes = utia::write_image(&native).expect("written");
    // Row = light (theta_i 30, phi_i 15), column = sensor (45, 187.5).
    let part = &image::decode(&bytes).expect("an EXR")[0];
    assert_eq!((part.width, part.height), (288, 288));
    let Samples::F32(green) = &part.channels["G"] else { panic!("FLOAT") };
    assert_eq!(
        green[(48 * 2 + 2) * 288 + 48 * 3 + 25],
        native.colours[1].total[(48 * 2 + 2) * 288 + 48 * 3 + 25]
    );
    let back = utia::read(&bytes).expect("readable");
    assert!(back.colours == native.colours && back.grid == native.grid);
    // Chosen by the name of the file.
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("brdf.exr");
    let export = interchange::export(&native, Format::Utia, &Options::default(), &path).expect("written");
    assert!(std::fs::read(&path).expect("there") == bytes && export.read_back.is_some());
}

#[test]
fn other_images_are_not_taken_for_utia() {
    let reason = |change: fn(&mut ImagePart)| {
        let mut part = ImagePart { width: 288, height: 288, ..ImagePart::default() };
        for name in ["R", "G", "B"] {
            part.channels.insert(name.into(), Samples::F32(vec![0.5; 288 * 288]));
        }
        change(&mut part);
        utia::read(&image::encode(vec![part]).expect("encoded")).expect_err("refused").to_string()
    };
    assert!(reason(|part| drop(part.channels.remove("G"))).contains("no channel `G`"));
    let narrow = |part: &mut ImagePart| {
        part.height = 287;
        part.channels.values_mut().for_each(|samples| *samples = Samples::F32(vec![0.5; 288 * 287]));
    };
    assert!(reason(narrow).contains("288 x 287"));
    let nan = |part: &mut ImagePart| {
        let mut values = vec![0.5; 288 * 288];
        values[300] = f32::NAN;
        part.channels.insert("R".into(), Samples::F32(values));
    };
    assert!(reason(nan).contains("incidence 1, bin 12: NaN"));
}

#[test]
fn other_tables_are_sampled_at_the_directions_of_utia() {
    // Wide lobes, bins of 3 x 5 degrees, incidences of the format's angles: the interpolant between bin means is all that
    // differs, of fourth order in the step.
    let ggx = Ggx::new(0.5, 0.5);
    let grid = hemisphere(steps(15.0, 6), None, 30, 72);
    let back = utia::read(&utia::write(&table(&ggx, &grid)).expect("written")).expect("readable");
    let light = sphere::direction_deg(45.0, 0.0);
    for bin in [10, 60, 130, 180, 200] {
        let [theta, phi] = back.grid.points_deg[bin];
        let wanted = ggx.brdf(light, sphere::direction_deg(theta, phi))[0];
        let found = f64::from(back.colours[0].total[(48 * 3) * 288 + bin]);
        assert!((found / wanted - 1.0).abs() < 2e-3, "{theta} {phi}: {found} {wanted}");
    }
}

#[test]
fn damaged_utia_files_are_refused() {
    let reason = |bytes: &[u8]| utia::read(bytes).expect_err("must be refused").to_string();
    assert!(reason(b"").contains("0 bytes"));
    let mut bytes = vec![0; 1_990_656];
    bytes[80..88].copy_from_slice(&f64::NAN.to_le_bytes());
    assert!(reason(&bytes).contains("incidence 0, bin 10: NaN"));
    bytes.push(0);
    assert!(reason(&bytes).contains("1990657 bytes"));
    assert_eq!(mutations::refused(&[7; 600], utia::read), 1.0);
}

/// Each round decodes 288 x 288 pixels.
fn damaged_images(rounds: usize) {
    let mut part = ImagePart { width: 288, height: 288, ..ImagePart::default() };
    for name in ["R", "G", "B"] {
        part.channels.insert(name.into(), Samples::F32(vec![0.5; 288 * 288]));
    }
    let good = image::encode(vec![part]).expect("encoded");
    assert!(utia::read(&good).is_ok());
    let refused = mutations::survives(&good, rounds, utia::read);
    assert!(refused > rounds / 3, "{refused}");
}

#[test]
fn damaged_utia_images_are_refused() {
    damaged_images(2_000);
}

#[test]
#[ignore = "takes minutes: cargo test --test it interchange_points -- --ignored"]
fn damaged_utia_images_are_refused_a_hundred_thousand_times() {
    damaged_images(100_000);
}

#[test]
fn exr_parts_come_back_bit_for_bit() {
    let hemisphere = hemisphere(vec![0.0, 40.0], Some(steps(90.0, 4)), 3, 4);
    let listed = points(vec![10.0], vec![0.0], &[0.0, 30.0], &[0.0, 90.0]);
    for grid in [hemisphere, listed] {
        let wanted = measured_looking(&coloured(), &grid);
        let bytes = exr_parts::write(&wanted).expect("written");
        assert!(exr_parts::read(&bytes).expect("readable") == wanted);
        let parts = image::decode(&bytes).expect("an EXR");
        assert_eq!(parts.len(), wanted.grid.incidences());
        let last = parts.iter().max_by_key(|part| part.name.clone()).expect("parts");
        let (theta_i, phi_i) = wanted.grid.incidence_deg(wanted.grid.incidences() - 1);
        assert_eq!(
            (last.number("gonio.theta_i_deg"), last.number("gonio.phi_i_deg")),
            (Some(theta_i), Some(phi_i))
        );
    }
}

#[test]
fn damaged_parts_are_refused() {
    let grid = points(vec![10.0, 20.0], vec![0.0], &[30.0], &[0.0, 90.0]);
    let good = exr_parts::write(&table(&Ggx::new(0.4, 0.4), &grid)).expect("written");
    assert!(exr_parts::read(&good).is_ok());
    assert!(exr_parts::read(b"MERL").expect_err("mislabelled").to_string().contains("not an EXR"));
    // Each round decodes a compressed image: fewer bytes flipped than whole files cut.
    let refused = mutations::refused(&good, exr_parts::read);
    assert!(refused > 0.3, "{refused}");
}
