//! What a run costs: time and memory, as the system tells them. Nothing of it enters a table.

use std::time::Instant;

use serde::{Deserialize, Serialize};

/// What a run cost.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Cost {
    /// Wall time.
    pub wall_s: f64,
    /// Processor time of all threads, synthesis included.
    pub cpu_s: f64,
    /// Wall time spent making patches.
    pub synthesis_s: f64,
    /// Wall time spent tracing.
    pub tracing_s: f64,
    /// Processor time spent tracing, and laying out patches for it.
    pub tracing_cpu_s: f64,
    /// Threads.
    pub threads: usize,
    /// Samples.
    pub samples: u64,
    /// Rays followed.
    pub rays_traced: u64,
    /// Rays that were not needed.
    pub rays_skipped: u64,
    /// Largest resident memory.
    pub peak_bytes: u64,
}

impl Cost {
    /// Whether times are such as a clock shows.
    pub fn is_possible(&self) -> bool {
        let Cost { wall_s, cpu_s, synthesis_s, tracing_s, tracing_cpu_s, .. } = *self;
        [wall_s, cpu_s, synthesis_s, tracing_s, tracing_cpu_s].iter().all(|s| (0.0..=f64::MAX).contains(s))
    }

    /// This and a run after it, or next to it on another machine.
    pub fn plus(self, next: Cost) -> Cost {
        Cost {
            wall_s: self.wall_s + next.wall_s,
            cpu_s: self.cpu_s + next.cpu_s,
            synthesis_s: self.synthesis_s + next.synthesis_s,
            tracing_s: self.tracing_s + next.tracing_s,
            tracing_cpu_s: self.tracing_cpu_s + next.tracing_cpu_s,
            threads: next.threads,
            samples: self.samples + next.samples,
            rays_traced: self.rays_traced + next.rays_traced,
            rays_skipped: self.rays_skipped + next.rays_skipped,
            peak_bytes: self.peak_bytes.max(next.peak_bytes),
        }
    }
}

/// The clocks of a run, which may continue an earlier part of it.
pub(super) struct Clocks {
    begin: Instant,
    cpu: f64,
    /// Costs of all phases that are over.
    so_far: Cost,
    threads: usize,
    /// When tracing began, and the processor time then, while it lasts.
    tracing: Option<(Instant, f64)>,
}

impl Clocks {
    pub fn new(earlier: Cost) -> Self {
        Clocks {
            begin: Instant::now(),
            cpu: cpu_seconds(),
            so_far: earlier,
            threads: rayon::current_num_threads(),
            tracing: None,
        }
    }

    /// Patches were made in `wall_s` since, and laid out for tracing in `cpu_s`.
    pub fn made_patches(&mut self, wall_s: f64, cpu_s: f64) {
        self.so_far.synthesis_s += wall_s;
        self.so_far.tracing_cpu_s += cpu_s;
    }

    pub fn tracing_begins(&mut self) {
        self.tracing = Some((Instant::now(), cpu_seconds()));
    }

    pub fn tracing_ends(&mut self) {
        let Cost { tracing_s, tracing_cpu_s, .. } = self.cost();
        (self.so_far.tracing_s, self.so_far.tracing_cpu_s) = (tracing_s, tracing_cpu_s);
        self.tracing = None;
    }

    /// Times up to now, and memory; other figures are as they were in the earlier part.
    pub fn cost(&self) -> Cost {
        let (wall_s, cpu_s) = self
            .tracing
            .map_or((0.0, 0.0), |(wall, cpu)| (wall.elapsed().as_secs_f64(), cpu_seconds() - cpu));
        let earlier = &self.so_far;
        Cost {
            wall_s: earlier.wall_s + self.begin.elapsed().as_secs_f64(),
            cpu_s: earlier.cpu_s + cpu_seconds() - self.cpu,
            tracing_s: earlier.tracing_s + wall_s,
            tracing_cpu_s: earlier.tracing_cpu_s + cpu_s,
            threads: self.threads,
            peak_bytes: peak_bytes().max(earlier.peak_bytes),
            ..earlier.clone()
        }
    }
}

/// Processor time of the process so far, all threads.
#[cfg(unix)]
pub fn cpu_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Time since the first call: processor time is not known here.
#[cfg(not(unix))]
pub fn cpu_seconds() -> f64 {
    static BEGIN: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    BEGIN.elapsed().as_secs_f64()
}

/// Largest resident memory so far; 0 where the system does not tell.
pub fn peak_bytes() -> u64 {
    status_bytes("VmHWM:")
}

/// Resident memory now; 0 where the system does not tell.
pub fn resident_bytes() -> u64 {
    status_bytes("VmRSS:")
}

/// Lets `peak_bytes` count from now on, where the system can.
pub fn reset_peak() {
    // Without the right to it the peak stays that of the process: an upper bound.
    std::fs::write("/proc/self/clear_refs", "5").ok();
}

fn status_bytes(key: &str) -> u64 {
    let found = || {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status.lines().find(|line| line.starts_with(key))?;
        line.split_whitespace().nth(1)?.parse::<u64>().ok()
    };
    found().unwrap_or(0) * 1024
}
