//! How much is tried: what changes need, or, with GONIO_LONG=1 (`.ci/nightly`), all that a promise says.

use std::env;

/// Whether all is to be tried.
pub fn is_long() -> bool {
    env::var_os("GONIO_LONG").is_some_and(|value| value != "0")
}

/// `short`, or `long` where all is to be tried.
pub fn or_long<T>(short: T, long: T) -> T {
    if is_long() { long } else { short }
}
