//! Which sums a measurement keeps of its paths, and how the colours of every table follow from them.
//!
//! Every surface sample has the same flux. F = 1 needs nothing but counts. Schlick's reflectance of a path of k bounces is a
//! polynomial in F0, whose parts (`optics::parts`) are summed: they serve every colour and every material. Fresnel's
//! equations, and Schlick's formula beyond `HIGHEST` bounces, are worked out for each colour of each material.

pub mod path_weights;

use std::ops::Range;

use crate::campaign::{Campaign, FresnelLaw, Optics};
use crate::measure::optics::{Kept, reflectances_of};
use crate::optics::fresnel::Fresnel;
use crate::optics::reflectance::Reflectance;

/// Highest order up to which parts are summed: their number grows with the order.
pub const HIGHEST: u32 = 8;

/// Elements of a Mueller matrix, row by row.
pub const ELEMENTS: usize = 16;

/// What is summed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SumKind {
    /// Paths.
    Counts,
    /// The parts of Schlick's polynomial.
    Parts,
    /// The reflectance in every colour.
    Colours,
    /// Paths of every colour by themselves.
    Paths,
}

/// The sums of a campaign.
#[derive(Debug, Clone)]
pub struct FresnelSums {
    sums: SumKind,
    bounces: u32,
    by_order: bool,
    /// Every colour of every material, one after the other.
    reflectances: Vec<Reflectance>,
    /// Colours of each material.
    of_material: Vec<usize>,
    mueller: bool,
}

/// How one colour of a table follows from the sums.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColourSource {
    /// F = 1.
    Unit,
    /// Schlick, from the parts.
    Schlick {
        /// Reflectance at normal incidence.
        f0: f64,
    },
    /// Its own sums.
    Traced {
        /// Its place among the colours of all materials.
        place: usize,
    },
    /// Paths of its own.
    Followed {
        /// Its place among the colours of all materials.
        place: usize,
    },
}

impl FresnelSums {
    /// What a campaign needs.
    pub fn of(campaign: &Campaign) -> Self {
        let of_material = campaign.optics.each().into_iter().map(Optics::colours).collect();
        let schlick = |optics: &&Optics| match optics {
            Optics::Schlick { .. } => true,
            Optics::Index(index) => index.law == FresnelLaw::Schlick,
            Optics::PerfectMirror
            | Optics::Dielectric(_)
            | Optics::Diffuse { .. }
            | Optics::Layered { .. }
            | Optics::Several(_) => false,
        };
        let sums = match campaign.optics {
            Optics::PerfectMirror => SumKind::Counts,
            _ if campaign.optics.lets_through() => SumKind::Paths,
            _ if campaign.trace.bounces <= HIGHEST && campaign.optics.each().iter().all(schlick) => {
                SumKind::Parts
            }
            _ => SumKind::Colours,
        };
        FresnelSums {
            sums,
            bounces: campaign.trace.bounces,
            by_order: campaign.trace.by_order,
            reflectances: reflectances_of(&campaign.optics),
            of_material,
            mueller: campaign.optics.has_mueller(),
        }
    }

    /// The same with the reflectance of every colour followed along the path, as tests compare it with.
    pub fn traced(self) -> Self {
        let follow = matches!(self.sums, SumKind::Counts | SumKind::Paths);
        FresnelSums { sums: if follow { self.sums } else { SumKind::Colours }, ..self }
    }

    /// Highest order.
    pub fn bounces(&self) -> usize {
        self.bounces as usize
    }

    /// Whether every order above 1 is kept by itself.
    pub fn by_order(&self) -> bool {
        self.by_order
    }

    /// What paths keep of their facets.
    pub fn kept(&self) -> Kept {
        Kept { angles: !matches!(self.sums, SumKind::Counts | SumKind::Paths), facets: self.mueller }
    }

    /// The materials of the colours, one after the other.
    pub fn reflectances(&self) -> &[Reflectance] {
        &self.reflectances
    }

    /// Sums for each bin, next to the flux with F = 1.
    pub fn sums_of_a_bin(&self) -> usize {
        self.first_sums() + self.multiple_sums() + self.mueller_sums()
    }

    /// Signed sums for each bin: the 16 elements of the Mueller matrix of each colour, one after the other.
    pub fn mueller_sums(&self) -> usize {
        if self.mueller { ELEMENTS * self.reflectances.len() } else { 0 }
    }

    /// Whether every colour has paths of its own, which may go through the surface.
    pub fn goes_through(&self) -> bool {
        self.sums == SumKind::Paths
    }

    /// Paths that are counted for each start: at clear facets one for each colour, and at order 1 both parts of it.
    pub fn paths_of_a_start(&self) -> u64 {
        match (self.sums, self.bounces) {
            (SumKind::Paths, 1) => 2 * self.reflectances.len() as u64,
            (SumKind::Paths, _) => self.reflectances.len() as u64,
            _ => 1,
        }
    }

    /// Whether every colour has sums of its own.
    pub fn is_traced(&self) -> bool {
        self.sums == SumKind::Colours
    }

    /// Whether Schlick's reflectance for any F0 follows from the sums.
    pub fn serves_any_f0(&self) -> bool {
        let matt = self.reflectances.iter().any(|one| matches!(one.fresnel, Fresnel::Diffuse { .. }));
        self.sums == SumKind::Parts || (self.sums == SumKind::Colours && self.bounces == 1 && !matt)
    }

    /// Colours that have paths of their own, whose arrivals and flux are counted one by one; 1 where all share their paths.
    pub fn hit_sets(&self) -> usize {
        if self.sums == SumKind::Paths { self.reflectances.len() } else { 1 }
    }

    /// The places of a material's colours among those, of all materials where they share their paths.
    pub fn hit_places(&self, material: usize) -> Range<usize> {
        let first: usize = self.of_material[..material].iter().sum();
        if self.sums == SumKind::Paths { first..first + self.of_material[material] } else { 0..1 }
    }

    /// Sums of order 1 for each bin, next to the flux with F = 1: (1-c)^5, and traced colours.
    pub fn first_sums(&self) -> usize {
        match self.sums {
            SumKind::Counts => 0,
            SumKind::Parts => 1,
            SumKind::Colours => 1 + self.reflectances.len(),
            SumKind::Paths => self.reflectances.len(),
        }
    }

    /// Sums of the orders above 1 for each bin.
    pub fn multiple_sums(&self) -> usize {
        (0..self.groups()).map(|group| self.group(group).len()).sum()
    }

    /// Groups of orders above 1 that have sums of their own: each order, or all of them together.
    pub fn groups(&self) -> usize {
        match self.bounces {
            1 => 0,
            bounces if self.by_order => bounces as usize - 1,
            _ => 1,
        }
    }

    /// The sums of a group.
    pub fn group(&self, group: usize) -> Range<usize> {
        let size = |group: usize| match self.sums {
            SumKind::Counts => 1,
            SumKind::Parts => 1 + self.degree(group),
            SumKind::Colours | SumKind::Paths => self.reflectances.len(),
        };
        let first = (0..group).map(size).sum();
        first..first + size(group)
    }

    /// Degree of a group's polynomial.
    fn degree(&self, group: usize) -> usize {
        if self.by_order { group + 2 } else { self.bounces as usize }
    }

    /// Sums of one order for the albedo.
    pub fn order_sums(&self, order: usize) -> usize {
        match self.sums {
            SumKind::Counts => 0,
            SumKind::Parts => order + 1,
            SumKind::Colours | SumKind::Paths => self.reflectances.len(),
        }
    }

    /// The colours of one material's table.
    pub fn colours(&self, material: usize) -> Vec<ColourSource> {
        let first: usize = self.of_material[..material].iter().sum();
        let colour = |place: usize| match (self.sums, self.reflectances[place].fresnel) {
            (SumKind::Counts, _) => ColourSource::Unit,
            (SumKind::Paths, _) => ColourSource::Followed { place },
            (SumKind::Parts, Fresnel::Schlick { f0 }) => ColourSource::Schlick { f0 },
            _ => ColourSource::Traced { place },
        };
        (first..first + self.of_material[material]).map(colour).collect()
    }

    /// Every colour of every material.
    pub fn all_colours(&self) -> Vec<ColourSource> {
        (0..self.of_material.len()).flat_map(|material| self.colours(material)).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::campaign;

    fn sums(optics: &str, trace: &str) -> FresnelSums {
        let text = format!(
            "name = \"w\"\n[surface]\nrealisations = 1\n[surface.ggx]\nalpha = 0.5\n[light]\ntheta_i_deg = [0]\n\
             [sensor.hemisphere]\n{optics}\n[trace]\n{trace}\n[stop]\nsamples = 1\n"
        );
        let parsed = campaign::parse(&text, "w", Path::new("")).unwrap_or_else(|e| panic!("{e}"));
        FresnelSums::of(&parsed.campaign)
    }

    #[test]
    fn sums_lie_side_by_side_without_a_gap() {
        let gold = "[optics]\nmaterial = \"gold\"";
        let exact = "[optics]\nmaterials = [\"gold\", \"silver\"]\nfresnel = \"exact\"";
        // (first, multiple): counts need none next to the flux; parts of degree 4 are 5, of 2 to 4 are 3 + 4 + 5.
        for (optics, trace, first, multiple) in [
            ("", "bounces = 1", 0, 0),
            ("", "bounces = 4\nby_order = true", 0, 3),
            (gold, "bounces = 1", 1, 0),
            (gold, "bounces = 4", 1, 5),
            (gold, "bounces = 4\nby_order = true", 1, 12),
            (gold, "bounces = 9", 4, 3),
            (exact, "bounces = 1", 7, 0),
            (exact, "bounces = 3\nby_order = true", 7, 12),
        ] {
            let sums = sums(optics, trace);
            assert_eq!((sums.first_sums(), sums.multiple_sums()), (first, multiple), "{optics} {trace}");
            let mut next = 0;
            for group in 0..sums.groups() {
                assert_eq!(sums.group(group).start, next);
                next = sums.group(group).end;
            }
        }
        assert!(!sums(gold, "bounces = 9").serves_any_f0());
        assert_eq!(sums(exact, "bounces = 1").all_colours().len(), 6);
    }
}
