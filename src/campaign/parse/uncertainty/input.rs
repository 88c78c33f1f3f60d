//! One input of `[uncertainty]`: its distribution and how wide it is.

use crate::campaign::parse::reader::{Bounds, GivenValue, Slot};
use crate::campaign::schema::{Distribution, InputQuantity, Quantity};

/// Words for [`Distribution`].
pub(crate) const DISTRIBUTIONS: [(&str, Distribution); 5] = [
    ("normal", Distribution::Normal),
    ("rectangular", Distribution::Rectangular),
    ("triangular", Distribution::Triangular),
    ("arcsine", Distribution::Arcsine),
    ("t", Distribution::T),
];

const DEGREES: Bounds = Bounds::closed(0.0, 5.0)
    .low_open()
    .advice("leave out what has no error", "degrees; a budget is of small errors");
const RELATIVE: Bounds = Bounds::closed(0.0, 0.3)
    .low_open()
    .advice("leave out what has no error", "a part of the quantity; a budget is of small errors");
const ABSOLUTE: Bounds = Bounds::closed(0.0, 10.0).low_open().advice("leave out what has no error", "");
const DOF: Bounds = Bounds::closed(1.0, 1e9);
/// Below 3 the variance of Student's t is not finite (JCGM 101, 6.4.9.4).
const DOF_OF_T: Bounds =
    Bounds::closed(3.0, 1e9).advice("the variance of t is not finite below; use \"normal\"", "");
const COVERAGE_FACTOR: Bounds = Bounds::closed(1.0, 10.0);

/// Reads an input.
pub(super) fn input(item: &GivenValue<'_>, quantity: Quantity) -> Option<InputQuantity> {
    let [distribution, u, expanded, k, half_width, dof, relative] =
        item.table()?.keys(["distribution", "u", "U", "k", "half_width", "dof", "relative"]);
    let by_limits = half_width.given().is_some();
    let default = if by_limits { Distribution::Rectangular } else { Distribution::Normal };
    let distribution = distribution.or(default, |i| i.choice(&DISTRIBUTIONS));
    let is_relative = relative.or(false, |i| i.boolean())?;
    if is_relative && !has_relative(quantity) {
        return relative
            .refuse("belongs to n, k, f0 and albedo; the unit of the others is in their description");
    }
    let bounds = bounds_of(quantity, is_relative);
    let widths = Widths { u: &u, expanded: &expanded, k: &k, half_width: &half_width };
    let distribution = distribution?;
    let scale = widths.scale(item, distribution, bounds);
    let dof = match distribution {
        Distribution::T => dof
            .required("the degrees of freedom of t, such as 9 for 10 observations")
            .and_then(|i| i.float(&DOF_OF_T).map(Some)),
        _ => dof.or(None, |i| i.float(&DOF).map(Some)),
    };
    Some(InputQuantity { quantity, distribution, scale: scale?, dof: dof?, relative: is_relative })
}

fn has_relative(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::N | Quantity::K | Quantity::F0 | Quantity::Albedo)
}

fn bounds_of(quantity: Quantity, relative: bool) -> &'static Bounds {
    match quantity {
        Quantity::LampThetaDeg
        | Quantity::LampPhiDeg
        | Quantity::SensorThetaDeg
        | Quantity::SensorPhiDeg
        | Quantity::TiltXDeg
        | Quantity::TiltYDeg => &DEGREES,
        _ if has_relative(quantity) && !relative => &ABSOLUTE,
        _ => &RELATIVE,
    }
}

/// The keys that say how wide a distribution is.
struct Widths<'s, 'a> {
    u: &'s Slot<'a>,
    expanded: &'s Slot<'a>,
    k: &'s Slot<'a>,
    half_width: &'s Slot<'a>,
}

impl Widths<'_, '_> {
    fn scale(&self, item: &GivenValue<'_>, distribution: Distribution, bounds: &Bounds) -> Option<f64> {
        if matches!(distribution, Distribution::Normal | Distribution::T) {
            self.half_width
                .absent("belongs to \"rectangular\", \"triangular\" and \"arcsine\"; give u, or U and k")?;
            return match (self.u.given(), self.expanded.given()) {
                (Some(u), None) => {
                    self.k.absent("belongs to U; u is a standard uncertainty")?;
                    u.float(bounds)
                }
                (None, Some(expanded)) => {
                    let k = self.k.required("the coverage factor that U was given with, such as 2");
                    let (expanded, k) = (expanded.float(bounds), k.and_then(|k| k.float(&COVERAGE_FACTOR)));
                    Some(expanded? / k?)
                }
                (Some(_), Some(expanded)) => expanded.refuse("u is there as well: give one of them"),
                (None, None) => item.refuse("give u, the standard uncertainty, or U and k, or half_width"),
            };
        }
        for (slot, name) in [(self.u, "u"), (self.expanded, "U"), (self.k, "k")] {
            slot.absent(&format!("{name} belongs to \"normal\" and \"t\"; give half_width"))?;
        }
        self.half_width.required("half of the distance between the limits").and_then(|i| i.float(bounds))
    }
}
