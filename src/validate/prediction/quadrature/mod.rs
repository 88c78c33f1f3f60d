//! Adaptive cubature of several functions at once over rectangles of two angles.
//!
//! Input: rectangles and an `Integrand`, which also says how its narrow feature varies. Output: the integrals, an
//! estimate of their errors, and the number of rectangles it took. Tensor Gauss-Kronrod rule (7, 15), worst
//! rectangle first. Everything is sequential and free of randomness: same bits always.

pub(crate) mod gauss_kronrod;

use std::collections::BinaryHeap;

use gauss_kronrod::Leaf;

/// Functions that are integrated together.
pub const COMPONENTS: usize = 8;

/// How much closer than asked for the orders must agree: where a kink lies between the nodes of both, they may agree by
/// chance.
pub const AT_KINKS: f64 = 0.1;

/// One number per function.
pub type Components = [f64; COMPONENTS];

/// (sine, cosine) of a parameter.
pub type SinCos = (f64, f64);

/// What is integrated over two angles u and v.
pub trait Integrand {
    /// The functions, the area element included.
    fn values(&self, u: SinCos, v: SinCos) -> Components;

    /// The coordinates on which the narrow feature depends, scaled so that it is 1 wide about the origin and, at the
    /// distance s from there, varies over lengths of about 1 + s.
    fn feature(&self, u: SinCos, v: SinCos) -> [f64; 2];
}

/// A rectangle of parameters, radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rect {
    /// First parameter, [lower, upper].
    pub u: [f64; 2],
    /// Second parameter, [lower, upper].
    pub v: [f64; 2],
}

impl Rect {
    /// The two halves; `None` where there is no number left between the ends.
    fn halves(self, along: Along) -> Option<[Rect; 2]> {
        let [lower, upper] = if along == Along::U { self.u } else { self.v };
        let middle = 0.5 * (lower + upper);
        if !(lower < middle && middle < upper) {
            return None;
        }
        let part = |ends| if along == Along::U { Rect { u: ends, ..self } } else { Rect { v: ends, ..self } };
        Some([part([lower, middle]), part([middle, upper])])
    }

    /// Its four quarters.
    pub fn quarters(self) -> [Rect; 4] {
        let ([a, b], [c, d]) = (self.u, self.v);
        let (u, v) = (0.5 * (a + b), 0.5 * (c + d));
        [([a, u], [c, v]), ([a, u], [v, d]), ([u, b], [c, v]), ([u, b], [v, d])].map(|(u, v)| Rect { u, v })
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Along {
    U,
    V,
}

/// When the sum over the rectangles is good enough: every component's error <= max(relative |I|, absolute).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Precision {
    /// Of the component's own integral.
    pub relative: Components,
    /// In the unit of the integral.
    pub absolute: f64,
    /// The refinement gives up beyond so many rectangles, and the error tells.
    pub max_rectangles: usize,
}

/// Integrals with their errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integral {
    /// The integrals, order 15.
    pub value: Components,
    /// Sum over the rectangles of the disagreement with order 7, an upper estimate for anything smooth.
    pub error: Components,
    /// Rectangles in the end.
    pub rectangles: usize,
}

/// Largest variation of the feature's coordinates over a rectangle that may be integrated, in units of 1 + s. The
/// poles of 1/(1 + s^2)^2 then lie at least 1/FEATURE_STEP rectangle widths away, where order 15 gives six digits.
const FEATURE_STEP: f64 = 2.0;

/// Integrates over all `rects` to the wanted precision.
///
/// First every rectangle is halved until the feature is *resolved* on it: over its corners, edge middles and centre
/// the coordinates s vary by at most 2 (1 + min |s|). Only then is an error estimate believed, so a lobe of 1e-4 rad
/// cannot hide between the nodes of a large bin. Then the rectangle with the largest error is halved, along the
/// parameter in which the two orders disagree more, until the precision is reached.
// Tested by `a_spike_far_smaller_than_the_rectangle_is_found`, `polynomials_are_integrated_exactly`.
pub fn integrate<I: Integrand>(integrand: &I, rects: &[Rect], precision: &Precision) -> Integral {
    let mut leaves = Vec::new();
    for &rect in rects {
        resolve(integrand, rect, &mut leaves);
    }
    refine(integrand, leaves, precision)
}

/// Halves `rect` until the feature is resolved, and integrates the pieces.
fn resolve<I: Integrand>(integrand: &I, rect: Rect, leaves: &mut Vec<Leaf>) {
    let mut open = vec![rect];
    while let Some(rect) = open.pop() {
        match unresolved(integrand, rect).and_then(|along| rect.halves(along)) {
            Some([lower, upper]) => open.extend([upper, lower]),
            None => leaves.push(Leaf::new(integrand, rect)),
        }
    }
}

/// The parameter along which the feature varies too much, `None` where it is resolved.
fn unresolved<I: Integrand>(integrand: &I, rect: Rect) -> Option<Along> {
    let thirds = |[a, b]: [f64; 2]| [a, 0.5 * (a + b), b].map(f64::sin_cos);
    let (us, vs) = (thirds(rect.u), thirds(rect.v));
    let s = us.map(|u| vs.map(|v| integrand.feature(u, v)));
    let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let (mut along_u, mut along_v, mut nearest) = (0.0f64, 0.0f64, f64::INFINITY);
    let path = |[a, b, c]: [[f64; 2]; 3]| distance(a, b) + distance(b, c);
    for (k, &row) in s.iter().enumerate() {
        along_v = along_v.max(path(row));
        along_u = along_u.max(path([s[0][k], s[1][k], s[2][k]]));
        nearest = row.iter().fold(nearest, |least, p| least.min(p[0].hypot(p[1])));
    }
    let allowed = FEATURE_STEP * (1.0 + nearest);
    if along_u.max(along_v) <= allowed {
        None
    } else if along_u >= along_v {
        Some(Along::U)
    } else {
        Some(Along::V)
    }
}

fn refine<I: Integrand>(integrand: &I, leaves: Vec<Leaf>, precision: &Precision) -> Integral {
    let (mut value, mut error) = totals(&leaves);
    let allowed = |value: &Components| {
        let mut allowed = [0.0; COMPONENTS];
        for c in 0..COMPONENTS {
            allowed[c] = (precision.relative[c] * value[c].abs()).max(precision.absolute);
        }
        allowed
    };
    let scale = allowed(&value);
    let mut heap: BinaryHeap<Leaf> = leaves.into_iter().map(|leaf| leaf.ranked(&scale)).collect();
    let mut settled = Vec::new();
    while heap.len() + settled.len() < precision.max_rectangles {
        let good = allowed(&value);
        if (0..COMPONENTS).all(|c| error[c] <= good[c]) {
            break;
        }
        let Some(worst) = heap.pop() else { break };
        let Some(halves) = worst.rect.halves(worst.along) else {
            settled.push(worst);
            continue;
        };
        let parts = halves.map(|rect| Leaf::new(integrand, rect).ranked(&scale));
        for c in 0..COMPONENTS {
            value[c] += parts[0].value[c] + parts[1].value[c] - worst.value[c];
            error[c] += parts[0].error[c] + parts[1].error[c] - worst.error[c];
        }
        heap.extend(parts);
    }
    settled.append(&mut heap.into_vec());
    let (value, error) = totals(&settled);
    Integral { value, error, rectangles: settled.len() }
}

fn totals(leaves: &[Leaf]) -> (Components, Components) {
    let (mut value, mut error) = ([0.0; COMPONENTS], [0.0; COMPONENTS]);
    for leaf in leaves {
        for c in 0..COMPONENTS {
            value[c] += leaf.value[c];
            error[c] += leaf.error[c];
        }
    }
    (value, error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn precision(relative: f64) -> Precision {
        Precision { relative: [relative; COMPONENTS], absolute: 1e-300, max_rectangles: 100_000 }
    }

    /// Powers of the parameters themselves, for angles small enough that asin is exact to rounding.
    struct Powers;

    impl Integrand for Powers {
        fn values(&self, u: SinCos, v: SinCos) -> Components {
            let (u, v) = (u.0.asin(), v.0.asin());
            [1.0, u.powi(13), v.powi(13), u.powi(12) * v.powi(12), u.powi(22), v.powi(22), u * v, 0.0]
        }

        fn feature(&self, _: SinCos, _: SinCos) -> [f64; 2] {
            [0.0, 0.0]
        }
    }

    #[test]
    fn polynomials_are_integrated_exactly() {
        let once = Precision { max_rectangles: 1, ..precision(1.0) };
        let found = integrate(&Powers, &[Rect { u: [0.0, 1.0], v: [0.0, 1.0] }], &once);
        assert_eq!(found.rectangles, 1);
        let expected = [1.0, 1.0 / 14.0, 1.0 / 14.0, 1.0 / 169.0, 1.0 / 23.0, 1.0 / 23.0, 0.25, 0.0];
        for (found, expected) in found.value.iter().zip(expected) {
            // Degree 23 is exact; 225 terms, asin and a power of at most 22 round to 64 ulp.
            assert!((found - expected).abs() <= 64.0 * f64::EPSILON, "{found} {expected}");
        }
    }

    /// 1/(pi w^2 (1 + r^2/w^2)^2) about a point: its integral over the plane is 1.
    struct Spike {
        width: f64,
    }

    impl Integrand for Spike {
        fn values(&self, u: SinCos, v: SinCos) -> Components {
            let [x, y] = self.feature(u, v);
            let mut values = [0.0; COMPONENTS];
            values[0] = 1.0 / (PI * self.width * self.width * (1.0 + x * x + y * y).powi(2));
            values
        }

        fn feature(&self, u: SinCos, v: SinCos) -> [f64; 2] {
            [(u.0.atan2(u.1) - 0.1234) / self.width, (v.0.atan2(v.1) - 0.4321) / self.width]
        }
    }

    #[test]
    fn a_spike_far_smaller_than_the_rectangle_is_found() {
        for width in [1e-2, 1e-5, 1e-8] {
            let found =
                integrate(&Spike { width }, &[Rect { u: [-1.0, 1.0], v: [-1.0, 1.0] }], &precision(1e-6));
            // Outside the square, which reaches at least 0.56 from the point, there is less than width^2/0.56^2. The
            // disagreement of the orders, 1e-6, bounds the rest; the position rounds to 1e-16/width.
            let tolerance = 1e-6 + 4.0 * width * width + 1e-15 / width;
            assert!((found.value[0] - 1.0).abs() < tolerance, "{width}: {found:?}");
            assert!(found.rectangles < 2000, "{width}: {}", found.rectangles);
        }
    }
}
