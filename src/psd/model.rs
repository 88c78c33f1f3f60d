//! The models of a power spectral density, and the frequencies between which a surface has waves.

use std::f64::consts::PI;

use serde::Serialize;
use statrs::function::gamma::ln_gamma;

use super::table::PsdTable;

/// Rounding by which a wave on a limit of the frequencies still counts as between them.
const ON_THE_LIMIT: f64 = 1e-9;

/// A density, and the frequencies between which a surface is made of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Psd {
    /// The density.
    #[serde(flatten)]
    pub model: PsdModel,
    /// There are no waves below, 1/um. `None`: no such limit.
    pub f_min_per_um: Option<f64>,
    /// There are none above, 1/um. `None`: up to half a wave for each cell.
    pub f_max_per_um: Option<f64>,
}

/// The models.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "model", rename_all = "snake_case")]
pub enum PsdModel {
    /// K-correlation (ABC): a profile has S1(f) = A/(1 + (B f)^2)^(C/2), one-sided (Church and Takacs 1991).
    KCorrelation {
        /// A, um^3.
        a_um3: f64,
        /// B, um: 2 pi times the correlation length.
        b_um: f64,
        /// C, above 1.
        c: f64,
    },
    /// S(f) in proportion to f^(-2 (H + 1)) between two frequencies.
    SelfAffine {
        /// Root mean square height, um.
        rms_um: f64,
        /// Hurst exponent H in (0, 1).
        hurst: f64,
    },
    /// Measured.
    Table(PsdTable),
}

impl Psd {
    /// The frequencies between which there are waves on cells of a pitch, 1/um; the higher is at most half of one over
    /// the pitch.
    pub fn band(&self, pitch_um: f64) -> [f64; 2] {
        let nyquist = 0.5 / pitch_um;
        [self.f_min_per_um.unwrap_or(0.0), self.f_max_per_um.map_or(nyquist, |highest| highest.min(nyquist))]
    }

    /// Areal density at a frequency f > 0 on cells of a pitch, um^4; 0 outside the [`band`](Self::band).
    ///
    /// - K-correlation: A B Gamma((C + 1)/2)/(2 sqrt(pi) Gamma(C/2)) (1 + (B f)^2)^(-(C + 1)/2), which has the profile
    ///   S1; its integral is 2 pi S(0)/(B^2 (C - 1)).
    /// - Self-affine: H rms^2/(pi (f1^(-2 H) - f2^(-2 H))) f^(-2 (H + 1)), f1 and f2 the band: its integral is rms^2.
    // Tested by `densities_integrate_to_their_closed_forms` (tests/it/surface/psd.rs).
    pub fn areal(&self, f: f64, pitch_um: f64) -> f64 {
        self.on(pitch_um)(f)
    }

    /// The same as a function of f, its constants worked out once.
    pub fn on(&self, pitch_um: f64) -> impl Fn(f64) -> f64 + Sync + '_ {
        let [low, high] = self.band(pitch_um);
        let [constant, power] = match &self.model {
            PsdModel::KCorrelation { a_um3, b_um, c } => {
                let gammas = (ln_gamma(0.5 * (c + 1.0)) - ln_gamma(0.5 * c)).exp();
                [0.5 * a_um3 * b_um * gammas / PI.sqrt(), -0.5 * (c + 1.0)]
            }
            PsdModel::SelfAffine { rms_um, hurst } => {
                // In units of the lowest frequency: -expm1 keeps its digits for a narrow band and a small H.
                let share = -(2.0 * hurst * (low / high).ln()).exp_m1();
                [hurst * rms_um * rms_um / (PI * low * low * share), -2.0 * (hurst + 1.0)]
            }
            PsdModel::Table(_) => [1.0, 0.0],
        };
        move |f| {
            if f < low * (1.0 - ON_THE_LIMIT) || f > high * (1.0 + ON_THE_LIMIT) {
                return 0.0;
            }
            match &self.model {
                PsdModel::KCorrelation { b_um, .. } => constant * (1.0 + (b_um * f).powi(2)).powf(power),
                PsdModel::SelfAffine { .. } => constant * (f / low).powf(power),
                PsdModel::Table(table) => table.areal(f),
            }
        }
    }
}
