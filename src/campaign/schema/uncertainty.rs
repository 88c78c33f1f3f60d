//! How well an instrument is known, checked: `[uncertainty]`. What `measure` makes does not depend on it.

use serde::Serialize;

/// A pivot of the correlation matrix below this is a rounding of 0: sums of at most 15 products of numbers up to 1.
const ROUNDING: f64 = 1e-12;

/// The quantities that an instrument has an uncertainty of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Polar angle of the light, degrees.
    LampThetaDeg,
    /// Azimuth of the light, degrees.
    LampPhiDeg,
    /// Polar angle of the sensor, degrees.
    SensorThetaDeg,
    /// Azimuth of the sensor, degrees.
    SensorPhiDeg,
    /// The sample turned about the stage's x axis, degrees.
    TiltXDeg,
    /// The sample turned about the stage's y axis, degrees.
    TiltYDeg,
    /// What heights are to be multiplied by, less 1.
    HeightScale,
    /// What the distance of neighbouring heights is to be multiplied by, less 1.
    PitchScale,
    /// Half-angle of the light's cone, relative.
    LampCone,
    /// Half-angle of the sensor's aperture, relative.
    SensorAperture,
    /// Real part of the index of refraction, absolute or relative.
    N,
    /// Its imaginary part.
    K,
    /// Reflectance at normal incidence.
    F0,
    /// Reflectance of matt facets.
    Albedo,
    /// What every reading is to be multiplied by, less 1: linearity of the detector, reference standard.
    Reading,
}

/// Names of the quantities in a campaign, in the order of [`Quantity`].
pub const QUANTITIES: [(&str, Quantity); 15] = [
    ("lamp_theta_deg", Quantity::LampThetaDeg),
    ("lamp_phi_deg", Quantity::LampPhiDeg),
    ("sensor_theta_deg", Quantity::SensorThetaDeg),
    ("sensor_phi_deg", Quantity::SensorPhiDeg),
    ("tilt_x_deg", Quantity::TiltXDeg),
    ("tilt_y_deg", Quantity::TiltYDeg),
    ("height_scale", Quantity::HeightScale),
    ("pitch_scale", Quantity::PitchScale),
    ("lamp_cone", Quantity::LampCone),
    ("sensor_aperture", Quantity::SensorAperture),
    ("n", Quantity::N),
    ("k", Quantity::K),
    ("f0", Quantity::F0),
    ("albedo", Quantity::Albedo),
    ("reading", Quantity::Reading),
];

impl Quantity {
    /// Its name in a campaign.
    pub fn name(self) -> &'static str {
        QUANTITIES[self as usize].0
    }
}

/// The distribution of an input's error about 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// Normal.
    Normal,
    /// Even between two limits.
    Rectangular,
    /// Triangular between two limits.
    Triangular,
    /// That of a sine: most often near its limits.
    Arcsine,
    /// Student's t, of a mean of repeated observations.
    T,
}

/// One input quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InputQuantity {
    /// What it is.
    pub quantity: Quantity,
    /// The law of its error.
    pub distribution: Distribution,
    /// Standard uncertainty of `Normal` and `T`, > 0; else half of the distance between the limits.
    pub scale: f64,
    /// Degrees of freedom of the standard uncertainty, >= 1, of `T` >= 3. `None`: it is known.
    pub dof: Option<f64>,
    /// Whether the scale of n, k, f0 and albedo is a part of the quantity; of the others see [`Quantity`].
    pub relative: bool,
}

impl InputQuantity {
    /// u(x): the scale itself, or half-width/sqrt(3), sqrt(6), sqrt(2) (JCGM 100, 4.3.7, 4.3.9; JCGM 101, 6.4).
    pub fn standard_uncertainty(&self) -> f64 {
        match self.distribution {
            Distribution::Normal | Distribution::T => self.scale,
            Distribution::Rectangular => self.scale / 3f64.sqrt(),
            Distribution::Triangular => self.scale / 6f64.sqrt(),
            Distribution::Arcsine => self.scale / 2f64.sqrt(),
        }
    }
}

/// A correlation coefficient of two inputs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Correlation {
    /// Which inputs; both are given, and differ.
    pub between: [Quantity; 2],
    /// In [-1, 1].
    pub coefficient: f64,
}

/// `[uncertainty]`: all inputs, and the pairs of directions that a budget is made for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Uncertainty {
    /// In the order of [`QUANTITIES`], each once.
    pub inputs: Vec<InputQuantity>,
    /// Of some pairs of them; the matrix of all has no negative eigenvalue.
    pub correlations: Vec<Correlation>,
    /// `[theta_i, phi_i, theta_r, phi_r]` of a campaign without an arm; empty: all positions of its arm.
    pub at_deg: Vec<[f64; 4]>,
    /// Half-angle of the aperture about them.
    pub aperture_deg: Option<f64>,
    /// Surface samples per incidence and realisation in every run. `None`: those of `[stop]`.
    pub samples: Option<u64>,
    /// Trials of the Monte Carlo method.
    pub trials: u64,
}

impl Uncertainty {
    /// The correlation matrix of the inputs.
    pub fn correlation_matrix(&self) -> Vec<Vec<f64>> {
        let count = self.inputs.len();
        let place = |quantity| self.inputs.iter().position(|input| input.quantity == quantity);
        let mut matrix = vec![vec![0.0; count]; count];
        for (k, row) in matrix.iter_mut().enumerate() {
            row[k] = 1.0;
        }
        for Correlation { between: [a, b], coefficient } in &self.correlations {
            if let (Some(a), Some(b)) = (place(*a), place(*b)) {
                matrix[a][b] = *coefficient;
                matrix[b][a] = *coefficient;
            }
        }
        matrix
    }

    /// L of R = L L^T, rows of the lower triangle: what makes independent normal numbers correlated.
    ///
    /// Errors: the first input that no numbers with these correlations exist with. Coefficients of +-1 are allowed.
    pub fn correlation_factor(&self) -> Result<Vec<Vec<f64>>, Quantity> {
        lower_factor(&self.correlation_matrix()).map_err(|k| self.inputs[k].quantity)
    }
}

/// Cholesky's factor of a correlation matrix that may be singular; the row where it has none.
// Tested by `correlations_that_no_numbers_have_are_refused_by_name` (tests/it/budget/schema.rs).
fn lower_factor(matrix: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, usize> {
    let count = matrix.len();
    let mut factor = vec![vec![0.0; count]; count];
    for row in 0..count {
        for column in 0..=row {
            let dot: f64 = (0..column).map(|k| factor[row][k] * factor[column][k]).sum();
            let rest = matrix[row][column] - dot;
            let pivot: f64 = factor[column][column];
            factor[row][column] = match (row == column, pivot > 0.0) {
                (true, _) if rest < -ROUNDING => return Err(row),
                (true, _) if rest <= ROUNDING => 0.0,
                (true, _) => rest.sqrt(),
                (false, true) => rest / pivot,
                // An input that follows from those before it: this one must agree with them.
                (false, false) if rest.abs() > ROUNDING.sqrt() => return Err(row),
                (false, false) => 0.0,
            };
        }
    }
    Ok(factor)
}
