//! A Zemax file out of a table: which incidences it has, and what their blocks hold.
//!
//! Between incidences a reader goes straight from block to block at equal angles about the mirror direction, where a
//! lobe grows towards grazing light faster than that. Incidences are therefore added half-way between two others
//! until the albedo of the file is the table's there.

use rayon::prelude::*;

use super::energy::albedo;
use super::tables::{Zemax, about, frame, rotation_deg};
use super::text;
use crate::interchange::resample::sampling::{integral, samples};
use crate::interchange::{Brdf, Checked, Lookup};
use crate::sphere;
use crate::table::BrdfTable;

/// Steps of the azimuth, degrees.
const STEP: f64 = 5.0;
const RADIALS: usize = 91;
/// Half of what an export may be off (`albedo::ALLOWED`): half-way is not quite the worst place.
const NEAR: f64 = 0.005;
/// No gap is halved that is narrower than this, degrees.
const NARROWEST: f64 = 1.0;
/// Values of a file at most (40 MB of text), unless the incidences alone are more.
const MOST_VALUES: usize = 1 << 22;
/// Directions of each kind in an integral: file and table have the same ones, and only their ratio counts.
const SAMPLES: usize = 512;
/// Azimuths of the light at which a gap is looked at, at most.
const AZIMUTHS: usize = 4;

/// An incidence of a file.
struct FileIncidence {
    theta_deg: f64,
    /// By rotation.
    blocks: Vec<IncidenceBlock>,
    /// Nothing is missing between this one and the next.
    is_settled: bool,
}

/// The values of one incidence and rotation.
struct IncidenceBlock {
    values: Vec<f32>,
    /// The table's, where its bins have sizes.
    albedo: Option<f64>,
}

/// The text of a file of a table with one colour, and notes on it; of light that has gone `through` the table is what a
/// mirror in the horizon shows.
///
/// TIS is the table's own albedo where its bins have sizes, interpolated between incidences, and else what the file's
/// values integrate to.
// Tested by `tis_is_the_albedo_of_the_table`, `the_albedo_holds_between_incidences`,
// `zemax_tables_stand_about_the_mirror_direction` (tests/it/interchange/interchange_text.rs).
pub fn write(table: &BrdfTable, through: bool, lookup: &Lookup) -> Checked<(String, Vec<String>)> {
    let isotropic = lookup.is_isotropic();
    // Rotations increase: azimuths fall, but for 0.
    let mut turns: Vec<(f64, usize)> =
        lookup.phi_i().iter().map(|&phi| rotation_deg(deg(phi))).zip(0..).collect();
    turns.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut file = Zemax {
        through,
        symmetric: isotropic,
        rotations: turns.iter().map(|turn| turn.0).collect(),
        azimuths: (0..if isotropic { 37 } else { 72 }).map(|k| STEP * f64::from(k)).collect(),
        // Denser near the mirror direction.
        radials: (0..RADIALS).map(|k| 180.0 * (k as f64 / (RADIALS - 1) as f64).powi(2)).collect(),
        ..Zemax::default()
    };
    let turns: Vec<usize> = turns.iter().map(|turn| turn.1).collect();
    let at_incidence = |ti: usize| {
        let blocks = turns.par_iter().map(|&pi| IncidenceBlock {
            values: incidence_values(&file, lookup, (ti, pi)),
            albedo: albedo(table, lookup.theta_i()[ti], lookup.phi_i()[pi]),
        });
        FileIncidence { theta_deg: deg(lookup.theta_i()[ti]), blocks: blocks.collect(), is_settled: false }
    };
    let mut incidences: Vec<FileIncidence> = (0..lookup.theta_i().len()).map(at_incidence).collect();
    loop {
        let notes = fill(&mut file, &incidences);
        let added = missing(&file, lookup, &mut incidences);
        if added.is_empty() {
            return Ok((text::text(&file), notes));
        }
        // Of lobes narrower than the bins the integral of the interpolant is uncertain: it makes no light where the
        // table does not.
        let most = incidences.iter().flat_map(|incidence| &incidence.blocks).map(|block| block.albedo);
        let most = most.collect::<Option<Vec<f64>>>().map(|all| all.into_iter().fold(1.0, f64::max));
        incidences.extend(added.into_iter().map(|theta_deg| between(&file, lookup, &turns, theta_deg, most)));
        incidences.sort_by(|a, b| a.theta_deg.total_cmp(&b.theta_deg));
    }
}

fn deg(angle: f64) -> f64 {
    (angle.to_degrees() * 1e9).round() / 1e9
}

/// Puts incidences into a file, their values scaled to their albedos; notes on that.
fn fill(file: &mut Zemax, incidences: &[FileIncidence]) -> Vec<String> {
    file.light = incidences.iter().map(|incidence| incidence.theta_deg).collect();
    let by_turn = |turn: usize| incidences.iter().map(move |incidence| &incidence.blocks[turn]);
    let blocks: Vec<&IncidenceBlock> = (0..file.rotations.len()).flat_map(by_turn).collect();
    file.values = vec![blocks.iter().flat_map(|block| block.values.iter().copied()).collect()];
    let integrals = file.integrals(0);
    let tis: Vec<f64> =
        blocks.iter().zip(&integrals).map(|(block, &sum)| block.albedo.unwrap_or(sum)).collect();
    let notes = file.hold_energy(&tis, &integrals).into_iter().collect();
    file.tis = vec![tis];
    notes
}

/// The middles of gaps in which the file's albedo is not the table's, the worst first, as many as there is room for.
fn missing(file: &Zemax, lookup: &Lookup, incidences: &mut [FileIncidence]) -> Vec<f64> {
    let gap = |k: usize| (incidences[k].theta_deg, incidences[k + 1].theta_deg);
    let open: Vec<usize> = (0..incidences.len() - 1)
        .filter(|&k| !incidences[k].is_settled && gap(k).1 - gap(k).0 >= NARROWEST)
        .collect();
    let middle = |k: usize| 0.5 * (gap(k).0 + gap(k).1);
    let mut found: Vec<(f64, f64)> =
        open.par_iter().map(|&k| (off(file, lookup, middle(k)), middle(k))).collect();
    found.retain(|&(off, _)| off > NEAR);
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let size = file.rotations.len() * file.azimuths.len() * file.radials.len();
    found.truncate((MOST_VALUES / size).saturating_sub(incidences.len()));
    let added: Vec<f64> = found.into_iter().map(|(_, theta_deg)| theta_deg).collect();
    for k in open.into_iter().rev() {
        let middle = 0.5 * (incidences[k].theta_deg + incidences[k + 1].theta_deg);
        incidences[k].is_settled = !added.contains(&middle);
    }
    added
}

/// The largest |file/table - 1| of the albedos under light from this polar angle.
fn off(file: &Zemax, lookup: &Lookup, theta_deg: f64) -> f64 {
    let phis = lookup.phi_i();
    let at = |&phi: &f64| {
        let wi = sphere::direction(theta_deg.to_radians(), phi);
        let to = samples(wi, lookup.guide().lobe(), SAMPLES);
        let [table, found] = [integral(&to, |wo| lookup.brdf(wi, wo)), integral(&to, |wo| file.brdf(wi, wo))];
        if table[0] > 0.0 { (found[0] / table[0] - 1.0).abs() } else { 0.0 }
    };
    phis.iter().step_by(phis.len().div_ceil(AZIMUTHS)).map(at).fold(0.0, f64::max)
}

/// The values at an incidence.
fn incidence_values(file: &Zemax, lookup: &Lookup, incidence: (usize, usize)) -> Vec<f32> {
    let (theta, phi) = (lookup.theta_i()[incidence.0], lookup.phi_i()[incidence.1]);
    values(file, theta, |out| {
        lookup.values().at_incidence(incidence, phi, sphere::turned(out, phi.sin_cos()))[0]
    })
}

/// An incidence between those of the table, of no larger albedo than `most`; `None` where bins have no sizes.
fn between(
    file: &Zemax,
    lookup: &Lookup,
    turns: &[usize],
    theta_deg: f64,
    most: Option<f64>,
) -> FileIncidence {
    let theta = theta_deg.to_radians();
    let block = |&pi: &usize| {
        let phi = lookup.phi_i()[pi];
        let wi = sphere::direction(theta, phi);
        let values = values(file, theta, |out| lookup.brdf(wi, sphere::turned(out, phi.sin_cos()))[0]);
        let to = samples(wi, lookup.guide().lobe(), SAMPLES);
        let albedo = most.map(|most| integral(&to, |wo| lookup.brdf(wi, wo))[0].min(most));
        IncidenceBlock { values, albedo }
    };
    FileIncidence { theta_deg, blocks: turns.par_iter().map(block).collect(), is_settled: false }
}

/// The values of a block; `value` is that of a direction seen with the light at azimuth 0.
fn values(file: &Zemax, theta: f64, value: impl Fn(glam::DVec3) -> f64) -> Vec<f32> {
    let at = |azimuth: f64, radial: f64| {
        let out = about(frame(theta), azimuth, radial);
        if out.z > 0.0 { value(out) as f32 } else { 0.0 }
    };
    let row = |&azimuth: &f64| file.radials.iter().map(move |&radial| (azimuth, radial));
    file.azimuths.iter().flat_map(row).map(|(azimuth, radial)| at(azimuth, radial)).collect()
}
