//! Promise: look-up tables of OpenMATERIAL 3D are written as its schema asks, and come back.

use gonio::interchange::text::bird;
use gonio::interchange::{self, Format, Options};
use gonio::table::BrdfTable;
use serde_json::{Value, json};

use crate::support::analytic::{Ggx, hemisphere, steps, table};

/// R, G, B of a GGX at three incidences.
fn colours() -> BrdfTable {
    table(&Ggx { tint: vec![0.9, 0.5, 0.2], ..Ggx::new(0.5, 0.5) }, &hemisphere(steps(30.0, 3), None, 6, 12))
}

fn written(own: &BrdfTable, options: &Options) -> (Value, BrdfTable) {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("a.xompt");
    let back = interchange::export(own, Format::OpenMaterial, options, &path).expect("written").read_back;
    assert_eq!(back.expect("light").l1, 0.0);
    let bytes = std::fs::read(&path).expect("there");
    // Annex A of the specification: the schema is named in the second line.
    let second = bytes.split(|byte| *byte == b'\n').nth(1).expect("lines");
    let schema = b"\"$schema\":\"https://raw.githubusercontent.com/asam-ev/OpenMATERIAL-3D/refs/tags/v1.1.0/";
    assert!(second.starts_with(schema) && second.ends_with(b"/material_brdf_schema.json\","));
    let found = interchange::import(&path, Format::OpenMaterial, &Options::default(), None).expect("read").0;
    (serde_json::from_slice(&bytes).expect("JSON"), found)
}

/// What the schema of version 1.1.0 asks of a file.
fn is_valid(file: &Value) {
    let metadata = &file["metadata"];
    for key in ["name", "license", "sources"] {
        assert!(metadata[key].is_string(), "{key}: {metadata}");
    }
    for key in ["copyrights", "authors"] {
        assert!(
            metadata[key].as_array().is_some_and(|all| all.iter().all(Value::is_string)),
            "{key}: {metadata}"
        );
    }
    for key in ["materialVersion", "openMaterial3dVersion"] {
        let parts: Vec<&str> = metadata[key].as_str().expect(key).split('.').collect();
        assert!(
            parts.len() == 3 && parts.iter().all(|part| part.parse::<u32>().is_ok()),
            "{key}: {metadata}"
        );
    }
    let uuid: Vec<&str> = metadata["uuid"].as_str().expect("a UUID").split('-').collect();
    assert_eq!(uuid.iter().map(|part| part.len()).collect::<Vec<_>>(), [8, 4, 4, 4, 12]);
    assert!(uuid.concat().chars().all(|c| c.is_ascii_hexdigit()) && uuid[2].starts_with('8'), "{metadata}");
    let mut last = [-1.0; 4];
    for row in file["brdf"]["lookupTable"].as_array().expect("rows") {
        let row: Vec<f64> =
            row.as_array().expect("a row").iter().map(|n| n.as_f64().expect("a number")).collect();
        assert!(row.len() == 5 && (1e-9..=17.16e-3).contains(&row[0]) && row[4] >= 0.0, "{row:?}");
        assert!(row[1..3].iter().all(|theta| (0.0..=1_570_796.0 / 1e6).contains(theta)), "{row:?}");
        assert!((0.0..=6_283_185.0 / 1e6).contains(&row[3]), "{row:?}");
        assert!(last.as_slice() < &row[..4], "sorted: {last:?} {row:?}");
        last.copy_from_slice(&row[..4]);
    }
}

#[test]
fn tables_come_back_from_openmaterial() {
    let mut own = colours();
    for (colour, nm) in own.colours.iter_mut().zip([450.0, 550.0, 632.8]) {
        colour.wavelength_nm = Some(nm);
    }
    let (file, found) = written(&own, &Options::default());
    is_valid(&file);
    assert_eq!(file["brdf"]["wavelengths"].to_string(), "[4.5e-7,5.5e-7,6.328e-7]");
    assert_eq!(found.wavelengths_nm(), own.wavelengths_nm());
    for (a, b) in found.colours.iter().zip(&own.colours) {
        assert_eq!(a.total, b.total);
    }
    // R, G, B with the wavelengths that the user gives, of B, G, R.
    let own = colours();
    let options = Options { wavelengths_nm: vec![450.0, 550.0, 650.0], ..Options::default() };
    let (file, found) = written(&own, &options);
    is_valid(&file);
    for (k, colour) in own.colours.iter().enumerate() {
        assert_eq!(found.colours[2 - k].total, colour.total);
    }
    let refused = |own: &BrdfTable, options: &Options| {
        let folder = tempfile::tempdir().expect("folder");
        interchange::export(own, Format::OpenMaterial, options, &folder.path().join("a"))
            .expect_err("refused")
            .to_string()
    };
    assert!(
        refused(&own, &Options::default())
            .contains("R, G, B without: give 3 with --wavelengths-nm, of B, G and R")
    );
    for wavelengths_nm in [vec![650.0, 550.0, 450.0], vec![0.45, 0.55, 0.65]] {
        let wrong = Options { wavelengths_nm, ..Options::default() };
        assert!(refused(&own, &wrong).contains("increasing numbers of 100 to 1000000 nm"));
    }
    let brushed = table(&Ggx::new(0.2, 0.5), &hemisphere(steps(30.0, 3), Some(steps(45.0, 8)), 6, 12));
    let one = Options { wavelengths_nm: vec![550.0], ..Options::default() };
    assert!(refused(&brushed, &one).contains("azimuth"), "{}", refused(&brushed, &one));
}

/// Rows count from the light's azimuth, wherever that is, and angles end where the schema's numbers do.
#[test]
fn lights_at_any_azimuth_and_the_last_angles_come_back() {
    // An isotropic sample, as BiRD's files have it.
    let read = |light: [f64; 2], theta_r: &[f64], phi_r: &[f64], brdf: &[f64]| {
        let list = |unit: &str, values: &[f64]| json!({ "unit": unit, "values": values });
        let same = |unit: &str, value: f64| list(unit, &vec![value; brdf.len()]);
        let file = json!({
            "metadata": { "sample": { "properties_symmetry": "isotropic" } },
            "data": {
                "wavelength_i": same("nm", 550.0),
                "theta_i": same("deg", light[0]),
                "phi_i": same("deg", light[1]),
                "theta_r": list("deg", theta_r),
                "phi_r": list("deg", phi_r),
                "BRDF": list("1/sr", brdf),
            }
        });
        bird::read_with_notes(file.to_string().as_bytes()).expect("readable").0
    };
    let mut uuids = vec![];
    for (phi_i, phi_r, from_light) in
        [(180.0, [0.0, 200.0], [180.0, 20.0]), (10.1, [190.1, 20.2], [180.0, 10.1])]
    {
        let own = read([30.0, phi_i], &[30.0, 10.0], &phi_r, &[0.5, 0.25]);
        let (file, found) = written(&own, &Options::default());
        is_valid(&file);
        let row = |sensor: [f64; 2], value: f32| {
            let at = found.grid.points_deg.iter().position(|point| (point[1] - sensor[1]).abs() < 1e-7);
            assert_eq!(found.colours[0].total[at.expect("its azimuth")], value, "{sensor:?}");
        };
        row([30.0, from_light[0]], 0.5);
        row([10.0, from_light[1]], 0.25);
        uuids.push(file["metadata"]["uuid"].clone());
    }
    assert_ne!(uuids[0], uuids[1], "the same values in other directions");
    // 1.570796 is read as 89.99998128 degrees, whose radians are a little more.
    let text = "{\"brdf\":{\"lookupTable\":[[9.05e-07,1.570796,1.570796,6.283185,0.5]]}}";
    let last =
        interchange::decode(Format::OpenMaterial, &Options::default(), text.as_bytes()).expect("readable");
    let gonio::interchange::Imported::Table(last) = last else { panic!("a table") };
    is_valid(&written(&last, &Options::default()).0);
    let folder = tempfile::tempdir().expect("folder");
    let beyond = read([30.0, 0.0], &[30.0], &[359.999999], &[0.5]);
    let why =
        interchange::export(&beyond, Format::OpenMaterial, &Options::default(), &folder.path().join("a"));
    let why = why.expect_err("refused").to_string();
    assert!(
        why.contains("a sensor 359.999999 degrees from the light's azimuth: OpenMATERIAL's azimuths end"),
        "{why}"
    );
}

/// The form of the specification's own examples: six digits, azimuths 0 and pi, null where nothing is known.
#[test]
fn files_of_others_are_read_and_wrong_ones_name_their_row() {
    let file = |rows: &str| {
        format!("{{\"metadata\":{{}},\"brdf\":{{\"wavelengths\":[9.05e-07],\"lookupTable\":[{rows}]}}}}")
    };
    let read =
        |rows: &str| interchange::decode(Format::OpenMaterial, &Options::default(), file(rows).as_bytes());
    let rows = "[9.05e-07,0.523599,0,0,0.1],[9.05e-07,0.523599,0.785398,0,0.2],\
                [9.05e-07,0.523599,0.785398,3.141592653589793,0.4],[9.05e-07,0.523599,1.0,0.0,null]";
    let found = match read(rows).expect("readable") {
        gonio::interchange::Imported::Table(table) => table,
        _ => panic!("a table"),
    };
    assert!((found.grid.theta_i_deg[0] - 30.0).abs() < 1e-4 && found.grid.is_isotropic());
    assert_eq!(found.wavelengths_nm(), [905.0]);
    // The pair of the mirror is at pi, half a turn from the light.
    assert_eq!(found.colours[0].total, [0.1, 0.2, 0.4]);
    for (rows, said) in [
        ("[9.05e-07,0.5,0.1,0,-1]", "row 1: wavelength 0.000000905 m, BRDF -1 1/sr"),
        ("[0.9,0.5,0.1,0,1]", "row 1: wavelength 0.9 m"),
        ("[9.05e-07,null,0.1,0,1]", "row 1: a value without its wavelength or angles"),
        ("[9.05e-07,0.5,0.1,0,1],[9.05e-07,0.5,0.1,0,2]", "row 2: its directions have 1 already"),
        (
            "[9.05e-07,0.5,0.1,0,1],[8e-07,0.5,0.1,0,1],[8e-07,0.5,0.2,0,1]",
            "row 3: its directions have no value at 905 nm",
        ),
        ("[9.05e-07,0.5,0.1,0]", "no look-up table of OpenMATERIAL"),
        ("", "no samples"),
    ] {
        let why = read(rows).err().expect(said).to_string();
        assert!(why.contains(said), "{said}: {why}");
    }
}
