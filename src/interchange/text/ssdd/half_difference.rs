//! SSDD over half/difference angles: a table of them where f(wi, wo) = f(wo, wi), else a function.

use super::azimuths::{check_round, check_whole, merged};
use super::header::SsddHeader;
use crate::instrument::{Grid, GridKind};
use crate::interchange::content::half_difference::{HalfDifference, default_arms};
use crate::interchange::text::azimuths::Azimuths;
use crate::interchange::text::samples::alike;
use crate::interchange::{Brdf, Checked, Imported, spectral_table};
use crate::table::{BrdfTable, check_grid};

/// Cosines below this are those of arms on the horizon.
const HORIZON: f64 = 1e-9;

/// What a file holds, and notes on it.
pub fn imported(header: &SsddHeader, total: &[Vec<f32>]) -> Checked<(Imported, Vec<String>)> {
    let turn = if header.reciprocal { 180.0 } else { 360.0 };
    let round = Azimuths::of(header.list(1, [0.0, 360.0])?, 360.0, false);
    check_round(&round)?;
    let most = if header.bilateral { 0.5 * turn } else { turn };
    let about = Azimuths::of(header.list(3, [0.0, most])?, turn, header.bilateral);
    check_whole(&about, turn)?;
    let mut notes = vec![];
    let alone = round.angles.len() == 1;
    if alone && header.anisotropic {
        notes.push("PARAM1_LIST has one azimuth, which stands for all: read as isotropic".to_string());
    }
    let (values, seam) = merged(total, header.sizes(), &round, &about);
    notes.extend(seam);
    let grid = Grid {
        kind: GridKind::HalfDifference,
        theta_h_deg: header.list(0, [0.0, 90.0])?.to_vec(),
        phi_h_deg: if alone { vec![0.0] } else { round.angles },
        theta_d_deg: header.list(2, [0.0, 90.0])?.to_vec(),
        phi_d_deg: about.angles,
        ..Grid::default()
    };
    let (grid, values) = match header.reciprocal {
        true => (grid, values),
        false => match halved(&grid, &values) {
            Some(half) => half,
            None => return Ok((function(header, grid, &values)?, notes)),
        },
    };
    check_grid(&grid)?;
    Ok((Imported::Table(with_gaps(spectral_table(grid, values, &header.wavelengths_nm)?)), notes))
}

/// The half of a whole turn of phi_d, if the other half has the same azimuths and values, the arms exchanged.
fn halved(grid: &Grid, values: &[Vec<f32>]) -> Option<(Grid, Vec<Vec<f32>>)> {
    let (phi_d, count) = (&grid.phi_d_deg, grid.phi_d_deg.len());
    if count == 1 && phi_d[0] < 180.0 {
        return Some((grid.clone(), values.to_vec()));
    }
    let half = phi_d.iter().take_while(|&&phi| phi < 180.0).count();
    let pairs = phi_d[..half].iter().zip(&phi_d[half..]);
    if 2 * half != count || pairs.into_iter().any(|(a, b)| (b - a - 180.0).abs() > 1e-6) {
        return None;
    }
    let mut all = values.iter().flat_map(|values| values.chunks(count)).map(|row| row.split_at(half));
    let same = all.all(|(a, b)| a.iter().zip(b).all(|(&a, &b)| alike(a.into(), b.into())));
    let first = |values: &Vec<f32>| values.chunks(count).flat_map(|row| &row[..half]).copied().collect();
    let grid = Grid { phi_d_deg: phi_d[..half].to_vec(), ..grid.clone() };
    same.then(|| (grid, values.iter().map(first).collect()))
}

/// The function of values that are not reciprocal.
fn function(header: &SsddHeader, grid: Grid, values: &[Vec<f32>]) -> Checked<Imported> {
    let table = with_gaps(spectral_table(grid, values.to_vec(), &header.wavelengths_nm)?);
    let arms = default_arms(table.grid.is_isotropic());
    let part = |values: &[Vec<f32>]| -> Box<dyn Brdf> {
        Box::new(HalfDifference::directed(&table.grid, values.to_vec(), &table.hits))
    };
    let wavelengths_nm = header.wavelengths_nm.clone();
    Ok(Imported::Function { parts: values.chunks(3).map(part).collect(), wavelengths_nm, grid: arms })
}

/// A zero of an arm on or below the horizon is a gap.
fn with_gaps(mut table: BrdfTable) -> BrdfTable {
    let bins = table.grid.bins();
    for at in 0..table.hits.len() {
        if table.colours.iter().all(|colour| colour.total[at] == 0.0) {
            let (wi, wo) = table.grid.arms_of_half(at / bins, at % bins);
            if wi.z <= HORIZON || wo.z <= HORIZON {
                table.set_gap(at);
            }
        }
    }
    table
}
