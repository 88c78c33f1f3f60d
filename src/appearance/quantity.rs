//! A number with what is known of its error, or why there is none.

use serde::Serialize;

/// A number with its errors, or the reason why the table does not say it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Quantity {
    /// The number; null where the table does not say it.
    pub value: Option<f64>,
    /// Standard error over the realisations (jackknife); null without them.
    pub se: Option<f64>,
    /// How much it changes with bins twice as large, an upper estimate of what the bins leave open; of a reading whose bounds are
    /// nearly one number, how far it is from the lower.
    pub bins: Option<f64>,
    /// Why there is no number, or what was done to have one.
    pub note: Option<String>,
}

impl Quantity {
    /// None, for a reason.
    pub fn missing(why: impl Into<String>) -> Self {
        Quantity { note: Some(why.into()), ..Quantity::default() }
    }

    /// The number, or none where it is not finite: a ratio to no light.
    pub(super) fn new(value: f64, se: Option<f64>, bins: Option<f64>, note: Option<String>) -> Self {
        if !value.is_finite() {
            return Self::missing("no light arrives there");
        }
        let known = |error: Option<f64>| error.filter(|error| error.is_finite());
        // What interpolation between incidences is off by is not known, and so no error is.
        let se = if note.is_some() { None } else { known(se) };
        Quantity { value: Some(value), se, bins: known(bins), note }
    }
}
