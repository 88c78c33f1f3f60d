//! Promise: a table that is wrong fails, one that is right passes, and what was not tested is said to be so.
//!
//! Every law has tables that break it: each is a right table with one thing changed. Power: the changes are many times
//! the noise of the right table, which passes.

use std::sync::LazyLock;

use gonio::campaign::Campaign;
use gonio::measure::Measured;
use gonio::table::{BrdfTable, Realisations};
use gonio::validate::{Judgement, Ruling, Verdict, examine};

use crate::support::campaign_text::accepted;
use crate::support::measuring::{measured, measured_one};

fn judged<'a>(verdict: &'a Verdict, law: &str) -> &'a Judgement {
    verdict.judgements.iter().find(|judgement| judgement.law == law).expect("every law has its line")
}

fn ruling(verdict: &Verdict, law: &str) -> Ruling {
    judged(verdict, law).ruling
}

fn verdict_of(measured: &Measured) -> Verdict {
    examine(&measured.table, &measured.campaign, Some(&measured.realisations))
}

/// The same values under another campaign's text.
fn relabelled(measured: &Measured, change: impl FnOnce(&mut Campaign)) -> Verdict {
    let mut campaign = measured.campaign.clone();
    change(&mut campaign);
    examine(&measured.table, &campaign, Some(&measured.realisations))
}

/// The table and its realisations with every value of (incidence, bin, colour) multiplied.
fn scaled(measured: &Measured, factor: impl Fn(usize, usize, usize) -> f32) -> Verdict {
    let (mut table, mut parts) = (measured.table.clone(), measured.realisations.clone());
    let bins = table.grid.bins();
    let apply = |values: &mut Vec<f32>, colour: usize| {
        values.iter_mut().enumerate().for_each(|(at, value)| *value *= factor(at / bins, at % bins, colour));
    };
    for (colour, channels) in table.colours.iter_mut().enumerate() {
        let lists =
            [&mut channels.total, &mut channels.single, &mut channels.stderr, &mut channels.stderr_single];
        lists.into_iter().for_each(|values| apply(values, colour));
    }
    for part in &mut parts.parts {
        for list in [&mut part.total, &mut part.single] {
            list.iter_mut().enumerate().for_each(|(colour, values)| apply(values, colour));
        }
    }
    examine(&table, &measured.campaign, Some(&parts))
}

fn smith_text(surface: &str, light: &str, rest: &str) -> String {
    format!(
        "name = \"s\"\n[surface]\nrealisations = 16\n{surface}\n[light]\n{light}\n[sensor.hemisphere]\n\
         theta_r_bins = 9\nphi_r_bins = 18\n{rest}\n[stop]\nsamples = 65536\n"
    )
}

/// A statistical Smith surface, of which the formula is exact.
fn smith(surface: &str, light: &str, rest: &str) -> Measured {
    measured_one(&smith_text(surface, light, rest))
}

/// Correlated heights of alpha 0.3, measured once.
static SMITH: LazyLock<Measured> = LazyLock::new(|| smith(&format!("{CORRELATED}alpha = 0.3"), LIGHT, ""));

const CORRELATED: &str = "[surface.smith]\nndf = \"ggx\"\nheights = \"correlated\"\n";
const LIGHT: &str = "theta_i_deg = [0, 30, 60]";

#[test]
fn a_right_table_passes_and_a_wrong_label_fails() {
    let measured = &*SMITH;
    let right = verdict_of(measured);
    assert!(right.ok && right.verdict.starts_with("passed"), "{:#?}", right.judgements);
    assert_eq!(ruling(&right, "model"), Ruling::Passed);
    assert_eq!(ruling(&right, "energy"), Ruling::Passed);
    assert_eq!(ruling(&right, "light"), Ruling::Passed);
    // The seed is no physics: another one is as right.
    assert_eq!(ruling(&relabelled(measured, |campaign| campaign.seed = 99), "model"), Ruling::Passed);
    let of = |text: &str| accepted(&smith_text(&format!("{CORRELATED}{text}"), LIGHT, "")).campaign;
    for wrong in ["alpha = 0.1", "alpha = 0.31", "alpha = 0.6"] {
        let other = of(wrong);
        let verdict = relabelled(measured, |campaign| *campaign = other);
        assert_eq!(ruling(&verdict, "model"), Ruling::Failed, "{wrong}");
        assert!(!verdict.ok && verdict.verdict.starts_with("failed: "), "{}", verdict.verdict);
    }
    // At alpha 0.8 and 75 degrees separable masking is a fifth of the flux away (docs/physics.md).
    let of = |heights: &str| {
        let surface = format!("[surface.smith]\nndf = \"ggx\"\nheights = \"{heights}\"\nalpha = 0.8");
        smith_text(&surface, "theta_i_deg = [75]", "")
    };
    let (rough, independent) = (measured_one(&of("correlated")), accepted(&of("independent")).campaign);
    assert_eq!(ruling(&verdict_of(&rough), "model"), Ruling::Passed);
    let verdict = relabelled(&rough, |campaign| *campaign = independent);
    assert_eq!(ruling(&verdict, "model"), Ruling::Failed, "another masking");
}

#[test]
fn wrong_values_of_an_exact_surface_fail() {
    let measured = &*SMITH;
    let bins = measured.table.grid.bins();
    let (incidence, brightest) = {
        let values = &measured.table.colours[0].single[bins..2 * bins];
        (1, (0..bins).max_by(|&a, &b| values[a].total_cmp(&values[b])).expect("bins"))
    };
    let one = scaled(measured, |s, b, _| if (s, b) == (incidence, brightest) { 1.2 } else { 1.0 });
    assert_eq!(ruling(&one, "model"), Ruling::Failed, "one bin scaled");
    // The cosine of the sensor, taken at the middle of the bin, as a file with f cos would have it.
    let edges = &measured.table.grid.theta_r_edges_deg;
    let columns = measured.table.grid.phi_r_edges_deg.len() - 1;
    let cosine =
        |bin: usize| (0.5 * (edges[bin / columns] + edges[bin / columns + 1])).to_radians().cos() as f32;
    assert_eq!(
        ruling(&scaled(measured, |_, bin, _| cosine(bin)), "model"),
        Ruling::Failed,
        "times the cosine"
    );
    // All flux reflected of a smooth surface is 0.99 or so: a tenth more breaks the law.
    assert_eq!(ruling(&scaled(measured, |_, _, _| 1.15), "energy"), Ruling::Failed, "more than it gets");
    assert_eq!(ruling(&scaled(measured, |_, _, _| 0.0), "light"), Ruling::Failed, "nothing arrives");
}

#[test]
fn swapped_colours_and_a_turned_sample_fail() {
    let gold = "[optics]\nmaterial = \"gold\"";
    let mut measured = smith(&format!("{CORRELATED}alpha = 0.3"), LIGHT, gold);
    assert_eq!(ruling(&verdict_of(&measured), "model"), Ruling::Passed);
    measured.table.colours.swap(0, 2);
    measured.realisations.parts.iter_mut().for_each(|part| {
        part.total.swap(0, 2);
        part.single.swap(0, 2);
    });
    assert_eq!(ruling(&verdict_of(&measured), "model"), Ruling::Failed, "red and blue swapped");

    let light = "theta_i_deg = [30]\nazimuth = \"absolute\"\nphi_i_deg = [0, 45]";
    let brushed = smith(&format!("{CORRELATED}alpha_x = 0.1\nalpha_y = 0.3"), light, "");
    assert_eq!(ruling(&verdict_of(&brushed), "model"), Ruling::Passed);
    let turned = relabelled(&brushed, |campaign| campaign.surface.rotation_deg = 10.0);
    assert_eq!(ruling(&turned, "model"), Ruling::Failed, "turned by 10 degrees");
}

/// Random heights keep a discrepancy of their own, so their bar is not 0.
#[test]
fn a_distance_many_noises_above_its_bar_fails_whatever_the_noise() {
    let measured = measured_one(
        "name = \"g\"\n[surface]\nrealisations = 8\ncells = 128\n[surface.ggx]\nalpha = 0.3\n[light]\n\
         theta_i_deg = [30]\n[sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 36\n[stop]\nsamples = 65536\n",
    );
    let right = verdict_of(&measured);
    assert_ne!(ruling(&right, "model"), Ruling::Failed, "{}", judged(&right, "model").reason);
    for parts in [Some(&measured.realisations), None] {
        let smoother = measured.campaign.with_alpha(gonio::campaign::Alpha::isotropic(0.1));
        let verdict = examine(&measured.table, &smoother, parts);
        let model = judged(&verdict, "model");
        assert_eq!(model.ruling, Ruling::Failed, "{}", model.reason);
    }
    // One realisation has no error bar: nothing can be said.
    let mut alone = measured.clone();
    alone.realisations = Realisations::default();
    alone.campaign.surface.realisations = 1;
    for colour in &mut alone.table.colours {
        colour.stderr.fill(-1.0);
        colour.stderr_single.fill(-1.0);
    }
    assert_eq!(ruling(&verdict_of(&alone), "model"), Ruling::NotJudged);
}

/// Exchanged arms of equal apertures see the same, whatever the surface; scaled at one incidence they do not.
#[test]
fn arms_that_are_not_reciprocal_fail() {
    let measured = measured_one(
        "name = \"a\"\n[surface]\nrealisations = 8\n[surface.smith]\nndf = \"ggx\"\nheights = \"correlated\"\n\
         alpha = 0.5\n[light]\ntheta_i_deg = [20, 40, 60]\naperture_deg = 4.0\nazimuth = \"absolute\"\nphi_i_deg = [0]\n\
         [sensor.arm]\ntheta_r_deg = [20, 40, 60]\nphi_r_deg = [0]\naperture_deg = 4.0\n[stop]\nsamples = 262144\n",
    );
    let right = verdict_of(&measured);
    assert_eq!(ruling(&right, "reciprocity"), Ruling::Passed, "{}", judged(&right, "reciprocity").reason);
    let wrong = scaled(&measured, |incidence, _, _| if incidence == 2 { 1.3 } else { 1.0 });
    let found = judged(&wrong, "reciprocity");
    assert_eq!(found.ruling, Ruling::Failed, "{}", found.reason);
}

fn imported(table: &BrdfTable, value: impl Fn(f32) -> f32) -> BrdfTable {
    let total = table.colours[0].total.iter().map(|&f| value(f)).collect();
    gonio::interchange::foreign_table(table.grid.clone(), vec![total]).expect("values")
}

/// An imported table has no errors: none are made up, and the limit of the albedo is 1.
#[test]
fn an_imported_table_that_reflects_more_than_it_gets_fails() {
    let measured = &*SMITH;
    let right = examine(&imported(&measured.table, |f| f), None, None);
    assert_eq!(ruling(&right, "energy"), Ruling::Passed);
    assert_eq!(ruling(&right, "model"), Ruling::NotJudged);
    let wrong = examine(&imported(&measured.table, |f| 1.2 * f), None, None);
    let energy = judged(&wrong, "energy");
    assert_eq!((energy.ruling, energy.allowance), (Ruling::Failed, None), "{}", energy.reason);
    assert!(energy.reason.contains("errors n/a"), "{}", energy.reason);
    let black = examine(&imported(&measured.table, |_| 0.0), None, None);
    assert!(judged(&black, "light").reason.contains("every value is 0"), "{:?}", black.judgements);
    assert_eq!(ruling(&black, "light"), Ruling::NotJudged);
}

/// A height map has no model and, at one incidence, no pair of directions: what remains is energy, and it is said so.
#[test]
fn light_that_sees_nothing_is_no_albedo_of_zero() {
    let tables = measured(
        "name = \"grazing\"\n[surface]\nrealisations = 4\n[surface.smith]\nndf = \"ggx\"\nheights = \"correlated\"\n\
         alpha = 0.5\n[light]\ntheta_i_deg = [89.9999999]\n[sensor.hemisphere]\n[stop]\nsamples = 65536\n",
    );
    let measured = &tables[0];
    let dark = measured.incidences[0].orders[0] == 0;
    let verdict = verdict_of(measured);
    assert_eq!(verdict.ok, !dark, "{:?}", verdict.judgements);
    assert_eq!(measured.incidences[0].single().0.is_none(), dark && measured.incidences[0].cut == 0);
}
