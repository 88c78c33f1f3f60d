//! `gonio --version -v`: what was built, by what, and which lanes this processor runs.

use std::ffi::OsString;

use crate::lanes::Kernel;

/// Whether the words of the command line ask for it.
pub fn is_asked(words: &[OsString]) -> bool {
    let [_, first, second] = words else { return false };
    let is = |word: &OsString, names: [&str; 2]| names.iter().any(|name| word == name);
    let (version, verbose) = (["--version", "-V"], ["--verbose", "-v"]);
    is(first, version) && is(second, verbose) || is(first, verbose) && is(second, version)
}

/// A line a fact.
pub fn lines() -> Vec<String> {
    vec![
        format!("gonio {}", env!("CARGO_PKG_VERSION")),
        format!("commit   {}", option_env!("GONIO_COMMIT").unwrap_or("not known")),
        format!("compiler {}", env!("GONIO_COMPILER")),
        format!("target   {}", env!("GONIO_TARGET")),
        format!("lanes    {}", Kernel::widest().name()),
    ]
}
