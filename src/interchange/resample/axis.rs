//! Cubic interpolation along the axes of a table: polar angles that go on through the pole, azimuths that wrap.

use std::f64::consts::TAU;

/// The widest gap between azimuths that is interpolated over.
pub(crate) const WIDEST_GAP_DEG: f64 = 46.0;

/// A node, its weight, and whether it is seen through the pole (its azimuth then counts from the other side).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tap {
    pub node: usize,
    pub weight: f64,
    pub reflected: bool,
}

/// At most four taps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Taps {
    taps: [Tap; 4],
    count: usize,
}

impl Taps {
    pub fn iter(&self) -> impl Iterator<Item = Tap> + '_ {
        self.taps[..self.count].iter().copied()
    }

    fn of(nodes: &[(f64, usize, bool)], x: f64) -> Self {
        let mut taps = [Tap { node: 0, weight: 0.0, reflected: false }; 4];
        for (k, &(xk, node, reflected)) in nodes.iter().enumerate() {
            // Lagrange's polynomial through up to four nodes. Divisions cost more than all else here: one for each; at
            // the node itself both products are the same number.
            let (mut above, mut below) = (1.0, 1.0);
            for (j, &(xj, ..)) in nodes.iter().enumerate() {
                if j != k {
                    above *= x - xj;
                    below *= xk - xj;
                }
            }
            taps[k] = Tap { node, weight: above / below, reflected };
        }
        Taps { taps, count: nodes.len() }
    }
}

/// Increasing angles from the pole, radians; beyond the last the value there holds.
#[derive(Debug, Clone)]
pub(crate) struct Polar {
    /// (angle, node, reflected), those through the pole first.
    extended: Vec<(f64, usize, bool)>,
}

impl Polar {
    /// `nodes` increase strictly. With `through_pole` two of them are seen at negative angles.
    pub fn new(nodes: &[f64], through_pole: bool) -> Self {
        let first = usize::from(nodes[0] == 0.0);
        let mirrored = nodes.iter().enumerate().skip(first).take(if through_pole { 2 } else { 0 });
        let mut extended: Vec<_> = mirrored.map(|(k, &t)| (-t, k, true)).collect();
        extended.reverse();
        extended.extend(nodes.iter().enumerate().map(|(k, &t)| (t, k, false)));
        Polar { extended }
    }

    /// The cubic's taps at `x` >= 0.
    pub fn cubic(&self, x: f64) -> Taps {
        self.taps(x, 4)
    }

    /// The taps of the straight line at `x` >= 0.
    pub fn linear(&self, x: f64) -> Taps {
        self.taps(x, 2)
    }

    fn taps(&self, x: f64, count: usize) -> Taps {
        let nodes = &self.extended;
        let count = count.min(nodes.len());
        let x = x.clamp(nodes[0].0, nodes[nodes.len() - 1].0);
        let above = at_most(nodes, |node| node.0, x);
        let start = above.saturating_sub(count / 2 + count % 2).min(nodes.len() - count);
        Taps::of(&nodes[start..start + count], x)
    }
}

/// Azimuths on the circle, radians.
#[derive(Debug, Clone)]
pub(crate) struct AzimuthCircle {
    /// Increasing, in [0, 2 pi).
    nodes: Vec<f64>,
}

impl AzimuthCircle {
    /// The nodes must increase strictly and lie in [0, 2 pi).
    pub fn new(nodes: Vec<f64>) -> Self {
        AzimuthCircle { nodes }
    }

    pub fn cubic(&self, x: f64) -> Taps {
        self.taps(x, if self.nodes.len() < 4 { 2 } else { 4 })
    }

    pub fn linear(&self, x: f64) -> Taps {
        self.taps(x, 2)
    }

    /// The widest step between neighbours.
    pub fn widest_gap(&self) -> f64 {
        let n = self.nodes.len();
        let step = |k: usize| (self.nodes[(k + 1) % n] - self.nodes[k]).rem_euclid(TAU);
        if n == 1 { TAU } else { (0..n).map(step).fold(0.0, f64::max) }
    }

    fn taps(&self, x: f64, count: usize) -> Taps {
        let n = self.nodes.len();
        let count = count.min(n);
        // No remainders, which are as dear as divisions: most angles are in range, and at most one turn is crossed.
        let x = if (0.0..TAU).contains(&x) { x } else { x.rem_euclid(TAU) };
        let above = at_most(&self.nodes, |&node| node, x) as isize;
        let start = above - (count / 2 + count % 2) as isize;
        let mut nodes = [(0.0, 0, false); 4];
        for (k, slot) in nodes.iter_mut().take(count).enumerate() {
            let (index, n) = (start + k as isize, n as isize);
            let (wrapped, turn) = match index {
                below if below < 0 => (below + n, -TAU),
                beyond if beyond >= n => (beyond - n, TAU),
                inside => (inside, 0.0),
            };
            *slot = (self.nodes[wrapped as usize] + turn, wrapped as usize, false);
        }
        Taps::of(&nodes[..count], x)
    }
}

/// How many of the increasing angles are at most `x`. Most axes are even: there it takes no search.
fn at_most<T>(nodes: &[T], angle: impl Fn(&T) -> f64, x: f64) -> usize {
    let n = nodes.len();
    let (first, last) = (angle(&nodes[0]), angle(&nodes[n - 1]));
    let even = (x - first) / (last - first) * (n - 1) as f64;
    let count = (even.clamp(0.0, n as f64) as usize + 1).min(n);
    if angle(&nodes[count - 1]) <= x && nodes.get(count).is_none_or(|next| angle(next) > x) {
        return count;
    }
    nodes.partition_point(|node| angle(node) <= x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_reproduced_between_uneven_nodes() {
        let nodes = [0.1, 0.3, 0.35, 0.7, 1.1, 1.5];
        let axis = Polar::new(&nodes, false);
        let f = |x: f64| 1.0 - 2.0 * x + 3.0 * x * x - 0.5 * x * x * x;
        for x in [0.1, 0.2, 0.33, 0.5, 1.0, 1.49] {
            let found: f64 = axis.cubic(x).iter().map(|tap| tap.weight * f(nodes[tap.node])).sum();
            // A few operations on numbers of order 1.
            assert!((found - f(x)).abs() < 1e-14, "{x}: {found}");
        }
    }

    #[test]
    fn the_pole_and_the_full_turn_are_crossed() {
        // An even function of the polar angle, seen through the pole.
        let axis = Polar::new(&[0.05, 0.15, 0.25, 0.35], true);
        let at: f64 = axis
            .cubic(0.0)
            .iter()
            .map(|tap| tap.weight * [0.05, 0.15, 0.25, 0.35f64][tap.node].powi(2))
            .sum();
        assert!(at.abs() < 1e-15 && axis.cubic(0.0).iter().filter(|tap| tap.reflected).count() == 2, "{at}");
        let circle = AzimuthCircle::new((0..36).map(|k| f64::from(k) * TAU / 36.0).collect());
        let at: f64 =
            circle.cubic(-0.01).iter().map(|tap| tap.weight * (tap.node as f64 * TAU / 36.0).cos()).sum();
        // Cubic's error: h^4 3/128 f'''' = (0.1745)^4/43.
        assert!((at - 0.01f64.cos()).abs() < 2.2e-5, "{at}");
    }
}
