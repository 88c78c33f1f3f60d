//! What the program prints: stdout that may go away, warnings, aligned columns, numbers with their units.

use std::cell::RefCell;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::Path;

use indicatif::HumanCount;
use serde::Serialize;
use serde_json::Value;

use crate::error::{Error, Result, is_unseen, seen_in_json};
use crate::files;
use crate::files::memory;
use crate::text_decoding::decode_text;

/// Columns of the terminal that every text fits.
pub const WIDTH: usize = 100;

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

/// stdout. A reader that closes it ends the printing, not the run.
#[derive(Default)]
pub struct Output {
    closed: bool,
}

impl Output {
    /// Prints one line.
    pub fn line(&mut self, text: impl Display) -> Result<()> {
        self.print(&seen(text))
    }

    fn print(&mut self, text: &str) -> Result<()> {
        if self.closed || is_kept(|kept| kept.out.extend([text, "\n"])) {
            return Ok(());
        }
        match writeln!(io::stdout().lock(), "{text}") {
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
pub fn say(text: impl Display) {
    let text = seen(text);
    if !is_kept(|kept| kept.said.push(text.clone())) {
        writeln!(io::stderr().lock(), "{text}").ok();
    }
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

/// Columns under their headings, flush right.
pub fn columns(headings: &[&str], rows: &[Vec<String>]) -> Vec<String> {
    let width = |column: usize, heading: &str| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        cells.chain([heading.chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = headings.iter().enumerate().map(|(k, heading)| width(k, heading)).collect();
    let line = |cells: &[String]| {
        let padded = cells.iter().zip(&widths).map(|(cell, &width)| format!("{cell:>width$}"));
        padded.collect::<Vec<_>>().join("  ")
    };
    let head: Vec<String> = headings.iter().map(|heading| heading.to_string()).collect();
    [line(&head)].into_iter().chain(rows.iter().map(|row| line(row))).collect()
}

/// `text` behind `head`, broken at spaces to fit [`WIDTH`]; further lines start below the text's beginning.
pub fn wrapped(head: &str, text: &str) -> Vec<String> {
    let indent = " ".repeat(head.chars().count());
    let mut lines = Vec::new();
    let mut line = head.to_string();
    let mut empty = true;
    for word in text.split_whitespace() {
        if !empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines.push(std::mem::replace(&mut line, indent.clone()));
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
        empty = false;
    }
    lines.push(line);
    lines
}

/// A whole number with commas: `65,536`.
pub fn grouped(number: impl Into<u64>) -> String {
    HumanCount(number.into()).to_string()
}

/// Bytes in the unit that suits them.
pub fn bytes(count: u64) -> String {
    let count = count as f64;
    let units = [("GiB", 30), ("MiB", 20), ("KiB", 10)];
    let fitting =
        units.iter().map(|&(unit, bits)| (unit, count / f64::from(1 << bits))).find(|(_, n)| *n >= 1.0);
    fitting.map_or(format!("{count} bytes"), |(unit, n)| {
        if n < 10.0 { format!("{n:.1} {unit}") } else { format!("{n:.0} {unit}") }
    })
}

/// Seconds in the unit that suits them.
pub fn duration(seconds: f64) -> String {
    const UNITS: [(&str, f64); 4] =
        [("years", 31_557_600.0), ("days", 86_400.0), ("h", 3600.0), ("min", 60.0)];
    match UNITS.iter().find(|(_, unit)| seconds >= 2.0 * unit) {
        Some((unit, size)) => format!("{:.1} {unit}", seconds / size),
        None if seconds < 10.0 => format!("{seconds:.1} s"),
        None => format!("{seconds:.0} s"),
    }
}

/// A mean with its standard error, the error to two digits.
pub fn with_error(mean: f64, se: Option<f64>) -> String {
    match se {
        None => format!("{mean:.5} +- n/a"),
        Some(se) if se > 0.0 => {
            let decimals = (1.0 - se.log10().floor()).clamp(0.0, 9.0) as usize;
            format!("{mean:.decimals$} +- {se:.decimals$}")
        }
        Some(_) => format!("{mean:.5} +- 0"),
    }
}

/// A number, or `n/a`.
pub fn or_na(value: Option<f64>, decimals: usize) -> String {
    value.map_or("n/a".into(), |value| format!("{value:.decimals$}"))
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

    #[test]
    fn numbers_are_printed_with_their_units() {
        assert_eq!(grouped(7u32), "7");
        assert_eq!(grouped(1_234_567u64), "1,234,567");
        assert_eq!(
            (bytes(12), bytes(2048), bytes(50 << 20)),
            ("12 bytes".into(), "2.0 KiB".into(), "50 MiB".into())
        );
        assert_eq!(
            (duration(1.26), duration(90.0), duration(7200.0)),
            ("1.3 s".into(), "90 s".into(), "2.0 h".into())
        );
    }

    #[test]
    fn the_error_decides_the_digits() {
        assert_eq!(with_error(0.934_121_7, Some(0.000_213)), "0.93412 +- 0.00021");
        assert_eq!(with_error(0.5, Some(12.0)), "0 +- 12");
        assert_eq!(with_error(1.0, Some(0.0)), "1.00000 +- 0");
        assert_eq!(with_error(1.0, None), "1.00000 +- n/a");
    }

    #[test]
    fn columns_are_flush_right() {
        let rows = [vec!["1".to_string(), "22.5".into()], vec!["333".into(), "4".into()]];
        assert_eq!(columns(&["a", "b"], &rows), ["  a     b", "  1  22.5", "333     4"]);
    }

    #[test]
    fn long_texts_are_broken_at_spaces() {
        let lines = wrapped("skips   ", &"word ".repeat(40));
        assert!(lines.len() == 3 && lines.iter().all(|line| line.len() <= WIDTH), "{lines:?}");
        assert!(lines[1].starts_with("        word"));
    }
}
