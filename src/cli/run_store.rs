//! A run that can be ended and gone on with: what it keeps, and what is said of that.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::measure::Arguments;
use super::targets::TablePaths;
use super::text::output::{bytes, grouped, say, warn};
use crate::campaign::{self, Campaign};
use crate::error::{Error, Result};
use crate::files;
use crate::measure::{
    Band, BandFiles, Checkpoint, Disk, FinishedBands, FoundCheckpoint, Pace, Plan, RunHeader, RunState, Shard,
};

/// Where a run keeps what it has measured: the blocks under way and, of a run in bands, those that are finished.
pub struct RunStore {
    folder: PathBuf,
    pub checkpoint: Checkpoint,
    pub bands: BandFiles,
}

/// An resumable run: nothing, blocks, bands, or bands and the blocks of a further one.
#[derive(Default)]
pub struct ResumableRun {
    pub found: Option<FoundCheckpoint>,
    pub bands: FinishedBands,
}

impl RunStore {
    /// The files whose names begin with `stem`.
    pub fn of(folder: &Path, stem: &str) -> Self {
        let folder = folder.to_path_buf();
        RunStore { checkpoint: Checkpoint::of(&folder, stem), bands: BandFiles::of(&folder, stem), folder }
    }

    /// The resumable run that lies there, if it is asked for. One that is not asked for is in the way, or removed by
    /// force.
    pub fn find(&self, resume: bool, force: bool) -> Result<ResumableRun> {
        if resume {
            return self.load();
        }
        match self.path()? {
            Some(_) if force => self.remove().map(|()| ResumableRun::default()),
            Some(path) => {
                let what = "keeps an resumable run; --resume goes on with it, --force starts again, -o DIR writes \
                            elsewhere";
                Err(Error::format(&path, what))
            }
            None => Ok(ResumableRun::default()),
        }
    }

    fn load(&self) -> Result<ResumableRun> {
        let resumable = ResumableRun { found: self.checkpoint.load()?, bands: self.bands.headers()? };
        if let Some(found) = &resumable.found {
            found.passed_over.iter().for_each(|why| {
                warn(format_args!("{why}; the one before, {}, is used", found.path.display()));
            });
            let of = |band: Option<Band>| band.map(|band| (band.of, band.stops));
            let other =
                resumable.bands.values().find(|(_, header)| of(header.band) != of(found.kept.header.band));
            if let Some((band, _)) = other {
                let what =
                    format!("is not of the run that {} is a band of; --force starts again", band.display());
                return Err(Error::format(&found.path, what));
            }
        }
        if resumable.headers().next().is_none() {
            say("note: no checkpoint is there, all is measured from the beginning");
        }
        Ok(resumable)
    }

    /// One of the files, if any is there.
    pub fn path(&self) -> Result<Option<PathBuf>> {
        let checkpoint = self.checkpoint.path().map(Path::to_path_buf);
        Ok(checkpoint.or(self.bands.paths()?.into_iter().next()))
    }

    /// What is to be said where the file system has less room than a run takes.
    pub fn room_for(&self, disk: Disk) -> Option<String> {
        let free = files::free_bytes(&self.folder)?;
        (disk.bytes() > free).then(|| {
            let [results, kept, free] = [disk.results_bytes, disk.until_then_bytes, free].map(bytes);
            format!(
                "{}: {free} are free, results may take {results} and what is kept until then {kept}",
                self.folder.display()
            )
        })
    }

    /// Removes all of them.
    pub fn remove(&self) -> Result<()> {
        self.checkpoint.remove()?;
        self.bands.remove()
    }

    /// Removes what a run keeps whose tables are all there; that of another campaign stays.
    pub fn remove_finished(&self, campaign: &Campaign, shard: Option<Shard>) -> Result<()> {
        let of_this = |header: &RunHeader| header.faults((campaign, shard), "", "").is_empty();
        if matches!(self.checkpoint.load(), Ok(Some(found)) if of_this(&found.kept.header)) {
            self.checkpoint.remove()?;
        }
        match self.bands.headers() {
            Ok(bands) if bands.values().all(|(_, header)| of_this(header)) => self.bands.remove(),
            _ => Ok(()),
        }
    }
}

impl ResumableRun {
    fn headers(&self) -> impl Iterator<Item = (&Path, &RunHeader)> {
        let found = self.found.iter().map(|found| (found.path.as_path(), &found.kept.header));
        found.chain(self.bands.values().map(|(path, header)| (path.as_path(), header)))
    }

    /// Which of `all` tables it measured: `open` may be fewer, where it was ended while it wrote them.
    pub fn measured<'a>(&self, all: &'a [TablePaths], open: Vec<&'a TablePaths>) -> Vec<&'a TablePaths> {
        let Some((_, header)) = self.headers().next() else { return open };
        let parsed = campaign::parse(&header.campaign, "campaign", Path::new(""));
        let Ok(kept) = parsed.map(|parsed| parsed.campaign) else { return open };
        let (alphas, optics) = (kept.alphas(), kept.optics.each());
        let measured =
            |target: &&TablePaths| alphas.contains(&target.alpha) && optics.contains(&&target.optics);
        let measured: Vec<&TablePaths> = all.iter().filter(measured).collect();
        let covers = open.iter().all(|open| measured.iter().any(|target| target.table == open.table));
        if covers { measured } else { open }
    }

    /// Refuses what cannot be gone on from, by the key of `file` that differs.
    pub fn check(&self, campaign: &Campaign, shard: Option<Shard>, file: &Path) -> Result<()> {
        let file = file.display().to_string();
        let faults = |(path, header): (&Path, &RunHeader)| {
            header.faults((campaign, shard), &file, &path.display().to_string())
        };
        let refused = self.headers().map(faults).find(|faults| !faults.is_empty());
        refused.map_or(Ok(()), |faults| Err(Error::Campaign(faults)))
    }

    /// The newest of its files.
    pub fn path(&self) -> Option<&Path> {
        self.headers().next().map(|(path, _)| path)
    }

    /// The number of its last checkpoint.
    pub fn number(&self) -> u64 {
        self.found.as_ref().map_or(0, |found| found.kept.header.number)
    }

    /// How many stops it measured at a time, if there is one; `None` within for all.
    pub fn stops_at_a_time(&self) -> Option<Option<u64>> {
        self.headers().next().map(|(_, header)| header.band.map(|band| band.stops))
    }

    /// The run_state to go on with, for a run that is checked.
    pub fn run_state(self, campaign: &Campaign, plan: &Plan) -> Result<RunState> {
        let Some(FoundCheckpoint { path, kept, .. }) = self.found else {
            return Ok(RunState::new(campaign, plan));
        };
        let run_state = kept.run_state(campaign, plan);
        let run_state =
            run_state.map_err(|why| Error::format(&path, format!("{why}; --force starts again")))?;
        goes_on(&path, run_state.starts(plan), plan);
        Ok(run_state)
    }
}

/// Says what a run goes on from.
pub fn goes_on(path: &Path, starts: u64, plan: &Plan) {
    let percent = 100.0 * starts as f64 / plan.total_samples.max(1) as f64;
    say(format_args!("note: goes on from {}: {} samples, {percent:.1} %", path.display(), grouped(starts)));
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
pub fn with_advice(error: Error, store: &RunStore, arguments: &Arguments) -> Error {
    match error {
        Error::Interrupted(when) if matches!(store.path(), Ok(Some(_))) => {
            Error::Interrupted(format!("{when}; go on with: {}", arguments.again()))
        }
        Error::Interrupted(_) => Error::Interrupted("before anything was measured".into()),
        other => other,
    }
}

/// What is said where a run is ended and does not measure just then.
pub fn advice(store: &RunStore, again: &str) -> String {
    match store.path() {
        Ok(Some(_)) => format!("before its end; go on with: {again}"),
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
