//! Work without Python's lock, and its errors as exceptions of the package: `gonio.errors.of(exit_code, text, faults)`.

use gonio::cli;
use gonio::error::{Error, Result};
use gonio::job::threads;
use pyo3::prelude::*;

/// The exception of an error, or what prevents it from being made.
pub fn exception(py: Python<'_>, error: &Error) -> PyErr {
    let faults = match error {
        Error::Campaign(faults) => serde_json::to_string(faults).ok(),
        _ => None,
    };
    let made = || {
        let arguments = (error.exit_code(), error.to_string(), faults);
        py.import("gonio.errors")?.getattr("of")?.call1(arguments)
    };
    made().map_or_else(|why| why, PyErr::from_value)
}

/// A result of the crate as one of Python.
pub fn raised<T>(py: Python<'_>, result: Result<T>) -> PyResult<T> {
    result.map_err(|error| exception(py, &error))
}

/// Does `work` on so many threads at most, one a core for 0. They are its own: a process that was forked has no others.
pub fn on_threads<T: Send>(
    py: Python<'_>,
    most: usize,
    work: impl FnOnce() -> Result<T> + Send,
) -> PyResult<T> {
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
    let done = py.detach(|| cli::guarded(|| threads::pool(most.min(cores))?.install(work)));
    raised(py, done)
}
