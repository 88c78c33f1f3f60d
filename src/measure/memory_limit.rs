//! How much memory a run may use: half of what the system, the session and the job scheduler leave.

use std::fs;

/// Bytes where the system says nothing.
const DEFAULT_LIMIT: u64 = 4 << 30;

/// Half of the least of: available memory, address space left under `ulimit -v`, limit of the control group (as job
/// schedulers and containers set it).
///
/// Held by: row 93 of `tests/bad_inputs.rs`.
pub fn memory_limit() -> u64 {
    let limits = [available(), address_space_left(), control_group()];
    limits.into_iter().flatten().min().map_or(DEFAULT_LIMIT, |bytes| bytes / 2)
}

fn available() -> Option<u64> {
    kib_in(&fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// What this process may still map, where that is limited.
fn address_space_left() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let mapped = kib_in(&fs::read_to_string("/proc/self/status").ok()?, "VmSize:")?;
    Some(limit.saturating_sub(mapped))
}

/// The limit of this process's group: version 2, or the memory controller of version 1.
fn control_group() -> Option<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").ok()?;
    let limit = |line: &str| {
        let (controllers, path) = line.split_once(':')?.1.split_once(':')?;
        let file = match controllers {
            "" => format!("/sys/fs/cgroup{path}/memory.max"),
            "memory" => format!("/sys/fs/cgroup/memory{path}/memory.limit_in_bytes"),
            _ => return None,
        };
        // "max" is no number, and no limit.
        fs::read_to_string(file).ok()?.trim().parse().ok()
    };
    groups.lines().filter_map(limit).min()
}

/// The bytes behind `name` in a text of lines such as `VmSize:  1234 kB`.
fn kib_in(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_system_are_read_and_other_lines_are_not() {
        let text = "MemTotal:       24 kB\nMemAvailable:   12 kB\nVmSize:  many kB\n";
        assert_eq!(kib_in(text, "MemAvailable:"), Some(12 * 1024));
        assert_eq!((kib_in(text, "VmSize:"), kib_in(text, "VmPeak:")), (None, None));
    }
}
