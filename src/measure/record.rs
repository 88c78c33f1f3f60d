//! The sums of one stop and realisation as numbers: what colours are made of.

use super::slopes::SeenBySlope;
use super::tally::{Tally, from_units};
use super::weighing::{Colour, Weighing};
use crate::optics::parts;

/// One stop and realisation, flux as a share of the incident flux.
#[derive(Debug, Clone, PartialEq)]
pub struct StopRecord {
    /// Order 1 with F = 1, by bin.
    pub single: Vec<f64>,
    /// Order 1 by weight and bin, as in the tally.
    pub first: Vec<Vec<f64>>,
    /// Orders above 1 by weight and bin, as in the tally.
    pub multiple: Vec<Vec<f64>>,
    /// Arrivals by bin.
    pub hits: Vec<u64>,
    /// Paths that leave, by order - 1.
    pub orders: Vec<OrderRecord>,
    /// Paths beyond the last order, and their flux with F = 1.
    pub cut: (u64, f64),
    /// Starts that the light does not see.
    pub hidden: u64,
    /// Paths over the edge of an open map, and their flux with F = 1.
    pub left_map: (u64, f64),
    /// Where they would arrive, as in the tally.
    pub left: Option<Box<StopRecord>>,
    /// Starts whose facets send light into no aperture, and their flux.
    pub outside: (u64, f64),
    /// What the light sees of the facets, by their slope.
    pub seen: SeenBySlope,
}

/// Paths that leave after one number of bounces.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderRecord {
    /// Their number.
    pub count: u64,
    /// Their flux with F = 1.
    pub unit: f64,
    /// Their flux by weight.
    pub weighted: Vec<f64>,
}

impl StopRecord {
    /// The record of a tally of so many blocks.
    pub fn new(tally: &Tally, blocks: f64) -> Self {
        let share = |units: u128| from_units(units) / blocks;
        let flux = |sums: &Vec<u128>| sums.iter().map(|&units| share(units)).collect::<Vec<_>>();
        let order = |order: &super::tally::Order| OrderRecord {
            count: order.count,
            unit: share(order.flux),
            weighted: flux(&order.weighted),
        };
        StopRecord {
            single: flux(&tally.single),
            first: tally.first.iter().map(flux).collect(),
            multiple: tally.multiple.iter().map(flux).collect(),
            hits: tally.hits.clone(),
            orders: tally.orders.iter().map(order).collect(),
            cut: (tally.cut.count, share(tally.cut.flux)),
            hidden: tally.hidden.count,
            left_map: (tally.left_map.count, share(tally.left_map.flux)),
            left: tally.left.as_ref().map(|left| Box::new(StopRecord::new(left, blocks))),
            outside: (tally.outside.count, share(tally.outside.flux)),
            seen: SeenBySlope::of(tally),
        }
    }

    /// Flux of order 1 in one colour. Schlick: F0 times the whole plus (1 - F0) times the (1-c)^5 part.
    pub fn single_flux(&self, colour: Colour, bin: usize) -> f64 {
        match colour {
            Colour::Unit => self.single[bin],
            Colour::Schlick { f0 } => f0 * self.single[bin] + (1.0 - f0) * self.first[0][bin],
            Colour::Traced { place } => self.first[1 + place][bin],
        }
    }

    /// Flux of the orders above 1 in one colour.
    pub fn multiple_flux(&self, weighing: &Weighing, colour: Colour, bin: usize) -> f64 {
        (0..weighing.groups()).map(|group| self.group_flux(weighing, group, colour, bin)).sum()
    }

    /// Flux of one group of orders above 1 in one colour.
    pub fn group_flux(&self, weighing: &Weighing, group: usize, colour: Colour, bin: usize) -> f64 {
        let sums = weighing.group(group);
        match colour {
            Colour::Unit => self.multiple[sums.start][bin],
            Colour::Schlick { f0 } => parts::at_f0(self.multiple[sums].iter().map(|sum| sum[bin]), f0),
            Colour::Traced { place } => self.multiple[sums.start + place][bin],
        }
    }
}

impl OrderRecord {
    /// Flux of the order in one colour.
    pub fn flux(&self, colour: Colour) -> f64 {
        match colour {
            Colour::Unit => self.unit,
            Colour::Schlick { f0 } => parts::at_f0(self.weighted.iter().copied(), f0),
            Colour::Traced { place } => self.weighted[place],
        }
    }
}
