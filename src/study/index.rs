//! How much a 3-D table loses: the deviation of the turned BRDFs from their mean over the turn, without the noise.
//!
//! With d_k(phi) the deviation in realisation k, products of *different* realisations estimate d^2 without bias:
//! (sum d)^2 - sum d^2 over R (R - 1). The index is sqrt(max(0, sum w d^2/sum w fbar^2)) over turns and bins.

use serde::Serialize;

use crate::fit::FitData;
use crate::stats;

/// The index of all incidences with one theta_i.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct IncidenceIndex {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// The index.
    pub anisotropy_index: f64,
    /// Its standard error; null with fewer than three realisations.
    pub anisotropy_index_se: Option<f64>,
}

/// The bin that adds most to the index.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Worst {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Polar angle of the bin's centre.
    pub theta_r_deg: f64,
    /// Azimuth of the bin's centre, from the light.
    pub phi_r_deg: f64,
    /// Root mean square deviation over the turn, relative to the mean.
    pub relative_deviation: f64,
}

/// The index of a whole study.
pub(super) struct IndexOfStudy {
    /// Of all incidences.
    pub value: f64,
    /// Standard error.
    pub se: Option<f64>,
    /// By theta_i.
    pub incidences: Vec<IncidenceIndex>,
    /// Where it is largest; `None` where nothing is left above the noise.
    pub worst: Option<Worst>,
}

/// Sums over the turns of one bin and theta_i, all realisations and all but each one.
struct Turned {
    /// Unbiased sum of d^2, [0] with all, [1 + k] without realisation k.
    square: Vec<f64>,
    /// Sum of fbar^2.
    mean_square: f64,
}

pub(super) fn index(data: &FitData) -> IndexOfStudy {
    let (bins, turns) = (data.grid.bins(), data.grid.phi_i_deg.len());
    let count = data.parts.len();
    let mut all = vec![0.0; count + 1];
    let (mut flux, mut incidences, mut worst) = (0.0, Vec::new(), None::<(f64, Worst)>);
    for (row, &theta_i_deg) in data.grid.theta_i_deg.iter().enumerate() {
        let (mut here, mut here_flux) = (vec![0.0; count + 1], 0.0);
        for bin in 0..bins {
            for colour in 0..data.value.len() {
                let turned = turned(
                    data,
                    colour,
                    (row * turns..(row + 1) * turns).map(|incidence| incidence * bins + bin),
                );
                let w = data.size[row * turns * bins + bin];
                here.iter_mut().zip(&turned.square).for_each(|(sum, square)| *sum += w * square);
                here_flux += w * turned.mean_square;
                let cost = w * turned.square[0];
                if cost > worst.map_or(0.0, |(most, _)| most) {
                    let relative_deviation = (turned.square[0] / turned.mean_square).sqrt();
                    let (theta_r_deg, phi_r_deg) = centre(data, bin);
                    worst = Some((cost, Worst { theta_i_deg, theta_r_deg, phi_r_deg, relative_deviation }));
                }
            }
        }
        let (anisotropy_index, anisotropy_index_se) = root(&here, here_flux);
        incidences.push(IncidenceIndex { theta_i_deg, anisotropy_index, anisotropy_index_se });
        all.iter_mut().zip(&here).for_each(|(sum, here)| *sum += here);
        flux += here_flux;
    }
    let (value, se) = root(&all, flux);
    IndexOfStudy { value, se, incidences, worst: worst.map(|(_, worst)| worst) }
}

/// The index and its error from the squares with all realisations and without each. Near 0 the error of the square
/// decides: the error is sqrt(square + se(square)) - sqrt(square).
fn root(squares: &[f64], flux: f64) -> (f64, Option<f64>) {
    if flux <= 0.0 {
        return (0.0, None);
    }
    let square = (squares[0] / flux).max(0.0);
    let without: Vec<f64> = squares[1..].iter().map(|square| square / flux).collect();
    let of_square = stats::jackknife_se(&without).filter(|_| without.len() >= 3);
    let se = of_square.map(|of_square| (square + of_square).sqrt() - square.sqrt());
    (square.sqrt(), se)
}

/// The sums of one bin; with one realisation the noise stays in.
fn turned(data: &FitData, colour: usize, entries: impl Iterator<Item = usize> + Clone) -> Turned {
    let turns = entries.clone().count() as f64;
    let count = data.parts.len();
    let middle = |values: &[f64]| entries.clone().map(|entry| values[entry]).sum::<f64>() / turns;
    let means: Vec<f64> = data.parts.iter().map(|part| middle(&part[colour])).collect();
    let mut square = vec![0.0; count + 1];
    for entry in entries.clone() {
        let deviation = |k: usize| data.parts[k][colour][entry] - means[k];
        let sum: f64 = (0..count).map(deviation).sum();
        let own: f64 = (0..count).map(|k| deviation(k).powi(2)).sum();
        let pairs = |count: usize, sum: f64, own: f64| match count {
            0 => 0.0,
            1 => sum * sum,
            n => (sum * sum - own) / (n * (n - 1)) as f64,
        };
        square[0] += pairs(count, sum, own);
        for k in 0..count {
            let d = deviation(k);
            square[1 + k] += pairs(count - 1, sum - d, own - d * d);
        }
    }
    let mean = middle(&data.value[colour]);
    Turned { square, mean_square: turns * mean * mean }
}

/// (theta_r, phi_r) of a bin's centre in degrees.
fn centre(data: &FitData, bin: usize) -> (f64, f64) {
    let grid = &data.grid;
    let middle = |edges: &[f64], k: usize| 0.5 * (edges[k] + edges[k + 1]);
    if grid.theta_r_edges_deg.is_empty() {
        let columns = grid.phi_r_deg.len();
        return (grid.theta_r_deg[bin / columns], grid.phi_r_deg[bin % columns]);
    }
    let columns = grid.phi_r_edges_deg.len() - 1;
    (middle(&grid.theta_r_edges_deg, bin / columns), middle(&grid.phi_r_edges_deg, bin % columns))
}
