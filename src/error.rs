//! The program's errors: what each kind prints, and its exit code.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

/// The result of everything that can fail on account of the user or of the machine.
pub type Result<T> = std::result::Result<T, Error>;

/// One fault of a campaign file.
///
/// Prints as `path:line:column: key = value: allowed`; `line` and `column` count from 1 and are left out
/// where TOML gives none, `value` is left out where there is none (a missing or unknown key).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// The campaign file.
    pub path: String,
    /// Line in the file, from 1.
    pub line: Option<usize>,
    /// Column in the line, from 1.
    pub column: Option<usize>,
    /// Dotted key, as `surface.ggx.alpha`.
    pub key: String,
    /// The value as the user wrote it.
    pub value: Option<String>,
    /// What is allowed, and what to do.
    pub allowed: String,
    /// Whether the value means something, and too much of it: memory, time or size.
    #[serde(skip)]
    pub too_large: bool,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.path)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
            if let Some(column) = self.column {
                write!(f, ":{column}")?;
            }
        }
        write!(f, ": {}", self.key)?;
        if let Some(value) = &self.value {
            write!(f, " = {value}")?;
        }
        write!(f, ": {}", self.allowed)
    }
}

/// Everything that ends a command early.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The command line is wrong.
    #[error("{0}")]
    Usage(String),
    /// The campaign cannot be understood; all its faults.
    #[error("{}", faults_text(.0))]
    Campaign(Vec<Fault>),
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file's content is wrong.
    #[error("{}: {what}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The job is refused: memory, time or size.
    #[error("{0}")]
    Refused(String),
    /// The job ran, and its result breaks a law or an expectation.
    #[error("{0}")]
    Disagreement(String),
    /// The user, or the system, asked for the end. What was measured is kept.
    #[error("interrupted {0}")]
    Interrupted(String),
    /// A broken invariant of the program itself.
    #[error("internal error: {0}")]
    Internal(String),
}

/// A value, or what is wrong with the content that it was to come from.
pub type Checked<T> = std::result::Result<T, ContentError>;

/// Why the bytes of a file, or the values of a table, are not taken. [`Error::format`] adds the path.
#[derive(Debug, thiserror::Error)]
pub enum ContentError {
    /// They are not what the reader, or the format to be written, needs.
    #[error("{0}")]
    Wrong(String),
    /// They take more memory than may be used.
    #[error("{0}")]
    TooLarge(String),
    /// The system failed while they were read or written.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// Another file is at fault, which the error names.
    #[error("{0}")]
    Elsewhere(Box<Error>),
}

impl ContentError {
    /// The same, with where in the content it is.
    pub fn at(self, place: impl fmt::Display) -> Self {
        match self {
            ContentError::Wrong(what) => ContentError::Wrong(format!("{place}: {what}")),
            ContentError::TooLarge(what) => ContentError::TooLarge(format!("{place}: {what}")),
            ContentError::Io(e) => ContentError::Io(io::Error::new(e.kind(), format!("{place}: {e}"))),
            elsewhere => elsewhere,
        }
    }
}

/// What is wrong with a content, in the words of `format!`.
macro_rules! wrong {
    ($($words:tt)*) => {
        $crate::error::ContentError::Wrong(format!($($words)*))
    };
}
pub(crate) use wrong;

impl From<String> for ContentError {
    fn from(what: String) -> Self {
        ContentError::Wrong(what)
    }
}

impl From<&str> for ContentError {
    fn from(what: &str) -> Self {
        ContentError::Wrong(what.into())
    }
}

impl From<Error> for ContentError {
    fn from(error: Error) -> Self {
        ContentError::Elsewhere(Box::new(error))
    }
}

impl Error {
    /// The process's exit code for this error. A campaign whose only faults are sizes is refused as too large.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Disagreement(_) => 1,
            Error::Campaign(faults) if !faults.is_empty() && faults.iter().all(|fault| fault.too_large) => 4,
            Error::Usage(_) | Error::Campaign(_) => 2,
            Error::Io { .. } | Error::Format { .. } => 3,
            Error::Refused(_) => 4,
            Error::Internal(_) => 70,
            Error::Interrupted(_) => 130,
        }
    }

    /// An input or output error at `path`.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Error::Io { path: path.to_path_buf(), source }
    }

    /// What is wrong with the content of the file at `path`; whatever it quotes of the file, it is one line. A content that
    /// is too large for the memory is refused.
    // Tested by tests/process/bombs.rs.
    pub fn format(path: &Path, what: impl Into<ContentError>) -> Self {
        match what.into() {
            ContentError::Wrong(what) => Error::Format { path: path.to_path_buf(), what: one_line(&what) },
            ContentError::TooLarge(what) => {
                Error::Refused(format!("{}: {}", path.display(), one_line(&what)))
            }
            ContentError::Io(source) => Error::io(path, source),
            ContentError::Elsewhere(error) => *error,
        }
    }
}

/// Whether a character of a foreign text does something to the text around it instead of being seen: control characters,
/// the marks that turn the direction of writing, joiners and separators without width, and what is no text.
// Tested by `characters_that_act_are_told_from_those_that_are_seen`.
pub fn is_unseen(c: char) -> bool {
    let acts = matches!(c, '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
        | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffd}' | '\u{e0000}'..='\u{e007f}');
    c.is_control() || acts
}

/// A foreign text on one line: a space for each character that is not seen.
pub fn on_one_line(text: &str) -> String {
    text.chars().map(|c| if is_unseen(c) { ' ' } else { c }).collect()
}

/// JSON whose characters that are not seen, which stand in its texts alone, are written as its own escapes: the
/// document is the same.
// Tested by `words_of_files_cannot_act_on_a_terminal` (src/cli/text/output.rs), tests/it/foreign_words.rs.
pub fn seen_in_json(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        if is_unseen(c) && c != '\n' {
            out.extend(c.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")));
        } else {
            out.push(c);
        }
    }
    out
}

/// A foreign text, or a message that quotes one, as a part of one line: characters that are not seen ([`is_unseen`])
/// become `?`, and the middle of a long one is left out.
// Tested by `findings_of_the_fuzzer_are_answered_in_one_line` (tests/it/fuzzed.rs).
fn one_line(text: &str) -> String {
    const HEAD: usize = 360;
    const TAIL: usize = 120;
    let line: String = text.chars().map(|c| if is_unseen(c) { '?' } else { c }).collect();
    let count = line.chars().count();
    if count <= HEAD + TAIL {
        return line;
    }
    let head: String = line.chars().take(HEAD).collect();
    let tail: String = line.chars().skip(count - TAIL).collect();
    format!("{head} ... {tail}")
}

/// One line per fault; the caller adds `error: ` to the first line only, so the others carry it here.
fn faults_text(faults: &[Fault]) -> String {
    let lines: Vec<String> = faults.iter().map(Fault::to_string).collect();
    lines.join("\nerror: ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_that_act_are_told_from_those_that_are_seen() {
        assert!(
            "\n\t\u{1b}\u{7f}\u{9b}\u{200f}\u{202e}\u{2066}\u{2069}\u{feff}\u{fffd}\u{e0041}"
                .chars()
                .all(is_unseen)
        );
        assert!(!"a \u{a0}\u{b5}\u{b0}\u{5d0}\u{4e2d}\u{1f600}~".chars().any(is_unseen));
        let error = Error::format(Path::new("t"), "a\u{202e}b\u{1b}[2Jc");
        assert_eq!(error.to_string(), "t: a?b?[2Jc");
    }

    #[test]
    fn a_fault_names_file_line_key_value_and_range() {
        let fault = Fault {
            path: "gold.toml".into(),
            line: Some(7),
            column: Some(1),
            key: "surface.ggx.alpha".into(),
            value: Some("0".into()),
            allowed: "must lie in [1e-4, 10]".into(),
            too_large: false,
        };
        assert_eq!(fault.to_string(), "gold.toml:7:1: surface.ggx.alpha = 0: must lie in [1e-4, 10]");
        let large = Fault { too_large: true, ..fault.clone() };
        let code = |faults: &[&Fault]| Error::Campaign(faults.iter().copied().cloned().collect()).exit_code();
        assert_eq!([code(&[&fault]), code(&[&fault, &large]), code(&[&large, &large])], [2, 2, 4]);
    }
}
