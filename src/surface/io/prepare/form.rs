//! The sphere or the cylinder of a map, by least squares of its heights.
//!
//! Both are the quadric A |P p|^2 + b.p + e = 0 of the points p = (x, y, z), b = (bx, by, -1): P is 1 for a sphere, and
//! for a cylinder takes the part along its axis away, which is perpendicular to b: axis = (cos phi, sin phi, t)/sqrt(1 + t^2),
//! t = bx cos phi + by sin phi. The radius is sqrt(|b|^2 - 4 A e)/(2 |A|). For A = 0 either is a plane: no radius is too
//! large. z is the root that stays finite there.

use super::MapGrid;
use super::least_squares::{Points, quadratic, solve};

/// The steps of the fit at most; it takes five to ten.
const MOST_STEPS: usize = 60;
/// Change of the heights by a step, relative to what is left of them, below which the fit has ended.
const CONVERGED: f64 = 1e-9;
/// The same relative to the heights themselves: what rounding moves of a form that fits exactly.
const ROUNDING: f64 = 1e-12;
/// Step of a parameter for its derivative; parameters are of order 1.
const STEP: f64 = 1e-6;

/// The form that is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quadric {
    /// A, bx, by, e.
    Sphere,
    /// A, bx, by, e, phi.
    Cylinder,
}

/// What was taken off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Form {
    /// In the unit of the heights; infinite of a plane.
    pub radius: f64,
    /// Whether the middle is higher than the edge: a ball, not a bowl.
    pub convex: bool,
    /// Azimuth of a cylinder's axis, degrees from 0 to 180.
    pub azimuth_deg: Option<f64>,
}

/// Takes the form off heights of mean zero. Samples that `filled` names do not count in the fit.
///
/// Errors: the map reaches beyond the edge of the form, or the fit does not end.
pub fn take_off(
    heights: &mut [f64],
    grid: &MapGrid,
    filled: &[bool],
    quadric: Quadric,
) -> Result<Form, String> {
    let points = Points::of(heights, grid, filled);
    let mut fit = quadric.start(&points)?;
    let beyond = || {
        "the map reaches beyond the edge of the form that fits it: cut it, or take another surface.file.detrend".to_string()
    };
    let mut left = points.squares(quadric, &fit).ok_or_else(beyond)?;
    let rounding = ROUNDING * points.norm();
    let mut damping = 1e-9;
    for step in 0..=MOST_STEPS {
        if step == MOST_STEPS {
            return Err(
                "the fit of the form does not end: the map has no such form; see surface.file.detrend".into(),
            );
        }
        let (squares, right) = points.equations(quadric, &fit).ok_or_else(beyond)?;
        let Some(change) = solve(squares.clone(), right, damping) else {
            damping = f64::max(10.0 * damping, 1e-6);
            continue;
        };
        let next: Vec<f64> = fit.iter().zip(&change).map(|(value, change)| value + change).collect();
        // Change of the heights, root mean square, by the linear model.
        let moved = quadratic(&squares, &change).max(0.0);
        match points.squares(quadric, &next) {
            Some(found) if found <= left => {
                let ended = moved.sqrt() <= CONVERGED * found.sqrt() + rounding;
                (fit, left, damping) = (next, found, 0.1 * damping);
                if ended {
                    break;
                }
            }
            // Rounding alone makes it worse: there is nothing to gain any more.
            Some(found) if moved.sqrt() <= CONVERGED * found.sqrt() + rounding => break,
            _ if damping > 1e6 => break,
            _ => damping = f64::max(10.0 * damping, 1e-6),
        }
    }
    let scale = points.scale;
    let form = |at: usize| {
        let [x, y] = points.place(at % grid.columns, at / grid.columns);
        Some(scale * quadric.height(&fit, x, y)?)
    };
    let forms: Vec<f64> = (0..heights.len()).map(form).collect::<Option<_>>().ok_or_else(beyond)?;
    heights.iter_mut().zip(forms).for_each(|(height, form)| *height -= form);
    let [a, bx, by, e] = [fit[0], fit[1], fit[2], fit[3]];
    let radius = scale * (bx * bx + by * by + 1.0 - 4.0 * a * e).max(0.0).sqrt() / (2.0 * a.abs());
    let azimuth_deg = fit.get(4).map(|phi| phi.to_degrees().rem_euclid(180.0));
    Ok(Form { radius, convex: a < 0.0, azimuth_deg })
}

impl Points<'_> {
    /// Sum of the squared distances from the form; `None` where it has no height.
    fn squares(&self, quadric: Quadric, fit: &[f64]) -> Option<f64> {
        let of_row = |row: usize| {
            self.row(row)
                .map(|[x, y, z]| quadric.height(fit, x, y).map(|form| (z - form).powi(2)))
                .sum::<Option<f64>>()
        };
        Some(self.rows(of_row)?.into_iter().sum())
    }

    /// The normal equations of a step: derivatives of the form by central differences.
    fn equations(&self, quadric: Quadric, fit: &[f64]) -> Option<(Vec<Vec<f64>>, Vec<f64>)> {
        let beside = |k: usize, step: f64| {
            let mut fit = fit.to_vec();
            fit[k] += step;
            fit
        };
        let near: Vec<[Vec<f64>; 2]> = (0..fit.len()).map(|k| [beside(k, -STEP), beside(k, STEP)]).collect();
        self.normal_equations(fit.len(), |[x, y, z]| {
            let off = z - quadric.height(fit, x, y)?;
            let slope = |[before, after]: &[Vec<f64>; 2]| {
                Some((quadric.height(after, x, y)? - quadric.height(before, x, y)?) / (2.0 * STEP))
            };
            Some((near.iter().map(slope).collect::<Option<Vec<f64>>>()?, off))
        })
    }
}

impl Quadric {
    /// Where the fit begins: at the paraboloid of the heights.
    fn start(self, points: &Points) -> Result<Vec<f64>, String> {
        let found = points.paraboloid().ok_or("too few heights for a form")?;
        let &[e, bx, by, xx, xy, yy] = &found[..] else { return Err("too few heights for a form".into()) };
        Ok(match self {
            Quadric::Sphere => vec![0.5 * (xx + yy), bx, by, e],
            Quadric::Cylinder => {
                // The axis lies where the curvature is least.
                let (middle, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(0.5 * xy));
                let across = 0.5 * xy.atan2(xx - yy);
                let (largest, along) = if middle >= 0.0 {
                    (middle + half, across + std::f64::consts::FRAC_PI_2)
                } else {
                    (middle - half, across)
                };
                vec![largest, bx, by, e, along]
            }
        })
    }

    /// Height of the form at a place, `None` beyond its edge.
    fn height(self, fit: &[f64], x: f64, y: f64) -> Option<f64> {
        let [a, bx, by, e] = [fit[0], fit[1], fit[2], fit[3]];
        // Of the axis: A |P p|^2 = A (|p|^2 - (axis.p)^2).
        let axis = match self {
            Quadric::Sphere => [0.0; 3],
            Quadric::Cylinder => {
                let (sin, cos) = fit[4].sin_cos();
                let tilt = bx * cos + by * sin;
                let length = tilt.hypot(1.0);
                [cos / length, sin / length, tilt / length]
            }
        };
        let across = axis[0] * x + axis[1] * y;
        let square = a * (1.0 - axis[2] * axis[2]);
        let linear = 1.0 + 2.0 * a * across * axis[2];
        let rest = a * (x * x + y * y - across * across) + bx * x + by * y + e;
        let root = linear * linear - 4.0 * square * rest;
        (root > 0.0 && linear > 0.0).then(|| 2.0 * rest / (linear + root.sqrt()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::io::prepare::detrend::take_off_mean;

    const GRID: MapGrid = MapGrid { columns: 81, pitch: [2.0, 3.0], periodic: false };

    /// Heights of a form over 160 x 180, its centre off the middle.
    fn heights(height: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let mut heights: Vec<f64> = (0..81 * 61)
            .map(|k| height((k % 81) as f64 * 2.0 - 71.0, (k / 81) as f64 * 3.0 - 95.0))
            .collect();
        take_off_mean(&mut heights);
        heights
    }

    fn rms(heights: &[f64]) -> f64 {
        (heights.iter().map(|h| h * h).sum::<f64>() / heights.len() as f64).sqrt()
    }

    #[test]
    fn a_ball_and_a_bowl_are_taken_off_with_their_radius() {
        for (radius, sign) in [(150.0, 1.0), (2000.0, -1.0), (1e6, 1.0)] {
            let mut found = heights(|x, y| sign * f64::sqrt(radius * radius - x * x - y * y));
            let before = rms(&found);
            let form = take_off(&mut found, &GRID, &[], Quadric::Sphere).expect("a ball");
            // Heights of the radius' size, rounded.
            let rounded = radius * f64::EPSILON;
            assert!(rms(&found) < 1e-8 * before + rounded, "{radius}: {} of {before}", rms(&found));
            assert_eq!(form.convex, sign > 0.0);
            // Sag of 16^2/(2 R) relative to its digits.
            assert!((form.radius / radius - 1.0).abs() < 1e-6, "{radius}: {form:?}");
        }
    }

    /// A cylinder whose axis runs along (cos 30, sin 30, 0.1): height by intersecting vertical lines.
    #[test]
    fn a_tilted_cylinder_is_taken_off_with_its_radius_and_azimuth() {
        let (radius, tilt) = (400.0, 0.1f64);
        let (sin, cos) = 30.0f64.to_radians().sin_cos();
        // Across the axis the ellipse z = sqrt(R^2 - w^2) sqrt(1 + tilt^2), along it z rises by the tilt.
        let cylinder = |x: f64, y: f64| {
            let (along, across) = (x * cos + y * sin, -x * sin + y * cos);
            tilt * along + f64::sqrt(radius * radius - across * across) * tilt.hypot(1.0)
        };
        let mut found = heights(cylinder);
        let before = rms(&found);
        let form = take_off(&mut found, &GRID, &[], Quadric::Cylinder).expect("a cylinder");
        assert!(rms(&found) < 1e-8 * before, "{} of {before}", rms(&found));
        assert!((form.radius / radius - 1.0).abs() < 1e-6 && form.convex, "{form:?}");
        assert!((form.azimuth_deg.expect("an axis") - 30.0).abs() < 1e-5, "{form:?}");
    }

    #[test]
    fn roughness_stays_and_what_was_filled_does_not_pull() {
        // Waves of 6 x 9 in 160 x 180: next to no part of them is a ball.
        let wave = |x: f64, y: f64| 0.02 * (1.1 * x).sin() * (0.7 * y).cos();
        let sphere = |x: f64, y: f64| f64::sqrt(9e6 - x * x - y * y);
        let wanted = heights(wave);
        for (quadric, form) in [
            (Quadric::Sphere, &sphere as &dyn Fn(f64, f64) -> f64),
            (Quadric::Cylinder, &|x: f64, _| f64::sqrt(9e6 - x * x)),
        ] {
            let mut found = heights(|x, y| wave(x, y) + form(x, y));
            let filled: Vec<bool> = (0..found.len()).map(|k| k % 81 < 9).collect();
            found
                .iter_mut()
                .zip(&filled)
                .filter(|(_, filled)| **filled)
                .for_each(|(height, _)| *height += 5.0);
            take_off(&mut found, &GRID, &filled, quadric).expect("a form");
            let off: Vec<f64> =
                (0..found.len()).filter(|k| !filled[*k]).map(|k| found[k] - wanted[k]).collect();
            let mean = off.iter().sum::<f64>() / off.len() as f64;
            let off: Vec<f64> = off.iter().map(|off| off - mean).collect();
            // The part of the waves that is a ball: 1/sqrt(4000 samples of some 30 waves) of their height.
            assert!(rms(&off) < 0.01 * rms(&wanted), "{quadric:?}: {} of {}", rms(&off), rms(&wanted));
        }
    }

    #[test]
    fn a_plane_is_a_ball_of_any_radius_and_no_form_is_refused() {
        let mut plane = heights(|x, y| 0.3 * x - 0.1 * y);
        let form = take_off(&mut plane, &GRID, &[], Quadric::Sphere).expect("a plane");
        assert!(rms(&plane) < 1e-6 && form.radius > 1e6, "{form:?} {}", rms(&plane));
    }
}
