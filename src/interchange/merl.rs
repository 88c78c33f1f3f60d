//! MERL `.binary`: isotropic, 90 x 90 x 180 half/difference cells, three colours.
//!
//! Three int32 (90, 90, 180), then f64 [colour][theta_h][theta_d][phi_d], divided by a scale for each colour.
//! theta_h = 90 (i/90)^2 degrees, theta_d = i, phi_d = i degrees; phi_d and phi_d + 180 are one cell. The format does
//! not say where in its cell a value lies: [`Sampling`]. Layout: the MERL BRDF database's reader (Matusik et al. 2003).

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use rayon::prelude::*;

use super::{Brdf, Colour, Lookup, Reason};
use crate::instrument::Grid;
use crate::sphere;

/// Cells along theta_h, theta_d, phi_d.
const SIZE: [usize; 3] = [90, 90, 180];
const CELLS: usize = SIZE[0] * SIZE[1] * SIZE[2];
/// Bytes of a file: 34,992,012.
pub const BYTES: usize = 12 + 3 * 8 * CELLS;
const SCALE: Colour = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
/// What stands in cells that no pair of directions above the horizon has.
const INVALID: f64 = -1.0;

/// Where in its cell a value lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// At the lower corner: for readers that interpolate. theta_h = 0 is stored exactly.
    #[default]
    Node,
    /// In the middle of the index: for readers that take the cell as it is.
    Centre,
}

impl Sampling {
    fn offset(self) -> f64 {
        if self == Sampling::Node { 0.0 } else { 0.5 }
    }

    /// How the values are meant.
    pub fn convention(self) -> String {
        let (word, reader) = match self {
            Sampling::Node => ("nodes (index i is the angle of i)", "interpolating readers"),
            Sampling::Centre => ("centres (index i is the angle of i + 0.5)", "nearest-cell readers"),
        };
        format!(
            "BRDF in 1/sr, no cosine, divided by 1/1500, 1.15/1500, 1.66/1500 for R, G, B; half/difference angles, \
             isotropic; cell values at {word}, for {reader}; -1 where a direction is below the horizon"
        )
    }
}

/// The directions of fractional indices, azimuth of the half vector 0.
fn directions([ih, id, ip]: [f64; 3]) -> (DVec3, DVec3) {
    let theta_h = FRAC_PI_2 * (ih / SIZE[0] as f64).powi(2);
    let (theta_d, phi_d) = (FRAC_PI_2 * id / SIZE[1] as f64, PI * ip / SIZE[2] as f64);
    let d = sphere::direction(theta_d, phi_d);
    let (sin, cos) = theta_h.sin_cos();
    let h = DVec3::new(sin, 0.0, cos);
    let wi = DVec3::new(cos * d.x + sin * d.z, d.y, cos * d.z - sin * d.x);
    (wi, 2.0 * wi.dot(h) * h - wi)
}

/// Fractional indices of a pair, phi_d in [0, 180).
///
/// Held by: `indices_and_directions_agree`, `every_cell_lies_where_the_layout_says` (tests/interchange_merl.rs).
fn indices(wi: DVec3, wo: DVec3) -> [f64; 3] {
    let h = (wi + wo).normalize();
    let (theta_h, phi_h) = (sphere::theta(h), sphere::phi(h));
    let turned = sphere::turned(wi, (-phi_h.sin(), phi_h.cos()));
    let (sin, cos) = theta_h.sin_cos();
    let d = DVec3::new(cos * turned.x - sin * turned.z, turned.y, sin * turned.x + cos * turned.z);
    let phi_d = sphere::phi(d) % PI;
    [
        SIZE[0] as f64 * (theta_h / FRAC_PI_2).sqrt(),
        SIZE[1] as f64 * sphere::theta(d) / FRAC_PI_2,
        SIZE[2] as f64 * phi_d / PI,
    ]
}

/// Refuses anisotropic tables.
pub fn check(grid: &Grid) -> Reason<()> {
    if grid.phi_r_relative && grid.phi_i_deg.len() == 1 {
        return Ok(());
    }
    Err("the table is anisotropic, and MERL files have no azimuth of the half vector; measure with azimuth = \
         \"relative\" (average_azimuth = true), or export to a format of four dimensions (rgl, ssdd, tensor_tree)"
        .into())
}

/// The bytes of a file of an isotropic table; one of one colour has it in all three. Both arms of a pair are one cell: their mean.
pub fn write(lookup: &Lookup, sampling: Sampling) -> Vec<u8> {
    let colours = lookup.colours();
    let cell = |at: usize| -> Colour {
        let index = [at / (SIZE[1] * SIZE[2]), at / SIZE[2] % SIZE[1], at % SIZE[2]];
        let (wi, wo) = directions(index.map(|i| i as f64 + sampling.offset()));
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return [INVALID; 3];
        }
        let (there, back) = (lookup.brdf(wi, wo), lookup.brdf(wo, wi));
        std::array::from_fn(|c| 0.5 * (there[c.min(colours - 1)] + back[c.min(colours - 1)]) / SCALE[c])
    };
    let cells: Vec<Colour> = (0..CELLS).into_par_iter().map(cell).collect();
    let mut bytes = Vec::with_capacity(BYTES);
    SIZE.iter().for_each(|&side| bytes.extend((side as i32).to_le_bytes()));
    for colour in 0..3 {
        cells.iter().for_each(|cell| bytes.extend(cell[colour].to_le_bytes()));
    }
    bytes
}

/// A file as a function: linear between its values, invalid ones left out.
pub struct Merl {
    values: Vec<f32>,
    sampling: Sampling,
    /// Share of the values that are negative: marks of "below the horizon".
    pub invalid: f64,
}

/// Reads the bytes of a file.
///
/// Refused: another length, another size of the grid, values that are not finite. Held by:
/// `damaged_files_are_refused` (tests/interchange_merl.rs).
pub fn read(bytes: &[u8], sampling: Sampling) -> Reason<Merl> {
    let side = |k: usize| bytes.get(4 * k..4 * k + 4).map(|b| i32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let sides = [side(0), side(1), side(2)];
    if sides != SIZE.map(|side| Some(side as i32)) {
        return Err(match sides {
            [Some(h), Some(d), Some(p)] => {
                format!("says {h} x {d} x {p} cells, a MERL file has 90 x 90 x 180")
            }
            _ => format!("{} bytes are too few for a MERL file", bytes.len()),
        });
    }
    if bytes.len() != BYTES {
        return Err(format!("{} bytes, a MERL file has {BYTES}", bytes.len()));
    }
    let mut values = Vec::with_capacity(3 * CELLS);
    let mut invalid = 0;
    for (at, chunk) in bytes[12..].as_chunks::<8>().0.iter().enumerate() {
        let value = f64::from_le_bytes(*chunk) * SCALE[at / CELLS];
        let stored = value as f32;
        if !stored.is_finite() {
            return Err(format!("value {at} is {value}, no finite BRDF"));
        }
        invalid += usize::from(stored < 0.0);
        values.push(stored);
    }
    if invalid == values.len() {
        return Err("every value is marked invalid".into());
    }
    Ok(Merl { values, sampling, invalid: invalid as f64 / (3 * CELLS) as f64 })
}

impl Brdf for Merl {
    fn colours(&self) -> usize {
        3
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let found = indices(wi, wo).map(|index| index - self.sampling.offset());
        // Below the first node and above the last the end values hold; phi_d wraps into the other arm's half.
        let clamped = |index: f64, last: usize| index.clamp(0.0, last as f64);
        let [h, d] = [clamped(found[0], SIZE[0] - 1), clamped(found[1], SIZE[1] - 1)];
        let (h0, d0, p0) = (h as usize, d as usize, found[2].floor());
        // The nodes along theta_h lie at squares: the fraction is one of angles, not of indices.
        let square = |index: usize| (index as f64 + self.sampling.offset()).powi(2);
        let at = (h + self.sampling.offset()).powi(2);
        let fractions = [(at - square(h0)) / (square(h0 + 1) - square(h0)), d - d0 as f64, found[2] - p0];
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for corner in 0..8 {
            let step = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight: f64 =
                step.iter().zip(fractions).map(|(&s, f)| if s == 1 { f } else { 1.0 - f }).product();
            let (h, d) = ((h0 + step[0]).min(SIZE[0] - 1), (d0 + step[1]).min(SIZE[1] - 1));
            let p = (p0 as isize + step[2] as isize).rem_euclid(SIZE[2] as isize) as usize;
            let cell = (h * SIZE[1] + d) * SIZE[2] + p;
            if weight == 0.0 || self.values[cell] < 0.0 {
                continue;
            }
            weights += weight;
            for (colour, sum) in sum.iter_mut().enumerate() {
                *sum += weight * f64::from(self.values[colour * CELLS + cell].max(0.0));
            }
        }
        if weights > 0.0 { sum.map(|s| s / weights) } else { sum }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_and_directions_agree() {
        for index in [[10.0, 20.0, 30.0], [3.5, 44.5, 100.5], [60.0, 10.0, 179.0], [25.0, 30.0, 0.5]] {
            let (wi, wo) = directions(index);
            for (found, wanted) in indices(wi, wo).into_iter().zip(index) {
                // Angles to a few ulp; the square root at small theta_h and the azimuth at small theta_d lose some.
                assert!((found - wanted).abs() < 1e-10, "{index:?}: {found} {wanted}");
            }
            // The arms exchanged are the same cell.
            let back = indices(wo, wi);
            assert!(back.iter().zip(index).all(|(found, wanted)| (found - wanted).abs() < 1e-10), "{back:?}");
        }
    }
}
