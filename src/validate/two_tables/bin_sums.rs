//! The bins of two tables: sums of their differences and of what noise explains of these.

use super::compared_table::{ComparedTable, paired};
use super::differences::{BinDifferences, ValueIndex};
use super::figures::DifferenceFigures;
use crate::instrument::Region;
use crate::instrument::folded_incidences;
use crate::stats;
use crate::table::Realisations;
use crate::validate::counted_bins::counted_bins;
use crate::validate::model_distance;

/// Realisations of a table that does not say how many it has: Student's t is the normal law by then.
const MANY: usize = 1000;

/// Both tables with what their errors need.
pub(super) struct ComparedPair<'a> {
    a: ComparedTable<'a>,
    b: ComparedTable<'a>,
    /// Which incidence of the realisations is the tables' first.
    first_incidence: usize,
    /// The realisations of both, where they can be paired.
    pub paired: Option<(&'a Realisations, &'a Realisations)>,
    /// The differences by realisation, paired or not.
    by_part: Option<BinDifferences<'a>>,
    realisations: [usize; 2],
    /// (95 % limit of t, c4) by degrees of freedom, from 1.
    limits: Vec<(f64, f64)>,
    folded: Vec<bool>,
}

impl<'a> ComparedPair<'a> {
    pub fn new(a: ComparedTable<'a>, b: ComparedTable<'a>, first_incidence: usize) -> Self {
        let paired = paired(&a, &b);
        let count = |side: &ComparedTable| {
            side.campaign.map_or(MANY, |campaign| campaign.surface.realisations as usize).min(MANY)
        };
        let realisations = [count(&a), count(&b)];
        let most = match paired {
            Some((parts, _)) => parts.parts.len() - 1,
            None => (realisations[0] + realisations[1]).saturating_sub(2),
        };
        let limits = (1..=most).map(|dof| (stats::student_limit(0.05, dof), stats::c4(dof + 1))).collect();
        let folds = |side: &ComparedTable| {
            side.campaign.map(|campaign| folded_incidences(campaign, &side.table.grid))
        };
        let none = || vec![false; a.table.grid.incidences()];
        let (in_a, in_b) = (folds(&a).unwrap_or_else(none), folds(&b).unwrap_or_else(none));
        let folded = in_a.iter().zip(in_b).map(|(&a, b)| a && b).collect();
        let by_part = BinDifferences::new(a, b);
        ComparedPair { a, b, first_incidence, paired, by_part, realisations, limits, folded }
    }

    pub fn most_dof(&self) -> usize {
        self.limits.len().max(1)
    }

    pub fn incidence(&self, incidence: usize) -> DifferenceSums {
        let grid = &self.a.table.grid;
        let bins = grid.bins();
        let counted = counted_bins(grid, incidence, self.folded[incidence]);
        let parts = self.by_part.as_ref().map_or(0, BinDifferences::count);
        let mut sums = DifferenceSums { parts: vec![0.0; parts], ..DifferenceSums::default() };
        for (bin, region) in grid.regions(incidence).iter().enumerate() {
            for colour in 0..self.a.table.colours.len() {
                self.entry(
                    TableEntry { at: incidence * bins + bin, colour },
                    region,
                    counted[bin],
                    &mut sums,
                );
            }
        }
        sums
    }

    fn entry(&self, entry: TableEntry, region: &Region, counted: bool, sums: &mut DifferenceSums) {
        let TableEntry { at, colour } = entry;
        if self.a.table.is_gap(at) || self.b.table.is_gap(at) {
            return;
        }
        let value = |side: &ComparedTable| f64::from(side.table.colours[colour].total[at]);
        let (a, b) = (value(&self.a), value(&self.b));
        let hit = self.a.table.hits[at] > 0 && self.b.table.hits[at] > 0;
        let w = region.projected_solid_angle();
        // Arms without an aperture have no size: their directions count alike.
        let w = if w > 0.0 { w } else { 1.0 };
        sums.distance += (a - b).abs() * w;
        sums.flux += b * w;
        if let Some(by_part) = &self.by_part {
            let stored = self.first_incidence * self.a.table.grid.bins() + at;
            match by_part.at(ValueIndex { here: at, stored, colour }) {
                Some(x) => model_distance::add_products(&x, w, &mut sums.parts),
                None => sums.without_error = true,
            }
        }
        let Some((se, dof)) = self.error(entry, hit, a.max(b)) else {
            sums.without_error = true;
            return;
        };
        let (limit, c4) = self.limits[dof - 1];
        sums.noise += se * w / c4;
        if hit && counted && se > 0.0 {
            let t = (a - b).abs() / se;
            sums.max_t = Some(sums.max_t.map_or(t, |most: f64| most.max(t)));
            sums.outside += usize::from(t > limit);
            let e_n = (a - b).abs() / self.expanded(entry).unwrap_or(limit * se);
            sums.max_e_n = Some(sums.max_e_n.map_or(e_n, |most: f64| most.max(e_n)));
            sums.beyond += usize::from(e_n > 1.0);
            sums.bins += 1;
        }
    }

    /// sqrt(U_A^2 + U_B^2), the half-widths of both 95 % intervals; `None` of paired tables, which have one together.
    fn expanded(&self, TableEntry { at, colour }: TableEntry) -> Option<f64> {
        if self.paired.is_some() {
            return None;
        }
        let half = |(side, count): (&ComparedTable, usize)| {
            self.limits[count.max(2) - 2].0 * f64::from(side.table.colours[colour].stderr[at])
        };
        Some([&self.a, &self.b].into_iter().zip(self.realisations).map(half).fold(0.0, f64::hypot))
    }

    /// Standard error of the difference and its degrees of freedom. An empty bin is off by no more than what the other
    /// table has there, whatever its 1.5 hits allow for.
    fn error(&self, TableEntry { at, colour }: TableEntry, hit: bool, larger: f64) -> Option<(f64, usize)> {
        if let Some((a, b)) = self.paired {
            let at = self.first_incidence * self.a.table.grid.bins() + at;
            let value = |parts: &Realisations, k: usize| f64::from(parts.parts[k].total[colour][at]);
            let (_, se) = stats::mean_and_se((0..a.parts.len()).map(|k| value(a, k) - value(b, k)));
            return se.map(|se| (se, a.parts.len() - 1));
        }
        let se = [&self.a, &self.b].map(|side| f64::from(side.table.colours[colour].stderr[at]));
        if self.limits.is_empty() || se[0] < 0.0 || se[1] < 0.0 || self.realisations.contains(&1) {
            return None;
        }
        let [va, vb] = se.map(|se| se * se);
        let both = (va + vb).sqrt();
        let part = |variance: f64, count: usize| variance * variance / (count - 1) as f64;
        let spread = part(va, self.realisations[0]) + part(vb, self.realisations[1]);
        let dof =
            if spread > 0.0 { ((va + vb) * (va + vb) / spread).floor() as usize } else { self.limits.len() };
        Some((if hit { both } else { both.min(larger) }, dof.clamp(1, self.limits.len())))
    }
}

/// The place of a value in the tables.
#[derive(Clone, Copy)]
struct TableEntry {
    at: usize,
    colour: usize,
}

/// Sums over bins and colours.
#[derive(Debug, Clone, Default)]
pub(super) struct DifferenceSums {
    distance: f64,
    /// What each realisation adds to the distance without noise.
    parts: Vec<f64>,
    noise: f64,
    flux: f64,
    without_error: bool,
    max_t: Option<f64>,
    max_e_n: Option<f64>,
    outside: usize,
    /// Bins with an E_n above 1.
    beyond: usize,
    pub bins: usize,
}

impl DifferenceSums {
    pub fn merged(mut self, other: &DifferenceSums) -> DifferenceSums {
        self.distance += other.distance;
        self.noise += other.noise;
        self.flux += other.flux;
        self.without_error |= other.without_error;
        self.max_t = [self.max_t, other.max_t].into_iter().flatten().reduce(f64::max);
        self.max_e_n = [self.max_e_n, other.max_e_n].into_iter().flatten().reduce(f64::max);
        self.outside += other.outside;
        self.beyond += other.beyond;
        self.bins += other.bins;
        self
    }

    /// What each realisation adds to the distance relative to B; nothing where it is not known.
    pub fn by_part(&self) -> Vec<f64> {
        let known = self.flux > 0.0 && !self.without_error;
        let parts = if known { &self.parts[..] } else { &[] };
        parts.iter().map(|sum| sum / self.flux).collect()
    }

    pub fn figures(&self) -> DifferenceFigures {
        let share = |count: usize| (self.bins > 0).then(|| count as f64 / self.bins as f64);
        let known = !self.without_error;
        let l1 = (self.flux > 0.0).then(|| self.distance / self.flux);
        let l1_noise =
            (known && self.flux > 0.0).then(|| (2.0 / std::f64::consts::PI).sqrt() * self.noise / self.flux);
        DifferenceFigures {
            l1,
            l1_noise,
            max_t: self.max_t,
            share_outside_95: share(self.outside),
            max_e_n: self.max_e_n,
            share_e_n_above_1: share(self.beyond),
            ..DifferenceFigures::default()
        }
        .with_difference(&self.by_part())
    }
}
