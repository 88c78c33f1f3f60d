//! A campaign file with faults names them all: where, which key, what was written, what is allowed.

use std::path::Path;

use gonio::campaign::{self, Alpha, Azimuth, Optics, PhiFrom, SensorArm, SurfaceKind};
use gonio::error::{Error, Fault};

use crate::support::campaign_text::{ARM, FILE, GOOD, accepted, on, parse, with, with_arm};

fn faults(text: impl AsRef<[u8]>) -> Vec<Fault> {
    match parse(text) {
        Err(Error::Campaign(faults)) => faults,
        other => panic!("expected faults, got {other:?}"),
    }
}

/// The text must have one fault: of `key`, on the line that starts with `line`, with `phrase` in its advice.
#[track_caller]
fn one_fault(text: &str, line: &str, key: &str, phrase: &str) {
    let found = faults(text);
    let listed = Error::Campaign(found.clone()).to_string();
    assert_eq!(found.len(), 1, "{listed}\n{text}");
    let expected_line = text.lines().position(|l| l.starts_with(line)).map(|n| n + 1);
    assert!(expected_line.is_some(), "no line starts with {line:?}");
    assert_eq!((found[0].key.as_str(), found[0].line), (key, expected_line), "{listed}\n{text}");
    assert!(found[0].allowed.contains(phrase), "{listed} lacks {phrase:?}");
    assert_eq!(found[0].path, "c.toml");
    assert!(!listed.contains('\n'), "{listed}");
}

/// Rows of (text in `GOOD`, its replacement, key, phrase); the fault is on the replacement's line.
#[track_caller]
fn each_row_is_one_fault(rows: &[(&str, &str, &str, &str)]) {
    for (old, new, key, phrase) in rows {
        one_fault(&with(old, new), new.lines().next().unwrap_or_default(), key, phrase);
    }
}

#[test]
fn the_good_campaign_has_no_faults_and_no_notes() {
    assert_eq!(accepted(GOOD).notes, Vec::<String>::new());
}

#[test]
fn a_fault_shows_the_value_as_it_was_written() {
    let found = faults(with("alpha = 0.2", "  alpha = 0.000_05"));
    assert_eq!(
        found[0].to_string(),
        "c.toml:10:3: surface.ggx.alpha = 0.000_05: must lie in [1e-4, 10]; a smooth mirror has no lobe to measure"
    );
}

#[test]
fn alpha_outside_its_range_is_refused() {
    let range = "must lie in [1e-4, 10]";
    let key = "surface.ggx.alpha";
    each_row_is_one_fault(&[
        ("alpha = 0.2", "alpha = nan", key, "must be finite"),
        ("alpha = 0.2", "alpha = inf", key, "must be finite"),
        ("alpha = 0.2", "alpha = -inf", key, "must be finite"),
        ("alpha = 0.2", "alpha = 0", key, "a smooth mirror has no lobe to measure"),
        ("alpha = 0.2", "alpha = -0.0", key, range),
        ("alpha = 0.2", "alpha = -0.3", key, range),
        ("alpha = 0.2", "alpha = 1e-400", key, "a smooth mirror has no lobe to measure"),
        ("alpha = 0.2", "alpha = 1e400", key, "must be finite"),
        ("alpha = 0.2", "alpha = 5e-5", key, range),
        ("alpha = 0.2", "alpha = 1e6", key, range),
        ("alpha = 0.2", "alpha = 99999999999999999999999999999999999999999999", key, "must be finite"),
        ("alpha = 0.2", "alpha = \"0.2\"", key, "must be a number; this is a string"),
        ("alpha = 0.2", "alpha = true", key, "must be a number; this is a boolean"),
        ("alpha = 0.2", "alpha = 1979-05-27", key, "this is a datetime"),
        ("alpha = 0.2", "alpha = []", key, "must not be empty"),
        ("alpha = 0.2", "alpha = [0.1, 0.1]", key, "must increase"),
        ("alpha = 0.2", "alpha = [0.2, 0.1]", key, "comes after 0.2"),
        ("alpha = 0.2", "alpha = [0.1, nan]", key, "must be finite"),
    ]);
}

#[test]
fn alpha_has_one_spelling() {
    let heading = "[surface.ggx]";
    let lone = with("alpha = 0.2", "alpha_x = 0.2");
    one_fault(&lone, heading, "surface.ggx.alpha_y", "required next to alpha_x");
    let lone = with("alpha = 0.2", "alpha_y = 0.2");
    one_fault(&lone, heading, "surface.ggx.alpha_x", "required next to alpha_y");
    one_fault(&with("alpha = 0.2", ""), heading, "surface.ggx.alpha", "required");
    let both = with("alpha = 0.2", "alpha = 0.2\nalpha_x = 0.1");
    one_fault(&both, "alpha = ", "surface.ggx.alpha", "ambiguous");
    let list = with("alpha = 0.2", "alpha_x = [0.1]\nalpha_y = 0.2");
    one_fault(&list, "alpha_x", "surface.ggx.alpha_x", "must be a number");
}

#[test]
fn an_unknown_key_is_refused_with_the_nearest_name() {
    let text = with("alpha = 0.2", "alpha = 0.2\nalhpa = 0.3");
    one_fault(&text, "alhpa", "surface.ggx.alhpa", "did you mean `alpha`?");
    let text = with("rotation_deg = 0.0", "Rotation_deg = 0.0");
    one_fault(&text, "Rotation", "surface.Rotation_deg", "did you mean `rotation_deg`?");
    let text = with("seed = 7", "sed = 7");
    one_fault(&text, "sed", "sed", "did you mean `seed`?");
    let text = with("seed = 7", "colour = 7");
    one_fault(&text, "colour", "colour", "known here: name, seed");
    let text = with("seed = 7", "seed = 7\nsamples = 7");
    one_fault(&text, "samples", "samples", "; samples belongs in [stop]");
}

#[test]
fn a_slip_is_one_fault() {
    let text = with("alpha = 0.2", "alhpa = 0.3");
    one_fault(&text, "alhpa", "surface.ggx.alhpa", "did you mean `alpha`?");
    let text = with("[sensor.hemisphere]", "[sensor.hemispher]");
    one_fault(&text, "[sensor.hemispher]", "sensor.hemispher", "did you mean `hemisphere`?");
    let text = with("[surface.ggx]\nalpha = 0.2", "model = \"ggx\"");
    one_fault(&text, "model", "surface.model", "did you mean [surface.ggx]?");
    let text = with("alpha = 0.2", "alpha = 0.2\n\"a\\nb\" = 0.3");
    one_fault(&text, "\"a", "surface.ggx.a b", "unknown key");
}

#[test]
fn text_that_is_not_toml_is_one_fault_with_its_line() {
    for wrong in
        ["alpha = .5", "alpha = 1,5", "alpha = 5.", "alpha = \"x", "alpha = 0.1\u{0}", "alpha = 0.1\u{1}"]
    {
        let found = faults(with("alpha = 0.2", wrong));
        assert_eq!(
            (found.len(), found[0].key.as_str(), found[0].line),
            (1, "surface.ggx.alpha", Some(10)),
            "{wrong}"
        );
    }
    let shown = faults(with("alpha = 0.2", "alpha = 1,5"))[0].to_string();
    assert!(shown.starts_with("c.toml:10:10: surface.ggx.alpha = 1,5: "), "{shown}");
    let text = with("alpha = 0.2", "alpha = 0.2\nalpha = 0.3");
    one_fault(&text, "alpha = 0.3", "surface.ggx.alpha", "duplicate");
    let text = with("[expect]", "[stop]");
    assert_eq!(faults(text)[0].key, "TOML");
}

#[test]
fn deep_nesting_is_refused_without_a_stack_overflow() {
    let brackets = format!("seed = {}", "[".repeat(100_000));
    assert_eq!(faults(brackets)[0].line, Some(1));
    let dots = format!("a{} = 1", ".a".repeat(100_000));
    assert!(!faults(dots).is_empty());
}

#[test]
fn an_empty_file_names_the_required_keys() {
    for text in ["", "\n\n# nothing\n"] {
        let found = faults(text);
        let keys: Vec<&str> = found.iter().map(|f| f.key.as_str()).collect();
        assert_eq!(keys, ["name", "surface", "light.theta_i_deg", "sensor", "stop.samples"]);
        assert!(found.iter().all(|f| f.allowed.contains("required") && f.line.is_none()));
    }
}

#[test]
fn bytes_that_are_not_utf8_are_refused_with_their_offset() {
    let mut bytes = GOOD.as_bytes().to_vec();
    bytes[20] = 0xff;
    let found = faults(&bytes);
    assert_eq!((found.len(), found[0].line), (1, Some(2)));
    assert!(found[0].allowed.contains("byte 20 is not UTF-8"), "{}", found[0]);
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_change_nothing() {
    let windows = format!("\u{feff}{}", GOOD.replace('\n', "\r\n"));
    assert_eq!(accepted(&windows), accepted(GOOD));
    let found = faults(windows.replace("name", "nome"));
    assert_eq!((found[0].line, found[0].column), (Some(1), Some(1)));
    let found = faults(windows.replace("alpha = 0.2", "alpha = 0"));
    assert_eq!((found[0].line, found[0].column), (Some(10), Some(1)));
}

#[test]
fn utf16_with_its_mark_is_read_like_utf8() {
    let wide = |text: &str, bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(bytes).collect()
    };
    for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        assert_eq!(parse(wide(GOOD, bytes)).expect("accepted"), accepted(GOOD));
        let found = faults(wide(&GOOD.replace("alpha = 0.2", "alpha = 0"), bytes));
        assert_eq!((found[0].line, found[0].column), (Some(10), Some(1)));
    }
    let mut odd = wide(GOOD, u16::to_le_bytes);
    odd.pop();
    let found = faults(odd);
    assert!(found[0].allowed.contains("UTF-16 with half a character at its end"), "{}", found[0]);
}

#[test]
fn a_huge_file_is_refused() {
    let found = faults(vec![b'\n'; (16 << 20) + 1]);
    assert!(found[0].allowed.contains("16 MiB"));
}

#[test]
fn a_file_that_cannot_be_read_is_an_input_error() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("missing.toml"), folder.path().to_path_buf()] {
        let error = campaign::read(&path).unwrap_err();
        assert_eq!(error.exit_code(), 3, "{error}");
        assert!(error.to_string().contains(path.to_str().unwrap()));
    }
    let path = folder.path().join("c.toml");
    std::fs::write(&path, on(FILE).replace("[light]", "[light]\naverage_azimuth = true")).unwrap();
    let SurfaceKind::File(map) = campaign::read(&path).unwrap().campaign.surface.kind else { panic!() };
    assert_eq!(map.resolved_path, folder.path().join("scan.npy"));
    std::fs::write(&path, "").unwrap();
    assert_eq!(campaign::read(&path).unwrap_err().exit_code(), 2);
}

#[test]
fn counts_take_whole_numbers_only() {
    let samples = "samples = 1_000_000";
    let key = "stop.samples";
    let whole = "must be a whole number in [1, 1099511627776]";
    each_row_is_one_fault(&[
        (samples, "samples = 0", key, whole),
        (samples, "samples = -1", key, whole),
        (samples, "samples = 1.5e0", key, whole),
        (samples, "samples = 1e300", key, whole),
        (samples, "samples = nan", key, whole),
        (samples, "samples = 18446744073709551615", key, whole),
        (samples, "samples = 340282366920938463463374607431768211456", key, whole),
        (samples, "samples = \"many\"", key, "this is a string"),
        ("seed = 7", "seed = -1", "seed", "[0, 18446744073709551615]"),
        ("seed = 7", "seed = 18446744073709551616", "seed", "[0, 18446744073709551615]"),
        ("realisations = 4", "realisations = 0", "surface.realisations", "[1, 4096]"),
        ("realisations = 4", "realisations = 4097", "surface.realisations", "[1, 4096]"),
        ("cells = 256", "cells = 0", "surface.cells", "[8, 16384]"),
        ("cells = 256", "cells = 2", "surface.cells", "[8, 16384]"),
        ("cells = 256", "cells = 1048576", "surface.cells", "[8, 16384]"),
        ("correlation_cells = 8.0", "correlation_cells = 1.9", "surface.correlation_cells", "[2, 32]"),
        ("correlation_cells = 8.0", "correlation_cells = 33", "surface.correlation_cells", "[2, 32]"),
        ("theta_r_bins = 18", "theta_r_bins = 0", "sensor.hemisphere.theta_r_bins", "[1, 9000]"),
        ("phi_r_bins = 36", "phi_r_bins = 36001", "sensor.hemisphere.phi_r_bins", "[1, 36000]"),
        ("bounces = 1", "bounces = 0", "trace.bounces", "[1, 10000]"),
        ("bounces = 1", "bounces = 1_000_000_000", "trace.bounces", "[1, 10000]"),
    ]);
    assert_eq!(accepted(&with(samples, "samples = 1e6")).campaign.stop.samples, 1_000_000);
    assert_eq!(accepted(&with("seed = 7", "seed = 0")).campaign.seed, 0);
    assert_eq!(accepted(&with("seed = 7", "")).campaign.seed, 1);
    assert_eq!(accepted(&with("seed = 7", "seed = 18446744073709551615")).campaign.seed, u64::MAX);
}

#[test]
fn light_angles_outside_the_arm_are_refused() {
    let theta = "theta_i_deg = [0, 15, 30]";
    let key = "light.theta_i_deg";
    each_row_is_one_fault(&[
        (theta, "theta_i_deg = [0, 90]", key, "the light arm stops below 90"),
        (theta, "theta_i_deg = [-5, 0]", key, "must lie in [0, 90)"),
        (theta, "theta_i_deg = [0, 180]", key, "the light arm stops below 90"),
        (theta, "theta_i_deg = [nan]", key, "must be finite"),
        (theta, "theta_i_deg = []", key, "must not be empty"),
        (theta, "theta_i_deg = [0, 15, 15]", key, "is there twice"),
        (theta, "theta_i_deg = [0, 30, 15]", key, "15 comes after 30"),
        (theta, "theta_i_deg = 30", key, "must be a list such as"),
        (theta, "theta_i_deg = [\"0\"]", key, "must be a number"),
        (theta, "theta_i_deg = [[0]]", key, "must be a number"),
        ("aperture_deg = 0.0", "aperture_deg = 46", "light.aperture_deg", "must lie in [0, 45]"),
        ("aperture_deg = 0.0", "aperture_deg = -1", "light.aperture_deg", "must lie in [0, 45]"),
        ("aperture_deg = 0.0", "aperture_deg = nan", "light.aperture_deg", "must be finite"),
    ]);
    assert_eq!(accepted(&with(theta, "theta_i_deg = [89.99]")).campaign.light.theta_i_deg, [89.99]);
    let cone = with("30]\naperture_deg = 0.0", "50]\naperture_deg = 40");
    one_fault(&cone, "aperture_deg", "light.aperture_deg", "must stay below 90");
}

#[test]
fn ranges_are_checked() {
    let theta = "theta_i_deg = [0, 15, 30]";
    let key = "light.theta_i_deg";
    let (to, step) = ("light.theta_i_deg.to", "light.theta_i_deg.step");
    each_row_is_one_fault(&[
        (theta, "theta_i_deg = { from = 30, to = 0, step = 5 }", to, "must not lie below from = 30"),
        (theta, "theta_i_deg = { from = 0, to = 30, step = 0 }", step, "must lie in (0, 1e6]"),
        (theta, "theta_i_deg = { from = 0, to = 30, step = -5 }", step, "must lie in (0, 1e6]"),
        (theta, "theta_i_deg = { from = 0, to = 30, step = nan }", step, "must be finite"),
        (theta, "theta_i_deg = { from = 0, to = 30, step = 1e-9 }", key, "more than 100000 points"),
        (theta, "theta_i_deg = { from = 0, to = 30, step = 1e-320 }", key, "more than 100000 points"),
        (theta, "theta_i_deg = { from = 45, to = 45.0000000000001, count = 100 }", key, "there twice"),
        (theta, "theta_i_deg = { from = 0, to = 90, step = 15 }", to, "the light arm stops below 90"),
        (theta, "theta_i_deg = { from = -5, to = 30, step = 5 }", "light.theta_i_deg.from", "[0, 90)"),
        (theta, "theta_i_deg = { from = 0, to = 30 }", step, "required"),
        (theta, "theta_i_deg = { from = 0, to = 80, step = 7 }", to, "end at 77 or 84, or give count"),
        (
            theta,
            "theta_i_deg = { from = 0, to = 30, step = 5, count = 7 }",
            "light.theta_i_deg.count",
            "never both",
        ),
        (theta, "theta_i_deg = { from = 0, to = 30, count = 1 }", "light.theta_i_deg.count", "at least 2"),
        (theta, "theta_i_deg = { from = 0, to = 30, count = 0 }", "light.theta_i_deg.count", "[1, "),
        (theta, "theta_i_deg = { from = 0, to = 30, count = 200_000 }", key, "more than 100000 points"),
        ("seed = 7", "seed = { from = 1, to = 9, step = 2 }", "seed", "one number here"),
        (
            "correlation_cells = 8.0",
            "correlation_cells = [4, 8]",
            "surface.correlation_cells",
            "one number here",
        ),
        (
            theta,
            "theta_i_deg = { from = 0, to = 30, step = 5, stop = 3 }",
            "light.theta_i_deg.stop",
            "`step`",
        ),
    ]);
}

#[test]
fn ranges_count_their_points_by_whole_steps() {
    let theta = "theta_i_deg = [0, 15, 30]";
    let fine = accepted(&with(theta, "theta_i_deg = { from = 0, to = 89.9, step = 0.1 }")).campaign;
    assert_eq!(fine.light.theta_i_deg.len(), 900);
    let counted = |k: usize| k as f64 * 0.1;
    assert!((0..899).all(|k| fine.light.theta_i_deg[k] == counted(k)));
    assert_eq!(fine.light.theta_i_deg[899], 89.9);
    let single = accepted(&with(theta, "theta_i_deg = { from = 5, to = 5, step = 1 }")).campaign;
    assert_eq!(single.light.theta_i_deg, [5.0]);
}

#[test]
fn ranges_end_where_they_say() {
    let theta = "theta_i_deg = [0, 15, 30]";
    let counted =
        accepted(&with(theta, "theta_i_deg = { from = 1, to = 80, count = 7 }")).campaign.light.theta_i_deg;
    assert_eq!((counted.len(), counted[0], counted[6]), (7, 1.0, 80.0));
    // Steps of 79/6, each point from its own number of them: two roundings of 80.
    assert!((0..7).all(|k| (counted[k] - (1.0 + k as f64 * 79.0 / 6.0)).abs() <= 80.0 * f64::EPSILON));
    // 0.7 is no binary fraction: 126 steps miss 88.2 by 1e-14, and the last point is what was written.
    let inexact = accepted(&with(theta, "theta_i_deg = { from = 0, to = 88.2, step = 0.7 }"))
        .campaign
        .light
        .theta_i_deg;
    assert_eq!((inexact.len(), inexact[126]), (127, 88.2));
    let waves = |list: &str| {
        let text = with(
            "material = \"gold\"",
            &format!("material = \"gold\"\nfresnel = \"exact\"\nwavelength_nm = {list}"),
        );
        accepted(&text).campaign.optics.wavelengths_nm()
    };
    assert_eq!(waves("{ from = 450, to = 650, step = 50 }"), [450.0, 500.0, 550.0, 600.0, 650.0]);
    assert_eq!(waves("{ from = 450, to = 650, count = 5 }"), waves("[450, 500, 550, 600, 650]"));
    let ladder = accepted(&format!(
        "{GOOD}\n[bench]\ncells = {{ from = 64, to = 256, step = 64 }}\ncorrelation_cells = {{ from = 2, to = 8, step = 2 }}\n"
    ));
    let ladder = ladder.campaign.bench.expect("a ladder");
    assert_eq!((ladder.cells, ladder.correlation_cells), (vec![64, 128, 192, 256], vec![2.0, 4.0, 6.0, 8.0]));
}

#[test]
fn azimuths_are_reduced_and_noted() {
    let phi = |list: &str| with("aperture_deg = 0.0", &format!("phi_i_deg = {list}"));
    let parsed = accepted(&phi("[360, -270, 540]"));
    assert_eq!(parsed.campaign.light.azimuth, Azimuth::Absolute(vec![0.0, 90.0, 180.0]));
    assert!(parsed.notes[0].contains("reduced to [0, 360)"), "{:?}", parsed.notes);
    let whole = accepted(&phi("{ from = 0, to = 345, step = 15 }"));
    assert!(matches!(&whole.campaign.light.azimuth, Azimuth::Absolute(phis) if phis.len() == 24));
    // Increasing as written; the table has them in order.
    for list in ["[-90, -45, 0, 45, 90]", "{ from = -90, to = 90, step = 45 }"] {
        let negative = accepted(&phi(list)).campaign;
        assert_eq!(negative.light.azimuth, Azimuth::Absolute(vec![0.0, 45.0, 90.0, 270.0, 315.0]));
    }
    let key = "light.phi_i_deg";
    for (list, phrase) in [
        ("[0, 360]", "360 is there twice (reduced to 0 here)"),
        ("[0, 90, 360]", "360 is there twice"),
        ("{ from = 0, to = 360, step = 15 }", "360 is there twice"),
        ("[-90, 0, -45]", "315 here"),
        ("[-90, 270]", "270 is there twice"),
        ("[nan]", "must be finite"),
        ("[1e300]", "must lie in [-3600, 3600]"),
    ] {
        one_fault(&phi(list), "phi_i_deg", key, phrase);
    }
    let turned = accepted(&with("rotation_deg = 0.0", "rotation_deg = -90"));
    assert_eq!(turned.campaign.surface.rotation_deg, 270.0);
    assert_eq!(turned.notes.len(), 1);
}

#[test]
fn the_azimuth_follows_the_surface() {
    let anisotropic = with("alpha = 0.2", "alpha_x = 0.2\nalpha_y = 0.1");
    one_fault(&anisotropic, "[light]", "light.phi_i_deg", "the surface is not isotropic");
    let relative = anisotropic.replace("[light]", "[light]\nazimuth = \"relative\"");
    one_fault(&relative, "azimuth", "light.azimuth", "average_azimuth = true");
    let averaged = relative.replace("[light]", "[light]\naverage_azimuth = true");
    assert_eq!(accepted(&averaged).campaign.light.azimuth, Azimuth::Relative);
    let absolute = with("[light]", "[light]\nazimuth = \"absolute\"");
    one_fault(&absolute, "[light]", "light.phi_i_deg", "required with azimuth = \"absolute\"");
    let mixed = with("[light]", "[light]\nazimuth = \"relative\"\nphi_i_deg = [0]");
    one_fault(&mixed, "phi_i_deg", "light.phi_i_deg", "has no meaning with azimuth = \"relative\"");
    let pointless = with("[light]", "[light]\naverage_azimuth = true\nphi_i_deg = [0]");
    one_fault(&pointless, "average", "light.average_azimuth", "has no meaning with phi_i_deg");
    let neither = with("[light]", "[light]\nazimuth = \"both\"");
    one_fault(&neither, "azimuth", "light.azimuth", "\"relative\" or \"absolute\"");
}

#[test]
fn the_surface_has_exactly_one_kind() {
    let none = with("[surface.ggx]\nalpha = 0.2\n", "");
    one_fault(&none, "[surface]", "surface", "exactly one kind is required: [surface.ggx]");
    let two = with("[light]", "[surface.mirror]\n[light]");
    one_fault(&two, "[surface.mirror]", "surface.mirror", "[surface.ggx] is there as well");
    let mirror = on("[surface.mirror]\nalpha = 0\n");
    one_fault(&mirror, "alpha", "surface.mirror.alpha", "this table has no keys");
    let misspelt = with("[surface.ggx]", "[surface.gxx]");
    one_fault(&misspelt, "[surface.gxx]", "surface.gxx", "did you mean `ggx`?");
}

#[test]
fn a_bench_varies_only_what_a_patch_can_have() {
    let bench = |text: &str| format!("{GOOD}\n[bench]\n{text}\n");
    let accepted = accepted(&bench("correlation_cells = [4, 32]")).campaign.bench.expect("a bench");
    assert_eq!((accepted.cells, accepted.correlation_cells), (vec![256], vec![4.0, 32.0]));
    for (list, key, phrase) in [
        ("cells = []", "bench.cells", "at least one number"),
        ("cells = [4]", "bench.cells", "whole number in [8, 16384]"),
        // Found by the fuzzer: the surface's own correlation was not held to the patches of the bench.
        ("cells = [50, 32.0]", "bench.cells", "no room for the surface's correlation_cells = 8"),
        (
            "cells = [64, 256]\ncorrelation_cells = [16]",
            "bench.correlation_cells",
            "an eighth of the smallest patch",
        ),
        ("correlation_cells = [nan]", "bench.correlation_cells", "must be finite"),
    ] {
        let found = faults(bench(list));
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].key == key && found[0].allowed.contains(phrase), "{found:?}");
    }
    let mirror = format!("{}\n[bench]\n", on("[surface.mirror]\n"));
    assert!(faults(mirror)[0].allowed.contains("synthesised surface"));
}

#[test]
fn surfaces_without_random_heights_refuse_the_keys_of_a_patch() {
    let groove = "[surface.v_groove]\nslope = 0.5\n";
    let averaged = |text: String| text.replace("[light]", "[light]\naverage_azimuth = true");
    for kind in [groove, "[surface.mirror]\n", FILE] {
        let good = averaged(on(kind));
        accepted(&good);
        for key in ["cells = 64", "correlation_cells = 8", "mirror_images = true"] {
            let text = good.replace("[surface]", &format!("[surface]\n{key}"));
            let name = format!("surface.{}", key.split(' ').next().unwrap());
            one_fault(&text, key, &name, "belongs to a synthesised surface");
        }
    }
    let repeated = averaged(on(groove)).replace("[surface]", "[surface]\nrealisations = 3");
    assert_eq!(accepted(&repeated).campaign.surface.realisations, 3);
    let file = averaged(on(FILE)).replace("[surface]", "[surface]\nrealisations = 3");
    one_fault(&file, "realisations", "surface.realisations", "its tiles");
    assert_eq!(accepted(&averaged(on(FILE))).campaign.surface.realisations, 16);
    let flat = averaged(on("[surface.v_groove]\nslope = 0\n"));
    one_fault(&flat, "slope", "surface.v_groove.slope", "must lie in [1e-4, 10]");
}

#[test]
fn height_maps_are_described_completely() {
    let text = |old: &str, new: &str| {
        on(&FILE.replace(old, new)).replace("[light]", "[light]\naverage_azimuth = true")
    };
    let pitch = "surface.file.pitch_x_um";
    for wrong in ["0", "-1", "1e-300", "1e300", "nan"] {
        let text = text("pitch_x_um = 1", &format!("pitch_x_um = {wrong}"));
        one_fault(&text, "pitch_x_um", pitch, "lie in [1e-9, 1e9]");
    }
    let heading = "[surface.file]";
    one_fault(
        &text("pitch_x_um = 1\n", ""),
        heading,
        pitch,
        "arrays and pictures (.npy, .tif, .png) hold no pitches",
    );
    let exr = |rest: &str| text(FILE, &format!("{heading}\npath = \"a/scan.EXR\"\n{rest}"));
    let SurfaceKind::File(map) = accepted(&exr("")).campaign.surface.kind else { panic!() };
    assert_eq!((map.pitch_x_um, map.tiles, map.periodic), (None, 4, false));
    assert_eq!(map.resolved_path, Path::new("folder/a/scan.EXR"));
    let partial = exr("pitch_x_um = 1\npitch_y_um = 1\n");
    one_fault(&partial, heading, "surface.file.height_unit_um", "or none of them");
    one_fault(&exr("tiles = 65\n"), "tiles", "surface.file.tiles", "[1, 64]");
    one_fault(&exr("detrend = \"ring\"\n"), "detrend", "surface.file.detrend", "\"cylinder\"");
    let degree = "surface.file.degree";
    one_fault(&exr("detrend = \"polynomial\"\ndegree = 1\n"), "degree", degree, "[2, 10]");
    one_fault(&exr("detrend = \"sphere\"\ndegree = 3\n"), "degree", degree, "leave it out");
    let path = "surface.file.path";
    for name in ["scan.gsf", "scan.xyz", "scan.txt", "scan.exr", "scan.x3p", "scan.tif"] {
        accepted(&text("scan.npy", name));
    }
    one_fault(&text("scan.npy", "scan.bmp"), "path", path, "must end in .x3p, .sur, .sdf");
    one_fault(&text("scan.npy", ""), "path", path, "must be a file name");
    one_fault(&text("path = \"scan.npy\"\n", ""), heading, path, "required");
}

#[test]
fn the_sensor_is_one_of_two() {
    one_fault(&with_arm("[sensor]\n"), "[sensor]", "sensor", "exactly one is required");
    let both = with("[optics]", &format!("{ARM}[optics]"));
    one_fault(&both, "[sensor.arm]", "sensor.arm", "keep one");
    let text = |old: &str, new: &str| with_arm(&ARM.replace(old, new));
    let theta = "sensor.arm.theta_r_deg";
    one_fault(&text("0, 60]", "0, 90]"), "theta_r", theta, "the sensor arm stops below 90");
    one_fault(&text("[-60,", "[-90,"), "theta_r", theta, "the sensor arm stops above -90");
    one_fault(&text("[-60,", "[60,"), "theta_r", theta, "must increase");
    let aperture = "sensor.arm.aperture_deg";
    let row = |new: &str| with_arm(&ARM.replace("aperture_deg = 1", new)).replace("aperture_deg = 0.0", "");
    one_fault(&row("aperture_deg = 0"), "aperture", aperture, "[1e-6, 45]; an aperture as good as closed");
    one_fault(&row("aperture_deg = 46"), "aperture", aperture, "[1e-6, 45]");
    one_fault(&row("aperture_deg = 30"), "aperture", aperture, "must stay below 90");
    one_fault(&row(""), "[sensor.arm]", aperture, "required");
    let sample = text("aperture", "phi_r_from = \"sample\"\naperture");
    one_fault(&sample, "phi_r_from", "sensor.arm.phi_r_from", "has no meaning");
    let from = |text: &str| match accepted(text).campaign.sensor {
        SensorArm::Arm { phi_r_from, phi_r_deg, .. } => (phi_r_from, phi_r_deg),
        other => panic!("{other:?}"),
    };
    assert_eq!(from(&with_arm(ARM)), (PhiFrom::Light, vec![0.0]));
    let absolute = with_arm(ARM).replace("[light]", "[light]\nphi_i_deg = [0]");
    assert_eq!(from(&absolute), (PhiFrom::Sample, vec![0.0]));
}

#[test]
fn a_table_too_large_for_an_image_is_refused_before_anything_is_allocated() {
    let fine = "{ from = 0, to = 89.99, step = 0.01 }";
    let text = with("[0, 15, 30]", fine)
        .replace("[light]", "[light]\nphi_i_deg = { from = 0, to = 359.99, step = 0.01 }")
        .replace("= 18", "= 9000")
        .replace("= 36", "= 36000");
    let phrase = "theta_i x phi_i x theta_r x phi_r = 9000 x 36000 x 9001 x 36000";
    one_fault(&text, "[sensor.hemisphere]", "sensor.hemisphere", phrase);
    // 10^20 entries do not fit 64 bits.
    let most = "{ from = 0, to = 89, count = 99_999 }";
    let arm = format!("[sensor.arm]\ntheta_r_deg = {most}\nphi_r_deg = {most}\naperture_deg = 0.1\n");
    let text = with_arm(&arm)
        .replace("[0, 15, 30]", &most.replace("89,", "89.0,"))
        .replace("[light]", &format!("[light]\nphi_i_deg = {most}"));
    one_fault(&text, "[sensor.arm]", "sensor.arm", "a table holds at most 2^31");
}

#[test]
fn optics_outside_physics_are_refused() {
    let gold = "material = \"gold\"";
    let f0 = "optics.f0";
    each_row_is_one_fault(&[
        (gold, "f0 = -0.1", f0, "must lie in [0, 1]"),
        (gold, "f0 = 1.5", f0, "must lie in [0, 1]"),
        (gold, "f0 = nan", f0, "must be finite"),
        (gold, "f0 = [0.1, 0.2]", f0, "give [r, g, b] or one number"),
        (gold, "f0 = [0.1, 0.2, 1.2]", f0, "must lie in [0, 1]"),
        (gold, "material = \"unobtainium\"", "optics.material", "known: gold, silver, aluminum"),
        (gold, "material = \"Gold\"", "optics.material", "did you mean `gold`?"),
        (gold, "eta = 0", "optics.eta", "must lie in (0, 100]"),
        (gold, "eta = nan", "optics.eta", "must be finite"),
        (gold, "eta = 1", "optics.eta", "is no surface"),
        (gold, "k = 1", "optics.k", "belongs to eta"),
        (gold, "materials = []", "optics.materials", "must not be empty"),
        (gold, "materials = [\"gold\", \"gold\"]", "optics.materials", "is there already"),
        (gold, "materials = [\"gold\", \"tin\"]", "optics.materials", "unknown material"),
        (gold, "file = \"nowhere.csv\"", "optics.file", "cannot be read"),
        // A pipe would never end; a device stands for it here.
        (gold, "file = \"/dev/zero\"", "optics.file", "is not a regular file"),
    ]);
    let both = with(gold, "material = \"gold\"\nf0 = 1");
    one_fault(&both, "f0", f0, "ambiguous");
    one_fault(&with(gold, ""), "[optics]", "optics.material", "leave out [optics] altogether");
    let gray = accepted(&with(gold, "f0 = 1")).campaign.optics;
    assert_eq!(gray, Optics::Schlick { material: None, f0: [1.0; 3] });
    let ideal = with("[optics]\nmaterial = \"gold\"\n", "");
    assert_eq!(accepted(&ideal).campaign.optics, Optics::PerfectMirror);
}

#[test]
fn indices_outside_physics_are_refused() {
    let gold = "material = \"gold\"";
    let one = |new: &str, key: &str, phrase: &str| {
        let name = key.rsplit('.').next().expect("a name");
        one_fault(&with(gold, new), name, key, phrase);
    };
    let lists = "eta = [1.5, 1.6]\nk = [2, 3]\nwavelength_nm = [450, 550]";
    let (k, nm) = ("optics.k", "optics.wavelength_nm");
    one("eta = 1.5\nk = -1", k, "must lie in [0, 100]; absorption is positive");
    one(&lists.replace("[2, 3]", "[2, -3]"), k, "must lie in [0, 100]");
    one(&lists.replace("[2, 3]", "[2]"), k, "has 1 entries, eta has 2");
    one(&lists.replace("[450, 550]", "[550, 450]"), nm, "comes after 550; wavelengths must increase");
    one(&lists.replace("[450, 550]", "[450, 450]"), nm, "wavelengths must increase, each once");
    one(&lists.replace("[450, 550]", "[450, 550, 650]"), nm, "has 3 entries, eta has 2");
    one(&lists.replace("[450, 550]", "[0.45, 550]"), nm, "must lie in [1, 1e6]");
    let unnamed = with(gold, "eta = [1.5, 1.6]");
    one_fault(&unnamed, "[optics]", nm, "a wavelength for each entry of eta");
    one("eta = 1.5\nwavelength_nm = [550, 600]", nm, "has 2 entries, eta has 1");
    one("material = \"gold\"\nwavelength_nm = [550]", nm, "belongs to eta, file or fresnel");
    let exact = |what: &str| format!("{what}\nfresnel = \"exact\"");
    one(&exact("material = \"skin\""), "optics.material", "has no n and k here");
    one(&exact("f0 = 0.5"), "optics.f0", "holds no n and k");
    one(&exact("material = \"gold\"\nwavelength_nm = [200]"), nm, "must lie in [367.9, 821.1]");
    one("material = \"gold\"\nfresnel = \"cook\"", "optics.fresnel", "\"schlick\" or \"exact\"");
    let polarisation = "optics.polarisation";
    one("material = \"gold\"\npolarisation = \"s\"", polarisation, "Schlick's formula knows no polarisation");
    one(
        "eta = 1.5\nfresnel = \"exact\"\npolarisation = [\"s\", \"s\"]",
        polarisation,
        "each polarisation once",
    );
    one(
        "material = \"gold\"\npolarisation = \"mueller\"",
        polarisation,
        "Schlick's formula knows no polarisation",
    );
    one(
        "eta = 1.5\nfresnel = \"exact\"\npolarisation = [\"mueller\", \"s\"]",
        polarisation,
        "\"mueller\" alone",
    );
    one("facet = \"dielectric\"\neta = 1.5\npolarisation = \"s\"", polarisation, "\"none\" or \"mueller\"");
    let polarised = with(gold, "eta = 1.5\nfresnel = \"exact\"\npolarisation = \"p\"");
    let twice = polarised.replace("bounces = 1", "bounces = 2");
    one_fault(&twice, "polarisation", polarisation, "must be \"none\" or \"mueller\" with bounces = 2");
    assert_eq!(accepted(&polarised).campaign.optics.colours(), 1);
    let apart = with("bounces = 1", "bounces = 1\nby_order = true");
    one_fault(&apart, "by_order", "trace.by_order", "2 to 16 orders");
}

#[test]
fn an_artists_surface_is_converted_in_one_place() {
    let alpha = "[surface.ggx]\nalpha = 0.2\n";
    let artist = "[surface.artist]\nroughness = 0.5\nmetalness = 0.5\nbase_color = [1, 0.5, 0]\n";
    let both = with(alpha, artist);
    one_fault(&both, "[optics]", "optics", "[surface.artist] says what the facets reflect");
    let text = both.replace("[optics]\nmaterial = \"gold\"\n", "");
    let parsed = accepted(&text);
    assert!(parsed.notes.iter().any(|note| note.contains("diffuse part")), "{:?}", parsed.notes);
    assert_eq!(parsed.campaign.surface.kind, SurfaceKind::Ggx(vec![Alpha::isotropic(0.25)]));
    // 0.04/2 + base/2, one rounding each.
    let Optics::Schlick { material: None, f0 } = parsed.campaign.optics else { panic!() };
    assert!(
        f0.iter().zip([0.52, 0.27, 0.02]).all(|(found, wanted)| (found - wanted).abs() < 1e-15),
        "{f0:?}"
    );
    let faulty = |from: &str, to: &str| text.replace(from, to);
    let key = |name: &str| format!("surface.artist.{name}");
    one_fault(&faulty("roughness = 0.5", "roughness = 0"), "roughness", &key("roughness"), "[0.01, 1]");
    one_fault(&faulty("metalness = 0.5", "metalness = 2"), "metalness", &key("metalness"), "[0, 1]");
    one_fault(&faulty("[1, 0.5, 0]", "[1, 0.5]"), "base_color", &key("base_color"), "[r, g, b]");
    one_fault(&faulty("roughness = 0.5\n", ""), "[surface.artist]", &key("roughness"), "required");
}

#[test]
fn grains_have_their_keys() {
    let grains = |keys: &str| on(&format!("[surface.grains]\n{keys}\n"));
    let good = "alpha = 0.3\ncoverage = 0.5";
    assert!(accepted(&grains(good)).notes.is_empty());
    let faults = [
        ("alpha = 0.3", "[surface.grains]", "surface.grains.coverage", "required"),
        ("coverage = 0.5", "[surface.grains]", "surface.grains.alpha", "required"),
        ("alpha = 0.3\ncoverage = 0", "coverage = 0", "surface.grains.coverage", "must lie in [1e-4, 0.999]"),
        ("alpha = 0.3\ncoverage = 1", "coverage = 1", "surface.grains.coverage", "must lie in [1e-4, 0.999]"),
        (
            "alpha = 0.3\ncoverage = [0.5, 0.2]",
            "coverage = [0.5, 0.2]",
            "surface.grains.coverage",
            "increase",
        ),
        (
            "alpha = [0.3, 0.4]\ncoverage = [0.2, 0.5]",
            "coverage = [0.2",
            "surface.grains.coverage",
            "one of them",
        ),
        ("alpha = 0.3\ncoverage = 0.5\nside = 3", "side = 3", "surface.grains.side", "[8, 10000]"),
        ("alpha = 0.3\ncoverage = 0.5\nbase = \"glass\"", "base", "surface.grains.base", "absorbing"),
        ("alpha = 0.3\ncoverage = 0.5\nshape = \"cones\"", "shape", "surface.grains.shape", "pits"),
        (
            "alpha = 0.3\ncoverage = 0.5\nshape = \"heights\"\nside = 9",
            "side = 9",
            "surface.grains.side",
            "cells",
        ),
    ];
    for (keys, at, key, says) in faults {
        one_fault(&grains(keys), at, key, says);
    }
    let cells =
        with("cells = 256\n", "").replace("[surface.ggx]\nalpha = 0.2", &format!("[surface.grains]\n{good}"));
    one_fault(
        &cells,
        "correlation_cells = 8.0",
        "surface.correlation_cells",
        "grains have a size of their own",
    );
    // All light of the plane goes into one direction: between two bins, rounding says where.
    let edge = grains(good).replace("bins = \"centred\"", "bins = \"aligned\"");
    assert!(accepted(&edge).notes.iter().any(|note| note.contains("edge of the bins")));
    let absorbing = edge.replace(good, &format!("{good}\nbase = \"absorbing\""));
    assert!(accepted(&absorbing).notes.is_empty());
}

#[test]
fn a_statistical_surface_is_checked_like_the_others() {
    let alpha = "[surface.ggx]\nalpha = 0.2\n";
    let smith = |keys: &str| with(alpha, &format!("[surface.smith]\n{keys}\n"));
    let plain = smith("alpha = 0.2").replace("cells = 256\ncorrelation_cells = 8.0\n", "");
    assert!(accepted(&plain).campaign.is_isotropic());
    let faulty = |from: &str, to: &str| plain.replace(from, to);
    one_fault(&faulty("alpha = 0.2", "alpha = 0"), "alpha = 0", "surface.smith.alpha", "1e-4");
    one_fault(&faulty("alpha = 0.2", "alpha = 0.2\nndf = \"phong\""), "ndf", "surface.smith.ndf", "beckmann");
    let heights = faulty("alpha = 0.2", "alpha = 0.2\nheights = \"none\"");
    one_fault(&heights, "heights", "surface.smith.heights", "independent");
    let blind = faulty("visibility = true", "visibility = false");
    one_fault(&blind, "visibility = false", "trace.visibility", "nothing but its masking");
}

#[test]
fn stopping_rules_outside_their_ranges_are_refused() {
    let samples = "samples = 1_000_000";
    for rule in ["relative_error = 0", "relative_error = 1.5"] {
        let text = with(samples, &format!("{samples}\n{rule}"));
        one_fault(&text, rule, "stop.relative_error", "must lie in [");
    }
    let text = with(samples, &format!("{samples}\nseconds = 0.5"));
    one_fault(&text, "seconds", "stop.seconds", "must lie in [1, ");
    let text = with(samples, &format!("{samples}\nrelative_error = 0.01"));
    let one = text.replace("realisations = 4", "realisations = 1");
    one_fault(&one, "relative_error", "stop.relative_error", "at least 2 realisations");
}

#[test]
fn further_laws_are_checked() {
    let law = |table: &str| with("[surface.ggx]\nalpha = 0.2\n", table);
    let student = "surface.student_t.gamma";
    one_fault(&law("[surface.student_t]\nalpha = 0.2\n"), "[surface.student_t]", student, "required");
    let gamma = |value: &str| law(&format!("[surface.student_t]\nalpha = 0.2\ngamma = {value}\n"));
    accepted(&gamma("2"));
    for (value, allowed) in
        [("1.9", "must lie in [2, 100]; 2 is ggx"), ("101", "use beckmann"), ("nan", "must be finite")]
    {
        one_fault(&gamma(value), "gamma", student, allowed);
    }
    let exponent = |value: &str| law(&format!("[surface.blinn_phong]\nexponent = {value}\n"));
    let SurfaceKind::BlinnPhong { alphas, .. } = accepted(&exponent("48")).campaign.surface.kind else {
        panic!()
    };
    assert_eq!((alphas[0].x, alphas[0].y), (0.2, 0.2));
    one_fault(&exponent("-1"), "exponent", "surface.blinn_phong.exponent", "must lie in [0, 20000]");
    let alpha = law("[surface.blinn_phong]\nexponent = 48\nalpha = 0.2\n");
    one_fault(&alpha, "alpha", "surface.blinn_phong.alpha", "unknown key");
    let spectrum = law("[surface.beckmann]\nalpha = 0.2\nspectrum = \"white\"\n");
    one_fault(&spectrum, "spectrum", "surface.beckmann.spectrum", "\"gaussian\" or \"exponential\"");
}

/// `GOOD` with a preset in place of its arms.
fn preset(keys: &str) -> String {
    let arms = &GOOD[GOOD.find("[light]").unwrap()..GOOD.find("[optics]").unwrap()];
    with(arms, &format!("[preset]\n {keys}\n"))
}

#[test]
fn presets_are_checked() {
    let heading = "[preset]";
    one_fault(&preset(""), heading, "preset.name", "required; the instrument, such as \"utia\"");
    one_fault(&preset("name = \"UTIA\""), " name", "preset.name", "must be \"utia\" or \"merl\"");
    let utia = |rest: &str| preset(&format!("name = \"utia\"\n{rest}"));
    one_fault(
        &utia("theta_i_deg = [3]"),
        "theta_i_deg",
        "preset.theta_i_deg",
        "unknown key; known here: name, ",
    );
    one_fault(&utia("aperture_deg = 15"), "aperture_deg", "preset.aperture_deg", "reaches the horizon");
    let both = utia("").replace("[optics]", "[light]\ntheta_i_deg = [3]\n[optics]");
    one_fault(&both, "[light]", "light", "a [preset] is there and replaces [light] and [sensor]");
    let onera = preset("name = \"onera\"\ntheta_i_deg = [0, 75]");
    one_fault(&onera, "theta_i_deg", "preset.theta_i_deg", "must lie in [0, 60]; its arms stop at 60");
    let rosi = preset("name = \"rosi\"\ntheta_i_deg = [45]");
    one_fault(&rosi, heading, "preset.theta_r_deg", "required");
    let brushed = preset("name = \"in_plane\"").replace("alpha = 0.2", "alpha_x = 0.1\nalpha_y = 0.2");
    one_fault(&brushed, heading, "preset.phi_i_deg", "the surface is not isotropic");
    accepted(&brushed.replace("\"in_plane\"", "\"in_plane\"\nphi_i_deg = [0, 90]"));
    let klems = with("theta_i_deg = [0, 15, 30]", "theta_i_deg = [0, 15, 30]\nazimuth = \"klems_full\"");
    one_fault(&klems, "theta_i_deg", "light.theta_i_deg", "the basis names the incidences");
}

#[test]
fn small_tables_are_checked() {
    let name = "name = \"good\"";
    each_row_is_one_fault(
        &[
            (name, "name = \"\"", "name", "1 to 100 letters"),
            (name, "name = \"../up\"", "name", "start with none of"),
            (name, "name = \"-x\"", "name", "start with none of"),
            (name, "name = \"a b\"", "name", "digits"),
            (name, "name = 3", "name", "must be a string"),
            ("visibility = true", "visibility = 1", "trace.visibility", "true or false; this is an integer"),
            ("l1_model = 0.04", "l1_model = 0", "expect.l1_model", "(0, 10]"),
            ("l1_model = 0.04", "l1_model = nan", "expect.l1_model", "must be finite"),
            ("\"centred\"", "\"center\"", "sensor.hemisphere.bins", "\"centred\" or \"aligned\""),
        ]
        .map(|row| {
            if row.0 == "\"centred\"" {
                ("bins = \"centred\"", "bins = \"center\"", row.2, row.3)
            } else {
                row
            }
        }),
    );
    let masking = with("\"direction_correlated\"", "\"correlated\"");
    one_fault(&masking, "masking", "expect.masking", "\"separable\" or \"height_correlated\"");
    let ghost = with("bounces = 1\nvisibility = true", "bounces = 2\nvisibility = false");
    one_fault(&ghost, "visibility", "trace.visibility", "must be true with bounces = 2");
    let text =
        with("[trace]\nbounces = 1\nvisibility = true\n", "").replace("seed = 7", "seed = 7\ntrace = 3");
    one_fault(&text, "trace", "trace", "must be a table; this is an integer");
    let text = with("[surface]\n", "[[surface]]\n");
    one_fault(&text, "[[surface]]", "surface", "must be a table; this is an array");
}

#[test]
fn all_faults_of_a_file_are_listed_in_its_order() {
    let text = with("alpha = 0.2", "alpha = 0\nalhpa = 1")
        .replace("[0, 15, 30]", "[\n  0,\n  95,\n  nan,\n]")
        .replace("bounces = 1", "bounces = 0")
        .replace("samples = 1_000_000", "")
        .replace("cells = 256", "cells = 1\nperiod = 3");
    let found: Vec<(String, Option<usize>)> = faults(&text).into_iter().map(|f| (f.key, f.line)).collect();
    let expected = [
        ("surface.cells", 6),
        ("surface.period", 7),
        ("surface.ggx.alpha", 11),
        ("surface.ggx.alhpa", 12),
        ("light.theta_i_deg", 17),
        ("light.theta_i_deg", 18),
        ("trace.bounces", 31),
        ("stop.samples", 34),
    ];
    assert_eq!(found, expected.map(|(key, line)| (key.to_string(), Some(line))));
}

#[test]
fn doubtful_campaigns_are_noted() {
    let note = |text: &str, phrase: &str| {
        let notes = accepted(text).notes;
        assert!(notes.len() == 1 && notes[0].contains(phrase), "{notes:?} lacks {phrase:?}");
    };
    note(&with("[0, 15, 30]", "[0, 0.5, 1.5]"), "all angles <= 1.571: degrees are expected");
    note(&with("alpha = 0.2", "alpha = 10"), "above 2: beyond the tested range");
    note(&with("alpha = 0.2", "alpha = 0.04"), "narrower than a bin");
    note(&with("aperture_deg = 0.0", "aperture_deg = 3"), "exceeds a quarter of alpha");
    let arm = with_arm(&ARM.replace("aperture_deg = 1", "aperture_deg = 3"));
    // Its arm stands at the lamp too: two notes.
    let notes = accepted(&arm).notes;
    assert!(notes.len() == 2 && notes[1].contains("exceeds a quarter of alpha"), "{notes:?}");
    assert!(notes[0].contains("the sensor stands where the lamp is"), "{notes:?}");
}
