//! CIE's tables: colour-matching functions and illuminants, 380 to 780 nm in steps of 5.
//!
//! `cie_5nm.csv` holds the figures of CIE 015:2018 (1931 2-degree and 1964 10-degree observer; A, C, D65, F11), written by
//! `tests/data/cie_tables.py`. What lies outside of 380 to 780 nm is left out, as CIE 15 allows.

use std::sync::LazyLock;

use serde::Serialize;

const TABLE: &str = include_str!("cie_5nm.csv");

/// Of whose eyes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Observer {
    /// CIE 1931, fields of 2 degrees.
    #[serde(rename = "2")]
    Two,
    /// CIE 1964, fields of 10 degrees.
    #[serde(rename = "10")]
    Ten,
}

/// Under which light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Illuminant {
    /// Daylight of 6504 K.
    D65,
    /// A tungsten lamp, 2856 K.
    A,
    /// A narrow-band fluorescent lamp of 4000 K (FL11).
    F11,
    /// Older daylight, which glossmeters are adjusted to.
    C,
}

impl Observer {
    /// Both.
    pub const ALL: [Observer; 2] = [Observer::Two, Observer::Ten];
}

impl Illuminant {
    /// Those that colours are given under.
    pub const ALL: [Illuminant; 3] = [Illuminant::D65, Illuminant::A, Illuminant::F11];

    /// As CIE writes it.
    pub fn name(self) -> &'static str {
        match self {
            Illuminant::D65 => "D65",
            Illuminant::A => "A",
            Illuminant::F11 => "F11",
            Illuminant::C => "C",
        }
    }
}

/// One wavelength: its nm, and the file's columns.
struct Row {
    nm: f64,
    columns: Vec<f64>,
}

static ROWS: LazyLock<Vec<Row>> = LazyLock::new(|| {
    let row = |line: &str| {
        let mut numbers = line.split(',').filter_map(|word| word.parse().ok());
        numbers.next().map(|nm| Row { nm, columns: numbers.collect() })
    };
    TABLE.lines().skip(1).filter_map(row).collect()
});

/// S(nm) x(nm), S y, S z at every wavelength of the tables: what a reflectance there weighs in X, Y, Z.
// Tested by `white_points_are_those_of_cie`.
pub fn weights(observer: Observer, illuminant: Illuminant) -> Vec<(f64, [f64; 3])> {
    let first = if observer == Observer::Two { 0 } else { 3 };
    let light = match illuminant {
        Illuminant::A => 6,
        Illuminant::C => 7,
        Illuminant::D65 => 8,
        Illuminant::F11 => 9,
    };
    let of = |row: &Row| (row.nm, [0, 1, 2].map(|c| row.columns[first + c] * row.columns[light]));
    ROWS.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_points_are_those_of_cie() {
        // CIE 015:2018, Table T.3 and appendices: x, y of the illuminants, four digits.
        let cases = [
            (Observer::Two, Illuminant::D65, [0.3127, 0.3290]),
            (Observer::Ten, Illuminant::D65, [0.3138, 0.3310]),
            (Observer::Two, Illuminant::A, [0.4476, 0.4074]),
            (Observer::Two, Illuminant::C, [0.3101, 0.3162]),
            (Observer::Two, Illuminant::F11, [0.3805, 0.3769]),
        ];
        for (observer, illuminant, wanted) in cases {
            let mut sums = [0.0; 3];
            for (_, weight) in weights(observer, illuminant) {
                (0..3).for_each(|c| sums[c] += weight[c]);
            }
            let all: f64 = sums.iter().sum();
            // Half a digit of what is printed, and as much for the wavelengths between the steps.
            (0..2).for_each(|c| assert!((sums[c] / all - wanted[c]).abs() < 1e-4, "{illuminant:?} {sums:?}"));
        }
    }
}
