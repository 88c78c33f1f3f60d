//! Promise: `[uncertainty]` reads back as itself, changes nothing of what is measured, and bad correlations are named.

use gonio::campaign::{QUANTITIES, to_toml, uncertainty_to_toml};

use crate::support::campaign_text::{ARM, GOOD, accepted, parse, with, with_arm};

const ALL_KINDS: &str = "
[uncertainty]
lamp_theta_deg = { u = 0.02 }
lamp_phi_deg = { U = 0.1, k = 3 }
sensor_theta_deg = { half_width = 0.05 }
sensor_phi_deg = { half_width = 1e-7, distribution = \"triangular\" }
tilt_x_deg = { half_width = 0.3, distribution = \"arcsine\", dof = 12.5 }
height_scale = { u = 0.01, dof = 4 }
n = { u = 0.02, relative = true }
k = { u = 0.1 }
reading = { u = 0.003, dof = 9, distribution = \"t\" }
correlations = [[\"lamp_theta_deg\", \"sensor_theta_deg\", 0.5], [\"n\", \"k\", -1]]
";

/// A material that has n and k.
fn on_metal(text: &str) -> String {
    text.replace("material = \"gold\"", "eta = 0.5\nk = 2.0")
}

#[test]
fn uncertainties_survive_the_way_through_toml() {
    let at = format!("{ALL_KINDS}at = [[30, 0, -45, 10], [0, 0, 0, 0]]\naperture_deg = 1.5\nsamples = 5\n");
    for text in [format!("{GOOD}{at}"), with_arm(ARM) + ALL_KINDS + "trials = 300_000\n"] {
        let first = accepted(&on_metal(&text));
        let uncertainty = first.uncertainty.expect("it is there");
        let written = to_toml(&first.campaign) + &uncertainty_to_toml(&uncertainty);
        let again = accepted(&written);
        assert_eq!(again.campaign, first.campaign);
        assert_eq!(again.uncertainty, Some(uncertainty), "{written}");
    }
}

/// What tables store of a campaign is the same with and without the table.
#[test]
fn the_campaign_is_the_same_without_it() {
    let [without, with] = ["", ALL_KINDS].map(|table| accepted(&on_metal(&(with_arm(ARM) + table))));
    assert_eq!(without.campaign, with.campaign);
    assert_eq!(to_toml(&without.campaign), to_toml(&with.campaign));
    assert!(without.uncertainty.is_none());
}

#[test]
fn names_of_quantities_are_in_their_order() {
    for (place, (name, quantity)) in QUANTITIES.into_iter().enumerate() {
        assert_eq!((quantity as usize, quantity.name()), (place, name));
    }
}

/// r_12 = r_13 = 0.9 and r_23 = -0.9 have the determinant 1 + 2 (0.9)(0.9)(-0.9) - 3 (0.81) = -2.888 < 0; with +0.9 it is
/// 1 + 1.458 - 2.43 = 0.028 > 0. Coefficients of 1 are allowed where they agree.
#[test]
fn correlations_that_no_numbers_have_are_refused_by_name() {
    let inputs = "lamp_theta_deg = { u = 1 }\nsensor_theta_deg = { u = 1 }\nreading = { u = 0.1 }\n";
    let text = |last: &str, size: &str| {
        let base = with_arm(ARM);
        format!(
            "{base}\n[uncertainty]\n{inputs}correlations = [[\"lamp_theta_deg\", \"sensor_theta_deg\", {size}], \
             [\"lamp_theta_deg\", \"reading\", {size}], [\"sensor_theta_deg\", \"reading\", {last}]]\n"
        )
    };
    accepted(&text("0.9", "0.9"));
    accepted(&text("1", "1"));
    for bad in [text("-0.9", "0.9"), text("0.5", "1")] {
        let said = parse(&bad).expect_err("no numbers have these").to_string();
        assert!(said.contains("uncertainty.correlations") && said.contains("from reading on"), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}

/// A misspelt key is answered with the nearest name.
#[test]
fn misspelt_quantities_are_answered_with_the_nearest() {
    let said =
        parse(with("[stop]", "[uncertainty]\nlamp_teta_deg = { u = 1 }\n[stop]")).expect_err("misspelt");
    assert!(said.to_string().contains("did you mean `lamp_theta_deg`?"), "{said}");
}
