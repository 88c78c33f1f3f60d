//! Tables and paragraphs that fit the terminal.

use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Columns of text where stdout is no terminal, and the most on one.
pub const WIDEST: usize = 100;
/// Columns that text takes on a narrower terminal.
const NARROWEST: usize = 60;
/// Spaces between two columns of a table.
const GAP: usize = 2;
/// Where text of its own begins at the latest, behind a word such as `samples`.
const LATEST_TEXT: usize = 16;

static WIDTH: AtomicUsize = AtomicUsize::new(WIDEST);

/// From now on text fits the terminal of stdout, where it is one.
pub fn fit_terminal() {
    WIDTH.store(terminal_columns().max(NARROWEST), Ordering::Relaxed);
}

/// Columns of stdout's terminal, also of one that does not know its rows; [`WIDEST`] at most, and elsewhere.
pub fn terminal_columns() -> usize {
    #[cfg(unix)]
    let columns = rustix::termios::tcgetwinsize(io::stdout()).map(|size| size.ws_col).ok();
    #[cfg(not(unix))]
    let columns = terminal_size::terminal_size_of(io::stdout()).map(|(columns, _)| columns.0);
    columns.filter(|&columns| columns > 0).map_or(WIDEST, usize::from).min(WIDEST)
}

/// Columns that text may take.
pub fn width() -> usize {
    WIDTH.load(Ordering::Relaxed)
}

/// Columns under their headings, flush right; those that do not fit the width follow below, behind the first again.
pub fn columns(headings: &[&str], rows: &[Vec<String>]) -> Vec<String> {
    columns_within(width(), headings, rows)
}

fn columns_within(most: usize, headings: &[&str], rows: &[Vec<String>]) -> Vec<String> {
    let width = |column: usize, heading: &str| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        cells.chain([heading.chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = headings.iter().enumerate().map(|(k, heading)| width(k, heading)).collect();
    let block = |columns: &Vec<usize>| {
        let line = |cell: &dyn Fn(usize) -> Option<String>| {
            let padded = columns
                .iter()
                .filter_map(|&k| cell(k).map(|text| format!("{text:>width$}", width = widths[k])));
            padded.collect::<Vec<_>>().join(&" ".repeat(GAP))
        };
        let head = line(&|k| Some(headings[k].to_string()));
        let rows = rows.iter().map(|row| line(&|k| row.get(k).cloned()));
        [head].into_iter().chain(rows).collect::<Vec<_>>()
    };
    blocks(most, headings, &widths).iter().flat_map(block).collect()
}

/// The columns that stand side by side, block after block. Each block begins with those that name the row.
fn blocks(most: usize, headings: &[&str], widths: &[usize]) -> Vec<Vec<usize>> {
    let names = if headings.get(1) == Some(&"phi_i") { 2 } else { 1 }.min(headings.len());
    let taken = |columns: &[usize]| columns.iter().map(|&k| widths[k] + GAP).sum::<usize>();
    let mut blocks: Vec<Vec<usize>> = vec![(0..names).collect()];
    for (column, width) in widths.iter().enumerate().skip(names) {
        let last = blocks.len() - 1;
        let fits = taken(&blocks[last]) + width <= most;
        if fits || blocks[last].len() == names {
            blocks[last].push(column);
        } else {
            blocks.push((0..names).chain([column]).collect());
        }
    }
    blocks
}

/// `text` behind `head`, broken at spaces to fit the width; further lines start below the text's beginning.
pub fn wrapped(head: &str, text: &str) -> Vec<String> {
    wrapped_within(width(), head, text)
}

fn wrapped_within(most: usize, head: &str, text: &str) -> Vec<String> {
    let indent = " ".repeat(head.chars().count());
    let mut lines = Vec::new();
    let mut line = head.to_string();
    let mut empty = true;
    for word in text.split_whitespace() {
        if !empty && line.chars().count() + 1 + word.chars().count() > most {
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

/// A line that is too long for a narrow terminal, broken at spaces.
pub fn fitted(line: &str) -> Vec<String> {
    fitted_within(width(), line)
}

fn fitted_within(most: usize, line: &str) -> Vec<String> {
    if most == WIDEST || line.chars().count() <= most {
        return vec![line.into()];
    }
    let (head, text) = line.split_at(text_begins(line));
    wrapped_within(most, head, text)
}

/// Where the text of a line begins: behind its first word where that stands in a column of its own, else with the line.
fn text_begins(line: &str) -> usize {
    let indent = line.len() - line.trim_start().len();
    let column = line[indent..].find("  ").map(|gap| {
        let behind = indent + gap;
        behind + (line[behind..].len() - line[behind..].trim_start().len())
    });
    column.filter(|&at| at <= LATEST_TEXT).unwrap_or(indent)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(rows: &[&[&str]]) -> Vec<Vec<String>> {
        rows.iter().map(|row| row.iter().map(|cell| cell.to_string()).collect()).collect()
    }

    #[test]
    fn columns_are_flush_right() {
        let rows = texts(&[&["1", "22.5"], &["333", "4"]]);
        assert_eq!(columns(&["a", "b"], &rows), ["  a     b", "  1  22.5", "333     4"]);
    }

    #[test]
    fn columns_that_do_not_fit_follow_below() {
        let rows = texts(&[&["0", "0", "0.1", "0.2"], &["60", "0", "0.3", "0.4"]]);
        let lines = columns_within(22, &["theta_i", "phi_i", "one", "two"], &rows);
        let wanted = [
            "theta_i  phi_i  one",
            "      0      0  0.1",
            "     60      0  0.3",
            "theta_i  phi_i  two",
            "      0      0  0.2",
            "     60      0  0.4",
        ];
        assert_eq!(lines, wanted);
        // All of them where they fit to the last column, and no block of names alone where nothing does.
        assert_eq!(
            columns_within(24, &["theta_i", "phi_i", "one", "two"], &rows)[0],
            "theta_i  phi_i  one  two"
        );
        assert_eq!(columns_within(5, &["name", "long heading"], &texts(&[&["a", "b"]])).len(), 2);
    }

    #[test]
    fn long_texts_are_broken_at_spaces() {
        let lines = wrapped("skips   ", &"word ".repeat(40));
        assert!(lines.len() == 3 && lines.iter().all(|line| line.len() <= WIDEST), "{lines:?}");
        assert!(lines[1].starts_with("        word"));
    }

    #[test]
    fn a_line_fits_a_narrow_terminal() {
        let line = "time          3.0 s (1.0 s of it making patches), 5.0 s of processor time";
        let lines = [
            "time          3.0 s (1.0 s of it making",
            "              patches), 5.0 s of",
            "              processor time",
        ];
        assert_eq!(fitted_within(40, line), lines);
        assert_eq!(fitted_within(WIDEST, line), [line]);
        assert_eq!(fitted_within(12, "  plain words here"), ["  plain", "  words here"]);
    }
}
