//! The sums of one incidence and realisation as fractions of the incident flux: what colours are made of.

use super::fresnel_sums::{ColourSource, ELEMENTS, FresnelSums};
use super::tally::{Order, Tally, from_signed_units, from_units};
use crate::optics::parts;

/// A tally, read as fractions of what fell on the patch in its blocks.
#[derive(Debug, Clone, Copy)]
pub struct TallyFlux<'a> {
    /// The sums.
    pub tally: &'a Tally,
    blocks: f64,
}

impl<'a> TallyFlux<'a> {
    /// That of a tally of so many blocks.
    pub fn new(tally: &'a Tally, blocks: u64) -> Self {
        TallyFlux { tally, blocks: blocks as f64 }
    }

    /// Units of the tally as a fraction of the incident flux.
    pub fn of(&self, units: u128) -> f64 {
        from_units(units) / self.blocks
    }

    /// Flux with a sign: an element of a colour's Mueller matrix, all orders together.
    pub fn mueller(&self, place: usize, element: usize, bin: usize) -> f64 {
        from_signed_units(self.tally.mueller[place * ELEMENTS + element][bin]) / self.blocks
    }

    /// What left an open map, where anything did.
    pub fn left(&self) -> Option<TallyFlux<'a>> {
        self.tally.left.as_deref().map(|tally| TallyFlux { tally, ..*self })
    }

    /// Flux of order 1 in one colour. Schlick: F0 times the whole plus (1 - F0) times the (1-c)^5 part.
    pub fn single(&self, colour: ColourSource, bin: usize) -> f64 {
        let Tally { single, first, .. } = self.tally;
        match colour {
            ColourSource::Unit => self.of(single[bin]),
            ColourSource::Schlick { f0 } => f0 * self.of(single[bin]) + (1.0 - f0) * self.of(first[0][bin]),
            ColourSource::Traced { place } => self.of(first[1 + place][bin]),
            ColourSource::Followed { place } => self.of(first[place][bin]),
        }
    }

    /// Flux of the orders above 1 in one colour.
    pub fn multiple(&self, sums: &FresnelSums, colour: ColourSource, bin: usize) -> f64 {
        (0..sums.groups()).map(|group| self.group(sums, group, colour, bin)).sum()
    }

    /// Flux of one group of orders above 1 in one colour.
    pub fn group(&self, sums: &FresnelSums, group: usize, colour: ColourSource, bin: usize) -> f64 {
        let (multiple, sums) = (&self.tally.multiple, sums.group(group));
        match colour {
            ColourSource::Unit => self.of(multiple[sums.start][bin]),
            ColourSource::Schlick { f0 } => {
                parts::at_f0(multiple[sums].iter().map(|sum| self.of(sum[bin])), f0)
            }
            ColourSource::Traced { place } | ColourSource::Followed { place } => {
                self.of(multiple[sums.start + place][bin])
            }
        }
    }

    /// Flux of paths that leave after `order` + 1 bounces, in one colour.
    pub fn order(&self, order: usize, colour: ColourSource) -> f64 {
        self.of_order(&self.tally.orders[order], colour)
    }

    /// The same of paths that have gone through the surface.
    pub fn through(&self, order: usize, colour: ColourSource) -> f64 {
        self.tally.through.get(order).map_or(0.0, |order| self.of_order(order, colour))
    }

    fn of_order(&self, order: &Order, colour: ColourSource) -> f64 {
        match colour {
            ColourSource::Unit => self.of(order.flux),
            ColourSource::Schlick { f0 } => {
                parts::at_f0(order.weighted.iter().map(|&units| self.of(units)), f0)
            }
            ColourSource::Traced { place } | ColourSource::Followed { place } => {
                self.of(order.weighted[place])
            }
        }
    }

    /// Flux with F = 1 beyond the last order.
    pub fn truncated(&self) -> f64 {
        self.of(self.tally.cut.flux)
    }

    /// Flux with F = 1 that ends on an absorbing plane.
    pub fn absorbed(&self) -> f64 {
        self.of(self.tally.absorbed.flux)
    }
}
