//! The density of a facet's slope under Student's t, of which GGX (gamma = 2) and Beckmann (no end of gamma) are members.
//!
//! P(p) = (1 + q/(gamma - 1))^-gamma/(pi alpha_x alpha_y), q = |p/alpha|^2 along the axes; Beckmann: exp(-q)/(pi alpha_x
//! alpha_y). Parameters are logarithms, as in the fits of tables: the logarithm of the matrix of roughness is
//! [[a + b, c], [c, a - b]], and the last is ln(gamma - 1).

use std::f64::consts::PI;

use glam::DVec2;

use crate::fit::microfacet_law::roughness;
use crate::surface::SlopeLaw;

/// A law, and which of its parameters are free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlopeFamily {
    /// gamma where it is held, 2 of GGX and infinite of Beckmann; `None`: it is fitted.
    held: Option<f64>,
    /// Whether two roughnesses and an axis are fitted.
    pub anisotropic: bool,
}

impl SlopeFamily {
    /// Beckmann, GGX and Student's t, with one roughness and with two.
    pub fn all() -> Vec<SlopeFamily> {
        let laws = [Some(f64::INFINITY), Some(2.0), None];
        let both = |held| [false, true].map(|anisotropic| SlopeFamily { held, anisotropic });
        laws.into_iter().flat_map(both).collect()
    }

    /// The name in campaigns.
    pub fn name(self) -> &'static str {
        match self.held {
            None => "student_t",
            Some(2.0) => "ggx",
            Some(_) => "beckmann",
        }
    }

    /// Whether gamma is fitted.
    pub fn fits_gamma(self) -> bool {
        self.held.is_none()
    }

    /// Numbers of the matrix of roughness: 1 or 3.
    pub fn matrix_params(self) -> usize {
        if self.anisotropic { 3 } else { 1 }
    }

    /// gamma of some parameters.
    pub fn gamma(self, params: &[f64]) -> f64 {
        self.held.unwrap_or_else(|| 1.0 + params[self.matrix_params()].exp())
    }

    /// Names of the decoded parameters.
    pub fn names(self) -> Vec<&'static str> {
        let mut names =
            if self.anisotropic { vec!["alpha_x", "alpha_y", "rotation_deg"] } else { vec!["alpha"] };
        names.extend(self.fits_gamma().then_some("gamma"));
        names
    }

    /// The parameters under their names.
    pub fn decoded(self, params: &[f64]) -> Vec<f64> {
        let mut values = if self.anisotropic {
            let (x, y, turn) = roughness(params, 0.0);
            vec![x, y, turn.to_degrees()]
        } else {
            vec![params[0].exp()]
        };
        values.extend(self.fits_gamma().then(|| self.gamma(params)));
        values
    }

    /// The density at some parameters.
    pub fn at(self, params: &[f64]) -> SlopeDensity {
        let (x, y, turn) =
            if self.anisotropic { roughness(params, 0.0) } else { (params[0].exp(), params[0].exp(), 0.0) };
        SlopeDensity { axis: DVec2::from_angle(turn), alpha: [x, y], gamma: self.gamma(params) }
    }
}

/// A law of slopes with its numbers.
#[derive(Debug, Clone, Copy)]
pub struct SlopeDensity {
    axis: DVec2,
    alpha: [f64; 2],
    gamma: f64,
}

impl SlopeDensity {
    /// q of a slope.
    #[inline]
    pub fn q(&self, slope: DVec2) -> f64 {
        let (x, y) = (slope.dot(self.axis) / self.alpha[0], slope.dot(self.axis.perp()) / self.alpha[1]);
        x * x + y * y
    }

    /// What a facet of this q weighs in the equation of the matrix, alpha^2 = 2 mean(weight p p').
    #[inline]
    pub fn weight(&self, q: f64) -> f64 {
        if self.gamma.is_infinite() { 1.0 } else { self.gamma / (self.gamma - 1.0 + q) }
    }

    /// ln P of a facet of this q, nats.
    #[inline]
    pub fn log(&self, q: f64) -> f64 {
        let scale = -(PI * self.alpha[0] * self.alpha[1]).ln();
        if self.gamma.is_infinite() {
            scale - q
        } else {
            scale - self.gamma * (q / (self.gamma - 1.0)).ln_1p()
        }
    }

    /// The law of sqrt(q).
    pub fn lengths(&self) -> SlopeLaw {
        if self.gamma.is_infinite() { SlopeLaw::Beckmann } else { SlopeLaw::student_t(self.gamma) }
    }
}
