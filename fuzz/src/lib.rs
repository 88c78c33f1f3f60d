//! The readers, asked as `cargo fuzz` asks: bytes in, nothing out.

mod readers;
mod scans;
mod traced;

use std::panic::{self, AssertUnwindSafe};
use std::process;
use std::sync::{Mutex, Once, PoisonError};

/// What the last panic said.
static SAID: Mutex<String> = Mutex::new(String::new());

/// Reads what an input of `target` stands for. Panics of decoders that the program takes for damage of the file are no finds:
/// the fuzzer's own hook would end the process before anybody can catch them.
pub fn read(target: &str, bytes: &[u8]) {
    static HOOK: Once = Once::new();
    let said = || SAID.lock().unwrap_or_else(PoisonError::into_inner);
    HOOK.call_once(|| panic::set_hook(Box::new(move |panic| *said() = panic.to_string())));
    if panic::catch_unwind(AssertUnwindSafe(|| readers::read(target, bytes))).is_err() {
        eprintln!("{}", said());
        process::abort();
    }
}
