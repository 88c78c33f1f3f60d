//! How much of the light crosses gaps of a map on its way to the samples, where what it would have met is not known.

use glam::DVec2;

use crate::campaign::{Azimuth, Campaign};
use crate::surface::io::import::ImportedMap;

/// Samples that are looked at, at most: a part of 1 % is known to 0.1 %.
const LOOKED_AT: usize = 10_000;

/// A sentence on how many of the light's ways cross a gap below the highest height, at the incidence where they are most;
/// `None` of a map without excluded gaps.
///
/// Looked for at samples that are evenly spread over the cells where paths start, cell by cell along the light's azimuth, up to
/// where the way is above the highest height or leaves the map.
pub fn note(map: &ImportedMap, margin: usize, campaign: &Campaign) -> Option<String> {
    let excluded = map.excluded.as_ref()?;
    let field = &map.field;
    let (cells_x, cells_y) = (field.cells_x(), field.cells_y());
    let (_, high) = field.range();
    let (width, inner) = (cells_x - 2 * margin, (cells_x - 2 * margin) * (cells_y - 2 * margin));
    let mut step = inner.div_ceil(LOOKED_AT).max(1);
    // Not the same columns in each row.
    while step > 1 && width.is_multiple_of(step) {
        step += 1;
    }
    let cells = (0..inner).step_by(step).map(|k| (margin + k % width, margin + k / width));
    let looked_at: Vec<(usize, usize)> = cells.filter(|&(x, y)| !excluded.holds(x, y)).collect();
    let crossing = |theta: f64, phi: f64| {
        // In cells a unit of height climbs: the way runs tan(theta) in the unit of the heights.
        let along = theta.to_radians().tan()
            * DVec2::from_angle(phi.to_radians())
            * DVec2::new(map.alpha_x, map.alpha_y);
        let crosses = |&&(x, y): &&(usize, usize)| -> bool {
            let height = field.corners(x, y).h00;
            let reach = along * (high - height);
            let steps = reach.abs().max_element().ceil() as usize;
            (1..=steps).any(|step| {
                let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) + reach * (step as f64 / steps as f64);
                let within = |at: f64, cells: usize| match field.is_periodic() {
                    true => Some(at.rem_euclid(cells as f64) as usize % cells),
                    false => (at >= 0.0 && at < cells as f64).then_some(at as usize),
                };
                within(at.x, cells_x).zip(within(at.y, cells_y)).is_some_and(|(x, y)| excluded.holds(x, y))
            })
        };
        looked_at.iter().filter(crosses).count()
    };
    let turned = campaign.surface.rotation_deg;
    let azimuths = match &campaign.light.azimuth {
        Azimuth::Absolute(phis) => phis.clone(),
        Azimuth::Relative | Azimuth::KlemsFull => (0..8).map(|k| 45.0 * f64::from(k)).collect(),
    };
    let ways =
        campaign.light.theta_i_deg.iter().flat_map(|&theta| azimuths.iter().map(move |&phi| (theta, phi)));
    let counted = ways.map(|(theta, phi)| (crossing(theta, phi - turned), theta, phi));
    let (count, theta, phi) = counted.max_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)))?;
    let share = 100.0 * count as f64 / looked_at.len().max(1) as f64;
    Some(format!(
        "{share:.2} % of the light's ways cross excluded gaps below the highest height at theta_i {theta}, phi_i {phi}, where \
         they are most: what shadows there is the filled surface"
    ))
}
