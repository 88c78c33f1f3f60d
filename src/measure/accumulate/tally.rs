//! Integer sums: the same bytes in whatever order paths are added.
//!
//! Flux is counted in units of 2^-90 of the flux that falls on the patch in one block. A surface sample's share is rounded to a
//! unit once, so that sums of any length, in any order, are exact: blocks may be measured on several machines, or on
//! several days, and be added up.

use serde::{Deserialize, Serialize};

use super::fresnel_sums::FresnelSums;
use super::slopes::SeenBySlope;

/// One unit of flux is 2^-90: a fraction of 1e-15 still has 40 bits, and 2^38 blocks still fit.
const UNITS: f64 = (1u128 << 90) as f64;

/// Flux in units.
pub fn to_units(flux: f64) -> u128 {
    (flux * UNITS).round() as u128
}

/// Units as flux.
pub fn from_units(units: u128) -> f64 {
    units as f64 / UNITS
}

/// Flux with a sign in units.
pub fn to_signed_units(flux: f64) -> i128 {
    (flux * UNITS).round() as i128
}

/// Units with a sign as flux.
pub fn from_signed_units(units: i128) -> f64 {
    units as f64 / UNITS
}

/// The sums of one incidence and realisation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Order 1 with F = 1, by bin.
    pub single: Vec<u128>,
    /// Order 1 weighted by (1-c)^5, then in each traced colour, by bin; empty where F = 1.
    pub first: Vec<Vec<u128>>,
    /// Orders above 1, group by group as `FresnelSums` has them, by bin; empty for one bounce.
    pub multiple: Vec<Vec<u128>>,
    /// Arrivals by bin; of each colour by itself where it has paths of its own, one after the other.
    pub hits: Vec<u64>,
    /// Paths that leave on the light's side, by order - 1.
    pub orders: Vec<Order>,
    /// Those that leave on the other side; empty where no light goes through.
    pub through: Vec<Order>,
    /// Paths beyond the last order.
    pub cut: FluxCount,
    /// Samples that the light does not see.
    pub hidden: FluxCount,
    /// Paths over the edge of an open map.
    pub left_map: FluxCount,
    /// Where those would arrive if nothing lay beyond the edge; in its `cut`, those that may go on from something
    /// there and arrive anywhere. `None` before the first.
    pub left: Option<Box<Tally>>,
    /// Samples whose facets send light into no aperture.
    pub outside: FluxCount,
    /// Paths that end on a plane between grains which reflects nothing.
    pub absorbed: FluxCount,
    /// What the light sees of the samples, by the slope of their facets.
    pub seen: SeenBySlope,
    /// Elements of Mueller matrices, each for each bin, as `FresnelSums` has them; units with a sign.
    pub mueller: Vec<Vec<i128>>,
    /// Faults of the program.
    pub lost: u64,
}

/// Paths that end in one way.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct FluxCount {
    /// Their number.
    pub count: u64,
    /// Their flux with F = 1, units.
    pub flux: u128,
}

/// Paths that leave after one number of bounces.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Order {
    /// Their number.
    pub count: u64,
    /// Their flux with F = 1, units.
    pub flux: u128,
    /// Their flux by weight, as `FresnelSums` has them, units.
    pub weighted: Vec<u128>,
}

impl Tally {
    /// An empty tally for so many bins.
    pub fn new(bins: usize, sums: &FresnelSums) -> Self {
        let of_bins = |sums: usize| vec![vec![0u128; bins]; sums];
        let order = |order: usize| Order { weighted: vec![0; sums.order_sums(order)], ..Order::default() };
        let through = if sums.goes_through() { sums.bounces() } else { 0 };
        Tally {
            single: vec![0; bins],
            first: of_bins(sums.first_sums()),
            multiple: of_bins(sums.multiple_sums()),
            hits: vec![0; bins * sums.hit_sets()],
            orders: (1..=sums.bounces()).map(order).collect(),
            through: (1..=through).map(order).collect(),
            cut: FluxCount::default(),
            hidden: FluxCount::default(),
            left_map: FluxCount::default(),
            left: None,
            outside: FluxCount::default(),
            absorbed: FluxCount::default(),
            seen: SeenBySlope::default(),
            mueller: vec![vec![0; bins]; sums.mueller_sums()],
            lost: 0,
        }
    }

    /// Adds another tally of the same shape.
    pub fn merge(&mut self, other: &Self) {
        add(&mut self.single, &other.single);
        let planes = self.first.iter_mut().zip(&other.first);
        for (mine, theirs) in planes.chain(self.multiple.iter_mut().zip(&other.multiple)) {
            add(mine, theirs);
        }
        for (mine, theirs) in self.mueller.iter_mut().zip(&other.mueller) {
            add(mine, theirs);
        }
        for (mine, theirs) in self.hits.iter_mut().zip(&other.hits) {
            *mine += theirs;
        }
        let through = self.through.iter_mut().zip(&other.through);
        for (mine, theirs) in self.orders.iter_mut().zip(&other.orders).chain(through) {
            mine.count += theirs.count;
            mine.flux += theirs.flux;
            add(&mut mine.weighted, &theirs.weighted);
        }
        self.cut.merge(other.cut);
        self.hidden.merge(other.hidden);
        self.left_map.merge(other.left_map);
        if let Some(theirs) = &other.left {
            match &mut self.left {
                Some(mine) => mine.merge(theirs),
                mine => *mine = Some(theirs.clone()),
            }
        }
        self.outside.merge(other.outside);
        self.absorbed.merge(other.absorbed);
        self.seen.merge(&other.seen);
        self.lost += other.lost;
    }

    /// Whether another tally has sums for the same things.
    pub fn has_shape_of(&self, other: &Self) -> bool {
        fn planes<T>(sums: &[Vec<T>]) -> Vec<usize> {
            sums.iter().map(Vec::len).collect()
        }
        let orders = |orders: &[Order]| orders.iter().map(|order| order.weighted.len()).collect::<Vec<_>>();
        self.single.len() == other.single.len()
            && self.hits.len() == other.hits.len()
            && planes(&self.first) == planes(&other.first)
            && planes(&self.multiple) == planes(&other.multiple)
            && planes(&self.mueller) == planes(&other.mueller)
            && orders(&self.orders) == orders(&other.orders)
            && orders(&self.through) == orders(&other.through)
            && self.left.iter().all(|left| left.left.is_none() && left.has_shape_of(other))
    }

    /// Whether these may be the sums of so many samples, of `paths` each: every path has one fate, and no sum can overflow
    /// by what is added.
    pub fn is_sound(&self, starts: u64, paths: u64) -> bool {
        let all = u128::from(starts) * u128::from(paths);
        let counts = self.fates().into_iter().map(|fate| fate.count).chain(self.leaving().map(|o| o.count));
        counts.map(u128::from).sum::<u128>() == all
            && self.sums_are_sound(u64::try_from(all).unwrap_or(u64::MAX))
            && self.left.iter().all(|left| left.sums_are_sound(self.left_map.count))
    }

    fn fates(&self) -> [FluxCount; 5] {
        [self.cut, self.hidden, self.left_map, self.outside, self.absorbed]
    }

    /// Paths that leave on either side, by order.
    pub fn leaving(&self) -> impl Iterator<Item = &Order> {
        self.orders.iter().chain(&self.through)
    }

    /// Whether no sum by bin or by fate is larger than so many paths make it.
    fn sums_are_sound(&self, paths: u64) -> bool {
        let planes = self.first.iter().chain(&self.multiple).chain([&self.single]);
        let fates = self.fates();
        let fluxes = fates.iter().map(|fate| &fate.flux).chain(self.leaving().map(|order| &order.flux));
        let weighted = self.leaving().flat_map(|order| &order.weighted);
        // A path arrives in a bin once, its mirror image once more.
        self.hits.iter().all(|&hits| hits / 2 <= paths)
            && self.seen.is_sound(paths)
            && self.lost == 0
            && planes.flatten().chain(fluxes).chain(weighted).all(|&units| units <= u128::MAX / 4)
            && self.mueller.iter().flatten().all(|units| units.unsigned_abs() <= u128::MAX / 8)
    }

    /// The sums of the paths over the edge of an open map.
    pub fn left(&mut self, sums: &FresnelSums) -> &mut Tally {
        let bins = self.single.len();
        self.left.get_or_insert_with(|| Box::new(Tally::new(bins, sums)))
    }

    /// How many sums by bin there are, hits not among them.
    pub fn sums(&self) -> usize {
        let left = self.left.as_ref().map_or(0, |left| left.sums());
        self.single.len() * (1 + self.first.len() + self.multiple.len() + self.mueller.len()) + left
    }

    /// All paths that were counted.
    pub fn paths(&self) -> u64 {
        let out: u64 = self.leaving().map(|order| order.count).sum();
        out + self.fates().iter().map(|fate| fate.count).sum::<u64>() + self.lost
    }
}

impl FluxCount {
    /// Adds one path.
    pub fn add(&mut self, flux: u128) {
        self.count += 1;
        self.flux += flux;
    }

    /// Adds `count` paths of `flux` each.
    pub fn add_many(&mut self, count: u64, flux: u128) {
        self.count += count;
        self.flux += u128::from(count) * flux;
    }

    fn merge(&mut self, other: FluxCount) {
        self.count += other.count;
        self.flux += other.flux;
    }
}

fn add<T: Copy + std::ops::AddAssign>(mine: &mut [T], theirs: &[T]) {
    for (mine, &theirs) in mine.iter_mut().zip(theirs) {
        *mine += theirs;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flux_survives_the_units() {
        for flux in [1.0, 0.3, 1e-6, 1e-12, 4000.0 / 65_536.0] {
            // Half a unit of 2^-90, relative to the flux; then one rounding to f64.
            let bound = f64::EPSILON + 2f64.powi(-91) / flux;
            assert!((from_units(to_units(flux)) / flux - 1.0).abs() <= bound, "{flux}");
        }
    }
}
