//! Where results go: the folder, the files of each table, and what lies there already.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::watcher::Watcher;
use crate::campaign::{self, Alpha, Campaign, Optics, SurfaceKind, quoted};
use crate::error::{Error, Result};
use crate::files::{self, Claim, Destination};
use crate::report::card;
use crate::report::html::render;
use crate::table::{BrdfTable, TableRows, realisations};

/// Bytes within which a file says what it is.
const HEAD: u64 = 1 << 16;

/// The output folder: `wanted`, or `out/<name>`.
pub fn folder_of(wanted: Option<&Path>, campaign: &Campaign) -> PathBuf {
    wanted.map_or_else(|| Path::new("out").join(&campaign.name), Path::to_path_buf)
}

/// The output folder, ready to take files, and the claim under which they are written.
pub fn open_folder(wanted: Option<&Path>, campaign: &Campaign) -> Result<(PathBuf, Arc<Claim>)> {
    let folder = folder_of(wanted, campaign);
    let claim = files::create_folder(&folder)?;
    Ok((folder, claim))
}

/// Refuses to write over what the campaign reads.
pub fn spare_inputs(outputs: &[&Path], file: &Path, campaign: &Campaign) -> Result<()> {
    let map = match &campaign.surface.kind {
        SurfaceKind::File(map) => Some(map.resolved_path.as_path()),
        _ => None,
    };
    let inputs: Vec<&Path> = [Some(file), map].into_iter().flatten().collect();
    outputs.iter().try_for_each(|output| spare(output, inputs.iter().copied(), "campaign"))
}

/// Refuses to write over a file that is read.
pub fn spare(output: &Path, inputs: impl IntoIterator<Item = impl AsRef<Path>>, by: &str) -> Result<()> {
    let Ok(there) = fs::canonicalize(output) else { return Ok(()) };
    let is_input = |path: &Path| fs::canonicalize(path).is_ok_and(|path| path == there);
    if inputs.into_iter().any(|path| is_input(path.as_ref())) {
        let what = format!("is read by this {by} and would be overwritten; choose another -o");
        return Err(Error::format(output, what));
    }
    Ok(())
}

/// The files of one table, and what lay there when they were named. The summary is written last: where it is, the table is finished.
#[derive(Clone)]
pub struct TablePaths {
    /// The roughness, where there is one.
    pub alpha: Option<Alpha>,
    /// The material.
    pub optics: Optics,
    /// The table.
    pub table: Destination,
    /// Its realisations.
    pub realisations: Destination,
    /// Its summary.
    pub summary: Destination,
    /// Its page.
    pub page: Destination,
    /// Its provenance card.
    pub card: Destination,
    /// What it is measured by: one roughness, one material.
    pub one: Campaign,
    campaign: String,
}

impl TablePaths {
    /// The files of every table of a campaign.
    pub fn of(campaign: &Campaign, folder: &Path) -> Vec<TablePaths> {
        TablePaths::of_run(campaign, folder, None)
    }

    /// The same of one of several runs, whose label all its files have.
    pub fn of_run(campaign: &Campaign, folder: &Path, label: Option<&str>) -> Vec<TablePaths> {
        let (alphas, materials) = (campaign.alphas(), campaign.optics.each());
        let (several_alphas, several_materials) = (alphas.len() > 1, materials.len() > 1);
        let paths = |(alpha, optics): (Option<Alpha>, &Optics)| {
            let one = alpha.map_or_else(|| campaign.clone(), |alpha| campaign.with_alpha(alpha));
            let one = one.with_optics(optics);
            let mut stem = run_stem(&campaign.name, label);
            if let (Some(alpha), true) = (alpha, several_alphas) {
                stem = format!("{stem}_{}", alpha.label());
            }
            if several_materials {
                stem = format!("{stem}_{}", optics.label());
            }
            let file = |ending: &str| Destination::at(folder.join(format!("{stem}{ending}")));
            TablePaths {
                alpha,
                optics: optics.clone(),
                table: file(".exr"),
                realisations: file(".realisations.exr"),
                summary: file(".json"),
                page: file(".html"),
                card: file(".card.md"),
                campaign: campaign::to_toml(&one),
                one,
            }
        };
        let pairs = alphas.into_iter().flat_map(|alpha| materials.iter().map(move |&optics| (alpha, optics)));
        pairs.map(paths).collect()
    }

    /// Whether this is the table of `measured`.
    pub fn is_of(&self, measured: &BrdfTable) -> bool {
        measured.campaign == self.campaign
    }

    /// Whether the table is there and finished. A table of another campaign, or a file that is no table, is an
    /// error; one of this campaign without its summary is of a run that was ended, and is made again.
    pub fn is_finished(&self, watcher: &dyn Watcher) -> Result<bool> {
        let finished = self.summary.exists();
        if !files::is_there(&self.table) {
            let stray = [&self.summary, &self.realisations].into_iter().find(|path| files::is_there(path));
            if let Some(path) = stray {
                return Err(already_exists(path, "is there without its table"));
            }
            return self.spare_others().map(|()| false);
        }
        let mut rows = TableRows::open(&self.table)
            .map_err(|e| already_exists(&self.table, &format!("is no table ({e})")))?;
        rows.verify().map_err(|e| already_exists(&self.table, &format!("is no table ({e})")))?;
        let header = rows.header();
        if header.campaign != self.campaign {
            return Err(already_exists(&self.table, "was measured by another campaign or seed"));
        }
        if finished && header.version != env!("CARGO_PKG_VERSION") {
            let version = quoted(&header.version);
            watcher.warn(&format!("{} was measured by version {version}", self.table.display()));
        }
        if !finished {
            self.spare_others()?;
        }
        Ok(finished)
    }

    /// Refuses to replace what this program did not write.
    fn spare_others(&self) -> Result<()> {
        spare_foreign(&self.realisations, realisations::TABLE_DIGEST, "realisations")?;
        spare_foreign(&self.page, render::MARK, "page")?;
        spare_foreign(&self.card, card::MARK, "card")
    }

    /// All its files.
    pub fn paths(&self) -> [&Path; 5] {
        [&self.table, &self.realisations, &self.summary, &self.page, &self.card]
    }
}

/// What the names of a run's files begin with.
pub fn run_stem(name: &str, label: Option<&str>) -> String {
    label.map_or_else(|| name.to_string(), |label| format!("{name}_{label}"))
}

/// Refuses to replace a file that does not say near its beginning, by `mark`, that this program wrote it.
pub fn spare_foreign(path: &Path, mark: &str, what: &str) -> Result<()> {
    if !files::is_there(path) {
        return Ok(());
    }
    let mut head = Vec::new();
    files::open(path)?.take(HEAD).read_to_end(&mut head).map_err(|e| Error::io(path, e))?;
    let is_own = head.windows(mark.len()).any(|bytes| bytes == mark.as_bytes());
    if is_own { Ok(()) } else { Err(already_exists(path, &format!("is no {what} of this program"))) }
}

/// The refusal to replace a file, or to write where a folder is.
pub fn already_exists(path: &Path, what: &str) -> Error {
    if path.is_dir() {
        return Error::format(path, "is a folder; name a file in it");
    }
    Error::format(path, format!("{what}; --force replaces it, another name or folder leaves it as it is"))
}
