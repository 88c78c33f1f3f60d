//! The quadrature that a fit averages its models with: nodes in every bin, laid out once, the same for all models
//! and all iterations, so that the sum of squares is a smooth function of the parameters.
//!
//! Rectangles are cut at the plane of incidence and at theta_i (where maskings have kinks), halved until the slope of
//! the half vector, in units of the planned alpha, varies by at most 1 + its distance from 0, and given 4 x 4
//! Gauss-Legendre nodes. A lobe 1/(1 + s^2)^2 then has its poles four half-widths away from every piece: the rule is
//! right to 4.2^-8 = 1e-5 of a bin. Apertures get 4 x 9 nodes.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use crate::instrument::{Grid, Region};
use crate::optics::FacetAngle;
use crate::sphere;
use crate::theory::gauss_legendre::gauss_legendre;
use crate::theory::transmission::{RefractingFacet, half_vector};
use crate::validate::source_nodes;

/// Nodes along each side of a piece.
const ORDER: usize = 4;
/// Nodes along the radius of the light's aperture.
const APERTURE_ORDER: usize = 3;
/// Halvings of a bin at most.
const DEEPEST: u32 = 24;
/// Halvings at the edge of where facets let light through: beyond it they reflect all.
const DEEPEST_EDGE: u32 = 8;
/// The steepest slope that is told from steeper ones, over the lobe's: the longest tails have 1e-12 of their light there.
const STEEPEST: f64 = 1e3;

/// A direction to the sensor with its share of the bin's mean.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// Unit vector, stage's frame.
    pub wo: DVec3,
    /// The weights of a bin add up to 1 (to the rule's accuracy).
    pub weight: f64,
}

/// What nodes have to resolve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobe {
    /// The narrowest lobe, in slopes.
    pub alpha: f64,
    /// Index beyond over index here, for bins below the horizon; not 1.
    pub eta: f64,
}

/// The nodes of one incidence.
#[derive(Debug, Clone)]
pub struct IncidenceNodes {
    /// Directions to the light with weights that add up to 1.
    pub light: Vec<(DVec3, f64)>,
    /// All entries' nodes, one after the other.
    pub nodes: Vec<Node>,
    /// Where each entry's nodes end.
    pub ends: Vec<usize>,
}

impl IncidenceNodes {
    /// The nodes of every incidence of a grid.
    pub fn of_grid(grid: &Grid, aperture: f64, lobe: Lobe) -> Vec<IncidenceNodes> {
        let all: Vec<usize> = (0..grid.incidences() * grid.bins()).collect();
        IncidenceNodes::of_entries(grid, &all, aperture, lobe)
    }

    /// The nodes of `entries` (incidence * bins + bin, increasing), incidence by incidence.
    ///
    /// - `aperture`: half-angle of the light's cone, rad.
    // Tested by `the_quadrature_agrees_with_the_adaptive_one` (tests/it/fit.rs).
    pub fn of_entries(grid: &Grid, entries: &[usize], aperture: f64, lobe: Lobe) -> Vec<IncidenceNodes> {
        let incidences: Vec<&[usize]> = entries.chunk_by(|a, b| a / grid.bins() == b / grid.bins()).collect();
        incidences
            .par_iter()
            .map(|entries| IncidenceNodes::of_incidence(grid, entries, aperture, lobe))
            .collect()
    }

    /// The nodes of entries (one at least) of one incidence.
    fn of_incidence(grid: &Grid, entries: &[usize], aperture: f64, lobe: Lobe) -> IncidenceNodes {
        let incidence = entries[0] / grid.bins();
        let wi = grid.wi(incidence);
        let (mut nodes, mut ends) = (Vec::new(), Vec::new());
        let regions = grid.regions(incidence);
        for entry in entries {
            let region = regions[entry - incidence * grid.bins()];
            match region {
                Region::Cap { axis, half_angle } => {
                    let cone = source_nodes(axis, half_angle, ORDER);
                    nodes.extend(cone.into_iter().map(|(wo, weight)| Node { wo, weight }));
                }
                Region::Rectangle { theta, phi } => {
                    let size = region.projected_solid_angle();
                    for piece in pieces(wi, theta, phi, lobe) {
                        piece.nodes(size, &mut nodes);
                    }
                }
            }
            ends.push(nodes.len());
        }
        IncidenceNodes { light: source_nodes(wi, aperture, APERTURE_ORDER), nodes, ends }
    }

    /// The mean over every entry's bin of what `value(wi)(wo)` says.
    pub fn means<V: Fn(DVec3) -> [f64; 2]>(&self, value: impl Fn(DVec3) -> V) -> Vec<[f64; 2]> {
        let mut means = vec![[0.0; 2]; self.ends.len()];
        for &(wi, share) in &self.light {
            let value = value(wi);
            let mut first = 0;
            for (mean, &end) in means.iter_mut().zip(&self.ends) {
                for node in &self.nodes[first..end] {
                    let [a, b] = value(node.wo);
                    mean[0] += share * node.weight * a;
                    mean[1] += share * node.weight * b;
                }
                first = end;
            }
        }
        means
    }
}

/// A piece of a rectangle of (theta, phi).
#[derive(Clone, Copy)]
struct Piece {
    theta: [f64; 2],
    phi: [f64; 2],
}

/// The rectangle cut and halved until the half vector's slope is resolved on each piece.
fn pieces(wi: DVec3, theta: [f64; 2], phi: [f64; 2], lobe: Lobe) -> Vec<Piece> {
    let phi_i = sphere::phi(wi);
    let turns = (((phi[0] - phi_i) / PI).ceil() as i64)..=(((phi[1] - phi_i) / PI).floor() as i64);
    let thetas = cut(theta, [sphere::theta(wi)]);
    let phis = cut(phi, turns.map(|k| phi_i + PI * k as f64));
    let whole = |theta: &[f64]| {
        let theta = [theta[0], theta[1]];
        phis.windows(2).map(move |phi| (Piece { theta, phi: [phi[0], phi[1]] }, 0)).collect::<Vec<_>>()
    };
    let mut open: Vec<(Piece, u32)> = thetas.windows(2).flat_map(whole).collect();
    let mut done = Vec::new();
    while let Some((piece, depth)) = open.pop() {
        match piece.halves(wi, lobe, depth) {
            Some(halves) => open.extend(halves.map(|half| (half, depth + 1))),
            None => done.push(piece),
        }
    }
    done
}

/// The ends with those of `marks` between them.
fn cut(ends: [f64; 2], marks: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut all = vec![ends[0]];
    all.extend(marks.into_iter().filter(|&mark| ends[0] < mark && mark < ends[1]));
    all.push(ends[1]);
    all
}

impl Piece {
    /// Two halves along the side on which the slope varies more; `None` where it is resolved.
    fn halves(self, wi: DVec3, lobe: Lobe, depth: u32) -> Option<[Piece; 2]> {
        let three = |[a, b]: [f64; 2]| [a, 0.5 * (a + b), b];
        let mut facets = 0;
        let mut slope = |theta: f64, phi: f64| {
            let wo = sphere::direction(theta, phi);
            let h = half_vector(wi, wo, lobe.eta);
            facets += usize::from(if wo.z > 0.0 {
                FacetAngle::of_pair(wi, wo).sin2 < lobe.eta * lobe.eta
            } else {
                RefractingFacet::new(wi, wo, lobe.eta).is_some()
            });
            // Steeper facets, and such as no light goes through, are as far as this.
            let scale = (lobe.alpha * h.z).max(h.truncate().length() / STEEPEST);
            [h.x / scale, h.y / scale]
        };
        let s = three(self.theta).map(|theta| three(self.phi).map(|phi| slope(theta, phi)));
        let path =
            |[a, b, c]: [[f64; 2]; 3]| (a[0] - b[0]).hypot(a[1] - b[1]) + (b[0] - c[0]).hypot(b[1] - c[1]);
        let along_phi = s.iter().map(|&row| path(row)).fold(0.0, f64::max);
        let along_theta = (0..3).map(|k| path([s[0][k], s[1][k], s[2][k]])).fold(0.0, f64::max);
        let nearest = s.as_flattened().iter().map(|p| p[0].hypot(p[1])).fold(f64::INFINITY, f64::min);
        let on_edge = facets != 0 && facets != 9 && depth < DEEPEST_EDGE;
        if along_phi.max(along_theta) <= 1.0 + nearest && !on_edge || depth == DEEPEST {
            return None;
        }
        let split = |[a, b]: [f64; 2]| [[a, 0.5 * (a + b)], [0.5 * (a + b), b]];
        Some(if along_theta >= along_phi {
            split(self.theta).map(|theta| Piece { theta, ..self })
        } else {
            split(self.phi).map(|phi| Piece { phi, ..self })
        })
    }

    /// Gauss-Legendre nodes with the weight cos theta sin theta, as shares of a bin of this projected solid angle.
    fn nodes(self, size: f64, nodes: &mut Vec<Node>) {
        let rule = gauss_legendre(ORDER);
        let (d_theta, d_phi) = (self.theta[1] - self.theta[0], self.phi[1] - self.phi[0]);
        for &(u, weight_u) in &rule {
            let theta = self.theta[0] + u * d_theta;
            let row = weight_u * d_theta * d_phi * (theta.sin() * theta.cos()).abs() / size;
            for &(v, weight_v) in &rule {
                let wo = sphere::direction(theta, self.phi[0] + v * d_phi);
                nodes.push(Node { wo, weight: row * weight_v });
            }
        }
    }
}
