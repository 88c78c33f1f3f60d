//! Ranges of floats: what lies in them, and what to say to what does not.

use std::fmt;

/// The floats that are allowed for a key, and what to say to those that are not.
pub(crate) struct Bounds {
    low: f64,
    high: f64,
    low_open: bool,
    high_open: bool,
    below: &'static str,
    above: &'static str,
}

impl Bounds {
    /// The closed interval from `low` to `high`.
    pub const fn closed(low: f64, high: f64) -> Self {
        Bounds { low, high, low_open: false, high_open: false, below: "", above: "" }
    }

    /// The same without `low` itself.
    pub const fn low_open(self) -> Self {
        Bounds { low_open: true, ..self }
    }

    /// The same without `high` itself.
    pub const fn high_open(self) -> Self {
        Bounds { high_open: true, ..self }
    }

    /// Advice for a value that is too low, and for one that is too high.
    pub const fn advice(self, below: &'static str, above: &'static str) -> Self {
        Bounds { below, above, ..self }
    }

    /// What is wrong with `value`, if anything. NaN and the infinities always are.
    pub fn fault(&self, value: f64) -> Option<String> {
        if !value.is_finite() {
            return Some(format!("must be finite and lie in {self}"));
        }
        let high_enough = if self.low_open { value > self.low } else { value >= self.low };
        let low_enough = if self.high_open { value < self.high } else { value <= self.high };
        let advice = match (high_enough, low_enough) {
            (true, true) => return None,
            (false, _) => self.below,
            _ => self.above,
        };
        let separator = if advice.is_empty() { "" } else { "; " };
        Some(format!("must lie in {self}{separator}{advice}"))
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let left = if self.low_open { '(' } else { '[' };
        let right = if self.high_open { ')' } else { ']' };
        write!(f, "{left}{}, {}{right}", plain(self.low), plain(self.high))
    }
}

/// A number as a person writes it.
pub(crate) fn plain(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-3..1e6).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}
