//! Promise: with shadowing and masking switched off, what is measured is D F/(4 cos cos) of the surface's own normals.

use std::path::Path;
use std::sync::{LazyLock, OnceLock};

use gonio::campaign::{self, Alpha, Campaign, SurfaceKind};
use gonio::measure::{Measured, Patches, Plan};
use gonio::validate::compare::IncidenceComparison;
use gonio::validate::error_measures::Figures;
use gonio::validate::{Verdict, examine};

use crate::support::long::or_long;
use crate::support::measuring::{by_few, measured, measured_on};

/// A table measured without shadowing and masking. `light` may give azimuths, `optics` a material.
fn unobstructed(surface: &str, light: &str, optics: &str) -> Measured {
    let text = format!(
        "name = \"unobstructed\"\nseed = 5\n\
         [surface]\nrealisations = 8\ncells = 256\n[surface.{surface}\n\
         [light]\ntheta_i_deg = [0, 30, 60, 75]\n{light}\n\
         [sensor.hemisphere]\ntheta_r_bins = 9\nphi_r_bins = 18\nbins = \"aligned\"\n{optics}\n\
         [trace]\nvisibility = false\n[stop]\nsamples = 65_536\n"
    );
    let held = || {
        let campaign = campaign::parse(&text, "c.toml", Path::new("")).expect("a good campaign").campaign;
        Patches::held(&campaign).expect("patches")
    };
    // The patches are the same whatever the roughness, the light and the material: made once.
    static GGX: OnceLock<Patches> = OnceLock::new();
    let plan = |plan: &Plan, _: &Campaign| {
        let mut plan = plan.clone();
        by_few(&mut plan, or_long(32_768, 65_536));
        Some(plan)
    };
    if surface.starts_with("ggx") {
        measured_on(GGX.get_or_init(held), &text, plan)
    } else {
        measured_on(&held(), &text, plan)
    }
}

/// Isotropic surfaces of alpha 0.2 and 0.5, measured once.
static SMOOTHER: LazyLock<Measured> = LazyLock::new(|| unobstructed("ggx]\nalpha = 0.2", RELATIVE, ""));
static ROUGHER: LazyLock<Measured> = LazyLock::new(|| unobstructed("ggx]\nalpha = 0.5", RELATIVE, ""));

const RELATIVE: &str = "azimuth = \"relative\"";

fn verdict(measured: &Measured) -> Verdict {
    examine(&measured.table, &measured.campaign, Some(&measured.realisations))
}

/// What is left of the distance when noise is taken off, and the noise, at the worst incidence.
fn worst(verdict: &Verdict) -> (f64, f64) {
    let [comparison] = verdict.comparisons.as_slice() else { panic!("one model") };
    assert_eq!(comparison.masking, "none");
    let figures = |incidence: &IncidenceComparison| {
        (
            incidence.figures.l1_model.expect("8 realisations"),
            incidence.figures.l1_noise.expect("8 realisations"),
        )
    };
    let worse = |a: (f64, f64), b: (f64, f64)| if a.0 / a.1 > b.0 / b.1 { a } else { b };
    comparison.incidences.iter().map(figures).reduce(worse).expect("stops")
}

#[test]
fn the_table_is_that_of_the_normals_alone() {
    let brushed =
        unobstructed("ggx]\nalpha_x = 0.1\nalpha_y = 0.4", "azimuth = \"absolute\"\nphi_i_deg = [0, 90]", "");
    let beckmann = unobstructed("beckmann]\nalpha = 0.3", RELATIVE, "");
    for measured in [&*SMOOTHER, &*ROUGHER, &brushed, &beckmann] {
        let surface = &measured.campaign.surface.kind;
        let verdict = verdict(measured);
        let (model, noise) = worst(&verdict);
        println!("{surface:?}: {model:.4}, noise {noise:.4}");
        // Patches as small as these keep an error of their own, about as large as the noise; twice the noise is a
        // quarter of what a roughness wrong by a tenth shows. The figure has a spread of its own: two of those.
        for incidence in &verdict.comparisons[0].incidences {
            let of = |figure: Option<f64>| figure.expect("8 realisations");
            let (model, se) = (of(incidence.figures.l1_model), of(incidence.figures.l1_model_se));
            let noise = of(incidence.figures.l1_noise);
            assert!(model - 2.0 * se < 2.0 * noise, "{surface:?}: {model} +- {se}, noise {noise}");
        }
    }
}

#[test]
fn a_roughness_wrong_by_a_tenth_is_seen() {
    // Power of the test above: the same table held to the model of another surface.
    let mut measured = ROUGHER.clone();
    let SurfaceKind::Ggx(alphas) = &mut measured.campaign.surface.kind else { panic!("ggx") };
    *alphas = vec![Alpha::isotropic(0.55)];
    let (model, noise) = worst(&verdict(&measured));
    println!("{model:.4}, noise {noise:.4}");
    assert!(model > 4.0 * noise, "{model} {noise}");
}

#[test]
fn the_laws_of_energy_are_skipped_and_said_to_be() {
    let verdict = verdict(&ROUGHER);
    // The model itself reflects more than it gets at 75 degrees.
    let albedo = verdict.comparisons[0].incidences[3].albedo_model.expect("a hemisphere");
    assert!(albedo > 1.0, "{albedo}");
    assert!(verdict.energy.skipped.as_ref().is_some_and(|why| why.contains("visibility is switched off")));
    assert!(verdict.energy.largest_albedo.is_none() && verdict.reciprocity.is_none());
    assert!(!verdict.failures.iter().any(|failure| failure.starts_with("energy")), "{:?}", verdict.failures);
}

#[test]
fn the_material_does_not_change_the_figures() {
    let (mirror, noise) = worst(&verdict(&SMOOTHER));
    for material in ["gold", "water"] {
        let optics = format!("[optics]\nmaterial = \"{material}\"");
        let (found, _) = worst(&verdict(&unobstructed("ggx]\nalpha = 0.2", RELATIVE, &optics)));
        println!("{material}: {found:.4}, F = 1: {mirror:.4}, noise {noise:.4}");
        // The same starts: only the weights of the bins change, and those by less than what they weigh.
        assert!((found - mirror).abs() < noise, "{material}: {found} {mirror} {noise}");
    }
}

/// A campaign as it is delivered, at its full size; `optics` is added to it.
fn delivered(path: &str, optics: &str) -> Vec<Measured> {
    measured(&format!("{}\n{optics}", std::fs::read_to_string(path).expect("the campaign")))
}

/// theta_i, phi_i, l1_model, l1_noise.
type Stop = (f64, f64, f64, f64);

/// Every incidence, and (l1_model, l1_noise) as means over incidences and colours, which is what a bar speaks of.
fn figures(measured: &Measured) -> (Vec<Stop>, (f64, f64)) {
    let verdict = verdict(measured);
    let [comparison] = verdict.comparisons.as_slice() else { panic!("one model") };
    let of = |f: &Figures| f.l1_model.zip(f.l1_noise).expect("16 realisations");
    let incidences = comparison.incidences.iter().map(|incidence| {
        let (model, noise) = of(&incidence.figures);
        println!(
            "{:?} {} {}: {model:.4}, noise {noise:.4}",
            measured.campaign.alphas()[0],
            incidence.theta_i_deg,
            incidence.phi_i_deg
        );
        (incidence.theta_i_deg, incidence.phi_i_deg, model, noise)
    });
    (incidences.collect(), of(&comparison.figures))
}

#[test]
#[ignore = "takes minutes: cargo test --release --test it visibility_off -- --ignored --nocapture"]
fn isotropic_normals_keep_their_bar_whatever_the_material() {
    let bar = 0.002;
    let mut white = Vec::new();
    for (material, optics) in [
        ("F = 1", ""),
        ("gold", "[optics]\nmaterial = \"gold\""),
        ("water", "[optics]\nmaterial = \"water\""),
    ] {
        let tables = delivered("configs/visibility_off.toml", optics);
        let found: Vec<(f64, f64)> = tables.iter().map(|table| figures(table).1).collect();
        println!("{material}: {found:.4?}");
        // A bar counts only where the noise is no larger.
        assert!(found.iter().all(|&(model, noise)| noise <= bar && model <= bar), "{material}: {found:?}");
        assert!(tables.iter().all(|table| verdict(table).ok), "{material}");
        if white.is_empty() {
            white = found;
            continue;
        }
        for (&(with, noise), &(without, _)) in found.iter().zip(&white) {
            // The same starts: what can be told from 0 at all is half of the noise.
            assert!((with - without).abs() < 0.5 * noise, "{material}: {with} {without}");
        }
    }
}

#[test]
#[ignore = "takes minutes: cargo test --release --test it visibility_off -- --ignored --nocapture"]
fn brushed_normals_keep_their_bars_at_every_azimuth() {
    for table in delivered("configs/visibility_off_anisotropic.toml", "") {
        let (incidences, _) = figures(&table);
        assert_eq!(incidences.len(), 12);
        for (theta_i, phi_i, model, noise) in incidences {
            let bar = if theta_i <= 60.0 { 0.006 } else { 0.012 };
            assert!(noise <= bar && model <= bar, "{theta_i} {phi_i}: {model} {noise}");
        }
    }
}
