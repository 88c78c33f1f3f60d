//! Measures a brushed metal and writes it as the `.bsdf` file that Mitsuba's `measured` plugin reads.
//!
//!     cargo run --release --example export_for_mitsuba [FILE]

use std::path::{Path, PathBuf};

use gonio::campaign;
use gonio::error::Result;
use gonio::interchange::{Format, Options, export};
use gonio::job::Measurement;

const CAMPAIGN: &str = r#"
name = "brushed"
seed = 1
[surface]
realisations = 4
cells = 128
[surface.ggx]
alpha_x = 0.4
alpha_y = 0.6
[light]
theta_i_deg = [0, 15, 30, 45, 60]
azimuth = "absolute"
phi_i_deg = [0, 30, 60, 90]
[sensor.hemisphere]
theta_r_bins = 18
phi_r_bins = 36
[optics]
material = "copper"
[stop]
samples = 65_536
"#;

/// Runs the example.
pub fn main() -> Result<()> {
    let file = std::env::args_os().nth(1).map_or("brushed.bsdf".into(), PathBuf::from);
    write(&file)
}

/// Measures, and writes the file.
pub fn write(file: &Path) -> Result<()> {
    let campaign = campaign::parse(CAMPAIGN, "brushed.toml", Path::new("."))?.campaign;
    for measured in Measurement::new(campaign).run()? {
        let written = export(&measured.table, Format::Rgl, &Options::default(), file)?;
        println!("{}: {}", file.display(), written.convention);
        // The file's own reader against the table's bins.
        if let Some(read_back) = written.read_back {
            println!("mean distance from the table: {:.2} %", 100.0 * read_back.l1);
        }
        written.notes.iter().for_each(|note| println!("note: {note}"));
    }
    Ok(())
}
