//! Means over bins that total reflection begins in: the reflectance has a root's kink on a circle of directions.
//!
//! Light from the denser side is totally reflected by facets at more than the critical angle from it: wi.wo < K with
//! K = 1 - 2 eta^2, a circle about wi. Rectangles that it crosses are cut along it. On either side the distance from the
//! circle runs as t^2, so that the root is linear in t, and along it as sin^2, for where the circle touches an edge.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::chart::{DirectionChart, FluxDensity, integrate_region};
use super::quadrature::{COMPONENTS, Components, Integral, Integrand, Precision, Rect, SinCos, integrate};

/// wi.wo at which light at a facet of index `eta` < 1 begins to be totally reflected: cos of twice the critical angle.
pub(super) fn critical_cosine(eta: f64) -> f64 {
    1.0 - 2.0 * eta * eta
}

/// The integrals over the rectangles of a chart, cut where w.wi = `cosine`.
// Tested by `means_at_total_reflection_match_another_program` (tests/it/facets/critical_means.rs).
pub(super) fn integrate_cut(
    density: &impl FluxDensity,
    (chart, rects): &(DirectionChart, Vec<Rect>),
    (wi, cosine): (DVec3, f64),
    precision: &Precision,
) -> Integral {
    let circle = Circle::of(chart, wi, cosine);
    let mut sum = Integral { value: [0.0; COMPONENTS], error: [0.0; COMPONENTS], rectangles: 0 };
    let mut add = |part: Integral| {
        for c in 0..COMPONENTS {
            sum.value[c] += part.value[c];
            sum.error[c] += part.error[c];
        }
        sum.rectangles += part.rectangles;
    };
    for rect in rects.iter().flat_map(|rect| circle.half_turns(rect)) {
        for u in circle.strips(&rect).windows(2).map(|u| [u[0], u[1]]) {
            if !circle.crosses(0.5 * (u[0] + u[1]), rect.v) {
                add(integrate_region(density, &(*chart, vec![Rect { u, ..rect }]), precision));
                continue;
            }
            for end in rect.v {
                let piece = Piece { density, chart, circle, rect: Rect { u, ..rect }, end };
                add(integrate(&piece, &[Rect { u: [0.0, 1.0], v: [0.0, 1.0] }], precision));
            }
        }
    }
    sum
}

/// a cos u + r sin u cos(v - v0) = cosine.
#[derive(Debug, Clone, Copy)]
struct Circle {
    a: f64,
    r: f64,
    v0: f64,
    cosine: f64,
}

impl Circle {
    fn of(chart: &DirectionChart, wi: DVec3, cosine: f64) -> Self {
        let axis = |u: f64, v: f64| chart.at(u.sin_cos(), v.sin_cos()).0.dot(wi);
        let (x, y) = (axis(FRAC_PI_2, 0.0), axis(FRAC_PI_2, FRAC_PI_2));
        Circle { a: axis(0.0, 0.0), r: x.hypot(y), v0: y.atan2(x), cosine }
    }

    /// The ends of `rect` in u, and where the circle crosses its edges of constant v.
    fn strips(&self, rect: &Rect) -> Vec<f64> {
        let mut marks = rect.u.to_vec();
        for v in rect.v {
            let along = self.r * (v - self.v0).cos();
            let ratio = self.cosine / self.a.hypot(along);
            if ratio.abs() < 1.0 {
                let (middle, half) = (along.atan2(self.a), ratio.acos());
                marks.extend(
                    [middle - half, middle + half].into_iter().filter(|u| rect.u[0] < *u && *u < rect.u[1]),
                );
            }
        }
        marks.sort_by(f64::total_cmp);
        marks.dedup();
        marks
    }

    /// The parts of `rect` that lie within one half turn from v0 each: there the circle crosses a row once.
    fn half_turns(&self, rect: &Rect) -> Vec<Rect> {
        let [low, high] = rect.v.map(|v| (v - self.v0) / PI);
        let inner = (low.floor() as i64 + 1..high.ceil() as i64).map(|k| self.v0 + PI * k as f64);
        let marks: Vec<f64> = std::iter::once(rect.v[0]).chain(inner).chain([rect.v[1]]).collect();
        marks.windows(2).map(|v| Rect { v: [v[0], v[1]], ..*rect }).collect()
    }

    /// cos(v - v0) where the circle crosses the row of `u`, if it does.
    fn cos_at(&self, u: f64) -> f64 {
        let (sin, cos) = u.sin_cos();
        (self.cosine - self.a * cos) / (self.r * sin)
    }

    /// Whether the circle crosses the row of `u` between the ends of `v`, which lie within one half turn.
    fn crosses(&self, u: f64, v: [f64; 2]) -> bool {
        let ends = v.map(|v| (v - self.v0).cos());
        let found = self.cos_at(u);
        ends[0].min(ends[1]) < found && found < ends[0].max(ends[1])
    }

    /// Where it does; at the ends of a strip it reaches an end of `v`, up to rounding.
    fn crossing(&self, u: f64, v: [f64; 2]) -> f64 {
        let half_turns = ((0.5 * (v[0] + v[1]) - self.v0) / PI).floor();
        let turn = self.cos_at(u).clamp(-1.0, 1.0).acos();
        let turned = if half_turns.rem_euclid(2.0) == 0.0 { turn } else { PI - turn };
        (self.v0 + half_turns * PI + turned).clamp(v[0], v[1])
    }
}

/// What lies between the circle and one end of v, over a strip of u that the circle crosses.
struct Piece<'a, D> {
    density: &'a D,
    chart: &'a DirectionChart,
    circle: Circle,
    rect: Rect,
    end: f64,
}

impl<D> Piece<'_, D> {
    /// The direction at (s, t) of the unit square, and the solid angle of a unit of it.
    fn at(&self, s: SinCos, t: SinCos) -> (DVec3, f64) {
        let (s, t) = (s.0.atan2(s.1), t.0.atan2(t.1));
        let [u0, u1] = self.rect.u;
        let (sin, cos) = (FRAC_PI_2 * s).sin_cos();
        let u = u0 + (u1 - u0) * sin * sin;
        let from = self.circle.crossing(u, self.rect.v);
        let v = from + (self.end - from) * t * t;
        let (wo, area) = self.chart.at(u.sin_cos(), v.sin_cos());
        (wo, area * (u1 - u0) * PI * sin * cos * (self.end - from).abs() * 2.0 * t)
    }
}

impl<D: FluxDensity> Integrand for Piece<'_, D> {
    fn values(&self, s: SinCos, t: SinCos) -> Components {
        let (wo, area) = self.at(s, t);
        self.density.densities(wo).map(|value| value * area)
    }

    fn feature(&self, s: SinCos, t: SinCos) -> [f64; 2] {
        self.density.feature(self.at(s, t).0)
    }
}
