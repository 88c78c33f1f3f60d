//! The fit of one model: the divergence that is minimised, its gradient, and damped Fisher scoring within bounds.
//!
//! The divergence of a model m from values f, w the sizes of the bins and e the floor, is
//! sum w (y ln(y/z) - y + z), y = f + e, z = m + e: Poisson's likelihood (Kullback and Leibler's divergence of the
//! reflected flux). Its gradient is sum w (m - f)/z dm: bins weigh by their size over the *model*, so no draw of the noise
//! decides how much it counts, the mean over realisations enters linearly, and an exact model is met without bias,
//! whatever the noise is. Weights from the scatter of few realisations pull towards what they happen to agree on.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::data::FitData;
use super::law::{Amplitudes, FitLaw};
use super::nodes::{IncidenceNodes, Lobe};
use super::sample::FitSample;

/// Step of the forward differences in the shape: 1e-7 of a second derivative, 1e-9 by rounding.
const STEP: f64 = 1e-7;
/// Largest change of a shape's parameter in one step.
const LONGEST: f64 = 1.0;
/// Share of the flux that the next step may still gain where a fit ends: parameters are then right to 1e-7.
pub const EXACT: f64 = 1e-14;
/// The same where all values or the picture's are fitted after it, or nothing but an order is asked for: to 1e-5.
pub const NEAR: f64 = 1e-10;
/// The same where rounding hides any gain.
const ROUNDED: f64 = 1e-10;
/// Share of the flux below which a parameter is without influence.
const IDLE: f64 = 1e-13;
/// Steps at most.
const STEPS: usize = 60;

/// Entries of a table with their nodes.
pub struct FitLayout {
    nodes: Vec<IncidenceNodes>,
    entries: Vec<usize>,
    /// Size of each entry's bin times the number of entries that it stands for.
    sizes: Vec<f64>,
}

impl FitLayout {
    /// The layout of `sample` for lobes as narrow as `lobe`.
    pub fn new(data: &FitData, sample: &FitSample, lobe: Lobe) -> FitLayout {
        let sizes = sample.entries.iter().zip(&sample.shares).map(|(&entry, share)| data.size[entry] * share);
        FitLayout {
            nodes: IncidenceNodes::of_entries(&data.grid, &sample.entries, data.aperture, lobe),
            sizes: sizes.collect(),
            entries: sample.entries.clone(),
        }
    }
}

/// Both bases of every entry of a layout.
pub type LayoutBasis = Vec<[f64; 2]>;

/// One model against a table.
pub struct Problem<'a> {
    data: &'a FitData,
    layout: &'a FitLayout,
    /// The model.
    pub law: FitLaw,
    /// Number of the shape's parameters; amplitudes follow, colour by colour.
    pub shapes: usize,
    kind: Amplitudes,
    bounds: Vec<[f64; 2]>,
    flux: f64,
}

/// Where a fit stands.
#[derive(Clone)]
pub struct State {
    /// Shape first, then the amplitudes of each colour.
    pub params: Vec<f64>,
    /// Both bases at `params`.
    pub basis: LayoutBasis,
    /// The divergence there.
    pub divergence: f64,
}

/// The gradient of the divergence and the expectation of its second derivatives.
pub struct LocalShape {
    /// By each parameter.
    pub gradient: DVector<f64>,
    /// Fisher's matrix: sum w/z dm dm'.
    pub fisher: DMatrix<f64>,
}

impl<'a> Problem<'a> {
    /// The problem of fitting `law` to the values of `data` at the incidences of `layout`.
    pub fn new(data: &'a FitData, layout: &'a FitLayout, law: FitLaw) -> Self {
        let kind = law.amplitudes(data.perfect_mirror);
        let shape = law.bounds();
        let most = if kind == Amplitudes::Schlick { 1.0 } else { f64::INFINITY };
        let amplitudes = vec![[0.0, most]; kind.per_colour() * data.value.len()];
        let flux = |(colour, values): (usize, &Vec<f64>)| {
            let at = layout.entries.iter().zip(&layout.sizes);
            at.map(|(&entry, size)| size * (values[entry].abs() + data.floor[colour])).sum::<f64>()
        };
        let flux = data.value.iter().enumerate().map(flux).sum();
        let shapes = shape.len();
        Problem { data, layout, law, shapes, kind, bounds: [shape, amplitudes].concat(), flux }
    }

    /// The divergence at `params`.
    pub fn at(&self, params: Vec<f64>) -> State {
        let basis = self.basis(&params[..self.shapes]);
        let divergence = self.divergence(&params, &basis);
        State { params, basis, divergence }
    }

    /// Minimises the divergence from `params` until a step gains less than `least` of the flux ([`EXACT`], [`NEAR`]), and
    /// says whether it came so far.
    pub fn solve(&self, params: Vec<f64>, least: f64) -> (State, bool) {
        let start = self.polished(self.at(params), least);
        self.descend(start, true, least)
    }

    /// The parameters that are neither at a bound that holds them back nor without influence.
    pub fn free(&self, params: &[f64], local: &LocalShape) -> Vec<usize> {
        let free = |&k: &usize| {
            let ([low, high], slope) = (self.bounds[k], local.gradient[k]);
            let held = params[k] <= low && slope > 0.0 || params[k] >= high && slope < 0.0;
            let scale = if k < self.shapes { 1.0 } else { params[k].abs().max(f64::MIN_POSITIVE) };
            !held
                && (local.fisher[(k, k)] * scale * scale > IDLE * self.flux
                    || k >= self.shapes && slope < 0.0)
        };
        (0..params.len()).filter(free).collect()
    }

    /// The parameters that stand on a bound.
    pub fn on_bound(&self, params: &[f64]) -> Vec<usize> {
        (0..params.len())
            .filter(|&k| params[k] <= self.bounds[k][0] || params[k] >= self.bounds[k][1])
            .collect()
    }

    /// The model's means at a state, [colour][entry of the layout].
    pub fn model(&self, state: &State) -> Vec<Vec<f64>> {
        let colour = |colour| state.basis.iter().map(|b| self.value(&state.params, colour, *b)).collect();
        (0..self.data.value.len()).map(colour).collect()
    }

    /// Derivatives of both bases by each parameter of the shape.
    pub fn derivatives(&self, state: &State) -> Vec<LayoutBasis> {
        let by = |k: usize| {
            let mut shape = state.params[..self.shapes].to_vec();
            shape[k] += STEP;
            let slope = |(up, here): ([f64; 2], &[f64; 2])| [0, 1].map(|i| (up[i] - here[i]) / STEP);
            self.basis(&shape).into_iter().zip(&state.basis).map(slope).collect()
        };
        (0..self.shapes).into_par_iter().map(by).collect()
    }

    /// Gradient and Fisher's matrix for the values `target`; without `slopes` the shape is held.
    pub fn local(&self, state: &State, slopes: &[LayoutBasis], target: &[Vec<f64>]) -> LocalShape {
        let count = state.params.len();
        let (mut gradient, mut fisher) = (DVector::zeros(count), DMatrix::zeros(count, count));
        let per_colour = self.kind.per_colour();
        let mut moved: Vec<(usize, f64)> = Vec::with_capacity(slopes.len() + per_colour);
        for (colour, values) in target.iter().enumerate() {
            for (slot, &entry) in self.layout.entries.iter().enumerate() {
                let w = self.layout.sizes[slot];
                if w == 0.0 {
                    continue;
                }
                let (m, floor) =
                    (self.value(&state.params, colour, state.basis[slot]), self.data.floor[colour]);
                moved.clear();
                moved.extend(
                    (0..slopes.len()).map(|k| (k, self.by_shape(&state.params, colour, slopes[k][slot]))),
                );
                let first = self.shapes + colour * per_colour;
                moved.extend((0..per_colour).map(|k| (first + k, self.by_amplitude(k, state.basis[slot]))));
                let weight = w / (m + floor);
                for &(i, d) in &moved {
                    gradient[i] += weight * (m - values[entry]) * d;
                    moved.iter().for_each(|&(j, e)| fisher[(i, j)] += weight * d * e);
                }
            }
        }
        LocalShape { gradient, fisher }
    }

    /// Fisher scoring; where `shape` is false the basis stays and only amplitudes move, which costs little.
    fn descend(&self, mut state: State, shape: bool, least: f64) -> (State, bool) {
        if state.params.len() == if shape { 0 } else { self.shapes } {
            return (state, true);
        }
        let mut damping = 0.0;
        for _ in 0..STEPS {
            let slopes = if shape { self.derivatives(&state) } else { Vec::new() };
            let local = self.local(&state, &slopes, &self.data.value);
            let mut free = self.free(&state.params, &local);
            free.retain(|&k| shape || k >= self.shapes);
            loop {
                let step = step(&local, &free, damping, &state.params);
                let gain = -0.5 * step.dot(&local.gradient);
                if gain <= least * self.flux {
                    return (state, true);
                }
                let trial = self.moved(&state, &step, shape, least);
                if trial.divergence < state.divergence {
                    state = trial;
                    damping = if damping < 1e-5 { 0.0 } else { 0.1 * damping };
                    break;
                }
                if damping > 1e8 {
                    return (state, gain <= ROUNDED * self.flux);
                }
                damping = (10.0 * damping).max(1e-3);
            }
        }
        (state, false)
    }

    /// The state with the best amplitudes of its shape.
    fn polished(&self, state: State, least: f64) -> State {
        self.descend(state, false, least).0
    }

    fn moved(&self, state: &State, step: &DVector<f64>, shape: bool, least: f64) -> State {
        let longest = (0..self.shapes).map(|k| step[k].abs()).fold(LONGEST, f64::max);
        let moved = |k: usize| {
            let [low, high] = self.bounds[k];
            (state.params[k] + step[k] * LONGEST / longest).clamp(low, high)
        };
        let mut params: Vec<f64> = (0..state.params.len()).map(moved).collect();
        if shape {
            self.law.confine(&mut params[..self.shapes]);
            return self.polished(self.at(params), least);
        }
        let divergence = self.divergence(&params, &state.basis);
        State { params, basis: state.basis.clone(), divergence }
    }

    fn basis(&self, shape: &[f64]) -> LayoutBasis {
        self.layout.nodes.par_iter().map(|nodes| self.law.means(shape, nodes)).collect::<Vec<_>>().concat()
    }

    fn divergence(&self, params: &[f64], basis: &[[f64; 2]]) -> f64 {
        let mut sum = 0.0;
        for (colour, values) in self.data.value.iter().enumerate() {
            let floor = self.data.floor[colour];
            for ((&entry, size), &basis) in self.layout.entries.iter().zip(&self.layout.sizes).zip(basis) {
                let m = self.value(params, colour, basis);
                sum += size * term(values[entry], m, floor);
            }
        }
        sum
    }

    fn amplitude(&self, params: &[f64], colour: usize, k: usize) -> f64 {
        params[self.shapes + colour * self.kind.per_colour() + k]
    }

    fn value(&self, params: &[f64], colour: usize, [a, b]: [f64; 2]) -> f64 {
        match self.kind {
            Amplitudes::Fixed => a,
            Amplitudes::Schlick => self.amplitude(params, colour, 0) * (a - b) + b,
            Amplitudes::One => self.amplitude(params, colour, 0) * a,
            Amplitudes::Two => self.amplitude(params, colour, 0) * a + self.amplitude(params, colour, 1) * b,
        }
    }

    /// What the value changes by where both bases do: it is linear in them.
    fn by_shape(&self, params: &[f64], colour: usize, slopes: [f64; 2]) -> f64 {
        self.value(params, colour, slopes)
    }

    fn by_amplitude(&self, k: usize, [a, b]: [f64; 2]) -> f64 {
        match self.kind {
            Amplitudes::Schlick => a - b,
            _ if k == 0 => a,
            _ => b,
        }
    }
}

/// y ln(y/z) - y + z of y = f + e and z = m + e, as z ((1 + u) ln(1 + u) - u), u = (f - m)/z: small differences keep
/// their digits. Below y = 0 the logarithm is that of |y|, which no model sees.
fn term(f: f64, m: f64, floor: f64) -> f64 {
    let z = m + floor;
    let u = (f - m) / z;
    let log = if u > -1.0 { u.ln_1p() } else { (-1.0 - u).max(f64::MIN_POSITIVE).ln() };
    z * ((1.0 + u) * log - u)
}

/// The divergence of whole models, entry by entry of a table.
pub fn divergence(data: &FitData, model: &[Vec<f64>]) -> f64 {
    let of = |(colour, entry): (usize, usize)| {
        data.size[entry] * term(data.value[colour][entry], model[colour][entry], data.floor[colour])
    };
    data.entries().map(of).sum()
}

/// The damped step of the free parameters, 0 for all others. An amplitude at 0 has a scale of its own: its diagonal.
fn step(local: &LocalShape, free: &[usize], damping: f64, params: &[f64]) -> DVector<f64> {
    let mut step = DVector::zeros(params.len());
    let (mut matrix, gradient) = reduced(local, free);
    for k in 0..free.len() {
        matrix[(k, k)] *= 1.0 + damping + 1e-12;
    }
    if let Some(factors) = matrix.cholesky() {
        let solved = factors.solve(&gradient);
        free.iter().enumerate().for_each(|(k, &at)| step[at] = -solved[k]);
    } else {
        // Two parameters that do the same: each by itself.
        for &at in free {
            step[at] = -local.gradient[at] / (local.fisher[(at, at)] * (1.0 + damping) * free.len() as f64);
        }
    }
    step
}

/// Matrix and gradient of the free parameters alone.
fn reduced(local: &LocalShape, free: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
    let n = free.len();
    let matrix = DMatrix::from_fn(n, n, |i, j| local.fisher[(free[i], free[j])]);
    (matrix, DVector::from_fn(n, |i, _| local.gradient[free[i]]))
}
