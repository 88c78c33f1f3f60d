//! Promise: universal BRDF files of BiRD are written as the project's schema asks, with standard uncertainties, and come
//! back; files of others are read, in their units and polarisations.

use std::f64::consts::FRAC_PI_4;

use gonio::interchange::text::bird;
use gonio::interchange::{self, Format, Imported, Options};
use gonio::table::BrdfTable;
use serde_json::{Value, json};

use crate::support::analytic::{Ggx, hemisphere, measured_looking, steps, table};
use crate::support::campaign_text::SMALL;
use crate::support::mutations;
use crate::support::program::{command, exits, folder, gonio};

fn written(own: &BrdfTable, options: &Options) -> (Value, BrdfTable, Vec<String>) {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("a.brdf");
    let export = interchange::export(own, Format::Bird, options, &path).expect("written");
    assert_eq!(export.read_back.expect("light").l1, 0.0);
    let bytes = std::fs::read(&path).expect("there");
    let found = interchange::import(&path, Format::Bird, &Options::default(), None).expect("read").0;
    (serde_json::from_slice(&bytes).expect("JSON"), found, export.notes)
}

fn read(file: &Value) -> Result<(BrdfTable, Vec<String>), String> {
    let bytes = serde_json::to_vec(file).expect("JSON");
    let found = Format::Bird.codec().decode(&bytes, &Options::default());
    match found.map_err(|why| why.to_string())? {
        (Imported::Table(table), notes) => Ok((table, notes)),
        _ => panic!("a table"),
    }
}

/// An object has these keys, and of others none but these.
fn has_keys(object: &Value, required: &[&str], others: &[&str]) {
    let keys: Vec<&str> = object.as_object().expect("an object").keys().map(String::as_str).collect();
    assert!(required.iter().all(|key| keys.contains(key)), "{required:?}: {keys:?}");
    assert!(keys.iter().all(|key| required.contains(key) || others.contains(key)), "{others:?}: {keys:?}");
}

fn are_texts(object: &Value, keys: &[&str]) {
    for key in keys {
        assert!(object[key].is_string(), "{key}: {object}");
    }
}

/// What version 1.0 of the schema asks of the metadata of a simulation: keys, words and types, written from the schema.
/// (A `name` that its text also asks for is no property of it, so that no file could have it.)
fn metadata_is_valid(metadata: &Value) {
    let required = ["schema", "id", "type", "timestamp", "provenance", "method", "instrumentation"];
    let required: Vec<&str> = required.into_iter().chain(["software", "sample", "environment"]).collect();
    has_keys(metadata, &required, &["license", "description", "data_links", "comments", "adhoc_section"]);
    are_texts(metadata, &["schema", "id", "timestamp", "description"]);
    assert_eq!((&metadata["type"], &metadata["environment"]), (&json!("BRDF"), &json!("NA")));
    assert!(["simulation", "measurement"].contains(&metadata["method"].as_str().expect("a word")));
    assert_eq!(metadata["instrumentation"], "NA");
    assert!(metadata["id"].as_str().is_some_and(|id| id.starts_with("urn:uuid:") && id.len() == 45));
    let form: String = metadata["timestamp"]
        .as_str()
        .expect("a time")
        .chars()
        .map(|c| if c.is_ascii_digit() { '0' } else { c })
        .collect();
    assert_eq!(form, "0000-00-00T00:00:00Z");
    assert!(metadata["adhoc_section"].is_object());

    let provenance = &metadata["provenance"];
    let others = ["website", "phone", "comments"];
    has_keys(provenance, &["organization", "location", "email", "contact_person"], &others);
    are_texts(provenance, &["organization", "email", "contact_person"]);
    assert!(provenance["email"].as_str().is_some_and(|email| email.contains('@')));
    let place = ["country", "city", "street", "building_nr", "postal_code"];
    has_keys(&provenance["location"], &place, &["county", "room_nr", "coordinates"]);
    are_texts(&provenance["location"], &place);

    let software = &metadata["software"];
    let common = ["description", "data_links", "comments", "adhoc_section"];
    let others: Vec<&str> = ["version", "author", "simulation_model"].into_iter().chain(common).collect();
    has_keys(software, &["name"], &others);
    are_texts(software, &["name", "version", "description"]);
    if let Some(model) = software.get("simulation_model") {
        let others = ["equation", "parameters", "data_links", "comments", "adhoc_section"];
        has_keys(model, &["name", "description"], &others);
        for parameter in model["parameters"].as_array().expect("a list") {
            has_keys(parameter, &["name", "description", "value", "unit"], &["symbol", "comments"]);
            are_texts(parameter, &["name", "description", "unit"]);
            assert!(parameter["value"].is_number());
        }
    }

    let sample = &metadata["sample"];
    let required = ["name", "type", "dimensions", "shape", "zero_azimuth_location"];
    has_keys(sample, &required, &["properties_symmetry", "comments", "adhoc_section"]);
    are_texts(sample, &["name", "type", "shape", "zero_azimuth_location"]);
    assert!(sample["dimensions"].is_object());
}

/// The same of its data: a unit and numbers within their ranges for each variable, as many of each.
fn data_is_valid(data: &Value) {
    let required = ["theta_i", "phi_i", "theta_r", "phi_r", "BRDF"];
    has_keys(data, &required, &["uBRDF", "wavelength_i", "wavelength_r"]);
    let count = data["BRDF"]["values"].as_array().expect("a list").len();
    for (name, units, end) in [
        ("theta_i", &["rad", "deg", "\u{b0}"][..], 90.0),
        ("theta_r", &["rad", "deg", "\u{b0}"], 90.0),
        ("phi_i", &["rad", "deg", "\u{b0}"], 360.0),
        ("phi_r", &["rad", "deg", "\u{b0}"], 360.0),
        ("BRDF", &["1/sr", "sr^-1"], f64::INFINITY),
        ("uBRDF", &["1/sr", "sr^-1", "%"], f64::INFINITY),
        ("wavelength_i", &["nm", "\u{3bc}m"], f64::INFINITY),
    ] {
        let Some(variable) = data.get(name) else { continue };
        has_keys(variable, &["unit", "values"], &["name", "description", "uncertainty", "comments"]);
        assert!(units.contains(&variable["unit"].as_str().expect("a unit")), "{name}");
        let values = variable["values"].as_array().expect("a list");
        assert_eq!(values.len(), count, "{name}");
        // Of radians the schema's ends are others; degrees are written.
        let inside = |value: &Value| value.as_f64().is_some_and(|value| (0.0..end).contains(&value));
        assert!(values.iter().all(inside), "{name}");
    }
}

fn is_valid(file: &Value) {
    has_keys(file, &["metadata", "data"], &[]);
    metadata_is_valid(&file["metadata"]);
    data_is_valid(&file["data"]);
}

#[test]
fn tables_come_back_from_bird() {
    // Anisotropic, three wavelengths, with a standard error at every value.
    let grid = hemisphere(steps(30.0, 3), Some(steps(45.0, 8)), 6, 12);
    let mut own = measured_looking(&Ggx { tint: vec![0.9, 0.5, 0.2], ..Ggx::new(0.2, 0.5) }, &grid);
    own.campaign =
        "name = \"brushed\"\nseed = 7\n[surface]\npitch_um = 0.5\n[surface.ggx]\nalpha_x = 0.2\n".into();
    for (colour, nm) in own.colours.iter_mut().zip([632.8, 450.0, 550.0]) {
        colour.wavelength_nm = Some(nm);
    }
    let (file, found, notes) = written(&own, &Options::default());
    is_valid(&file);
    assert!(notes.len() == 1 && notes[0].contains("provenance says NA"), "{notes:?}");
    assert_eq!(found.wavelengths_nm(), [450.0, 550.0, 632.8]);
    assert!(!found.grid.is_isotropic());
    for (k, colour) in [1, 2, 0].into_iter().enumerate() {
        assert_eq!(found.colours[k].total, own.colours[colour].total);
        assert_eq!(found.colours[k].stderr, own.colours[colour].stderr);
    }
    assert_eq!((found.grid.incidences(), found.grid.bins()), (own.grid.incidences(), own.grid.bins()));
    // What the campaign says is in the schema's own fields, units by the ends of its keys.
    let metadata = &file["metadata"];
    assert_eq!((&metadata["method"], &metadata["sample"]["name"]), (&json!("simulation"), &json!("brushed")));
    let parameters = metadata["software"]["simulation_model"]["parameters"].as_array().expect("a list");
    let of = |name: &str| parameters.iter().find(|one| one["name"] == name).expect(name);
    assert_eq!(of("surface.pitch_um")["unit"], "\u{3bc}m");
    assert_eq!(of("surface.ggx.alpha_x")["value"], 0.2);
    assert_eq!(metadata["adhoc_section"]["campaign"], own.campaign.as_str());
}

#[test]
fn isotropic_tables_and_colours_without_wavelengths() {
    // One channel needs no wavelength; without errors at every value there is no uBRDF.
    let own = table(&Ggx::new(0.5, 0.5), &hemisphere(steps(30.0, 3), None, 6, 12));
    let (file, found, notes) = written(&own, &Options::default());
    is_valid(&file);
    assert!(file["data"].get("uBRDF").is_none() && file["data"].get("wavelength_i").is_none());
    assert!(notes.iter().any(|note| note.contains("method says measurement")), "{notes:?}");
    assert!(notes.iter().any(|note| note.contains("no uBRDF")), "{notes:?}");
    assert_eq!(file["metadata"]["sample"]["properties_symmetry"], "isotropic");
    assert!(found.grid.is_isotropic() && !found.is_spectral());
    assert_eq!(found.colours[0].total, own.colours[0].total);
    assert!(found.colours[0].stderr.iter().all(|error| *error == -1.0));
    // R, G, B take the wavelengths that the user gives, of B, G, R.
    let own = table(&Ggx { tint: vec![0.9, 0.5, 0.2], ..Ggx::new(0.5, 0.5) }, &own.grid);
    let options = Options { wavelengths_nm: vec![450.0, 550.0, 650.0], ..Options::default() };
    let (file, found, _) = written(&own, &options);
    is_valid(&file);
    for (k, colour) in own.colours.iter().enumerate() {
        assert_eq!(found.colours[2 - k].total, colour.total);
    }
    let folder = tempfile::tempdir().expect("folder");
    let refused = |own: &BrdfTable| {
        let path = folder.path().join("a");
        interchange::export(own, Format::Bird, &Options::default(), &path).expect_err("refused").to_string()
    };
    assert!(refused(&own).contains("BiRD's rows have a wavelength, the table has R, G, B without: give 3"));
    let grazing = crate::support::analytic::points(vec![0.0], vec![0.0], &[0.0, 90.0], &[0.0, 180.0]);
    let why = refused(&table(&Ggx::new(0.5, 0.5), &grazing));
    assert!(why.contains("a polar angle of 90 degrees: the schema's end below 90"), "{why}");
}

/// The numbers of the project's example: Spectralon under s- and p-polarised light in turn, at normal incidence.
fn example() -> Value {
    let s = json!([1, 1, 0, 0]);
    let p = json!([1, -1, 0, 0]);
    let of = |value: f64| vec![value; 8];
    json!({
        "metadata": { "sample": { "name": "SRT1", "properties_symmetry": "isotropic" } },
        "data": {
            "wavelength_i": { "unit": "nm", "values": [550, 550, 650, 650, 750, 750, 850, 850] },
            "polarization_i": { "notation": "inStokes", "values": [s, p, s, p, s, p, s, p] },
            "theta_i": { "unit": "\u{b0}", "values": of(0.0) },
            "phi_i": { "unit": "\u{b0}", "values": of(0.0) },
            "theta_r": { "unit": "\u{b0}", "values": of(10.0) },
            "phi_r": { "unit": "\u{b0}", "values": of(60.0) },
            "BRDF": {
                "unit": "sr^-1",
                "values": [0.254, 0.263, 0.267, 0.273, 0.281, 0.295, 0.296, 0.301]
            },
        }
    })
}

#[test]
fn the_projects_example_is_read() {
    let (found, notes) = read(&example()).expect("readable");
    assert_eq!(found.wavelengths_nm(), [550.0, 650.0, 750.0, 850.0]);
    assert!(found.grid.is_isotropic() && found.grid.points_deg == [[10.0, 60.0]]);
    // Unpolarised light is half s, half p.
    let mean = |s: f64, p: f64| (0.5 * (s + p)) as f32;
    let wanted = [mean(0.254, 0.263), mean(0.267, 0.273), mean(0.281, 0.295), mean(0.296, 0.301)];
    assert_eq!(found.colours.iter().map(|colour| colour.total[0]).collect::<Vec<_>>(), wanted);
    assert!(notes.len() == 1 && notes[0].contains("opposite polarisations"), "{notes:?}");
    // What is isotropic and yet lit from several azimuths keeps them.
    let mut turned = example();
    let data = turned["data"].as_object_mut().expect("an object");
    for variable in data.values_mut() {
        let values = variable["values"].as_array_mut().expect("a list");
        values.extend(values.clone());
    }
    for at in 8..16 {
        data["phi_i"]["values"][at] = json!(90);
        data["phi_r"]["values"][at] = json!(150);
    }
    let (several, notes) = read(&turned).expect("readable");
    assert!(!several.grid.is_isotropic() && several.grid.azimuths() == 2);
    assert!(notes.iter().any(|note| note.contains("light of several azimuths")), "{notes:?}");
    // A text stands wherever nothing is known.
    for (metadata, isotropic) in [
        (json!({ "sample": "NA" }), false),
        (json!({ "sample": { "properties_symmetry": "Isotropic" } }), true),
    ] {
        let mut other = example();
        other["metadata"] = metadata;
        assert_eq!(read(&other).expect("readable").0.grid.is_isotropic(), isotropic);
    }
    // The same in letters.
    let mut letters = example();
    letters["data"]["polarization_i"] =
        json!({ "notation": "sp", "values": ["s", "p", "s", "p", "s", "p", "s", "p"] });
    assert_eq!(read(&letters).expect("readable").0, found);
}

/// Two directions as institutes list them (45:0 and the mirror pair, half a turn from the light), in other units.
fn pair() -> Value {
    json!({ "data": {
        "wavelength_i": { "unit": "\u{3bc}m", "values": [0.55, 0.55] },
        "wavelength_r": { "unit": "nm", "values": [550, 550] },
        "polarization_i": { "notation": "sp", "values": ["u", "u"] },
        "polarization_r": { "notation": "inStokes", "values": [[1, 0, 0, 0], [1, 0, 0, 0]] },
        "theta_i": { "unit": "rad", "values": [FRAC_PI_4, FRAC_PI_4] },
        "phi_i": { "unit": "rad", "values": [0, 0] },
        "theta_r": { "unit": "rad", "values": [0, FRAC_PI_4] },
        "phi_r": { "unit": "deg", "values": [0, 180] },
        "BRDF": { "unit": "1/sr", "values": [0.25, 0.5], "uncertainty": { "value": 2, "unit": "%" } },
    }})
}

#[test]
fn units_and_uncertainties_of_others_are_read() {
    let (found, notes) = read(&pair()).expect("readable");
    assert!(notes.is_empty(), "{notes:?}");
    assert_eq!((found.wavelengths_nm(), found.grid.theta_i_deg.clone()), (vec![550.0], vec![45.0]));
    assert_eq!(found.grid.points_deg, [[0.0, 0.0], [45.0, 180.0]]);
    // Two per cent of each value.
    assert_eq!(found.colours[0].stderr, [0.005, 0.01]);
    let mut listed = pair();
    listed["data"]["uBRDF"] = json!({ "unit": "sr^-1", "values": [0.001, 0.125] });
    assert_eq!(read(&listed).expect("readable").0.colours[0].stderr, [0.001, 0.125]);
    listed["data"]["adhoc_variables"] = json!({ "spot": { "unit": "mm", "values": [1, 2] } });
    assert_eq!(read(&listed).expect("readable").1, ["adhoc_variables are not read"]);
    // What varies there may be what tells two rows apart.
    for angle in ["theta_r", "phi_r"] {
        listed["data"][angle]["values"] = json!([0, 0]);
    }
    let why = read(&listed).expect_err("two values of one pair");
    assert!(why.ends_with("and 0.5 here (adhoc_variables are not read)"), "{why}");
}

#[test]
fn wrong_bird_files_name_their_value() {
    let with = |key: &str, value: Value| {
        let mut file = pair();
        file["data"][key] = value;
        file
    };
    let values = |unit: &str, values: Value| json!({ "unit": unit, "values": values });
    for (file, said) in [
        (json!({ "data": {} }), "data.BRDF is missing: theta_i, phi_i, theta_r, phi_r and BRDF needed"),
        (json!({ "data": { "variables": [], "values": [] } }), "data.variables is of a draft of the format"),
        (json!({}), "no BRDF file of BiRD: missing field `data`"),
        // Before the drafts: lists of numbers by themselves.
        (json!({ "data": { "theta_i": [0], "theta_v": [10] } }), "data.theta_v is of BiRD's first files"),
        (with("theta_i", Value::Null), "data.theta_i is missing"),
        (with("theta_i", values("gon", json!([1, 2]))), "data.theta_i.unit = gon: deg, \u{b0}, rad needed"),
        (
            with("theta_i", values("deg", json!([1]))),
            "data.theta_i has 1 values, data.BRDF 2: as many needed",
        ),
        (with("theta_r", values("deg", json!([1, 95]))), "value 2 of theta_r: 95 degrees: 0 to 90 needed"),
        (with("BRDF", values("1/sr", json!([0.1, -1]))), "value 2 of BRDF: -1 1/sr: 0 or more needed"),
        (with("BRDF", values("1/sr", json!([0.1, 1e39]))), "value 2 of BRDF"),
        (with("uBRDF", values("sr", json!([1, 1]))), "the unit sr of an uncertainty of BRDF"),
        (with("uBRDF", values("%", json!([1, -1]))), "value 2: uncertainty -0.005: 0 or more needed"),
        (with("uBRDF", values("%", json!([1]))), "data.uBRDF has 1 values"),
        (
            with("wavelength_i", values("nm", json!([550, 0.5]))),
            "value 2 of wavelength_i: 0.5 nm: 1 to 20000000 needed",
        ),
        (with("wavelength_i", values("nm", json!([550, 560]))), "value 2: light of 560 nm is seen at 550 nm"),
        (
            with("polarization_r", json!({ "values": ["u", "s"] })),
            "value 2 of polarization_r: light seen behind",
        ),
        (
            with("polarization_i", json!({ "values": ["u", "s"] })),
            "value 2: polarised light without its opposite",
        ),
        (
            with("polarization_i", json!({ "values": ["u", "q"] })),
            "value 2 of polarization_i: q: s, p or u needed",
        ),
        (with("polarization_i", json!({ "values": ["u", [2, 0, 0, 0]] })), "1 and three of -1 to 1 needed"),
        (with("polarization_i", json!({ "values": ["u"] })), "data.polarization_i has 1 values"),
    ] {
        let why = read(&file).expect_err(said);
        assert!(why.contains(said), "{said}: {why}");
    }
    let mut empty = pair();
    for variable in empty["data"].as_object_mut().expect("an object").values_mut() {
        variable["values"] = json!([]);
    }
    assert!(read(&empty).expect_err("refused").contains("no samples"));
}

#[test]
fn bird_is_read_in_every_encoding_and_survives_damage() {
    let (wanted, _) = read(&example()).expect("readable");
    let text = example().to_string();
    let marked = format!("\u{feff}{text}");
    let wide: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [marked.into_bytes(), wide] {
        assert!(bird::read_with_notes(&bytes).expect("read").0 == wanted);
    }
    for file in [example(), pair()] {
        let text = file.to_string();
        assert!(mutations::survives(text.as_bytes(), 20_000, bird::read_with_notes) > 2_000);
    }
}

/// The date is the only thing that changes from one export to the next.
#[test]
fn a_date_that_is_set_gives_the_same_bytes() {
    let folder = folder(SMALL);
    exits(&gonio(folder.path(), &["measure", "small.toml", "-o", "."]), 0);
    let export = |name: &str| {
        let mut export = command(folder.path(), &["export", "small.exr", "--to", "bird", "-o", name]);
        exits(&export.env("SOURCE_DATE_EPOCH", "1000000000").output().expect("runs"), 0);
        std::fs::read_to_string(folder.path().join(name)).expect("written")
    };
    let text = export("a.brdf");
    assert!(text.contains("2001-09-09T01:46:40Z"));
    assert_eq!(text, export("b.brdf"));
}
