//! The header of a table's file: its grid, its campaign, how its directions and values are to be understood, and the names of
//! its channels.

use std::collections::BTreeMap;

use crate::error::{Checked, wrong};
use crate::files::image::ImagePart;
use crate::instrument::Grid;

use super::BrdfTable;
use super::channels::{self, ColourName, DIGEST, MUELLER_ELEMENTS, Plane};
use super::grid_attribute::{self, GRID};

pub(super) const VERSION: &str = "gonio.version";
pub(super) const CAMPAIGN: &str = "gonio.campaign";
pub(super) const CONVENTION: &str = "gonio.convention";
pub(super) const SEED: &str = "gonio.seed";
const PATCH_DIGEST: &str = "gonio.patch_digest";

/// How directions and values of a table are to be understood.
const CONVENTION_TEXT: &str = "Frame: z is the mean normal of the sample, x its tangent, right-handed; \
    theta is the angle from z and phi the azimuth from x towards y, in degrees. wi points from the surface to \
    the light (theta_i, phi_i), wo from the surface to the sensor (theta_r, phi_r); the mirror direction lies at \
    theta_r = theta_i, phi_r = phi_i + 180. With phi_r_relative, phi_r counts from phi_i. Values are the BRDF in \
    1/sr averaged over the bin by projected solid angle, not multiplied by any cosine. Row = light stop, theta_i \
    major; column = sensor bin, theta_r major.";

/// What is added for a sensor that looks below the surface.
const THROUGH_TEXT: &str = " theta_r beyond 90 degrees is light that has gone through the surface: radiant flux per \
    projected solid angle |cos(theta_r)| dw and incident flux, without a factor n^2. The light stands on the side of z; \
    where it is the back of the sample, z points inwards. With n_i and n_o the indices on both sides, f(wo -> wi) = \
    f(wi -> wo) (n_i/n_o)^2 for light the other way round, and f (n_i/n_o)^2 carries the basic radiance L/n^2.";

/// What Mueller matrices mean, where they are there.
const MUELLER: &str = "gonio.mueller";
const MUELLER_TEXT: &str = "m00 to m33: the Mueller matrix, row of the light that leaves, column of the light that comes, in \
    1/sr, all orders together. Stokes vector (I, Q, U, V) in the frame s, p = k x s, k of the ray along k: s lies across the \
    plane of z and the arm, Q = |E_s|^2 - |E_p|^2, U + i V = 2 E_s conj(E_p) for E exp(-i w t), so that V > 0 turns clockwise \
    for who looks against the light. A cap all about z has the light's plane for every azimuth. m00 is what unpolarised \
    light becomes with its polarisation kept from facet to facet; the other channels take it as unpolarised at each.";

/// How directions and values of a table of this grid are to be understood.
pub fn convention(grid: &Grid) -> String {
    format!("{CONVENTION_TEXT}{}", if grid.looks_below() { THROUGH_TEXT } else { "" })
}

/// What a part says besides its values.
pub(super) struct TableHeader {
    /// The table without its channels.
    pub empty: BrdfTable,
    /// Its colours.
    pub names: Vec<ColourName>,
    /// As [`Loaded::warnings`](super::store::Loaded::warnings).
    pub warnings: Vec<String>,
}

/// Reads what a part says besides its values; channels that are none of a table's are taken out of it.
pub(super) fn header(part: &mut ImagePart) -> Checked<TableHeader> {
    let mut warnings = Vec::new();
    let grid = grid_attribute::read_grid(part)?;
    let seed = read_seed(part, &mut warnings)?;
    let mut attribute = |name: &str| {
        let text = part.text(name);
        if text.is_none() {
            warnings.push(format!("no {name} attribute"));
        }
        text.unwrap_or_default().to_string()
    };
    let (version, campaign) = (attribute(VERSION), attribute(CAMPAIGN));
    if attribute(CONVENTION) != convention(&grid) {
        warnings.push(format!("{CONVENTION} is not this program's: its angles may mean something else"));
    }
    let patch_digest = part.text(PATCH_DIGEST).unwrap_or_default().to_string();
    let names = channels::colour_names(part)?;
    drop_unknown(part, &names, &mut warnings);
    let (colours, hits, schlick) = (Vec::new(), Vec::new(), None);
    let empty = BrdfTable { grid, campaign, version, seed, patch_digest, colours, hits, schlick };
    Ok(TableHeader { empty, names, warnings })
}

/// The header of a table's file: all but the values, the digest yet to be filled in.
pub(super) fn outline(
    table: &BrdfTable,
    grid: &Grid,
    planes: &BTreeMap<String, Plane>,
) -> Checked<ImagePart> {
    let (height, width) = grid_attribute::check_grid(grid)?;
    let mut part = ImagePart { width, height, ..ImagePart::default() };
    part.channels = planes.iter().map(|(name, plane)| (name.clone(), plane.kind())).collect();
    part.set_text(DIGEST, &"0".repeat(64));
    part.set_text(GRID, &grid_attribute::grid_text(grid)?);
    part.set_text(VERSION, &table.version);
    part.set_text(CAMPAIGN, &table.campaign);
    part.set_text(CONVENTION, &convention(grid));
    if table.colours.iter().any(|colour| !colour.mueller.is_empty()) {
        part.set_text(MUELLER, MUELLER_TEXT);
    }
    part.set_text(SEED, &table.seed.to_string());
    part.set_text(PATCH_DIGEST, &table.patch_digest);
    let errors: Vec<Vec<f32>> = table.colours.iter().map(|colour| colour.albedo_se.clone()).collect();
    channels::set_albedo_errors(&mut part, &errors, grid.incidences());
    Ok(part)
}

fn read_seed(part: &ImagePart, warnings: &mut Vec<String>) -> Checked<u64> {
    let Some(text) = part.text(SEED) else {
        warnings.push(format!("no {SEED} attribute; 0 is taken"));
        return Ok(0);
    };
    text.parse().map_err(|_| wrong!("{SEED} = {text}: an integer from 0 to {} needed", u64::MAX))
}

/// Takes out channels that are none of a table's.
fn drop_unknown(part: &mut ImagePart, colours: &[ColourName], warnings: &mut Vec<String>) {
    let of_colour = |name: &str| colours.iter().any(|(colour, _)| colour == name);
    let number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let order = |text: &str| text.strip_prefix("order").is_some_and(number);
    let known = |name: &str| match name.split_once('.') {
        None => matches!(name, "hits" | "schlick" | "unit") || of_colour(name),
        Some(("single" | "multiple" | "left_map", rest)) => of_colour(rest),
        Some(("stderr", rest)) => match rest.split_once('.') {
            Some((layer, rest)) => {
                (layer == "single" || MUELLER_ELEMENTS.contains(&layer)) && of_colour(rest)
            }
            None => of_colour(rest),
        },
        Some((layer, rest)) if MUELLER_ELEMENTS.contains(&layer) => of_colour(rest),
        Some(("parts", rest)) => number(rest),
        Some((layer, rest)) if order(layer) => {
            of_colour(rest) || rest.strip_prefix("parts.").is_some_and(number)
        }
        Some(_) => false,
    };
    part.channels.retain(|name, _| {
        if !known(name) {
            warnings.push(format!("channel `{name}` is not one of a table's and is left out"));
        }
        known(name)
    });
}
