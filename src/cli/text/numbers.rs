//! Numbers with their units, in as many digits as they are worth.

use indicatif::HumanCount;

/// A whole number with commas: `65,536`.
pub fn grouped(number: impl Into<u64>) -> String {
    HumanCount(number.into()).to_string()
}

/// Bytes in the unit that suits them.
pub fn bytes(count: u64) -> String {
    let count = count as f64;
    let units = [("GiB", 30), ("MiB", 20), ("KiB", 10)];
    let fitting =
        units.iter().map(|&(unit, bits)| (unit, count / f64::from(1 << bits))).find(|(_, n)| *n >= 1.0);
    fitting.map_or(format!("{count} bytes"), |(unit, n)| {
        if n < 10.0 { format!("{n:.1} {unit}") } else { format!("{n:.0} {unit}") }
    })
}

/// Seconds in the unit that suits them.
pub fn duration(seconds: f64) -> String {
    const UNITS: [(&str, f64); 4] =
        [("years", 31_557_600.0), ("days", 86_400.0), ("h", 3600.0), ("min", 60.0)];
    match UNITS.iter().find(|(_, unit)| seconds >= 2.0 * unit) {
        Some((unit, size)) => format!("{:.1} {unit}", seconds / size),
        None if seconds < 10.0 => format!("{seconds:.1} s"),
        None => format!("{seconds:.0} s"),
    }
}

/// A mean with its standard error, the error to two digits.
pub fn with_error(mean: f64, se: Option<f64>) -> String {
    match se {
        None => format!("{mean:.5} +- n/a"),
        Some(se) if se > 0.0 => {
            let decimals = two_digits(se, 9.0);
            format!("{mean:.decimals$} +- {se:.decimals$}")
        }
        Some(_) => format!("{mean:.5} +- 0"),
    }
}

/// Digits after the point that show two significant ones of `size` > 0, at most `most`.
pub fn two_digits(size: f64, most: f64) -> usize {
    (1.0 - size.log10().floor()).clamp(0.0, most) as usize
}

/// A number, or `n/a`.
pub fn or_na(value: Option<f64>, decimals: usize) -> String {
    value.map_or("n/a".into(), |value| format!("{value:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_printed_with_their_units() {
        assert_eq!(grouped(7u32), "7");
        assert_eq!(grouped(1_234_567u64), "1,234,567");
        assert_eq!(
            (bytes(12), bytes(2048), bytes(50 << 20)),
            ("12 bytes".into(), "2.0 KiB".into(), "50 MiB".into())
        );
        assert_eq!(
            (duration(1.26), duration(90.0), duration(7200.0)),
            ("1.3 s".into(), "90 s".into(), "2.0 h".into())
        );
    }

    #[test]
    fn the_error_decides_the_digits() {
        assert_eq!(with_error(0.934_121_7, Some(0.000_213)), "0.93412 +- 0.00021");
        assert_eq!(with_error(0.5, Some(12.0)), "0 +- 12");
        assert_eq!(with_error(1.0, Some(0.0)), "1.00000 +- 0");
        assert_eq!(with_error(1.0, None), "1.00000 +- n/a");
    }
}
