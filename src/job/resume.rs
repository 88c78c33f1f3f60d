//! Runs that were ended: what there is to be resumed, and which tables they measured.

use std::path::Path;

use super::paths::TablePaths;
use super::watcher::Watcher;
use crate::campaign::{self, Campaign, Optics};
use crate::error::{Error, Result};
use crate::measure::{ResumableRun, RunFiles};

/// The run that lies there to be resumed, if it is asked for. One that is not asked for is refused, or removed by force.
pub(super) fn find(
    files: &RunFiles,
    resume: bool,
    force: bool,
    watcher: &dyn Watcher,
) -> Result<ResumableRun> {
    if !resume {
        return match files.any()? {
            Some(_) if force => files.remove().map(|()| ResumableRun::default()),
            Some(path) => {
                let what = "keeps an unfinished run; --resume resumes it, --force starts again, -o DIR writes elsewhere";
                Err(Error::format(&path, what))
            }
            None => Ok(ResumableRun::default()),
        };
    }
    let found = files.load()?;
    if let Some(checkpoint) = &found.under_way {
        checkpoint.passed_over.iter().for_each(|why| {
            watcher.warn(&format!("{why}; the one before, {}, is used", checkpoint.path.display()));
        });
    }
    if found.headers().next().is_none() {
        watcher.note("no checkpoint is there, all is measured from the beginning");
    }
    Ok(found)
}

/// Which of `all` tables a run measured: `open` may be fewer, where it was ended while it wrote them.
pub(super) fn measured<'a>(
    found: &ResumableRun,
    all: &'a [TablePaths],
    open: &[&'a TablePaths],
) -> Vec<&'a TablePaths> {
    let kept = found.headers().next().map(|(_, header)| header.campaign.as_str());
    let kept = kept.and_then(|text| campaign::parse(text, "campaign", Path::new("")).ok());
    let Some(kept) = kept.map(|parsed| parsed.campaign) else { return open.to_vec() };
    let (alphas, optics) = (kept.alphas(), kept.optics.each());
    let is_measured = |paths: &&TablePaths| alphas.contains(&paths.alpha) && optics.contains(&&paths.optics);
    let measured: Vec<&TablePaths> = all.iter().filter(is_measured).collect();
    let covers = open.iter().all(|open| measured.iter().any(|paths| *paths.table == *open.table));
    if covers { measured } else { open.to_vec() }
}

/// The campaign with the roughnesses and materials of `some` tables alone. They share patches and draws: the tables stay
/// the same.
pub(super) fn campaign_of(campaign: &Campaign, some: &[&TablePaths]) -> Campaign {
    let mut part = campaign.clone();
    if let Some(alphas) = part.surface.kind.alphas_mut() {
        alphas.retain(|alpha| some.iter().any(|paths| paths.alpha == Some(*alpha)));
    }
    if let Optics::Several(all) = &mut part.optics {
        all.retain(|optics| some.iter().any(|paths| paths.optics == *optics));
        if let [one] = &all[..] {
            part.optics = one.clone();
        }
    }
    part
}
