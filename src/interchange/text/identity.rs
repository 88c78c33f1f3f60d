//! What files say of a table besides its values: its name, an identity and the sensor's aperture.

use std::f64::consts::TAU;

use sha2::{Digest, Sha256};

use crate::instrument::Region;
use crate::interchange::read_back::middles_deg;
use crate::table::BrdfTable;

/// The table's campaign as TOML; `None` where it holds none.
pub fn campaign(table: &BrdfTable) -> Option<toml::Table> {
    table.campaign.parse().ok().filter(|_| !table.campaign.is_empty())
}

/// The campaign's name.
pub fn name(table: &BrdfTable) -> String {
    let own = campaign(table).and_then(|campaign| campaign.get("name")?.as_str().map(String::from));
    own.unwrap_or_else(|| "imported table".into())
}

/// A UUID that the same campaign with the same values in the same directions has again.
pub fn uuid(table: &BrdfTable) -> String {
    let mut hash = Sha256::new();
    hash.update(table.campaign.as_bytes());
    for colour in &table.colours {
        hash.update(colour.wavelength_nm.unwrap_or_default().to_le_bytes());
        colour.total.iter().for_each(|value| hash.update(value.to_le_bytes()));
    }
    for incidence in 0..table.grid.incidences() {
        let (theta, phi) = table.grid.incidence_deg(incidence);
        let sensors = middles_deg(&table.grid, incidence).into_iter().flat_map(|(theta, phi)| [theta, phi]);
        [theta, phi].into_iter().chain(sensors).for_each(|angle| hash.update(angle.to_le_bytes()));
    }
    let mut bytes = [0; 16];
    bytes.copy_from_slice(&hash.finalize()[..16]);
    // Version 8 of RFC 9562: bits of the writer's own.
    (bytes[6], bytes[8]) = (0x80 | bytes[6] & 0x0f, 0x80 | bytes[8] & 0x3f);
    let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    [&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]].join("-")
}

/// The solid angle of the sensor's aperture, sr, where all bins are of one.
pub fn receiver(table: &BrdfTable) -> Option<f64> {
    let half = |region: &Region| match region {
        Region::Cap { half_angle, .. } if *half_angle > 0.0 => Some(*half_angle),
        _ => None,
    };
    let regions = table.grid.regions(0);
    let first = half(regions.first()?)?;
    // 2 pi (1 - cos h), without cancellation.
    regions.iter().all(|region| half(region) == Some(first)).then(|| 2.0 * TAU * (0.5 * first).sin().powi(2))
}
