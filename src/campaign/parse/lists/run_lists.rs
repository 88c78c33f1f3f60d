//! Lists that make a run each: seeds, and correlation lengths of random heights. Their tables share no patches.

use std::cell::Cell;

use crate::campaign::parse::reader::GivenValue;

/// Most entries of such a list.
pub(crate) const MOST_RUNS: usize = 1000;

/// Which value of each list a reading takes, and how many there are.
pub(crate) struct RunLists {
    picked: Option<usize>,
    /// The list that was found.
    found: Cell<Option<usize>>,
}

impl RunLists {
    /// No list is taken.
    pub fn refused() -> Self {
        RunLists { picked: None, found: Cell::new(None) }
    }

    /// The `run`th value of the list.
    pub fn pick(run: usize) -> Self {
        RunLists { picked: Some(run), found: Cell::new(None) }
    }

    /// How many values the list has; `None` where there is no list.
    pub fn count(&self) -> Option<usize> {
        self.found.get()
    }

    /// The value of this run: a number by `one`, an entry of a list or range by `all`.
    pub fn value<T: Copy + PartialOrd>(
        &self,
        item: &GivenValue<'_>,
        one: impl Fn(&GivenValue<'_>) -> Option<T>,
        all: impl Fn(&GivenValue<'_>) -> Option<Vec<T>>,
    ) -> Option<T> {
        if item.list_length().is_none() && !item.is_table() {
            return one(item);
        }
        let Some(run) = self.picked else {
            return item.refuse(
                "must be one number here: a list makes a run each, for gonio measure and gonio check",
            );
        };
        let values = all(item)?;
        if self.found.get().is_some() {
            return item.refuse("is a list, as seed is: one of them at a time; give the other a number");
        }
        if values.is_empty() || values.len() > MOST_RUNS {
            return item
                .refuse(format!("has {} entries; 1 to {MOST_RUNS} are allowed, a run each", values.len()));
        }
        if !values.is_sorted_by(|a, b| a < b) {
            return item.refuse("must increase, each value once: one run is made for each");
        }
        self.found.set(Some(values.len()));
        values.get(run).copied()
    }
}
