//! Albedos of an incidence from the fluxes of its realisations, with errors that cover lost light.

use super::assemble::IncidenceResult;
use super::lost_light;
use crate::stats;

/// A mean and its standard error, as far as they are known.
type KnownMean = (Option<f64>, Option<f64>);

impl IncidenceResult {
    /// Whether the light saw no surface sample: then nothing is known of the albedo.
    pub fn is_dark(&self) -> bool {
        self.orders.iter().chain(&self.through).sum::<u64>()
            + self.cut
            + self.left_map
            + self.outside
            + self.absorbed
            == 0
    }

    /// Albedo of order 1.
    pub fn single(&self) -> KnownMean {
        self.covered(self.albedo_by_order[0].iter().copied(), self.lost_light[0])
    }

    /// Albedo of all orders.
    pub fn total(&self) -> KnownMean {
        let of = |realisation: usize| self.albedo_by_order.iter().map(|order| order[realisation]).sum();
        self.covered((0..self.closure.len()).map(of), self.lost_light[1])
    }

    /// Share of the light that has gone through the surface at order 1; `None` where none does.
    pub fn single_transmittance(&self) -> KnownMean {
        match self.transmittance_by_order.first() {
            Some(first) => self.covered(first.iter().copied(), self.lost_light[0]),
            None => (None, None),
        }
    }

    /// The same after all orders.
    pub fn total_transmittance(&self) -> KnownMean {
        if self.transmittance_by_order.is_empty() {
            return (None, None);
        }
        let of =
            |realisation: usize| self.transmittance_by_order.iter().map(|order| order[realisation]).sum();
        self.covered((0..self.closure.len()).map(of), self.lost_light[1])
    }

    /// What a model of single scattering misses: with F = 1 the share of the incident light that leaves later than
    /// after one bounce or is still on its way after the last order; with a material the share of the reflected light
    /// above order 1, where such orders are followed.
    // Tested by `single_scattering_misses_three_tenths_of_a_rough_mirror` (tests/it/measure/energy.rs).
    pub fn beyond_order_1(&self) -> KnownMean {
        let orders = &self.albedo_by_order;
        let of = |realisation: usize| {
            let single = orders[0][realisation];
            if self.perfect {
                return self.closure[realisation] - single;
            }
            let total: f64 = orders.iter().map(|order| order[realisation]).sum();
            if total > 0.0 { (total - single) / total } else { 0.0 }
        };
        let seen = if self.perfect || orders.len() > 1 { self.closure.len() } else { 0 };
        self.covered((0..seen).map(of), self.lost_light[1])
    }

    /// An albedo whose error covers what light over the edge of an open map may have added.
    fn covered(&self, values: impl Iterator<Item = f64> + Clone, bound: f64) -> KnownMean {
        if self.is_dark() {
            return (None, None);
        }
        let (mean, se) = stats::known_mean(values);
        (mean, se.map(|se| lost_light::with_bound(se, bound)))
    }
}
