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
