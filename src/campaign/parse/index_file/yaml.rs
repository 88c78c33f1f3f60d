//! Files of the refractiveindex.info database: the `DATA` of its YAML, and no more of the language than that has.
//!
//! `type: tabulated nk | n | k` with rows of wavelength (um) and values; `type: formula 1` with `wavelength_range` (um)
//! and `coefficients` C1 C2 ...: n^2 - 1 = C1 + sum C2i l^2/(l^2 - C(2i+1)^2), and `formula 2`, where C(2i+1) is not
//! squared. Source: the database's own description of its formulae.

use super::dispersion::{Curve, Dispersion, Points};
use crate::campaign::parse::faults::quoted;

/// Whether a text is such a file.
pub(crate) fn looks_like(text: &str) -> bool {
    text.lines().any(|line| line.trim_end() == "DATA:")
}

/// One entry of `DATA`: its type, its keys, and the rows of its `data`.
#[derive(Default)]
struct DataEntry<'a> {
    kind: &'a str,
    line: usize,
    range: &'a str,
    coefficients: &'a str,
    rows: Vec<(usize, &'a str)>,
}

/// n and k of the file.
// Tested by `a_formula_is_the_published_glass`, `tabulated_metals_are_read`.
pub(crate) fn parse(text: &str) -> Result<Dispersion, String> {
    let (mut eta, mut k) = (None, None);
    for entry in entries(text)? {
        let at = |why: String| format!("line {}: {why}", entry.line);
        let (n_here, k_here) = match entry.kind {
            "tabulated nk" => (table(&entry, &["n", "k"])?, table(&entry, &["k"])?),
            "tabulated n" => (table(&entry, &["n"])?, None),
            "tabulated k" => (None, table(&entry, &["k"])?),
            "formula 1" => (Some(formula(&entry, |c| c * c).map_err(at)?), None),
            "formula 2" => (Some(formula(&entry, |c| c).map_err(at)?), None),
            other => {
                return Err(at(format!(
                    "type `{}` is not read; tabulated nk, n and k and formula 1 and 2 are",
                    quoted(other)
                )));
            }
        };
        for (slot, here, name) in [(&mut eta, n_here, "n"), (&mut k, k_here, "k")] {
            if here.is_some() && slot.is_some() {
                return Err(at(format!("{name} is there twice")));
            }
            *slot = slot.take().or(here);
        }
    }
    Dispersion::new(eta.ok_or("its DATA holds no n")?, k)
}

fn entries(text: &str) -> Result<Vec<DataEntry<'_>>, String> {
    let mut entries: Vec<DataEntry> = Vec::new();
    let mut inside = false;
    for (number, line) in (1..).zip(text.lines()) {
        let bare = line.trim();
        if bare.is_empty() || bare.starts_with('#') {
            continue;
        }
        // A key at the margin ends what came before.
        if !line.starts_with([' ', '-']) {
            inside = bare == "DATA:";
            continue;
        }
        if !inside {
            continue;
        }
        let bare = match bare.strip_prefix("- ") {
            Some(rest) => {
                entries.push(DataEntry { line: number, ..DataEntry::default() });
                rest.trim()
            }
            None => bare,
        };
        let entry =
            entries.last_mut().ok_or_else(|| format!("line {number}: no entry of DATA begins with -"))?;
        match bare.split_once(':') {
            Some(("type", kind)) => entry.kind = trimmed(kind),
            Some(("wavelength_range" | "range", range)) => entry.range = trimmed(range),
            Some(("coefficients", all)) => entry.coefficients = trimmed(all),
            Some(("data", _)) => {}
            Some((key, _)) => return Err(format!("line {number}: the key `{}` is not known", quoted(key))),
            None => entry.rows.push((number, bare)),
        }
    }
    Ok(entries)
}

fn trimmed(value: &str) -> &str {
    value.trim().trim_matches(['"', '\''])
}

fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split_whitespace().map(|word| word.parse().ok().filter(|number: &f64| number.is_finite())).collect()
}

/// The first of `names` over the wavelength; n and k follow each other on a line.
fn table(entry: &DataEntry, names: &[&str]) -> Result<Option<Curve>, String> {
    let columns = if entry.kind == "tabulated nk" { 3 } else { 2 };
    let at = if names == ["k"] { columns - 1 } else { 1 };
    let mut points = Points::default();
    for &(line, row) in &entry.rows {
        let all = numbers(row).filter(|all| all.len() == columns);
        let all = all.ok_or_else(|| format!("line {line}: `{}` is no row of {}", quoted(row), entry.kind))?;
        points.push(line, 1e3 * all[0], names[0], all[at])?;
    }
    Ok(points.curve())
}

fn formula(entry: &DataEntry, pole: fn(f64) -> f64) -> Result<Curve, String> {
    let range =
        numbers(entry.range).filter(|range| range.len() == 2 && range[0] > 0.0 && range[0] < range[1]);
    let range = range
        .ok_or_else(|| format!("wavelength_range `{}` is not two wavelengths in um", quoted(entry.range)))?;
    let all = numbers(entry.coefficients).filter(|all| all.len() % 2 == 1 && all.len() <= 17);
    let all = all.ok_or_else(|| {
        format!("coefficients `{}` are not one number and pairs of numbers", quoted(entry.coefficients))
    })?;
    let terms = all[1..].chunks(2).map(|pair| (pair[0], pole(pair[1]))).collect();
    Ok(Curve::Sellmeier { first: all[0], terms, range: [1e3 * range[0], 1e3 * range[1]] })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Malitson's fused silica (J. Opt. Soc. Am. 55, 1205, 1965) by formula 1, and Schott's N-BK7 by formula 2, whose
    /// catalogue gives n_d = 1.51680 and n_F = 1.52238 at 587.5618 and 486.1327 nm; silica has n_d = 1.45846.
    #[test]
    fn a_formula_is_the_published_glass() {
        let silica = "REFERENCES: \"Malitson\"\nDATA:\n  - type: formula 1\n    wavelength_range: 0.21 6.7\n    coefficients: \
                      0 0.6961663 0.0684043 0.4079426 0.1162414 0.8974794 9.896161\n";
        let glass = "DATA:\n  - type: formula 2 \n    range: 0.3 2.5\n    coefficients: 0 1.03961212 0.00600069867 \
                     0.231792344 0.0200179144 1.01046945 103.560653\n  - type: tabulated k\n    data: |\n        0.300 \
                     2.8607E-06\n        2.500 1.4E-05\nCONDITIONS:\n  temperature: 20\n";
        let eta = |text: &str, nm: f64| parse(text).expect("read").at(nm).expect("within").eta;
        // Catalogues print five digits.
        assert!((eta(silica, 587.5618) - 1.45846).abs() < 5e-6);
        assert!((eta(glass, 587.5618) - 1.51680).abs() < 5e-6);
        assert!((eta(glass, 486.1327) - 1.52238).abs() < 5e-6);
        let glass = parse(glass).expect("read");
        assert_eq!((glass.ends(), glass.at(299.0), glass.points()), ([300.0, 2500.0], None, vec![]));
        assert!(glass.at(300.0).is_some_and(|medium| medium.k == 2.8607e-6));
    }

    #[test]
    fn tabulated_metals_are_read() {
        let text = "DATA:\n  - type: tabulated nk\n    data: |\n        0.4959 0.97 1.869\n        0.5166 0.62 2.081\n";
        let found = parse(text).expect("read").points();
        let rows: Vec<_> = found.iter().map(|m| (m.wavelength_nm, m.eta, m.k)).collect();
        // A thousand times a decimal number of four digits rounds once.
        assert!((rows[0].0.expect("nm") - 495.9).abs() < 1e-9);
        assert_eq!((rows[0].1, rows[0].2, rows[1].1, rows[1].2), (0.97, 1.869, 0.62, 2.081));
        for (text, phrase) in [
            ("DATA:\n  - type: formula 4\n", "line 2: type `formula 4` is not read"),
            ("DATA:\n  - type: tabulated nk\n    data: |\n        0.5 1.5\n", "line 4: `0.5 1.5` is no row"),
            ("DATA:\n  - type: formula 1\n    coefficients: 0 1 2\n", "wavelength_range `` is not"),
            ("DATA:\n  - type: tabulated k\n    data: |\n        0.5 1.5\n", "holds no n"),
            ("DATA:\n", "holds no n"),
        ] {
            let found = parse(text).expect_err(text);
            assert!(found.contains(phrase), "{text:?}: {found}");
        }
    }
}
