//! Promise: a height map means the same surface whatever its file, its offset and its unit.

use std::path::Path;

use gonio::campaign::{Detrend, HeightMap, Preparation};
use gonio::error::{Error, Result};
use gonio::files::image::{self, Attribute, ImagePart, Samples};
use gonio::surface::Heightfield;
use gonio::surface::io::import::{ImportedMap, load, load_patch};
use gonio::surface::io::{export, map_file};

use crate::support::arrays;

const COLUMNS: usize = 24;
const ROWS: usize = 17;

/// Repeatable f32 heights within about 3 units, of sum 0 where COLUMNS is even.
fn heights() -> Vec<f64> {
    let half = |i: usize| f64::from(((i * i) as f32 * 0.37).sin() + 0.01 * (i % 7) as f32);
    (0..COLUMNS * ROWS).map(|i| if i % 2 == 0 { half(i / 2) } else { -half(i / 2) }).collect()
}

fn map(path: &Path, periodic: bool) -> HeightMap {
    HeightMap {
        path: path.display().to_string(),
        resolved_path: path.to_path_buf(),
        channel: None,
        preparation: Preparation::default(),
        pitch_x_um: None,
        pitch_y_um: None,
        height_unit_um: None,
        periodic,
        detrend: Detrend::Plane,
        // The file's own cells: what is held here is how they are read.
        refine: Some(1),
        tiles: 4,
    }
}

fn with_pitch(map: HeightMap, pitch_um: f64) -> HeightMap {
    HeightMap {
        pitch_x_um: Some(pitch_um),
        pitch_y_um: Some(2.0 * pitch_um),
        height_unit_um: Some(1.0),
        ..map
    }
}

/// Loads `bytes` as a file of its own.
fn load_bytes(bytes: &[u8], settings: impl Fn(&Path) -> HeightMap) -> Result<ImportedMap> {
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join("scan");
    std::fs::write(&path, bytes).expect("file");
    load(&settings(&path))
}

fn npy_f64(heights: &[f64]) -> Vec<u8> {
    arrays::npy(heights, COLUMNS)
}

fn npy_f32(heights: &[f64]) -> Vec<u8> {
    arrays::npy_f32(heights, COLUMNS)
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn exported_heights_come_back_bit_for_bit() {
    for (periodic, cells_x, cells_y) in [(true, COLUMNS, ROWS), (false, COLUMNS - 1, ROWS - 1)] {
        let field = Heightfield::new(cells_x, cells_y, periodic, heights());
        let exr = export::encode_exr(&field, 0.1, 0.3).expect("encodes");
        let npy = export::encode_npy(&field).expect("encodes");
        for bytes in [&exr, &npy] {
            let raw = map_file::read(bytes).expect("reads");
            assert_eq!((raw.columns, raw.rows), (COLUMNS, ROWS));
            assert_eq!(bits(&raw.heights), bits(field.heights()));
        }
        // The heights cancel in pairs: their mean is 0, and taking it off changes no bit.
        let plain = |path: &Path| HeightMap { detrend: Detrend::None, ..map(path, periodic) };
        let from_exr = load_bytes(&exr, plain).expect("loads");
        assert_eq!(bits(from_exr.field.heights()), bits(field.heights()));
        assert_eq!((from_exr.alpha_x, from_exr.alpha_y), (1.0 / 0.1, 1.0 / 0.3));
        let from_npy = load_bytes(&npy, |path| with_pitch(plain(path), 0.1)).expect("loads");
        assert_eq!(from_npy.field, from_exr.field);
        assert_eq!(from_npy.alpha_x, from_exr.alpha_x);
    }
}

#[test]
fn a_gwyddion_field_and_lines_of_text_are_the_same_map() {
    let heights = heights();
    let from_npy = load_bytes(&npy_f64(&heights), |path| with_pitch(map(path, false), 0.5)).expect("loads");
    let own = |path: &Path| map(path, false);
    // Sizes and heights in um; pitches 0.5 and 1.
    let header = format!(
        "Gwyddion Simple Field 1.0\nXRes = {COLUMNS}\nYRes = {ROWS}\nXReal = {}\nYReal = {}\nXYUnits = um\n\
         ZUnits = um\n",
        0.5 * COLUMNS as f64,
        1.0 * ROWS as f64
    );
    let mut gsf = header.into_bytes();
    gsf.resize(gsf.len() + 4 - gsf.len() % 4, 0);
    gsf.extend(heights.iter().flat_map(|&h| (h as f32).to_le_bytes()));
    let line = |(k, h): (usize, &f64)| format!("{} {} {h:?}\n", 0.5 * (k % COLUMNS) as f64, k / COLUMNS);
    let xyz: String = heights.iter().enumerate().map(line).collect();
    for (name, bytes) in [("gsf", gsf), ("xyz", xyz.into_bytes())] {
        let found = load_bytes(&bytes, own).unwrap_or_else(|e| panic!("{name}: {e}"));
        // Heights that f32 holds, and numbers written so that they read back the same.
        assert_eq!(bits(found.field.heights()), bits(from_npy.field.heights()), "{name}");
        assert_eq!((found.alpha_x, found.alpha_y), (from_npy.alpha_x, from_npy.alpha_y), "{name}");
    }
}

#[test]
fn patches_have_equal_bytes_from_every_run_and_keep_their_heights() {
    let shifted = heights().iter().map(|h| f64::from((h + 0.7) as f32)).collect();
    let field = Heightfield::new(COLUMNS, ROWS, true, shifted);
    let exr = export::encode_exr(&field, 0.1, 0.3).expect("encodes");
    for _ in 0..20 {
        assert!(exr == export::encode_exr(&field, 0.1, 0.3).expect("encodes"));
    }
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join("patch_000.exr");
    std::fs::write(&path, &exr).expect("file");
    let patch = load_patch(&path).expect("loads");
    assert_eq!(bits(patch.field.heights()), bits(field.heights()));
    assert_eq!((patch.pitch_x, patch.pitch_y), (0.1, 0.3));
}

/// Every slope of the map, in a fixed order.
fn slopes(map: &ImportedMap) -> Vec<f64> {
    map.field
        .all_corners()
        .flat_map(|corners| corners.slopes())
        .flat_map(|slope| [slope.x * map.alpha_x, slope.y * map.alpha_y])
        .collect()
}

#[test]
fn scaling_by_a_power_of_two_keeps_every_slope_bit_for_bit() {
    let noisy: Vec<f64> = heights().iter().enumerate().map(|(i, h)| h * 1.1 + 0.013 * i as f64).collect();
    for periodic in [true, false] {
        let load_scaled = |scale: f64| {
            let scaled: Vec<f64> = noisy.iter().map(|h| h * scale).collect();
            load_bytes(&npy_f64(&scaled), |path| with_pitch(map(path, periodic), 0.3 * scale)).expect("loads")
        };
        let unscaled = bits(&slopes(&load_scaled(1.0)));
        for power in [-40, -1, 3, 60] {
            assert_eq!(bits(&slopes(&load_scaled(2.0_f64.powi(power)))), unscaled, "2^{power}");
        }
    }
}

#[test]
fn an_offset_in_f64_changes_nothing_and_in_f32_is_refused() {
    let offset: Vec<f64> = heights().iter().map(|h| h + 1e6).collect();
    for periodic in [true, false] {
        let settings = |path: &Path| with_pitch(map(path, periodic), 1.0);
        let plain = load_bytes(&npy_f64(&heights()), settings).expect("loads");
        let shifted = load_bytes(&npy_f64(&offset), settings).expect("loads");
        for (a, b) in plain.field.heights().iter().zip(shifted.field.heights()) {
            // ulp(1e6) = 1.2e-10: half of it from storing, half from the mean.
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
        assert!(load_bytes(&npy_f32(&heights()), settings).is_ok());
        let refused = load_bytes(&npy_f32(&offset), settings).expect_err("48 steps of 0.0625");
        assert!(matches!(&refused, Error::Format { what, .. } if what.contains("steps of the format")));
    }
}

#[test]
fn a_hole_in_the_scan_is_named_by_row_and_column() {
    let mut holed = heights();
    holed[3 * COLUMNS + 5] = f64::NAN;
    for bytes in [npy_f64(&holed), npy_f32(&holed)] {
        let refused = load_bytes(&bytes, |path| with_pitch(map(path, false), 1.0)).expect_err("a hole");
        assert!(refused.to_string().contains("row 3, column 5"), "{refused}");
    }
}

#[test]
fn an_exr_map_may_name_its_only_channel_as_it_likes_and_be_half_or_uint() {
    let settings = |path: &Path| map(path, false);
    let part = |samples: Samples| {
        let mut part = ImagePart { width: COLUMNS, height: ROWS, ..ImagePart::default() };
        part.channels.insert("Z".into(), samples);
        // Heights up to 96 on less would be walls.
        part.attributes.insert("pitch_x".into(), Attribute::Number(64.0));
        part.attributes.insert("pitch_y".into(), Attribute::Number(64.0));
        part
    };
    let uint = part(Samples::U32((0..(COLUMNS * ROWS) as u32).map(|i| i * i % 97).collect()));
    let imported = load_bytes(&image::encode(vec![uint.clone()]).expect("encodes"), settings).expect("loads");
    assert_eq!(imported.alpha_x, 1.0 / 64.0);
    let half = heights().iter().map(|&h| exr::prelude::f16::from_f64(h)).collect();
    let imported = load_bytes(&image::encode(vec![part(Samples::F16(half))]).expect("encodes"), settings);
    assert!(imported.expect("loads").notes.iter().any(|note| note.contains("half floats")));
    let mut two = uint;
    two.channels.insert("A".into(), Samples::F32(vec![0.0; COLUMNS * ROWS]));
    let refused = load_bytes(&image::encode(vec![two]).expect("encodes"), settings).expect_err("which?");
    assert!(refused.to_string().contains("no channel `height` among A, Z"), "{refused}");
}

#[test]
fn damaged_maps_are_errors_and_never_panic() {
    let field = Heightfield::new(COLUMNS, ROWS, true, heights());
    let exr = export::encode_exr(&field, 0.1, 0.3).expect("encodes");
    let npy = export::encode_npy(&field).expect("encodes");
    let mut state = 5_u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % n as u64) as usize
    };
    for bytes in [exr, npy] {
        for length in 0..bytes.len() {
            assert!(map_file::read(&bytes[..length]).is_err(), "read a file cut at {length} bytes");
        }
        for _ in 0..10_000 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + random(3) {
                let at = if random(2) == 0 { random(bytes.len()) } else { random(500) };
                damaged[at] = if random(2) == 0 { random(256) as u8 } else { damaged[at] ^ (1 << random(8)) };
            }
            if let Ok(map) = map_file::read(&damaged) {
                assert_eq!(map.heights.len(), map.columns * map.rows);
            }
        }
    }
}

/// h = A sin(2 pi x / L): Sq = A / sqrt 2, Sdq = 2 pi A / (L sqrt 2), whatever the file's unit. Slopes are difference
/// quotients over L/256: short by (pi/256)^2/6 = 2.5e-5; the spline between 64 samples errs by less.
#[test]
fn a_sine_has_the_height_and_the_slope_of_its_formula_in_any_unit() {
    let (amplitude, length) = (0.25, 16.0);
    let sine = |x: f64| amplitude * (std::f64::consts::TAU * x / length).sin();
    let heights: Vec<f64> = (0..64 * 64).map(|i| sine((i % 64) as f64 * length / 64.0)).collect();
    let periodic = |path: &Path| HeightMap { refine: Some(4), ..map(path, true) };
    let root = 2.0_f64.sqrt();
    for (xy, z, unit_um) in [("um", "um", 1.0), ("m", "m", 1e6), ("m", "nm", 1e-3), ("mm", "\u{b5}m", 1.0)] {
        let size = length * 1e-6
            / [("um", 1e-6), ("m", 1.0), ("mm", 1e-3)].iter().find(|u| u.0 == xy).expect("unit").1;
        let header = format!(
            "Gwyddion Simple Field 1.0\nXRes = 64\nYRes = 64\nXReal = {size:?}\nYReal = {size:?}\nXYUnits = {xy}\nZUnits = {z}\n"
        );
        let mut gsf = header.into_bytes();
        gsf.resize(gsf.len() + 4 - gsf.len() % 4, 0);
        gsf.extend(heights.iter().flat_map(|h| ((h / unit_um) as f32).to_le_bytes()));
        let found = load_bytes(&gsf, periodic).expect("loads");
        let unit = found.unit_um.expect("the file says so");
        let near = |found: f64, expected: f64| {
            assert!((found / expected - 1.0).abs() < 1e-4, "{xy} {z}: {found} {expected}")
        };
        near(unit, unit_um);
        near(unit * found.sq(), amplitude / root);
        near(found.cuts.sdq, std::f64::consts::TAU * amplitude / (length * root));
        near(unit * found.pitch()[0], length / 256.0);
        near(unit * found.size()[1], length);
    }
}

#[test]
fn maps_of_other_programs_read_as_what_they_are_or_are_refused_by_what_they_lack() {
    let case = |name: &str| std::fs::read(Path::new("tests/data/maps").join(name)).expect("a case");
    let own = |path: &Path| HeightMap { detrend: Detrend::None, ..map(path, false) };
    let arc = load_bytes(&case("map_arc_grid.asc"), own).expect("loads");
    let matrix = load_bytes(&case("map_gwyddion_matrix.txt"), own).expect("loads");
    // The same scan: in micrometres from the bottom, and in metres (five digits) from the top, 1 um between samples.
    let sizes = [(&arc, 1.0), (&matrix, 1e6)];
    let rows = sizes.map(|(map, unit)| {
        map.field
            .heights()
            .chunks(12)
            .map(|row| row.iter().map(|h| h * unit).collect::<Vec<_>>())
            .collect::<Vec<_>>()
    });
    for (above, below) in rows[0].iter().rev().zip(&rows[1]) {
        for (a, b) in above.iter().zip(below) {
            // Rounded to 1e-5 in the grid, to 5e-6 of up to 0.15 in the matrix; the means differ by no more.
            assert!((a - b).abs() < 2e-5, "{a} {b}");
        }
    }
    assert!((arc.pitch()[0] - 1.0).abs() < 1e-12 && (1e6 * matrix.pitch()[1] - 1.0).abs() < 1e-12);
    let reason = |name: &str| load_bytes(&case(name), own).expect_err("must be refused").to_string();
    // The instrument's points have no size, and one of them has no data.
    assert!(reason("map_zygo.xyz").contains("x and y count pixels"), "{}", reason("map_zygo.xyz"));
    let zygo =
        load_bytes(&case("map_zygo.xyz"), |path| with_pitch(map(path, false), 1.0)).expect_err("a gap");
    let asked = "no data at row 1, column 5 (1 such of 144): set surface.file.gaps";
    assert!(zygo.to_string().contains(asked), "{zygo}");
    let missing = reason("xyz_missing_line.txt");
    assert!(missing.contains(asked), "{missing}");
    // A mark before the first number is no word, and the point of that line is read.
    let filled = String::from_utf8(case("xyz_missing_line.txt"))
        .expect("text")
        .replace("\n6 1 ", "\n5 1 -0.05124\n6 1 ");
    let plain = load_bytes(filled.as_bytes(), own).expect("loads");
    let marked = load_bytes(format!("\u{feff}{filled}").as_bytes(), own).expect("loads");
    assert_eq!(marked, plain);
    for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        let wide: Vec<u8> = std::iter::once(0xfeff).chain(filled.encode_utf16()).flat_map(bytes).collect();
        assert_eq!(load_bytes(&wide, own).expect("loads"), plain);
    }
}

#[test]
fn a_unit_slip_of_a_thousand_is_refused_or_named() {
    let settings = |unit: f64| {
        move |path: &Path| HeightMap { height_unit_um: Some(unit), ..with_pitch(map(path, true), 1.0) }
    };
    // Rms slope of the map itself: about 1.
    let right = load_bytes(&npy_f64(&heights()), settings(0.3)).expect("loads");
    assert!(!right.notes.iter().any(|note| note.contains("units right")), "{:?}", right.notes);
    let large =
        load_bytes(&npy_f64(&heights()), settings(300.0)).expect_err("slopes of several hundred").to_string();
    assert!(
        large.contains("Sdq") && large.contains("height_unit_um = 300 on a pitch of 1 x 2 um"),
        "{large}"
    );
    let small = load_bytes(&npy_f64(&heights()), settings(3e-4)).expect("a mirror, perhaps");
    assert!(
        small.notes.iter().any(|note| note.contains("smoother than a polished mirror")),
        "{:?}",
        small.notes
    );
}
