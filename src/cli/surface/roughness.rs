//! The areal parameters of a measured map in words, before and after its preparation.

use serde::Serialize;

use crate::cli::text::layout::columns;
use crate::surface::areal::{Parameters, Roughness};
use crate::surface::io::import::MapSteps;

/// Both, and what one unit of height is.
#[derive(Serialize)]
pub struct RoughnessEntry {
    /// One unit of height, um; `null` where neither campaign nor file says. The lengths below are in units of height.
    pub unit_um: Option<f64>,
    /// As the file has it.
    pub before: Roughness,
    /// As it is measured, before any refinement.
    pub after: Roughness,
}

impl RoughnessEntry {
    /// Of the heights of both.
    pub fn of(steps: &MapSteps) -> crate::error::Checked<Self> {
        let of = |heights: &[f64]| Roughness::of(heights, &steps.grid);
        Ok(RoughnessEntry { unit_um: steps.unit_um, before: of(&steps.before)?, after: of(&steps.after)? })
    }

    /// A table of both.
    pub fn lines(&self) -> Vec<String> {
        let (scale, unit) = self.unit_um.map_or((1.0, "unit of the heights"), |unit| (unit, "um"));
        let row = |name: &str, of: &dyn Fn(&Parameters) -> Option<f64>| {
            let text = |of_which: &Roughness| {
                of(&of_which.parameters).map_or("n/a".to_string(), |value| format!("{}", Significant(value)))
            };
            vec![name.to_string(), text(&self.before), text(&self.after)]
        };
        let length = |name: &str| format!("{name}, {unit}");
        let rows = [
            row(&length("Sa"), &|p| Some(scale * p.sa)),
            row(&length("Sq"), &|p| Some(scale * p.sq)),
            row("Ssk", &|p| p.ssk),
            row("Sku", &|p| p.sku),
            row("Sdq", &|p| Some(p.sdq)),
            row("Sdr, %", &|p| Some(100.0 * p.sdr)),
            row(&length("Sal (0.2)"), &|p| p.sal.map(|sal| scale * sal)),
            row("Str (0.2)", &|p| p.str),
        ];
        let mut lines = columns(&["roughness", "as read", "measured"], &rows);
        lines.push("of the file's own samples (ISO 25178-2); as read: mean off, gaps filled".into());
        lines
    }
}

/// A number in five digits.
struct Significant(f64);

impl std::fmt::Display for Significant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-4..1e5).contains(&size) {
            let decimals = if size == 0.0 { 0.0 } else { (4.0 - size.log10().floor()).clamp(0.0, 8.0) };
            write!(f, "{:.*}", decimals as usize, self.0)
        } else {
            write!(f, "{:.4e}", self.0)
        }
    }
}
