//! `gonio bench`: run time against error.

pub(crate) mod against;
mod text;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::Value;

use super::streams::folder;
use super::text::output::{Output, json_text, note, parsed_json, warn};
use super::text::progress::RunProgress;
use super::text::resolution;
use crate::bench::{self, BenchAnswer, Other, Range, TruthKind};
use crate::campaign::{self, Campaign, Parsed, Resolution};
use crate::error::{Error, Fault, Result};
use crate::files::{self, Destination};
use crate::job::paths;
use crate::measure::Patches;
use crate::report::plot::ladders;
use crate::validate::prediction::model::Model;

/// Error against samples and time: ladders of runs, the fit err^2 = a/N + b^2, a plot
#[derive(Args)]
#[command(
    after_help = "Example: gonio bench configs/bench.toml --from 2^12 --to 2^20",
    after_long_help = "Writes bench.svg and bench.json to the folder. A random surface gets a second ladder, over\n\
    realisations: its b is free of the patches' spread. N: samples of a stop, all realisations.\n\
    With a [bench] table in the campaign it varies cells and correlation length instead. Several\n\
    campaigns: a folder each, and bench.svg of them all.\n\
    --against measures the same patches, azimuths and bins --replicates times as planned and by\n\
    another way: rays (samples from place to place instead of slope to slope), hemisphere (light in\n\
    all directions, not that into the apertures alone). It writes no files.\n\n\
    Example: gonio bench configs/bench.toml --from 2^12 --to 2^20"
)]
pub struct Arguments {
    /// The campaign, a TOML file with one roughness; several for one plot of them all
    #[arg(required = true, value_name = "CAMPAIGN")]
    campaigns: Vec<PathBuf>,
    /// Noise and time to an equal error by: rays, hemisphere
    #[arg(long, value_name = "WAY", value_parser = other, conflicts_with_all = LADDERS)]
    against: Option<Other>,
    /// The incidences on a patch of each of these sizes: time and bytes for each cell
    #[arg(long, value_name = "N,N,..", hide_short_help = true, value_delimiter = ',', value_parser = clap::value_parser!(u32).range(8..=16_384), conflicts_with_all = LADDERS, conflicts_with_all = ["against", "replicates"])]
    cells: Vec<u32>,
    /// What errors are counted from: model (if there is one) or reference
    #[arg(long, value_enum, value_name = "TRUTH", hide_possible_values = true)]
    truth: Option<Wanted>,
    /// Smallest N, as 4096 or 2^12 [default: the largest/4^5]
    #[arg(long, value_name = "N", value_parser = count)]
    from: Option<u64>,
    /// Largest N [default: the campaign's]
    #[arg(long, value_name = "N", value_parser = count)]
    to: Option<u64>,
    /// Largest number of realisations [default: 4 times the campaign's]
    #[arg(long, hide_short_help = true, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=65_536))]
    realisations_to: Option<u32>,
    /// Runs of each rung, each with a seed of its own
    #[arg(long, value_name = "R", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=1000))]
    replicates: u32,
    /// Folder of the results [default: out/<name>]
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    output: Option<PathBuf>,
    /// Replace the bench of another campaign
    #[arg(long, hide_short_help = true)]
    force: bool,
    /// Print one JSON document: rows and fit
    #[arg(long)]
    json: bool,
}

const LADDERS: [&str; 6] = ["truth", "from", "to", "realisations_to", "output", "force"];

fn other(text: &str) -> std::result::Result<Other, String> {
    let found = Other::ALL.into_iter().find(|other| other.name() == text);
    found.ok_or_else(|| "one of rays, hemisphere".into())
}

#[derive(Clone, Copy, ValueEnum)]
enum Wanted {
    Model,
    Reference,
}

/// A count: digits, with `_` between them, or 2^k.
fn count(text: &str) -> std::result::Result<u64, String> {
    let power = text.strip_prefix("2^").map(|k| k.parse().ok().and_then(|k| 1u64.checked_shl(k)));
    let value = power.unwrap_or_else(|| text.replace('_', "").parse().ok());
    value
        .filter(|n| (1..=1 << 50).contains(n))
        .ok_or_else(|| "a number such as 4096 or 2^12, up to 2^50".into())
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let [path] = &arguments.campaigns[..] else { return several(arguments) };
    let Parsed { campaign, notes, .. } = campaign::read(path)?;
    notes.iter().for_each(warn);
    one_roughness(&campaign, path)?;
    if let Some(other) = arguments.against {
        return against::against(&campaign, other, arguments.replicates, arguments.json);
    }
    if !arguments.cells.is_empty() {
        return against::sizes(&campaign, &arguments.cells, arguments.json);
    }
    if let Some(lists) = &campaign.bench {
        return resolution(arguments, path, &campaign, lists);
    }
    let mut out = Output::default();
    let answer = of_one(arguments, (path, &campaign), arguments.output.as_deref(), &mut out)?;
    if arguments.json {
        out.json(&answer)?;
    }
    Ok(0)
}

/// Several campaigns, one after the other, and one plot of their last ladders.
fn several(arguments: &Arguments) -> Result<u8> {
    if arguments.against.is_some() || !arguments.cells.is_empty() {
        return Err(Error::Usage("--against and --cells take one campaign at a time".into()));
    }
    let campaigns = arguments.campaigns.iter().map(|path| Ok((path, campaign::read(path)?.campaign)));
    let campaigns = campaigns.collect::<Result<Vec<_>>>()?;
    for (index, (path, campaign)) in campaigns.iter().enumerate() {
        one_roughness(campaign, path)?;
        let path = path.display();
        if campaign.bench.is_some() {
            return Err(Error::Usage(format!(
                "{path}: has a [bench] table: such a campaign is benched alone"
            )));
        }
        if campaigns[..index].iter().any(|(_, before)| before.name == campaign.name) {
            let name = &campaign.name;
            return Err(Error::Usage(format!(
                "{path}: name = \"{name}\" occurs twice; each has a folder of its own"
            )));
        }
    }
    let folder = arguments.output.clone().unwrap_or_else(|| "out/bench".into());
    let picture = Destination::at(folder.join("bench.svg"));
    if !arguments.force {
        paths::spare_foreign(&picture, ladders::MARK, "plot")?;
    }
    let (mut out, mut answers) = (Output::default(), Vec::new());
    for (path, campaign) in &campaigns {
        if !arguments.json {
            out.line(format_args!("== {}", campaign.name))?;
        }
        let own = folder.join(&campaign.name);
        answers.push(of_one(arguments, (path, campaign), Some(&own), &mut out)?);
    }
    files::write_atomically(&picture, ladders::picture_together(&answers).as_bytes())?;
    if arguments.json {
        out.json(&answers)?;
    } else {
        out.line(format_args!("all           {}", picture.display()))?;
    }
    Ok(0)
}

/// The ladders of one campaign: measured, written, and printed unless JSON is asked for.
fn of_one(
    arguments: &Arguments,
    (path, campaign): (&Path, &Campaign),
    folder: Option<&Path>,
    out: &mut Output,
) -> Result<BenchAnswer> {
    let kind = match arguments.truth {
        Some(Wanted::Model) => TruthKind::Model,
        Some(Wanted::Reference) => TruthKind::Reference,
        None if Model::of(campaign).is_some() => TruthKind::Model,
        None => TruthKind::Reference,
    };
    let range = Range {
        from: arguments.from,
        to: arguments.to,
        most_realisations: arguments.realisations_to,
        replicates: arguments.replicates,
    };
    let ladders = bench::planned(campaign, &range, kind)?;
    let resolved = campaign::to_toml(campaign);
    let [document, picture] = outputs(arguments, (path, campaign), folder, &resolved)?;
    let mut notes = Vec::new();
    let mut patches = Patches::prepare(campaign, &mut notes)?;
    notes.iter().for_each(note);
    let progress = RunProgress::new(ladders.total_samples(), "samples");
    let bench = bench::bench(campaign, ladders, &mut patches, &|starts| progress.add(starts))?;
    progress.finish();
    let answer = BenchAnswer::new(campaign, resolved, kind, &bench);
    files::write_atomically(&picture, ladders::picture(&answer).as_bytes())?;
    files::write_atomically(&document, format!("{}\n", json_text(&answer)?).as_bytes())?;
    if !arguments.json {
        out.lines(text::lines(&bench, arguments.replicates))?;
        out.line(format_args!("plot          {}", picture.display()))?;
        out.line(format_args!("figures       {}", document.display()))?;
    }
    Ok(answer)
}

/// The files that will be written; what is there must be of the same campaign.
fn outputs(
    arguments: &Arguments,
    (path, campaign): (&Path, &Campaign),
    folder: Option<&Path>,
    resolved: &str,
) -> Result<[Destination; 2]> {
    let (folder, _claim) = paths::open_folder(folder, campaign)?;
    let [document, picture] = ["bench.json", "bench.svg"].map(|name| Destination::at(folder.join(name)));
    paths::spare_inputs(&[&document, &picture], path, campaign)?;
    if !arguments.force {
        spare_another(&document, resolved)?;
        paths::spare_foreign(&picture, ladders::MARK, "plot")?;
    }
    Ok([document, picture])
}

/// A campaign with `[bench]`: every patch size with every correlation length, in place of ladders.
fn resolution(arguments: &Arguments, path: &Path, campaign: &Campaign, lists: &Resolution) -> Result<u8> {
    if arguments.from.or(arguments.to).is_some() || arguments.realisations_to.is_some() {
        let why = "--from, --to and --realisations-to are of ladders; [bench] varies cells and correlation";
        return Err(Error::Usage(why.into()));
    }
    let settings = bench::resolution::settings(campaign, lists)?;
    let resolved = campaign::to_toml(campaign);
    let [document, _] = outputs(arguments, (path, campaign), arguments.output.as_deref(), &resolved)?;
    let progress = RunProgress::new(settings.iter().map(|(_, plan)| plan.total_samples).sum(), "samples");
    let rows = bench::resolution(campaign, &settings, &|starts| progress.add(starts))?;
    progress.finish();
    let answer = resolution::answer(campaign, resolved, &rows)?;
    files::write_atomically(&document, format!("{}\n", json_text(&answer)?).as_bytes())?;
    let mut out = Output::default();
    if arguments.json {
        out.json(&answer)?;
        return Ok(0);
    }
    out.lines(resolution::lines(campaign, &rows))?;
    out.line(format_args!("figures       {}", document.display()))?;
    Ok(0)
}

/// One table at a time: a list of roughnesses is a fault of the campaign here.
fn one_roughness(campaign: &Campaign, path: &Path) -> Result<()> {
    let kind = campaign.surface.kind.name();
    let Some(alphas) = campaign.surface.kind.alphas() else { return Ok(()) };
    if alphas.len() == 1 {
        return Ok(());
    }
    let listed: Vec<String> = alphas.iter().map(|alpha| alpha.x.to_string()).collect();
    Err(Error::Campaign(vec![Fault {
        too_large: false,
        path: path.display().to_string(),
        line: None,
        column: None,
        key: format!("surface.{kind}.alpha"),
        value: Some(format!("[{}]", listed.join(", "))),
        allowed: "bench takes one roughness at a time".into(),
    }]))
}

/// Refuses to replace the bench of another campaign.
fn spare_another(document: &Path, resolved: &str) -> Result<()> {
    if !files::is_there(document) {
        return Ok(());
    }
    let found: Option<Value> = parsed_json(&files::read(document)?).ok();
    if found.is_some_and(|found| found["campaign"] == resolved) {
        note(format_args!("{} is measured again", document.display()));
        return Ok(());
    }
    Err(paths::already_exists(document, "is of another campaign or seed"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_digits_or_powers_of_two() {
        assert_eq!((count("4096"), count("65_536"), count("2^14")), (Ok(4096), Ok(65_536), Ok(16_384)));
        for wrong in ["", "2^", "2^64", "0", "-1", "1e6", "2^51"] {
            assert!(count(wrong).is_err(), "{wrong}");
        }
    }
}
