//! Promise: between the incidences of a table light that has gone through follows refraction: what is exported there is the
//! law that was tabulated, nearer than by the mirror's half vector.

use glam::DVec3;
use gonio::instrument::Grid;
use gonio::interchange::{Brdf, Colour, Lookup};
use gonio::sphere::direction_deg;
use gonio::table::BrdfTable;
use gonio::theory::{Masking, Microfacet, Ndf};

use crate::support::analytic::{hemisphere, steps, table};

/// What rough glass lets through.
struct Glass {
    model: Microfacet,
    eta: f64,
}

impl Brdf for Glass {
    fn colours(&self) -> usize {
        1
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let f = if wo.z < 0.0 { self.model.btdf(wi, wo, Masking::HeightCorrelated, self.eta) } else { 0.0 };
        [f, 0.0, 0.0]
    }

    fn sides(&self) -> [bool; 2] {
        [true, true]
    }
}

/// The half of what has gone through, rows of 2 degrees under light every 15 degrees.
fn tabulated(glass: &Glass, side: &str, eta: f64) -> BrdfTable {
    let above = hemisphere(steps(15.0, 6), None, 45, 90);
    let below = above.theta_r_edges_deg.iter().rev().skip(1).map(|edge| 180.0 - edge);
    let edges = above.theta_r_edges_deg.iter().copied().chain(below).collect();
    let mut table = table(glass, &Grid { theta_r_edges_deg: edges, ..above });
    table.campaign = format!(
        "name = \"glass\"\n[surface.smith]\nalpha = 0.3\n[optics]\nfacet = \"dielectric\"\neta = {eta}\n[light]\n\
         theta_i_deg = [0]\nside = \"{side}\"\n[sensor.hemisphere]\nside = \"both\"\n[stop]\nsamples = 1\n"
    );
    table.half(true).expect("what has gone through")
}

/// The integral of |f - law| cos over that of the law, by midpoints.
fn distance(lookup: &Lookup, glass: &Glass, theta_i: f64) -> f64 {
    let wi = direction_deg(theta_i, 0.0);
    let (mut off, mut whole) = (0.0, 0.0);
    for (row, column) in (0..90 * 60).map(|k| (k / 60, k % 60)) {
        let wo = direction_deg(f64::from(row) + 0.5, 6.0 * f64::from(column) + 3.0);
        let weight = wo.z * wo.truncate().length();
        let law = glass.brdf(wi, DVec3::new(wo.x, wo.y, -wo.z))[0];
        off += weight * (lookup.brdf(wi, wo)[0] - law).abs();
        whole += weight * law;
    }
    off / whole
}

#[test]
fn light_through_follows_refraction_between_incidences() {
    const ETA: f64 = 1.5;
    for (side, eta) in [("front", ETA), ("back", 1.0 / ETA)] {
        let glass = Glass { model: Microfacet::isotropic(Ndf::Ggx, 0.3), eta };
        let half = tabulated(&glass, side, ETA);
        let [refracted, mirrored] =
            [true, false].map(|through| Lookup::of_side(&half, through).expect("a product"));
        for theta_i in [7.5, 22.5, 37.5, 52.5, 67.5] {
            let [by_refraction, by_mirror] = [&refracted, &mirrored].map(|l| distance(l, &glass, theta_i));
            println!("{side} {theta_i}: {by_refraction:.4}, by the mirror's half vector {by_mirror:.4}");
            // What is left of f over the law is masking, smooth over 15 degrees, and what rows of 2 degrees smooth out: from
            // outside a hundredth. From inside total reflection begins within the lobe, towards grazing light in most of it.
            let most = if side == "front" { 0.01 } else { 0.03 };
            assert!(by_refraction < most, "{side} {theta_i}: {by_refraction} {by_mirror}");
            // Two lobes in the place of one: a tenth of the light and more.
            assert!(by_mirror > 0.09, "{side} {theta_i}: {by_mirror}");
        }
        // At an incidence both are the table; where half vectors send light is rounded.
        let (wi, wo) = (direction_deg(30.0, 0.0), direction_deg(20.0, 170.0));
        let [a, b] = [&refracted, &mirrored].map(|lookup| lookup.brdf(wi, wo)[0]);
        assert!((a / b - 1.0).abs() < 1e-9, "{side}: {a} {b}");
    }
}
