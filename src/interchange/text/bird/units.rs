//! The units that the schema names, and what they are in the table's: degrees, nanometres, 1/sr.

use crate::interchange::text::samples::whole_deg;

/// A unit of the schema.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    /// Degrees, nanometres or 1/sr: the table's own.
    Own,
    /// Radians.
    Radian,
    /// Micrometres.
    Micrometre,
}

/// The schema writes the Greek letter; the older sign for micro is the same to a reader.
const WORDS: [(&str, Unit); 8] = [
    ("deg", Unit::Own),
    ("°", Unit::Own),
    ("rad", Unit::Radian),
    ("nm", Unit::Own),
    ("\u{3bc}m", Unit::Micrometre),
    ("\u{b5}m", Unit::Micrometre),
    ("1/sr", Unit::Own),
    ("sr^-1", Unit::Own),
];

impl Unit {
    /// deg, ° or rad.
    pub fn of_angle(word: &str) -> Option<Unit> {
        Self::among(&WORDS[..3], word)
    }

    /// nm or µm.
    pub fn of_wavelength(word: &str) -> Option<Unit> {
        Self::among(&WORDS[3..6], word)
    }

    /// 1/sr or sr^-1.
    pub fn of_brdf(word: &str) -> Option<Unit> {
        Self::among(&WORDS[6..], word)
    }

    fn among(words: &[(&str, Unit)], word: &str) -> Option<Unit> {
        words.iter().find(|(known, _)| *known == word).map(|(_, unit)| *unit)
    }

    /// The words that are known to one of the three above.
    pub fn words(known: fn(&str) -> Option<Unit>) -> Vec<&'static str> {
        WORDS.iter().map(|(word, _)| *word).filter(|word| known(word).is_some()).collect()
    }

    /// A number of this unit in the table's.
    pub fn own(self, number: f64) -> f64 {
        match self {
            Unit::Own => number,
            Unit::Radian => whole_deg(number),
            Unit::Micrometre => number * 1e3,
        }
    }
}
