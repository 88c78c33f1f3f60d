//! The table against one model, bin mean against bin mean: noise and model discrepancy apart.
//!
//! With w a bin's projected solid angle, f measured, m the model's bin mean, se the standard error of f over R
//! realisations: l1 = sum |f-m| w / sum m w; l1_noise = sqrt(2/pi)/c4(R) sum se w / sum m w, what noise alone would
//! show; l1_model = sqrt(max(0, l1^2 - l1_noise^2)), null for R < 4; l2_model_sq = sum w ((f-m)^2 - se^2)/sum w m^2.

use serde::Serialize;

use crate::stats;

/// A model held against a table.
#[derive(Debug, Clone, Serialize)]
pub struct Comparison {
    /// Law of the normals, or the surface's own model.
    pub model: String,
    /// The masking's name.
    pub masking: String,
    /// Which channel is compared: `single`.
    pub scope: String,
    /// Means over stops and colours of the figures below.
    #[serde(flatten)]
    pub figures: Figures,
    /// Each stop.
    pub stops: Vec<StopComparison>,
}

/// The error measures.
#[derive(Debug, Clone, Copy, Serialize, Default)]
pub struct Figures {
    /// Flux-weighted L1 distance.
    pub l1: Option<f64>,
    /// Its part that noise explains.
    pub l1_noise: Option<f64>,
    /// What is left.
    pub l1_model: Option<f64>,
    /// Below this, `l1_model` cannot be told from 0: half of `l1_noise`.
    pub l1_model_floor: Option<f64>,
    /// Squared L2 discrepancy with the noise taken off: unbiased, it may be negative.
    pub l2_model_sq: Option<f64>,
}

/// One stop of a comparison.
#[derive(Debug, Clone, Serialize)]
pub struct StopComparison {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Azimuth of the light.
    pub phi_i_deg: f64,
    /// The model's flux into all bins, mean of the colours; null for an arm.
    pub albedo_model: Option<f64>,
    /// The error measures.
    #[serde(flatten)]
    pub figures: Figures,
    /// Largest |f-m|/se.
    pub max_t: Option<f64>,
    /// Share of the bins whose 95 % interval misses the model.
    pub share_outside_95: Option<f64>,
    /// Degrees of freedom of t: realisations - 1.
    pub dof: usize,
    /// Bins and colours that t was computed for.
    #[serde(skip)]
    pub judged: usize,
}

/// One colour of one stop.
pub struct StopData<'a> {
    /// Measured.
    pub value: &'a [f32],
    /// Standard errors, -1: not available.
    pub stderr: &'a [f32],
    /// Arrivals.
    pub hits: &'a [u32],
    /// The model.
    pub model: &'a [f64],
    /// Projected solid angles.
    pub size: &'a [f64],
    /// Bins that count in statistics: of a folded pair, one.
    pub counted: &'a [bool],
    /// Realisations.
    pub realisations: usize,
}

/// What one colour of one stop shows.
#[derive(Debug, Clone, Copy, Default)]
pub struct ColourFigures {
    /// The error measures.
    pub figures: Figures,
    /// The model's flux.
    pub albedo_model: f64,
    /// Largest |t| of the counted bins.
    pub max_t: Option<f64>,
    /// Counted bins whose 95 % interval misses the model.
    pub outside: usize,
    /// Counted bins with an error bar.
    pub bins: usize,
}

impl StopData<'_> {
    /// The figures of this stop and colour.
    pub fn figures(&self) -> ColourFigures {
        let known = self.realisations > 1;
        let limit = if known { stats::student_limit(0.05, self.realisations - 1) } else { f64::INFINITY };
        let (mut distance, mut noise, mut flux) = (0.0, 0.0, 0.0);
        let (mut square, mut model_square) = (0.0, 0.0);
        let mut out = ColourFigures::default();
        for bin in 0..self.value.len() {
            let (f, m, w) = (f64::from(self.value[bin]), self.model[bin], self.size[bin]);
            // A bin that only higher orders reach is empty as well.
            let hit = self.hits[bin] > 0 && f > 0.0;
            // An empty bin is off by its own mean, not by the 1.5 hits that its error bar allows for.
            let se = if hit { f64::from(self.stderr[bin]) } else { f64::from(self.stderr[bin]).min(m) };
            distance += (f - m).abs() * w;
            noise += se * w;
            flux += m * w;
            square += w * ((f - m) * (f - m) - if hit { se * se } else { 0.0 });
            model_square += w * m * m;
            if known && hit && self.counted[bin] && se > 0.0 {
                let t = (f - m).abs() / se;
                out.max_t = Some(out.max_t.map_or(t, |max: f64| max.max(t)));
                out.outside += usize::from(t > limit);
                out.bins += 1;
            }
        }
        out.albedo_model = flux;
        if flux > 0.0 {
            let l1 = distance / flux;
            let l1_noise = known
                .then(|| (2.0 / std::f64::consts::PI).sqrt() / stats::c4(self.realisations) * noise / flux);
            let enough = l1_noise.filter(|_| self.realisations >= 4);
            out.figures = Figures {
                l1: Some(l1),
                l1_noise,
                l1_model: enough.map(|noise| (l1 * l1 - noise * noise).max(0.0).sqrt()),
                l1_model_floor: enough.map(|noise| 0.5 * noise),
                l2_model_sq: known.then_some(square / model_square),
            };
        }
        out
    }
}

impl Figures {
    /// Means of what is available; null where nothing is.
    pub fn mean<'a>(all: impl Iterator<Item = &'a Figures> + Clone) -> Figures {
        let mean = |pick: fn(&Figures) -> Option<f64>| {
            let values: Vec<f64> = all.clone().filter_map(pick).collect();
            (!values.is_empty()).then(|| stats::mean(&values))
        };
        Figures {
            l1: mean(|f| f.l1),
            l1_noise: mean(|f| f.l1_noise),
            l1_model: mean(|f| f.l1_model),
            l1_model_floor: mean(|f| f.l1_model_floor),
            l2_model_sq: mean(|f| f.l2_model_sq),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bins of size 2 and 1, model 1 and 4, measured 1.5 and 3, errors 0.25 and 0.5, R = 5.
    #[test]
    fn the_error_measures_follow_their_definitions() {
        let data = StopData {
            value: &[1.5, 3.0],
            stderr: &[0.25, 0.5],
            hits: &[10, 10],
            model: &[1.0, 4.0],
            size: &[2.0, 1.0],
            counted: &[true, true],
            realisations: 5,
        };
        let found = data.figures();
        // l1 = (0.5 2 + 1 1)/(1 2 + 4 1) = 1/3; sum se w = 1; c4(5) = 0.939986 (tables).
        let noise = (2.0 / std::f64::consts::PI).sqrt() / 0.939_986 / 6.0;
        assert!((found.figures.l1.unwrap() - 1.0 / 3.0).abs() < 1e-15);
        assert!((found.figures.l1_noise.unwrap() - noise).abs() < 1e-6);
        let model = (1.0f64 / 9.0 - noise * noise).sqrt();
        assert!((found.figures.l1_model.unwrap() - model).abs() < 1e-6);
        // (2 (0.25 - 0.0625) + (1 - 0.25))/(2 + 16).
        assert!((found.figures.l2_model_sq.unwrap() - 1.125 / 18.0).abs() < 1e-15);
        // t = 2 in both bins, t(0.975, 4) = 2.776.
        assert_eq!((found.max_t, found.outside, found.bins), (Some(2.0), 0, 2));
    }

    #[test]
    fn one_realisation_has_no_noise_figures() {
        let data = StopData {
            value: &[1.0],
            stderr: &[-1.0],
            hits: &[1],
            model: &[1.0],
            size: &[1.0],
            counted: &[true],
            realisations: 1,
        };
        let found = data.figures();
        assert_eq!((found.figures.l1, found.figures.l1_noise, found.max_t), (Some(0.0), None, None));
    }
}
