//! The program: command line in, exit code out.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(gonio::cli::exit_code(std::env::args_os()))
}
