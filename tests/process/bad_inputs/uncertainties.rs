//! Uncertainties that no instrument has, and budgets that cannot be made.

use super::row::{Row, command, refused, taken};
use crate::support::campaign_text::{ARM, GOOD, on, with, with_arm};

pub fn rows() -> Vec<Row> {
    [inputs(), correlations(), surroundings(), directions(), commands()].into_iter().flatten().collect()
}

/// `GOOD` with an arm and these lines of `[uncertainty]`.
fn on_arm(lines: &str) -> String {
    format!("{}\n[uncertainty]\n{lines}\n", with_arm(ARM))
}

fn inputs() -> Vec<Row> {
    let row = |lines: &str, says: &[&'static str]| refused("uncertainty", on_arm(lines), says);
    vec![
        taken("uncertainty", on_arm("reading = { u = 0.01 }"), &["incidences"]),
        row("", &["uncertainty: give at least one input, such as reading"]),
        row("lamp_teta_deg = { u = 1 }", &["uncertainty.lamp_teta_deg", "did you mean `lamp_theta_deg`?"]),
        row("reading = 0.01", &["uncertainty.reading = 0.01", "must be a table"]),
        row("reading = {}", &["uncertainty.reading", "give u, the standard uncertainty"]),
        row("reading = { u = 0 }", &["uncertainty.reading.u = 0", "(0, 0.3]", "leave out"]),
        row("reading = { u = -0.1 }", &["uncertainty.reading.u = -0.1", "(0, 0.3]"]),
        row("reading = { u = nan }", &["uncertainty.reading.u = nan", "must be finite"]),
        row("tilt_x_deg = { u = 45 }", &["uncertainty.tilt_x_deg.u = 45", "(0, 5]", "small errors"]),
        row("reading = { u = 0.1, U = 0.1, k = 2 }", &["uncertainty.reading.U", "u is there as well"]),
        row("reading = { U = 0.1 }", &["uncertainty.reading.k", "required", "such as 2"]),
        row("reading = { U = 0.1, k = 0 }", &["uncertainty.reading.k = 0", "[1, 10]"]),
        row("reading = { u = 0.1, k = 2 }", &["uncertainty.reading.k = 2", "belongs to U"]),
        row(
            "reading = { u = 0.1, distribution = \"rectangular\" }",
            &["uncertainty.reading.u = 0.1", "give half_width"],
        ),
        row(
            "reading = { half_width = 0.1, distribution = \"normal\" }",
            &["uncertainty.reading.half_width = 0.1", "give u, or U and k"],
        ),
        row(
            "reading = { u = 0.1, distribution = \"gauss\" }",
            &["uncertainty.reading.distribution", "\"normal\" or"],
        ),
        row(
            "reading = { u = 0.1, distribution = \"t\" }",
            &["uncertainty.reading.dof", "required", "such as 9"],
        ),
        row(
            "reading = { u = 0.1, distribution = \"t\", dof = 2 }",
            &["uncertainty.reading.dof = 2", "[3, 1e9]", "not finite"],
        ),
        row("reading = { u = 0.1, dof = 0 }", &["uncertainty.reading.dof = 0", "[1, 1e9]"]),
        row(
            "reading = { u = 0.1, relative = true }",
            &["uncertainty.reading.relative", "n, k, f0 and albedo"],
        ),
        row("reading = { u = 0.1 }\ntrials = 10", &["uncertainty.trials = 10", "[200000, 100000000]"]),
        row("reading = { u = 0.1 }\nsamples = 0", &["uncertainty.samples = 0", "must be a whole number"]),
    ]
}

fn correlations() -> Vec<Row> {
    let row = |list: &str, says: &[&'static str]| {
        let lines = format!("reading = {{ u = 0.01 }}\ntilt_x_deg = {{ u = 0.1 }}\ncorrelations = {list}");
        refused("correlations", on_arm(&lines), says)
    };
    vec![
        row("0.5", &["uncertainty.correlations = 0.5", "must be a list"]),
        row("[0.5]", &["uncertainty.correlations", "two inputs and a coefficient"]),
        row(
            "[[\"reading\", \"tilt_y_deg\", 0.5]]",
            &["uncertainty.correlations", "did you mean \"tilt_x_deg\"?"],
        ),
        row("[[\"reading\", \"n\", 0.5]]", &["uncertainty.correlations", "given here: tilt_x_deg, reading"]),
        row("[[\"reading\", \"reading\", 0.5]]", &["uncertainty.correlations", "name two inputs"]),
        row("[[\"reading\", \"tilt_x_deg\", 1.5]]", &["uncertainty.correlations = 1.5", "[-1, 1]"]),
        row(
            "[[\"reading\", \"tilt_x_deg\", 0.5], [\"tilt_x_deg\", \"reading\", 0.5]]",
            &["uncertainty.correlations", "are there twice"],
        ),
    ]
}

/// What the rest of the campaign allows.
fn surroundings() -> Vec<Row> {
    let lines = "\n[uncertainty]\nreading = { u = 0.01 }\n";
    let arm = with_arm(ARM);
    let other = |old: &str, new: &str, line: &str| {
        assert_eq!(arm.matches(old).count(), 1, "{old}");
        format!("{}\n[uncertainty]\n{line}\n", arm.replace(old, new))
    };
    let row = |text: String, says: &[&'static str]| refused("budget", text, says);
    vec![
        row(on_arm("lamp_cone = { u = 0.1 }"), &["uncertainty.lamp_cone", "light.aperture_deg, which is 0"]),
        row(on_arm("f0 = { u = 0.1 }"), &["uncertainty.f0", "give n and k"]),
        row(on_arm("albedo = { u = 0.1 }"), &["uncertainty.albedo", "optics.albedo between 0 and 1"]),
        row(
            other("material = \"gold\"", "f0 = 0.5", "n = { u = 0.1 }"),
            &["uncertainty.n", "no index of refraction"],
        ),
        row(other("material = \"gold\"", "eta = 1.5", "k = { u = 0.1 }"), &["uncertainty.k", "no k above 0"]),
        row(
            other("material = \"gold\"", "f0 = 1", "f0 = { u = 0.1 }"),
            &["uncertainty.f0", "between 0 and 1"],
        ),
        row(
            other("realisations = 4", "realisations = 1", "reading = { u = 0.1 }"),
            &["surface.realisations of at least 2"],
        ),
        row(
            other("alpha = 0.2", "alpha = [0.2, 0.3]", "reading = { u = 0.1 }"),
            &["uncertainty", "one roughness"],
        ),
        row(
            other("material = \"gold\"", "materials = [\"gold\", \"silver\"]", "reading = { u = 0.1 }"),
            &["uncertainty", "one material"],
        ),
        row(on("[surface.mirror]\n") + lines, &["uncertainty", "surface.mirror", "needs a rough surface"]),
        // A budget's table is read by every command.
        row(
            format!("{GOOD}{lines}"),
            &["uncertainty.at", "required", "[[theta_i, phi_i, theta_r, phi_r], ...]"],
        ),
    ]
}

fn directions() -> Vec<Row> {
    let row = |lines: &str, says: &[&'static str]| {
        let text = format!("{GOOD}\n[uncertainty]\nreading = {{ u = 0.01 }}\n{lines}\n");
        refused("directions", text, says)
    };
    vec![
        row("at = [[0, 0, 10, 0]]", &["uncertainty.aperture_deg", "required"]),
        row("at = []\naperture_deg = 1", &["uncertainty.at = []", "at least one pair"]),
        row("at = [[0, 0, 10]]\naperture_deg = 1", &["uncertainty.at", "[theta_i, phi_i, theta_r, phi_r]"]),
        row("at = [[90, 0, 10, 0]]\naperture_deg = 1", &["uncertainty.at = 90", "[0, 90)"]),
        row(
            "at = [[0, 0, 89.5, 0]]\naperture_deg = 1",
            &["uncertainty.at", "the aperture at theta = 89.5 reaches"],
        ),
        row("at = [[0, 0, 120, 0]]\naperture_deg = 1", &["uncertainty.at = 120", "(-90, 90)"]),
        refused(
            "directions",
            on_arm("reading = { u = 0.01 }\nat = [[0, 0, 0, 0]]"),
            &["uncertainty.at", "has no meaning with [sensor.arm]"],
        ),
    ]
}

fn commands() -> Vec<Row> {
    let grazing = "[sensor.arm]\ntheta_r_deg = [88.95]\naperture_deg = 1\n";
    vec![
        command("budget", "budget c.toml")
            .file("c.toml", with_arm(ARM))
            .exits(2, &["c.toml: uncertainty: required", "[uncertainty] with reading"]),
        command("budget", "budget absent.toml").exits(3, &["absent.toml"]),
        command("budget", "budget c.toml -o -")
            .file("c.toml", on_arm("reading = { u = 0.01 }"))
            .exits(2, &["a folder is needed"]),
        command("budget", "budget c.toml")
            .file(
                "c.toml",
                format!(
                    "{}\n[uncertainty]\ntilt_x_deg = {{ u = 0.01 }}\n",
                    with("samples = 1_000_000", "samples = 1000").replace(
                        "[sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\nbins = \"centred\"\n",
                        grazing
                    )
                ),
            )
            .exits(4, &["keeps 0.05 degrees from the horizon", "lower theta_i_deg, theta_r_deg"]),
    ]
}
