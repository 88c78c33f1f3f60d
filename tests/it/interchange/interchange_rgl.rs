//! Promise: RGL tensor files have the layout and the values that Mitsuba's `measured` expects. (Mitsuba itself reads
//! them in tests/interop.)

use gonio::interchange::mitsuba::rgl;
use gonio::interchange::{self, Format, Lookup, Options};

use crate::support::analytic::{Ggx, hemisphere, l1, steps, table};
use crate::support::mutations;

const LIGHT: [(f64, f64); 5] = [(3.0, 0.0), (20.0, 77.0), (40.0, 200.0), (55.0, 310.0), (68.0, 33.0)];

fn isotropic(alpha: f64) -> Lookup {
    Lookup::new(&table(&Ggx::new(alpha, alpha), &hemisphere(steps(10.0, 9), None, 60, 120)))
        .expect("a product")
}

#[test]
fn an_isotropic_file_has_the_fields_and_bytes_of_the_format() {
    let bytes = rgl::write(&isotropic(0.3), None, "note").expect("written");
    let start = [0x74, 0x65, 0x6e, 0x73, 0x6f, 0x72, 0x5f, 0x66, 0x69, 0x6c, 0x65, 0, 1, 0, 9, 0, 0, 0];
    assert_eq!(bytes[..18], start);
    // The first field: length and name, one axis, type u8, an offset at a multiple of 8, four bytes.
    assert_eq!(&bytes[18..33], b"\x0b\x00description\x01\x00");
    assert_eq!(bytes[33], 1);
    let offset = u64::from_le_bytes(bytes[34..42].try_into().expect("eight")) as usize;
    assert!(offset.is_multiple_of(8) && &bytes[offset..offset + 4] == b"note");
    let text = String::from_utf8_lossy(&bytes[..600]);
    for field in ["jacobian", "phi_i", "theta_i", "ndf", "sigma", "vndf", "luminance", "rgb"] {
        assert!(text.contains(field), "{field}");
    }
    assert!(!text.contains("wavelengths"));
}

#[test]
fn rgl_reads_back() {
    let alpha = 0.3;
    let file = rgl::read(&rgl::write(&isotropic(alpha), None, "").expect("written")).expect("sound");
    let off = l1(&file, &Ggx::new(alpha, alpha), &LIGHT, 75.0);
    // The bar of the issue for Mitsuba; this reader follows the same scheme.
    assert!(off <= 1e-3, "{off}");
    // Bins of 3 x 7.5 degrees: less than half of the lobe's half-widths, 2 alpha = 44 degrees and, in azimuth under light
    // from 68 degrees, 2 alpha/tan(68) = 18.
    let ggx = Ggx::new(0.4, 0.6);
    let own = table(&ggx, &hemisphere(steps(18.0, 5), Some(steps(45.0, 8)), 30, 48));
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("brushed.bsdf");
    let written = interchange::export(&own, Format::Rgl, &Options::default(), &path).expect("written");
    let file = rgl::read(&std::fs::read(&path).expect("written")).expect("sound");
    let off = l1(&file, &ggx, &LIGHT, 75.0);
    assert!(off <= 5e-3, "{off}");
    // Cells follow the lobe, and bins are read linearly every 7.5 degrees: step^2/8 of a second derivative of ln f of
    // 1/alpha^2 = 6 at most.
    let l1 = written.read_back.expect("light").l1;
    assert!(l1 > 0.0 && l1 <= 7.5f64.to_radians().powi(2) / 8.0 * 6.0, "{l1}");
}

#[test]
fn spectral_files_keep_the_colours_apart() {
    let mut ggx = Ggx::new(0.4, 0.4);
    ggx.tint = vec![0.9, 0.6, 0.3];
    let lookup = Lookup::new(&table(&ggx, &hemisphere(steps(15.0, 6), None, 30, 36))).expect("a product");
    let bytes = rgl::write(&lookup, Some(&[465.0, 532.0, 630.0]), "").expect("written");
    let file = rgl::read(&bytes).expect("sound");
    assert!(file.note.as_deref().is_some_and(|note| note.contains("630 nm, 532 nm, 465 nm")));
    let wi = gonio::sphere::direction_deg(30.0, 0.0);
    let found = gonio::interchange::Brdf::brdf(&file, wi, gonio::sphere::direction_deg(32.0, 183.0));
    // One shape times three tints, through f32.
    assert!((found[1] / found[0] - 2.0 / 3.0).abs() < 1e-6 && (found[2] / found[0] - 1.0 / 3.0).abs() < 1e-6);
}

#[test]
fn damaged_tensor_files_are_refused() {
    let reason = |bytes: &[u8]| rgl::read(bytes).err().expect("must be refused");
    assert!(reason(b"").to_string().contains("empty"));
    assert!(reason(b"MERL").to_string().contains("not a tensor file"));
    let lookup =
        Lookup::new(&table(&Ggx::new(0.5, 0.5), &hemisphere(steps(40.0, 3), None, 4, 4))).expect("a product");
    let good = rgl::write(&lookup, None, "").expect("written");
    assert!(reason(&good[..good.len() - 1]).to_string().contains("beyond the file's end"));
    // A small file of the same fields: 2 x 2 slices.
    let small = small_file();
    assert!(rgl::read(&small).is_ok());
    let refused = mutations::refused(&small, rgl::read);
    assert!(refused > 0.2, "{refused}");
}

/// A file with the least that a reader needs.
fn small_file() -> Vec<u8> {
    use gonio::interchange::mitsuba::tensor_file::{TensorData, encode};
    let ones = |sides: &[usize]| (sides.to_vec(), TensorData::F32(vec![1.0; sides.iter().product()]));
    let named = |name: &'static str, (sides, data): (Vec<usize>, TensorData)| (name, sides, data);
    encode(&[
        ("theta_i", vec![2], TensorData::F32(vec![0.0, 1.0])),
        ("phi_i", vec![1], TensorData::F32(vec![0.0])),
        named("ndf", ones(&[2, 2])),
        named("sigma", ones(&[2, 2])),
        named("vndf", ones(&[1, 2, 2, 2])),
        named("rgb", ones(&[1, 2, 3, 2, 2])),
    ])
}
