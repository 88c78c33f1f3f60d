//! The text of a campaign: what is no TOML, wrong keys, numbers and counts.

use super::row::{Row, refused, taken};
use crate::support::campaign_text::{ARM, GOOD, on, with, with_arm};

const ALPHA: &str = "surface.ggx.alpha";
const SAMPLES: &str = "samples = 1_000_000";
const THETA: &str = "theta_i_deg = [0, 15, 30]";

pub fn rows() -> Vec<Row> {
    [text(), keys(), roughness(), counts(), angles(), ranges(), sizes(), rest()]
        .into_iter()
        .flatten()
        .collect()
}

fn text() -> Vec<Row> {
    let mut no_utf8 = GOOD.as_bytes().to_vec();
    no_utf8[20] = 0xff;
    let windows = format!("\u{feff}{}", GOOD.replace('\n', "\r\n"));
    let control = |c: char| with("alpha = 0.2", &format!("alpha = 0.1{c}"));
    vec![
        refused("empty campaign", "", &["c.toml: name: required"]).and_somewhere(&[
            "surface: exactly one kind is required",
            "light.theta_i_deg: required",
            "stop.samples: required",
        ]),
        refused("empty campaign", "\n# nothing\n\n", &["c.toml: name: required"]),
        refused("campaign not UTF-8", no_utf8, &["c.toml:2: file", "byte 20 is not UTF-8"]),
        taken("byte order mark and CRLF", windows, &["incidences", "3"]),
        refused("control characters", control('\0'), &["c.toml:10:", ALPHA]),
        refused("control characters", control('\u{1}'), &["c.toml:10:", ALPHA]),
        refused("control characters", control('\u{7f}'), &["c.toml:10:", ALPHA]),
        refused("control characters", with("\"good\"", "\"a\u{1b}[31mb\""), &["c.toml:1:", "name"]),
        refused("deep nesting", format!("seed = {}", "[".repeat(100_000)), &["c.toml:1:", "seed"]),
        refused("deep nesting", format!("a{} = 1", ".a".repeat(100_000)), &["c.toml: ", "recursion limit"]),
        refused("deep nesting", format!("seed = {}", "{a=".repeat(100_000)), &["c.toml:1:", "seed"]),
        refused("huge campaign", "", &["c.toml: file", "larger than 16 MiB"]).prepared(|folder| {
            let file = std::fs::File::create(folder.join("c.toml")).expect("file");
            file.set_len(1 << 30).expect("a sparse gigabyte");
        }),
    ]
}

fn keys() -> Vec<Row> {
    let alpha = |new: &str| with("alpha = 0.2", new);
    vec![
        refused("duplicate key", alpha("alpha = 0.2\nalpha = 0.3"), &["c.toml:11:", ALPHA, "duplicate"]),
        refused("duplicate key", format!("{GOOD}[stop]\nsamples = 1\n"), &["duplicate"]),
        refused(
            "misspelt key",
            alpha("alhpa = 0.2"),
            &["c.toml:10:1: surface.ggx.alhpa", "did you mean `alpha`?"],
        ),
        refused("misspelt key", with("[optics]", "[optic]"), &["optic", "did you mean `optics`?"]),
        refused(
            "key in capitals",
            alpha("Alpha = 0.2"),
            &["c.toml:10:1: surface.ggx.Alpha", "did you mean `alpha`?"],
        ),
        refused("alpha twice", alpha("alpha = 0.2\nalpha_x = 0.1"), &[ALPHA, "ambiguous"]),
        refused("alpha_y missing", alpha("alpha_x = 0.2"), &["surface.ggx.alpha_y", "required"]),
        refused(
            "number misspelt",
            alpha("alpha = \"0.2\""),
            &["alpha = \"0.2\"", "must be a number; this is a string"],
        ),
        refused("number misspelt", alpha("alpha = 1,5"), &["alpha = 1,5", "numbers are written 0.5"]),
        refused("number misspelt", alpha("alpha = .5"), &["alpha = .5", "numbers are written 0.5"]),
        refused("number misspelt", alpha("alpha = 5."), &["alpha = 5.", "numbers are written 0.5"]),
        refused("number misspelt", alpha("alpha = 0.2 rad"), &["c.toml:10:", ALPHA]),
    ]
}

fn roughness() -> Vec<Row> {
    let row = |name: &'static str, value: &str, says: &[&'static str]| {
        refused(name, with("alpha = 0.2", &format!("alpha = {value}")), says)
    };
    let range = "must lie in [1e-4, 10]";
    let brushed =
        with("alpha = 0.2", "alpha_x = 1e-4\nalpha_y = 1").replace("[light]", "[light]\nphi_i_deg = [0, 90]");
    vec![
        row("alpha nan", "nan", &["c.toml:10:1: surface.ggx.alpha = nan", "must be finite"]),
        row("alpha infinite", "inf", &["surface.ggx.alpha = inf", "must be finite"]),
        row("alpha infinite", "-inf", &["surface.ggx.alpha = -inf", "must be finite"]),
        row("alpha zero", "0", &["surface.ggx.alpha = 0", range, "a smooth mirror has no lobe"]),
        row("alpha zero", "-0.0", &["surface.ggx.alpha = -0.0", range]),
        row("alpha negative", "-0.3", &["surface.ggx.alpha = -0.3", range]),
        row("alpha beyond f64", "1e-400", &["surface.ggx.alpha = 1e-400", range]),
        row("alpha beyond f64", "1e400", &["surface.ggx.alpha = 1e400", "must be finite"]),
        row("alpha too small", "5e-5", &["surface.ggx.alpha = 5e-5", range]),
        row("alpha large", "1e6", &["surface.ggx.alpha = 1e6", range]),
        taken("alpha smallest", with("alpha = 0.2", "alpha = 1e-4"), &["narrower than a bin"]),
        taken(
            "alpha smallest",
            with("alpha = 0.2", "alpha = 1e-4").replace("aperture_deg = 0.0", "aperture_deg = 0.1"),
            &["light.aperture_deg = 0.1", "exceeds a quarter of alpha"],
        ),
        taken("alpha large", with("alpha = 0.2", "alpha = 10"), &["above 2: beyond the tested range"]),
        taken("alpha very unequal", brushed, &["incidences", "6"]),
    ]
}

fn counts() -> Vec<Row> {
    let samples = |value: &str| with(SAMPLES, &format!("samples = {value}"));
    let whole = "must be a whole number";
    let one =
        |text: String| text.replace("realisations = 4", "realisations = 1").replace("[0, 15, 30]", "[0]");
    vec![
        taken("samples as a float", samples("1e6"), &["1,048,576"]),
        refused("samples as a float", samples("1.5e0"), &["stop.samples = 1.5e0", whole]),
        refused("samples zero", samples("0"), &["stop.samples = 0", whole]),
        refused("samples zero", samples("-1"), &["stop.samples = -1", whole]),
        refused(
            "samples overflow",
            samples("18446744073709551615"),
            &["stop.samples = 18446744073709551615", "years"],
        )
        .exits(4, &["stop.samples = 18446744073709551615", "years"]),
        refused("samples overflow", samples("99999999999999999999999999"), &["stop.samples", whole]),
        refused(
            "confidence as a key",
            format!("{GOOD}confidence = 2\n"),
            &["expect.confidence", "unknown key"],
        ),
        refused(
            "seed out of range",
            with("seed = 7", "seed = -1"),
            &["seed = -1", "[0, 18446744073709551615]"],
        ),
        taken("seed out of range", with("seed = 7", "seed = 0"), &["incidences"]),
        taken("seed out of range", with("seed = 7", "seed = 18446744073709551615"), &["incidences"]),
        refused(
            "seed out of range",
            with("seed = 7", "seed = 18446744073709551616"),
            &["seed = 18446744073709551616"],
        ),
        taken("run of years", one(samples("1_000_000_000_000")), &["time"]).and_somewhere(&["1,000,000,0"]),
        refused("run of years", samples("1e12").replace("realisations = 4", "realisations = 400"), &[])
            .exits(4, &["good: would take about", "days"]),
        refused(
            "bounces out of range",
            with("bounces = 1", "bounces = 0"),
            &["trace.bounces = 0", "[1, 10000]"],
        ),
        refused(
            "bounces out of range",
            with("bounces = 1", "bounces = 1_000_000_000"),
            &["trace.bounces = 1_000_000_000", "[1, 10000]"],
        ),
        taken("bounces out of range", with("bounces = 1", "bounces = 10_000"), &["incidences"]),
    ]
}

fn angles() -> Vec<Row> {
    let theta = |value: &str| with(THETA, &format!("theta_i_deg = {value}"));
    let phi = |value: &str| with("[light]", &format!("[light]\nphi_i_deg = {value}"));
    let key = "light.theta_i_deg";
    let end = "the light arm stops below 90";
    vec![
        refused("theta 90", theta("[0, 90]"), &[key, "= 90", end]),
        refused(
            "theta 90",
            with_arm(&ARM.replace("0, 60]", "0, 90]")),
            &["sensor.arm.theta_r_deg = 90", "below 90"],
        ),
        taken("theta nearly 90", theta("[89.99]"), &["incidences"]),
        refused("theta out of range", theta("[-5, 0]"), &[key, "= -5", "[0, 90)"]),
        refused("theta out of range", theta("[0, 90.5]"), &[key, "= 90.5", end]),
        refused("theta out of range", theta("[0, 180]"), &[key, "= 180", end]),
        taken(
            "phi the same modulo 360",
            phi("[360, -270, 540]"),
            &["light.phi_i_deg", "reduced to [0, 360)"],
        ),
        refused("phi the same modulo 360", phi("[0, 360]"), &["light.phi_i_deg = 360", "is there twice"]),
        taken(
            "phi the same modulo 360",
            with("rotation_deg = 0.0", "rotation_deg = 720"),
            &["surface.rotation_deg = 720", "reduced to 0"],
        ),
        refused("phi not finite", phi("[nan]"), &["light.phi_i_deg = nan", "must be finite"]),
        refused("phi not finite", phi("[1e300]"), &["light.phi_i_deg = 1e300", "[-3600, 3600]"]),
        taken("angles like radians", theta("[0, 0.5, 1.5]"), &["degrees are expected"]),
        refused("angles empty or unsorted", theta("[]"), &[key, "must not be empty"]),
        refused("angles empty or unsorted", theta("[0, 15, 15]"), &[key, "15 is there twice"]),
        refused("angles empty or unsorted", theta("[0, 30, 15]"), &[key, "15 comes after 30"]),
        taken("one angle", theta("[45]"), &["incidences", "1"]),
        taken(
            "arms in each other's way",
            with_arm(&ARM.replace("[-60, 0, 60]", "[-15, 30]")),
            &["sensor.arm.theta_r_deg = 30", "a real instrument"],
        ),
    ]
}

fn ranges() -> Vec<Row> {
    let theta = |value: &str| with(THETA, &format!("theta_i_deg = {{ {value} }}"));
    let step = "light.theta_i_deg.step";
    vec![
        refused(
            "range backwards",
            theta("from = 30, to = 0, step = 5"),
            &["light.theta_i_deg.to = 0", "must not lie below"],
        ),
        refused("range backwards", theta("from = 0, to = 30, step = 0"), &[step, "= 0", "(0, 1e6]"]),
        refused("range backwards", theta("from = 0, to = 30, step = -5"), &[step, "= -5", "(0, 1e6]"]),
        refused(
            "range backwards",
            theta("from = 0, to = 30, step = nan"),
            &[step, "= nan", "must be finite"],
        ),
        refused(
            "range that its step does not divide",
            theta("from = 0, to = 80, step = 7"),
            &["light.theta_i_deg.to = 80", "no whole number of steps of 7 from 0", "end at 77 or 84"],
        ),
        taken("range with an inexact step", theta("from = 0, to = 89.9, step = 0.1"), &["incidences", "900"]),
    ]
}

fn sizes() -> Vec<Row> {
    let cells = |value: &str| with("cells = 256", &format!("cells = {value}"));
    let fine = "{ from = 0, to = 89.975, step = 0.025 }";
    let table = with("[0, 15, 30]", fine)
        .replace("[light]", "[light]\nphi_i_deg = { from = 0, to = 359.9, step = 0.1 }")
        .replace("= 18", "= 900")
        .replace("= 36", "= 900");
    let most = "{ from = 0, to = 89, count = 99_999 }";
    let arm = format!("[sensor.arm]\ntheta_r_deg = {most}\nphi_r_deg = {most}\naperture_deg = 0.1\n");
    let overflowing = with_arm(&arm)
        .replace("[0, 15, 30]", most)
        .replace("[light]", &format!("[light]\nphi_i_deg = {most}"));
    let range = "[8, 16384]";
    vec![
        refused("table too large", table, &[])
            .exits(4, &["c.toml:17:9: sensor.hemisphere", "3600 x 3600 x 901 x 900", "bytes", "2^31"]),
        refused("table size overflows", overflowing, &[])
            .exits(4, &["sensor.arm", "99999 x 99999 x 99999 x 99999", "2^31"]),
        refused("cells out of range", cells("0"), &["surface.cells = 0", range]),
        refused("cells out of range", cells("1"), &["surface.cells = 1", range]),
        refused("cells out of range", cells("2"), &["surface.cells = 2", range]),
        taken("cells out of range", cells("8").replace("correlation_cells = 8.0\n", ""), &["8 x 8"]),
        refused("cells out of range", cells("1048576"), &[])
            .exits(4, &["surface.cells = 1048576", "8192 GiB", "16384"]),
        taken("map prime or oblong", cells("257"), &["257 x 257"]),
        taken("map prime or oblong", cells("1000"), &["1000 x 1000"]),
    ]
}

fn rest() -> Vec<Row> {
    let arm = |aperture: &str| {
        with_arm(&ARM.replace("aperture_deg = 1", &format!("aperture_deg = {aperture}")))
            .replace("aperture_deg = 0.0\n", "")
    };
    let bar = |value: &str| with("l1_model = 0.04", &format!("l1_model = {value}"));
    let mirror = on("[surface.mirror]\n");
    vec![
        refused("aperture out of range", arm("0"), &["sensor.arm.aperture_deg = 0", "as good as closed"]),
        refused("aperture out of range", arm("46"), &["sensor.arm.aperture_deg = 46", "[1e-6, 45]"]),
        refused("aperture out of range", arm("-1"), &["sensor.arm.aperture_deg = -1", "[1e-6, 45]"]),
        taken("aperture out of range", mirror, &["incidences"]),
        // Cut cones would no longer be what their name says: they are refused, not cut.
        refused(
            "aperture that reaches the horizon",
            arm("30.5"),
            &["sensor.arm.aperture_deg = 30.5", "reaches the horizon"],
        ),
        refused(
            "aperture that reaches the horizon",
            with("aperture_deg = 0.0", "aperture_deg = 45").replace("30]", "50]"),
            &["reaches the horizon"],
        ),
        refused(
            "no bins",
            with("theta_r_bins = 18", "theta_r_bins = 0"),
            &["sensor.hemisphere.theta_r_bins = 0", "[1, 9000]"],
        ),
        refused("bar out of range", bar("0"), &["expect.l1_model = 0", "(0, 10]"]),
        refused("bar out of range", bar("nan"), &["expect.l1_model = nan", "must be finite"]),
    ]
}
