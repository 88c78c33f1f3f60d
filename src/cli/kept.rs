//! A run that can be ended and gone on with: its checkpoint, and the signals that end it.

use std::ffi::OsString;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::measure::Arguments;
use super::output::{grouped, say, warn};
use super::targets::Target;
use crate::campaign::{self, Campaign};
use crate::error::{Error, Result};
use crate::measure::{Checkpoint, Found, Ledger, Plan, Shard};

/// What a process that is asked to end says to whom it was started by.
const INTERRUPTED: i32 = 130;

/// The unfinished run that lies there, if it is asked for. One that is not asked for is in the way, or removed by
/// force.
pub fn find(checkpoint: &Checkpoint, resume: bool, force: bool) -> Result<Option<Found>> {
    if resume {
        let found = checkpoint.load()?;
        match &found {
            Some(found) => found.passed_over.iter().for_each(|why| {
                warn(format_args!("{why}; the one before, {}, is used", found.path.display()));
            }),
            None => say("note: no checkpoint is there, all is measured from the beginning"),
        }
        return Ok(found);
    }
    match checkpoint.path() {
        Some(_) if force => checkpoint.remove().map(|()| None),
        Some(path) => {
            let what = "keeps an unfinished run; --resume goes on with it, --force starts again, -o DIR writes elsewhere";
            Err(Error::format(path, what))
        }
        None => Ok(None),
    }
}

/// Which of `all` tables a run that was found measured: `open` may be fewer, where it was ended while it wrote them.
pub fn measured_by<'a>(found: &Found, all: &'a [Target], open: Vec<&'a Target>) -> Vec<&'a Target> {
    let parsed = campaign::parse(&found.kept.heading.campaign, "campaign", Path::new(""));
    let Ok(kept) = parsed.map(|parsed| parsed.campaign) else { return open };
    let (alphas, optics) = (kept.alphas(), kept.optics.each());
    let measured = |target: &&Target| alphas.contains(&target.alpha) && optics.contains(&&target.optics);
    let measured: Vec<&Target> = all.iter().filter(measured).collect();
    let covers = open.iter().all(|open| measured.iter().any(|target| target.table == open.table));
    if covers { measured } else { open }
}

/// The ledger to go on with: that of the found run, which must be of this campaign, or an empty one.
pub fn ledger(found: Option<Found>, campaign: &Campaign, plan: &Plan, file: &Path) -> Result<Ledger> {
    let Some(Found { path, kept, .. }) = found else { return Ok(Ledger::new(campaign, plan)) };
    let faults =
        kept.faults((campaign, plan.shard), &file.display().to_string(), &path.display().to_string());
    if !faults.is_empty() {
        return Err(Error::Campaign(faults));
    }
    let ledger = kept.ledger(campaign, plan);
    let ledger = ledger.map_err(|why| Error::format(&path, format!("{why}; --force starts again")))?;
    let (starts, percent) = (grouped(ledger.starts(plan)), ledger.percent(plan));
    say(format_args!("note: goes on from {}: {starts} samples, {percent:.1} %", path.display()));
    Ok(ledger)
}

/// Removes the checkpoint of a run whose tables are all there; that of another campaign stays.
pub fn remove_finished(checkpoint: &Checkpoint, campaign: &Campaign, shard: Option<Shard>) -> Result<()> {
    if checkpoint.path().is_none() {
        return Ok(());
    }
    match checkpoint.load() {
        Ok(Some(found)) if found.kept.faults((campaign, shard), "", "").is_empty() => checkpoint.remove(),
        _ => Ok(()),
    }
}

/// A flag that the first SIGINT or SIGTERM sets; the second ends the process at once.
pub fn interruption() -> Result<Arc<AtomicBool>> {
    let asked = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the flag is not set yet when the first signal is looked at.
        flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&asked))
            .and_then(|_| flag::register(signal, Arc::clone(&asked)))
            .map_err(|e| Error::Internal(format!("signal {signal}: {e}")))?;
    }
    Ok(asked)
}

/// An interruption with the command that goes on.
pub fn with_advice(error: Error, checkpoint: &Checkpoint, arguments: &Arguments) -> Error {
    match error {
        Error::Interrupted(when) if checkpoint.path().is_some() => {
            Error::Interrupted(format!("{when}; go on with: {}", arguments.again()))
        }
        Error::Interrupted(_) => Error::Interrupted("before anything was measured".into()),
        other => other,
    }
}

/// A word of a command line, quoted where a shell would not take it as it is.
pub fn quoted(word: impl Into<OsString>) -> String {
    let word = word.into().to_string_lossy().into_owned();
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("out/a-1.toml"), "out/a-1.toml");
        assert_eq!(quoted("my folder"), "'my folder'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
    }
}
