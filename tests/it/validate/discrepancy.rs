//! Promise: a random continuous surface stays as close to D G2/(4 cos cos) as the bars below say, noise taken off, and
//! the direction-correlated masking is the nearest one off normal incidence.

use std::path::Path;

use gonio::campaign;
use gonio::measure::{Measured, Patches, measure, plan};
use gonio::validate::compare::Comparison;
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
        let at = |incidence: &&gonio::validate::compare::IncidenceComparison| {
            incidence.theta_i_deg == theta_i && incidence.phi_i_deg == phi_i
        };
        let incidence = height.incidences.iter().find(at).expect("a stop");
        let (found, noise) = (incidence.figures.l1_model.unwrap(), incidence.figures.l1_noise.unwrap());
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
    for incidence in 0..3 {
        let l1 = |c: &&Comparison| c.incidences[incidence].figures.l1.expect("compared");
        let nearest = verdict.comparisons.iter().min_by(|a, b| l1(a).total_cmp(&l1(b)));
        assert_eq!(nearest.expect("three maskings").masking, "direction_correlated");
    }
    // Separable masking is off by about 0.1 at 75 degrees: it over-darkens. Noise here is about 0.03.
    let separable = &verdict.comparisons[0].incidences[2].figures;
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

/// alpha 0.3 at 30 degrees on 64 x 64 cells: eight patches at a time against 480 together. sqrt(l1^2 - l1_noise^2) read
/// 0.0192 on average where 480 patches show 0.0104: what noise adds in many bins was taken off as if it lay in one.
#[test]
#[ignore = "half a minute: cargo test --test it discrepancy -- --ignored --nocapture few_patches"]
fn few_patches_show_the_discrepancy_of_many() {
    let figures = |realisations: u32, seed: u32| {
        let results = run(&format!(
            "name = \"few\"\nseed = {seed}\n[surface]\nrealisations = {realisations}\ncells = 64\n\
             [surface.ggx]\nalpha = 0.3\n[light]\ntheta_i_deg = [30]\n[sensor.hemisphere]\n[trace]\nbounces = 1\n\
             [stop]\nsamples = 65_536\n"
        ));
        let comparison =
            results[0].1.comparisons.iter().find(|c| c.masking == "height_correlated").expect("compared");
        (comparison.figures, gonio::stats::mean(&comparison.by_part))
    };
    let (many, pooled) = figures(480, 1000);
    println!("480 patches: {many:?}");
    let seeds = 40;
    let all: Vec<_> = (1..=seeds).map(|seed| figures(8, seed)).collect();
    let (mean, se) = gonio::stats::mean_and_se(all.iter().map(|(_, distance)| *distance));
    let covered = all.iter().filter(|(few, _)| {
        let ends = few.l1_model_low.zip(few.l1_model_high).expect("8 realisations");
        (ends.0..=ends.1).contains(&pooled)
    });
    let (covered, se) = (covered.count(), se.expect("several seeds"));
    let old = |f: &gonio::validate::error_measures::Figures| {
        let (l1, noise) = f.l1.zip(f.l1_noise).expect("8 realisations");
        (l1 * l1 - noise * noise).max(0.0).sqrt()
    };
    let before = gonio::stats::mean(&all.iter().map(|(few, _)| old(few)).collect::<Vec<_>>());
    println!("8 patches: {mean:.4} +- {se:.4} (before: {before:.4}), covered {covered} of {seeds}");
    // Bias of a bin at most 0.21 of its standard error: 0.27 of l1_noise; and three errors of the mean.
    let noise = gonio::stats::mean(&all.iter().filter_map(|(few, _)| few.l1_noise).collect::<Vec<_>>());
    assert!((mean - pooled).abs() < 0.27 * noise + 3.0 * se, "{mean} {pooled}");
    assert!(covered >= 36, "{covered}");
}
