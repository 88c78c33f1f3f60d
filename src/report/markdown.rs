//! Words of files as text of a Markdown page, where they can make no element, link, cell or header of their own.
//!
//! The one place for such words on their way to Markdown; on their way to HTML it is `plot::escaped`.

use crate::error::is_unseen;

/// A text in a line or in a cell of a table.
// Tested by `words_stay_words`.
pub fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut before = ' ';
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '|' | '`' | '\\' | '*' => out.extend(['\\', c]),
            // Behind a bracket it would begin the target of a link.
            '(' | '[' if before == ']' => out.extend(['\\', c]),
            '\n' | '\t' => out.push(' '),
            c if is_unseen(c) => out.push(char::REPLACEMENT_CHARACTER),
            c => out.push(c),
        }
        before = c;
    }
    out
}

/// A digest between backticks; what is none as [`plain`] text.
pub fn code(text: &str) -> String {
    let is_digest = !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric());
    if is_digest { format!("`{text}`") } else { plain(text) }
}

/// What begins and ends a listing of this text: more backticks than stand in it side by side.
pub fn fence(text: &str) -> String {
    let longest = text.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    "`".repeat(longest.max(2) + 1)
}

/// The lines of a listing, without characters that are not seen.
pub fn listing(text: &str) -> String {
    let unseen = |c: char| is_unseen(c) && !matches!(c, '\n' | '\t');
    text.chars().map(|c| if unseen(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stay_words() {
        let text = "<img src=x onerror=alert(1)> | a `b` [c](d) [e][f] \u{202e}g\n# h";
        let safe = "&lt;img src=x onerror=alert(1)&gt; \\| a \\`b\\` [c]\\(d) [e]\\[f] \u{fffd}g # h";
        assert_eq!(plain(text), safe);
        assert_eq!(
            plain("agrees: L1 0.012 [0.010, 0.014], theta_i 40"),
            "agrees: L1 0.012 [0.010, 0.014], theta_i 40"
        );
        assert_eq!((code("0f9a"), code("`<b>")), ("`0f9a`".into(), "\\`&lt;b&gt;".into()));
        assert_eq!((fence("a = 1"), fence("# ```` b ``")), ("```".into(), "`````".into()));
        assert_eq!(listing("a\n\tb\u{1b}c"), "a\n\tb\u{fffd}c");
    }
}
