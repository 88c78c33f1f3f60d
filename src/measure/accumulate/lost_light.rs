//! Light over the edge of an open map: what it may have added to each bin, and error bars that cover it.
//!
//! A ray that leaves a map which does not continue itself may meet nothing beyond, or anything. So of the light of such
//! paths every bin may lack between nothing and `bound`: all of what would arrive there if nothing lay beyond, and,
//! where more bounces are followed, all that may go on from something there. Of a value known to lie evenly in
//! [f, f + bound] the root mean square distance from f is bound/sqrt(3), which is added to the standard error in
//! square (JCGM 100, 4.3.7); 95 % of it, 1.96 bound/sqrt(3), covers the bound.

use super::fresnel_sums::ColourSource;
use super::table_source::TableSource;
use super::tally_flux::TallyFlux;
use crate::stats;
use crate::table::ColourChannels;

/// The channels of a colour with errors that cover the lost light, and with its bound.
pub(crate) fn covered(
    source: &TableSource,
    colour: ColourSource,
    channels: ColourChannels,
) -> ColourChannels {
    let sums = &source.plan.sums;
    let single =
        source.brdf(source.flux, |flux, bin| flux.left().map_or(0.0, |left| left.single(colour, bin)));
    let total = source.brdf(source.flux, |flux, bin| {
        flux.left().map_or(0.0, |left| {
            left.single(colour, bin) + left.multiple(sums, colour, bin) + left.truncated()
        })
    });
    ColourChannels {
        stderr: widened(&channels.stderr, &total),
        // No element of a Mueller matrix exceeds the first.
        stderr_mueller: channels.stderr_mueller.iter().map(|stderr| widened(stderr, &total)).collect(),
        stderr_single: widened(&channels.stderr_single, &single),
        left_map: total,
        ..channels
    }
}

/// Standard errors with those of lost light; what is not available (-1) remains so.
fn widened(stderr: &[f32], bound: &[f32]) -> Vec<f32> {
    let both = |(&stderr, &bound): (&f32, &f32)| {
        if stderr < 0.0 { stderr } else { with_bound(f64::from(stderr), f64::from(bound)) as f32 }
    };
    stderr.iter().zip(bound).map(both).collect()
}

/// A standard error and a bound on what may be missing as one error: sqrt(se^2 + bound^2/3).
pub fn with_bound(se: f64, bound: f64) -> f64 {
    se.hypot(bound / 3f64.sqrt())
}

/// What lost light may have added to the albedos of order 1 and of all orders: mean of realisations and colours.
pub(crate) fn of_albedos(realisations: &[TallyFlux], colours: &[ColourSource]) -> [f64; 2] {
    let of = |flux: &TallyFlux, orders: usize, beyond: f64| {
        let Some(left) = flux.left() else { return 0.0 };
        let flux = |&colour: &ColourSource| (0..orders).map(|order| left.order(order, colour)).sum::<f64>();
        stats::mean(&colours.iter().map(flux).collect::<Vec<_>>()) + beyond * left.truncated()
    };
    let mean = |orders: usize, beyond: f64| {
        stats::mean(&realisations.iter().map(|flux| of(flux, orders, beyond)).collect::<Vec<_>>())
    };
    [mean(1, 0.0), mean(realisations[0].tally.orders.len(), 1.0)]
}
