//! The slopes that facets should get, and their divergence.

use super::facets::{Facets, GROUP, Rows, padded};
use super::feedback::{Feedback, TURNS};
use super::length_ranks::LengthRanks;
use super::ranking::Ranking;
use super::slope_law::SlopeLaw;
use crate::lanes::LaneWork;
use crate::lanes::vector::{Gathered, Lanes};

/// What facets become, by the bin of their slope.
pub(super) struct Targets {
    /// For each bin 1 over the squared length that its shortest slopes get, and what that grows by to its longest.
    ///
    /// Of 1/r^2 = (1 - u)/u the law of GGX's longest slopes is a straight line in u; of r or r^2 it is far from one.
    reciprocals: Gathered,
    turns: Option<Turns>,
}

/// How far directions are turned.
struct Turns {
    /// The length class of each bin of slopes; a whole number.
    classes: Gathered,
    /// `Feedback::turn_coefficients`.
    coefficients: [[f32; 8]; TURNS],
}

impl Targets {
    /// Of the law's length at each rank (corrected), nearly in a facet's own direction.
    pub fn new(law: SlopeLaw, ranking: &Ranking, feedback: &Feedback) -> Self {
        let bins = ranking.lengths.number_of_bins();
        let mut reciprocals = vec![0.0f32; 2 * bins];
        let coefficients = feedback.turn_coefficients();
        let mut classes = vec![0.0f32; if coefficients.is_some() { bins } else { 0 }];
        for bin in ranking.lengths.bins() {
            // A level facet is as good as one of 1e-19.
            let reciprocal = |share: f64| {
                let length = law.length_quantile(share) * f64::from(feedback.gain_at(share as f32));
                (length.powi(-2) as f32).min(f32::MAX)
            };
            let [shortest, longest] = bin.shares.map(reciprocal);
            reciprocals[2 * bin.index] = shortest;
            reciprocals[2 * bin.index + 1] = longest - shortest;
            if coefficients.is_some() {
                classes[bin.index] = Feedback::length_class(bin.middle()) as f32;
            }
        }
        let turns = coefficients.map(|coefficients| Turns { classes: Gathered::new(classes), coefficients });
        Targets { reciprocals: Gathered::new(reciprocals), turns }
    }

    /// The wanted slopes of facets of a family.
    ///
    /// A surplus density of azimuths 2 sum (c_k cos k psi + s_k sin k psi) vanishes, to first order, under
    /// psi -> psi + sum 2/k (c_k sin k psi - s_k cos k psi).
    #[inline(always)]
    fn of<L: Lanes>(&self, l: L, ranking: &Ranking, family: usize, facets: &Facets<L>) -> [L::F; 2] {
        let squared = LengthRanks::told_apart(l, facets);
        let bin = ranking.bins(l, family, facets, squared);
        let at = l.add_i(bin, bin);
        let growth = l.gather(&self.reciprocals, l.add_i(at, l.splat_i(1)));
        let reciprocal = l.add(l.gather(&self.reciprocals, at), l.mul(LengthRanks::part(l, squared), growth));
        let ratio = l.mul(reciprocal, squared);
        let one = l.splat(1.0);
        let [x, y] = facets.slope;
        let Some(turns) = &self.turns else {
            let scale = l.div(one, l.sqrt(ratio));
            return [l.mul(x, scale), l.mul(y, scale)];
        };
        // The tangent for the angle: they differ by its cube, and it is a few hundredths.
        let tangent = turns.angle(l, bin, facets, squared);
        let scale = l.div(one, l.sqrt(l.mul(ratio, l.add(one, l.mul(tangent, tangent)))));
        let turned = [l.sub(x, l.mul(tangent, y)), l.add(y, l.mul(tangent, x))];
        turned.map(|turned| l.mul(turned, scale))
    }
}

impl Turns {
    /// The angles that facets are turned by.
    #[inline(always)]
    fn angle<L: Lanes>(&self, l: L, bin: L::I, facets: &Facets<L>, squared: L::F) -> L::F {
        let class = l.trunc(l.gather(&self.classes, bin));
        let mut angle = l.splat(0.0);
        for ([cos, sin], tables) in
            powers(l, facets, squared).into_iter().zip(self.coefficients.as_chunks().0)
        {
            let [of_sin, of_cos] = tables;
            let turned = l.sub(l.mul(l.look_up(of_sin, class), sin), l.mul(l.look_up(of_cos, class), cos));
            angle = l.add(angle, turned);
        }
        angle
    }
}

/// Cosine and sine of 2, 3 and 4 times the azimuths of facets; all 0 of a level facet.
#[inline(always)]
pub(super) fn powers<L: Lanes>(l: L, facets: &Facets<L>, squared: L::F) -> [[L::F; 2]; TURNS / 2] {
    let inverse = l.div(l.splat(1.0), l.sqrt(squared));
    let unit = facets.slope.map(|part| l.mul(part, inverse));
    let times = |[x, y]: [L::F; 2], [u, v]: [L::F; 2]| {
        [l.sub(l.mul(x, u), l.mul(y, v)), l.add(l.mul(x, v), l.mul(y, u))]
    };
    let second = times(unit, unit);
    let third = times(second, unit);
    [second, third, times(third, unit)]
}

/// Makes heights their targets' divergence, in place.
pub(super) struct WriteDivergence<'a> {
    pub side: usize,
    pub heights: &'a mut [f32],
    pub ranking: &'a Ranking,
    pub targets: &'a Targets,
}

/// The wanted slopes of a row's lower and upper facets; cell x stands at x + 1, and the last one at 0 as well.
struct TargetRow {
    slopes: [[Vec<f32>; 2]; 2],
}

impl WriteDivergence<'_> {
    #[inline(always)]
    fn targets<L: Lanes>(&self, l: L, rows: &Rows, to: &mut TargetRow) {
        for x in (0..self.side.next_multiple_of(GROUP)).step_by(L::WIDTH) {
            for (family, facets) in rows.facets(l, x).into_iter().enumerate() {
                let target = self.targets.of(l, self.ranking, family, &facets);
                for (part, row) in target.into_iter().zip(&mut to.slopes[family]) {
                    l.store(&mut row[x + 1..], part);
                }
            }
        }
        to.slopes.as_flattened_mut().iter_mut().for_each(|row| row[0] = row[self.side]);
    }
}

impl LaneWork for WriteDivergence<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let n = self.side;
        let room = || TargetRow { slopes: [(); 2].map(|()| [(); 2].map(|()| padded(n + 1))) };
        let (mut before, mut here) = (room(), room());
        let first = self.heights[..n].to_vec();
        let mut rows = Rows::new(&self.heights[(n - 1) * n..], &first);
        self.targets(l, &rows, &mut before);
        let mut out = padded(n);
        for y in 0..n {
            // Behind the last row the first one follows, which is written over by then.
            if y + 1 < n {
                rows.advance(&self.heights[(y + 1) * n..][..n]);
            } else {
                rows.advance(&first);
            }
            self.targets(l, &rows, &mut here);
            divergence(l, n, &before, &here, &mut out);
            self.heights[y * n..][..n].copy_from_slice(&out[..n]);
            std::mem::swap(&mut before, &mut here);
        }
    }
}

/// The edge from (x, y) along x belongs to the lower facet of cell (x, y) and to the upper facet of (x, y-1).
#[inline(always)]
fn divergence<L: Lanes>(l: L, n: usize, before: &TargetRow, here: &TargetRow, out: &mut [f32]) {
    let [[low_x, low_y], [_, up_y]] = &here.slopes;
    let [[_, low_y_before], [up_x_before, up_y_before]] = &before.slopes;
    for x in (0..n.next_multiple_of(GROUP)).step_by(L::WIDTH) {
        let left = |row: &[f32]| l.load(&row[x..]);
        let own = |row: &[f32]| l.load(&row[x + 1..]);
        let along_x = l.sub(l.add(left(low_x), left(up_x_before)), l.add(own(low_x), own(up_x_before)));
        let along_y = l.sub(l.add(own(low_y_before), left(up_y_before)), l.add(own(low_y), left(up_y)));
        l.store(&mut out[x..], l.mul(l.splat(0.5), l.add(along_x, along_y)));
    }
}
