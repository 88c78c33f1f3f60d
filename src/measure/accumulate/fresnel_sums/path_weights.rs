//! What one path adds to the sums: its weight in each of them.

use super::{FresnelSums, SumKind};
use crate::measure::optics::PathLight;
use crate::optics::parts;
use crate::optics::reflectance::Reflectance;

/// The weights of one path, for sums of shares of its flux.
#[derive(Debug, Clone, Default)]
pub struct PathWeights {
    /// Into the sums of its order, from `order_first` on.
    pub order: Vec<f64>,
    /// The first of these sums.
    pub order_first: usize,
    /// Into the sums of its bins, from `first` on.
    pub bins: Vec<f64>,
    /// The first of these sums.
    pub first: usize,
}

impl FresnelSums {
    /// The weights of a path which left after `order` facets.
    pub fn weigh(&self, light: &PathLight, order: u32, weights: &mut PathWeights) {
        let angles = light.angles();
        let PathWeights { order: of_order, order_first, bins, first } = weights;
        bins.clear();
        of_order.clear();
        *order_first = 0;
        let group = if self.by_order { (order as usize).saturating_sub(2) } else { 0 };
        *first = if order > 1 { self.group(group).start } else { 0 };
        match self.sums {
            SumKind::Paths => {
                of_order.push(1.0);
                bins.push(1.0);
                *order_first = light.place();
                *first += light.place();
            }
            SumKind::Counts if order == 1 => {}
            SumKind::Counts => bins.push(1.0),
            SumKind::Parts => {
                parts::of_path(angles, of_order);
                if order == 1 {
                    bins.push(of_order[1]);
                } else {
                    bins.resize(1 + self.degree(group), 0.0);
                    parts::add_raised(of_order, self.degree(group), bins);
                }
            }
            SumKind::Colours => {
                let product = |r: &Reflectance| angles.iter().map(|&angle| r.at(angle)).product::<f64>();
                of_order.extend(self.reflectances.iter().map(product));
                if order == 1 {
                    // What layered facets mirror met no base; no F0 is worked out from their sums.
                    bins.push(angles.first().map_or(0.0, |angle| angle.schlick_weight()));
                }
                bins.extend_from_slice(of_order);
            }
        }
    }
}
