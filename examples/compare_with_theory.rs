//! Measures a rough mirror and holds it against D F G/(4 |n.l||n.v|) with each masking: which part of the difference is
//! noise, and which is the model's own.
//!
//!     cargo run --release --example compare_with_theory

use std::path::Path;

use gonio::campaign;
use gonio::error::Result;
use gonio::job::Measurement;
use gonio::validate::examine;

const CAMPAIGN: &str = r#"
name = "rough_mirror"
seed = 1
[surface]
realisations = 8
cells = 128
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = [0, 30, 60]
[sensor.hemisphere]
theta_r_bins = 18
phi_r_bins = 36
[stop]
samples = 65_536
"#;

/// Runs the example.
pub fn main() -> Result<()> {
    let campaign = campaign::parse(CAMPAIGN, "rough_mirror.toml", Path::new("."))?.campaign;
    for measured in Measurement::new(campaign).run()? {
        let verdict = examine(&measured.table, &measured.campaign, Some(&measured.realisations));
        println!("masking               L1 distance    of it noise    of it the model");
        for comparison in &verdict.comparisons {
            let known = |value: Option<f64>| value.map_or("n/a".into(), |value| format!("{value:.4}"));
            let figures = &comparison.figures;
            let [l1, noise, model] = [figures.l1, figures.l1_noise, figures.l1_model].map(known);
            println!("{:<22}{l1:>11}{noise:>15}{model:>19}", comparison.masking);
        }
        println!("{}", verdict.verdict);
    }
    Ok(())
}
