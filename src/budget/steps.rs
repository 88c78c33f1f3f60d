//! The step of finite differences: large against the noise of paths that cross an aperture's edge, small against what the
//! difference leaves out.

use super::response::Group;
use crate::error::{Error, Result};

/// How often a step is judged, and what it is changed by.
const LOOKS: usize = 3;
const CHANGE: f64 = 2.0;
/// Variances of truncation and noise that differ by less are balanced.
const BALANCED: f64 = 4.0;
/// Derivatives known to this part of their root mean square need no better step.
const GOOD_ENOUGH: f64 = 0.01;

/// Groups at the step at which truncation and noise are balanced, or both small enough; `[first, most]` are the first and
/// the largest step.
pub fn balanced(
    [mut step, most]: [f64; 2],
    values: &[Vec<f64>],
    mut measure: impl FnMut(f64) -> Result<Vec<Vec<Group>>>,
) -> Result<Vec<Vec<Group>>> {
    let mut best: Option<(f64, Vec<Vec<Group>>)> = None;
    for _ in 0..LOOKS {
        let groups = measure(step)?;
        let [noise, truncation, size] = judged(&groups, values);
        let error = noise + truncation;
        let next = if error <= GOOD_ENOUGH * GOOD_ENOUGH * size {
            step
        } else if truncation > BALANCED * noise {
            step / CHANGE
        } else if noise > BALANCED * truncation {
            (step * CHANGE).min(most)
        } else {
            step
        };
        if best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, groups));
        }
        if next == step {
            break;
        }
        step = next;
    }
    best.map(|(_, groups)| groups).ok_or_else(|| Error::Internal("no step of a derivative".into()))
}

/// Sums over pairs, colours and moves of the squared noise, truncation and size of derivatives, relative to the values.
fn judged(groups: &[Vec<Group>], values: &[Vec<f64>]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (groups, values) in groups.iter().zip(values) {
        for (group, value) in groups.iter().zip(values).filter(|(_, value)| **value > 0.0) {
            for first in &group.first {
                let parts = [first.noise(), first.truncation, first.value()];
                parts.iter().zip(&mut sums).for_each(|(part, sum)| *sum += (part / value).powi(2));
            }
        }
    }
    sums
}
