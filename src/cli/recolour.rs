//! `gonio recolour`: the table of another Schlick material, without another trace.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::export::check_output;
use super::table_file;
use super::text::output::{Output, columns, say, with_error};
use crate::campaign::{self, Optics, materials};
use crate::error::{Error, Result};
use crate::files::{self, NewFile};
use crate::instrument::GridKind;
use crate::instrument::angle_decimals;
use crate::stats;
use crate::table::recolour::recolour;
use crate::table::{BrdfTable, RealisationPart, Realisations, realisations, store};

/// Another Schlick material for a measured table, without another trace
#[derive(Args)]
#[command(
    after_help = "The table must hold the sums of Schlick's formula: any material or f0 does, but F = 1. Errors follow\n\
    from <stem>.realisations.exr beside it; without that file they are -1 (not available).\n\n\
    Example: gonio recolour out/gold/gold.exr --material copper -o copper.exr"
)]
pub struct Arguments {
    /// The table
    table: PathBuf,
    /// The new material, by its name
    #[arg(long, value_name = "NAME", required_unless_present = "f0", conflicts_with = "f0")]
    material: Option<String>,
    /// Reflectance at normal incidence instead: one number or R,G,B
    #[arg(long, value_name = "R,G,B", value_delimiter = ',')]
    f0: Vec<f64>,
    /// The new table; its realisations go beside it
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Replace files that are there
    #[arg(long)]
    force: bool,
    /// Print one JSON document: files, F0, albedos
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let f0 = wanted(arguments)?;
    let (path, output) = (&arguments.table, &arguments.output);
    let beside = table_file::realisations_path(output);
    check_output(path, output, arguments.force)?;
    check_output(&table_file::realisations_path(path), &beside, arguments.force)?;
    let table = table_file::load(path)?;
    let mut campaign = table_file::campaign_of(path, &table)?;
    let old = table_file::realisations_beside(path, &table)?;
    campaign.optics = Optics::Schlick { material: arguments.material.clone(), f0 };
    let text = campaign::to_toml(&campaign);
    let (new, parts) = recolour(&table, old.as_ref(), f0, text).map_err(|why| Error::format(path, why))?;
    if parts.is_none() {
        say(format_args!(
            "note: no realisations with the sums: the errors of {} are not available",
            output.display()
        ));
    } else if parts.as_ref().is_some_and(|all| all.parts.len() < campaign.surface.realisations as usize) {
        say("note: errors follow from groups of realisations, not from each");
    }
    // Both reach the disk before either takes its place: for want of room nothing is replaced.
    // Those that are there were kept: the new ones are of the same size.
    let staged = |parts| realisations::staged(&beside, parts, &new, realisations::limit(true));
    let (table, others) = (store::staged(output, &new)?, parts.as_ref().map(staged).transpose()?);
    table.commit()?;
    let others = others.and_then(|(_, file)| file);
    others.map_or_else(|| files::remove(&beside), NewFile::commit)?;
    let mut out = Output::default();
    let rows = albedos(&new, parts.as_ref());
    if arguments.json {
        let files = json!({ "table": output.display().to_string(), "material": arguments.material, "f0": f0,
            "realisations": parts.as_ref().map(|_| beside.display().to_string()),
            "stops": rows.iter().map(RecolouredStop::json).collect::<Vec<_>>() });
        out.json(&files)?;
        return Ok(0);
    }
    let decimals = [
        angle_decimals(2, rows.iter().map(|row| row.stop_deg.0)),
        angle_decimals(2, rows.iter().map(|row| row.stop_deg.1)),
    ];
    let texts: Vec<Vec<String>> = rows.iter().map(|row| row.text(decimals)).collect();
    out.lines(columns(&["theta_i", "phi_i", "albedo single", "albedo total"], &texts))?;
    out.line(format_args!("table         {}", output.display()))?;
    if parts.is_some() { out.line(format_args!("realisations  {}", beside.display())) } else { Ok(()) }
        .map(|()| 0)
}

/// F0 by the command line.
fn wanted(arguments: &Arguments) -> Result<[f64; 3]> {
    if let Some(name) = &arguments.material {
        return materials::named(name).map_err(|why| Error::Usage(format!("--material {name}: {why}")));
    }
    let f0 = match arguments.f0[..] {
        [gray] => [gray; 3],
        [r, g, b] => [r, g, b],
        _ => return Err(Error::Usage(format!("--f0: {} numbers; give one, or R,G,B", arguments.f0.len()))),
    };
    match f0.iter().find(|f0| !(0.0..=1.0).contains(*f0)) {
        Some(bad) => Err(Error::Usage(format!("--f0 {bad}: must lie in [0, 1]"))),
        None => Ok(f0),
    }
}

/// Albedos of a stop with their errors: order 1, and all orders. `None` for sensors that do not see all light.
struct RecolouredStop {
    stop_deg: (f64, f64),
    albedos: Option<[(f64, Option<f64>); 2]>,
}

impl RecolouredStop {
    fn json(&self) -> Value {
        let [single, total] = match self.albedos {
            Some(albedos) => albedos.map(|(mean, se)| (Some(mean), se)),
            None => [(None, None); 2],
        };
        json!({ "theta_i_deg": self.stop_deg.0, "phi_i_deg": self.stop_deg.1, "albedo_single": single.0,
            "albedo_single_se": single.1, "albedo_total": total.0, "albedo_total_se": total.1 })
    }

    /// Its words, the angles with so many decimals.
    fn text(&self, [of_theta, of_phi]: [usize; 2]) -> Vec<String> {
        let (theta, phi) = self.stop_deg;
        let texts = match self.albedos {
            Some(albedos) => albedos.map(|(mean, se)| with_error(mean, se)),
            None => ["not seen".to_string(), "not seen".into()],
        };
        [vec![format!("{theta:.of_theta$}"), format!("{phi:.of_phi$}")], texts.to_vec()].concat()
    }
}

fn albedos(table: &BrdfTable, parts: Option<&Realisations>) -> Vec<RecolouredStop> {
    let bins = table.grid.bins();
    let row = |stop: usize| {
        let sizes: Vec<f64> = table.grid.regions(stop).iter().map(|r| r.projected_solid_angle()).collect();
        let flux = |values: &[f32]| {
            values[stop * bins..]
                .iter()
                .zip(&sizes)
                .map(|(&value, size)| f64::from(value) * size)
                .sum::<f64>()
        };
        let mean = |colours: &mut dyn Iterator<Item = &Vec<f32>>| {
            stats::mean(&colours.map(|values| flux(values)).collect::<Vec<_>>())
        };
        let of = |of_table: f64, pick: fn(&RealisationPart) -> &Vec<Vec<f32>>| match parts {
            Some(all) => stats::mean_and_se(
                all.parts.iter().map(|part| mean(&mut pick(part).iter())).collect::<Vec<_>>().into_iter(),
            ),
            None => (of_table, None),
        };
        let single = of(mean(&mut table.colours.iter().map(|colour| &colour.single)), |part| &part.single);
        let total = of(mean(&mut table.colours.iter().map(|colour| &colour.total)), |part| &part.total);
        let whole = table.grid.kind == GridKind::Hemisphere;
        RecolouredStop { stop_deg: table.grid.stop_deg(stop), albedos: whole.then_some([single, total]) }
    };
    (0..table.grid.stops()).map(row).collect()
}
