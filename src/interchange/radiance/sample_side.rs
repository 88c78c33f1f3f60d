//! The side of the sample that light comes from, and which blocks of a file are of it.
//!
//! WINDOW's `Back` (`Reflection Back`, `Transmission Back`: light from that side) is the side that Radiance calls front, +z;
//! files are written and preferably read so.

use std::str::FromStr;

use super::xml::{DataBlock, Document, short};
use crate::error::wrong;
use crate::interchange::Checked;

/// Blocks that a message names at most.
const MOST_NAMED: usize = 6;

/// The side of the sample that light comes from, by the file's own words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleSide {
    /// `Reflection Back` and `Transmission Back`, light from +z: what Radiance calls front.
    Back,
    /// `Reflection Front` and `Transmission Front`, light from -z.
    Front,
}

impl SampleSide {
    /// The words for a block of light that comes back, or has gone through.
    pub fn direction(self, through: bool) -> &'static str {
        match (self, through) {
            (SampleSide::Back, false) => "Reflection Back",
            (SampleSide::Back, true) => "Transmission Back",
            (SampleSide::Front, false) => "Reflection Front",
            (SampleSide::Front, true) => "Transmission Front",
        }
    }
}

impl FromStr for SampleSide {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "back" => Ok(SampleSide::Back),
            "front" => Ok(SampleSide::Front),
            _ => {
                Err("front or back needed: the blocks of light from -z (`Front`) or from +z (`Back`)".into())
            }
        }
    }
}

/// The blocks that become a table, and notes on the others.
pub struct SideBlocks<'a> {
    /// Of light that comes back, and that has gone through: none, or Visible and the two of colour where both are there.
    pub halves: [Vec<&'a DataBlock>; 2],
    /// One sentence each.
    pub notes: Vec<String>,
}

impl Document {
    /// The blocks of light from one side: visible, and those of the colour `others` (all or none; a file with one of two is
    /// taken for one without colour, as Radiance has it). Without a wanted side it is +z where the file has it.
    // Tested by `a_missing_block_is_answered_with_those_that_are_there`, `the_wanted_side_is_read`
    // (tests/it/interchange/interchange_radiance.rs).
    pub fn side(&self, others: [&str; 2], side: Option<SampleSide>) -> Checked<SideBlocks<'_>> {
        let find = |direction: &str, wavelength: &str| {
            self.blocks
                .iter()
                .find(|block| block.is(direction) && block.wavelength.eq_ignore_ascii_case(wavelength))
        };
        let words = |side: SampleSide| [side.direction(false), side.direction(true)];
        let wanted = side.map_or(vec![SampleSide::Back, SampleSide::Front], |side| vec![side]);
        let visible = |side: &SampleSide| words(*side).map(|direction| find(direction, "Visible"));
        let Some(side) = wanted.into_iter().find(|side| visible(side).iter().any(Option::is_some)) else {
            let what = side.map_or("reflection or transmission".into(), |side| {
                let [reflection, transmission] = words(side);
                format!("`{reflection}` or `{transmission}`")
            });
            return Err(wrong!("no block of visible {what}; the file has {}", self.named(|_| true)));
        };
        let there: Vec<(usize, &str)> =
            words(side).into_iter().enumerate().filter(|(_, word)| find(word, "Visible").is_some()).collect();
        let has = |direction: &str| others.iter().all(|name| find(direction, name).is_some());
        let names = if there.iter().all(|(_, direction)| has(direction)) { &others[..] } else { &[] };
        let mut halves = [vec![], vec![]];
        for &(through, direction) in &there {
            let wavelengths = std::iter::once("Visible").chain(names.iter().copied());
            halves[through] = wavelengths.filter_map(|wavelength| find(direction, wavelength)).collect();
        }
        let mut notes = vec![];
        if side == SampleSide::Front {
            notes.push(
                "light from the side -z (`Front`): x and y are the file's, azimuths run clockwise seen from there".into(),
            );
        }
        let left = |block: &DataBlock| !halves.iter().flatten().any(|taken| std::ptr::eq(*taken, block));
        if self.blocks.iter().any(left) {
            let read: Vec<String> = there.iter().map(|(_, direction)| format!("`{direction}`")).collect();
            let verb = if read.len() > 1 { "are" } else { "is" };
            notes.push(format!("{} {verb} read; not read: {}", read.join(" and "), self.named(left)));
        }
        Ok(SideBlocks { halves, notes })
    }

    /// Some blocks as a list: direction and wavelength of each.
    fn named(&self, wanted: impl Fn(&DataBlock) -> bool) -> String {
        let name = |block: &DataBlock| {
            let words = format!("{} ({})", short(&block.direction), short(&block.wavelength));
            words.escape_debug().to_string()
        };
        let mut names: Vec<String> = self.blocks.iter().filter(|block| wanted(block)).map(name).collect();
        if names.len() > MOST_NAMED {
            let more = names.len() - MOST_NAMED;
            names.truncate(MOST_NAMED);
            names.push(format!("{more} more"));
        }
        names.join(", ")
    }
}

impl DataBlock {
    fn is(&self, direction: &str) -> bool {
        self.direction
            .split_whitespace()
            .map(str::to_ascii_lowercase)
            .eq(direction.split(' ').map(str::to_ascii_lowercase))
    }
}
