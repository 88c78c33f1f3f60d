//! Files that speak of both sides of a surface: what their blocks say, put together.

use super::brdf::{Brdf, TwoSided};
use super::half_difference::default_arms;
use super::imported::{Imported, function_of};
use crate::campaign::SensorSide;
use crate::error::Checked;
use crate::instrument::{Grid, GridKind};
use crate::interchange::resample::{gaps, thirds};
use crate::table::BrdfTable;

/// Functions of three colours each, their wavelengths, and what was filled in.
pub type Functions = (Vec<Box<dyn Brdf>>, Vec<f64>, Vec<String>);

/// The same with a grid that suits them.
type OnGrid = (Vec<Box<dyn Brdf>>, Vec<f64>, Grid);

/// The block of light that comes back, and that of light that has gone through, as a mirror in the horizon shows it; at
/// least one is there. A table where both list directions under the same light, else a function.
// Tested by `both_sides_are_put_together` (tests/it/interchange/through.rs).
pub fn put_together(blocks: [Option<Imported>; 2]) -> Checked<Imported> {
    let (above, below) = match blocks {
        [Some(above), None] => return Ok(above),
        [above, Some(Imported::Table(below))] => match (above, below.mirrored()) {
            (None, Some(below)) => return Ok(below.into()),
            (Some(Imported::Table(above)), Some(image)) => match above.joined(&image) {
                Some(both) => return Ok(both.into()),
                None => (Some(above.into()), below.into()),
            },
            (above, _) => (above, below.into()),
        },
        [above, Some(below)] => (above, below),
        [None, None] => return Err("no block of values".into()),
    };
    let side = if above.is_some() { SensorSide::Both } else { SensorSide::Transmission };
    let of = |block: Imported| -> Checked<OnGrid> {
        Ok(match block {
            Imported::Function { parts, wavelengths_nm, grid } => (parts, wavelengths_nm, grid),
            Imported::Table(table) => {
                let grid = table.grid.clone();
                let (parts, wavelengths_nm, _) = functions(table)?;
                (parts, wavelengths_nm, grid)
            }
        })
    };
    let (below, wavelengths_nm, grid) = of(below)?;
    let (parts, grid) = match above {
        None => (below.into_iter().map(|part| two_sided([None, Some(part)])).collect(), grid),
        Some(above) => {
            let (above, nm, grid) = of(above)?;
            let colours = |parts: &[Box<dyn Brdf>]| parts.iter().map(|part| part.colours()).sum::<usize>();
            if nm != wavelengths_nm || colours(&above) != colours(&below) {
                return Err("light that comes back and light that goes through have different colours".into());
            }
            let pair = |(above, below)| two_sided([Some(above), Some(below)]);
            (above.into_iter().zip(below).map(pair).collect(), grid)
        }
    };
    let isotropic = grid.is_isotropic();
    let grid = if grid.kind == GridKind::Hemisphere { grid } else { default_arms(isotropic) };
    Ok(Imported::Function { parts, wavelengths_nm, grid: grid.of_side(side) })
}

/// A table as functions, and notes on gaps that were filled in; each side by itself.
pub fn functions(table: BrdfTable) -> Checked<Functions> {
    let wavelengths_nm = table.wavelengths_nm();
    if !table.grid.looks_below() {
        let (table, filled) = gaps::filled(table)?;
        let parts = thirds(&table).into_iter().map(function_of).collect::<Checked<Vec<_>>>()?;
        return Ok((parts, wavelengths_nm, filled.into_iter().collect()));
    }
    let (mut halves, mut notes) = ([vec![], vec![]], vec![]);
    for (half, below) in halves.iter_mut().zip([false, true]) {
        if let Some(side) = table.half(below) {
            let (parts, _, filled) = functions(side)?;
            half.extend(parts.into_iter().map(Some));
            notes.extend(filled);
        }
    }
    let [above, below] = &mut halves;
    let count = above.len().max(below.len());
    let part = |k: usize| {
        two_sided([above.get_mut(k).and_then(Option::take), below.get_mut(k).and_then(Option::take)])
    };
    Ok(((0..count).map(part).collect(), wavelengths_nm, notes))
}

fn two_sided(halves: [Option<Box<dyn Brdf>>; 2]) -> Box<dyn Brdf> {
    Box::new(TwoSided(halves))
}
