//! What a table's campaign says of its light: from which side it comes, and between which media it goes.

use std::path::Path;

use crate::campaign::{self, LightSide, Optics};
use crate::table::BrdfTable;

/// The side that a table's light comes from; `None` where the table holds no campaign.
pub fn side_of(table: &BrdfTable) -> Option<LightSide> {
    optics_of(table).map(|optics| {
        if optics.light_sides() == [LightSide::Back] { LightSide::Back } else { LightSide::Front }
    })
}

/// Whether the media on both sides differ, so that f(wi -> wo) and f(wo -> wi) differ by n^2. `None`: not known.
pub fn media_differ(table: &BrdfTable) -> Option<bool> {
    optics_of(table).map(|optics| optics.lets_through())
}

/// The index beyond over the index here of a table of clear facets, of its middle colour; `None`: not known, or none.
pub fn index_of(table: &BrdfTable) -> Option<f64> {
    let Optics::Dielectric(clear) = optics_of(table)? else { return None };
    let eta = clear.media.get(clear.media.len() / 2)?.eta;
    Some(if clear.light == LightSide::Back { 1.0 / eta } else { eta }).filter(|&eta| eta != 1.0)
}

fn optics_of(table: &BrdfTable) -> Option<Optics> {
    let parsed =
        (!table.campaign.is_empty()).then(|| campaign::parse(&table.campaign, "campaign", Path::new("")))?;
    parsed.ok().map(|parsed| parsed.campaign.optics)
}
