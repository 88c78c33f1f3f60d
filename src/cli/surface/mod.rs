//! `gonio surface`: the patches of a campaign as files, with the certificate of what they really have.

mod certificate;
mod patch_files;
mod roughness;

use std::path::PathBuf;

use clap::Args;

use self::certificate::{MapFigures, Pooled, RayBound};
use self::patch_files::{PatchJob, ROUGHNESS};
use self::roughness::RoughnessEntry;
use super::streams::folder;
use super::text::output::{Output, json_text, note, to_json, warn};
use super::text::progress::RunProgress;
use crate::campaign::{self, Parsed};
use crate::error::Result;
use crate::files;
use crate::job::paths;
use crate::measure;
use crate::report::plot;

/// Make the patches of a campaign and certify their slopes and heights
#[derive(Args)]
#[command(after_help = "Writes patch_000.exr ... (height, pitch_x, pitch_y) and, last, \
    certificate.json; of a measured map roughness.svg too.\n\nExample: gonio surface configs/quickstart.toml -o patches --npy")]
pub struct Arguments {
    /// The campaign, a TOML file
    campaign: PathBuf,
    /// Folder of the patches [default: out/<name>]
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    output: Option<PathBuf>,
    /// Write the same heights as patch_000.npy ... too
    #[arg(long)]
    npy: bool,
    /// Write each as a mesh too, patch_000.glb ... (glTF, for viewers)
    #[arg(long)]
    glb: bool,
    /// Seed instead of the campaign's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Replace patches that are there
    #[arg(long)]
    force: bool,
    /// Print the certificate as one JSON document
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let Parsed { mut campaign, notes: warnings, .. } = campaign::read(&arguments.campaign)?;
    campaign.seed = arguments.seed.unwrap_or(campaign.seed);
    measure::plan(&campaign)?;
    let (folder, _claim) = paths::open_folder(arguments.output.as_deref(), &campaign)?;
    let mut notes = Vec::new();
    let wanted = [("exr", true), ("npy", arguments.npy), ("glb", arguments.glb)];
    let ends = wanted.into_iter().filter(|(_, wanted)| *wanted).map(|(end, _)| end).collect();
    let job = PatchJob::new(&campaign, folder, ends, arguments.force, &mut notes)?;
    let areal = job.roughness(&mut notes)?;
    warnings.iter().for_each(warn);
    notes.iter().for_each(note);
    job.check_folder(&arguments.campaign)?;
    let progress = RunProgress::new(job.count, "patches");
    let (entries, slopes) = job.make_all(&progress)?;
    progress.finish();
    let pooled = Pooled::of(&entries, slopes.and_then(|slopes| slopes.ks()));
    let bounds = job.ray_bounds(&entries);
    let figures = job.figures(&entries);
    let mut document =
        job.document(&entries, &pooled, (&bounds, figures.as_ref()), &[warnings, notes].concat())?;
    if let Some(areal) = &areal {
        document["roughness"] = to_json(areal)?;
        let picture = plot::roughness::picture(&areal.before, &areal.after, areal.unit_um);
        job.put(&job.folder.join(ROUGHNESS), picture.as_bytes())?;
    }
    files::write_atomically(job.certificate(), format!("{}\n", json_text(&document)?).as_bytes())?;
    let mut out = Output::default();
    if arguments.json {
        out.json(&document)?;
    } else {
        out.lines(certificate::lines(&entries, &pooled, figures.is_some()))?;
        let others: String = job.ends[1..].iter().map(|end| format!(" and .{end}")).collect();
        let (last, pitch) = (job.name(job.count - 1, "exr"), job.pitch);
        out.line("")?;
        out.lines(figures.iter().flat_map(MapFigures::lines))?;
        out.lines(areal.iter().flat_map(RoughnessEntry::lines))?;
        out.lines(certificate::grain_lines(&entries))?;
        out.lines(RayBound::lines(&bounds))?;
        let plots = if areal.is_some() { format!(", {ROUGHNESS}") } else { String::new() };
        out.line(format_args!(
            "files   {} to {last}{others}{plots}, certificate.json in {}",
            job.name(0, "exr"),
            job.folder.display()
        ))?;
        if figures.is_none() {
            out.line(format_args!("pitch   {} x {} in the unit of the heights", pitch[0], pitch[1]))?;
        }
    }
    Ok(0)
}
