//! `[uncertainty]`: how well the instrument is known, and where a budget is made.

mod correlations;
mod directions;
mod input;

use super::reader::{GivenValue, Slot};
use crate::campaign::schema::{
    Alpha, InputQuantity, LightArm, Optics, QUANTITIES, Quantity, RefractiveIndex, SensorArm, Surface,
    SurfaceKind, Uncertainty,
};

/// Words for distributions.
pub(crate) use input::DISTRIBUTIONS;

/// Surface samples, as of `[stop]`.
const MOST_SAMPLES: u64 = 1 << 40;
/// JCGM 101, 7.2.2: 1e4/(1 - p) trials at least for an interval of probability p = 0.95.
const FEWEST_TRIALS: u64 = 200_000;
const MOST_TRIALS: u64 = 100_000_000;
const TRIALS: u64 = 1_000_000;

/// The other tables of the file.
pub(crate) struct Around<'a> {
    pub surface: &'a Surface,
    pub light: &'a LightArm,
    pub sensor: &'a SensorArm,
    pub optics: &'a Optics,
}

/// Reads the table; what it can be asked depends on the rest of the campaign.
pub(crate) fn uncertainty(item: &GivenValue<'_>, around: &Around<'_>) -> Option<Uncertainty> {
    let mut names = [""; QUANTITIES.len() + 5];
    for (name, (quantity, _)) in names.iter_mut().zip(QUANTITIES) {
        *name = quantity;
    }
    names[QUANTITIES.len()..].copy_from_slice(&["correlations", "at", "aperture_deg", "samples", "trials"]);
    let slots = item.table()?.keys(names);
    let (quantities, others) = slots.split_at(QUANTITIES.len());
    let [correlations, at, aperture, samples, trials] = others else { return None };
    let measurable = budget_is_possible(item, around);
    let inputs = inputs(quantities, around);
    let samples = samples.or(None, |i| i.whole(1..=MOST_SAMPLES).map(Some));
    let trials = trials.or(TRIALS, |i| i.whole(FEWEST_TRIALS..=MOST_TRIALS));
    let directions = directions::directions([at, aperture], around);
    let inputs = inputs?;
    if inputs.is_empty() {
        return item.refuse(
            "give at least one input, such as reading = { u = 0.002 } or sensor_theta_deg = { half_width = 0.05 }",
        );
    }
    let correlations = correlations.or(vec![], |i| correlations::correlations(i, &inputs))?;
    let ((at_deg, aperture_deg), samples, trials) = (directions?, samples?, trials?);
    measurable?;
    Some(Uncertainty { inputs, correlations, at_deg, aperture_deg, samples, trials })
}

/// A budget is of one table, of a surface that spreads light, with errors that come from the spread of realisations.
fn budget_is_possible(item: &GivenValue<'_>, around: &Around<'_>) -> Option<()> {
    let surface = around.surface;
    if matches!(surface.kind, SurfaceKind::Mirror | SurfaceKind::VGroove { .. }) {
        return item.refuse(format!(
            "surface.{} sends light in single directions, where a BRDF has no derivative: a budget needs a rough surface",
            surface.kind.name()
        ));
    }
    if surface.realisations < 2 {
        let key = if surface.kind.is_map() { "surface.file.tiles" } else { "surface.realisations" };
        return item.refuse(format!("needs {key} of at least 2: type A errors come from the spread of them"));
    }
    if surface.kind.alphas().is_some_and(|alphas: &Vec<Alpha>| alphas.len() > 1) {
        return item.refuse("a budget is of one table: give one roughness instead of a list");
    }
    if around.optics.each().len() > 1 {
        return item
            .refuse("a budget is of one table: give one material, polarisation and side of the light");
    }
    Some(())
}

fn inputs(slots: &[Slot<'_>], around: &Around<'_>) -> Option<Vec<InputQuantity>> {
    let read = |(slot, (_, quantity)): (&Slot<'_>, (&str, Quantity))| {
        let item = slot.given()?;
        let there = exists(item, quantity, around);
        Some(input::input(item, quantity).filter(|_| there.is_some()))
    };
    slots.iter().zip(QUANTITIES).filter_map(read).collect()
}

/// A fault where the campaign has no such quantity.
fn exists(item: &GivenValue<'_>, quantity: Quantity, around: &Around<'_>) -> Option<()> {
    let inside = |value: &f64| 0.0 < *value && *value < 1.0;
    let albedo = match around.optics {
        Optics::Diffuse { albedo } | Optics::Layered { albedo, .. } => Some(albedo),
        _ => None,
    };
    match (quantity, around.optics) {
        (Quantity::LampCone, _) if around.light.aperture_deg == 0.0 => item
            .refuse("is relative to light.aperture_deg, which is 0: give the light a cone, or leave it out"),
        (Quantity::N, Optics::Index(_) | Optics::Dielectric(_) | Optics::Layered { .. }) => Some(()),
        (Quantity::N, _) => {
            item.refuse("[optics] has no index of refraction; leave it out, or give optics.eta")
        }
        (Quantity::K, Optics::Index(RefractiveIndex { media, .. })) if media.iter().all(|m| m.k > 0.0) => {
            Some(())
        }
        (Quantity::K, _) => item.refuse("[optics] has no k above 0; leave it out, or give optics.k"),
        (Quantity::F0, Optics::Schlick { f0, .. }) if f0.iter().all(inside) => Some(()),
        (Quantity::F0, _) => {
            item.refuse("belongs to optics.f0 between 0 and 1; of an index of refraction give n and k")
        }
        (Quantity::Albedo, _) if albedo.is_some_and(|albedo| albedo.iter().all(inside)) => Some(()),
        (Quantity::Albedo, _) => {
            item.refuse("belongs to matt or layered facets with optics.albedo between 0 and 1")
        }
        _ => Some(()),
    }
}
