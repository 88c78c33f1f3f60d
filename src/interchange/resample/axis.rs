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
pub(crate) struct Taps<'a> {
    nodes: &'a [Node],
    weights: [f64; 4],
}

impl Taps<'_> {
    pub fn iter(&self) -> impl Iterator<Item = Tap> + '_ {
        let tap = |(&(_, node, reflected), weight): (&Node, f64)| Tap { node, weight, reflected };
        self.nodes.iter().zip(self.weights).map(tap)
    }
}

/// A node's angle, its number, and whether it is seen through the pole.
type Node = (f64, usize, bool);

/// Increasing nodes, and what Lagrange's polynomials through neighbours need.
#[derive(Debug, Clone)]
struct Nodes {
    all: Vec<Node>,
    /// By the first of four neighbours, for each of them: 1 over the product of its distances from the others. Exports
    /// ask for billions of taps, and divisions cost more than all else there.
    inverse: Vec<[f64; 4]>,
    /// Nodes per angle: most axes are even.
    density: f64,
}

impl Nodes {
    fn new(all: Vec<Node>) -> Self {
        let distances = |nodes: &[Node], k: usize| -> f64 {
            (0..4).filter(|&j| j != k).map(|j| nodes[k].0 - nodes[j].0).product()
        };
        let inverse =
            all.windows(4).map(|nodes| std::array::from_fn(|k| 1.0 / distances(nodes, k))).collect();
        let density = (all.len() - 1) as f64 / (all[all.len() - 1].0 - all[0].0);
        Nodes { all, inverse, density }
    }

    /// `count` taps, 4 or fewer, of the nodes about x.
    fn taps(&self, x: f64, count: usize) -> Taps<'_> {
        let count = count.min(self.all.len());
        let start = self.at_most(x).saturating_sub(count.div_ceil(2)).min(self.all.len() - count);
        let nodes = &self.all[start..start + count];
        let weights = match *nodes {
            [a, b, c, d] => {
                let [a, b, c, d] = [a, b, c, d].map(|node| x - node.0);
                let (ab, cd) = (a * b, c * d);
                let above = [b * cd, a * cd, ab * d, ab * c];
                std::array::from_fn(|k| above[k] * self.inverse[start][k])
            }
            [a, b, c] => [weight(x, a, [b, c]), weight(x, b, [a, c]), weight(x, c, [a, b]), 0.0],
            [a, b] => [weight(x, a, [b]), weight(x, b, [a]), 0.0, 0.0],
            _ => [1.0, 0.0, 0.0, 0.0],
        };
        Taps { nodes, weights }
    }

    /// How many of the angles are at most `x`. On an even axis it takes no search.
    fn at_most(&self, x: f64) -> usize {
        let (nodes, n) = (&self.all, self.all.len());
        let even = (x - nodes[0].0) * self.density;
        let count = (even.clamp(0.0, n as f64) as usize + 1).min(n);
        if nodes[count - 1].0 <= x && nodes.get(count).is_none_or(|next| next.0 > x) {
            return count;
        }
        nodes.partition_point(|node| node.0 <= x)
    }
}

/// Lagrange's weight of a node among few.
fn weight<const N: usize>(x: f64, node: Node, others: [Node; N]) -> f64 {
    others.iter().map(|other| (x - other.0) / (node.0 - other.0)).product()
}

/// Increasing angles from the pole, radians; beyond the last the value there holds.
#[derive(Debug, Clone)]
pub(crate) struct Polar {
    /// Those through the pole first.
    nodes: Nodes,
}

impl Polar {
    /// `nodes` increase strictly. With `through_pole` two of them are seen at negative angles.
    pub fn new(nodes: &[f64], through_pole: bool) -> Self {
        let first = usize::from(nodes[0] == 0.0);
        let mirrored = nodes.iter().enumerate().skip(first).take(if through_pole { 2 } else { 0 });
        let mut all: Vec<Node> = mirrored.map(|(k, &t)| (-t, k, true)).collect();
        all.reverse();
        all.extend(nodes.iter().enumerate().map(|(k, &t)| (t, k, false)));
        Polar { nodes: Nodes::new(all) }
    }

    /// The cubic's taps at `x` >= 0.
    pub fn cubic(&self, x: f64) -> Taps<'_> {
        self.taps(x, 4)
    }

    /// The taps of the straight line at `x` >= 0.
    pub fn linear(&self, x: f64) -> Taps<'_> {
        self.taps(x, 2)
    }

    fn taps(&self, x: f64, count: usize) -> Taps<'_> {
        let all = &self.nodes.all;
        self.nodes.taps(x.clamp(all[0].0, all[all.len() - 1].0), count)
    }
}

/// Azimuths on the circle, radians.
#[derive(Debug, Clone)]
pub(crate) struct AzimuthCircle {
    /// With the last two a turn before and the first two a turn later.
    nodes: Nodes,
    count: usize,
}

impl AzimuthCircle {
    /// The azimuths must increase strictly and lie in [0, 2 pi).
    pub fn new(azimuths: Vec<f64>) -> Self {
        let count = azimuths.len();
        let turned = |turn: f64| azimuths.iter().enumerate().map(move |(k, &phi)| (phi + turn, k, false));
        let more = count.min(2);
        let all = turned(-TAU).skip(count - more).chain(turned(0.0)).chain(turned(TAU).take(more));
        AzimuthCircle { nodes: Nodes::new(all.collect()), count }
    }

    pub fn cubic(&self, x: f64) -> Taps<'_> {
        self.taps(x, if self.count < 4 { 2 } else { 4 })
    }

    pub fn linear(&self, x: f64) -> Taps<'_> {
        self.taps(x, 2)
    }

    /// The widest step between neighbours.
    pub fn widest_gap(&self) -> f64 {
        let step = |pair: &[Node]| pair[1].0 - pair[0].0;
        self.nodes.all.windows(2).map(step).fold(0.0, f64::max)
    }

    fn taps(&self, x: f64, count: usize) -> Taps<'_> {
        // No remainder, which is as dear as a division: most angles are in range.
        let x = if (0.0..TAU).contains(&x) { x } else { x.rem_euclid(TAU) };
        self.nodes.taps(x, count.min(self.count))
    }
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
