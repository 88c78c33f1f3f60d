//! Measures a rough metal in memory and prints its albedos with their errors.
//!
//!     cargo run --release --example measure

use std::path::Path;

use gonio::campaign;
use gonio::error::Result;
use gonio::job::Measurement;

const CAMPAIGN: &str = r#"
name = "rough_gold"
seed = 1
[surface]
realisations = 8
cells = 128
[surface.ggx]
alpha = 0.3
[light]
theta_i_deg = [0, 45, 75]
[sensor.hemisphere]
theta_r_bins = 18
phi_r_bins = 36
[optics]
material = "gold"
[stop]
samples = 65_536
"#;

/// Runs the example.
pub fn main() -> Result<()> {
    let campaign = campaign::parse(CAMPAIGN, "rough_gold.toml", Path::new("."))?.campaign;
    let tables = Measurement::new(campaign).run()?;
    for measured in &tables {
        println!("theta_i  albedo of one bounce, mean of the colours");
        for (index, incidence) in measured.incidences.iter().enumerate() {
            let theta = measured.table.grid.incidence_deg(index).0;
            // Unknown errors are not invented: a single patch has none.
            match incidence.single() {
                (Some(mean), Some(se)) => println!("{theta:>7}  {mean:.4} +- {se:.4}"),
                (Some(mean), None) => println!("{theta:>7}  {mean:.4} +- n/a"),
                _ => println!("{theta:>7}  not seen"),
            }
        }
    }
    Ok(())
}
