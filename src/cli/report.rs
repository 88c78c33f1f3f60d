//! `gonio report`: the page of a stored table.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Deserialize;

use super::streams::Place;
use super::table_file::{self, Beside, Opened};
use super::text::numbers::bytes;
use super::text::output;
use super::text::output::{Output, note, warn};
use super::text::progress::Stage;
use crate::bench::{BenchAnswer, answer};
use crate::campaign::Campaign;
use crate::error::{Error, Result, on_one_line};
use crate::files::{self, STANDARD};
use crate::job::paths;
use crate::report;
use crate::report::html::specimen::FirstPatch;
use crate::report::summary::SCHEMA;
use crate::report::sweep::{CSV_MARK, NETCDF_MARK, ParameterSweep, SweptTable};
use crate::report::{Facts, IncidenceSummary, Page, Summary};
use crate::table::{BrdfTable, Realisations, TableRows, store};
use crate::validate::{self, Prediction, Verdict, verdict};

/// Make one self-contained page of a table: figures, plots, pictures and a 3-D viewer
#[derive(Args)]
#[command(
    after_help = "The page asks for nothing over the network. <stem>.json and <stem>.realisations.exr next to the
\
    table are used where they are there.\n\nExample: gonio report out/quickstart/quickstart.exr -o quickstart.html"
)]
pub struct Arguments {
    /// The table; several: a page of them side by side
    #[arg(required = true, value_name = "TABLE.exr")]
    tables: Vec<PathBuf>,
    /// The page [default: <stem>.html]; .md: the card; .csv, .nc: figures of several
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Fit the models of `gonio fit` to each of several tables, whatever it costs
    #[arg(long)]
    fit: bool,
    /// Answers of `gonio bench`, for the plot of error against samples, all in one
    #[arg(long, value_name = "FILE")]
    bench: Vec<PathBuf>,
    /// Replace a file that is there and no page or card of this program
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let tables = without_realisations(&arguments.tables);
    let [path] = &tables[..] else { return side_by_side(arguments, &tables) };
    if arguments.fit {
        return Err(Error::Usage("--fit is for several tables; of one: gonio fit".into()));
    }
    let output = arguments.output.clone().unwrap_or_else(|| beside(path));
    let place = Place::of(&output, false)?;
    let opened = table_file::open(path, verdict::row_bytes)?;
    paths::spare(place.path(), [path].into_iter().chain(&arguments.bench), "command")?;
    let benches = arguments.bench.iter().map(|path| bench_in(path)).collect::<Result<Vec<_>>>()?;
    let is_card = output.extension().is_some_and(|end| end == "md");
    if !is_card && output.extension().is_some_and(|end| end != "html" && end != "htm") {
        let why = "a page is .html, the card .md; a browser prints the page as a PDF";
        return Err(Error::Usage(format!("{}: {why}", output.display())));
    }
    let own = if is_card { (report::card::MARK, "card") } else { (report::html::render::MARK, "page") };
    arguments.spare(place.path(), own)?;
    let text = match opened {
        Opened::Whole(table) => whole(path, &table, is_card, &benches)?,
        Opened::Rows(mut rows) => by_rows(&mut rows, is_card, &benches)?,
    };
    write(place, &output, text.as_bytes())
}

/// The tables without the realisations of those among them, which `*.exr` names too.
fn without_realisations(paths: &[PathBuf]) -> Vec<PathBuf> {
    let belongs = |path: &PathBuf| {
        let stem = path.to_str().and_then(|name| name.strip_suffix(".realisations.exr"));
        stem.is_some_and(|stem| paths.contains(&format!("{stem}.exr").into()))
    };
    let (left_out, tables): (Vec<&PathBuf>, Vec<&PathBuf>) = paths.iter().partition(|path| belongs(path));
    if let [first, rest @ ..] = &left_out[..] {
        let more = if rest.is_empty() { String::new() } else { format!(" and {} more", rest.len()) };
        note(format_args!("left out: {}{more}, the realisations of a table that is given", first.display()));
    }
    tables.into_iter().cloned().collect()
}

/// The page next to a table; of one from stdin, stdout.
fn beside(table: &Path) -> PathBuf {
    if table == Path::new(STANDARD) { table.into() } else { table.with_extension("html") }
}

impl Arguments {
    /// Refuses to replace what does not say by its mark that it is one of ours.
    fn spare(&self, output: &Path, (mark, what): (&str, &str)) -> Result<()> {
        if self.force { Ok(()) } else { paths::spare_foreign(output, mark, what) }
    }
}

fn write(place: Place, output: &Path, text: &[u8]) -> Result<u8> {
    files::write_atomically(place.path(), text)?;
    let size = bytes(text.len() as u64);
    Output::default().line(format_args!("report        {} ({size})", output.display()))?;
    place.done().map(|()| 0)
}

/// A page of several tables, or the CSV of their figures.
fn side_by_side(arguments: &Arguments, tables: &[PathBuf]) -> Result<u8> {
    let Some(output) = &arguments.output else {
        return Err(Error::Usage(
            "several tables need a name for their page: -o FILE.html, or FILE.csv or FILE.nc for their figures".into(),
        ));
    };
    let ending = output.extension().unwrap_or_default().to_string_lossy();
    if ending == "md" {
        return Err(Error::Usage("a card is of one table: -o FILE.html, FILE.csv or FILE.nc".into()));
    }
    if !arguments.bench.is_empty() {
        return Err(Error::Usage("--bench belongs to the page of one table".into()));
    }
    let place = Place::of(output, false)?;
    paths::spare(place.path(), tables, "command")?;
    let own = match &*ending {
        "csv" => (CSV_MARK, "CSV of tables"),
        "nc" => (NETCDF_MARK, "NetCDF of tables"),
        _ => (report::html::render::MARK, "page"),
    };
    arguments.spare(place.path(), own)?;
    let name = output.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let tables = tables.iter().map(|path| swept(path, arguments.fit)).collect::<Result<Vec<_>>>()?;
    let sweep = ParameterSweep { name, tables };
    let bytes = match &*ending {
        "csv" => sweep.csv().into_bytes(),
        "nc" => sweep.netcdf().map_err(|why| Error::format(output, why))?,
        _ => sweep.page(false).into_bytes(),
    };
    write(place, output, &bytes)
}

/// A table with its summary, that next to it or one from the table alone; and its best fit, where it is cheap or asked for.
fn swept(path: &Path, fit: bool) -> Result<SweptTable> {
    let table = match table_file::open(path, verdict::row_bytes)? {
        Opened::Whole(table) => table,
        Opened::Rows(rows) => return Err(table_file::too_large(&rows)),
    };
    let campaign = table_file::campaign_if_any(path, &table)?;
    let beside = Beside::new(path, &table);
    let summary = summary_known(&beside, campaign.as_ref(), None)?;
    let swept = SweptTable::new(name_of(path), campaign.as_ref(), summary);
    if !fit && !swept.fit_is_cheap(table.grid.incidences() * table.grid.bins() * table.colours.len()) {
        return Ok(swept);
    }
    let _fitting = Stage::begin("fitting");
    Ok(swept.fitted(&table, campaign.as_ref(), beside.get()?))
}

/// A table's name by its file: on one line, and nothing that a spreadsheet takes for a formula.
fn name_of(path: &Path) -> String {
    let stem = on_one_line(&path.file_stem().unwrap_or_default().to_string_lossy());
    if stem.starts_with(['=', '+', '-', '@', ' ']) { format!("./{stem}") } else { stem }
}

const NO_CAMPAIGN: &str = "The table holds no campaign: its surface cannot be made anew.";

/// The card or the page of a table in memory.
fn whole(path: &Path, table: &BrdfTable, is_card: bool, benches: &[BenchAnswer]) -> Result<String> {
    let campaign = table_file::campaign_if_any(path, table)?;
    let prediction = campaign.as_ref().and_then(|campaign| Prediction::of(campaign, &table.grid));
    let beside = Beside::new(path, table);
    let summary = summary_known(&beside, campaign.as_ref(), prediction.as_ref())?;
    if is_card {
        return Ok(report::card(table, &store::digest(table)?, Facts::of(table), &summary));
    }
    page_of((table, beside.get()?), (campaign.as_ref(), prediction.as_ref()), &summary, benches)
}

/// The summary next to a table, else one from the table alone; `prediction` is made where there is none yet.
fn summary_known(
    beside: &Beside,
    campaign: Option<&Campaign>,
    prediction: Option<&Prediction>,
) -> Result<Summary> {
    let (path, table) = (beside.path, beside.table);
    if let Some(summary) = summary_beside(path, table, || store::digest(table))? {
        return Ok(summary);
    }
    let verdict = match campaign {
        Some(campaign) => {
            let parts = beside.get()?;
            let made = if prediction.is_none() { Prediction::of(campaign, &table.grid) } else { None };
            Some(validate::examine_against(table, campaign, parts, prediction.or(made.as_ref())))
        }
        None => None,
    };
    summary_of(path, table, campaign, verdict.as_ref(), IncidenceSummary::of_bins(table))
}

/// The card or the page of a table that does not fit the memory.
fn by_rows(rows: &mut TableRows, is_card: bool, benches: &[BenchAnswer]) -> Result<String> {
    let path = rows.path().to_path_buf();
    let campaign = table_file::campaign_if_any(&path, rows.header())?;
    let digest = rows.digest().unwrap_or_default().to_string();
    let beside = summary_beside(&path, rows.header(), || Ok(digest))?;
    if beside.is_some() || campaign.is_none() {
        rows.verify()?;
    }
    let mut facts = Facts::new(rows.grid(), rows.colours());
    let mut incidences = Vec::new();
    if is_card || beside.is_none() {
        for band in rows.bands(table_file::band_bytes(), rows.row_bytes()) {
            let first_incidence = band.start;
            let band = rows.take(&band.collect::<Vec<_>>())?;
            facts.add(&band, first_incidence);
            incidences.extend(IncidenceSummary::of_bins(&band));
        }
    }
    let summary = match beside {
        Some(summary) => summary,
        None => {
            let verdict = match &campaign {
                Some(campaign) => {
                    let parts = table_file::realisations_beside_rows(rows)?;
                    let bytes = table_file::band_bytes();
                    Some(validate::examine_rows(rows, Some(campaign), parts.as_ref(), bytes)?)
                }
                None => None,
            };
            summary_of(&path, rows.header(), campaign.as_ref(), verdict.as_ref(), incidences)?
        }
    };
    if is_card {
        return Ok(report::card(rows.header(), rows.digest().unwrap_or("none"), facts, &summary));
    }
    let (table, kept) = report::thinned(rows, table_file::band_bytes())?;
    let prediction = campaign.as_ref().and_then(|campaign| Prediction::of(campaign, &table.grid));
    page_of((&table, None), (campaign.as_ref(), prediction.as_ref()), &summary.thinned(&kept), benches)
}

/// A summary from the table alone.
fn summary_of(
    path: &Path,
    header: &BrdfTable,
    campaign: Option<&Campaign>,
    verdict: Option<&Verdict>,
    incidences: Vec<IncidenceSummary>,
) -> Result<Summary> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = campaign.map_or(&*stem, |campaign| &campaign.name);
    Summary::of_table(name, header, campaign.map(|campaign| &campaign.surface), verdict, incidences)
}

/// The page of a table from its file: its first patch is made anew.
fn page_of(
    (table, parts): (&BrdfTable, Option<&Realisations>),
    (campaign, prediction): (Option<&Campaign>, Option<&Prediction>),
    summary: &Summary,
    benches: &[BenchAnswer],
) -> Result<String> {
    let _shown = Stage::begin("making the page");
    let specimen =
        campaign.map_or(Ok(Err(NO_CAMPAIGN.into())), |campaign| FirstPatch::default().remade(campaign))?;
    let look = report::html::appearance::shown(table, parts);
    let page = Page::of(table, campaign, prediction, summary, specimen);
    Ok(report::page(&Page { benches, appearance: look.as_ref(), ..page }))
}

/// The answer of `gonio bench` in a file. Errors: of a file that is none, or of another version.
fn bench_in(path: &Path) -> Result<BenchAnswer> {
    match BenchAnswer::deserialize(output::read_json(path)?) {
        Ok(bench) if bench.schema == answer::SCHEMA => Ok(bench),
        other => {
            let why = other.err().map_or(String::new(), |why| format!(": {why}"));
            let schema = answer::SCHEMA;
            Err(Error::format(path, format!("is no answer of `gonio bench` of schema {schema}{why}")))
        }
    }
}

/// The summary that `measure` wrote next to the table, if it is this table's: by its digest and, as older summaries have
/// none, by seed, patches and positions of the light.
fn summary_beside(
    path: &Path,
    table: &BrdfTable,
    digest: impl FnOnce() -> Result<String>,
) -> Result<Option<Summary>> {
    let beside = path.with_extension("json");
    if !beside.is_file() {
        note(format_args!("{} is absent: cost and albedo by order are not known", beside.display()));
        return Ok(None);
    }
    let summary = match Summary::deserialize(output::read_json(&beside)?) {
        Ok(summary) if summary.schema == SCHEMA => summary,
        other => {
            let why = other.err().map_or(String::new(), |why| format!(": {why};"));
            warn(format_args!("{} is no summary of schema {SCHEMA}{why} and is not used", beside.display()));
            return Ok(None);
        }
    };
    let is_at = |(incidence, listed): (usize, &IncidenceSummary)| {
        table.grid.incidence_deg(incidence) == (listed.theta_i_deg, listed.phi_i_deg)
    };
    let same = summary.seed == table.seed
        && summary.patch_digest == table.patch_digest
        && summary.incidences.len() == table.grid.incidences()
        && summary.incidences.iter().enumerate().all(is_at)
        && match &summary.table_digest {
            Some(of_summary) => *of_summary == digest()?,
            None => true,
        };
    if !same {
        warn(format_args!("{} belongs to another table and is not used", beside.display()));
    }
    Ok(same.then_some(summary))
}
