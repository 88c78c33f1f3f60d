//! Sa, Sq, Ssk, Sku, Sdq, Sdr, and with the autocorrelation Sal and Str.

use serde::Serialize;

use crate::surface::io::prepare::MapGrid;

/// Parameters of ISO 25178-2. Lengths are in the unit of the heights; the others are ratios. `null`: not defined.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Parameters {
    /// Mean of |h|.
    pub sa: f64,
    /// Root mean square of h.
    pub sq: f64,
    /// Mean of h^3 over Sq^3.
    pub ssk: Option<f64>,
    /// Mean of h^4 over Sq^4; 3 of a normal law.
    pub sku: Option<f64>,
    /// Root mean square slope, by the differences of neighbouring heights.
    pub sdq: f64,
    /// Area over projected area, less 1: mean over both ways to cut each cell into two triangles (ISO 25178-2:2021, D.15).
    pub sdr: f64,
    /// Shortest distance in which the autocorrelation falls to 0.2.
    pub sal: Option<f64>,
    /// That distance over the longest.
    pub str: Option<f64>,
}

impl Parameters {
    /// Of heights, which count from their mean; `sal` and `str` come from their autocorrelation.
    pub fn of(heights: &[f64], grid: &MapGrid, sal: Option<f64>, str: Option<f64>) -> Self {
        let mean_of =
            |f: &dyn Fn(f64) -> f64| heights.iter().map(|&h| f(h)).sum::<f64>() / heights.len() as f64;
        let centre = mean_of(&|h| h);
        let sq = mean_of(&|h| (h - centre).powi(2)).sqrt();
        let moment = |power: i32| (sq > 0.0).then(|| mean_of(&|h| ((h - centre) / sq).powi(power)));
        let sums = Slopes::of(heights, grid);
        Parameters {
            sa: mean_of(&|h| (h - centre).abs()),
            sq,
            ssk: moment(3),
            sku: moment(4),
            sdq: (sums.along_x + sums.along_y).sqrt(),
            sdr: sums.area - 1.0,
            sal,
            str,
        }
    }
}

/// Means over the cells of a map.
struct Slopes {
    /// Mean squared slope along x.
    along_x: f64,
    along_y: f64,
    /// Area over projected area.
    area: f64,
}

impl Slopes {
    fn of(heights: &[f64], grid: &MapGrid) -> Self {
        let (columns, rows) = (grid.columns, grid.rows(heights));
        let extra = usize::from(!grid.periodic);
        let [px, py] = grid.pitch;
        let at = |x: usize, y: usize| heights[y % rows * columns + x % columns];
        let slope_x = |x: usize, y: usize| (at(x + 1, y) - at(x, y)) / px;
        let slope_y = |x: usize, y: usize| (at(x, y + 1) - at(x, y)) / py;
        let (cells_x, cells_y) = (columns - extra, rows - extra);
        let (mut along_x, mut along_y, mut area) = (0.0, 0.0, 0.0);
        for y in 0..rows {
            // Row by row, so that a large map loses no digits.
            let (mut row_x, mut row_y, mut row_area) = (0.0, 0.0, 0.0);
            for x in 0..columns {
                if x < cells_x {
                    row_x += slope_x(x, y).powi(2);
                }
                if y < cells_y {
                    row_y += slope_y(x, y).powi(2);
                }
                if x < cells_x && y < cells_y {
                    let (near, far) = (slope_x(x, y).powi(2), slope_x(x, y + 1).powi(2));
                    let (left, right) = (slope_y(x, y).powi(2), slope_y(x + 1, y).powi(2));
                    // Each corner has half a cell's triangle, and each way to cut it two of the four.
                    let corner = |a: f64, b: f64| (1.0 + a + b).sqrt();
                    row_area +=
                        corner(near, left) + corner(near, right) + corner(far, left) + corner(far, right);
                }
            }
            (along_x, along_y, area) = (along_x + row_x, along_y + row_y, area + row_area);
        }
        Slopes {
            along_x: along_x / (cells_x * rows) as f64,
            along_y: along_y / (columns * cells_y) as f64,
            area: area / (4 * cells_x * cells_y) as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// A plane of slopes 3/4 and 0: every cell is 5/4 of its projection. A sine of 64 samples: Sa = 2/pi cot(pi/64) pi/64,
    /// Sq = 1/sqrt 2, Ssk = 0, Sku = 3/2; slopes are difference quotients, 2 sin(pi/64) of cosines.
    #[test]
    fn a_plane_and_a_sine_have_the_parameters_of_their_formulas() {
        let grid = MapGrid { columns: 64, pitch: [2.0, 0.5], periodic: false };
        let plane: Vec<f64> = (0..64 * 20).map(|k| 1.5 * (k % 64) as f64).collect();
        let found = Parameters::of(&plane, &grid, None, None);
        assert!((found.sdq - 0.75).abs() < 1e-12 && (found.sdr - 0.25).abs() < 1e-12, "{found:?}");
        let sine: Vec<f64> = (0..64 * 20).map(|k| (TAU * (k % 64) as f64 / 64.0).sin()).collect();
        let found = Parameters::of(&sine, &MapGrid { periodic: true, ..grid }, None, None);
        let sa = 2.0 / 64.0 / (PI / 64.0).tan();
        for (found, wanted) in [
            (found.sa, sa),
            (found.sq, 0.5f64.sqrt()),
            (found.ssk.expect("rough"), 0.0),
            (found.sku.expect("rough"), 1.5),
            (found.sdq, 2.0 * (PI / 64.0).sin() * 0.5f64.sqrt() / 2.0),
        ] {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
        let flat = Parameters::of(&[2.0; 64 * 20], &grid, None, None);
        assert_eq!((flat.sq, flat.ssk, flat.sdr), (0.0, None, 0.0));
    }
}
