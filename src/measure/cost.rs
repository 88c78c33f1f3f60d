//! What a run costs: time and memory, as the system tells them. Nothing of it enters a table.

use serde::Serialize;

/// What a run cost.
#[derive(Debug, Clone, Serialize)]
pub struct Cost {
    /// Wall time.
    pub wall_s: f64,
    /// Processor time of all threads, synthesis included.
    pub cpu_s: f64,
    /// Wall time spent making patches.
    pub synthesis_s: f64,
    /// Wall time spent tracing.
    pub tracing_s: f64,
    /// Threads.
    pub threads: usize,
    /// Starts.
    pub samples: u64,
    /// Rays followed.
    pub rays_traced: u64,
    /// Rays that were not needed.
    pub rays_skipped: u64,
    /// Largest resident memory.
    pub peak_bytes: u64,
}

/// Processor time of the process so far; 0 where the system does not tell.
pub fn cpu_seconds() -> f64 {
    let ticks = || {
        let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
        let after_name = stat.rsplit_once(')')?.1;
        let field = |n: usize| after_name.split_whitespace().nth(n)?.parse::<f64>().ok();
        Some(field(11)? + field(12)?)
    };
    // The kernel reports in ticks of 1/100 s.
    ticks().unwrap_or(0.0) / 100.0
}

/// Largest resident memory so far; 0 where the system does not tell.
pub fn peak_bytes() -> u64 {
    let peak = || {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
        line.split_whitespace().nth(1)?.parse::<u64>().ok()
    };
    peak().unwrap_or(0) * 1024
}
