//! Masking given the normal: how often the light sees facets, by their slope along the light.
//!
//! Input: starts, which lie on the facets in proportion to the area facing the light. Output: in each class of
//! slopes the fraction of them that the light sees. Smith's masking (Heitz 2014, section 3.3) is the same for all facets
//! that are facing the light; a continuous surface need not keep to it. Counted here, compared in `report`.

use serde::{Deserialize, Serialize};

use crate::stats;

/// Edges between the classes, in units of alpha along the light's azimuth; plain slopes of a surface without an alpha. Below 0 a facet is tilted towards the light;
/// slopes at or above cot(theta_i)/alpha are facing away from it and have no samples.
const EDGES: [f64; 17] =
    [-4.0, -3.0, -2.0, -1.5, -1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0];
const CLASSES: usize = EDGES.len() + 1;
/// All edges are multiples of its reciprocal.
const PARTS: f64 = 4.0;
/// The class of every part from the first edge to the last.
const CLASS_OF_PART: [u8; 32] = class_of_part();

const fn class_of_part() -> [u8; 32] {
    let (mut classes, mut part, mut class) = ([0; 32], 0, 0);
    while part < classes.len() {
        if EDGES[class] * PARTS <= EDGES[0] * PARTS + part as f64 {
            class += 1;
        }
        classes[part] = class as u8;
        part += 1;
    }
    classes
}

/// Counts of one incidence and realisation.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct SeenBySlope {
    starts: [u64; CLASSES],
    seen: [u64; CLASSES],
}

/// One class of facets, over all realisations.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SlopeClass {
    /// Slopes in [lower, upper) along the light's azimuth, units of alpha where there is one; null: without end.
    pub slope: [Option<f64>; 2],
    /// Samples in it.
    pub starts: u64,
    /// Fraction that the light sees: mean over the realisations that have starts in it.
    pub share: Option<f64>,
    /// Its standard error over these realisations.
    pub share_se: Option<f64>,
}

/// The class that holds a slope: a table is read in a third of the time that the edges are searched in.
fn class_of(slope: f64) -> usize {
    if slope.is_nan() || slope < EDGES[0] {
        return 0;
    }
    // Exact: the factor is a power of two.
    let parts = PARTS * slope;
    let below = parts as i64 - i64::from(parts < (parts as i64) as f64);
    let part = below.saturating_sub((PARTS * EDGES[0]) as i64) as usize;
    CLASS_OF_PART.get(part).map_or(CLASSES - 1, |&class| usize::from(class))
}

impl SeenBySlope {
    /// Counts a surface sample on a facet of this slope.
    pub fn count(&mut self, slope: f64, seen: bool) {
        let class = class_of(slope);
        self.starts[class] += 1;
        self.seen[class] += u64::from(seen);
    }

    /// Adds the counts of further blocks.
    pub fn merge(&mut self, other: &Self) {
        self.starts.iter_mut().zip(&other.starts).for_each(|(mine, theirs)| *mine += theirs);
        self.seen.iter_mut().zip(&other.seen).for_each(|(mine, theirs)| *mine += theirs);
    }

    /// Whether no class has more than so many samples, nor sees more than it has.
    pub fn is_sound(&self, starts: u64) -> bool {
        self.starts.iter().zip(&self.seen).all(|(here, seen)| here <= &starts && seen <= here)
    }
}

/// The classes over all realisations of an incidence; `None` where one of them has counted nothing: without visibility,
/// where only some facets are sampled, on a statistical surface.
// Tested by `the_light_sees_a_groove_as_torrance_and_sparrow_say`.
pub(crate) fn classes(realisations: &[&SeenBySlope]) -> Option<Vec<SlopeClass>> {
    let counted = |counts: &&SeenBySlope| counts.starts.iter().any(|&starts| starts > 0);
    if !realisations.iter().all(counted) {
        return None;
    }
    let class = |k: usize| {
        let here = realisations.iter().filter(|counts| counts.starts[k] > 0);
        let shares = here.map(|counts| counts.seen[k] as f64 / counts.starts[k] as f64);
        let (mean, se) = stats::mean_and_se(shares);
        let starts = realisations.iter().map(|counts| counts.starts[k]).sum();
        SlopeClass {
            slope: [k.checked_sub(1).map(|below| EDGES[below]), EDGES.get(k).copied()],
            starts,
            share: (starts > 0).then_some(mean),
            share_se: se,
        }
    };
    Some((0..CLASSES).map(class).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_says_what_the_edges_say() {
        let edges = EDGES.iter().flat_map(|edge| [edge.next_down(), *edge, edge.next_up()]);
        let between = (-50..50).map(|k| 0.1 * f64::from(k));
        for slope in edges.chain(between).chain([f64::NEG_INFINITY, -1e300, 1e300, f64::INFINITY]) {
            assert_eq!(class_of(slope), EDGES.partition_point(|&edge| edge <= slope), "{slope}");
        }
    }

    #[test]
    fn classes_are_half_open_and_say_where_nothing_is() {
        let mut counts = SeenBySlope::default();
        for (slope, seen) in [(-9.0, true), (0.25, true), (0.25, false), (0.249, true), (4.0, false)] {
            counts.count(slope, seen);
        }
        let counted = classes(&[&counts, &counts]).expect("counted");
        let of = |slope: [Option<f64>; 2]| {
            let class = counted.iter().find(|class| class.slope == slope).expect("a class");
            (class.starts, class.share, class.share_se)
        };
        assert_eq!(of([None, Some(-4.0)]), (2, Some(1.0), Some(0.0)));
        assert_eq!(of([Some(0.25), Some(0.5)]), (4, Some(0.5), Some(0.0)));
        assert_eq!(of([Some(0.0), Some(0.25)]), (2, Some(1.0), Some(0.0)));
        assert_eq!(of([Some(4.0), None]), (2, Some(0.0), Some(0.0)));
        assert_eq!(of([Some(1.0), Some(1.5)]), (0, None, None));
        assert!(classes(&[&counts, &SeenBySlope::default()]).is_none());
    }
}
