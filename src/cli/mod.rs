//! The command line: one file a verb.
//!
//! Results go to stdout, everything else to stderr. No physics here: verbs read, call a stage, and print.

use std::ffi::OsString;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Mutex;

use clap::{ColorChoice, CommandFactory, Parser, Subcommand};

use crate::campaign::quoted;
use crate::error::{Error, Result};
use crate::job::threads;
use text::output::{Output, warn};

mod albedo;
mod appearance;
mod bench;
mod budget;
mod check;
mod cite;
mod compare;
mod export;
mod fit;
mod import;
mod init;
mod lists;
mod measure;
mod merge;
pub mod process;
mod recolour;
mod render;
mod report;
mod shell;
mod streams;
mod study;
mod surface;
mod table_file;
pub mod text;
mod validate;

pub use text::output::{Printed, print_error};

/// A virtual gonioreflectometer: measures the BRDF of explicit random microsurfaces, with error bars.
#[derive(Parser)]
#[command(name = "gonio", version, arg_required_else_help = true, term_width = text::layout::terminal_columns())]
#[command(after_help = "Example: gonio measure configs/quickstart.toml\n\
    Exit codes: 0 done, 1 ran and disagrees, 2 command line or campaign, 3 files, 4 refused,\n\
    70 internal error, 130 interrupted.\n\
    Every command takes --threads N, --quiet, --color WHEN. A file named - is stdin, after -o stdout.")]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
    /// Worker threads, 0: one a core; results do not depend on it
    #[arg(long, global = true, hide_short_help = true, value_name = "N", default_value_t = 0)]
    threads: usize,
    /// Print nothing but errors, warnings, and what --json or -o - asks for
    #[arg(short, long, global = true, hide_short_help = true)]
    quiet: bool,
    /// Colours; auto: on a terminal, unless NO_COLOR is set
    #[arg(long, global = true, hide_short_help = true, value_enum, value_name = "WHEN", default_value_t = ColorChoice::Auto)]
    color: ColorChoice,
}

impl Arguments {
    /// Makes stdout and stderr what was asked for.
    fn set_streams(&self) {
        let colours = match self.color {
            ColorChoice::Auto => anstream::ColorChoice::Auto,
            ColorChoice::Always => anstream::ColorChoice::Always,
            ColorChoice::Never => anstream::ColorChoice::Never,
        };
        colours.write_global();
        if self.quiet && !self.verb.is_listing() {
            text::output::be_quiet();
        }
        text::layout::fit_terminal();
    }
}

#[derive(Subcommand)]
enum Verb {
    Check(check::Arguments),
    Surface(surface::Arguments),
    Measure(measure::Arguments),
    Merge(merge::Arguments),
    Validate(validate::Arguments),
    Compare(compare::Arguments),
    Fit(fit::Arguments),
    Study(study::Arguments),
    Export(export::Arguments),
    Import(import::Arguments),
    Bench(bench::Arguments),
    Report(report::Arguments),
    Render(render::Arguments),
    #[command(visible_alias = "recolor")]
    Recolour(recolour::Arguments),
    Albedo(albedo::Arguments),
    Appearance(appearance::Arguments),
    Budget(budget::Arguments),
    Init(init::Arguments),
    Materials(lists::materials::Arguments),
    Presets(lists::presets::Arguments),
    Formats(lists::formats::Arguments),
    Cite(cite::Arguments),
    Completions(shell::completions::Arguments),
    Man(shell::man::Arguments),
}

impl Verb {
    /// Whether all that it prints is what it is there for.
    fn is_listing(&self) -> bool {
        matches!(
            self,
            Verb::Materials(_) | Verb::Presets(_) | Verb::Formats(_) | Verb::Cite(_) | Verb::Completions(_)
        )
    }

    fn run(&self, threads: usize) -> Result<u8> {
        match self {
            Verb::Check(arguments) => check::run(arguments),
            Verb::Surface(arguments) => surface::run(arguments),
            Verb::Measure(arguments) => measure::run(arguments, threads),
            Verb::Merge(arguments) => merge::run(arguments),
            Verb::Validate(arguments) => validate::run(arguments),
            Verb::Compare(arguments) => compare::run(arguments),
            Verb::Fit(arguments) => fit::run(arguments, threads),
            Verb::Study(arguments) => study::run(arguments),
            Verb::Export(arguments) => export::run(arguments),
            Verb::Import(arguments) => import::run(arguments),
            Verb::Bench(arguments) => bench::run(arguments),
            Verb::Report(arguments) => report::run(arguments),
            Verb::Render(arguments) => render::run(arguments),
            Verb::Recolour(arguments) => recolour::run(arguments),
            Verb::Albedo(arguments) => albedo::run(arguments),
            Verb::Appearance(arguments) => appearance::run(arguments),
            Verb::Budget(arguments) => budget::run(arguments),
            Verb::Init(arguments) => init::run(arguments),
            Verb::Materials(arguments) => lists::materials::run(arguments),
            Verb::Presets(arguments) => lists::presets::run(arguments),
            Verb::Formats(arguments) => lists::formats::run(arguments),
            Verb::Cite(arguments) => cite::run(arguments),
            Verb::Completions(arguments) => shell::completions::run(arguments),
            Verb::Man(arguments) => shell::man::run(arguments),
        }
    }
}

/// The program: runs the command line `words`, prints the error if there is one, and returns the exit code.
pub fn exit_code(words: impl IntoIterator<Item = OsString>) -> u8 {
    run(words).unwrap_or_else(|error| {
        print_error(&error);
        error.exit_code()
    })
}

/// Runs the command line `words`, the program's name first, and returns the exit code.
///
/// A panic, also one inside a worker, is returned as [`Error::Internal`]; the process's panic hook is replaced.
pub fn run(words: impl IntoIterator<Item = OsString>) -> Result<u8> {
    remember_panics();
    process::ending::survive_limits();
    let ended = guarded(|| {
        let words: Vec<OsString> = words.into_iter().collect();
        if shell::version::is_asked(&words) {
            Output::default().lines(shell::version::lines())?;
            return Ok(0);
        }
        without_line_breaks(&words)?;
        let arguments = match Arguments::try_parse_from(words) {
            Ok(arguments) => arguments,
            Err(answer) => {
                let answer = shell::options::with_tip(answer, Arguments::command);
                // Help and version too; a reader that has gone away does not change the answer.
                answer.print().ok();
                return Ok(answer.exit_code().try_into().unwrap_or(2));
            }
        };
        arguments.set_streams();
        process::ending::listen()?;
        pool(arguments.threads)?.install(|| arguments.verb.run(arguments.threads))
    });
    process::ending::done();
    ended
}

/// Runs a command line for a caller that lives on: nothing is printed, and signals are the caller's, as is the panic hook.
// Tested by `a_command_answers_without_printing` (tests/it/cli.rs).
pub fn answer(words: impl IntoIterator<Item = OsString>) -> (Result<u8>, Printed) {
    let mut printed = Printed::default();
    let ended = guarded(|| {
        let arguments =
            Arguments::try_parse_from(words).map_err(|answer| Error::Usage(first_line(&answer)))?;
        let (ended, kept) =
            pool(arguments.threads)?.install(|| text::output::kept(|| arguments.verb.run(arguments.threads)));
        printed = kept;
        ended
    });
    (ended, printed)
}

/// Refuses what a message could not name on its one line. Other characters that are not seen are escaped where they are
/// printed.
fn without_line_breaks(words: &[OsString]) -> Result<()> {
    let breaks = |c: char| matches!(c, '\n' | '\r' | '\u{b}' | '\u{c}' | '\u{85}' | '\u{2028}' | '\u{2029}');
    match words.iter().find(|word| word.to_string_lossy().contains(breaks)) {
        Some(word) => {
            let word = quoted(&word.to_string_lossy());
            Err(Error::Usage(format!("{word}: a name with a line break is not taken; rename the file")))
        }
        None => Ok(()),
    }
}

/// What is wrong with a command line, without the usage.
fn first_line(answer: &clap::Error) -> String {
    let text = answer.to_string();
    text.lines().next().unwrap_or_default().trim_start_matches("error: ").into()
}

/// The wanted number of worker threads, or as many as are allowed.
fn pool(wanted: usize) -> Result<rayon::ThreadPool> {
    let pool = threads::pool(wanted)?;
    let used = pool.current_num_threads();
    if wanted > used {
        warn(format_args!("--threads {wanted}: {used} are used, {} for each core", threads::PER_CORE));
    }
    Ok(pool)
}

/// The last panic's text and place, as the hook saw it. Decoders catch panics of their own: nothing is printed
/// before one reaches the top.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

fn remember(panic: &str) {
    if let Ok(mut last) = LAST_PANIC.lock() {
        *last = panic.split_whitespace().collect::<Vec<_>>().join(" ");
    }
}

/// From now on a panic is remembered instead of printed: it is an error of what was [`guarded`].
pub fn remember_panics() {
    panic::set_hook(Box::new(|panic| remember(&panic.to_string())));
}

/// Turns a panic into an error.
pub fn guarded<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    panic::catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| {
        let said = payload.downcast_ref::<String>().map(String::as_str);
        let said = said.or(payload.downcast_ref::<&str>().copied()).unwrap_or("panic").to_string();
        let seen = LAST_PANIC.lock().map(|last| last.clone()).unwrap_or_default();
        let text = if seen.is_empty() { said } else { seen };
        Err(Error::Internal(format!("{text} (please report)")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn every_help_fits_a_screen_and_shows_an_example() {
        let mut command = Arguments::command();
        command.build();
        for verb in command.get_subcommands_mut().filter(|verb| verb.get_name() != "help") {
            let help = verb.render_help().to_string();
            assert!(help.lines().count() <= 24, "{help}");
            assert!(help.lines().all(|line| line.chars().count() <= 100), "{help}");
            assert!(help.contains("Example: gonio "), "{help}");
        }
    }

    #[test]
    fn a_panic_in_a_worker_is_an_internal_error_in_one_line() {
        let failed = guarded(|| {
            pool(2)?.install(|| rayon::join(|| (), || panic!("a broken invariant")));
            Ok(())
        });
        let error = failed.expect_err("the worker panicked");
        assert_eq!(error.exit_code(), 70);
        assert_eq!(error.to_string(), "internal error: a broken invariant (please report)");
    }
}
