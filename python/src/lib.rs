//! `gonio._gonio`: what the Python package calls. No physics and no words of its own: campaigns, tables and values go
//! in, and what the crate `gonio` answers comes out.

mod campaign;
mod failure;
mod models;
mod table;
mod task;

use std::ffi::OsString;
use std::io::Write;

use pyo3::prelude::*;

/// The native side of the package `gonio`.
#[pymodule]
mod _gonio {
    #[pymodule_export]
    use super::models::evaluate;
    #[pymodule_export]
    use super::table::{load, model_means, picture};
    #[pymodule_export]
    use super::task::Task;
    #[pymodule_export]
    use super::{main, version};

    /// Decoders catch panics of their own, which are not to be printed.
    #[pymodule_init]
    fn begin() {
        gonio::cli::remember_panics();
    }
}

/// Runs the command line `words`, the program's name first, and returns the exit code.
#[pyfunction]
fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| {
        let code = gonio::cli::exit_code(words);
        // A library's stdout is not flushed at the end of the process. A reader that has gone away changes nothing.
        std::io::stdout().flush().ok();
        code
    })
}

/// The version of the program.
#[pyfunction]
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
