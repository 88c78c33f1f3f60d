//! The faults and notes of one file: where they are, what the user wrote there, and what is allowed.

use std::cell::RefCell;
use std::cmp::Reverse;
use std::collections::HashSet;
use std::ops::Range;

use crate::error::{Fault, is_unseen};

/// Faults that are listed; a file with more is not a campaign, and its report stays readable.
const LISTED: usize = 1000;

/// Longest quotation of the user's text in a message, in characters.
const QUOTED: usize = 80;

/// Collects the faults and notes of one file.
///
/// Shared by all readers of the file (hence the cell): a reader records what it finds and goes on.
pub(crate) struct Report<'s> {
    path: &'s str,
    source: &'s str,
    line_starts: Vec<usize>,
    found: RefCell<FaultList>,
}

#[derive(Default)]
struct FaultList {
    faults: Vec<Fault>,
    unlisted: usize,
    notes: Vec<String>,
    misspelt: HashSet<String>,
}

impl<'s> Report<'s> {
    /// An empty report on the text `source` of the file called `path`.
    pub fn new(path: &'s str, source: &'s str) -> Self {
        let after_newlines = source.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1);
        let line_starts = std::iter::once(0).chain(after_newlines).collect();
        Report { path, source, line_starts, found: RefCell::default() }
    }

    /// Records a fault of `key` at byte `at`.
    pub fn fault(&self, key: &str, at: Option<usize>, value: Option<String>, allowed: String) {
        self.record(self.located(key, at, value, allowed));
    }

    /// Records that the value of `key` asks for too much: memory, time or size.
    pub fn too_large(&self, key: &str, at: Option<usize>, value: Option<String>, allowed: String) {
        self.record(Fault { too_large: true, ..self.located(key, at, value, allowed) });
    }

    fn record(&self, fault: Fault) {
        let mut found = self.found.borrow_mut();
        if found.faults.len() < LISTED { found.faults.push(fault) } else { found.unlisted += 1 }
    }

    /// Whether the list has reached its end, so that faults are only counted: no need to word them with care.
    pub fn is_full(&self) -> bool {
        self.found.borrow().faults.len() >= LISTED
    }

    /// Records that the file has a wrong key in the place of `key`.
    pub fn misspelt(&self, key: String) {
        self.found.borrow_mut().misspelt.insert(key);
    }

    /// Whether a wrong key stands in the place of `key`.
    pub fn is_misspelt(&self, key: &str) -> bool {
        self.found.borrow().misspelt.contains(key)
    }

    /// Records a note: what the user should know though nothing is wrong. Printed like a fault.
    pub fn note(&self, key: &str, at: Option<usize>, value: Option<String>, text: String) {
        let note = self.located(key, at, value, text).to_string();
        self.found.borrow_mut().notes.push(note);
    }

    /// The user's own text at `span`, on one line and cut where it is long.
    pub fn quote(&self, span: &Range<usize>) -> Option<String> {
        self.source.get(span.clone()).filter(|text| !text.is_empty()).map(quoted)
    }

    /// All faults in the order of the file (those without a place last), and all notes.
    pub fn into_parts(self) -> (Vec<Fault>, Vec<String>) {
        let path = self.path.to_string();
        let FaultList { mut faults, unlisted, notes, .. } = self.found.into_inner();
        faults.sort_by_key(|f| (f.line.unwrap_or(usize::MAX), f.column));
        if unlisted > 0 {
            let allowed = format!("{unlisted} further faults are not listed");
            let key = "file".into();
            let too_large = false;
            faults.push(Fault { path, line: None, column: None, key, value: None, allowed, too_large });
        }
        (faults, notes)
    }

    fn located(&self, key: &str, at: Option<usize>, value: Option<String>, allowed: String) -> Fault {
        let (line, column) = at.map(|at| self.line_and_column(at)).unzip();
        let (path, key) = (self.path.to_string(), quoted(key));
        Fault { path, line, column, key, value, allowed, too_large: false }
    }

    /// Line and column of byte `at`, both from 1, the column in characters.
    fn line_and_column(&self, at: usize) -> (usize, usize) {
        let line = self.line_starts.partition_point(|start| *start <= at);
        let start = self.line_starts[line - 1];
        let column = self.source.get(start..at).map_or(at - start, |text| text.chars().count());
        (line, column + 1)
    }
}

/// A text of a file as a message quotes it: every run of white space as one blank, characters that are not seen
/// ([`is_unseen`]) escaped, cut to a readable length.
pub(crate) fn quoted(text: &str) -> String {
    // Blanks may be most of it.
    let head: String = text.chars().take(20 * QUOTED).collect();
    let words: Vec<&str> = head.split_whitespace().collect();
    let (mut line, mut length) = (String::new(), 0);
    for c in words.join(" ").chars() {
        let seen = if is_unseen(c) { c.escape_default().to_string() } else { c.to_string() };
        length += seen.chars().count();
        if length > QUOTED {
            line.push_str("...");
            break;
        }
        line.push_str(&seen);
    }
    line
}

/// The name that `word` most likely stands for: a slip or two, or another case.
pub(crate) fn nearest<'n>(word: &str, names: &[&'n str]) -> Option<&'n str> {
    if word.chars().count() > 40 {
        return None;
    }
    let word = word.to_lowercase();
    let slips = |name: &&'n str| strsim::osa_distance(&word, &name.to_lowercase());
    // Of names equally near, the longest: it keeps most of what was typed.
    let best = names.iter().min_by_key(|name| (slips(name), Reverse(name.len())))?;
    (slips(best) <= (best.len() / 3).max(1)).then_some(*best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_or_another_case_finds_the_name() {
        let names = ["alpha", "alpha_x", "alpha_y"];
        assert_eq!(nearest("alhpa", &names), Some("alpha"));
        assert_eq!(nearest("Alpha", &names), Some("alpha"));
        assert_eq!(nearest("alphax", &names), Some("alpha_x"));
        assert_eq!(nearest("colour", &names), None);
        assert_eq!(nearest("", &names), None);
    }

    #[test]
    fn places_count_characters_from_one() {
        let report = Report::new("a.toml", "é = 1\r\nüb = 2\n");
        assert_eq!(report.line_and_column(0), (1, 1));
        assert_eq!(report.line_and_column(3), (1, 3));
        assert_eq!(report.line_and_column(8), (2, 1));
        assert_eq!(report.line_and_column(16), (3, 1));
    }

    #[test]
    fn a_quotation_is_one_short_line() {
        assert_eq!(quoted("[\n  1,\n  2,\n]"), "[ 1, 2, ]");
        assert_eq!(quoted("a\u{7}b\u{202e}c"), "a\\u{7}b\\u{202e}c");
        assert_eq!(quoted(&"x".repeat(5000)).len(), QUOTED + 3);
        // Sixteen of five characters each.
        assert_eq!(quoted(&"\u{7}".repeat(QUOTED)), format!("{}...", "\\u{7}".repeat(16)));
    }

    #[test]
    fn faults_beyond_the_list_are_counted() {
        let report = Report::new("a.toml", "");
        for _ in 0..LISTED + 7 {
            report.fault("k", None, None, "wrong".into());
        }
        let (faults, _) = report.into_parts();
        assert_eq!(faults.len(), LISTED + 1);
        assert_eq!(faults[LISTED].allowed, "7 further faults are not listed");
    }
}
