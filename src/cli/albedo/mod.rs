//! `gonio albedo`: tables of albedos, by formula or measured.

mod nodes;
mod text;

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::export::check_output;
use super::text::output::{Output, note, to_json, warn};
use super::text::progress::RunProgress;
use crate::albedo::Chosen;
use crate::albedo::files::Kind;
use crate::albedo::formula::{self, by_formula};
use crate::albedo::{self, AlbedoTable, Axes, Certificate};
use crate::campaign::{self, Parsed};
use crate::error::{Error, Result};
use crate::files::NewFile;
use crate::measure::{self, Patches};
use crate::theory::{Masking, Ndf};
use nodes::{Nodes, alpha_nodes, eta_nodes, law, masking, mu_nodes};

/// Cells of a quantity that a table may have.
const MOST_CELLS: usize = 1 << 20;

/// Albedo tables E(mu, alpha) or R, T(mu, alpha, eta), by formula or measured at all orders
#[derive(Args)]
#[command(
    after_help = "AXIS: a list 0.1,0.5; FROM:TO:N; of mu and alpha also N, middles of N parts of [0, 1] [default: 32].\n\n\
    Example: gonio albedo --grid --eta 1.1:2.4:8 -o glass.npz -o glass.h"
)]
pub struct Arguments {
    /// The campaign whose surface is measured, a TOML file
    #[arg(conflicts_with = "grid")]
    campaign: Option<PathBuf>,
    /// Order 1 by formula, without a campaign
    #[arg(long)]
    grid: bool,
    /// ggx, beckmann or student_t:GAMMA, 2 (ggx) to 100 [default: ggx]
    #[arg(long, value_name = "NAME", value_parser = law, conflicts_with = "campaign")]
    law: Option<Ndf>,
    /// height_correlated (the default), separable or direction_correlated
    #[arg(long, value_name = "NAME", value_parser = masking, conflicts_with = "campaign")]
    masking: Option<Masking>,
    /// Cosines of the light's polar angle
    #[arg(long, value_name = "AXIS", value_parser = mu_nodes)]
    mu: Option<Nodes>,
    /// Roughnesses
    #[arg(long, value_name = "AXIS", value_parser = alpha_nodes)]
    alpha: Option<Nodes>,
    /// Clear facets: index inside over outside
    #[arg(long, value_name = "AXIS", value_parser = eta_nodes)]
    eta: Option<Nodes>,
    /// A file of the table, .npz, .csv, .exr or .h (C and C++); may be given again
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Seed instead of the campaign's
    #[arg(long, value_name = "N", conflicts_with = "grid")]
    seed: Option<u64>,
    /// Replace files that are there
    #[arg(long)]
    force: bool,
    /// Print the table as one JSON document
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let files = arguments.open_files()?;
    let (table, certificate) = match &arguments.campaign {
        Some(path) => arguments.measured(path).map(|(table, certificate)| (table, Some(certificate)))?,
        None if arguments.grid => (arguments.by_formula()?, None),
        None => {
            return Err(Error::Usage(
                "a campaign that is measured, or --grid for a table by formula, is needed".into(),
            ));
        }
    };
    write(&table, files)?;
    let mut out = Output::default();
    if arguments.json {
        let texts: serde_json::Map<String, serde_json::Value> =
            table.texts().into_iter().map(|(name, text)| (name.to_string(), text.into())).collect();
        out.json(&json!({
            "texts": texts, "axes": to_json(&table.axes)?, "quantities": to_json(&table.quantities)?,
            "certificate": to_json(&certificate)?,
        }))?;
    } else {
        out.lines(text::lines(&table, certificate.as_ref()))?;
        out.lines(arguments.output.iter().map(|path| format!("file  {}", path.display())))?;
    }
    let failures = certificate.map(|certificate| certificate.failures()).unwrap_or_default();
    if failures.is_empty() { Ok(0) } else { Err(Error::Disagreement(failures.join("\nerror: "))) }
}

/// Puts the table into its files: all of them reach the disk before one takes its place.
fn write(table: &AlbedoTable, files: Vec<(&Path, Kind, NewFile)>) -> Result<()> {
    let mut whole = Vec::new();
    for (path, kind, mut file) in files {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        kind.write(table, &stem, &mut file).map_err(|why| Error::format(path, why))?;
        whole.push(file.on_disk()?);
    }
    whole.into_iter().try_for_each(NewFile::commit)
}

impl Arguments {
    /// The files, unfinished: what cannot be written is refused before anything is worked out.
    fn open_files(&self) -> Result<Vec<(&Path, Kind, NewFile)>> {
        let kinds = self.output.iter().map(|path| Kind::of(path)).collect::<Result<Vec<_>>>()?;
        if let Some((_, twice)) =
            self.output.iter().enumerate().find(|(k, path)| self.output[..*k].contains(path))
        {
            return Err(Error::Usage(format!("-o {}: is given twice", twice.display())));
        }
        let input = self.campaign.as_deref().unwrap_or("".as_ref());
        let mut files = Vec::new();
        for (path, kind) in self.output.iter().zip(kinds) {
            check_output(input, path, self.force)?;
            files.push((path.as_path(), kind, NewFile::create(path)?));
        }
        Ok(files)
    }

    fn by_formula(&self) -> Result<AlbedoTable> {
        let list = |nodes: &Option<Nodes>| nodes.clone().map_or(Nodes::middles(), |nodes| nodes.0);
        let eta = self.eta.clone().map_or(vec![], |nodes| nodes.0);
        let axes = Axes { mu: list(&self.mu), alpha: list(&self.alpha), eta };
        check_size(&axes)?;
        let progress = RunProgress::new(formula::work(&axes), "cells");
        let masking = self.masking.unwrap_or(Masking::HeightCorrelated);
        let ndf = self.law.unwrap_or(Ndf::Ggx);
        let table = by_formula(ndf, masking, &axes, &|cells| progress.add(cells));
        progress.finish();
        Ok(table)
    }

    fn measured(&self, path: &Path) -> Result<(AlbedoTable, Certificate)> {
        let Parsed { mut campaign, notes: warnings, .. } = campaign::read(path)?;
        campaign.seed = self.seed.unwrap_or(campaign.seed);
        let list = |nodes: &Option<Nodes>| nodes.clone().map(|nodes| nodes.0);
        let chosen = Chosen { mu: list(&self.mu), alpha: list(&self.alpha), eta: list(&self.eta) };
        let setup = albedo::campaign_of(&campaign, chosen)?;
        check_size(&setup.axes)?;
        let plan = measure::plan(&setup.campaign)?;
        if plan.parts().len() > 1 {
            return Err(Error::Refused(format!(
                "{}: does not fit the memory at once; fewer nodes",
                campaign.name
            )));
        }
        let mut notes = Vec::new();
        let patches = Patches::prepare(&setup.campaign, &mut notes)?;
        warnings.iter().chain(&setup.notes).for_each(warn);
        notes.iter().for_each(note);
        let progress = RunProgress::new(plan.total_samples, "samples");
        let measured = albedo::measure(&setup, &plan, &patches, &|samples| progress.add(samples));
        progress.finish();
        measured
    }
}

fn check_size(axes: &Axes) -> Result<()> {
    if axes.cells() <= MOST_CELLS {
        return Ok(());
    }
    Err(Error::Refused(format!("{} cells; a table has at most {MOST_CELLS}: fewer nodes", axes.cells())))
}
