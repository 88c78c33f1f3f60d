//! Promise: through arms, bins and tallies, order 1 of a statistical Smith surface is the formula, and nothing but noise
//! lies between.

use std::path::Path;

use gonio::campaign;
use gonio::measure::{Measured, Patches, measure, plan};
use gonio::validate::{Verdict, examine};

/// A campaign with everything after `[surface.smith]` and the azimuth given.
fn run(smith: &str, azimuth: &str) -> (Measured, Verdict) {
    let text = format!(
        r#"
        name = "smith"
        seed = 11
        surface.realisations = 16
        {smith}
        light.theta_i_deg = [0, 60, 75]
        {azimuth}
        sensor.hemisphere.bins = "aligned"
        trace.bounces = 16
        stop.samples = 65536
        "#
    );
    let campaign = campaign::parse(&text, "smith", Path::new(".")).expect("a good campaign").campaign;
    let plan = plan(&campaign).expect("it fits");
    let patches = Patches::prepare(&campaign, &mut Vec::new()).expect("nothing to load");
    let (mut measured, _) = measure(&campaign, &plan, &patches, &|_| {}).expect("no path is lost");
    let measured = measured.pop().expect("one roughness");
    let verdict = examine(&measured.table, &measured.campaign, Some(&measured.realisations));
    (measured, verdict)
}

const GGX: &str = r#"surface.smith = { alpha = 0.5, ndf = "ggx", heights = "correlated" }"#;

#[test]
fn order_one_is_the_formula_with_both_height_rules() {
    let brushed =
        r#"surface.smith = { alpha_x = 0.15, alpha_y = 0.5, ndf = "ggx", heights = "independent" }"#;
    let beckmann = r#"surface.smith = { alpha = 0.5, ndf = "beckmann", heights = "correlated" }"#;
    let cases = [
        (GGX, "", "height_correlated"),
        (brushed, "light.phi_i_deg = [0, 40]", "separable"),
        (beckmann, "", "height_correlated"),
    ];
    for (smith, azimuth, masking) in cases {
        let (_, verdict) = run(smith, azimuth);
        // The verdict's own test: no bin beyond Sidak's limit at 1 %, here over about 1,000 bins with 15 degrees of
        // freedom. A bin of 1 % error is caught from 10 standard errors, the table as a whole by the next line.
        assert!(verdict.ok, "{smith}: {:?}", verdict.failures);
        let figures =
            verdict.comparisons.iter().find(|c| c.masking == masking).expect("three maskings").figures;
        let (l1, noise) = (figures.l1.unwrap(), figures.l1_noise.unwrap());
        // Both are means over hundreds of bins and scatter by a few per cent about each other.
        assert!((l1 / noise - 1.0).abs() < 0.12, "{smith}: {l1} {noise}");
    }
}

#[test]
fn the_other_masking_is_told_apart() {
    // Power: at 75 degrees and alpha 0.5 the two rules differ by 5 %, three times the noise of this run.
    let (_, verdict) = run(GGX, "");
    let separable =
        &verdict.comparisons.iter().find(|c| c.masking == "separable").expect("three maskings").incidences[2];
    assert!(separable.figures.l1_model.unwrap() > 0.04, "{:?}", separable.figures);
    assert_eq!(verdict.nearest_masking.as_deref(), Some("height_correlated"));
}

#[test]
fn all_orders_and_the_cut_paths_add_up_to_the_light() {
    let (measured, _) = run(GGX, "");
    for incidence in &measured.incidences {
        // Shares of 2^-20, counted as integers: exact but for the rounding of the sum to f64.
        assert!(
            incidence.closure.iter().all(|closure| (closure - 1.0).abs() < 1e-12),
            "{:?}",
            incidence.closure
        );
        let (orders, cut) = (incidence.orders.iter().sum::<u64>(), incidence.cut);
        assert_eq!(orders + cut + incidence.hidden, 16 * 65_536);
    }
    // GGX alpha 0.5 under normal light: the single-scattering albedo of the reference table, within 4.5 standard errors.
    let (albedo, se) = measured.incidences[0].single();
    let (albedo, se) = (albedo.expect("a hemisphere"), se.expect("16 groups"));
    assert!((albedo - 0.687_848_515_110_2).abs() < 4.5 * se, "{albedo} {se}");
}
