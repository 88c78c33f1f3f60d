//! The part of a table on one side of the surface, as a table of its own.

use super::brdf_table::{BrdfTable, ColourChannels, RealisationPart, Realisations};
use crate::instrument::Grid;

impl BrdfTable {
    /// Light that comes back (`below` false), or that has gone through, as a mirror in the horizon shows it; `None` where
    /// no bin is there. Errors of albedos are those of both sides and are left out.
    pub fn half(&self, below: bool) -> Option<BrdfTable> {
        let half = self.grid.half(below)?;
        let stops = self.grid.stops();
        let of = |values: &Vec<f32>| half.of(values, stops);
        let colour = |colour: &ColourChannels| ColourChannels {
            total: of(&colour.total),
            single: of(&colour.single),
            multiple: of(&colour.multiple),
            stderr: of(&colour.stderr),
            stderr_single: of(&colour.stderr_single),
            albedo_se: Vec::new(),
            orders: colour.orders.iter().map(of).collect(),
            mueller: colour.mueller.iter().map(of).collect(),
            stderr_mueller: colour.stderr_mueller.iter().map(of).collect(),
            left_map: of(&colour.left_map),
            wavelength_nm: colour.wavelength_nm,
        };
        Some(BrdfTable {
            colours: self.colours.iter().map(colour).collect(),
            hits: half.of(&self.hits, stops),
            ..self.header(&half.grid)
        })
    }
}

impl Realisations {
    /// The same part of the incidences of `grid` in every realisation; the first of them is that of `first_stop`.
    pub fn half(&self, grid: &Grid, first_stop: usize, below: bool) -> Option<Realisations> {
        let half = grid.half(below)?;
        let (bins, stops) = (grid.bins(), grid.stops());
        let here = first_stop * bins..(first_stop + stops) * bins;
        let of = |colours: &Vec<Vec<f32>>| {
            colours.iter().map(|values| half.of(&values[here.clone()], stops)).collect()
        };
        let part = |part: &RealisationPart| RealisationPart {
            total: of(&part.total),
            single: of(&part.single),
            schlick: None,
        };
        Some(Realisations { parts: self.parts.iter().map(part).collect() })
    }
}
