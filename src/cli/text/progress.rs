//! How far a run is: a bar on a terminal, else one line a minute.

use std::io::{IsTerminal, stderr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use super::numbers::duration;
use super::output;

/// Seconds between two lines where stderr is no terminal.
const LINE_INTERVAL: u64 = 60;

/// Progress on stderr, reported from any thread.
pub struct RunProgress {
    total: u64,
    unit: &'static str,
    /// Done by an earlier run.
    before: u64,
    done: AtomicU64,
    begin: Instant,
    next_line: AtomicU64,
    bar: Option<ProgressBar>,
}

impl RunProgress {
    /// Starts counting to `total` of `unit` (a plural).
    pub fn new(total: u64, unit: &'static str) -> Self {
        Self::after(0, total, unit)
    }

    /// Goes on counting to `total` of `unit` from `before` that an earlier run did.
    pub fn after(before: u64, total: u64, unit: &'static str) -> Self {
        RunProgress {
            total,
            unit,
            before,
            done: AtomicU64::new(before),
            begin: Instant::now(),
            next_line: AtomicU64::new(LINE_INTERVAL),
            bar: (stderr().is_terminal() && !output::is_quiet()).then(|| bar(before, total, unit)),
        }
    }

    /// Counts `more` as done.
    pub fn add(&self, more: u64) {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        if let Some(bar) = &self.bar {
            bar.inc(more);
            return;
        }
        let elapsed = self.begin.elapsed();
        let due = self.next_line.load(Ordering::Relaxed);
        let next = elapsed.as_secs() + LINE_INTERVAL;
        // Of the threads that see a line due, one prints it.
        if elapsed.as_secs() >= due
            && self.next_line.compare_exchange(due, next, Ordering::Relaxed, Ordering::Relaxed).is_ok()
        {
            output::inform(line(self.before, done, self.total, self.unit, elapsed.as_secs_f64()));
        }
    }

    /// Says what is done besides, behind the bar; empty: nothing.
    pub fn say(&self, stage: &str) {
        let text = if stage.is_empty() { String::new() } else { format!("; {stage}") };
        self.bar.iter().for_each(|bar| bar.set_message(text.clone()));
    }

    /// Whether the bar was taken away.
    pub fn is_finished(&self) -> bool {
        self.bar.as_ref().is_some_and(ProgressBar::is_finished)
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Drop for RunProgress {
    fn drop(&mut self) {
        self.finish();
    }
}

/// What a command does that may take seconds, shown on a terminal until it is dropped.
pub struct Stage(Option<ProgressBar>);

impl Stage {
    /// Begins with a text such as `validating`.
    pub fn begin(text: &str) -> Self {
        Stage((stderr().is_terminal() && !output::is_quiet() && can_tick()).then(|| {
            let line = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {elapsed}") {
                line.set_style(style);
            }
            line.set_message(text.to_string());
            line.enable_steady_tick(Duration::from_millis(250));
            line
        }))
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        self.0.iter().for_each(ProgressBar::finish_and_clear);
    }
}

/// Whether the thread that ticks can be started: a bar panics where it cannot.
fn can_tick() -> bool {
    std::thread::Builder::new().spawn(|| ()).is_ok()
}

fn bar(before: u64, total: u64, unit: &'static str) -> ProgressBar {
    const TEMPLATE: &str = "{percent:>3} % [{wide_bar}] {rate}, {eta} left{msg}";
    let rate = move |state: &ProgressState, out: &mut dyn std::fmt::Write| {
        // A line that cannot be formatted is a line less.
        write!(out, "{} {unit}/s", HumanCount(state.per_sec() as u64)).ok();
    };
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
        bar.set_style(style.with_key("rate", rate).progress_chars("=> "));
    }
    bar.set_position(before);
    // What was there before says nothing of this run's rate.
    bar.reset_eta();
    // Without a thread that ticks it moves as work is done.
    if can_tick() {
        bar.enable_steady_tick(Duration::from_secs(1));
    }
    bar
}

fn line(before: u64, done: u64, total: u64, unit: &str, seconds: f64) -> String {
    let rate = (done - before) as f64 / seconds.max(1e-9);
    let left = duration(total.saturating_sub(done) as f64 / rate.max(1e-9));
    let percent = 100.0 * done as f64 / total.max(1) as f64;
    format!("{percent:.1} %, {} {unit}/s, about {left} left", short(rate))
}

/// A rate in three digits.
fn short(rate: f64) -> String {
    match rate {
        r if r >= 1e6 => format!("{:.1} M", r / 1e6),
        r if r >= 1e3 => format!("{:.1} k", r / 1e3),
        r => format!("{r:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_share_rate_and_time_left() {
        let text = line(0, 30_000_000, 120_000_000, "samples", 60.0);
        assert_eq!(text, "25.0 %, 500.0 k samples/s, about 3.0 min left");
        // What an earlier run did counts as done, and not for the rate.
        let text = line(30_000_000, 60_000_000, 120_000_000, "samples", 60.0);
        assert_eq!(text, "50.0 %, 500.0 k samples/s, about 2.0 min left");
    }

    #[test]
    fn nothing_done_is_no_division_by_zero() {
        assert!(line(0, 0, 0, "patches", 0.0).starts_with("0.0 %, 0.00 patches/s"));
    }
}
