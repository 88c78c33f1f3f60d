//! The square on which an RGL file lists directions, and values over it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::warp::cell;
use crate::sphere;

pub fn theta_of(u: f64) -> f64 {
    FRAC_PI_2 * u * u
}

pub fn u_of_theta(theta: f64) -> f64 {
    (theta / FRAC_PI_2).sqrt()
}

pub fn phi_of(u: f64) -> f64 {
    (2.0 * u - 1.0) * PI
}

pub fn u_of_phi(phi: f64) -> f64 {
    let u = (phi + PI) / TAU;
    u - u.floor()
}

/// A square grid's values at bilinear (u_theta, u_phi): columns along theta, rows along phi.
pub struct Map {
    pub rows: usize,
    pub columns: usize,
    pub values: Vec<f32>,
}

impl Map {
    pub fn of(rows: usize, columns: usize, value: impl Fn(DVec3) -> f64) -> Self {
        let node = |at: usize| {
            let (row, column) = (at / columns, at % columns);
            let (v, u) = (row as f64 / (rows - 1) as f64, column as f64 / (columns - 1) as f64);
            value(sphere::direction(theta_of(u), phi_of(v))) as f32
        };
        Map { rows, columns, values: (0..rows * columns).map(node).collect() }
    }

    pub fn at(&self, [u, v]: [f64; 2]) -> f64 {
        let ((column, x), (row, y)) = (cell(u, self.columns), cell(v, self.rows));
        let node = |r: usize, c: usize| f64::from(self.values[(row + r) * self.columns + column + c]);
        (1.0 - y) * ((1.0 - x) * node(0, 0) + x * node(0, 1)) + y * ((1.0 - x) * node(1, 0) + x * node(1, 1))
    }
}
