//! The colours that two tables have in common.

use super::totals::{Sources, Totals, WeightedMeans};
use super::words::NAMES;
use crate::error::{Checked, wrong};
use crate::interchange::content::foreign_table::LUMINANCE;
use crate::table::BrdfTable;

/// Wavelengths nearer than this are one, nm.
const SAME_NM: f64 = 1e-6;

/// Both tables with the same colours: as they are, the luminance of R, G, B next to one channel, or common wavelengths.
pub fn in_common<'a>(tables: [Totals<'a>; 2], steps: &mut Vec<String>) -> Checked<[Totals<'a>; 2]> {
    let [a, b] = tables.each_ref().map(|side| side.table.as_ref());
    let spectral = [a.is_spectral(), b.is_spectral()];
    match (spectral, a.colours.len(), b.colours.len()) {
        ([true, true], ..) => wavelengths(tables, steps),
        ([false, false], here, there) if here == there => Ok(tables),
        ([false, false], 3, 1) => Ok(luminance(tables, 0, steps)),
        ([false, false], 1, 3) => Ok(luminance(tables, 1, steps)),
        _ => Err(wrong!(
            "colours: B has {}, A {}: R, G, B or their luminance do not follow from single wavelengths here",
            names(b),
            names(a)
        )),
    }
}

fn names(table: &BrdfTable) -> String {
    table.colour_names().join(" ")
}

fn luminance<'a>(tables: [Totals<'a>; 2], which: usize, steps: &mut Vec<String>) -> [Totals<'a>; 2] {
    let [r, g, b] = LUMINANCE;
    let (colour, one) = (NAMES[which], NAMES[1 - which]);
    steps.push(format!(
        "{colour} has R, G, B and {one} one channel: the luminance {r} R + {g} G + {b} B (ITU-R BT.709) of {colour}"
    ));
    let sources: Sources = LUMINANCE.iter().copied().map(f64::from).enumerate().collect();
    of(tables, which, vec![sources])
}

fn wavelengths<'a>(tables: [Totals<'a>; 2], steps: &mut Vec<String>) -> Checked<[Totals<'a>; 2]> {
    let nm = tables.each_ref().map(|side| side.table.wavelengths_nm());
    let of_b = |here: f64| nm[1].iter().position(|there| (here - there).abs() <= SAME_NM);
    let pairs: Vec<[usize; 2]> =
        nm[0].iter().enumerate().filter_map(|(k, &here)| Some([k, of_b(here)?])).collect();
    if pairs.is_empty() {
        let [a, b] = tables.each_ref().map(|side| names(&side.table));
        return Err(wrong!("colours: B has {b}, A {a}: no wavelength in common"));
    }
    if pairs.len() == nm[0].len() && pairs.len() == nm[1].len() {
        return Ok(tables);
    }
    let kept: Vec<String> = pairs.iter().map(|pair| nm[0][pair[0]].to_string()).collect();
    steps.push(format!(
        "A has {} wavelengths and B {}: those in common, {} nm",
        nm[0].len(),
        nm[1].len(),
        kept.join(", ")
    ));
    let chosen = |tables, k: usize| of(tables, k, pairs.iter().map(|pair| vec![(pair[k], 1.0)]).collect());
    Ok(chosen(chosen(tables, 0), 1))
}

/// The tables, of one of them means of its colours.
fn of<'a>(tables: [Totals<'a>; 2], which: usize, colours: Vec<Sources>) -> [Totals<'a>; 2] {
    let mut tables = tables;
    let side = &tables[which];
    let grid = side.table.grid.clone();
    tables[which] = WeightedMeans::of_colours(&side.table, colours).of(side, &grid);
    tables
}
