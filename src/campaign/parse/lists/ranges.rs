//! Lists of numbers: one number, a list, or the points of `{ from, to, step }` or `{ from, to, count }`.

use std::ops::RangeInclusive;

use crate::campaign::parse::reader::{Bounds, GivenValue, Slot, plain};

/// Where a range may be said to end; its last point has bounds of its own.
const END: Bounds = Bounds::closed(-1e6, 1e6);

/// Widest step.
const STEP: Bounds = Bounds::closed(0.0, 1e6).low_open();

/// How near, as a share of the range, whole steps must come to `to`.
const END_TOLERANCE: f64 = 1e-9;

const WHAT: &str = "a range is { from = 0, to = 75, step = 15 } or { from = 0, to = 75, count = 6 }";

/// The points of a range, both ends exact, each of the others from its own whole number k as `from + k step`, so that no
/// rounding adds up. Refused where whole steps miss `to`.
// Tested by `ranges_count_their_points_by_whole_steps`, `ranges_end_where_they_say` (tests/it/campaign/config_faults.rs).
pub(crate) fn range(item: &GivenValue<'_>, bounds: &Bounds, most: usize) -> Option<Vec<f64>> {
    let [from, to, step, count] = item.table()?.keys(["from", "to", "step", "count"]);
    let first = from.required(WHAT).and_then(|i| i.float(bounds));
    let end = to.required(WHAT).and_then(|i| i.float(&END));
    if let (Some(_), Some(count)) = (step.given(), count.given()) {
        return count.refuse("ambiguous: give step or count, never both");
    }
    let number = count.or(None, |i| i.count(1..=u32::MAX).map(Some));
    let width = match count.given() {
        Some(_) => None,
        None => Some(step.required(WHAT).and_then(|i| i.float(&STEP))?),
    };
    let (first, end, number) = (first?, end?, number?);
    if end < first {
        return to.refuse(format!("must not lie below from = {}", plain(first)));
    }
    let span = end - first;
    let steps = match (number, width) {
        (Some(1), _) if span > 0.0 => {
            return count.refuse("must be at least 2: both ends are points of the range");
        }
        (Some(number), _) => f64::from(number) - 1.0,
        (None, width) => (span / width?).round(),
    };
    if steps >= most as f64 {
        return item.refuse(format!("gives more than {most} points; widen the step"));
    }
    let width = width.unwrap_or(if steps > 0.0 { span / steps } else { 0.0 });
    if (steps * width - span).abs() > END_TOLERANCE * span {
        let below = (span / width).floor();
        let [low, high] = [below, below + 1.0].map(|steps| plain(rounded(first + steps * width)));
        return to.refuse(format!(
            "is no whole number of steps of {} from {}: end at {low} or {high}, or give count instead of step",
            plain(width),
            plain(first)
        ));
    }
    if let Some(fault) = bounds.fault(end) {
        return to.refuse(fault);
    }
    let mut points: Vec<f64> = (0..=steps as u32).map(|k| first + f64::from(k) * width).collect();
    *points.last_mut()? = end;
    Some(points)
}

/// The numbers of a list that may be a single number or a range; at most `most`.
pub(crate) fn numbers(item: &GivenValue<'_>, bounds: &Bounds, most: usize) -> Option<Vec<f64>> {
    if item.is_table() {
        return range(item, bounds, most);
    }
    let read: Vec<Option<f64>> = item.one_or_list()?.iter().map(|element| element.float(bounds)).collect();
    read.into_iter().collect()
}

/// The same of whole numbers, whose steps are whole.
pub(crate) fn whole_numbers(
    item: &GivenValue<'_>,
    range: RangeInclusive<u64>,
    most: usize,
) -> Option<Vec<u64>> {
    if !item.is_table() {
        let read: Vec<Option<u64>> =
            item.one_or_list()?.iter().map(|element| element.whole(range.clone())).collect();
        return read.into_iter().collect();
    }
    let [from, to, step] = item.table()?.keys(["from", "to", "step"]);
    let what = "a range is { from = 1, to = 9, step = 2 }";
    let end = |slot: &Slot<'_>| slot.required(what).and_then(|i| i.whole(range.clone()));
    let (first, last, width) = (end(&from), end(&to), step.or(1, |i| i.whole(1..=u64::MAX)));
    let (first, last, width) = (first?, last?, width?);
    if last < first {
        return to.refuse(format!("must not lie below from = {first}"));
    }
    let (steps, left) = ((last - first) / width, (last - first) % width);
    if left > 0 {
        let low = last - left;
        return to.refuse(format!(
            "is no whole number of steps of {width} from {first}: end at {low} or {}",
            low.saturating_add(width)
        ));
    }
    if steps >= most as u64 {
        return item.refuse(format!("gives more than {most} numbers; widen the step"));
    }
    Some((0..=steps).map(|k| first + k * width).collect())
}

/// Records a fault of one number of a list; a range has no element to point at.
pub(crate) fn refuse_at<T>(item: &GivenValue<'_>, index: usize, fault: impl Into<String>) -> Option<T> {
    match item.list_length().and_then(|_| item.list()) {
        Some(elements) => elements.get(index)?.refuse(fault),
        None => item.refuse(fault),
    }
}

/// A value in twelve decimals, as it stands in names of files: 0.3, where three steps of 0.1 are 0.30000000000000004.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 1e12).round() / 1e12
}
