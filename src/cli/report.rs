//! `gonio report`: the page of a stored table.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use super::table_file::{self, Opened};
use super::text::output;
use super::text::output::{Output, bytes, say, warn};
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::files;
use crate::job::paths;
use crate::report;
use crate::report::html::specimen;
use crate::report::{Page, Scene, summary};
use crate::table::{BrdfTable, TableRows, store};
use crate::validate::{self, Prediction, verdict};

/// Make one self-contained page of a table: figures, plots, pictures and a 3-D viewer
#[derive(Args)]
#[command(
    after_help = "The page asks for nothing over the network. <stem>.json and <stem>.realisations.exr beside the\n\
    table are used where they are there.\n\nExample: gonio report out/quickstart/quickstart.exr -o quickstart.html"
)]
pub struct Arguments {
    /// The table
    table: PathBuf,
    /// The page; a name that ends in .md: the provenance card [default: <stem>.html]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The answer of `gonio bench`, for the plot of error against samples
    #[arg(long, value_name = "FILE")]
    bench: Option<PathBuf>,
    /// Replace a file that is there and no page or card of this program
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let path = &arguments.table;
    let opened = table_file::open(path, verdict::row_bytes)?;
    let output = arguments.output.clone().unwrap_or_else(|| path.with_extension("html"));
    paths::spare(&output, [Some(path), arguments.bench.as_ref()].into_iter().flatten(), "command")?;
    let bench = arguments.bench.as_deref().map(bench_in).transpose()?;
    let is_card = output.extension().is_some_and(|end| end == "md");
    if !arguments.force {
        let (mark, what) =
            if is_card { (report::card::MARK, "card") } else { (report::html::page::MARK, "page") };
        paths::spare_foreign(&output, mark, what)?;
    }
    let text = match opened {
        Opened::Whole(table) if is_card => stored_card(path, &table)?,
        Opened::Whole(table) => stored_page(path, &table, bench.as_ref())?,
        Opened::Rows(mut rows) => by_rows(&mut rows, is_card, bench.as_ref())?,
    };
    files::write_atomically(&output, text.as_bytes())?;
    Output::default().line(format_args!(
        "report        {} ({})",
        output.display(),
        bytes(text.len() as u64)
    ))?;
    Ok(0)
}

/// The schema of summaries and of answers of `gonio bench` that are read.
const SCHEMA: u64 = 1;

const NO_CAMPAIGN: &str = "The table holds no campaign: its surface cannot be made anew.";

/// The card of a table from its file and the summary beside it.
fn stored_card(path: &Path, table: &BrdfTable) -> Result<String> {
    let campaign = table_file::campaign_if_any(path, table)?;
    let prediction = campaign.as_ref().and_then(|campaign| Prediction::of(campaign, &table.grid));
    report::card(table, &summary_of(path, table, campaign.as_ref(), prediction.as_ref())?)
}

/// The page or the card of a table that does not fit the memory.
fn by_rows(rows: &mut TableRows, is_card: bool, bench: Option<&Value>) -> Result<String> {
    let path = rows.path().to_path_buf();
    let campaign = table_file::campaign_if_any(&path, rows.header())?;
    let digest = rows.digest().unwrap_or_default().to_string();
    let beside = summary_beside(&path, rows.header(), || Ok(digest))?;
    if beside.is_some() || campaign.is_none() {
        rows.verify()?;
    }
    let mut facts = report::Facts::new(rows.grid(), rows.colours());
    let mut stops = Vec::new();
    if is_card || beside.is_none() {
        for band in rows.bands(table_file::band_bytes(), rows.row_bytes()) {
            let first_stop = band.start;
            let band = rows.take(&band.collect::<Vec<_>>())?;
            facts.add(&band, first_stop);
            stops.extend(summary::stops_of(&band));
        }
    }
    let summary = match (beside, &campaign) {
        (Some(summary), _) => summary,
        (None, None) => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            summary::of_stops(&stem, rows.header(), None, None, stops)
        }
        (None, Some(campaign)) => {
            let parts = table_file::realisations_beside_rows(rows)?;
            let bytes = table_file::band_bytes();
            let verdict = validate::examine_rows(rows, Some(campaign), parts.as_ref(), bytes)?;
            let surface = Some(&campaign.surface);
            summary::of_stops(&campaign.name, rows.header(), surface, Some(&verdict), stops)
        }
    };
    if is_card {
        let digest = rows.digest().unwrap_or("none").to_string();
        return Ok(report::card_of(rows.header(), &digest, facts, &summary));
    }
    let (table, kept) = report::thinned(rows, table_file::band_bytes())?;
    let summary = report::thinned_summary(&summary, &kept);
    let prediction = campaign.as_ref().and_then(|campaign| Prediction::of(campaign, &table.grid));
    let specimen = match &campaign {
        Some(campaign) => specimen::remade(campaign)?,
        None => Err(NO_CAMPAIGN.into()),
    };
    let sources =
        Sources { table: &table, campaign: campaign.as_ref(), prediction: prediction.as_ref(), specimen };
    Ok(page_of(sources, &summary, bench))
}

/// The summary beside a table, or what the table alone says.
fn summary_of(
    path: &Path,
    table: &BrdfTable,
    campaign: Option<&Campaign>,
    prediction: Option<&Prediction>,
) -> Result<Value> {
    match summary_beside(path, table, || store::digest(table))? {
        Some(summary) => Ok(summary),
        None => examined(path, table, campaign, prediction),
    }
}

/// The page of a table from its file and what lies beside it.
fn stored_page(path: &Path, table: &BrdfTable, bench: Option<&Value>) -> Result<String> {
    let campaign = table_file::campaign_if_any(path, table)?;
    let prediction = campaign.as_ref().and_then(|campaign| Prediction::of(campaign, &table.grid));
    let summary = summary_of(path, table, campaign.as_ref(), prediction.as_ref())?;
    let specimen = match &campaign {
        Some(campaign) => specimen::remade(campaign)?,
        None => Err(NO_CAMPAIGN.into()),
    };
    Ok(page_of(
        Sources { table, campaign: campaign.as_ref(), prediction: prediction.as_ref(), specimen },
        &summary,
        bench,
    ))
}

/// Where a page comes from besides its summary.
pub struct Sources<'a> {
    /// The table.
    pub table: &'a BrdfTable,
    /// What it was measured by.
    pub campaign: Option<&'a Campaign>,
    /// What theory says of it.
    pub prediction: Option<&'a Prediction>,
    /// Its first patch.
    pub specimen: specimen::ShownSpecimen,
}

/// The page, alike for a table just measured and for one from its file.
pub fn page_of(sources: Sources, summary: &Value, bench: Option<&Value>) -> String {
    let Sources { table, campaign, prediction, specimen } = sources;
    let realisations = campaign.map_or(0, |campaign| campaign.surface.realisations as usize);
    let masking = campaign.map(validate::expect::masking);
    let scene = Scene { table, prediction, realisations };
    report::page(&Page { scene, campaign, masking, summary, specimen, bench })
}

/// The answer of `gonio bench` in a file. Errors: of a file that is none, or of another version.
fn bench_in(path: &Path) -> Result<Value> {
    let bench = output::read_json(path)?;
    if bench["schema"] != SCHEMA || !bench["ladders"].is_array() || !bench["rows"].is_array() {
        let why = format!("is no answer of `gonio bench` (schema {SCHEMA}, rows and ladders needed)");
        return Err(Error::format(path, why));
    }
    Ok(bench)
}

/// The summary that `measure` wrote beside the table, if it is this table's: by its digest and, as older summaries have
/// none, by seed, patches and positions of the light.
fn summary_beside(
    path: &Path,
    table: &BrdfTable,
    digest: impl FnOnce() -> Result<String>,
) -> Result<Option<Value>> {
    let beside = path.with_extension("json");
    if !beside.is_file() {
        say(format_args!("note: {} is absent: cost and albedo by order are not known", beside.display()));
        return Ok(None);
    }
    let summary = output::read_json(&beside)?;
    if summary["schema"] != SCHEMA {
        warn(format_args!("{} is no summary of schema {SCHEMA} and is not used", beside.display()));
        return Ok(None);
    }
    let stops = summary["stops"].as_array().map_or(&[][..], Vec::as_slice);
    let is_at = |(stop, listed): (usize, &Value)| {
        let (theta, phi) = table.grid.stop_deg(stop);
        listed["theta_i_deg"] == theta && listed["phi_i_deg"] == phi
    };
    let same = summary["seed"] == table.seed
        && summary["patch_digest"] == *table.patch_digest
        && stops.len() == table.grid.stops()
        && stops.iter().enumerate().all(is_at)
        && (summary["table_digest"].is_null() || summary["table_digest"] == *digest()?);
    if !same {
        warn(format_args!("{} belongs to another table and is not used", beside.display()));
    }
    Ok(same.then_some(summary))
}

/// A summary from the table alone.
fn examined(
    path: &Path,
    table: &BrdfTable,
    campaign: Option<&Campaign>,
    prediction: Option<&Prediction>,
) -> Result<Value> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let Some(campaign) = campaign else {
        return Ok(summary::of_table(&stem, table, None, None));
    };
    let parts = table_file::realisations_beside(path, table)?;
    let verdict = validate::examine_against(table, campaign, parts.as_ref(), prediction);
    Ok(summary::of_table(&campaign.name, table, Some(&campaign.surface), Some(&verdict)))
}
