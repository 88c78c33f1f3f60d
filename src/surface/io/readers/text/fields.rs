//! The lines of a height map in text, and the fields of a line.

/// Whether a line is empty or a comment.
pub fn is_passed_over(line: &str) -> bool {
    let line = line.trim();
    line.is_empty() || line.starts_with('#')
}

/// The fields of a line: parted by blanks, tabs or semicolons, or else by commas. A comma inside a field stays, so that
/// `0,5` is no number, and never two.
pub fn fields(line: &str) -> impl Iterator<Item = &str> {
    let blank = |c: char| c.is_whitespace() || c == ';';
    let line = line.trim_matches(|c: char| blank(c) || c == ',');
    let commas = !line.contains(blank);
    let parted = move |c: char| if commas { c == ',' } else { blank(c) };
    line.split(parted).map(|field| field.trim_matches(',')).filter(|field| !field.is_empty())
}

/// The cells of a line of a matrix, empty ones too where a mark parts them (`;`, a tab or a comma); where that mark also
/// ends the line, nothing follows it.
pub fn cells(line: &str) -> Box<dyn Iterator<Item = &str> + '_> {
    let line = line.trim_end_matches(['\r', ' ']);
    // Numbers that blanks part: the mark is not all that does.
    let parts_all = |mark: &char| {
        let is_one =
            |cell: &str| !cell.contains(char::is_whitespace) || cell.starts_with(char::is_alphabetic);
        line.contains(*mark) && line.split(*mark).all(|cell| is_one(cell.trim()))
    };
    match [';', '\t', ','].into_iter().find(parts_all) {
        Some(mark) => Box::new(line.split(mark).map(str::trim)),
        None => Box::new(fields(line)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_parted_by_one_kind_of_separator() {
        let parted = |line: &str| fields(line).map(String::from).collect::<Vec<_>>();
        for line in ["1 2 3", "1\t2\t 3\r", "1, 2, 3", "1;2;3", "1,2,3", " 1; 2 ;3;"] {
            assert_eq!(parted(line), ["1", "2", "3"], "{line}");
        }
        assert_eq!(parted("0,5 1,0"), ["0,5", "1,0"]);
    }
}
