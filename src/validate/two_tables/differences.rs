//! Differences of two tables by realisation: of one bin, independent numbers with the true difference as their mean.
//!
//! Realisations of A minus those of B, in the order that they are stored; the longer list by means over as many groups as
//! the shorter has entries. A table without realisations has its value and error split: with z_k normal,
//! x + se sqrt(R) (z_k - mean z) has variance R se^2, and two of them covariance se^2 - se^2 = 0, so that they are R
//! independent realisations where the noise is normal; where the error is 0 they are the value.
// Tested by `a_difference_is_read_without_bias`, `a_table_without_realisations_is_split`.

use super::compared_table::ComparedTable;
use crate::rng::{self, Purpose, StreamId};
use crate::table::Realisations;
use crate::validate::model_distance::FEWEST;

/// The place of a bin: in the tables at hand, and in the realisations, which have all incidences.
#[derive(Debug, Clone, Copy)]
pub struct ValueIndex {
    pub here: usize,
    pub stored: usize,
    pub colour: usize,
}

/// Two tables of which one at least has realisations.
pub struct BinDifferences<'a> {
    sides: [ComparedTable<'a>; 2],
    parts: [Option<&'a Realisations>; 2],
    count: usize,
}

impl<'a> BinDifferences<'a> {
    /// `None` where neither has enough realisations, or where an error that would be split is but a bound.
    pub fn new(a: ComparedTable<'a>, b: ComparedTable<'a>) -> Option<Self> {
        if a.errors_are_bounds || b.errors_are_bounds {
            return None;
        }
        let parts = [a, b].map(|side| side.parts.filter(|parts| parts.parts.len() >= FEWEST));
        let count = parts.iter().flatten().map(|parts| parts.parts.len()).min()?;
        Some(BinDifferences { sides: [a, b], parts, count })
    }

    /// How many realisations.
    pub fn count(&self) -> usize {
        self.count
    }

    /// A - B in each; `None` where an error that is needed is not known.
    pub fn at(&self, place: ValueIndex) -> Option<Vec<f64>> {
        let (a, b) = (self.side(0, place)?, self.side(1, place)?);
        Some(a.iter().zip(b).map(|(a, b)| a - b).collect())
    }

    fn side(&self, side: usize, ValueIndex { here, stored, colour }: ValueIndex) -> Option<Vec<f64>> {
        let Some(parts) = self.parts[side] else {
            let channels = &self.sides[side].table.colours[colour];
            let (value, se) = (f64::from(channels.total[here]), f64::from(channels.stderr[here]));
            let stream = [side, stored, colour].map(|number| number as u64);
            return (se >= 0.0).then(|| split(value, se, self.count, stream));
        };
        let all = parts.parts.len();
        let mean = |k: usize| {
            let group = &parts.parts[k * all / self.count..(k + 1) * all / self.count];
            group.iter().map(|part| f64::from(part.total[colour][stored])).sum::<f64>() / group.len() as f64
        };
        Some((0..self.count).map(mean).collect())
    }
}

/// So many realisations of which a value is the mean; the same ones for the same place.
fn split(value: f64, se: f64, count: usize, [side, stored, colour]: [u64; 3]) -> Vec<f64> {
    if se == 0.0 {
        return vec![value; count];
    }
    let id =
        StreamId { seed: colour, purpose: Purpose::Split, realisation: side, incidence: 0, block: stored };
    let mut rng = rng::stream(id);
    let z: Vec<f64> = (0..count).map(|_| rng::normal(&mut rng)).collect();
    let (mean, scale) = (crate::stats::mean(&z), se * (count as f64).sqrt());
    z.iter().map(|z| value + scale * (z - mean)).collect()
}
