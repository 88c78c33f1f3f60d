//! Promise: a random continuous surface stays as close to D G2/(4 cos cos) as the bars below say, noise taken off, and
//! the direction-correlated masking is the nearest one off normal incidence.

use std::path::Path;

use gonio::campaign;
use gonio::measure::{Measured, Patches, measure, plan};
use gonio::validate::verdict::nearest;
use gonio::validate::{Verdict, examine};

/// One bar: alpha_x, theta_i, phi_i, largest l1_model against height-correlated masking.
type Bar = (f64, f64, f64, f64);

fn run(text: &str) -> Vec<(Measured, Verdict)> {
    let campaign = campaign::parse(text, "discrepancy", Path::new(".")).expect("a good campaign").campaign;
    let plan = plan(&campaign).expect("it fits");
    let patches = Patches::prepare(&campaign, &mut Vec::new()).expect("random patches");
    let (measured, _) = measure(&campaign, &plan, &patches, &|_| {}).expect("no ray is lost");
    let examined = |m: Measured| {
        let verdict = examine(&m.table, &m.campaign, Some(&m.realisations));
        (m, verdict)
    };
    measured.into_iter().map(examined).collect()
}

fn hold(results: &[(Measured, Verdict)], bars: &[Bar]) {
    for &(alpha, theta_i, phi_i, bar) in bars {
        let of_alpha = |(m, _): &&(Measured, Verdict)| m.campaign.alphas()[0].is_some_and(|a| a.x == alpha);
        let (_, verdict) = results.iter().find(of_alpha).expect("a table for each alpha");
        let height =
            verdict.comparisons.iter().find(|c| c.masking == "height_correlated").expect("three maskings");
        let at = |stop: &&gonio::validate::compare::StopComparison| {
            stop.theta_i_deg == theta_i && stop.phi_i_deg == phi_i
        };
        let stop = height.stops.iter().find(at).expect("a stop");
        let (found, noise) = (stop.figures.l1_model.unwrap(), stop.figures.l1_noise.unwrap());
        println!("alpha {alpha} theta_i {theta_i} phi_i {phi_i}: {found:.4} of {bar} (noise {noise:.4})");
        // A figure counts where the noise is no larger than its bar.
        assert!(noise <= bar && found <= bar, "alpha {alpha}, {theta_i}, {phi_i}: {found} {noise}");
    }
}

#[test]
fn the_direction_correlated_masking_is_nearest_off_normal_incidence() {
    // 256^2 patches: the maskings differ from one another by the same light, whatever the patches' noise.
    let text = r#"
        name = "nearest"
        surface.realisations = 8
        surface.cells = 256
        surface.ggx.alpha = 0.5
        light.theta_i_deg = [30, 60, 75]
        sensor.hemisphere.bins = "aligned"
        stop.samples = 65536
    "#;
    let (_, verdict) = &run(text)[0];
    for stop in 0..3 {
        assert_eq!(
            nearest(&verdict.comparisons, |c| c.stops[stop].figures.l1).as_deref(),
            Some("direction_correlated")
        );
    }
    // Separable masking is off by about 0.1 at 75 degrees: it over-darkens. Noise here is about 0.03.
    let separable = &verdict.comparisons[0].stops[2].figures;
    assert!(separable.l1_model.unwrap() > 0.08, "{separable:?}");
}

#[test]
#[ignore = "takes minutes: cargo test --release -- --ignored"]
fn isotropic_surfaces_keep_their_bars() {
    let text = std::fs::read_to_string("configs/discrepancy.toml").expect("the campaign");
    let results = run(&text.replace("[0.05, 0.1, 0.2, 0.3, 0.5, 0.8]", "[0.1, 0.2, 0.5]"));
    let rows = [
        (0.1, [0.004, 0.005, 0.009, 0.016]),
        (0.2, [0.006, 0.008, 0.017, 0.032]),
        (0.5, [0.014, 0.024, 0.045, 0.056]),
    ];
    let angles = [0.0, 30.0, 60.0, 75.0];
    let bars: Vec<Bar> = rows
        .iter()
        .flat_map(|&(alpha, row)| angles.into_iter().zip(row).map(move |(t, b)| (alpha, t, 0.0, b)))
        .collect();
    hold(&results, &bars);
}

#[test]
#[ignore = "takes minutes: cargo test --release -- --ignored"]
fn a_brushed_surface_keeps_its_bars_at_every_azimuth() {
    let text = std::fs::read_to_string("configs/ggx_anisotropic.toml").expect("the campaign");
    let rows = [
        (0.0, [0.008, 0.010, 0.012, 0.025]),
        (45.0, [0.008, 0.013, 0.028, 0.045]),
        (90.0, [0.008, 0.015, 0.037, 0.053]),
    ];
    let angles = [0.0, 30.0, 60.0, 75.0];
    let bars: Vec<Bar> = rows
        .iter()
        .flat_map(|&(phi, row)| angles.into_iter().zip(row).map(move |(t, b)| (0.1, t, phi, b)))
        .collect();
    hold(&run(&text), &bars);
}
