//! What a receptor reads of a table at an incidence: a weighted sum of bins.
//!
//! flux/flux_in = sum over bins of the integral of f share cos. Within a bin f is taken as a plane (`hemisphere`), so that every
//! weight is known before any value, and realisations are read like their mean.

/// The weights of one value of the table, sr.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BinWeights {
    /// With f a plane within each bin.
    pub plane: f64,
    /// With f even within each bin.
    pub even: f64,
    /// With f a plane within bins twice as large.
    pub coarse: f64,
    /// With all light of a bin where the receptor collects least, and most.
    pub bounds: [f64; 2],
}

/// A weighted sum of bins.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// By place in the table's channels, `incidence * bins + bin`.
    pub terms: Vec<(usize, BinWeights)>,
    /// The integral of share cos, sr: the reading of f = 1.
    pub measure: f64,
    /// The largest bin that takes part, in the plane of incidence and across, degrees.
    pub bins_deg: [f64; 2],
    /// The largest bins with which the reading is taken to be one, degrees.
    pub most_deg: [f64; 2],
    /// What was done, where the table has not the very incidence.
    pub note: Option<String>,
}

impl BinWeights {
    /// The same weight whatever lies within the bins.
    pub(super) fn certain(weight: f64) -> Self {
        BinWeights { plane: weight, even: weight, coarse: weight, bounds: [weight; 2] }
    }

    fn scaled(self, factor: f64) -> Self {
        BinWeights {
            plane: factor * self.plane,
            even: factor * self.even,
            coarse: factor * self.coarse,
            bounds: self.bounds.map(|bound| factor * bound),
        }
    }
}

impl Reading {
    /// The same times a factor.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.terms.iter_mut().for_each(|(_, weights)| *weights = weights.scaled(factor));
        self.measure *= factor;
        self
    }

    /// The sum with another; of sizes of bins the larger, of notes the first.
    pub fn plus(mut self, other: Reading) -> Self {
        self.terms.extend(other.terms);
        self.measure += other.measure;
        self.bins_deg = [0, 1].map(|k| self.bins_deg[k].max(other.bins_deg[k]));
        self.most_deg = if self.most_deg == [0.0; 2] { other.most_deg } else { self.most_deg };
        self.note = self.note.or(other.note);
        self
    }

    /// Whether every bin is small enough.
    pub fn is_resolved(&self) -> bool {
        (0..2).all(|k| self.bins_deg[k] <= self.most_deg[k] * (1.0 + 1e-9))
    }
}
