//! The part of a table on one side of the surface, as a table of its own.

use super::brdf_table::{BrdfTable, ColourChannels, RealisationPart, Realisations};
use crate::instrument::Grid;

impl BrdfTable {
    /// Light that comes back (`below` false), or that has gone through, as a mirror in the horizon shows it; `None` where
    /// no bin is there. Errors of albedos are those of both sides and are left out.
    pub fn half(&self, below: bool) -> Option<BrdfTable> {
        let half = self.grid.half(below)?;
        let (all, stops) = (self.grid.bins(), self.grid.stops());
        let entries = || (0..stops).flat_map(|stop| half.bins.iter().map(move |bin| stop * all + bin));
        let of = |values: &Vec<f32>| -> Vec<f32> {
            if values.is_empty() { Vec::new() } else { entries().map(|entry| values[entry]).collect() }
        };
        let colour = |colour: &ColourChannels| ColourChannels {
            total: of(&colour.total),
            single: of(&colour.single),
            multiple: of(&colour.multiple),
            stderr: of(&colour.stderr),
            stderr_single: of(&colour.stderr_single),
            albedo_se: Vec::new(),
            orders: colour.orders.iter().map(of).collect(),
            left_map: of(&colour.left_map),
            wavelength_nm: colour.wavelength_nm,
        };
        Some(BrdfTable {
            colours: self.colours.iter().map(colour).collect(),
            hits: entries().map(|entry| self.hits[entry]).collect(),
            ..self.header(&half.grid)
        })
    }
}

impl Realisations {
    /// The same part of every realisation of a table of this grid.
    pub fn half(&self, grid: &Grid, below: bool) -> Option<Realisations> {
        let half = grid.half(below)?;
        let (all, stops) = (grid.bins(), grid.stops());
        let of = |colours: &Vec<Vec<f32>>| {
            let colour = |values: &Vec<f32>| {
                (0..stops)
                    .flat_map(|stop| half.bins.iter().map(move |bin| values[stop * all + bin]))
                    .collect()
            };
            colours.iter().map(colour).collect()
        };
        let part = |part: &RealisationPart| RealisationPart {
            total: of(&part.total),
            single: of(&part.single),
            schlick: None,
        };
        Some(Realisations { parts: self.parts.iter().map(part).collect() })
    }
}
