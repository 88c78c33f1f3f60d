//! A run that can be ended and resumed: what it keeps, and what is said of that.

use std::ffi::OsString;
use std::path::Path;

use super::measure::Arguments;
use super::targets::TablePaths;
use super::text::output::{bytes, grouped, say, warn};
use crate::campaign;
use crate::error::{Error, Result};
use crate::files;
use crate::measure::{Disk, Pace, Plan, ResumableRun, RunFiles};

/// The run that lies there to be resumed, if it is asked for. One that is not asked for already exists and is refused, or
/// removed by force.
pub fn find(files: &RunFiles, resume: bool, force: bool) -> Result<ResumableRun> {
    if resume {
        return load(files);
    }
    match files.any()? {
        Some(_) if force => files.remove().map(|()| ResumableRun::default()),
        Some(path) => {
            let what =
                "keeps an unfinished run; --resume resumes it, --force starts again, -o DIR writes elsewhere";
            Err(Error::format(&path, what))
        }
        None => Ok(ResumableRun::default()),
    }
}

fn load(files: &RunFiles) -> Result<ResumableRun> {
    let found = files.load()?;
    if let Some(checkpoint) = &found.under_way {
        checkpoint.passed_over.iter().for_each(|why| {
            warn(format_args!("{why}; the one before, {}, is used", checkpoint.path.display()));
        });
    }
    if found.headers().next().is_none() {
        say("note: no checkpoint is there, all is measured from the beginning");
    }
    Ok(found)
}

/// What is to be said where the file system has less room than a run takes.
pub fn room_for(disk: Disk, folder: &Path) -> Option<String> {
    let free = files::free_bytes(folder)?;
    (disk.bytes() > free).then(|| {
        let [results, kept, free] = [disk.results_bytes, disk.until_then_bytes, free].map(bytes);
        format!(
            "{}: {free} are free, results may take {results} and what is kept until then {kept}",
            folder.display()
        )
    })
}

/// Which of `all` tables a run measured: `open` may be fewer, where it was ended while it wrote them.
pub fn measured<'a>(
    found: &ResumableRun,
    all: &'a [TablePaths],
    open: Vec<&'a TablePaths>,
) -> Vec<&'a TablePaths> {
    let Some((_, header)) = found.headers().next() else { return open };
    let parsed = campaign::parse(&header.campaign, "campaign", Path::new(""));
    let Ok(kept) = parsed.map(|parsed| parsed.campaign) else { return open };
    let (alphas, optics) = (kept.alphas(), kept.optics.each());
    let is_measured =
        |target: &&TablePaths| alphas.contains(&target.alpha) && optics.contains(&&target.optics);
    let measured: Vec<&TablePaths> = all.iter().filter(is_measured).collect();
    let covers = open.iter().all(|open| measured.iter().any(|target| target.table == open.table));
    if covers { measured } else { open }
}

/// Says what a run is resumed from.
pub fn say_resumed(path: &Path, starts: u64, plan: &Plan) {
    let percent = 100.0 * starts as f64 / plan.total_samples.max(1) as f64;
    say(format_args!("note: resumes {}: {} samples, {percent:.1} %", path.display(), grouped(starts)));
}

/// The environment's word for how often finished blocks are kept, s of processor time.
const EVERY_S: &str = "GONIO_CHECKPOINT_S";

/// How often finished blocks are kept.
pub fn pace() -> Result<Pace> {
    let Some(word) = std::env::var_os(EVERY_S) else { return Ok(Pace::Rare) };
    let seconds = word.to_str().and_then(|word| word.parse::<f64>().ok());
    match seconds {
        Some(seconds) if (1e-3..=86_400.0).contains(&seconds) => Ok(Pace::Every(seconds)),
        _ => Err(Error::Usage(format!(
            "{EVERY_S} = {}: seconds of processor time between two checkpoints, 0.001 to 86400, are expected",
            quoted(&word)
        ))),
    }
}

/// An interruption with the command that goes on.
pub fn with_advice(error: Error, files: &RunFiles, arguments: &Arguments) -> Error {
    match error {
        Error::Interrupted(when) if matches!(files.any(), Ok(Some(_))) => {
            Error::Interrupted(format!("{when}; resume with: {}", arguments.again()))
        }
        Error::Interrupted(_) => Error::Interrupted("before anything was measured".into()),
        other => other,
    }
}

/// What is said where a run is ended and does not measure just then.
pub fn advice(files: &RunFiles, again: &str) -> String {
    match files.any() {
        Ok(Some(_)) => format!("before its end; resume with: {again}"),
        _ => "before its end; nothing is kept to go on from".into(),
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
