//! What a summary says of one incidence: from its measurement, or from the table alone.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::instrument::Region;
use crate::measure::accumulate::slopes::SlopeClass;
use crate::measure::{IncidenceResult, StoppedBy};
use crate::stats;
use crate::table::brdf_table::flux;
use crate::table::{BrdfTable, ColourChannels};

/// One incidence: fluxes as shares of the incident flux, means and standard errors over the realisations.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct IncidenceSummary {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Azimuth of the light.
    pub phi_i_deg: f64,
    /// Flux that leaves after one bounce.
    pub albedo_single: Option<f64>,
    /// Its standard error.
    pub albedo_single_se: Option<f64>,
    /// Flux that leaves after any number of bounces.
    pub albedo_total: Option<f64>,
    /// Its standard error.
    pub albedo_total_se: Option<f64>,
    /// Flux of each order.
    pub albedo_by_order: Option<Vec<f64>>,
    /// Flux that has gone through the surface at order 1; where light goes through.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmittance_single: Option<f64>,
    /// Its standard error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmittance_single_se: Option<f64>,
    /// The same after any number of facets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmittance_total: Option<f64>,
    /// Its standard error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmittance_total_se: Option<f64>,
    /// [`IncidenceResult::beyond_order_1`].
    pub beyond_order_1: Option<f64>,
    /// Its standard error.
    pub beyond_order_1_se: Option<f64>,
    /// Paths that leave, by order.
    pub orders: Vec<u64>,
    /// Paths that leave on the other side than the light's, by order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub through: Vec<u64>,
    /// Paths that were truncated at the last order.
    pub cut: u64,
    /// Surface samples in shadow.
    pub hidden: u64,
    /// Paths over the edge of an open map.
    pub left_map: u64,
    /// What they may have added to the albedo at most.
    pub left_map_flux: f64,
    /// Surface samples whose facets send light into no aperture, where only that is followed.
    pub outside: u64,
    /// Paths that end on an absorbing plane between grains.
    #[serde(skip_serializing_if = "is_zero")]
    pub absorbed: u64,
    /// 0: no path is lost.
    pub lost: u64,
    /// Surface samples in each realisation.
    pub samples: u64,
    /// What ended the incidence.
    pub stopped_by: Option<StoppedBy>,
    /// The relative error where it ended, if one was asked for.
    pub relative_error: Option<f64>,
    /// How many realisations would reach it, where the patches are the limit.
    pub realisations_needed: Option<u64>,
    /// The relative errors on the way.
    pub looks: Vec<ErrorLook>,
    /// What the light sees of the facets by their slope.
    pub seen_by_slope: Option<Vec<SlopeClass>>,
    /// All orders, truncated and absorbed paths with F = 1: 1 up to noise.
    pub closure: Option<f64>,
    /// Its standard error.
    pub closure_se: Option<f64>,
}

/// The error of an incidence after so many samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorLook {
    /// Surface samples in each realisation.
    pub samples: u64,
    /// Median relative standard error of the bright bins.
    pub relative_error: f64,
}

impl IncidenceSummary {
    /// Of an incidence that was measured with the light at these angles.
    pub(super) fn of_result(result: &IncidenceResult, (theta_i_deg, phi_i_deg): (f64, f64)) -> Self {
        let (albedo_single, albedo_single_se) = result.single();
        let (albedo_total, albedo_total_se) = result.total();
        let (transmittance_single, transmittance_single_se) = result.single_transmittance();
        let (transmittance_total, transmittance_total_se) = result.total_transmittance();
        let (beyond_order_1, beyond_order_1_se) = result.beyond_order_1();
        let (closure, closure_se) = stats::known_mean(result.closure.iter().copied());
        let mean = |order: &Vec<f64>| stats::known_mean(order.iter().copied()).0;
        IncidenceSummary {
            theta_i_deg,
            phi_i_deg,
            albedo_single,
            albedo_single_se,
            albedo_total,
            albedo_total_se,
            albedo_by_order: result.albedo_by_order.iter().map(mean).collect(),
            transmittance_single,
            transmittance_single_se,
            transmittance_total,
            transmittance_total_se,
            through: result.through.clone(),
            beyond_order_1,
            beyond_order_1_se,
            orders: result.orders.clone(),
            cut: result.cut,
            hidden: result.hidden,
            left_map: result.left_map,
            left_map_flux: result.lost_light[1],
            outside: result.outside,
            absorbed: result.absorbed,
            lost: 0,
            samples: result.samples,
            stopped_by: Some(result.stopped_by),
            relative_error: result.relative_error,
            realisations_needed: result.realisations_needed,
            looks: looks(result),
            seen_by_slope: result.seen_by_slope.clone(),
            closure,
            closure_se,
        }
    }

    /// What has gone through, in place of what comes back.
    pub(super) fn through(&self) -> Self {
        IncidenceSummary {
            theta_i_deg: self.theta_i_deg,
            phi_i_deg: self.phi_i_deg,
            albedo_single: self.transmittance_single,
            albedo_single_se: self.transmittance_single_se,
            albedo_total: self.transmittance_total,
            albedo_total_se: self.transmittance_total_se,
            ..IncidenceSummary::default()
        }
    }

    /// Of each incidence of a table, or of a band of it: flux over all bins, mean of the colours, where they gather all flux.
    pub fn of_bins(table: &BrdfTable) -> Vec<Self> {
        let gaps = table.gaps() > 0;
        (0..table.grid.incidences()).map(|incidence| of_bins(table, incidence, gaps)).collect()
    }
}

fn of_bins(table: &BrdfTable, incidence: usize, gaps: bool) -> IncidenceSummary {
    let (theta_i_deg, phi_i_deg) = table.grid.incidence_deg(incidence);
    let regions = table.grid.regions(incidence);
    // Of the bins on each side, 0 of the others'.
    let sizes = [false, true].map(|below| {
        let size =
            |region: &Region| if region.is_below() == below { region.projected_solid_angle() } else { 0.0 };
        regions.iter().map(size).collect::<Vec<f64>>()
    });
    let flux_of = |below: bool, pick: fn(&ColourChannels) -> &Vec<f32>| {
        let sizes = &sizes[usize::from(below)];
        // Bins that fill the hemisphere, up to the rounding of their edges.
        let whole = (sizes.iter().sum::<f64>() - PI).abs() < 1e-6 && !gaps;
        let flux = |colour| flux(&pick(colour)[incidence * sizes.len()..], sizes);
        whole.then(|| stats::mean(&table.colours.iter().map(flux).collect::<Vec<_>>()))
    };
    IncidenceSummary {
        theta_i_deg,
        phi_i_deg,
        albedo_single: flux_of(false, |colour| &colour.single),
        albedo_total: flux_of(false, |colour| &colour.total),
        transmittance_single: flux_of(true, |colour| &colour.single),
        transmittance_total: flux_of(true, |colour| &colour.total),
        ..IncidenceSummary::default()
    }
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// Error against samples, as far as the run looked at it.
fn looks(result: &IncidenceResult) -> Vec<ErrorLook> {
    // Samples of a block follow from what the incidence had in the end.
    let last = result.looks.last().map_or(1, |look| look.blocks);
    let block = result.samples / last.max(1);
    let looks = result.looks.iter();
    looks
        .map(|look| ErrorLook { samples: look.blocks * block, relative_error: look.relative_error })
        .collect()
}
