//! `gonio man`: the help of every command as manual pages.

use std::path::PathBuf;

use clap::{Args, CommandFactory};

use crate::cli::streams::folder;
use crate::cli::text::output::Output;
use crate::error::{Error, Result};
use crate::files::{self, Destination};
use crate::job::paths::already_exists;

/// Write the manual pages: gonio.1, and one of every command
#[derive(Args)]
#[command(after_help = "Example: gonio man ~/.local/share/man/man1")]
pub struct Arguments {
    /// The folder
    #[arg(value_parser = folder())]
    folder: PathBuf,
    /// Replace pages that are there
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let pages = pages()?;
    let _claim = files::create_folder(&arguments.folder)?;
    let paths: Vec<Destination> =
        pages.iter().map(|(name, _)| Destination::at(arguments.folder.join(name))).collect();
    if let Some(path) = paths.iter().find(|path| files::is_there(path) && !arguments.force) {
        return Err(already_exists(path, "is there already"));
    }
    for (path, (_, page)) in paths.iter().zip(&pages) {
        files::write_atomically(path, page)?;
    }
    Output::default().line(format_args!("{} pages in {}", pages.len(), arguments.folder.display()))?;
    Ok(0)
}

/// The pages by the names of their files.
fn pages() -> Result<Vec<(String, Vec<u8>)>> {
    let mut command = crate::cli::Arguments::command().disable_help_subcommand(true);
    command.build();
    // Built commands have the names that their pages go by.
    let verbs = command.get_subcommands().cloned();
    std::iter::once(command.clone()).chain(verbs).map(page).collect()
}

fn page(command: clap::Command) -> Result<(String, Vec<u8>)> {
    let name = format!("{}.1", command.get_display_name().unwrap_or(command.get_name()));
    let mut text = Vec::new();
    let written = clap_mangen::Man::new(command).render(&mut text);
    written.map_err(|e| Error::Internal(format!("manual page {name}: {e}")))?;
    Ok((name, text))
}
