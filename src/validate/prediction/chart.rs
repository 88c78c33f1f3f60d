//! How two angles name the directions of a sensor bin, so that the cubature meets no kink inside a rectangle.
//!
//! Input: a region of the stage's frame and the light's direction. Output: rectangles of two angles, and the map from
//! them into directions of the sample's frame.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::quadrature::{Components, Integral, Integrand, Precision, Rect, SinCos, integrate};
use crate::instrument::Region;
use crate::sphere;
use crate::theory::Microfacet;

/// What is integrated over directions of the sample's frame.
pub(super) trait FluxDensity {
    /// Outgoing flux per solid angle, 1/sr.
    fn densities(&self, wo: DVec3) -> Components;

    /// As `Integrand::feature`.
    fn feature(&self, wo: DVec3) -> [f64; 2];
}

/// The integrals over a region in its chart.
pub(super) fn integrate_region(
    density: &impl FluxDensity,
    (chart, rects): &(DirectionChart, Vec<Rect>),
    precision: &Precision,
) -> Integral {
    integrate(&Mapped { density, chart }, rects, precision)
}

/// How two angles name a direction of the sample's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum DirectionChart {
    /// (theta, phi).
    Polar,
    /// (psi, eta) about the axis: (axis, direction of eta = 0, of eta = 90 degrees).
    About(DVec3, DVec3, DVec3),
    /// A cap by parallels of latitude, theta = axis + half-angle sin u and phi = axis + half-width(theta) sin v.
    Parallels(CapParallels),
}

/// A cap that holds neither pole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CapParallels {
    theta: f64,
    phi: f64,
    half_angle: f64,
}

/// Largest steps of the first subdivision, on which the nine samples of the resolution test see the feature's trend.
const LARGEST: [f64; 2] = [PI / 6.0, PI / 4.0];

impl DirectionChart {
    /// The chart of a region and its rectangles, cut where the integrand may have kinks or narrow turns.
    ///
    /// Cuts in azimuth: the plane of incidence (of `wi`, sample's frame), and the axes of an anisotropic sample, where the
    /// canonical azimuth turns fast. In theta: `cut`; caps are taken by parallels of latitude where a jump below the
    /// horizon lies there.
    pub(super) fn of_region(
        model: &Microfacet,
        wi: DVec3,
        region: &Region,
        cut: Option<f64>,
    ) -> (DirectionChart, Vec<Rect>) {
        let mut planes = vec![sphere::phi(wi)];
        if !model.is_isotropic() {
            planes.extend([0.0, FRAC_PI_2]);
        }
        let (chart, u, cuts_u, v) = match *region {
            Region::Rectangle { theta, phi } => {
                (DirectionChart::Polar, theta, cut, phi.map(|phi| phi - model.rotation))
            }
            Region::Cap { axis, half_angle } => {
                let axis = model.to_sample(axis);
                let cap = CapParallels { theta: sphere::theta(axis), phi: sphere::phi(axis), half_angle };
                if let Some(cut) = cut.filter(|&cut| region.is_below() && cap.is_crossed_at(cut)) {
                    return (DirectionChart::Parallels(cap), cap.rectangles(cut));
                }
                let (down, across) = meridian_frame(axis);
                planes.iter_mut().for_each(|plane| *plane -= cap.phi);
                planes.push(0.0);
                (DirectionChart::About(axis, down, across), [0.0, half_angle], None, [0.0, TAU])
            }
        };
        let us = steps(u, cuts_u.as_slice(), LARGEST[0]);
        let vs = steps(v, &half_turns(&planes, v), LARGEST[1]);
        (chart, rectangles(&us, &vs))
    }

    /// The direction, and the solid angle of a unit of both angles.
    pub(super) fn at(&self, u: SinCos, v: SinCos) -> (DVec3, f64) {
        let ((sin_u, cos_u), (sin_v, cos_v)) = (u, v);
        match *self {
            DirectionChart::Polar => (DVec3::new(sin_u * cos_v, sin_u * sin_v, cos_u), sin_u),
            DirectionChart::About(axis, down, across) => {
                (axis * cos_u + (down * cos_v + across * sin_v) * sin_u, sin_u)
            }
            DirectionChart::Parallels(cap) => cap.at(u, v),
        }
    }
}

impl CapParallels {
    fn is_crossed_at(&self, theta: f64) -> bool {
        let inside = (theta - self.theta).abs() < self.half_angle;
        inside && self.theta > self.half_angle && self.theta + self.half_angle < PI
    }

    fn rectangles(&self, cut: f64) -> Vec<Rect> {
        let all = [-FRAC_PI_2, FRAC_PI_2];
        let middle = ((cut - self.theta) / self.half_angle).asin();
        rectangles(&steps(all, &[middle], LARGEST[1]), &steps(all, &[0.0], LARGEST[1]))
    }

    /// With a the half-angle: sin^2(width/2) = sin(a (1 + sin u)/2) sin(a (1 - sin u)/2)/(sin theta sin theta_axis).
    fn at(&self, (sin_u, cos_u): SinCos, (sin_v, cos_v): SinCos) -> (DVec3, f64) {
        let a = self.half_angle;
        let (sin, cos) = (self.theta + a * sin_u).sin_cos();
        let rise = (0.5 * a * (1.0 + sin_u)).sin() * (0.5 * a * (1.0 - sin_u)).sin();
        let width = 2.0 * (rise / (sin * self.theta.sin())).sqrt().asin();
        let (sin_phi, cos_phi) = (self.phi + width * sin_v).sin_cos();
        (DVec3::new(sin * cos_phi, sin * sin_phi, cos), sin * a * cos_u * width * cos_v)
    }
}

fn rectangles(us: &[f64], vs: &[f64]) -> Vec<Rect> {
    let row = |u: &[f64]| {
        let u = [u[0], u[1]];
        vs.windows(2).map(move |v| Rect { u, v: [v[0], v[1]] }).collect::<Vec<_>>()
    };
    us.windows(2).flat_map(row).collect()
}

/// The directions of growing theta and of growing phi at `axis`.
pub(super) fn meridian_frame(axis: DVec3) -> (DVec3, DVec3) {
    let (sin, cos) = sphere::phi(axis).sin_cos();
    let across = DVec3::new(-sin, cos, 0.0);
    (across.cross(axis), across)
}

/// All angles inside `ends` that differ from one of `planes` by a whole number of half turns.
fn half_turns(planes: &[f64], ends: [f64; 2]) -> Vec<f64> {
    let inside = |&plane: &f64| {
        let first = ((ends[0] - plane) / PI).ceil() as i64;
        let last = ((ends[1] - plane) / PI).floor() as i64;
        (first..=last).map(move |k| plane + PI * k as f64)
    };
    planes.iter().flat_map(inside).collect()
}

/// The ends, the cuts between them, and as many steps more as keep each below `largest`.
fn steps(ends: [f64; 2], cuts: &[f64], largest: f64) -> Vec<f64> {
    let mut marks: Vec<f64> = cuts.iter().copied().filter(|&cut| ends[0] < cut && cut < ends[1]).collect();
    marks.extend(ends);
    marks.sort_by(f64::total_cmp);
    marks.dedup();
    let mut all = vec![ends[0]];
    for pair in marks.windows(2) {
        let count = ((pair[1] - pair[0]) / largest).ceil().max(1.0);
        let within = (1..count as usize).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / count);
        all.extend(within);
        all.push(pair[1]);
    }
    all
}

/// A density over a chart.
struct Mapped<'a, D> {
    density: &'a D,
    chart: &'a DirectionChart,
}

impl<D: FluxDensity> Integrand for Mapped<'_, D> {
    fn values(&self, u: SinCos, v: SinCos) -> Components {
        let (wo, area) = self.chart.at(u, v);
        self.density.densities(wo).map(|value| value * area)
    }

    fn feature(&self, u: SinCos, v: SinCos) -> [f64; 2] {
        self.density.feature(self.chart.at(u, v).0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theory::Ndf;
    use crate::validate::prediction::quadrature::COMPONENTS;

    /// |cos theta|, so that the integral is the projected solid angle.
    struct Cosine;

    impl FluxDensity for Cosine {
        fn densities(&self, wo: DVec3) -> Components {
            [wo.z.abs(); COMPONENTS]
        }

        fn feature(&self, _: DVec3) -> [f64; 2] {
            [0.0, 0.0]
        }
    }

    #[test]
    fn a_cap_by_parallels_has_its_projected_solid_angle() {
        let model = Microfacet::isotropic(Ndf::Ggx, 0.3);
        let precision = Precision { relative: [1e-10; COMPONENTS], absolute: 0.0, max_rectangles: 1000 };
        for (theta_deg, half_angle) in [(100.0, 0.1), (140.0, 0.3), (175.0, 0.08)] {
            let region = Region::Cap { axis: sphere::direction_deg(theta_deg, 30.0), half_angle };
            let cut = f64::to_radians(theta_deg) + 0.3 * half_angle;
            let chart =
                DirectionChart::of_region(&model, sphere::direction_deg(20.0, 0.0), &region, Some(cut));
            assert!(matches!(chart.0, DirectionChart::Parallels(_)));
            let found = integrate_region(&Cosine, &chart, &precision).value[0];
            // The precision that is asked for.
            assert!((found / region.projected_solid_angle() - 1.0).abs() < 1e-10, "{theta_deg}: {found}");
        }
    }
}
