//! Promise: rough glass at all orders is that of an independent random walk (tests/data/smith_dielectric.py).

use std::collections::BTreeMap;

use gonio::instrument::Region;
use gonio::measure::Measured;

use crate::support::long::or_long;
use crate::support::measuring::measured_one;

/// A class of exits: whether through the surface, the order up to 3, whether farther than 30 degrees from the pole.
type Exit = (bool, usize, bool);

struct Row {
    exit: Exit,
    share: f64,
    se: f64,
}

/// (eta, alpha_x, alpha_y, theta_i) and what the walk found.
fn cases() -> Vec<([String; 4], Vec<Row>)> {
    let mut cases: Vec<([String; 4], Vec<Row>)> = Vec::new();
    for line in include_str!("../../data/smith_dielectric.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let key: [String; 4] = std::array::from_fn(|k| fields[k].to_string());
        let number = |k: usize| fields[k].parse::<f64>().expect("a number");
        let exit = (fields[4] == "t", number(5) as usize, fields[6] == "1");
        let row = Row { exit, share: number(7), se: number(8) };
        match cases.last_mut().filter(|(last, _)| *last == key) {
            Some((_, rows)) => rows.push(row),
            None => cases.push((key, vec![row])),
        }
    }
    cases
}

/// Flux by class, with its standard error over the realisations.
fn classes(measured: &Measured) -> BTreeMap<Exit, (f64, f64)> {
    let (table, grid) = (&measured.table, &measured.table.grid);
    let sizes = grid.sizes(0);
    let mut classes: BTreeMap<Exit, (f64, f64)> = BTreeMap::new();
    let colour = &table.colours[0];
    for (bin, region) in grid.regions(0).iter().enumerate() {
        let Region::Rectangle { theta, .. } = *region else { panic!("a hemisphere") };
        let from_pole = if region.is_below() { std::f64::consts::PI - theta[1] } else { theta[0] };
        let far = from_pole > 0.5; // 30 degrees is an edge of the bins.
        let orders = std::iter::once(&colour.single).chain(&colour.orders);
        for (order, values) in orders.enumerate() {
            let entry = classes.entry((region.is_below(), (order + 1).min(3), far)).or_default();
            entry.0 += f64::from(values[bin]) * sizes[bin];
        }
    }
    classes
}

#[test]
fn rough_glass_at_all_orders_is_that_of_an_independent_walk() {
    let samples = or_long(32_768u32, 4_194_304);
    let mut worst = 0.0f64;
    let cases = cases();
    assert_eq!(cases.len(), 24);
    for ([eta, alpha_x, alpha_y, theta_i], rows) in &cases {
        let measured = measured_one(&format!(
            "name = \"walk\"\n[surface]\nrealisations = 4\n[surface.smith]\nalpha_x = {alpha_x}\nalpha_y = {alpha_y}\n\
             [optics]\nfacet = \"dielectric\"\neta = {eta}\n[light]\ntheta_i_deg = [{theta_i}]\n\
             azimuth = \"absolute\"\nphi_i_deg = [25]\n[sensor.hemisphere]\nside = \"both\"\nbins = \"aligned\"\n\
             [trace]\nbounces = 16\nby_order = true\n[stop]\nsamples = {samples}\n"
        ));
        let paths = 4.0 * f64::from(samples);
        let classes = classes(&measured);
        for &Row { exit, share, se } in rows {
            let found = classes[&exit].0;
            // Counts on both sides; a folded arrival is half a path on either side of the plane, so that counts hold.
            let own = (share.max(1.0 / paths) / paths).sqrt();
            let z = (found - share).abs() / se.hypot(own);
            worst = worst.max(z);
            // 288 classes at most: Sidak's limit at 1 % is 4.1; 3 standard errors are kept by each case's totals, below.
            assert!(
                z < 4.1,
                "eta {eta}, alpha {alpha_x} {alpha_y}, theta {theta_i}, {exit:?}: {found} {share}, z {z}"
            );
        }
        for through in [false, true] {
            let of = |row: &&Row| row.exit.0 == through;
            let share: f64 = rows.iter().filter(of).map(|row| row.share).sum();
            let found: f64 =
                classes.iter().filter(|(exit, _)| exit.0 == through).map(|(_, flux)| flux.0).sum();
            let one = |n: f64| share * (1.0 - share) / n;
            let sigma = (one(paths) + one(f64::from(1 << 22))).sqrt();
            assert!(
                (found - share).abs() < 3.0 * sigma,
                "eta {eta}, alpha {alpha_x}, {theta_i}: {found} {share} {sigma}"
            );
        }
    }
    println!("largest z {worst:.2}");
}
