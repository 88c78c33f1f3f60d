//! Which blocks of an incidence and realisation are finished.

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// A set of blocks: ranges in increasing order that neither touch nor overlap.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub(crate) struct FinishedBlocks(Vec<Range<u64>>);

impl FinishedBlocks {
    /// Adds a block that is not among them.
    pub fn insert(&mut self, block: u64) {
        let ranges = &mut self.0;
        let at = ranges.partition_point(|range| range.end < block);
        match ranges.get_mut(at) {
            Some(range) if range.end == block => range.end += 1,
            Some(range) if range.start == block + 1 => range.start = block,
            _ => return ranges.insert(at, block..block + 1),
        }
        if at + 1 < ranges.len() && ranges[at].end == ranges[at + 1].start {
            ranges[at].end = ranges.remove(at + 1).end;
        }
    }

    /// How many there are.
    pub fn count(&self) -> u64 {
        self.0.iter().map(|range| range.end - range.start).sum()
    }

    /// What is missing of `wanted`, in order.
    pub fn missing(&self, wanted: &Range<u64>) -> Vec<Range<u64>> {
        let mut missing = Vec::new();
        let mut from = wanted.start;
        for range in self.0.iter().filter(|range| range.end > wanted.start && range.start < wanted.end) {
            if range.start > from {
                missing.push(from..range.start);
            }
            from = range.end;
        }
        if from < wanted.end {
            missing.push(from..wanted.end);
        }
        missing
    }

    /// Whether this is such a set, of blocks below `end`: what comes from a file may be anything.
    pub fn is_sound(&self, end: u64) -> bool {
        let apart = self.0.windows(2).all(|pair| pair[0].end < pair[1].start);
        apart && self.0.iter().all(|range| range.start < range.end && range.end <= end)
    }
}

#[cfg(test)]
#[expect(clippy::single_range_in_vec_init, reason = "a list of one range is what is meant")]
mod tests {
    use super::*;

    #[test]
    fn blocks_in_any_order_make_one_range() {
        for order in [[0, 1, 2, 3], [3, 2, 1, 0], [0, 3, 1, 2], [2, 0, 3, 1], [1, 3, 0, 2]] {
            let mut blocks = FinishedBlocks::default();
            for (inserted, block) in (1..).zip(order) {
                blocks.insert(block);
                assert!(blocks.is_sound(4) && blocks.count() == inserted, "{order:?}: {blocks:?}");
            }
            assert_eq!(blocks.0, [0..4], "{order:?}");
        }
    }

    #[test]
    fn what_is_missing_lies_between() {
        let mut blocks = FinishedBlocks::default();
        assert_eq!(blocks.missing(&(3..9)), [3..9]);
        [1, 4, 5, 8].into_iter().for_each(|block| blocks.insert(block));
        assert_eq!(blocks.missing(&(0..10)), [0..1, 2..4, 6..8, 9..10]);
        assert_eq!(blocks.missing(&(4..6)), []);
        assert_eq!(blocks.missing(&(5..8)), [6..8]);
    }

    #[test]
    fn ranges_that_no_set_has_are_found() {
        for ranges in [vec![3..3], vec![0..2, 2..3], vec![4..6, 0..1], vec![0..11], vec![0..3, 2..4]] {
            assert!(!FinishedBlocks(ranges.clone()).is_sound(10), "{ranges:?}");
        }
    }
}
