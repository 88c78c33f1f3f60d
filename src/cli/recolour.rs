//! `gonio recolour`: the table of another Schlick material, without another trace.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;
use serde_json::json;

use super::export::check_output;
use super::streams::of_two;
use super::table_file;
use super::text::layout::columns;
use super::text::numbers::with_error;
use super::text::output::{Output, note, to_json};
use super::text::progress::Stage;
use crate::campaign::{self, Optics, materials};
use crate::error::{Error, Result};
use crate::files::{self, Destination, NewFile};
use crate::instrument::{GridKind, IncidenceAngles};
use crate::stats;
use crate::table::brdf_table::flux;
use crate::table::recolour::recolour;
use crate::table::{BrdfTable, ColourChannels, RealisationPart, Realisations, realisations, store};

/// Another Schlick material for a measured table, without another trace
#[derive(Args)]
#[command(
    after_help = "The table must hold the sums of Schlick's formula: any material or f0 does, but F = 1. Errors follow\n\
    from <stem>.realisations.exr next to it; without that file they are -1 (not available).\n\n\
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
    /// The new table; its realisations go next to it
    #[arg(short, long, value_name = "FILE", value_parser = of_two())]
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
    let (path, output) = (&arguments.table, &Destination::at(&arguments.output));
    let beside = Destination::at(table_file::realisations_path(output));
    check_output(path, output, arguments.force)?;
    check_output(&table_file::realisations_path(path), &beside, arguments.force)?;
    let stage = Stage::begin("recolouring");
    let table = table_file::load(path)?;
    let mut campaign = table_file::campaign_of(path, &table)?;
    let old = table_file::realisations_beside(path, &table)?;
    campaign.optics = Optics::Schlick { material: arguments.material.clone(), f0 };
    let text = campaign::to_toml(&campaign);
    let (new, parts) = recolour(&table, old.as_ref(), f0, text).map_err(|why| Error::format(path, why))?;
    if parts.is_none() {
        note(format_args!(
            "no realisations with the sums: the errors of {} are not available",
            output.display()
        ));
    } else if parts.as_ref().is_some_and(|all| all.parts.len() < campaign.surface.realisations as usize) {
        note("errors follow from groups of realisations, not from each");
    }
    // Both reach the disk before either takes its place: for want of room nothing is replaced.
    // Those that are there were kept: the new ones are of the same size.
    let staged = |parts| realisations::staged(&beside, parts, &new, realisations::limit(true));
    let (table, others) = (store::staged(output, &new)?, parts.as_ref().map(staged).transpose()?);
    let others = others.and_then(|(_, file)| file);
    others.as_ref().map_or(Ok(()), NewFile::check_place)?;
    table.commit()?;
    others.map_or_else(|| files::remove(&beside), NewFile::commit)?;
    drop(stage);
    let mut out = Output::default();
    let incidences: Vec<RecolouredIncidence> = (0..new.grid.incidences())
        .map(|incidence| RecolouredIncidence::of(&new, parts.as_ref(), incidence))
        .collect();
    if arguments.json {
        let files = json!({ "table": output.display().to_string(), "material": arguments.material, "f0": f0,
            "realisations": parts.as_ref().map(|_| beside.display().to_string()), "stops": to_json(&incidences)? });
        out.json(&files)?;
        return Ok(0);
    }
    let angles = IncidenceAngles::of(&new.grid);
    let text = |mean: Option<f64>, se| mean.map_or("not seen".into(), |mean| with_error(mean, se));
    let row = |(index, incidence): (usize, &RecolouredIncidence)| {
        let albedos = [
            text(incidence.albedo_single, incidence.albedo_single_se),
            text(incidence.albedo_total, incidence.albedo_total_se),
        ];
        [angles.texts(index), albedos].concat()
    };
    let rows: Vec<Vec<String>> = incidences.iter().enumerate().map(row).collect();
    out.lines(columns(&["theta_i", "phi_i", "albedo single", "albedo total"], &rows))?;
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

/// Albedos of an incidence with their errors: order 1, and all orders; null for sensors that do not see all light.
#[derive(Default, Serialize)]
struct RecolouredIncidence {
    theta_i_deg: f64,
    phi_i_deg: f64,
    albedo_single: Option<f64>,
    albedo_single_se: Option<f64>,
    albedo_total: Option<f64>,
    albedo_total_se: Option<f64>,
}

impl RecolouredIncidence {
    fn of(table: &BrdfTable, parts: Option<&Realisations>, incidence: usize) -> Self {
        let (theta_i_deg, phi_i_deg) = table.grid.incidence_deg(incidence);
        let angles = RecolouredIncidence { theta_i_deg, phi_i_deg, ..RecolouredIncidence::default() };
        if table.grid.kind != GridKind::Hemisphere {
            return angles;
        }
        let sizes = table.grid.sizes(incidence);
        let mean = |colours: &mut dyn Iterator<Item = &Vec<f32>>| {
            let flux = |values: &Vec<f32>| flux(&values[incidence * sizes.len()..], &sizes);
            stats::mean(&colours.map(flux).collect::<Vec<_>>())
        };
        let of = |of_table: fn(&ColourChannels) -> &Vec<f32>,
                  pick: fn(&RealisationPart) -> &Vec<Vec<f32>>| match parts {
            Some(all) => {
                let means: Vec<f64> = all.parts.iter().map(|part| mean(&mut pick(part).iter())).collect();
                stats::mean_and_se(means.into_iter())
            }
            None => (mean(&mut table.colours.iter().map(of_table)), None),
        };
        let (single, albedo_single_se) = of(|colour| &colour.single, |part| &part.single);
        let (total, albedo_total_se) = of(|colour| &colour.total, |part| &part.total);
        let (albedo_single, albedo_total) = (Some(single), Some(total));
        RecolouredIncidence { albedo_single, albedo_single_se, albedo_total, albedo_total_se, ..angles }
    }
}
