//! A table of albedos in memory.

use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::files;

/// What the cells lie along; each list increases.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axes {
    /// Cosine of the light's polar angle, (0, 1].
    pub mu: Vec<f64>,
    /// Roughness; a single 0 of a surface that has none.
    pub alpha: Vec<f64>,
    /// Index of the inside over the outside; empty for mirror facets.
    pub eta: Vec<f64>,
}

impl Axes {
    /// Slabs of alpha and mu: one for each eta, or a single one.
    pub fn slabs(&self) -> usize {
        self.eta.len().max(1)
    }

    /// Number of cells of a quantity.
    pub fn cells(&self) -> usize {
        self.slabs() * self.alpha.len() * self.mu.len()
    }

    /// (name, nodes) of those that are there, in the order of the values: the last runs fastest.
    pub fn named(&self) -> Vec<(&'static str, &[f64])> {
        let all = [("eta", &self.eta[..]), ("alpha", &self.alpha), ("mu", &self.mu)];
        all.into_iter().filter(|(_, nodes)| !nodes.is_empty()).collect()
    }

    /// The mean over the hemisphere of values at the nodes of mu, interpolated as lookups do: 2 times the integral of value
    /// mu dmu, linear between the nodes and constant beyond the ends. Weights of the nodes; they add up to 1.
    // Tested by `weights_of_nodes_integrate_straight_lines`.
    pub fn mu_weights(&self) -> Vec<f64> {
        let mu = &self.mu;
        let last = mu.len() - 1;
        let mut weights = vec![0.0; mu.len()];
        weights[0] += mu[0] * mu[0];
        weights[last] += (1.0 - mu[last]) * (1.0 + mu[last]);
        for (k, pair) in mu.windows(2).enumerate() {
            let (a, b) = (pair[0], pair[1]);
            // 2 times the integral of the two hat functions' halves, times mu.
            weights[k] += (b - a) * (2.0 * a + b) / 3.0;
            weights[k + 1] += (b - a) * (a + 2.0 * b) / 3.0;
        }
        weights
    }
}

/// A value with its error; `None`: not available.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Cell {
    /// A share of the incident light.
    pub value: f64,
    /// As [`AlbedoTable::errors`] says.
    pub error: Option<f64>,
}

/// One quantity over all cells.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    /// Its name in files, a C identifier.
    pub name: String,
    /// What it is.
    pub about: String,
    /// \[eta\]\[alpha\]\[mu\].
    pub cells: Vec<Cell>,
    /// Means over the hemisphere, 2 times the integral of value mu dmu: \[eta\]\[alpha\].
    pub averages: Vec<Cell>,
}

/// A table of albedos, and where it comes from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AlbedoTable {
    /// What it is a table of.
    pub title: String,
    /// Where the cells are.
    pub axes: Axes,
    /// The quantities, the main ones first.
    pub quantities: Vec<Quantity>,
    /// What an error is.
    pub errors: &'static str,
    /// How averages are made.
    pub average: &'static str,
    /// Where it comes from, by name: law and masking, or campaign, seed and patches.
    pub origin: Vec<(&'static str, String)>,
}

/// What every value is.
pub const CONVENTION: &str = "shares of the incident flux, light from one direction at every azimuth alike; mu is the \
    cosine of its polar angle on its own side; eta the index of the inside over the outside; inside: light from below; \
    nodes lie where the axes say, values are at the nodes, order [eta][alpha][mu]; linear between nodes, constant beyond \
    the ends";

impl AlbedoTable {
    /// The texts that every file carries, by name.
    pub fn texts(&self) -> Vec<(&'static str, String)> {
        let mut texts = vec![
            ("title", self.title.clone()),
            ("convention", CONVENTION.into()),
            ("errors", self.errors.into()),
            ("average", self.average.into()),
        ];
        texts.extend(self.origin.iter().cloned());
        texts.push(("version", env!("CARGO_PKG_VERSION").into()));
        texts.push(("digest", self.digest()));
        texts
    }

    /// SHA-256 of axes, values, errors and origin.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        let mut number = |value: f64| hash.update(value.to_le_bytes());
        self.axes.named().iter().flat_map(|(_, nodes)| *nodes).copied().for_each(&mut number);
        for cell in
            self.quantities.iter().flat_map(|quantity| quantity.cells.iter().chain(&quantity.averages))
        {
            number(cell.value);
            number(cell.error.unwrap_or(-1.0));
        }
        let names = self.quantities.iter().map(|quantity| (quantity.name.as_str(), ""));
        let origin = self.origin.iter().map(|(name, text)| (*name, text.as_str()));
        for text in names.chain(origin).flat_map(|(name, text)| [name, text]) {
            hash.update(text);
            hash.update([0]);
        }
        files::hex(&hash.finalize())
    }

    /// The quantity of this name.
    pub fn quantity(&self, name: &str) -> Option<&Quantity> {
        self.quantities.iter().find(|quantity| quantity.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_nodes_integrate_straight_lines() {
        for mu in [vec![0.3], vec![0.0, 1.0], vec![0.0, 0.2, 0.7, 1.0], vec![0.125, 0.375, 0.625, 0.875]] {
            let axes = Axes { mu: mu.clone(), alpha: vec![0.5], eta: vec![] };
            let weights = axes.mu_weights();
            // A handful of products each.
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            if mu[0] == 0.0 {
                // 2 times the integral of mu mu dmu over [0, 1].
                let first: f64 = weights.iter().zip(&mu).map(|(weight, mu)| weight * mu).sum();
                assert!((first - 2.0 / 3.0).abs() < 1e-15, "{first}");
            }
        }
    }
}
