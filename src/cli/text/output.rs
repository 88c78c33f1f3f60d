//! What the program prints: stdout that may go away, notes, warnings and errors on stderr, JSON.

use std::cell::RefCell;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use anstyle::{AnsiColor, Style};
use serde::Serialize;
use serde_json::Value;

use super::layout::fitted;
use crate::error::{Error, Result, is_unseen, seen_in_json};
use crate::files;
use crate::files::memory;
use crate::text_decoding::decode_text;

/// What a command would have printed, for a caller who has no terminal.
#[derive(Default)]
pub struct Printed {
    /// Of stdout.
    pub out: String,
    /// Lines of stderr.
    pub said: Vec<String>,
}

thread_local! {
    /// Where this thread's words go instead of stdout and stderr.
    static KEPT: RefCell<Option<Printed>> = const { RefCell::new(None) };
}

/// Does `work`, and keeps what this thread prints meanwhile.
// Tested by `what_a_thread_prints_is_kept_for_its_caller`.
pub fn kept<T>(work: impl FnOnce() -> T) -> (T, Printed) {
    KEPT.set(Some(Printed::default()));
    let done = work();
    (done, KEPT.take().unwrap_or_default())
}

/// Whether the words are kept, which `keep` then does.
fn is_kept(keep: impl FnOnce(&mut Printed)) -> bool {
    KEPT.with_borrow_mut(|kept| kept.as_mut().map(keep)).is_some()
}

/// Whether results in words, notes and progress are left out.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From now on nothing is printed but warnings, errors, and documents that were asked for.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether that is so.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed) && !is_kept(|_| ())
}

/// What a line may begin with, and its colour on a terminal.
const COLOURED: [(&str, AnsiColor); 6] = [
    ("error:", AnsiColor::Red),
    ("warning:", AnsiColor::Yellow),
    ("note:", AnsiColor::Cyan),
    ("verdict: failed", AnsiColor::Red),
    ("verdict: passed", AnsiColor::Green),
    ("verdict: not judged", AnsiColor::Yellow),
];

/// A line with its first words in their colour, which a stream without colours takes out again.
fn coloured(line: &str) -> String {
    match COLOURED.iter().find(|(words, _)| line.starts_with(words)) {
        Some((words, colour)) => {
            let style = Style::new().bold().fg_color(Some((*colour).into()));
            format!("{style}{words}{style:#}{}", &line[words.len()..])
        }
        None => line.into(),
    }
}

/// stdout. A reader that closes it ends the printing, not the run.
#[derive(Default)]
pub struct Output {
    closed: bool,
}

impl Output {
    /// Prints one line of results in words; one that is too long for a narrow terminal is broken.
    pub fn line(&mut self, text: impl Display) -> Result<()> {
        if is_quiet() { Ok(()) } else { fitted(&seen(text)).iter().try_for_each(|line| self.print(line)) }
    }

    /// Prints what the command is there for, in lines as they are.
    pub fn document(&mut self, text: impl Display) -> Result<()> {
        self.print(&seen(text))
    }

    fn print(&mut self, text: &str) -> Result<()> {
        if self.closed || is_kept(|kept| kept.out.extend([text, "\n"])) {
            return Ok(());
        }
        match writeln!(anstream::stdout().lock(), "{}", coloured(text)) {
            Err(e) if e.kind() == ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(())
            }
            written => written.map_err(|e| Error::io(Path::new("stdout"), e)),
        }
    }

    /// Prints several lines.
    pub fn lines<T: Display>(&mut self, lines: impl IntoIterator<Item = T>) -> Result<()> {
        lines.into_iter().try_for_each(|line| self.line(line))
    }

    /// Prints a JSON document.
    pub fn json(&mut self, document: &impl Serialize) -> Result<()> {
        self.print(&seen_in_json(&json_text(document)?))
    }
}

/// Text for a terminal: what would act on it instead of being seen is escaped, as `\u{202e}`; ends of lines and tabs stay.
///
/// The one place for words of files on their way to a terminal.
// Tested by `words_of_files_cannot_act_on_a_terminal`.
fn seen(text: impl Display) -> String {
    let mut out = String::new();
    for c in text.to_string().chars() {
        if is_unseen(c) && !matches!(c, '\n' | '\t') { out.extend(c.escape_unicode()) } else { out.push(c) }
    }
    out
}

/// A JSON document as text, without an end of line.
pub fn json_text(document: &impl Serialize) -> Result<String> {
    serde_json::to_string_pretty(document).map_err(|e| Error::Internal(format!("printing JSON: {e}")))
}

/// The JSON document in a file.
///
/// Errors: [`Error::Io`], [`Error::Format`].
pub fn read_json(path: &Path) -> Result<Value> {
    let bytes = files::read(path)?;
    memory::check_file(path, json_bytes(&bytes))?;
    parsed_json(&bytes).map_err(|why| Error::format(path, format!("is no JSON: {why}")))
}

/// The most bytes of memory that a JSON document of these bytes takes: its text, and a node for each word.
fn json_bytes(bytes: &[u8]) -> u64 {
    const NODE: u64 = 100;
    2 * bytes.len() as u64 + NODE * memory::words(bytes)
}

/// A JSON document from its bytes, which an editor may have saved with a byte order mark.
pub fn parsed_json(bytes: &[u8]) -> std::result::Result<Value, String> {
    memory::check(json_bytes(bytes)).map_err(|why| why.to_string())?;
    serde_json::from_str(&decode_text(bytes)?).map_err(|e| e.to_string())
}

/// Plain data as JSON.
pub fn to_json(data: &impl Serialize) -> Result<Value> {
    serde_json::to_value(data).map_err(|e| Error::Internal(format!("building JSON: {e}")))
}

/// Prints a line on stderr; whether anybody reads it does not matter.
fn say(text: impl Display) {
    let text = seen(text);
    if !is_kept(|kept| kept.said.push(text.clone())) {
        writeln!(anstream::stderr().lock(), "{}", coloured(&text)).ok();
    }
}

/// Prints on stderr what is good to know, or how far the work is.
pub fn inform(text: impl Display) {
    if !is_quiet() {
        say(text);
    }
}

/// Prints a note on stderr.
pub fn note(text: impl Display) {
    inform(format_args!("note: {text}"));
}

/// Prints a warning on stderr, one line.
pub fn warn(text: impl Display) {
    say(format_args!("warning: {}", text.to_string().replace('\n', " ")));
}

/// Prints an error on stderr, with the number of faults where a campaign has some. An interruption is none.
pub fn print_error(error: &Error) {
    if let Error::Interrupted(_) = error {
        return say(error);
    }
    say(format_args!("error: {error}"));
    if let Error::Campaign(faults) = error {
        let file = faults.first().map_or("the campaign", |fault| &fault.path);
        let plural = if faults.len() == 1 { "" } else { "s" };
        say(format_args!("{} fault{plural} in {file}; nothing was measured", faults.len()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_thread_prints_is_kept_for_its_caller() {
        let (done, printed) = kept(|| {
            warn("a\nb");
            Output::default().line("one").and_then(|()| Output::default().line("two"))
        });
        assert!(done.is_ok());
        assert_eq!((printed.out.as_str(), printed.said), ("one\ntwo\n", vec!["warning: a b".to_string()]));
        assert!(!is_kept(|_| ()), "afterwards it prints again");
    }

    #[test]
    fn json_is_read_with_a_mark() {
        let wide = std::iter::once(0xfeff).chain("{\"a\": 1}".encode_utf16()).flat_map(u16::to_le_bytes);
        for bytes in [b"\xef\xbb\xbf{\"a\": 1}".to_vec(), wide.collect()] {
            assert_eq!(parsed_json(&bytes).expect("JSON")["a"], 1);
        }
        assert!(parsed_json(b"{\"a\": \"\xb0\"}").expect_err("no UTF-8").contains("byte 7 is not UTF-8"));
    }

    #[test]
    fn words_of_files_cannot_act_on_a_terminal() {
        assert_eq!(seen("a\u{1b}[2J \u{202e}b\n\t\u{b5}"), "a\\u{1b}[2J \\u{202e}b\n\t\u{b5}");
        let document = serde_json::json!({ "name": "\u{202e}\u{9b}\u{e0041}\n" });
        let text = seen_in_json(&json_text(&document).expect("JSON"));
        assert!(text.is_ascii() && text.contains("\\u202e\\u009b\\udb40\\udc41\\n"), "{text}");
        assert_eq!(parsed_json(text.as_bytes()).expect("JSON"), document);
    }
}
