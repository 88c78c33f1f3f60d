//! How a run is watched, kept and ended.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::cost::{Cost, cpu_seconds};
use super::patches::specimen::Specimen;
use super::persist::checkpoint::Checkpoint;
use super::persist::run_state::RunState;
use super::plan::Plan;
use crate::campaign::Campaign;
use crate::error::{Error, Result};

/// Time after which a checkpoint is due in any case, where there is something new.
const LONGEST: Duration = Duration::from_secs(60);
/// In between, one is due after this fraction of the work, and when this many times as long as the last took has gone by.
const WORK_PARTS: u64 = 100;
const REST: u32 = 100;
/// How long the work may take to end itself, once it is asked to: blocks are given up after less, patches take longer.
const PATIENCE: Duration = Duration::from_millis(400);

/// The content of a lock: a panic elsewhere ends the run by itself.
pub(super) fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How often finished blocks are kept, as processor time of the run: a busy machine makes no checkpoint more.
#[derive(Debug, Clone, Copy)]
pub enum Pace {
    /// After a second at the earliest, after a hundredth of the work, and so that writing takes a hundredth of the time.
    Rare,
    /// After so many seconds.
    Every(f64),
}

impl Pace {
    fn shortest_s(self) -> f64 {
        match self {
            Pace::Rare => 1.0,
            Pace::Every(seconds) => seconds,
        }
    }

    /// How often it is asked whether a checkpoint is due.
    fn tick(self) -> Duration {
        Duration::from_secs_f64((0.1 * self.shortest_s()).clamp(1e-3, 0.1))
    }

    /// How long a thread keeps sums to itself: adding them up takes up to milliseconds, where bins are many.
    pub(super) fn kept_by_a_thread(self) -> Duration {
        Duration::from_secs_f64((0.5 * self.shortest_s()).min(0.5))
    }
}

/// Who ends the process for a run that does not do so in time.
pub trait ProcessEnd: Sync {
    /// From now on the run keeps its finished blocks itself: nobody else is to end the process.
    fn hold(&self);
    /// Ends the process with this error: all finished blocks are kept, and nothing else is worth being waited for.
    fn leave(&self, error: Error);
    /// The run is over, and whoever wants to may end the process.
    fn release(&self);
}

/// What surrounds a run.
pub struct Session<'a> {
    /// Called with the samples of every finished block.
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// Called with what is done now besides tracing, as `making patches 3 to 4 of 16`; empty: nothing.
    pub stage: &'a (dyn Fn(&str) + Sync),
    /// Called with the first realisation's specimen when it is made.
    pub first_specimen: &'a (dyn Fn(&Specimen) + Sync),
    /// Called with what the user should know.
    pub note: &'a (dyn Fn(String) + Sync),
    /// Once this is set, no further blocks are begun, and running ones finished if they are short.
    pub interrupted: &'a AtomicBool,
    /// Where finished blocks are kept, if anywhere, and the number of the last checkpoint that is there.
    pub checkpoint: Option<(&'a Checkpoint, u64)>,
    /// How often.
    pub pace: Pace,
    /// Who ends the process; without one the run ends by itself, in its own time.
    pub ending: Option<&'a dyn ProcessEnd>,
}

/// Never set.
static NEVER: AtomicBool = AtomicBool::new(false);

impl<'a> Session<'a> {
    /// A run that is not kept and continues to its end.
    pub fn plain(progress: &'a (dyn Fn(u64) + Sync)) -> Self {
        Session {
            progress,
            stage: &|_| (),
            first_specimen: &|_| (),
            note: &|_| (),
            interrupted: &NEVER,
            checkpoint: None,
            pace: Pace::Rare,
            ending: None,
        }
    }

    /// Whether the run is to end.
    pub fn is_over(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}

/// What a run says that was ended, of all that it has measured.
pub(super) fn interrupted(run_state: &RunState, plan: &Plan) -> Error {
    let of = plan.part.band_incidences().map_or(String::new(), |_| format!(" of {}", plan.part));
    Error::Interrupted(format!("after {:.1} % of the samples{of}", run_state.percent(plan)))
}

/// Writes checkpoints while others measure.
pub(super) struct Keeper<'a> {
    pub session: &'a Session<'a>,
    pub campaign: &'a Campaign,
    pub plan: &'a Plan,
    pub run_state: &'a Mutex<RunState>,
    /// What the run has cost up to now.
    pub cost: &'a (dyn Fn() -> Cost + Sync),
}

/// The last checkpoint.
struct Last {
    number: u64,
    at: Instant,
    /// The processor time of the run until then, s.
    cpu_s: f64,
    took: Duration,
    starts: u64,
    failed: bool,
}

impl Keeper<'_> {
    /// As [`Self::keep`], in whose time nobody else ends the process.
    pub fn run(&self, others: Receiver<()>) -> Result<()> {
        let Some(checkpoint) = self.session.checkpoint else { return Ok(()) };
        self.session.ending.iter().for_each(|ending| ending.hold());
        let kept = self.keep(checkpoint, others);
        self.session.ending.iter().for_each(|ending| ending.release());
        kept
    }

    /// Writes a checkpoint whenever one is due, until the other end of the channel is dropped; then one more of what is
    /// new, unless the run was short. Returns how that one went.
    fn keep(&self, (checkpoint, number): (&Checkpoint, u64), others: Receiver<()>) -> Result<()> {
        let mut asked = None;
        let (begin, begin_cpu_s, starts) = (Instant::now(), cpu_seconds(), self.starts());
        let mut last =
            Last { number, at: begin, cpu_s: begin_cpu_s, took: Duration::ZERO, starts, failed: false };
        while others.recv_timeout(self.session.pace.tick()) == Err(RecvTimeoutError::Timeout) {
            if let Some(ending) = self.session.ending.filter(|_| self.session.is_over()) {
                if asked.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
                    return self.leave(ending, checkpoint, &mut last);
                }
            } else if self.is_due(&last) {
                match self.write(checkpoint, &mut last) {
                    Err(why) if !last.failed => {
                        (self.session.note)(format!(
                            "no checkpoint could be written, the run goes on: {why}"
                        ));
                        last.failed = true;
                    }
                    written => last.failed = written.is_err(),
                }
            }
        }
        let worth_it = self.session.is_over() || cpu_seconds() - begin_cpu_s > self.session.pace.shortest_s();
        if worth_it && self.is_new(&last) { self.write(checkpoint, &mut last) } else { Ok(()) }
    }

    /// Keeps what is finished, and ends the process in the middle of everything else.
    fn leave(&self, ending: &dyn ProcessEnd, checkpoint: &Checkpoint, last: &mut Last) -> Result<()> {
        let kept = if self.is_new(last) { self.write(checkpoint, last) } else { Ok(()) };
        ending.leave(kept.err().unwrap_or_else(|| interrupted(&locked(self.run_state), self.plan)));
        Ok(())
    }

    fn is_new(&self, last: &Last) -> bool {
        self.starts() > last.starts || last.failed
    }

    fn is_due(&self, last: &Last) -> bool {
        let (since, pace) = (last.at.elapsed(), self.session.pace);
        if since < LONGEST && cpu_seconds() - last.cpu_s < pace.shortest_s() {
            return false;
        }
        let new = self.starts() - last.starts;
        let enough = match pace {
            Pace::Rare => {
                let rested = since > last.took.saturating_mul(REST);
                since >= LONGEST || rested && new >= self.plan.total_samples / WORK_PARTS
            }
            Pace::Every(_) => true,
        };
        new > 0 && enough
    }

    /// The sums are locked while they are encoded, not while they are written.
    fn write(&self, checkpoint: &Checkpoint, last: &mut Last) -> Result<()> {
        let begin = Instant::now();
        let number = last.number + 1;
        let (bytes, starts) = {
            let mut run_state = locked(self.run_state);
            run_state.cost = (self.cost)();
            let bytes = run_state.to_bytes(number, self.campaign, self.plan)?;
            (bytes, run_state.tables.starts(self.plan))
        };
        // Also after a failure: a full disk is asked again at the next time, not at once.
        (last.at, last.cpu_s, last.took) = (begin, cpu_seconds(), begin.elapsed());
        checkpoint.save(number, &bytes)?;
        (last.took, last.number, last.starts) = (begin.elapsed(), number, starts);
        Ok(())
    }

    fn starts(&self) -> u64 {
        locked(self.run_state).tables.starts(self.plan)
    }
}
