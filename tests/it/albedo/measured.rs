//! Promise: measured albedos account for all light, and their order 1 is the formula's where that is exact.

use std::path::Path;

use gonio::albedo::Chosen;
use gonio::albedo::{self, AlbedoTable, Certificate, FormulaSurface};
use gonio::campaign;
use gonio::measure::{self, Patches};
use gonio::stats::{sidak, student_limit};
use gonio::theory::{Masking, Ndf};

use crate::support::measuring::by_few;

fn measured(surface: &str, more: &str, chosen: Chosen) -> (AlbedoTable, Certificate) {
    let text = format!(
        "name = \"albedo\"\nseed = 3\n[surface]\n{surface}\n[light]\ntheta_i_deg = [0, 60]\n{more}\n"
    );
    let parsed = campaign::parse(&text, "c.toml", Path::new("")).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let setup = albedo::campaign_of(&parsed.campaign, chosen).expect("has the axes");
    let mut plan = measure::plan(&setup.campaign).expect("it fits the memory");
    by_few(&mut plan, setup.campaign.stop.samples);
    let patches = Patches::prepare(&setup.campaign, &mut Vec::new()).expect("patches");
    albedo::measure(&setup, &plan, &patches, &|_| ()).expect("no ray is lost")
}

fn list(values: &[f64]) -> Option<Vec<f64>> {
    Some(values.to_vec())
}

const GLASS: &str = "side = \"both\"\n[sensor.hemisphere]\n[optics]\nfacet = \"dielectric\"\neta = 1.5\n";

#[test]
fn the_white_furnace_of_rough_glass_is_1() {
    let chosen = Chosen {
        mu: list(&[0.1, 0.5, 1.0]),
        alpha: list(&[0.05, 0.1, 0.2, 0.5, 1.0]),
        eta: list(&[1.1, 1.5, 2.4]),
    };
    let trace = "[trace]\nbounces = 400\n[stop]\nsamples = 8192";
    let (table, certificate) =
        measured("realisations = 4\n[surface.smith]\nalpha = 0.3", &format!("{GLASS}{trace}"), chosen);
    assert!(certificate.ok, "{:?}", certificate.lines());
    for side in ["outside", "inside"] {
        let [back, through, rest] =
            ["R", "T", "rest"].map(|name| table.quantity(&format!("{name}_{side}")).expect("there"));
        for (cell, back) in back.cells.iter().enumerate() {
            let (through, rest) = (through.cells[cell], rest.cells[cell]);
            let se = back
                .error
                .zip(through.error)
                .map(|(back, through)| back.hypot(through))
                .expect("4 realisations");
            // The paths are counted on one side or the other, so that their errors cancel: 3 of R's and T's own, promised.
            assert!(
                (back.value + through.value - 1.0).abs() <= 3.0 * se + 1e-12,
                "{side} {cell}: {back:?} {through:?}"
            );
            // 400 bounces leave nothing of 8192 paths; the sum of all is exact but for the rounding of 800 shares.
            assert!(rest.value.abs() < 1e-12, "{side} {cell}: {rest:?}");
        }
    }
}

#[test]
fn order_1_of_rough_glass_is_the_formulas() {
    let chosen = Chosen { mu: list(&[0.3, 0.9]), alpha: list(&[0.1, 0.6]), eta: list(&[1.5]) };
    let more = format!("{GLASS}[trace]\nbounces = 4\n[stop]\nsamples = 65536");
    let (table, certificate) = measured("realisations = 16\n[surface.smith]\nalpha = 0.3", &more, chosen);
    let order_1 = certificate.order_1.as_ref().expect("judged");
    assert!(certificate.ok && order_1.cells == 16, "{:?}", certificate.lines());
    // Power: another masking is told apart. Separable masking lets more through, by 1e-3 and more at these roughnesses.
    let through = table.quantity("T_outside_order1").expect("there");
    let other = FormulaSurface::new(Ndf::Ggx, 0.6, Masking::Separable).at(0.3, Some(1.5))[1];
    let cell = through.cells[2];
    let t = (cell.value - other.value).abs() / cell.error.expect("16 realisations");
    assert!(t > student_limit(sidak(0.01, 16), 15), "{t}");
}

#[test]
fn mirrors_have_their_split_and_their_orders() {
    let more = "[sensor.hemisphere]\n[trace]\nbounces = 12\n[stop]\nsamples = 16384";
    let grains = "realisations = 8\n[surface.grains]\nalpha = 0.5\ncoverage = 0.8";
    let heights = "realisations = 8\ncells = 64\ncorrelation_cells = 4\n[surface.ggx]\nalpha = 0.5";
    for surface in
        [grains, heights, "realisations = 8\n[surface.smith]\nalpha = 0.5\nheights = \"independent\""]
    {
        let chosen = Chosen { mu: list(&[0.25, 0.75]), ..Chosen::default() };
        let (table, certificate) = measured(surface, more, chosen);
        assert!(certificate.ok && certificate.order_1.is_some(), "{surface}: {:?}", certificate.lines());
        let at = |name: &str, cell: usize| {
            table.quantity(name).unwrap_or_else(|| panic!("{name}")).cells[cell].value
        };
        for cell in 0..2 {
            // From the same paths: sums of shares in f64.
            let split = at("E_f0_order1", cell) + at("E_f90_order1", cell);
            assert!((split - at("E_order1", cell)).abs() < 1e-12, "{surface}");
            assert!(at("E_f90_order1", cell) > 0.0 && at("E_order2", cell) > 0.0);
            let listed: f64 = (1..=8).map(|order| at(&format!("E_order{order}"), cell)).sum();
            assert!(listed <= at("E", cell) + 1e-12 && at("E", cell) + at("rest", cell) > 0.9);
        }
        let average = table.quantity("E").expect("there").averages[0];
        assert!(at("E", 0).min(at("E", 1)) <= average.value && average.value <= at("E", 0).max(at("E", 1)));
    }
}

#[test]
fn surfaces_without_roughness_have_tables_too() {
    let more = "azimuth = \"absolute\"\nphi_i_deg = [0]\n[sensor.hemisphere]\n[trace]\nbounces = 8\n[stop]\nsamples = 65536";
    for surface in ["realisations = 2\n[surface.mirror]", "realisations = 2\n[surface.v_groove]\nslope = 0.5"]
    {
        let (table, certificate) = measured(surface, more, Chosen::default());
        assert_eq!((table.axes.alpha.clone(), table.axes.mu.len()), (vec![0.0], 2));
        assert!(certificate.ok, "{:?}", certificate.lines());
        // No light ends in a groove of two faces that is open above.
        let white = &table.quantity("E").expect("there").cells;
        assert!(white.iter().all(|cell| (cell.value - 1.0).abs() < 1e-9), "{white:?}");
    }
}
