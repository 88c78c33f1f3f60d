//! The measurements that a budget is made of.

use super::alternatives::{self, Alternative, LeftOut};
use super::positions::{self, Position};
use super::response::Response;
use super::rig::{Rig, Seen, Setting};
use super::sensitivities;
use crate::campaign::{Campaign, SensorArm, Uncertainty};
use crate::error::{Error, Result};
use crate::stats;

/// What a budget is made of, with the sensitivities measured.
pub struct Measured {
    pub(super) positions: Vec<Position>,
    pub(super) nominal: Vec<Seen>,
    /// The same with the random numbers of moved pairs: what differences are taken from.
    pub(super) middle: Vec<Seen>,
    /// Answers to errors of the inputs: \[pair\]\[colour\].
    pub responses: Vec<Vec<Response>>,
    pub(super) alternatives: Vec<Alternative>,
    pub(super) left_out: Vec<LeftOut>,
    pub(super) notes: Vec<String>,
    pub(super) rig: Rig,
    pub(super) samples: u64,
}

/// Measures values and sensitivities, for a budget or by themselves.
pub fn measure(campaign: &Campaign, uncertainty: &Uncertainty, stage: &dyn Fn(&str)) -> Result<Measured> {
    let samples = uncertainty.samples.unwrap_or(campaign.stop.samples);
    let aperture_deg = match &campaign.sensor {
        SensorArm::Arm { aperture_deg, .. } => Some(*aperture_deg),
        _ => uncertainty.aperture_deg,
    };
    let aperture_deg = aperture_deg.ok_or_else(|| Error::Internal("a budget without an aperture".into()))?;
    stage("measuring");
    let mut notes = Vec::new();
    let mut rig = Rig::new(campaign, aperture_deg, samples, &mut notes)?;
    let positions = positions::positions(campaign, uncertainty);
    let nominal = rig.read_anew(&positions)?;
    let mean = |values: &Vec<f64>| stats::mean(values);
    let values: Vec<Vec<f64>> = nominal.iter().map(|seen| seen.brdf.iter().map(mean).collect()).collect();
    if values.iter().flatten().all(|value| *value == 0.0) {
        return Err(Error::Refused(format!(
            "{}: no light arrives at any of the positions: take a wider aperture, more samples, or other directions",
            campaign.name
        )));
    }
    let middle = rig.read_as_moved(&Setting::NOMINAL, &positions)?;
    let responses =
        sensitivities::responses(&mut rig, &uncertainty.inputs, &positions, &values, &middle, stage)?;
    let (alternatives, left_out) = (Vec::new(), Vec::new());
    Ok(Measured { positions, nominal, middle, responses, alternatives, left_out, notes, rig, samples })
}

impl Measured {
    /// Measures the same otherwise.
    pub(super) fn look_for_alternatives(&mut self, stage: &dyn Fn(&str)) -> Result<()> {
        (self.alternatives, self.left_out) =
            alternatives::alternatives(&mut self.rig, &self.positions, &self.nominal, &self.middle, stage)?;
        Ok(())
    }

    /// Standard error of the mean over realisations, and its degrees of freedom.
    pub(super) fn type_a(&self, pair: usize, colour: usize) -> (f64, f64) {
        let values = &self.nominal[pair].brdf[colour];
        let (_, se) = stats::mean_and_se(values.iter().copied());
        // A campaign with a budget has two realisations at least.
        (se.unwrap_or(f64::INFINITY), values.len() as f64 - 1.0)
    }

    /// Half-widths of what the value may be off by.
    pub(super) fn half_widths(&self, pair: usize, colour: usize) -> Vec<f64> {
        self.alternatives.iter().map(|one| one.half_widths[pair][colour].value).collect()
    }
}
