//! The Gauss-Kronrod rule of orders 7 and 15, Kronrod 1965 in QUADPACK's digits: its nodes and weights, and what both orders
//! make of a rectangle.

use std::cmp::Ordering;

use super::{Along, COMPONENTS, Components, Integrand, Rect};

/// Nodes between two ends, with their weights in the rules of order 15 and of order 7.
pub(crate) fn both_orders([a, b]: [f64; 2]) -> [(f64, [f64; 2]); 15] {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let low = |k: usize| if k % 2 == 1 { GAUSS[k / 2] } else { 0.0 };
    std::array::from_fn(|k| (middle + half * NODES[k], [half * KRONROD[k], half * low(k)]))
}

/// Nodes of order 15 on [-1, 1]; every second one belongs to order 7.
const NODES: [f64; 15] = [
    -0.991_455_371_120_812_6,
    -0.949_107_912_342_758_5,
    -0.864_864_423_359_769_1,
    -0.741_531_185_599_394_4,
    -0.586_087_235_467_691_1,
    -0.405_845_151_377_397_2,
    -0.207_784_955_007_898_47,
    0.0,
    0.207_784_955_007_898_47,
    0.405_845_151_377_397_2,
    0.586_087_235_467_691_1,
    0.741_531_185_599_394_4,
    0.864_864_423_359_769_1,
    0.949_107_912_342_758_5,
    0.991_455_371_120_812_6,
];

const KRONROD: [f64; 15] = [
    0.022_935_322_010_529_225,
    0.063_092_092_629_978_56,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_82,
    0.204_432_940_075_298_9,
    0.190_350_578_064_785_4,
    0.169_004_726_639_267_9,
    0.140_653_259_715_525_92,
    0.104_790_010_322_250_18,
    0.063_092_092_629_978_56,
    0.022_935_322_010_529_225,
];

const GAUSS: [f64; 7] = [
    0.129_484_966_168_869_7,
    0.279_705_391_489_276_64,
    0.381_830_050_505_118_9,
    0.417_959_183_673_469_4,
    0.381_830_050_505_118_9,
    0.279_705_391_489_276_64,
    0.129_484_966_168_869_7,
];

/// A rectangle with its integrals.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaf {
    pub(super) rect: Rect,
    pub(super) value: Components,
    pub(super) error: Components,
    /// Where the two orders disagree more.
    pub(super) along: Along,
    /// Largest error in units of the wanted precision.
    rank: f64,
}

impl Leaf {
    pub(super) fn new<I: Integrand>(integrand: &I, rect: Rect) -> Leaf {
        let nodes = |[a, b]: [f64; 2]| {
            let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
            (NODES.map(|x| (middle + half * x).sin_cos()), half)
        };
        let ((us, half_u), (vs, half_v)) = (nodes(rect.u), nodes(rect.v));
        let (mut both, mut low_u, mut low_v) = ([0.0; COMPONENTS], [0.0; COMPONENTS], [0.0; COMPONENTS]);
        for (i, &u) in us.iter().enumerate() {
            let (mut row, mut low_row) = ([0.0; COMPONENTS], [0.0; COMPONENTS]);
            for (j, &v) in vs.iter().enumerate() {
                let f = integrand.values(u, v);
                add(&mut row, KRONROD[j], &f);
                if j % 2 == 1 {
                    add(&mut low_row, GAUSS[j / 2], &f);
                }
            }
            add(&mut both, KRONROD[i], &row);
            add(&mut low_v, KRONROD[i], &low_row);
            if i % 2 == 1 {
                add(&mut low_u, GAUSS[i / 2], &row);
            }
        }
        let area = half_u * half_v;
        let (mut value, mut error, mut worst) = ([0.0; COMPONENTS], [0.0; COMPONENTS], (0.0f64, 0.0f64));
        for c in 0..COMPONENTS {
            let (in_u, in_v) = (area * (both[c] - low_u[c]).abs(), area * (both[c] - low_v[c]).abs());
            value[c] = area * both[c];
            error[c] = in_u + in_v;
            worst = (worst.0.max(in_u), worst.1.max(in_v));
        }
        let along = if worst.0 >= worst.1 { Along::U } else { Along::V };
        Leaf { rect, value, error, along, rank: 0.0 }
    }

    pub(super) fn ranked(mut self, scale: &Components) -> Leaf {
        self.rank = (0..COMPONENTS).fold(0.0, |rank, c| rank.max(self.error[c] / scale[c]));
        self
    }
}

fn add(sum: &mut Components, weight: f64, f: &Components) {
    for c in 0..COMPONENTS {
        sum[c] += weight * f[c];
    }
}

impl PartialEq for Leaf {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Leaf {}

impl PartialOrd for Leaf {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Leaf {
    fn cmp(&self, other: &Self) -> Ordering {
        self.rank.total_cmp(&other.rank)
    }
}
