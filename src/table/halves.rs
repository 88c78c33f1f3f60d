//! The parts of a table on the two sides of the surface, as tables of their own, and put together again.

use super::brdf_table::{BrdfTable, ColourChannels, RealisationPart, Realisations};
use crate::instrument::halves::Half;
use crate::instrument::{Grid, GridKind};

impl BrdfTable {
    /// Light that comes back (`below` false), or that has gone through, as a mirror in the horizon shows it; `None` where
    /// no bin is there. Errors of albedos are those of both sides and are left out.
    pub fn half(&self, below: bool) -> Option<BrdfTable> {
        self.grid.half(below).map(|half| self.part(&half))
    }

    /// The same where it is: theta_r of light that has gone through stays beyond 90 degrees.
    pub fn side(&self, below: bool) -> Option<BrdfTable> {
        self.grid.side(below).map(|side| self.part(&side))
    }

    /// The table as a mirror in the horizon shows its sensor; `None` for half/difference angles.
    pub fn mirrored(&self) -> Option<BrdfTable> {
        self.grid.mirrored().map(|image| self.part(&image))
    }

    fn part(&self, half: &Half) -> BrdfTable {
        let incidences = self.grid.incidences();
        let of = |values: &Vec<f32>| half.of(values, incidences);
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
        BrdfTable {
            colours: self.colours.iter().map(colour).collect(),
            hits: half.of(&self.hits, incidences),
            ..self.header(&half.grid)
        }
    }

    /// The totals of this table and of another with the same light and colours, whose bins, points or patches, follow.
    /// `None` where they do not fit together.
    // Tested by `both_sides_are_put_together` (tests/it/interchange/through.rs).
    pub fn joined(&self, other: &BrdfTable) -> Option<BrdfTable> {
        let lists = |grid: &Grid| matches!(grid.kind, GridKind::Points | GridKind::Patches);
        let bare = |grid: &Grid| Grid { points_deg: vec![], patches_deg: vec![], ..grid.clone() };
        let fits = lists(&self.grid) && bare(&self.grid) == bare(&other.grid);
        let nm = |table: &BrdfTable| table.colours.iter().map(|c| c.wavelength_nm).collect::<Vec<_>>();
        if !fits || nm(self) != nm(other) {
            return None;
        }
        let (a, b) = (self.grid.bins(), other.grid.bins());
        let one = |first: &[f32], second: &[f32]| -> Vec<f32> {
            first
                .chunks(a)
                .zip(second.chunks(b))
                .flat_map(|(first, second)| [first, second].concat())
                .collect()
        };
        let colour = |(first, second): (&ColourChannels, &ColourChannels)| ColourChannels {
            total: one(&first.total, &second.total),
            single: one(&first.single, &second.single),
            multiple: one(&first.multiple, &second.multiple),
            stderr: one(&first.stderr, &second.stderr),
            stderr_single: one(&first.stderr_single, &second.stderr_single),
            wavelength_nm: first.wavelength_nm,
            ..ColourChannels::default()
        };
        let hits = self.hits.chunks(a).zip(other.hits.chunks(b));
        let grid = Grid {
            points_deg: [&self.grid.points_deg[..], &other.grid.points_deg].concat(),
            patches_deg: [&self.grid.patches_deg[..], &other.grid.patches_deg].concat(),
            ..self.grid.clone()
        };
        Some(BrdfTable {
            colours: self.colours.iter().zip(&other.colours).map(colour).collect(),
            hits: hits.flat_map(|(first, second)| [first, second].concat()).collect(),
            ..self.header(&grid)
        })
    }
}

impl Realisations {
    /// The same part of the incidences of `grid` in every realisation; the first of them is that of `first_incidence`.
    pub fn half(&self, grid: &Grid, first_incidence: usize, below: bool) -> Option<Realisations> {
        let half = grid.half(below)?;
        let (bins, incidences) = (grid.bins(), grid.incidences());
        let here = first_incidence * bins..(first_incidence + incidences) * bins;
        let of = |colours: &Vec<Vec<f32>>| {
            colours.iter().map(|values| half.of(&values[here.clone()], incidences)).collect()
        };
        let part = |part: &RealisationPart| RealisationPart {
            total: of(&part.total),
            single: of(&part.single),
            schlick: None,
        };
        Some(Realisations { parts: self.parts.iter().map(part).collect() })
    }
}
