//! A campaign file whose seed or correlation length is a list: one campaign for each, with patches of its own.

use std::path::Path;

use super::parse::lists::run_lists::RunLists;
use super::{Campaign, Parsed, Preset, Uncertainty, name_for_messages, parse_with, read_bytes};
use crate::error::Result;

/// The runs of a campaign file.
pub struct CampaignRuns {
    /// One where no list makes several.
    pub runs: Vec<CampaignRun>,
    /// As in [`Parsed`].
    pub notes: Vec<String>,
    /// As in [`Parsed`].
    pub preset: Option<Preset>,
    /// As in [`Parsed`].
    pub uncertainty: Option<Uncertainty>,
}

/// One run.
pub struct CampaignRun {
    /// What tells its files from those of the other runs, as `seed_2` or `correlation_8`; `None` where it is the only one.
    pub label: Option<String>,
    /// What it measures.
    pub campaign: Campaign,
}

/// Reads the campaign file at `path` as [`super::read`] does; a list of seeds or of correlation lengths makes a run each.
// Tested by `lists_of_seeds_and_correlations_make_runs` (tests/it/sweeps.rs).
pub fn read_runs(path: &Path) -> Result<CampaignRuns> {
    let bytes = read_bytes(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let name = name_for_messages(path);
    let lists = RunLists::pick(0);
    let Parsed { campaign, notes, preset, uncertainty } = parse_with(&bytes, &name, folder, &lists)?;
    let Some(count) = lists.count() else {
        let runs = vec![CampaignRun { label: None, campaign }];
        return Ok(CampaignRuns { runs, notes, preset, uncertainty });
    };
    let rest = (1..count)
        .map(|run| parse_with(&bytes, &name, folder, &RunLists::pick(run)).map(|parsed| parsed.campaign));
    let all: Vec<Campaign> = std::iter::once(Ok(campaign)).chain(rest).collect::<Result<_>>()?;
    let by_seed = all.windows(2).any(|pair| pair[0].seed != pair[1].seed);
    let label = |one: &Campaign| match by_seed {
        _ if count == 1 => None,
        true => Some(format!("seed_{}", one.seed)),
        false => Some(format!("correlation_{}", one.surface.correlation_cells)),
    };
    let runs = all.into_iter().map(|campaign| CampaignRun { label: label(&campaign), campaign }).collect();
    Ok(CampaignRuns { runs, notes, preset, uncertainty })
}
