//! Roughnesses: the keys that every surface with a law has.

use super::lists::ranges::{range, rounded};
use super::reader::{Bounds, GivenValue, Slot, TableReader, plain};
use crate::campaign::schema::Alpha;

/// Slope scales: below, single precision no longer resolves the lobe; above, nothing was tested.
const ALPHA: Bounds = Bounds::closed(1e-4, 10.0).advice("a smooth mirror has no lobe to measure", "");

/// `alpha` (a number or a list), or `alpha_x` and `alpha_y`, of a table that has no other keys.
pub(super) fn alphas(table: TableReader<'_>) -> Option<Vec<Alpha>> {
    alphas_of(table.keys(["alpha", "alpha_x", "alpha_y"]))
}

/// `alpha` (a number or a list), or `alpha_x` and `alpha_y`.
pub(super) fn alphas_of([alpha, alpha_x, alpha_y]: [Slot<'_>; 3]) -> Option<Vec<Alpha>> {
    let equal = alpha.or(None, |i| isotropic_alphas(i).map(Some));
    let x = alpha_x.or(None, |i| i.float(&ALPHA).map(Some));
    let y = alpha_y.or(None, |i| i.float(&ALPHA).map(Some));
    match [&alpha, &alpha_x, &alpha_y].map(|slot| slot.given().is_some()) {
        [true, false, false] => equal?,
        [false, true, true] => Some(vec![Alpha::new(x??, y??)]),
        [false, true, false] => alpha_y.refuse("required next to alpha_x; or give alpha alone"),
        [false, false, true] => alpha_x.refuse("required next to alpha_y; or give alpha alone"),
        [false, false, false] => alpha.refuse("required: alpha, or alpha_x and alpha_y"),
        [true, ..] => alpha.refuse("ambiguous: give alpha, or alpha_x and alpha_y, never both"),
    }
}

fn isotropic_alphas(item: &GivenValue<'_>) -> Option<Vec<Alpha>> {
    Some(one_or_more(item, &ALPHA, "roughness")?.into_iter().map(Alpha::isotropic).collect())
}

/// Most entries of a list that makes a table each.
const MOST: usize = 1000;

/// A number, a list of them that increase, or a range: one table is made for each.
pub(super) fn one_or_more(item: &GivenValue<'_>, bounds: &Bounds, what: &str) -> Option<Vec<f64>> {
    if item.is_table() {
        let points = range(item, bounds, MOST)?.into_iter().map(rounded).collect::<Vec<_>>();
        if !points.is_sorted_by(|a, b| a < b) {
            return item.refuse(format!("gives a {what} twice; widen the step"));
        }
        return Some(points);
    }
    let Some(length) = item.list_length() else { return Some(vec![item.float(bounds)?]) };
    if length == 0 {
        return item.refuse(format!("must not be empty; one table is made for each {what}"));
    }
    if length > MOST {
        return item.refuse(format!("has {length} entries; at most {MOST} are allowed"));
    }
    let values = item.each(|i| i.float(bounds))?;
    if let Some(before) = values.windows(2).position(|pair| !matches!(pair, [a, b] if a < b)) {
        let (earlier, next) = (plain(values[before]), &item.list()?[before + 1]);
        return next.refuse(format!("comes after {earlier}; values of {what} must increase, each once"));
    }
    Some(values)
}
