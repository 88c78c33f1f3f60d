//! A table as a function of any two directions.
//!
//! Along the sensor's angles: cubic between the middles of the bins, with node values such that the means of the
//! interpolant over the bins are the table's. Between the stops of the light: at equal half vector, where the
//! mirrored light is alike (f(wi, wo) = D(h) times what varies slowly), instead of at equal `wo`, where two lobes
//! would show. A cubic may swing below 0 beside a lobe; there the value is 0.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::axis::{Circle, Polar, Taps};
use super::{Brdf, Colour, Reason};
use crate::instrument::{Grid, GridKind};
use crate::sphere;
use crate::table::BrdfTable;

/// The widest gap between azimuths that is interpolated over.
const WIDEST_GAP_DEG: f64 = 46.0;
/// Rounds of the correction towards the table's bin means; each leaves at most a third of the finest detail's error.
const ROUNDS: usize = 4;
/// Gauss-Legendre nodes and weights on [-1, 1], three points.
const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.774_596_669_241_483_4, 5.0 / 18.0)];

/// Angles of one arm: values in increasing order, and where the table has each.
struct Ordered {
    angles: Vec<f64>,
    places: Vec<usize>,
}

/// The interpolant.
pub struct Lookup {
    theta_i: Vec<f64>,
    phi_i: Vec<f64>,
    stops_polar: Polar,
    stops_circle: Circle,
    /// The azimuth is relative and has one value: every azimuth of the light is alike.
    isotropic: bool,
    relative: bool,
    rows: Polar,
    columns: Circle,
    column_count: usize,
    row_count: usize,
    /// Per colour: [theta_i][phi_i][row][column] in increasing order of all angles.
    values: Vec<Vec<f32>>,
}

impl Lookup {
    /// The interpolant of the totals of a table whose stops and bins are products of polar angles and azimuths that
    /// go all the way round.
    pub fn new(table: &BrdfTable) -> Reason<Self> {
        let grid = &table.grid;
        let (theta_i_deg, phi_i_deg) = stop_axes(grid)?;
        let (theta_i, phi_i) = (increasing("theta_i", &theta_i_deg)?, around("phi_i", &phi_i_deg)?);
        let isotropic = grid.phi_r_relative && phi_i.angles.len() == 1;
        let (theta_r_deg, phi_r_deg) = bin_axes(grid)?;
        let (rows, columns) = (increasing("theta_r", &theta_r_deg)?, around("phi_r", &phi_r_deg)?);
        let gap = |circle: &Circle| circle.widest_gap().to_degrees();
        let (stops_circle, columns_circle) = (Circle::new(phi_i.angles.clone()), Circle::new(columns.angles));
        if !isotropic && gap(&stops_circle) > WIDEST_GAP_DEG {
            return Err(format!("azimuths of the light leave a gap of {:.0} degrees", gap(&stops_circle)));
        }
        if grid.kind != GridKind::Hemisphere && gap(&columns_circle) > WIDEST_GAP_DEG {
            return Err(format!("azimuths of the sensor leave a gap of {:.0} degrees", gap(&columns_circle)));
        }
        let (row_count, column_count) = (rows.places.len(), columns.places.len());
        let mut lookup = Lookup {
            stops_polar: Polar::new(&theta_i.angles, false),
            rows: Polar::new(&rows.angles, true),
            columns: columns_circle,
            stops_circle,
            isotropic,
            relative: grid.phi_r_relative,
            row_count,
            column_count,
            values: Vec::new(),
            theta_i: theta_i.angles,
            phi_i: phi_i.angles,
        };
        for colour in &table.colours {
            let mut values = Vec::with_capacity(colour.total.len());
            for ti in &theta_i.places {
                for pi in &phi_i.places {
                    let stop = &colour.total[(ti * phi_i_deg.len() + pi) * row_count * column_count..];
                    for row in &rows.places {
                        values.extend(columns.places.iter().map(|column| stop[row * column_count + column]));
                    }
                }
            }
            lookup.values.push(values);
        }
        if grid.kind == GridKind::Hemisphere {
            lookup.keep_means(grid, &columns.places);
        }
        Ok(lookup)
    }

    /// Polar angles of the light, increasing, rad.
    pub fn theta_i(&self) -> &[f64] {
        &self.theta_i
    }

    /// Azimuths of the light, increasing in [0, 2 pi), rad; a single 0 where every azimuth is alike.
    pub fn phi_i(&self) -> &[f64] {
        &self.phi_i
    }

    /// Whether every azimuth of the light is alike.
    pub fn is_isotropic(&self) -> bool {
        self.isotropic
    }

    /// The value at one of the table's own stops (indices into [`Self::theta_i`], [`Self::phi_i`]) with the light at
    /// azimuth `phi_i`, which matters where every azimuth is alike.
    pub fn at_stop(&self, (ti, pi): (usize, usize), phi_i: f64, wo: DVec3) -> Colour {
        let phi_r = sphere::phi(wo) - if self.relative { phi_i } else { 0.0 };
        let near = self.columns.cubic(phi_r);
        let far = self.columns.cubic(phi_r + PI);
        let size = self.row_count * self.column_count;
        let first = (ti * self.phi_i.len() + pi) * size;
        let mut found = [0.0; 3];
        for row in self.rows.cubic(sphere::theta(wo)).iter() {
            for column in if row.reflected { &far } else { &near }.iter() {
                let at = first + row.node * self.column_count + column.node;
                for (value, values) in found.iter_mut().zip(&self.values) {
                    *value += row.weight * column.weight * f64::from(values[at]);
                }
            }
        }
        found.map(|value| value.max(0.0))
    }

    /// The sum over stops of the taps, at equal half vector; `None` where a stop's mirrored arm is below the horizon
    /// and `all` are wanted.
    fn over_stops(&self, wi: DVec3, wo: DVec3, polar: &Taps, circle: &Taps, all: bool) -> Option<Colour> {
        let h = (wi + wo).normalize();
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for t in polar.iter() {
            for p in circle.iter() {
                let weight = t.weight * p.weight;
                if weight == 0.0 {
                    continue;
                }
                let phi_i = if self.isotropic { sphere::phi(wi) } else { self.phi_i[p.node] };
                let from = sphere::direction(self.theta_i[t.node], phi_i);
                let to = 2.0 * from.dot(h) * h - from;
                if to.z <= 0.0 {
                    if all {
                        return None;
                    }
                    continue;
                }
                let value = self.at_stop((t.node, p.node), phi_i, to);
                sum.iter_mut().zip(value).for_each(|(s, v)| *s += weight * v);
                weights += weight;
            }
        }
        (weights > 0.0).then(|| sum.map(|s| s / weights))
    }

    /// Moves the node values until the interpolant's bin means are the table's.
    fn keep_means(&mut self, grid: &Grid, places: &[usize]) {
        let theta: Vec<[f64; 2]> = pairs(&grid.theta_r_edges_deg);
        let edges: Vec<[f64; 2]> = pairs(&grid.phi_r_edges_deg);
        let phi: Vec<[f64; 2]> = places.iter().map(|&place| edges[place]).collect();
        let rows = theta.iter().map(|&range| self.row_mean(range)).collect();
        let across = |shift: f64| {
            let mean = |&[p1, p2]: &[f64; 2]| {
                GAUSS
                    .iter()
                    .flat_map(|&(x, w)| weighted(&self.columns.cubic(middle(p1, p2, x) + shift), w))
                    .collect()
            };
            phi.iter().map(mean).collect()
        };
        let means = Means { rows, near: across(0.0), far: across(PI), columns: self.column_count };
        let size = self.row_count * self.column_count;
        use rayon::prelude::*;
        for values in &mut self.values {
            values.par_chunks_mut(size).for_each(|stop| means.correct(stop));
        }
    }

    /// Taps of the mean over [t1, t2], weighted with sin cos: nodes spaced in sin^2.
    fn row_mean(&self, [t1, t2]: [f64; 2]) -> Vec<(usize, bool, f64)> {
        let (s1, s2) = (t1.sin().powi(2), t2.sin().powi(2));
        let taps = |&(x, w): &(f64, f64)| {
            let taps = self.rows.cubic(middle(s1, s2, x).sqrt().asin());
            taps.iter().map(|tap| (tap.node, tap.reflected, w * tap.weight)).collect::<Vec<_>>()
        };
        GAUSS.iter().flat_map(taps).collect()
    }
}

impl Brdf for Lookup {
    fn colours(&self) -> usize {
        self.values.len()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let (theta, phi) = (sphere::theta(wi), sphere::phi(wi));
        let (polar, circle) = (self.stops_polar.cubic(theta), self.stops_circle.cubic(phi));
        let cubic = self.over_stops(wi, wo, &polar, &circle, true);
        let found = cubic.or_else(|| {
            let (polar, circle) = (self.stops_polar.linear(theta), self.stops_circle.linear(phi));
            self.over_stops(wi, wo, &polar, &circle, false)
        });
        // Every mirrored arm below the horizon: light and sensor both graze; the nearest stop as it is.
        found.map_or_else(|| self.nearest(theta, phi, wo), |value| value.map(|v| v.max(0.0)))
    }
}

impl Lookup {
    fn nearest(&self, theta: f64, phi: f64, wo: DVec3) -> Colour {
        let best =
            |taps: Taps| taps.iter().max_by(|a, b| a.weight.total_cmp(&b.weight)).map_or(0, |tap| tap.node);
        let (ti, pi) = (best(self.stops_polar.linear(theta)), best(self.stops_circle.linear(phi)));
        self.at_stop((ti, pi), if self.isotropic { phi } else { self.phi_i[pi] }, wo)
    }
}

/// The bin means of an interpolant as sums over its nodes.
struct Means {
    rows: Vec<Vec<(usize, bool, f64)>>,
    near: Vec<Vec<(usize, f64)>>,
    far: Vec<Vec<(usize, f64)>>,
    columns: usize,
}

impl Means {
    fn correct(&self, values: &mut [f32]) {
        let wanted: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
        let mut nodes = wanted.clone();
        for _ in 0..ROUNDS {
            let means = self.of(&nodes);
            nodes
                .iter_mut()
                .zip(&wanted)
                .zip(&means)
                .for_each(|((node, wanted), mean)| *node += wanted - mean);
        }
        values.iter_mut().zip(&nodes).for_each(|(value, node)| *value = *node as f32);
    }

    fn of(&self, nodes: &[f64]) -> Vec<f64> {
        let along = |taps: &[Vec<(usize, f64)>], row: usize| -> Vec<f64> {
            let row = &nodes[row * self.columns..][..self.columns];
            taps.iter().map(|taps| taps.iter().map(|&(k, w)| w * row[k]).sum()).collect()
        };
        let near: Vec<Vec<f64>> = (0..self.rows.len()).map(|row| along(&self.near, row)).collect();
        // Only the first rows are seen through the pole.
        let far: Vec<Vec<f64>> = (0..self.rows.len().min(3)).map(|row| along(&self.far, row)).collect();
        let mut means = Vec::with_capacity(nodes.len());
        for taps in &self.rows {
            let value = |column: usize| {
                let seen = |row: usize, reflected: bool| {
                    if reflected { far[row][column] } else { near[row][column] }
                };
                taps.iter().map(|&(row, reflected, w)| w * seen(row, reflected)).sum::<f64>()
            };
            means.extend((0..self.columns).map(value));
        }
        means
    }
}

fn middle(low: f64, high: f64, x: f64) -> f64 {
    0.5 * (low + high) + 0.5 * x * (high - low)
}

fn weighted(taps: &Taps, weight: f64) -> Vec<(usize, f64)> {
    taps.iter().map(|tap| (tap.node, weight * tap.weight)).collect()
}

fn pairs(edges_deg: &[f64]) -> Vec<[f64; 2]> {
    edges_deg.windows(2).map(|pair| [pair[0].to_radians(), pair[1].to_radians()]).collect()
}

/// Polar angles and azimuths whose product the stops are, degrees.
pub(super) fn stop_axes(grid: &Grid) -> Reason<(Vec<f64>, Vec<f64>)> {
    if grid.kind == GridKind::HalfDifference {
        return Err("half/difference angles are no stops and bins".into());
    }
    if grid.stops_deg.is_empty() {
        return Ok((grid.theta_i_deg.clone(), grid.phi_i_deg.clone()));
    }
    product(&grid.stops_deg).ok_or_else(|| "the stops are no product of polar angles and azimuths".into())
}

/// Polar angles and azimuths whose product the middles of the bins are, degrees.
pub(super) fn bin_axes(grid: &Grid) -> Reason<(Vec<f64>, Vec<f64>)> {
    let middles = |edges: &[f64]| edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let points = match grid.kind {
        GridKind::Hemisphere => {
            return Ok((middles(&grid.theta_r_edges_deg), middles(&grid.phi_r_edges_deg)));
        }
        GridKind::Arm => return Ok((grid.theta_r_deg.clone(), grid.phi_r_deg.clone())),
        GridKind::Points => grid.points_deg.clone(),
        GridKind::Patches => {
            grid.patches_deg.iter().map(|p| [0.5 * (p[0] + p[1]), 0.5 * (p[2] + p[3])]).collect()
        }
        GridKind::HalfDifference => return Err("half/difference angles are no stops and bins".into()),
    };
    product(&points)
        .ok_or_else(|| "the sensor's directions are no product of polar angles and azimuths".into())
}

/// The axes of a list in which the azimuth runs fastest.
fn product(list: &[[f64; 2]]) -> Option<(Vec<f64>, Vec<f64>)> {
    let columns = list.iter().take_while(|pair| pair[0] == list[0][0]).count();
    let theta: Vec<f64> = list.chunks(columns).map(|row| row[0][0]).collect();
    let phi: Vec<f64> = list[..columns].iter().map(|pair| pair[1]).collect();
    let fits = list.len() == theta.len() * columns
        && list.iter().enumerate().all(|(k, pair)| *pair == [theta[k / columns], phi[k % columns]]);
    fits.then_some((theta, phi))
}

fn increasing(name: &str, deg: &[f64]) -> Reason<Ordered> {
    if let Some(negative) = deg.iter().find(|&&angle| angle < 0.0) {
        return Err(format!("{name} = {negative}: an arm in one plane does not see the hemisphere"));
    }
    ordered(name, deg.iter().map(|angle| angle.to_radians()).collect())
}

fn around(name: &str, deg: &[f64]) -> Reason<Ordered> {
    ordered(name, deg.iter().map(|&angle| sphere::reduced_deg(angle).to_radians() % TAU).collect())
}

fn ordered(name: &str, angles: Vec<f64>) -> Reason<Ordered> {
    let mut places: Vec<usize> = (0..angles.len()).collect();
    places.sort_by(|&a, &b| angles[a].total_cmp(&angles[b]));
    let sorted: Vec<f64> = places.iter().map(|&place| angles[place]).collect();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!("{name} = {} is there twice", pair[0].to_degrees())),
        None => Ok(Ordered { angles: sorted, places }),
    }
}
