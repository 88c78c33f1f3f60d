//! The processor time of a running process, which a busy machine does not change as it changes the time on the wall.

use std::fs;
use std::process::Child;
use std::time::Duration;

/// Of a second, as the system counts processor time for other processes to see (USER_HZ of Linux).
const TICKS: u64 = 100;

/// What a process and its threads have used, and whether it is at its end: a child that was not waited for can be asked
/// then, too.
pub fn used(child: &Child) -> (Duration, bool) {
    let stat =
        fs::read_to_string(format!("/proc/{}/stat", child.id())).expect("a child that was not waited for");
    // The name stands in brackets and may hold anything; state, user and system time are the 3rd, 14th and 15th field.
    let (_, fields) = stat.rsplit_once(')').expect("a name");
    let fields: Vec<&str> = fields.split_whitespace().collect();
    let ticks = |field: usize| fields[field - 3].parse::<u64>().expect("a number");
    (Duration::from_millis((ticks(14) + ticks(15)) * 1000 / TICKS), fields[0] == "Z")
}
