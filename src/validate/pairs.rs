//! Pairs of directions with the arms exchanged, and what a table says of them, gathered incidence by incidence.
//!
//! A pair lies in two incidences, far apart in a large table: its values are kept as the incidences come by. A table with more
//! pairs than `MOST` is judged by as many at most, evenly spread.
//!
//! Bins that are not the same thing both ways are judged where a test can tell: see [`PairValues::is_judged`].

use super::parts::Parts;
use super::prediction::model::IncidenceMeans;
use crate::instrument::{Grid, GridKind, Region, Sensor};
use crate::sphere;
use crate::stats;
use crate::table::BrdfTable;

/// Pairs at most: a megabyte for each value of both ways.
const MOST: usize = 1 << 20;

/// Independent facets that a bin needs in each realisation: with fewer its values are far from normal, and Student's
/// limit says nothing of them. A square of the correlation length holds several slopes: they are more than that.
const FEWEST_FACETS: f64 = 4.0;
/// Arrivals that it needs in each realisation: counts of a few are equal by chance, and their spread 0.
const FEWEST_ARRIVALS: f64 = 64.0;
/// The largest correction by the model, as a ratio above 1.
const LARGEST_RATIO: f64 = 1.25;

/// (incidence, bin) with the arms one way and the other way round.
struct ReciprocalPair {
    there: (usize, usize),
    back: (usize, usize),
}

/// Order 1 of the first colour in the bins of all pairs: entry 2k is one way of pair k, 2k + 1 the other.
pub struct PairValues {
    /// Whether both ways are the same thing: equal apertures, or single directions.
    pub exact: bool,
    /// Independent facets of a realisation: squares of the correlation length. `None` where every start meets its own.
    facets: Option<f64>,
    /// (incidence, bin, entry) in the order of the incidences.
    places: Vec<(usize, usize, usize)>,
    value: Vec<f32>,
    arrivals: Vec<u32>,
    /// Share of the incidence's arrivals.
    share: Vec<f32>,
    /// A model's bin means, a list for each of its maskings; empty where there is none.
    mean: Vec<Vec<f64>>,
    /// The value in each realisation; none where they are not known.
    parts: Vec<Vec<f32>>,
}

impl PairValues {
    /// The pairs of a table of all incidences of `grid`, whose realisations have so many independent `facets`.
    pub fn new(grid: &Grid, exact: bool, facets: Option<f64>) -> Self {
        let pairs = pairs(grid);
        let both = |(k, pair): (usize, &ReciprocalPair)| {
            [(pair.there.0, pair.there.1, 2 * k), (pair.back.0, pair.back.1, 2 * k + 1)]
        };
        let mut places: Vec<_> = pairs.iter().enumerate().flat_map(both).collect();
        places.sort_unstable();
        let entries = places.len();
        let (value, arrivals, share) = (vec![0.0; entries], vec![0; entries], vec![0.0; entries]);
        PairValues { exact, facets, places, value, arrivals, share, mean: Vec::new(), parts: Vec::new() }
    }

    /// Takes the values of some incidences; `means` are a model's bin means at them.
    pub fn add(
        &mut self,
        band: &BrdfTable,
        first_incidence: usize,
        realisations: Option<Parts>,
        means: Option<&[IncidenceMeans]>,
    ) {
        let (bins, incidences) = (band.grid.bins(), band.grid.incidences());
        let entries = self.places.len();
        if let (Some(means), true) = (means.and_then(|means| means.first()), self.mean.is_empty()) {
            self.mean = vec![vec![f64::NAN; entries]; means.values.len()];
        }
        let known = realisations.filter(|parts| parts.all.parts.len() > 1);
        if let (Some(parts), true) = (known, self.parts.is_empty()) {
            self.parts = vec![vec![0.0; entries]; parts.all.parts.len()];
        }
        let from = self.places.partition_point(|place| place.0 < first_incidence);
        let colour = &band.colours[0];
        let of_incidence = |incidence: usize| {
            band.hits[incidence * bins..][..bins].iter().map(|&hits| f64::from(hits)).sum()
        };
        let all: Vec<f64> = (0..incidences).map(of_incidence).collect();
        for &(incidence, bin, entry) in
            self.places[from..].iter().take_while(|place| place.0 < first_incidence + incidences)
        {
            let here = incidence - first_incidence;
            let at = here * bins + bin;
            self.value[entry] = colour.single[at];
            self.arrivals[entry] = band.hits[at];
            self.share[entry] = (f64::from(band.hits[at]) / all[here]) as f32;
            for (masking, mean) in self.mean.iter_mut().enumerate() {
                mean[entry] = means.map_or(f64::NAN, |means| means[here].values[masking][0][bin]);
            }
            if let Some(Parts { all, first_incidence }) = known {
                let at = (first_incidence + here) * bins + bin;
                for (mine, part) in self.parts.iter_mut().zip(&all.parts) {
                    mine[entry] = part.single[0][at];
                }
            }
        }
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.value.len() / 2
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.value.is_empty()
    }

    /// Realisations whose values are known.
    pub fn realisations(&self) -> usize {
        self.parts.len()
    }

    /// Whether light arrived both ways, and the two can be compared.
    pub fn is_usable(&self, pair: usize) -> bool {
        let comparable = self.exact || !self.mean.is_empty();
        let seen = self.arrivals[2 * pair] > 0 && self.arrivals[2 * pair + 1] > 0;
        comparable && seen && self.ratio(pair).is_finite()
    }

    /// Whether a usable pair is judged: with the realisations at hand, and, where the two bins differ in shape,
    ///
    /// - both hold 4 independent facets in each realisation (share of the incidence's arrivals times the squares of the
    ///   correlation length in a patch) and 64 arrivals, or values are far from normal;
    /// - every masking of the model corrects by less than 25 %, or the table's own discrepancy would be tested.
    // Tested by `binned_reciprocity_raises_no_false_alarm`,
    // `an_incidence_that_is_scaled_or_exchanged_is_seen_in_binned_reciprocity`.
    pub fn is_judged(&self, pair: usize) -> bool {
        let realisations = self.parts.len() as f64;
        let ways = [2 * pair, 2 * pair + 1];
        let facets =
            |way: usize| self.facets.is_none_or(|all| all * f64::from(self.share[way]) >= FEWEST_FACETS);
        let arrivals = |way: usize| f64::from(self.arrivals[way]) >= FEWEST_ARRIVALS * realisations;
        let small = |ratio: f64| (1.0 / LARGEST_RATIO..=LARGEST_RATIO).contains(&ratio);
        let enough = ways.into_iter().all(|way| facets(way) && arrivals(way));
        self.parts.len() > 1 && (self.exact || (enough && self.ratios(pair).all(small)))
    }

    /// What the model says of one way over the other; 1 where both are the same thing.
    fn ratio(&self, pair: usize) -> f64 {
        self.ratios(pair).next().unwrap_or(1.0)
    }

    /// The same by each of its maskings.
    fn ratios(&self, pair: usize) -> impl Iterator<Item = f64> {
        let means = if self.exact { &[][..] } else { &self.mean[..] };
        means.iter().map(move |mean| mean[2 * pair] / mean[2 * pair + 1])
    }

    /// How far the correction may be off: by as much as the maskings differ in it, and, for random heights, which are not
    /// the model, by half of what the nearest masking is off in the bins. That half is an assumption: what a surface is off
    /// has one sign in both bins of a pair, which differ in shape alone. An incidence that is scaled is off by all of it.
    pub fn allowance(&self, pair: usize) -> f64 {
        let back = f64::from(self.value[2 * pair + 1]);
        let off = self.ratios(pair).map(|ratio| (ratio - self.ratio(pair)).abs()).fold(0.0, f64::max);
        let own = if self.facets.is_some() && !self.exact {
            self.misfit(2 * pair).max(self.ratio(pair) * self.misfit(2 * pair + 1))
        } else {
            0.0
        };
        off * back + 0.5 * own
    }

    /// How far the nearest masking is from the value of one way.
    fn misfit(&self, way: usize) -> f64 {
        let value = f64::from(self.value[way]);
        self.mean.iter().map(|mean| (value - mean[way]).abs()).reduce(f64::min).unwrap_or(0.0)
    }

    /// The value one way.
    pub fn there(&self, pair: usize) -> f64 {
        f64::from(self.value[2 * pair])
    }

    /// One way minus the other.
    pub fn difference(&self, pair: usize) -> f64 {
        self.difference_in(&self.value, pair)
    }

    fn difference_in(&self, values: &[f32], pair: usize) -> f64 {
        f64::from(values[2 * pair]) - self.ratio(pair) * f64::from(values[2 * pair + 1])
    }

    /// The difference over the realisations, and its standard error where they are known: the two ways vary together, and
    /// their own errors do not give it.
    pub fn mean_difference(&self, pair: usize) -> (f64, Option<f64>) {
        if self.parts.is_empty() {
            return (self.difference(pair), None);
        }
        stats::mean_and_se(self.parts.iter().map(|part| self.difference_in(part, pair)))
    }
}

/// Pairs of incidences whose directions the sensor sees from each other. In a 3-D table every column is such a pair.
fn pairs(grid: &Grid) -> Vec<ReciprocalPair> {
    let incidences = grid.incidences();
    let relative_3d = grid.phi_r_relative && grid.phi_i_deg.len() == 1 && grid.kind == GridKind::Hemisphere;
    // Columns beyond half a turn repeat the others mirrored.
    let each = if relative_3d { (grid.phi_r_edges_deg.len() - 1) / 2 + 1 } else { 1 };
    let all = (incidences as u64).saturating_mul((incidences as u64).saturating_sub(1)) / 2 * each as u64;
    let step = all.div_ceil(MOST as u64).max(1);
    let sensor = Sensor::new(grid);
    let (mut pairs, mut number) = (Vec::new(), 0);
    for a in 0..incidences {
        for b in a + 1..incidences {
            for column in 0..each {
                number += 1;
                if (number - 1) % step != 0 {
                    continue;
                }
                if relative_3d {
                    let columns = grid.phi_r_edges_deg.len() - 1;
                    let (row_a, row_b) = (row_of(grid, a), row_of(grid, b));
                    let (there, back) = ((a, row_b * columns + column), (b, row_a * columns + column));
                    pairs.push(ReciprocalPair { there, back });
                } else if let (Some(there), Some(back)) =
                    (bin_of(grid, &sensor, a, b), bin_of(grid, &sensor, b, a))
                {
                    pairs.push(ReciprocalPair { there: (a, there), back: (b, back) });
                }
            }
        }
    }
    pairs
}

/// The row of bins that holds the polar angle of an incidence.
fn row_of(grid: &Grid, incidence: usize) -> usize {
    let theta = grid.incidence_deg(incidence).0;
    grid.theta_r_edges_deg.partition_point(|&edge| edge <= theta) - 1
}

/// The bin at incidence `from` that looks along the direction of incidence `to`; of an arm, only a position that is there.
fn bin_of(grid: &Grid, sensor: &Sensor, from: usize, to: usize) -> Option<usize> {
    let back = if grid.phi_r_relative { -grid.incidence_deg(from).1 } else { 0.0 };
    let wo = sphere::turned(grid.wi(to), sphere::sin_cos_deg(back));
    // Bins between edges hold what falls into them: their regions need not be made.
    let apertures = matches!(grid.kind, GridKind::Arm | GridKind::Points);
    let regions = if apertures { grid.regions(from) } else { vec![] };
    let mut found = None;
    sensor.each_bin(wo, |bin| {
        let same = match regions.get(bin) {
            Some(Region::Cap { axis, .. }) => axis.distance(grid.wi(to)) < 1e-9,
            _ => true,
        };
        if same {
            found = Some(bin);
        }
    });
    found
}
