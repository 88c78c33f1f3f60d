//! How much memory a run and its readers may use: half of what the system, the session and the job scheduler leave.
//!
//! Readers judge what a file needs before they make room for it: from its length, the sizes that it claims, or the
//! numbers that its text can hold ([`words`]). What still does not fit, because others took the memory meanwhile,
//! ends the program with exit code 4 (`cli::run`).

use std::fs;
use std::path::Path;

use crate::error::{Checked, ContentError, Error, Result};

/// Bytes where the system says nothing.
const DEFAULT_LIMIT: u64 = 4 << 30;

/// Half of the least of: available memory, address space left under `ulimit -v`, limit of the control group (as job
/// schedulers and containers set it).
// Tested by the rows `little memory` of `tests/process/bad_inputs.rs`.
pub fn memory_limit() -> u64 {
    let limits = [available(), address_space_left(), control_group()];
    limits.into_iter().flatten().min().map_or(DEFAULT_LIMIT, |bytes| bytes / 2)
}

/// Refuses what takes more bytes than may be used.
pub fn check(needed: u64) -> Checked<()> {
    let limit = memory_limit();
    if needed <= limit {
        return Ok(());
    }
    Err(ContentError::TooLarge(format!(
        "reading it takes up to {} MiB of memory, {} MiB may be used (half of what is free); free memory, or split the \
         file",
        needed.div_ceil(1 << 20),
        limit >> 20
    )))
}

/// The same for the file at `path`.
pub fn check_file(path: &Path, needed: u64) -> Result<()> {
    check(needed).map_err(|why| Error::format(path, why))
}

/// How many words, cells or nodes a text can hold: its marks, its runs of blanks that follow none, and one more.
pub fn words(text: &[u8]) -> u64 {
    let is_blank = |byte: u8| byte.is_ascii_whitespace() || byte == 0;
    let is_mark = |byte: u8| matches!(byte, b',' | b';' | b':' | b'[' | b'{' | b'<' | b'=');
    let (mut count, mut blank) = (1, true);
    for &byte in text {
        let here = is_blank(byte);
        let mark = is_mark(byte);
        count += u64::from((here && !blank) || mark);
        blank = here || mark;
    }
    count
}

/// How many lines that are not empty a text has, and the length of the longest; either end of a line ends it.
pub fn lines(text: &[u8]) -> (u64, usize) {
    text.split(|byte| matches!(byte, b'\n' | b'\r'))
        .filter(|line| !line.is_empty())
        .fold((0, 0), |(count, longest), line| (count + 1, longest.max(line.len())))
}

/// A vector with room for so many values, or the reason why there is none.
pub fn room<T>(values: usize) -> std::result::Result<Vec<T>, String> {
    let mut list = Vec::new();
    match list.try_reserve_exact(values) {
        Ok(()) => Ok(list),
        Err(_) => Err(format!("{values} values of {} bytes do not fit into memory", size_of::<T>())),
    }
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
    fn words_and_lines_are_counted_as_readers_part_them() {
        for (text, wanted) in [("0, 1,2", 3), ("0 1\n2", 3), ("{0}{1}", 3), (",,,", 4), ("  0  ", 2), ("", 1)]
        {
            assert_eq!(words(text.as_bytes()), wanted, "{text:?}");
        }
        for text in ["ab\nc\n", "ab\r\nc", "ab\rc\r"] {
            assert_eq!(lines(text.as_bytes()), (2, 2), "{text:?}");
        }
    }

    #[test]
    fn what_no_machine_has_is_refused_before_it_is_asked_for() {
        assert!(check(0).is_ok());
        let error = Error::format(Path::new("f"), check(1 << 60).expect_err("an exbibyte"));
        let why = error.to_string();
        assert!(why.contains("1099511627776 MiB") && why.contains("may be used"), "{why}");
        assert_eq!(error.exit_code(), 4);
        assert!(room::<u64>(usize::MAX / 16).expect_err("too much").contains("do not fit"));
    }

    #[test]
    fn lines_of_the_system_are_read_and_other_lines_are_not() {
        let text = "MemTotal:       24 kB\nMemAvailable:   12 kB\nVmSize:  many kB\n";
        assert_eq!(kib_in(text, "MemAvailable:"), Some(12 * 1024));
        assert_eq!((kib_in(text, "VmSize:"), kib_in(text, "VmPeak:")), (None, None));
    }
}
