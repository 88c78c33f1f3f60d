//! Systematic samples: equal steps along a running sum, from one random offset.

/// The steps still to come.
pub(crate) struct SystematicSteps {
    next: u64,
    count: u64,
    step: f64,
    offset: f64,
}

impl SystematicSteps {
    /// `count` steps of this length, the first at `offset` (in [0, 1)) of it.
    pub fn new(count: u64, step: f64, offset: f64) -> Self {
        SystematicSteps { next: 0, count, step, offset }
    }

    /// Whether none is left.
    pub fn is_over(&self) -> bool {
        self.next == self.count
    }

    /// Whether a step lies before `sum`.
    #[inline]
    pub fn is_before(&self, sum: f64) -> bool {
        self.next < self.count && self.position() < sum
    }

    /// Takes the next step if it lies before `sum`, and says where it is.
    #[inline]
    pub fn take(&mut self, sum: f64) -> Option<f64> {
        let position = self.position();
        let taken = self.is_before(sum).then_some(position);
        self.next += u64::from(taken.is_some());
        taken
    }

    fn position(&self) -> f64 {
        (self.next as f64 + self.offset) * self.step
    }
}
