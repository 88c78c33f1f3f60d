//! What the columns of values of a list mean: by their names, whatever their order.

use smallvec::SmallVec;

use crate::error::wrong;
use crate::interchange::radiance::colour;
use crate::interchange::{Checked, Colour};
use crate::table::BrdfTable;
use crate::table::brdf_table::named_wavelength;

/// Numbers of one sample, one for each colour.
pub type ColourValues = SmallVec<[f32; 3]>;

/// What one column holds.
#[derive(Debug, Clone, PartialEq)]
enum Role {
    Value(Name),
    /// Standard error of a value; of the only one if it names none.
    Error(Option<Name>),
    Hits,
    /// What follows from the geometry.
    Known,
}

/// Which value.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Name {
    /// A single value.
    One,
    /// R, G, B.
    Rgb(usize),
    /// X, Y, Z.
    Xyz(usize),
    Wavelength(f64),
}

/// The names of a table's colours as columns: `Y`; `R`, `G`, `B`; or wavelengths such as `550nm`.
// Tested by `spectral_tables_come_back_from_lists` (tests/it/interchange/interchange_text.rs).
pub fn names_of(table: &BrdfTable) -> Vec<String> {
    let nm = table.colours.iter().map(|colour| colour.wavelength_nm);
    nm.zip(table.colour_names()).map(|(nm, name)| nm.map_or(name, |nm| format!("{nm}nm"))).collect()
}

/// The columns of a list, and the colours that they make.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Column of each value: one, R G B, X Y Z, or wavelengths in increasing order.
    values: Vec<usize>,
    /// Column of the standard error of each value; none where they are unknown.
    errors: Vec<usize>,
    hits: Option<usize>,
    is_xyz: bool,
    /// One for each value of a spectral list; else empty.
    pub wavelengths_nm: Vec<f64>,
}

impl Columns {
    /// The meaning of `names`, the first of which is column `first`.
    ///
    /// `R G B` in any order; `X Y Z` alike, which become R, G, B; `Y`, `value`, `brdf`; `550nm`, `w550`; `stderr`,
    /// `stderr.R`, `sigma`, ...; `hits`, `count`. A name that is none of these is refused.
    // Tested by `columns_are_told_by_their_names`.
    pub fn of(names: &[&str], first: usize) -> Checked<Self> {
        let (mut named, mut errors, mut hits) = (Vec::new(), Vec::new(), None);
        let has = |name: &str| names.iter().any(|other| other.trim().eq_ignore_ascii_case(name));
        let is_xyz = has("X") || has("Z");
        for (column, name) in (first..).zip(names) {
            let role = role_of(name, is_xyz).ok_or_else(|| {
                format!(
                    "the column `{}` is not known; R G B, X Y Z, Y, value, 550nm, stderr, stderr.R and hits are",
                    name.trim()
                )
            })?;
            match role {
                Role::Value(name) if named.iter().any(|&(other, _)| other == name) => {
                    return Err(wrong!(
                        "two columns hold the same values as `{}`",
                        names[column - first].trim()
                    ));
                }
                Role::Value(name) => named.push((name, column)),
                Role::Error(of) if errors.iter().any(|&(other, _)| other == of) => {
                    return Err(wrong!("the column `{}` is there twice", names[column - first].trim()));
                }
                Role::Error(of) => errors.push((of, column)),
                Role::Hits if hits.is_some() => return Err("two columns count arrivals".into()),
                Role::Hits => hits = Some(column),
                Role::Known => {}
            }
        }
        let values = in_order(&mut named)?;
        let error_of = |name: Name| {
            let fits = |of: &Option<Name>| of.map_or(named.len() == 1, |of| of == name);
            errors.iter().find(|(of, _)| fits(of)).map(|&(_, column)| column)
        };
        // The errors of X, Y and Z are those of no single colour.
        let known: Option<Vec<usize>> = named.iter().map(|&(name, _)| error_of(name)).collect();
        let wavelength = |&(name, _): &(Name, usize)| match name {
            Name::Wavelength(nm) => Some(nm),
            _ => None,
        };
        Ok(Columns {
            values,
            errors: known.filter(|_| !is_xyz).unwrap_or_default(),
            hits,
            is_xyz,
            wavelengths_nm: named.iter().filter_map(wavelength).collect(),
        })
    }

    /// Number of colours.
    pub fn colours(&self) -> usize {
        self.values.len()
    }

    /// Why a line's errors or counts are none, if they are not.
    pub fn fault(&self, numbers: &[f64]) -> Option<String> {
        let error = self.errors.iter().map(|&column| numbers[column]).find(|&e| e < 0.0 && e != -1.0);
        let hits = self.hits.map(|column| numbers[column]);
        let hits = hits.filter(|hits| hits.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(hits));
        error
            .map(|error| format!("{error} is no standard error (0 or more; -1: not available)"))
            .or_else(|| hits.map(|hits| format!("{hits} is no number of arrivals")))
    }

    /// The values of a line.
    pub fn values(&self, numbers: &[f64]) -> ColourValues {
        if self.is_xyz {
            let xyz: Colour = std::array::from_fn(|k| numbers[self.values[k]]);
            return colour::rgb(xyz).iter().map(|&value| value as f32).collect();
        }
        self.values.iter().map(|&column| numbers[column] as f32).collect()
    }

    /// The standard errors of a line; empty where they are unknown.
    pub fn errors(&self, numbers: &[f64]) -> ColourValues {
        self.errors.iter().map(|&column| numbers[column] as f32).collect()
    }

    /// The arrivals of a line, where they are counted.
    pub fn hits(&self, numbers: &[f64]) -> Option<u32> {
        self.hits.map(|column| numbers[column] as u32)
    }
}

/// The values' columns in the order of the colours; `named` is put into that order.
fn in_order(named: &mut [(Name, usize)]) -> Checked<Vec<usize>> {
    let rank = |name: Name| match name {
        Name::One => 0.0,
        Name::Rgb(k) | Name::Xyz(k) => k as f64,
        Name::Wavelength(nm) => nm,
    };
    named.sort_by(|a, b| rank(a.0).total_cmp(&rank(b.0)));
    let all = |fits: fn(&Name) -> bool| named.iter().all(|(name, _)| fits(name));
    let whole = match named.len() {
        0 => {
            return Err(
                "no column of values: R G B, X Y Z, Y, value or wavelengths such as 550nm needed".into()
            );
        }
        1 => all(|name| matches!(name, Name::One | Name::Wavelength(_))),
        3 => all(|name| matches!(name, Name::Rgb(_))) || all(|name| matches!(name, Name::Xyz(_))),
        _ => false,
    };
    if whole || all(|name| matches!(name, Name::Wavelength(_))) {
        Ok(named.iter().map(|&(_, column)| column).collect())
    } else {
        Err("the columns of values are neither one, nor R G B, nor X Y Z, nor wavelengths alone".into())
    }
}

fn role_of(name: &str, is_xyz: bool) -> Option<Role> {
    let name = name.trim();
    let small = name.to_ascii_lowercase();
    let (head, rest) = small.split_once(['.', '_']).unwrap_or((&small, ""));
    match head {
        "hits" | "hit" | "count" | "counts" if rest.is_empty() => return Some(Role::Hits),
        "projected" if rest == "solid_angle" => return Some(Role::Known),
        "stderr" | "std" | "stddev" | "sd" | "se" | "err" | "error" | "sigma" | "uncertainty" => {
            let of = if rest.is_empty() { None } else { Some(value_of(rest, is_xyz)?) };
            return Some(Role::Error(of));
        }
        _ => {}
    }
    value_of(&small, is_xyz).map(Role::Value)
}

fn value_of(small: &str, is_xyz: bool) -> Option<Name> {
    Some(match small {
        "y" if !is_xyz => Name::One,
        "value" | "brdf" | "bsdf" | "luminance" => Name::One,
        "r" => Name::Rgb(0),
        "g" => Name::Rgb(1),
        "b" => Name::Rgb(2),
        "x" => Name::Xyz(0),
        "y" => Name::Xyz(1),
        "z" => Name::Xyz(2),
        _ => {
            let nm = small.strip_suffix("nm").and_then(|nm| nm.trim().trim_end_matches('_').parse().ok());
            Name::Wavelength(
                nm.filter(|nm: &f64| *nm > 0.0 && nm.is_finite()).or_else(|| named_wavelength(small))?,
            )
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_told_by_their_names() {
        let numbers: Vec<f64> = (0..12).map(f64::from).collect();
        let values = |names: &[&str]| Columns::of(names, 4).expect("known").values(&numbers).to_vec();
        assert_eq!(values(&["B", "G", "R"]), [6.0, 5.0, 4.0]);
        assert_eq!(values(&["value", "stderr", "count"]), [4.0]);
        assert_eq!(values(&["650nm", "450 nm", "w550_5"]), [5.0, 6.0, 4.0]);
        let found =
            Columns::of(&["hits", "stderr.G", "stderr.B", "stderr.R", "G", "B", "R"], 4).expect("known");
        assert_eq!((found.values(&numbers).to_vec(), found.hits(&numbers)), (vec![10.0, 8.0, 9.0], Some(4)));
        assert_eq!(found.errors(&numbers).to_vec(), [7.0, 5.0, 6.0]);
        let spectral = Columns::of(&["650nm", "450nm"], 4).expect("known");
        assert_eq!(spectral.wavelengths_nm, [450.0, 650.0]);
        for (names, phrase) in [
            (&["R", "G"][..], "neither one"),
            (&["Q"], "the column `Q` is not known"),
            (&["Y", "value"], "the same values"),
            (&["X", "Y"], "neither one"),
            (&["stderr"], "no column of values"),
            (&["Y", "550nm"], "neither one"),
        ] {
            let found = Columns::of(names, 4).expect_err("refused");
            assert!(found.to_string().contains(phrase), "{names:?}: {found}");
        }
    }

    /// White D65 has X, Y, Z = 0.9505, 1, 1.089 (the rows' sums of the matrix) and is R = G = B = 1.
    #[test]
    fn xyz_becomes_rgb() {
        let numbers = [1.089, 1.0, 0.9505];
        let found = Columns::of(&["Z", "Y", "X"], 0).expect("known").values(&numbers);
        assert!(found.iter().all(|value| (value - 1.0).abs() < 1e-6), "{found:?}");
    }
}
