//! Promise: scans of every format that is read have the heights, pitches and gaps that other programs read in them.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use gonio::surface::io::map_file;
use gonio::surface::io::samples::MapSamples;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps/scans")
}

/// The files of a kind of map, with the lines of `heights.csv` on each.
fn scans() -> BTreeMap<String, Vec<Vec<f64>>> {
    let text = fs::read_to_string(folder().join("heights.csv")).expect("readable");
    let mut scans: BTreeMap<String, Vec<Vec<f64>>> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let (file, numbers) = line.split_once(',').expect("a file");
        let numbers = numbers.split(',').map(|number| number.parse().expect("a number")).collect();
        scans.entry(file.into()).or_default().push(numbers);
    }
    scans
}

fn read(file: &str) -> MapSamples {
    let bytes = fs::read(folder().join(file)).expect("a scan");
    map_file::read(&bytes).unwrap_or_else(|why| panic!("{file}: {why}"))
}

#[test]
fn every_scan_has_the_heights_that_other_programs_read() {
    let scans = scans();
    assert!(scans.len() >= 18, "{}", scans.len());
    for (file, lines) in scans {
        let map = read(&file);
        let unit = map.unit_um.unwrap_or(1.0);
        let known: Vec<f64> = map.heights.iter().copied().filter(|height| !height.is_nan()).collect();
        let mean = known.iter().sum::<f64>() / known.len() as f64;
        for line in lines {
            let [columns, rows, pitch_x, pitch_y, gaps, row, column, height, range] = line[..] else {
                panic!("{file}")
            };
            assert_eq!((map.columns as f64, map.rows as f64), (columns, rows), "{file}");
            assert_eq!((map.heights.len() - known.len()) as f64, gaps, "{file}");
            for (found, wanted) in map.pitch.iter().zip([pitch_x, pitch_y]) {
                match found {
                    // Nine digits, and pitches that files hold in f32.
                    Some(found) => {
                        assert!((unit * found / wanted - 1.0).abs() < 1e-6, "{file}: {found} {wanted}")
                    }
                    None => assert_eq!(wanted, 0.0, "{file}: {:?}", map.no_pitch),
                }
            }
            let found = unit * (map.heights[row as usize * map.columns + column as usize] - mean);
            assert!(
                (found - height).abs() < 1e-6 * range,
                "{file}: row {row}, column {column}: {found} {height}"
            );
        }
    }
}

/// Cut short or with some bytes changed, a scan is refused or read as a map; nothing panics, and a reason is one line.
#[test]
fn damaged_scans_are_errors_in_one_line_and_never_panic() {
    let mut state = 5_u64;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % n as u64) as usize
    };
    for file in scans().into_keys() {
        let bytes = fs::read(folder().join(&file)).expect("a scan");
        let mut answers = [0; 2];
        let mut judge = |bytes: &[u8]| {
            let needed = map_file::needed(bytes).map(|_| ());
            match needed.and_then(|()| map_file::read(bytes)) {
                Ok(map) => {
                    assert_eq!(map.heights.len(), map.columns * map.rows, "{file}");
                    answers[0] += 1;
                }
                Err(why) => {
                    let why = why.to_string();
                    assert!(!why.is_empty() && !why.contains('\n') && why.len() < 600, "{file}: {why:?}");
                    answers[1] += 1;
                }
            }
        };
        for length in (0..bytes.len()).step_by(1 + bytes.len() / 200) {
            judge(&bytes[..length]);
        }
        for _ in 0..600 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + random(3) {
                let at = if random(2) == 0 { random(bytes.len()) } else { random(bytes.len().min(700)) };
                damaged[at] = if random(2) == 0 { random(256) as u8 } else { damaged[at] ^ (1 << random(8)) };
            }
            judge(&damaged);
        }
        // Power: damage is met. Behind a checksum all of it is.
        assert!(answers[1] > 50, "{file}: {answers:?}");
    }
}

/// What each format holds that is no height map, and what to do about it.
#[test]
fn what_is_not_read_is_told_what_to_do() {
    let reason = |bytes: &[u8]| map_file::read(bytes).expect_err("must be refused").to_string();
    let scan = |file: &str| fs::read(folder().join(file)).expect("a scan");
    let changed = |file: &str, at: usize, to: &[u8]| {
        let mut bytes = scan(file);
        bytes[at..at + to.len()].copy_from_slice(to);
        reason(&bytes)
    };
    for (found, wanted) in [
        (
            reason(b"\x89HDF\r\n\x1a\n and so on"),
            "HDF5 file, as .datx and .plux are, is not read: save the map as .x3p",
        ),
        (reason(b"\x1f\x8b\x08"), "gunzip it first"),
        (reason(b"\xff\xd8\xff\xe0 a JPEG"), "none of the height maps that are read"),
        (changed("plain.sur", 18, &[5, 0]), "SUR: a series of surfaces; save one of them"),
        (changed("plain.sur", 18, &[12, 0]), "no surface (2)"),
        (changed("plain.sur", 108, &[0xff; 4]), "SUR: -1 points in a line"),
        (changed("plain.sur", 98, &[12, 0]), "12 bits a point; 16 and 32 are read"),
        (changed("iso2_int16.sdf", 5, b"3.0"), "SDF: version \"ISO-3.0\" is not read"),
        (changed("iso2_int16.sdf", 82, &[1]), "compressed data"),
        (changed("mountains_iso1_int32.sdf", 42, &[0xff, 0xff]), "do not make 65535 x 20 heights of 4 bytes"),
        (changed("metropro.dat", 218, &[0, 9]), "phase resolution 9; 0, 1 and 2 are known"),
        (changed("metropro.dat", 164, &[0; 4]), "scale factor 0"),
        (changed("by_gwyddion.gwy", 4, b"GwyDataField\0"), "no GwyContainer"),
    ] {
        assert!(found.contains(wanted), "{found}");
    }
    // Behind the checksum of the archive: as text, in a member that is not packed.
    let x3p = |from: &str, to: &str| {
        let mut archive =
            zip::ZipArchive::new(std::io::Cursor::new(scan("as_text.x3p"))).expect("an archive");
        let main = std::io::read_to_string(archive.by_name("main.xml").expect("there")).expect("text");
        let mut made = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        made.start_file("main.xml", zip::write::SimpleFileOptions::default()).expect("begun");
        std::io::Write::write_all(&mut made, main.replacen(from, to, 1).as_bytes()).expect("written");
        reason(&made.finish().expect("whole").into_inner())
    };
    for (found, wanted) in [
        (x3p(">SUR<", ">PCL<"), "X3P: a cloud of points (PCL); resample it to a surface (SUR)"),
        (
            x3p("<AxisType>I<", "<AxisType>A<"),
            "X3P: CX is absolute: the points need not lie on a grid; resample them",
        ),
        (x3p("<SizeZ>1<", "<SizeZ>3<"), "X3P: 3 layers; save one of them"),
        (x3p("<SizeX>120<", "<SizeX>121<"), "X3P: 10800 heights do not make 121 x 90"),
        (x3p("</Datum>", " 1;2</Datum>"), "1;2` is no number"),
        (x3p("<DataType>L<", "<DataType>Q<"), "CZ DataType `Q`: I, L, F or D needed"),
    ] {
        assert!(found.contains(wanted), "{found}");
    }
    let picture = |file: &str| read(file).no_pitch.expect("says so");
    assert!(picture("counts.png").contains("knows neither pitch nor unit"));
}

#[test]
fn a_channel_is_chosen_by_its_title_its_number_or_its_unit() {
    let bytes = fs::read(folder().join("two_channels.gwy")).expect("a scan");
    let choose = |channel: &str| map_file::read_channel(&bytes, Some(channel));
    let only = map_file::read(&bytes).expect("one of the two has a length");
    assert_eq!(choose("Height").expect("a title"), only);
    assert_eq!(choose("1").expect("a number"), only);
    let phase = choose("Phase").expect("a title");
    assert!(phase.no_pitch.is_some_and(|why| why.contains("one unit is given and the other is not")));
    let why = choose("Amplitude").expect_err("none of that name").to_string();
    assert!(
        why.contains("no channel `Amplitude` among 0 `Phase`, 1 `Height`: see surface.file.channel"),
        "{why}"
    );
    let sur = fs::read(folder().join("plain.sur")).expect("a scan");
    let why = map_file::read_channel(&sur, Some("Height")).expect_err("one map").to_string();
    assert!(why.contains("SUR holds one map; leave the key out"), "{why}");
}

/// A container of Gwyddion with a channel for each number, title and unit of height.
fn gwyddion(channels: &[(usize, &str, &str)]) -> Vec<u8> {
    let named = |name: &str, kind: &[u8]| [name.as_bytes(), b"\0", kind].concat();
    let text = |name: &str, value: &str| [named(name, b"s"), named(value, b"")].concat();
    let object = |name: &str, parts: &[u8]| {
        let length = u32::try_from(parts.len()).expect("short").to_le_bytes();
        [&named(name, b"")[..], &length, parts].concat()
    };
    let unit =
        |name: &str, unit: &str| [named(name, b"o"), object("GwySIUnit", &text("unitstr", unit))].concat();
    let whole = |name: &str, value: u32| [&named(name, b"i")[..], &value.to_le_bytes()].concat();
    let float = |name: &str, value: f64| [&named(name, b"d")[..], &value.to_le_bytes()].concat();
    let mut parts = Vec::new();
    for (number, title, height) in channels {
        let data: Vec<u8> = (0..4).flat_map(|k| (f64::from(k) + *number as f64).to_le_bytes()).collect();
        let field = [
            [whole("xres", 2), whole("yres", 2), float("xreal", 2e-6), float("yreal", 2e-6)].concat(),
            [unit("si_unit_xy", "m"), unit("si_unit_z", height)].concat(),
            [&named("data", b"D")[..], &4u32.to_le_bytes(), &data].concat(),
        ];
        parts.extend(named(&format!("/{number}/data"), b"o"));
        parts.extend(object("GwyDataField", &field.concat()));
        parts.extend(text(&format!("/{number}/data/title"), title));
    }
    [&b"GWYP"[..], &object("GwyContainer", &parts)].concat()
}

/// Microscopes store dozens of channels, and Gwyddion writes 10 before 2: those that may be meant are named, in their order.
#[test]
fn of_many_channels_those_of_heights_are_named() {
    let names: Vec<String> = (0..12).map(|k| format!("Phase {k}")).collect();
    let mut channels: Vec<(usize, &str, &str)> =
        (0..12).map(|k| (k, names[k].as_str(), if k == 7 { "V" } else { "" })).collect();
    let reason = |channels: &[(usize, &str, &str)]| {
        map_file::read(&gwyddion(channels)).expect_err("several").to_string()
    };
    let why = reason(&channels);
    assert!(
        why.contains("no channel has a length for its unit: name one of 0 `Phase 0`, 1 `Phase 1`")
            && why.contains("7 `Phase 7`, .. as"),
        "{why}"
    );
    channels.insert(2, (10, "Z back", "m"));
    channels.retain(|(number, title, _)| *number != 10 || *title == "Z back");
    assert_eq!(map_file::read(&gwyddion(&channels)).expect("one").heights[0], 10.0);
    channels[10] = (9, "Z", "m");
    let why = reason(&channels);
    assert!(
        why.contains("several channels of heights: name one of 9 `Z`, 10 `Z back` as surface.file.channel"),
        "{why}"
    );
    let found = map_file::read_channel(&gwyddion(&channels), Some("9")).expect("a number");
    assert_eq!((found.heights[0], found.unit_um), (9.0, Some(1e6)));
}
