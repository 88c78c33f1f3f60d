//! Units of length as height maps name them.

/// How many units of height one lateral unit is; the error says which of the two is not known.
///
/// Two empty names stand for one unit that is not named.
pub fn ratio(lateral: &str, height: &str) -> Result<f64, String> {
    let known = |unit: &str| metres(unit).ok_or_else(|| format!("{unit:.40} is no length"));
    match (lateral, height) {
        ("", "") => Ok(1.0),
        ("", _) | (_, "") => Err("one unit is given and the other is not".into()),
        _ => Ok(known(lateral)? / known(height)?),
    }
}

/// Metres in a unit of length, `None` for any other.
pub fn metres(unit: &str) -> Option<f64> {
    const SIZES: [(&str, f64); 13] = [
        ("km", 1e3),
        ("m", 1.0),
        ("cm", 1e-2),
        ("mm", 1e-3),
        ("um", 1e-6),
        ("\u{b5}m", 1e-6),
        ("\u{3bc}m", 1e-6),
        ("micron", 1e-6),
        ("nm", 1e-9),
        ("\u{c5}", 1e-10),
        ("\u{212b}", 1e-10),
        ("A", 1e-10),
        ("pm", 1e-12),
    ];
    SIZES.iter().find(|(name, _)| *name == unit).map(|(_, size)| *size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_turned_into_each_other_and_other_units_are_named() {
        // A quotient of two decimal numbers: three roundings.
        for (lateral, height, expected) in
            [("m", "nm", 1e9), ("\u{b5}m", "m", 1e-6), ("um", "um", 1.0), ("", "", 1.0)]
        {
            let found = ratio(lateral, height).expect("lengths");
            assert!((found - expected).abs() <= 4.0 * f64::EPSILON * expected, "{lateral} {height}: {found}");
        }
        assert_eq!(ratio("m", "V"), Err("V is no length".into()));
        assert_eq!(ratio("px", "px"), Err("px is no length".into()));
        assert!(ratio("m", "").is_err() && ratio("", "m").is_err());
        assert_eq!(metres("A").zip(metres("\u{c5}")), Some((1e-10, 1e-10)));
    }
}
