//! The instrument of a budget: measures pairs of directions again and again, on the same patches and random numbers.

use std::collections::BTreeMap;

use glam::DVec2;

use super::positions::Position;
use crate::campaign::{Azimuth, Campaign, Dielectric, Optics, Polarisation, Quantity, RefractiveIndex, Stop};
use crate::error::{Error, Result};
use crate::files::memory::memory_limit;
use crate::instrument::{Grid, GridKind};
use crate::measure::{self, Measured, Patches};
use crate::sphere;

/// What of the instrument differs from the campaign besides directions; factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Of all slopes of the surface.
    pub slopes: f64,
    /// Of the half-angle of the light's cone.
    pub cone: f64,
    /// Of that of the sensor's aperture.
    pub aperture: f64,
    /// Of the constants of the material.
    pub optics: OpticsChange,
}

/// What constants of a material become: value x factor + shift, in the order n, k, reflectance (f0 or albedo).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpticsChange {
    /// 1 where nothing changes.
    pub factors: [f64; 3],
    /// 0 where nothing changes.
    pub shifts: [f64; 3],
}

impl OpticsChange {
    /// The material as it is.
    pub const NONE: OpticsChange = OpticsChange { factors: [1.0; 3], shifts: [0.0; 3] };

    /// The place of a constant among the three.
    pub fn place(quantity: Quantity) -> usize {
        match quantity {
            Quantity::N => 0,
            Quantity::K => 1,
            _ => 2,
        }
    }

    fn of(&self, place: usize, value: &mut f64) {
        *value = *value * self.factors[place] + self.shifts[place];
    }

    /// The material with its constants changed; `None` where it would be none: n or k not above 0, reflectances not below 1.
    pub fn applied(&self, optics: &Optics) -> Option<Optics> {
        let mut changed = optics.clone();
        let mut possible = true;
        match &mut changed {
            Optics::Schlick { f0: all, .. } | Optics::Diffuse { albedo: all } => {
                all.iter_mut().for_each(|value| self.of(2, value));
                possible &= all.iter().all(|value| (0.0..=1.0).contains(value));
            }
            Optics::Layered { albedo, eta } => {
                albedo.iter_mut().for_each(|value| self.of(2, value));
                self.of(0, eta);
                possible &= *eta > 1.0 && albedo.iter().all(|value| (0.0..=1.0).contains(value));
            }
            Optics::Index(RefractiveIndex { media, .. }) | Optics::Dielectric(Dielectric { media, .. }) => {
                for medium in media {
                    self.of(0, &mut medium.eta);
                    self.of(1, &mut medium.k);
                    possible &= medium.eta > 0.0 && medium.k >= 0.0;
                }
            }
            Optics::PerfectMirror | Optics::Several(_) => {}
        }
        possible.then_some(changed)
    }
}

impl Setting {
    /// The campaign's own.
    pub const NOMINAL: Setting =
        Setting { slopes: 1.0, cone: 1.0, aperture: 1.0, optics: OpticsChange::NONE };
}

/// A pair of directions to be measured, and the one whose random numbers it uses.
#[derive(Debug, Clone, Copy)]
pub struct Wanted {
    /// `None`: its own, as `measure` draws them.
    pub drawn_as: Option<Position>,
    /// Where the arms stand.
    pub at: Position,
}

/// What was measured of a pair of directions.
#[derive(Debug, Clone)]
pub struct Seen {
    /// BRDF in 1/sr: \[colour\]\[realisation\].
    pub brdf: Vec<Vec<f64>>,
    /// Paths that arrived.
    pub hits: u64,
    /// By colour, what light over the edge of an open map may add at most; empty without an edge.
    pub left_map: Vec<f64>,
}

/// A campaign, ready to be measured anywhere.
pub struct Rig {
    campaign: Campaign,
    aperture_deg: f64,
    patches: Patches,
    /// Slopes of a measured map per difference of heights.
    map_slopes: Option<DVec2>,
    memory: u64,
    /// Of the patches, once the first run has been planned.
    size: Option<(f64, f64)>,
}

impl Rig {
    /// With so many surface samples per incidence and realisation. `notes` gets what an imported map had to say.
    ///
    /// Errors: those of making patches.
    pub fn new(
        campaign: &Campaign,
        aperture_deg: f64,
        samples: u64,
        notes: &mut Vec<String>,
    ) -> Result<Self> {
        let mut campaign = campaign.clone();
        campaign.stop = Stop { samples, relative_error: None, seconds: None };
        match &mut campaign.optics {
            Optics::Index(RefractiveIndex { polarisation, .. })
            | Optics::Dielectric(Dielectric { polarisation, .. })
                if *polarisation == Polarisation::Mueller =>
            {
                // The same reflectance without the matrix beside it.
                *polarisation = Polarisation::None;
            }
            _ => {}
        }
        let memory = memory_limit();
        let patches = Patches::prepare(&campaign, notes)?.for_bands(&campaign, memory)?;
        let map_slopes = match &patches {
            Patches::Map { map, .. } => Some(DVec2::new(map.alpha_x, map.alpha_y)),
            _ => None,
        };
        Ok(Rig { campaign, aperture_deg, patches, map_slopes, memory, size: None })
    }

    /// The campaign that is measured.
    pub fn campaign(&self) -> &Campaign {
        &self.campaign
    }

    /// Half-angles of the light's cone and of the sensor's aperture, degrees.
    pub fn half_angles_deg(&self) -> [f64; 2] {
        [self.campaign.light.aperture_deg, self.aperture_deg]
    }

    /// Cells of a measured map for each of its file's own along a side.
    pub fn map_steps(&self) -> Option<usize> {
        match &self.patches {
            Patches::Map { map, .. } => Some(map.steps),
            _ => None,
        }
    }

    /// Pairs of directions as `measure` draws them.
    ///
    /// Errors: as [`Self::read`].
    pub fn read_anew(&mut self, positions: &[Position]) -> Result<Vec<Seen>> {
        let wanted: Vec<Wanted> = positions.iter().map(|&at| Wanted { drawn_as: None, at }).collect();
        self.read(&Setting::NOMINAL, &wanted)
    }

    /// Pairs of directions at a setting, with the random numbers that they have when they are moved.
    ///
    /// Errors: as [`Self::read`].
    pub fn read_as_moved(&mut self, setting: &Setting, positions: &[Position]) -> Result<Vec<Seen>> {
        let wanted: Vec<Wanted> = positions.iter().map(|&at| Wanted { drawn_as: Some(at), at }).collect();
        self.read(setting, &wanted)
    }

    /// The wanted pairs of directions, in their order.
    ///
    /// Errors: as `measure::plan` and `measure::measure`.
    pub fn read(&mut self, setting: &Setting, wanted: &[Wanted]) -> Result<Vec<Seen>> {
        // A map takes longest to be laid out: all incidences at once. Elsewhere facets are sought for apertures: those of one
        // incidence alone.
        let at_once = self.campaign.surface.kind.is_map();
        let mut groups: BTreeMap<([u64; 3], [u64; 2]), Vec<usize>> = BTreeMap::new();
        for (place, one) in wanted.iter().enumerate() {
            let [theta, phi] = one.drawn_as.map(|position| light_bits(&position)).unwrap_or_default();
            let own = if at_once { [0; 2] } else { light_bits(&one.at) };
            groups.entry(([u64::from(one.drawn_as.is_some()), theta, phi], own)).or_default().push(place);
        }
        let campaign = self.set(setting)?;
        let aperture_deg = self.aperture_deg * setting.aperture;
        let mut seen: Vec<Option<Seen>> = vec![None; wanted.len()];
        for places in groups.values() {
            let positions: Vec<Position> = places.iter().map(|&place| wanted[place].at).collect();
            let found = self.run(&campaign, aperture_deg, wanted[places[0]].drawn_as, &positions)?;
            for (&place, found) in places.iter().zip(found) {
                seen[place] = Some(found);
            }
        }
        seen.into_iter()
            .collect::<Option<Vec<Seen>>>()
            .ok_or_else(|| Error::Internal("a pair of directions was not measured".into()))
    }

    /// The campaign of a setting; slopes of a measured map are set in the map itself.
    fn set(&mut self, setting: &Setting) -> Result<Campaign> {
        let mut campaign = self.campaign.clone();
        campaign.light.aperture_deg *= setting.cone;
        let optics = setting.optics.applied(&campaign.optics);
        campaign.optics = optics.ok_or_else(|| Error::Internal("constants of no material".into()))?;
        for alpha in campaign.surface.kind.alphas_mut().into_iter().flatten() {
            alpha.x *= setting.slopes;
            alpha.y *= setting.slopes;
        }
        if let (Patches::Map { map, .. }, Some(slopes)) = (&mut self.patches, self.map_slopes) {
            (map.alpha_x, map.alpha_y) = (setting.slopes * slopes).into();
        }
        Ok(campaign)
    }

    /// One run: every incidence with every direction of the sensor, of which the pairs are taken.
    fn run(
        &mut self,
        campaign: &Campaign,
        aperture_deg: f64,
        drawn_as: Option<Position>,
        positions: &[Position],
    ) -> Result<Vec<Seen>> {
        let averaged = campaign.light.azimuth == Azimuth::Relative;
        let (mut lights, mut points) = (AngleList::default(), AngleList::default());
        let place = |position: &Position| {
            let Position { theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg } = *position;
            let from = if averaged { phi_i_deg } else { 0.0 };
            let light = lights.place([theta_i_deg, phi_i_deg - from]);
            (light, points.place([theta_r_deg, sphere::reduced_deg(phi_r_deg - from)]))
        };
        let places: Vec<(usize, usize)> = positions.iter().map(place).collect();
        let grid = Grid {
            kind: GridKind::Points,
            incidences_deg: lights.all,
            phi_r_relative: averaged,
            points_deg: points.all,
            aperture_deg: Some(aperture_deg),
            ..Grid::default()
        };
        let mut campaign = campaign.clone();
        campaign.light.theta_i_deg = grid.incidences_deg.iter().map(|light| light[0]).collect();
        let drawn_at = drawn_as.map(|position| (position.theta_i_deg, position.phi_i_deg));
        let plan = measure::plan_at(&campaign, grid, drawn_at, self.size, self.memory)?;
        self.size = Some((plan.cells, plan.relief));
        let (mut tables, _) = measure::measure(&campaign, &plan, &self.patches, &|_| ())?;
        let measured = tables.pop().ok_or_else(|| Error::Internal("a budget measured no table".into()))?;
        // Of clear facets every colour has paths of its own.
        let colours = measured.table.colours.len().max(1) as u64;
        let paths_of_a_hit = if campaign.optics.lets_through() { colours } else { 1 };
        let bins = measured.table.grid.bins();
        let seen =
            |&(light, point): &(usize, usize)| seen_at(&measured, light * bins + point, paths_of_a_hit);
        Ok(places.iter().map(seen).collect())
    }
}

fn seen_at(measured: &Measured, at: usize, paths_of_a_hit: u64) -> Seen {
    let (table, parts) = (&measured.table, &measured.realisations.parts);
    let brdf = |colour: usize| parts.iter().map(|part| f64::from(part.total[colour][at])).collect();
    let left_map = table.colours.iter().filter_map(|colour| colour.left_map.get(at));
    Seen {
        brdf: (0..table.colours.len()).map(brdf).collect(),
        hits: u64::from(table.hits[at]) / paths_of_a_hit,
        left_map: left_map.map(|&value| f64::from(value)).collect(),
    }
}

fn light_bits(position: &Position) -> [u64; 2] {
    [position.theta_i_deg, position.phi_i_deg].map(f64::to_bits)
}

/// Pairs of angles, each once.
#[derive(Default)]
struct AngleList {
    all: Vec<[f64; 2]>,
    places: BTreeMap<[u64; 2], usize>,
}

impl AngleList {
    fn place(&mut self, angles: [f64; 2]) -> usize {
        *self.places.entry(angles.map(f64::to_bits)).or_insert_with(|| {
            self.all.push(angles);
            self.all.len() - 1
        })
    }
}
