//! Which blocks a file has: by the side that light comes from, what comes back, and what goes through.
//!
//! Radiance has one frame for all of them: x and y of every direction are the sample's, those of the light negated, and
//! the sign of z follows from the block. So each block is written as light that comes back on the side of the light, light
//! that has gone through as a mirror in the horizon shows it. Source: Radiance's bsdf_m.c and bsdf_t.c.

use std::borrow::Cow;

use super::sample_side::SampleSide;
use crate::campaign::LightSide;
use crate::error::wrong;
use crate::interchange::codec;
use crate::interchange::content::light::{media_differ, side_of};
use crate::interchange::{Checked, Options};
use crate::table::BrdfTable;

/// What a block is of.
pub struct Side<'a> {
    /// The side of the sample that light comes from.
    pub light: SampleSide,
    /// Whether it is light that has gone through.
    pub through: bool,
    /// Above the horizon.
    pub half: Cow<'a, BrdfTable>,
}

/// Where the media on both sides differ.
const N2: &str = "the media on both sides differ: values are shares of the flux, without a factor n^2, and f(wi, wo) is not f(wo, \
    wi); Radiance takes them for equal, as they are between like media (a pane)";
/// Where they do, and one side's light is all there is.
const ALONE: &str = "light the other way has no block: Radiance would make it up by f(wi, wo) = f(wo, wi), off by n^2; give its table \
    by --back";

/// The sides of the surface that a table holds, and those of one under light from the back besides; and notes on them.
// Tested by `tables_of_both_lights_make_four_blocks` (tests/it/interchange/through.rs).
pub fn of<'a>(table: &'a BrdfTable, options: &'a Options) -> Checked<(Vec<Side<'a>>, Vec<String>)> {
    let own = side_of(table);
    let mut all =
        blocks(table, if own == Some(LightSide::Back) { SampleSide::Front } else { SampleSide::Back });
    if let Some(back) = &options.back {
        if own == Some(LightSide::Back) {
            return Err("the first table's light comes from the back: it is the one for --back".into());
        }
        if side_of(back) == Some(LightSide::Front) {
            return Err("--back: that table's light comes from the front, a table of [light] side = \"back\" is needed".into());
        }
        if back.colours.len() != table.colours.len() {
            let counts = (back.colours.len(), table.colours.len());
            return Err(wrong!("--back: {} colours, the first table has {}", counts.0, counts.1));
        }
        all.extend(blocks(back, SampleSide::Front));
    }
    let lights: Vec<SampleSide> = all.iter().filter(|side| side.through).map(|side| side.light).collect();
    let differ = !lights.is_empty() && media_differ(table) == Some(true);
    let notes = [(differ, N2), (differ && lights.len() == 1, ALONE)];
    Ok((all, notes.into_iter().filter(|(said, _)| *said).map(|(_, what)| what.to_string()).collect()))
}

fn blocks(table: &BrdfTable, light: SampleSide) -> Vec<Side<'_>> {
    codec::halves(table).into_iter().map(|(through, half)| Side { light, through, half }).collect()
}
