//! `gonio completions`: the words of the command line for a shell.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::cli::text::output::Output;
use crate::error::{Error, Result};

/// Print the completions of a shell: bash, elvish, fish, powershell, zsh
#[derive(Args)]
#[command(after_help = "Example: gonio completions bash > ~/.local/share/bash-completion/completions/gonio")]
pub struct Arguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut crate::cli::Arguments::command(), "gonio", &mut script);
    let script = String::from_utf8(script).map_err(|e| Error::Internal(format!("completions: {e}")))?;
    Output::default().document(script.trim_end())?;
    Ok(0)
}
