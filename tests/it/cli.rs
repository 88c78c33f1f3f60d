//! Promise: the program's exit codes, what goes to stdout and stderr, and which files are written when.

use std::ffi::OsString;
use std::fs;
use std::process::Stdio;

use gonio::cli::answer;
use gonio::surface::io::import::load_patch;
use gonio::table::{realisations, store};
use serde_json::Value;
use tempfile::TempDir;

use crate::support::campaign_text::SMALL;
use crate::support::outputs::digests;
use crate::support::program::{command, exits, folder, gonio, json, stderr, stdout};

#[test]
fn a_command_answers_without_printing() {
    let words = |words: &[&str]| words.iter().map(OsString::from).collect::<Vec<_>>();
    let (ended, printed) = answer(words(&["gonio", "check", "configs/quickstart.toml", "--json"]));
    assert_eq!(ended.expect("runs"), 0);
    assert!(serde_json::from_str::<Value>(&printed.out).is_ok(), "{}", printed.out);
    let (ended, _) = answer(words(&["gonio", "fit"]));
    let error = ended.expect_err("no table");
    assert_eq!(error.exit_code(), 2);
    assert_eq!(error.to_string().lines().count(), 1, "{error}");
}

#[test]
fn help_and_version_are_answers_and_no_arguments_are_a_mistake() {
    let folder = folder(SMALL);
    for words in [&["--help"][..], &["--version"], &["check", "--help"], &["measure", "--help"]] {
        exits(&gonio(folder.path(), words), 0);
    }
    assert!(stdout(&gonio(folder.path(), &["--version"])).starts_with("gonio "));
    for words in
        [&[][..], &["measure"], &["mesure", "small.toml"], &["check", "small.toml", "--shard", "1/2"]]
    {
        let output = gonio(folder.path(), words);
        exits(&output, 2);
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{words:?}");
    }
    exits(&gonio(folder.path(), &["measure", "small.toml", "--seed", "-1"]), 2);
}

#[test]
fn check_shows_the_plan_and_writes_nothing() {
    let folder = folder(SMALL);
    let output = gonio(folder.path(), &["check", "small.toml"]);
    exits(&output, 0);
    let text = stdout(&output);
    for word in
        ["incidences", "bins", "realisations", "65,536", "524,288 in all", "memory", "time", "skipped"]
    {
        assert!(text.contains(word), "{word}: {text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    assert!(stderr(&output).is_empty());
    // What is skipped in a line; why, and what it saves, where that is asked for.
    let reasons = stdout(&gonio(folder.path(), &["check", "small.toml", "-v"]));
    let count = |text: &str| text.lines().filter(|line| line.starts_with("skipped ")).count();
    assert!(count(&text) == 1 && count(&reasons) > 3 && reasons.contains("saves"), "{reasons}");
    let answer = json(&gonio(folder.path(), &["check", "small.toml", "--json"]));
    assert_eq!((&answer["faults"], &answer["plan"]["samples"]), (&Value::Array(vec![]), &65_536.into()));
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 1);
}

#[test]
fn all_faults_are_listed_with_their_lines_and_nothing_runs() {
    let text = SMALL.replace("alpha = 0.3", "alhpa = 0.3").replace("[0, 50]", "[0, 95]");
    let folder = folder(&text);
    for verb in ["check", "measure", "surface"] {
        let output = gonio(folder.path(), &[verb, "small.toml"]);
        exits(&output, 2);
        let said = stderr(&output);
        assert!(said.lines().any(|line| line.starts_with("error: small.toml:8:")), "{said}");
        assert!(said.lines().any(|line| line.starts_with("error: small.toml:10:")), "{said}");
        let faults = said.lines().filter(|line| line.starts_with("error: ")).count();
        assert_eq!(
            said.lines().last(),
            Some(&*format!("{faults} faults in small.toml; nothing was measured"))
        );
        assert!(output.stdout.is_empty());
    }
    let output = gonio(folder.path(), &["check", "small.toml", "--json"]);
    exits(&output, 2);
    let answer = json(&output);
    assert!(output.stderr.is_empty() && answer["plan"].is_null());
    let lines: Vec<&Value> =
        answer["faults"].as_array().expect("a list").iter().map(|f| &f["line"]).collect();
    assert!(lines.contains(&&8.into()) && lines.contains(&&10.into()), "{lines:?}");
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 1);
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let folder = folder(SMALL);
    for words in [["check", "no.toml"], ["measure", "no.toml"], ["surface", "."], ["validate", "no.exr"]] {
        let output = gonio(folder.path(), &words);
        exits(&output, 3);
        assert!(stderr(&output).starts_with(&format!("error: {}: ", words[1])), "{}", stderr(&output));
    }
    exits(&gonio(folder.path(), &["validate", "small.toml"]), 3);
}

#[test]
fn results_are_the_same_bytes_for_any_number_of_threads() {
    let folder = folder(SMALL);
    let of = |threads: &str, variable: &str| {
        let out = format!("out_{threads}");
        for verb in ["measure", "surface"] {
            let mut command = command(folder.path(), &[verb, "small.toml", "--threads", threads, "-o", &out]);
            exits(&command.env("RAYON_NUM_THREADS", variable).output().expect("runs"), 0);
        }
        digests(&folder.path().join(out))
    };
    let one = of("1", "100000");
    let patches = (0..4).map(|k| format!("patch_00{k}.exr"));
    let tables = [
        "certificate.json",
        "small.card.md",
        "small.exr",
        "small.html",
        "small.json",
        "small.realisations.exr",
    ]
    .map(String::from);
    let names: Vec<String> = tables.into_iter().chain(patches).collect();
    let found: Vec<&String> = one.keys().collect();
    assert!(found.len() == names.len() && names.iter().all(|name| one.contains_key(name)), "{found:?}");
    for (threads, variable) in [("2", "abc"), ("3", "1"), ("7", "0")] {
        assert_eq!(of(threads, variable), one, "{threads} threads");
    }
}

#[test]
fn patches_of_any_side_are_measured() {
    // 33 is no power of two: no lanes serve it.
    let odd = SMALL.replace("cells = 32", "cells = 33");
    let hemisphere = "[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 12\n";
    let arm = "[sensor.arm]\ntheta_r_deg = [-40, 0, 40]\nphi_r_deg = [180]\naperture_deg = 2.0\n";
    let orders = "[trace]\nbounces = 3\n[stop]\n";
    for text in [odd.clone(), odd.replace("[stop]\n", orders), odd.replace(hemisphere, arm)] {
        let folder = folder(&text);
        exits(&gonio(folder.path(), &["measure", "small.toml", "-o", "out"]), 0);
    }
}

#[test]
fn a_finished_table_is_left_alone_and_another_needs_force() {
    let folder = folder(SMALL);
    let out = folder.path().join("out").join("small");
    let measure = |more: &[&str]| gonio(folder.path(), &[&["measure", "small.toml"], more].concat());
    let first = measure(&[]);
    exits(&first, 0);
    let report = stdout(&first);
    assert!(report.contains("albedo total") && report.contains("small.realisations.exr"), "{report}");
    assert!(report.lines().all(|line| line.chars().count() <= 100), "{report}");
    let before = digests(&out);
    let again = measure(&[]);
    exits(&again, 0);
    assert!(stdout(&again).contains("nothing to do"));
    assert_eq!(json(&measure(&["--json"]))["name"], "small");
    let other = measure(&["--seed", "6"]);
    exits(&other, 3);
    assert!(stderr(&other).contains("--force"), "{}", stderr(&other));
    assert_eq!(digests(&out), before);
    exits(&measure(&["--seed", "6", "--force"]), 0);
    assert_ne!(digests(&out)["small.exr"], before["small.exr"]);
    exits(&measure(&["--force"]), 0);
    assert_eq!(digests(&out), before);
    // Without its summary the table is unfinished: made again, without being asked.
    fs::remove_file(out.join("small.json")).expect("removed");
    exits(&measure(&[]), 0);
    assert_eq!(digests(&out), before);
    fs::write(out.join("small.exr"), b"notes of somebody").expect("written");
    exits(&measure(&[]), 3);
}

#[test]
fn an_output_folder_that_is_a_file_is_found_before_the_run() {
    let folder = folder(&SMALL.replace("65_536", "65_536_000_000"));
    fs::write(folder.path().join("taken"), b"").expect("file");
    for verb in ["measure", "surface"] {
        let output = gonio(folder.path(), &[verb, "small.toml", "-o", "taken"]);
        exits(&output, 3);
        assert!(stderr(&output).starts_with("error: taken: "), "{}", stderr(&output));
    }
}

#[test]
fn a_list_of_alphas_gives_a_table_each_and_only_the_missing_are_measured() {
    let folder = folder(&SMALL.replace("alpha = 0.3", "alpha = [0.1, 0.3]"));
    let measure = || gonio(folder.path(), &["measure", "small.toml", "-o", "out", "--json"]);
    let output = measure();
    exits(&output, 0);
    assert_eq!(json(&output).as_array().map(Vec::len), Some(2));
    let out = folder.path().join("out");
    let before = digests(&out);
    for alpha in ["0.1", "0.3"] {
        for end in ["exr", "json", "realisations.exr"] {
            assert!(before.contains_key(&format!("small_alpha_{alpha}.{end}")), "{before:?}");
        }
    }
    fs::remove_file(out.join("small_alpha_0.3.json")).expect("removed");
    exits(&measure(), 0);
    let after = digests(&out);
    assert_eq!(before["small_alpha_0.3.exr"], after["small_alpha_0.3.exr"]);
    // The very table that a campaign of this roughness alone gives, but for nothing.
    fs::write(folder.path().join("small.toml"), SMALL).expect("campaign");
    exits(&gonio(folder.path(), &["measure", "small.toml", "-o", "single"]), 0);
    assert_eq!(digests(&folder.path().join("single"))["small.exr"], after["small_alpha_0.3.exr"]);
}

#[test]
fn a_closed_pipe_ends_the_printing_and_not_the_run() {
    let folder = folder(SMALL);
    let mut child = command(folder.path(), &["measure", "small.toml", "-o", "out"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("ends");
    exits(&output, 0);
    assert!(stderr(&output).is_empty(), "{}", stderr(&output));
    assert!(folder.path().join("out/small.json").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_stdout_is_an_error() {
    let folder = folder(SMALL);
    let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
    let output = command(folder.path(), &["check", "small.toml"]).stdout(full).output().expect("runs");
    exits(&output, 3);
    assert!(stderr(&output).starts_with("error: stdout: "), "{}", stderr(&output));
}

#[test]
fn validate_reads_the_table_and_says_when_realisations_are_absent() {
    let folder = folder(SMALL);
    exits(&gonio(folder.path(), &["measure", "small.toml", "-o", "out"]), 0);
    let verdict = |words: &[&str]| {
        let output = gonio(folder.path(), &[&["validate", "out/small.exr"], words].concat());
        assert!(matches!(output.status.code(), Some(0 | 1)), "{}", stderr(&output));
        output
    };
    let whole = verdict(&["--json"]);
    assert!(!stderr(&whole).contains("absent"));
    let answer = json(&whole);
    let ok = answer["ok"].as_bool().expect("a verdict");
    assert_eq!(whole.status.code(), Some(if ok { 0 } else { 1 }));
    assert_eq!(answer["failures"].as_array().expect("a list").is_empty(), ok);
    fs::remove_file(folder.path().join("out/small.realisations.exr")).expect("removed");
    assert!(stderr(&verdict(&[])).contains("small.realisations.exr is absent"));
}

#[test]
fn surface_writes_patches_that_can_be_read_back() {
    let folder = folder(SMALL);
    let output = gonio(folder.path(), &["surface", "small.toml", "-o", "out", "--npy", "--json"]);
    exits(&output, 0);
    let certificate = json(&output);
    assert_eq!(certificate["patches"].as_array().map(Vec::len), Some(4));
    assert!(certificate["all"]["ks"].is_number());
    let patch = load_patch(&folder.path().join("out/patch_003.exr")).expect("a patch");
    assert_eq!((patch.field.cells_x(), patch.pitch_x, patch.pitch_y), (32, 1.0 / 0.3, 1.0 / 0.3));
    assert!(folder.path().join("out/patch_003.npy").exists());
    let before = digests(&folder.path().join("out"));
    let surface =
        |words: &[&str]| gonio(folder.path(), &[&["surface", "small.toml", "-o", "out"], words].concat());
    let again = surface(&["--npy"]);
    exits(&again, 0);
    assert!(stdout(&again).lines().all(|line| line.chars().count() <= 100), "{}", stdout(&again));
    assert_eq!(digests(&folder.path().join("out")), before);
    exits(&surface(&["--seed", "9"]), 3);
    assert_eq!(digests(&folder.path().join("out")), before);
    exits(&surface(&["--seed", "9", "--force"]), 0);
    let after = digests(&folder.path().join("out"));
    assert_ne!(after["patch_000.exr"], before["patch_000.exr"]);
    assert!(!after.contains_key("patch_000.npy"), "heights of another seed were left behind");
}

#[test]
fn patches_from_a_folder_give_the_same_bytes() {
    let folder = folder(SMALL);
    let measure = |words: &[&str]| gonio(folder.path(), &[&["measure", "small.toml"], words].concat());
    exits(&gonio(folder.path(), &["surface", "small.toml", "-o", "patches"]), 0);
    exits(&measure(&["-o", "made"]), 0);
    exits(&measure(&["-o", "read", "--patches", "patches"]), 0);
    let of = |name: &str| digests(&folder.path().join(name));
    assert_eq!(of("made")["small.exr"], of("read")["small.exr"]);
    // A patch that is missing is named before anything is measured, one of another size when it is read.
    fs::remove_file(folder.path().join("patches/patch_002.exr")).expect("was there");
    let missing = measure(&["-o", "none", "--patches", "patches"]);
    exits(&missing, 3);
    assert!(stderr(&missing).contains("patch_002.exr"), "{}", stderr(&missing));
    fs::write(folder.path().join("large.toml"), SMALL.replace("cells = 32", "cells = 48")).expect("campaign");
    exits(&gonio(folder.path(), &["surface", "large.toml", "-o", "patches", "--force"]), 0);
    let large = measure(&["-o", "none", "--patches", "patches"]);
    exits(&large, 3);
    assert!(stderr(&large).contains("has 48 x 48 cells, surface.cells is 32"), "{}", stderr(&large));
}

#[test]
fn the_bound_on_cells_per_ray_is_printed() {
    let folder = folder(&SMALL.replace("alpha = 0.3", "alpha = [0.3, 2]"));
    let output = gonio(folder.path(), &["surface", "small.toml", "--json"]);
    exits(&output, 0);
    let document = json(&output);
    let ranges = document["patches"].as_array().expect("patches").iter();
    let range = ranges.map(|patch| patch["height_range"].as_f64().expect("a range")).fold(0.0, f64::max);
    let bounds = document["ray_bounds"].as_array().expect("bounds");
    assert_eq!(bounds.len(), 2);
    for (bound, alpha) in bounds.iter().zip([0.3, 2.0]) {
        let edges = range * alpha * 2f64.sqrt() * 50f64.to_radians().tan() + 2.0;
        assert_eq!((bound["alpha_x"].as_f64(), bound["theta_i_deg"].as_f64()), (Some(alpha), Some(50.0)));
        // A whole number of cells, the next one above.
        let cells = bound["cells"].as_f64().expect("a number");
        assert!(cells >= edges - 1e-9 && cells < edges + 1.0, "{cells} {edges}");
    }
    let text = stdout(&gonio(folder.path(), &["surface", "small.toml"]));
    assert!(text.contains("tan(theta) + 2") && text.contains("light at 50: at most"), "{text}");
}

#[test]
fn exact_surfaces_are_patches_too() {
    let random = "realisations = 4\ncells = 32\ncorrelation_cells = 4.0\n[surface.ggx]\nalpha = 0.3\n";
    let grooves = SMALL.replace(random, "[surface.v_groove]\nslope = 0.5\n");
    let folder = folder(&grooves.replace("[light]\n", "[light]\naverage_azimuth = true\n"));
    let output = gonio(folder.path(), &["surface", "small.toml", "-o", "out", "--force"]);
    exits(&output, 0);
    let patch = load_patch(&folder.path().join("out/patch_000.exr")).expect("a patch");
    assert_eq!((patch.pitch_x, patch.field.heights()[1] / patch.pitch_x), (2.0, 0.5));
}

#[test]
fn what_a_campaign_reads_is_not_overwritten() {
    let folder = folder(SMALL);
    exits(&gonio(folder.path(), &["surface", "small.toml", "-o", "."]), 0);
    let random = "realisations = 4\ncells = 32\ncorrelation_cells = 4.0\n[surface.ggx]\nalpha = 0.3\n";
    let map = "[surface.file]\npath = \"patch_000.exr\"\nperiodic = true\n";
    let text = SMALL.replace(random, map).replace("[light]\n", "[light]\naverage_azimuth = true\n");
    fs::write(folder.path().join("map.toml"), text).expect("campaign");
    let before = fs::read(folder.path().join("patch_000.exr")).expect("readable");
    let output = gonio(folder.path(), &["surface", "map.toml", "-o", ".", "--force"]);
    exits(&output, 3);
    assert!(stderr(&output).contains("read by this campaign"), "{}", stderr(&output));
    assert_eq!(fs::read(folder.path().join("patch_000.exr")).expect("readable"), before);
}

#[test]
fn an_imported_table_is_held_to_the_laws() {
    let here = TempDir::new().expect("temporary folder");
    let csv = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n0,0,0,0,0.3\n0,0,30,180,0.2\n30,0,0,0,0.2\n30,0,30,180,0.4\n";
    std::fs::write(here.path().join("t.csv"), csv).expect("written");
    let words = ["import", "t.csv", "--from", "csv", "-o", "t.exr"];
    let imported = gonio(here.path(), &words);
    exits(&imported, 0);
    assert!(stdout(&imported).contains("2 incidences of 2 bins"), "{}", stdout(&imported));
    let again = gonio(here.path(), &words);
    exits(&again, 3);
    assert!(stderr(&again).contains("--force"), "{}", stderr(&again));
    let validated = gonio(here.path(), &["validate", "t.exr"]);
    exits(&validated, 0);
    assert!(stdout(&validated).contains("energy: not judged: points do not see"), "{}", stdout(&validated));
}

#[test]
fn export_says_how_far_the_file_is_and_under_which_convention() {
    let here = TempDir::new().expect("temporary folder");
    let csv = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n0,0,0,0,0.3\n0,0,30,180,0.2\n";
    std::fs::write(here.path().join("t.csv"), csv).expect("written");
    exits(&gonio(here.path(), &["import", "t.csv", "--from", "csv", "-o", "t.exr"]), 0);
    let exported = gonio(here.path(), &["export", "t.exr", "--to", "npz", "-o", "t.npz"]);
    exits(&exported, 0);
    for word in ["convention", "no cosine", "read back   L1 0.000e0"] {
        assert!(stdout(&exported).replace('\n', " ").contains(word), "{}", stdout(&exported));
    }
    exits(&gonio(here.path(), &["export", "t.exr", "--to", "npz", "-o", "t.npz"]), 3);
    exits(&gonio(here.path(), &["export", "t.exr", "--to", "npz", "-o", "t.npz", "--force", "--json"]), 0);
    let refused = gonio(here.path(), &["export", "t.exr", "--to", "rgl", "-o", "t.bsdf"]);
    exits(&refused, 4);
    assert!(stderr(&refused).contains("no product of polar angles and azimuths"), "{}", stderr(&refused));
    assert!(!here.path().join("t.bsdf").exists());
    exits(&gonio(here.path(), &["export", "t.exr", "--to", "mrel", "-o", "t"]), 2);
    exits(&gonio(here.path(), &["export", "t.csv", "--to", "npz", "-o", "u.npz"]), 3);
}

/// 0.00132 was printed where `measure` had said 0.00289: without the realisations counts took their place.
/// Patches of the quarter basis.
const QUARTER: usize = 41;

#[test]
fn klems_matrices_go_out_in_the_basis_that_is_asked_for() {
    let here = folder(SMALL);
    exits(&gonio(here.path(), &["measure", "small.toml", "-o", "out"]), 0);
    // Two incidences of bins as wide as 15 x 30 degrees: a matrix of patches as wide is off by more than 1 %.
    let export = |basis: &str, more: &[&str]| {
        let words = ["export", "out/small.exr", "--to", "klems", "--klems", basis, "-o", "k.xml", "--force"];
        gonio(here.path(), &[&words, more].concat())
    };
    for (basis, patches) in [("full", 145), ("half", 73), ("quarter", QUARTER)] {
        exits(&export(basis, &["--allow-albedo-error", "100"]), 0);
        let words = ["import", "k.xml", "--from", "klems", "-o", "k.exr", "--json"];
        let read = gonio(here.path(), &words);
        exits(&read, 0);
        fs::remove_file(here.path().join("k.exr")).expect("written");
        let text = fs::read_to_string(here.path().join("k.xml")).expect("written");
        let data = text.split("<ScatteringData>").nth(1).and_then(|rest| rest.split('<').next());
        let values = data.expect("one block").split(',').filter(|value| !value.trim().is_empty()).count();
        assert_eq!(values, patches * patches, "{basis}");
    }
    exits(&export("fifth", &[]), 2);
    exits(&export("half", &["--allow-albedo-error", "x"]), 2);
    let wrong =
        gonio(here.path(), &["export", "out/small.exr", "--to", "merl", "--klems", "half", "-o", "m"]);
    exits(&wrong, 2);
    assert!(stderr(&wrong).contains("--klems chooses a basis of klems, not of merl"), "{}", stderr(&wrong));
}

#[test]
fn import_reads_the_side_that_is_asked_for() {
    let here = folder("");
    let values = |value: f64| vec![value.to_string(); QUARTER * QUARTER].join(",");
    let block = |side: &str, value: f64| {
        format!(
            "<WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock>\
             <WavelengthDataDirection>Reflection {side}</WavelengthDataDirection>\
             <ColumnAngleBasis>LBNL/Klems Quarter</ColumnAngleBasis><RowAngleBasis>LBNL/Klems Quarter</RowAngleBasis>\
             <ScatteringData>{}</ScatteringData></WavelengthDataBlock></WavelengthData>",
            values(value)
        )
    };
    let file = |blocks: &str| {
        format!(
            "<WindowElement><Optical><Layer><DataDefinition><IncidentDataStructure>Columns</IncidentDataStructure>\
             </DataDefinition>{blocks}</Layer></Optical></WindowElement>"
        )
    };
    fs::write(here.path().join("both.xml"), file(&(block("Front", 0.1) + &block("Back", 0.2))))
        .expect("file");
    fs::write(here.path().join("back.xml"), file(&block("Back", 0.2))).expect("file");
    let import = |from: &str, more: &[&str]| {
        let words = ["import", from, "--from", "klems", "-o", "k.exr", "--force"];
        gonio(here.path(), &[&words, more].concat())
    };
    for (side, value) in [(&["--side", "front"][..], 0.1f32), (&["--side", "back"][..], 0.2), (&[][..], 0.2)]
    {
        exits(&import("both.xml", side), 0);
        let table = gonio::table::store::load(&here.path().join("k.exr")).expect("readable").table;
        assert!(table.colours[0].total.iter().all(|&found| found == value), "{side:?}");
    }
    exits(&import("both.xml", &["--side", "left"]), 2);
    let missing = import("back.xml", &["--side", "front"]);
    exits(&missing, 3);
    assert!(stderr(&missing).contains("Reflection Back"), "{}", stderr(&missing));
}

#[test]
fn errors_of_albedos_do_not_change_with_a_missing_file() {
    let here = folder(SMALL);
    exits(&gonio(here.path(), &["measure", "small.toml", "-o", "out"]), 0);
    let summary: Value =
        serde_json::from_slice(&fs::read(here.path().join("out/small.json")).expect("a summary"))
            .expect("JSON");
    let whole = json(&gonio(here.path(), &["validate", "out/small.exr", "--json"]));
    fs::remove_file(here.path().join("out/small.realisations.exr")).expect("was there");
    let output = gonio(here.path(), &["validate", "out/small.exr", "--json"]);
    let alone = json(&output);
    assert!(whole["energy"]["largest_albedo_se"].as_f64().expect("known") > 0.0);
    assert_eq!(whole["energy"], summary["energy"]);
    assert_eq!(alone["energy"], summary["energy"]);
    // The error of the mean of four realisations of order 1 and all others, as the summary's incidences have it.
    let incidences = summary["stops"].as_array().expect("stops");
    let largest = incidences.iter().max_by(|a, b| {
        a["albedo_total"]
            .as_f64()
            .expect("a number")
            .total_cmp(&b["albedo_total"].as_f64().expect("a number"))
    });
    let wanted = largest.expect("two stops")["albedo_total_se"].as_f64().expect("known");
    // f32 values in bins: 1e-6 of the albedo.
    assert!((alone["energy"]["largest_albedo_se"].as_f64().expect("known") - wanted).abs() < 2e-6);
    assert_eq!(whole["comparisons"], summary["comparisons"]);
    // What needs the realisations is not available, and said to be.
    assert!(whole["comparisons"][0]["l1_model_high"].is_number());
    assert!(alone["comparisons"][0]["l1_model_high"].is_null());
    assert!(alone["reciprocity"]["max_t"].is_null() && alone["reciprocity"]["limit"].is_null());
    assert!(stderr(&output).contains("small.realisations.exr is absent"));
}

#[test]
fn all_realisations_are_kept_on_demand_where_the_memory_allows() {
    // 18 x 72 bins and 9 incidences: 93 KiB a realisation and value, 720 realisations of both: 134 MB.
    let text = SMALL
        .replace("realisations = 4", "realisations = 720")
        .replace("theta_i_deg = [0, 50]", "theta_i_deg = [0, 10, 20, 30, 40, 50, 60, 70, 80]")
        .replace("theta_r_bins = 6", "theta_r_bins = 18")
        .replace("phi_r_bins = 12", "phi_r_bins = 72");
    let here = folder(&text);
    let output = gonio(here.path(), &["measure", "small.toml", "--keep-realisations", "--memory-mb", "128"]);
    exits(&output, 4);
    assert!(stderr(&output).contains("--keep-realisations: they take"), "{}", stderr(&output));
    assert_eq!(realisations::limit(true), u64::MAX);
    // The table is the same with them and without.
    let here = folder(SMALL);
    for (out, more) in [("a", &[][..]), ("b", &["--keep-realisations"][..])] {
        exits(&gonio(here.path(), &[&["measure", "small.toml", "-o", out], more].concat()), 0);
    }
    let read = |out: &str| fs::read(here.path().join(out).join("small.exr")).expect("a table");
    assert_eq!(read("a"), read("b"));
}

#[test]
fn realisations_without_some_of_their_parts_are_refused() {
    let here = folder(SMALL);
    exits(&gonio(here.path(), &["measure", "small.toml", "-o", "out"]), 0);
    let path = here.path().join("out/small.realisations.exr");
    let table = store::load(&here.path().join("out/small.exr")).expect("a table").table;
    let mut parts = realisations::load(&path).expect("realisations").realisations;
    parts.parts.pop();
    realisations::save(&path, &parts, &table, u64::MAX).expect("saved");
    let refused = gonio(here.path(), &["validate", "out/small.exr"]);
    exits(&refused, 3);
    let said = stderr(&refused);
    assert!(
        said.starts_with("error: out/small.realisations.exr: holds 3 parts of 1 realisations, "),
        "{said}"
    );
}
