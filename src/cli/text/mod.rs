//! What the commands print.

pub(crate) mod layout;
pub mod lobes;
pub(crate) mod measured;
pub(crate) mod numbers;
pub(crate) mod optics;
pub(crate) mod output;
pub(crate) mod plan;
pub(crate) mod progress;
pub(crate) mod resolution;
pub(crate) mod study;
pub(crate) mod terminal;
pub(crate) mod verdict;

use std::ffi::OsStr;

/// A word of a command line, quoted where a shell would not take it as it is.
pub fn quoted(word: impl AsRef<OsStr>) -> String {
    let word = word.as_ref().to_string_lossy();
    // No word of a command line has the NUL byte that cannot be quoted.
    shlex::try_quote(&word).map_or_else(|_| format!("{word:?}"), Into::into)
}
