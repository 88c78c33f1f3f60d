//! A table of Klems patches as a function of two directions: constant over each pair of patches.

use glam::DVec3;

use crate::instrument::klems::{Basis, Ring, middles, patches, rings_of};
use crate::instrument::{Grid, GridKind};
use crate::interchange::{Brdf, Checked, Colour};
use crate::sphere;
use crate::table::BrdfTable;

/// Directions nearer to a border than this belong to both sides, degrees: files in radians carry twelve digits.
const BORDER_DEG: f64 = 1e-9;

/// The geometry of a matrix: incidences in the middle of the light's patches.
pub fn grid(light: &[[f64; 4]], sensor: Vec<[f64; 4]>) -> Grid {
    Grid { kind: GridKind::Patches, incidences_deg: middles(light), patches_deg: sensor, ..Grid::default() }
}

/// The bases of a table whose incidences are the middles of patches: of the light, and of the sensor.
pub fn bases_of(table: &Grid) -> Option<[Vec<Ring>; 2]> {
    let sensor = if table.kind == GridKind::Patches { rings_of(&table.patches_deg)? } else { return None };
    let named = Basis::ALL.iter().map(|basis| basis.rings().to_vec());
    let other = Grid { incidences_deg: vec![], patches_deg: vec![], ..table.clone() };
    if other != (Grid { kind: GridKind::Patches, ..Grid::default() }) {
        return None;
    }
    // A ring below the horizon is 180 degrees less one above, to a rounding.
    let near = |(a, b): (&[f64; 2], &[f64; 2])| a.iter().zip(b).all(|(a, b)| (a - b).abs() < BORDER_DEG);
    let is_own = |rings: &Vec<Ring>| {
        let incidences = middles(&patches(rings));
        incidences.len() == table.incidences_deg.len()
            && incidences.iter().zip(&table.incidences_deg).all(near)
    };
    Some([std::iter::once(sensor.clone()).chain(named).find(is_own)?, sensor])
}

/// A matrix as a function: the value of the patches that hold the directions; on a border, the mean of both sides, as
/// which side a rounding falls to is nobody's choice.
// Tested by `directions_on_a_border_take_both_sides` (tests/it/interchange/interchange_radiance.rs).
pub struct Patchwise {
    light: Vec<Ring>,
    sensor: Vec<Ring>,
    table: BrdfTable,
}

impl Patchwise {
    /// Of a table of patches whose incidences are the middles of patches.
    pub fn new(table: BrdfTable) -> Checked<Self> {
        let [light, sensor] = bases_of(&table.grid)
            .ok_or("the patches are no Klems basis: rings from the normal to the horizon, of even steps")?;
        Ok(Patchwise { light, sensor, table })
    }
}

/// The patches about a direction, one for each of the four sides that it may lie on.
fn around(rings: &[Ring], w: DVec3) -> [usize; 4] {
    let (theta, phi) = (sphere::theta(w).to_degrees(), sphere::phi(w).to_degrees());
    let side = |theta: f64, phi: f64| {
        let within = rings.iter().position(|ring| theta < ring.1).unwrap_or(rings.len() - 1);
        let before: usize = rings[..within].iter().map(|ring| ring.2).sum();
        let count = rings[within].2;
        // Patch j reaches half a step to each side of 360 j/n.
        before + (phi / 360.0 * count as f64 + 0.5).rem_euclid(count as f64) as usize % count
    };
    [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)]
        .map(|(t, p)| side(theta + t * BORDER_DEG, phi + p * BORDER_DEG))
}

impl Brdf for Patchwise {
    fn colours(&self) -> usize {
        self.table.colours.len()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let incidences = around(&self.light, DVec3::new(-wi.x, -wi.y, wi.z));
        let bins = around(&self.sensor, wo);
        let mut sum = [0.0; 3];
        for at in
            incidences.iter().flat_map(|incidence| bins.map(|bin| incidence * self.table.grid.bins() + bin))
        {
            let colours = &self.table.colours;
            sum.iter_mut().zip(colours).for_each(|(s, colour)| *s += f64::from(colour.total[at]) / 16.0);
        }
        sum
    }
}
