//! A measured power spectral density: numbers at frequencies, and the areal density that they stand for.

use serde::Serialize;

/// Frequencies of a table at most: each of a profile looks at all above it.
const MOST: usize = 2000;
/// Steps of Simpson's rule in a stretch of 1 of the logarithm of frequency, two at least.
const STEPS: f64 = 16.0;
/// Powers of e by which the rest of a falling profile has died away where its transform ends.
const REST: f64 = 40.0;

/// What the numbers of a table are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PsdKind {
    /// Areal density S(f), um^4.
    Areal,
    /// One-sided density S1(f) of a profile, um^3.
    Profile,
}

/// Densities at spatial frequencies; between them a power law, outside of them no waves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PsdTable {
    /// What the numbers are.
    pub kind: PsdKind,
    /// Spatial frequencies, 1/um, above 0, increasing, two at least.
    pub frequency_per_um: Vec<f64>,
    /// Densities there, above 0.
    pub density: Vec<f64>,
    /// Areal densities there, um^4.
    #[serde(skip)]
    areal: Vec<f64>,
}

impl PsdTable {
    /// A table of two frequencies or more; `Err` says which number stands for no isotropic surface.
    ///
    /// A profile's density becomes S(f) = -1/(2 pi) integral from f of S1'(x)/sqrt(x^2 - f^2) dx (the inverse of
    /// S1(x) = 4 integral from 0 of S(sqrt(x^2 + y^2)) dy; Church and Takacs 1991), S1 going on beyond its last frequency as
    /// between the last two.
    // Tested by `a_profile_s_density_becomes_the_areal_one` (tests/it/surface/psd.rs).
    pub fn new(kind: PsdKind, frequency_per_um: Vec<f64>, density: Vec<f64>) -> Result<Self, String> {
        check(&frequency_per_um, &density)?;
        let areal = match kind {
            PsdKind::Areal => density.clone(),
            PsdKind::Profile => areal_of_profile(&frequency_per_um, &density)?,
        };
        Ok(PsdTable { kind, frequency_per_um, density, areal })
    }

    /// Lowest and highest frequency, 1/um.
    pub fn ends(&self) -> [f64; 2] {
        [self.frequency_per_um[0], self.frequency_per_um[self.frequency_per_um.len() - 1]]
    }

    /// Areal density at a frequency, um^4; 0 outside the table.
    pub fn areal(&self, f: f64) -> f64 {
        let all = &self.frequency_per_um;
        let [low, high] = self.ends();
        if !(low..=high).contains(&f) {
            return 0.0;
        }
        let k = all.partition_point(|&known| known <= f).clamp(1, all.len() - 1) - 1;
        self.areal[k] * (f / all[k]).powf(-fall(all, &self.areal, k))
    }
}

fn check(frequency: &[f64], density: &[f64]) -> Result<(), String> {
    if frequency.len() != density.len() || frequency.len() < 2 {
        return Err("needs as many densities as frequencies, two at least".into());
    }
    if frequency.len() > MOST {
        return Err(format!("has {} frequencies; {MOST} at most: average neighbours", frequency.len()));
    }
    let wrong = |value: &f64| !(value.is_finite() && *value > 0.0);
    if let Some(f) = frequency.iter().find(|f| wrong(f)) {
        return Err(format!("has a frequency {f}: must be above 0 (the mean is no wave)"));
    }
    if let Some(k) = frequency.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(format!("has {} after {}: frequencies must increase", frequency[k + 1], frequency[k]));
    }
    match density.iter().position(wrong) {
        Some(k) => Err(format!("has a density {} at {} /um: must be above 0", density[k], frequency[k])),
        None => Ok(()),
    }
}

/// The power p with which numbers fall from frequency k to the next, as f^-p.
fn fall(frequency: &[f64], density: &[f64], k: usize) -> f64 {
    -(density[k + 1] / density[k]).ln() / (frequency[k + 1] / frequency[k]).ln()
}

fn areal_of_profile(frequency: &[f64], profile: &[f64]) -> Result<Vec<f64>, String> {
    let last = frequency.len() - 1;
    let end = fall(frequency, profile, last - 1);
    if end <= 0.0 {
        return Err(format!(
            "does not fall at its last frequency {} /um: no areal PSD has this profile",
            frequency[last]
        ));
    }
    let at = |k: usize| {
        let f = frequency[k];
        // x = f cosh t takes the root away: S1'(x) = -p S1(x)/x on each power law.
        let place = |x: f64| (x / f).acosh();
        let mut sum = 0.0;
        for j in k..last {
            let p = fall(frequency, profile, j);
            let slope = |t: f64| p * profile[j] * (f * t.cosh() / frequency[j]).powf(-p) / (f * t.cosh());
            sum += simpson(slope, place(frequency[j]), place(frequency[j + 1]));
        }
        let rest =
            |t: f64| end * profile[last] * (f * t.cosh() / frequency[last]).powf(-end) / (f * t.cosh());
        let from = place(frequency[last]);
        sum += simpson(rest, from, from + REST / (1.0 + end));
        sum / std::f64::consts::TAU
    };
    let areal: Vec<f64> = (0..=last).map(at).collect();
    match areal.iter().position(|density| *density <= 0.0) {
        Some(k) => {
            Err(format!("rises too steeply beyond {} /um: no areal PSD has this profile", frequency[k]))
        }
        None => Ok(areal),
    }
}

/// Simpson's rule over a function of logarithms, in an even number of steps.
fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let steps = 2 * ((to - from) * STEPS / 2.0).ceil().max(1.0) as usize;
    let width = (to - from) / steps as f64;
    let weight = |k: usize| match k {
        0 => 1.0,
        k if k == steps => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    (0..=steps).map(|k| weight(k) * f(from + k as f64 * width)).sum::<f64>() * width / 3.0
}
