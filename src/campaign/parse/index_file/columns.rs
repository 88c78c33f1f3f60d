//! Columns of text: wavelengths with n, k or both, in one block or, as refractiveindex.info writes CSV, in a block each.

use super::SHORTEST_NM;
use super::dispersion::{Curve, Dispersion, Points};
use crate::campaign::parse::faults::quoted;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Column {
    Wavelength,
    N,
    K,
}

/// How the columns of a block are to be read.
struct ColumnHeader {
    columns: Vec<Column>,
    /// nm in a unit of the wavelengths; `None` where no heading says it.
    unit: Option<f64>,
}

/// What separates two numbers, and whether their point is a comma.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Separator {
    /// `;` or tabs: a comma inside a number is its point.
    Marked(char),
    Commas,
    Blanks,
}

/// n and k of a text.
///
/// Lines that are empty or begin with # are left out. A line of words is a heading: it names the columns and the unit
/// of the wavelengths (nm, um; `wl` is refractiveindex.info's, in um), and a second one begins another block. Without a
/// heading two columns are wavelength_nm, n and three wavelength_nm, n, k.
// Tested by `lists_of_n_and_k_are_read_or_refused_by_line`, `headings_say_what_columns_are`.
pub(crate) fn parse(text: &str) -> Result<Dispersion, String> {
    let style = style_of(text)?;
    let (mut n, mut k) = (Points::default(), Points::default());
    let mut heading: Option<ColumnHeader> = None;
    let mut whole = style == Separator::Commas;
    for (number, line) in lines(text) {
        let fields = fields_of(style, line);
        let numbers: Vec<f64> = fields.iter().filter_map(|field| number_of(style, field)).collect();
        if numbers.is_empty() {
            heading = Some(heading_of(&fields).map_err(|why| format!("line {number}: {why}"))?);
            continue;
        }
        let ColumnHeader { columns, unit } = heading.get_or_insert_with(|| unnamed(fields.len()));
        if numbers.len() != fields.len() || numbers.len() != columns.len() {
            return Err(format!("line {number}: `{}` is not {}", quoted(line), named(columns)));
        }
        let wavelength = columns.iter().position(|&column| column == Column::Wavelength);
        let nm = numbers[wavelength.unwrap_or(0)] * unit.unwrap_or(1.0);
        if unit.is_none() && nm < SHORTEST_NM {
            return Err(micrometres(number, nm));
        }
        for (&column, &value) in columns.iter().zip(&numbers) {
            match column {
                Column::Wavelength => {}
                Column::N => n.push(number, nm, "n", value)?,
                Column::K => k.push(number, nm, "k", value)?,
            }
        }
        whole &= columns.len() > 2 && !line.contains(['.', 'e', 'E']);
    }
    let eta = n.curve().ok_or("holds no line wavelength_nm,n,k")?;
    if whole {
        return Err(
            "no number has a point: if commas are decimal, put ; between the columns; else write 1.0".into(),
        );
    }
    Dispersion::new(eta, k.curve())
}

/// Wavelength in nm and n or k (`name`) on each line: a renderer's spectrum.
pub(crate) fn spectrum(text: &str, name: &str) -> Result<Curve, String> {
    let style = style_of(text)?;
    let mut points = Points::default();
    for (number, line) in lines(text) {
        let fields = fields_of(style, line);
        let numbers: Vec<f64> = fields.iter().filter_map(|field| number_of(style, field)).collect();
        let (&[nm, value], 2) = (&numbers[..], fields.len()) else {
            return Err(format!("line {number}: `{}` is not a wavelength in nm and a value", quoted(line)));
        };
        if nm < SHORTEST_NM {
            return Err(micrometres(number, nm));
        }
        points.push(number, nm, name, value)?;
    }
    points.curve().ok_or("holds no line of a wavelength in nm and a value".into())
}

fn micrometres(line: usize, wavelength: f64) -> String {
    format!(
        "line {line}: a wavelength of {wavelength}: these look like micrometres; head the columns wavelength_um,n,k, or \
         wavelength_nm,n,k if they are nm"
    )
}

/// Lines with something on them, from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = (1..).zip(text.lines().map(str::trim));
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

/// Marks that no number holds come first; commas between blanks are neither points nor marks for certain.
fn style_of(text: &str) -> Result<Separator, String> {
    let data = || lines(text).filter(|(_, line)| line.starts_with(|c: char| c.is_ascii_digit() || c == '.'));
    for mark in [';', '\t'] {
        if data().any(|(_, line)| line.contains(mark)) {
            return Ok(Separator::Marked(mark));
        }
    }
    let Some((number, line)) = data().find(|(_, line)| line.contains(',')) else {
        return Ok(Separator::Blanks);
    };
    // `400 1,5` has a comma inside what blanks set apart; `400, 1.5` has one behind each number.
    let inside = |word: &str| word.trim_end_matches(',').contains(',');
    if line.contains(' ') && line.split(' ').any(inside) {
        return Err(format!(
            "line {number}: `{}`: is the comma a decimal point? Write points, or put ; between the columns",
            quoted(line)
        ));
    }
    Ok(Separator::Commas)
}

fn fields_of(style: Separator, line: &str) -> Vec<&str> {
    let fields: Vec<&str> = match style {
        Separator::Marked(mark) => line.split(mark).map(str::trim).collect(),
        Separator::Commas => line.split(',').map(str::trim).collect(),
        Separator::Blanks => line.split_whitespace().collect(),
    };
    // One mark too many at the end of a line is common.
    let last = fields.iter().rposition(|field| !field.is_empty()).map_or(0, |at| at + 1);
    fields[..last].to_vec()
}

fn number_of(style: Separator, field: &str) -> Option<f64> {
    let marked =
        matches!(style, Separator::Marked(_)) && field.matches(',').count() == 1 && !field.contains('.');
    if marked { field.replace(',', ".").parse().ok() } else { field.parse().ok() }
}

/// Columns without a heading.
fn unnamed(count: usize) -> ColumnHeader {
    let columns = [Column::Wavelength, Column::N, Column::K];
    ColumnHeader { columns: columns[..if count == 2 { 2 } else { 3 }].to_vec(), unit: None }
}

fn named(columns: &[Column]) -> String {
    let name = |column: &Column| match column {
        Column::Wavelength => "wavelength_nm",
        Column::N => "n",
        Column::K => "k",
    };
    columns.iter().map(name).collect::<Vec<_>>().join(",")
}

/// The columns that a line of words names.
fn heading_of(fields: &[&str]) -> Result<ColumnHeader, String> {
    let mut heading = ColumnHeader { columns: Vec::new(), unit: None };
    for field in fields.iter().filter(|field| !is_unit(field)) {
        let name = bare(field);
        let word = name.split(['_', ' ', '(', '[', ',', '/']).next().unwrap_or_default();
        let column = match word {
            "wavelength" | "wl" | "lambda" | "\u{3bb}" => Column::Wavelength,
            "n" | "eta" => Column::N,
            "k" | "kappa" => Column::K,
            _ => {
                return Err(format!(
                    "the column `{}` is not known; wavelength_nm or wavelength_um (wl: um), n and k are",
                    quoted(field)
                ));
            }
        };
        if heading.columns.contains(&column) {
            return Err(format!("the column `{}` is there twice", quoted(field)));
        }
        if column == Column::Wavelength {
            let cut_off =
                fields.iter().filter(|field| is_unit(field)).find_map(|field| unit_of(&bare(field)));
            heading.unit = unit_of(&name).or(cut_off);
        }
        heading.columns.push(column);
    }
    let known = |column| heading.columns.contains(&column);
    if known(Column::Wavelength) && (known(Column::N) || known(Column::K)) {
        Ok(heading)
    } else {
        Err(format!("`{}` names no wavelength, or neither n nor k", quoted(&fields.join(","))))
    }
}

/// The unit in `Wavelength, um`, which is one heading that a comma has cut in two.
fn unit_of(name: &str) -> Option<f64> {
    let micro = ["um", "\u{b5}m", "\u{3bc}m", "micro"].iter().any(|unit| name.contains(unit));
    if name == "wl" || micro { Some(1e3) } else { name.contains("nm").then_some(1.0) }
}

fn is_unit(field: &str) -> bool {
    matches!(bare(field).as_str(), "um" | "nm" | "\u{b5}m" | "\u{3bc}m")
}

/// A heading without quotes, in small letters.
fn bare(field: &str) -> String {
    field.trim_matches(['"', '\'', ' ']).to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::schema::Medium;

    fn medium(nm: f64, eta: f64, k: f64) -> Medium {
        Medium { wavelength_nm: Some(nm), eta, k }
    }

    fn points(text: &str) -> Vec<Medium> {
        parse(text).unwrap_or_else(|why| panic!("{text:?}: {why}")).points()
    }

    #[test]
    fn lists_of_n_and_k_are_read_or_refused_by_line() {
        let two = vec![medium(450.0, 1.5, 2.5), medium(550.5, 0.25, 0.0)];
        for text in [
            "# gold\nwavelength_nm,n,k\n450,1.5,2.5\n\n550.5, 0.25, 0\n",
            "450 1.5 2.5\r\n550.5\t0.25\t0\r\n".replace('\t', " ").as_str(),
            "450\t1.5\t2.5\n550.5\t0.25\t0\n",
            "450;1,5;2,5\n550,5;0,25;0\n",
            "450, 1.5, 2.5,\n550.5, 0.25, 0,\n",
        ] {
            assert_eq!(points(text), two, "{text:?}");
        }
        let found = parse("450,1.5,2.5\n550.5,0.25,0\n").expect("read");
        // Half way: exact in binary.
        assert_eq!(found.at(500.25), Some(medium(500.25, 0.875, 1.25)));
        assert_eq!((found.at(449.0), found.at(551.0)), (None, None));
        let long = format!("450 1,5 {}\n", "2".repeat(5000));
        for (text, phrase) in [
            ("", "holds no line"),
            ("450,1.5,2,3\n", "line 1"),
            ("450,1.5,2\n460,1.5,x\n", "line 2"),
            ("450,1.5,-1\n", "line 1: k = -1 must lie in [0, 100]"),
            ("450,0,1.5\n", "line 1: n = 0 must lie in (0, 100]"),
            ("450,nan,1\n", "line 1: n = NaN must be finite"),
            ("450,1.1,1\n450,1.1,1\n", "line 2: 450 nm after 450 nm"),
            ("450 1,5 2\n", "is the comma a decimal point?"),
            (&long, "line 1: `450 1,5 222"),
            (&long, "222...`: is the comma"),
            ("400,1,5\n500,1,52\n", "no number has a point"),
            ("0.45,1.5,0\n0.65,1.5,0\n", "these look like micrometres"),
            ("wavelength_nm,R\n450,0.3\n", "the column `R` is not known"),
            ("wavelength_nm,k\n450,0.3\n", "holds no line"),
        ] {
            let found = parse(text).err().unwrap_or_else(|| panic!("{text:?} was read"));
            assert!(found.contains(phrase), "{text:?}: {found}");
        }
    }

    /// The sample of the issue: a spreadsheet's decimal commas, n alone.
    #[test]
    fn decimal_commas_between_semicolons_are_points() {
        let found = parse("400;1,5\n500;1,52\n700;1,49\n").expect("read");
        // Half way from 500 to 700 nm: n = 1.505, (n - 1)^2/(n + 1)^2 = 0.04064.
        let Medium { eta, k, .. } = found.at(600.0).expect("known");
        assert!((eta - 1.505).abs() < 1e-15 && k == 0.0);
    }

    #[test]
    fn headings_say_what_columns_are() {
        let one = vec![medium(500.0, 1.5, 0.25)];
        for text in [
            "wavelength_um,n,k\n0.5,1.5,0.25\n",
            "\"Wavelength, \u{b5}m\",n,k\n0.5,1.5,0.25\n",
            "k;n;wavelength (nm)\n0,25;1,5;500\n",
            // refractiveindex.info: n and k in blocks of their own, in um.
            "wl,n\n0.5,1.5\n\nwl,k\n0.5,0.25\n",
        ] {
            assert_eq!(points(text), one, "{text:?}");
        }
    }
}
