//! Promise: `compare` tells differences from noise, bin by bin, and refuses tables that have no bins in common.

#[path = "common/measuring.rs"]
mod measuring;

use std::fs;

use assert_cmd::Command;
use gonio::campaign::{self, Campaign};
use gonio::instrument::{Grid, GridKind};
use gonio::measure::Measured;
use gonio::table::{BrdfTable, ColourChannels, RealisationPart, Realisations, store};
use gonio::validate::two_tables::{Side, difference};
use measuring::measured_one;
use serde_json::Value;

/// A statistical surface: no patches to make.
const SMITH: &str = "\
name = \"smith\"
seed = 1
[surface]
realisations = 8
[surface.smith]
ndf = \"ggx\"
alpha = 0.5
[light]
theta_i_deg = [0, 40]
[sensor.hemisphere]
theta_r_bins = 9
phi_r_bins = 18
[stop]
samples = 65_536
";

/// Two bins, projected solid angles pi/4 and 3 pi/4.
fn table(values: [f32; 2], stderr: [f32; 2]) -> BrdfTable {
    let grid = Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: vec![0.0],
        phi_i_deg: vec![0.0],
        phi_r_relative: true,
        theta_r_edges_deg: vec![0.0, 30.0, 90.0],
        phi_r_edges_deg: vec![0.0, 360.0],
        ..Grid::default()
    };
    let channels = ColourChannels {
        total: values.to_vec(),
        single: values.to_vec(),
        multiple: vec![0.0; 2],
        stderr: stderr.to_vec(),
        stderr_single: stderr.to_vec(),
        ..ColourChannels::default()
    };
    BrdfTable {
        grid,
        campaign: String::new(),
        version: "test".into(),
        seed: 1,
        patch_digest: String::new(),
        colours: vec![channels],
        hits: vec![10; 2],
        schlick: None,
    }
}

fn with<'a>(table: &'a BrdfTable, parts: &'a Realisations) -> Side<'a> {
    Side { table, campaign: None, parts: Some(parts) }
}

fn alone(table: &BrdfTable) -> Side<'_> {
    Side { table, campaign: None, parts: None }
}

#[test]
fn the_measures_follow_their_definitions() {
    let (a, b) = (table([1.5, 3.0], [0.3, 0.25]), table([1.0, 4.0], [0.4, 0.0]));
    let found = difference(alone(&a), alone(&b)).expect("one grid");
    // l1 = (0.5 + 3 1)/(1 + 3 4); se 0.5 and 0.25; c4 of a thousand realisations is 1 to 3e-4; t = 1 and 4.
    let noise = (2.0 / std::f64::consts::PI).sqrt() * (0.5 + 3.0 * 0.25) / 13.0;
    let figures = found.figures;
    assert!((figures.l1.unwrap() - 3.5 / 13.0).abs() < 1e-12);
    assert!((figures.l1_noise.unwrap() / noise - 1.0).abs() < 5e-4, "{figures:?} {noise}");
    // 0.3 and 0.4 are f32.
    assert!((figures.max_t.unwrap() - 4.0).abs() < 1e-6);
    assert_eq!((figures.share_outside_95, found.bins, found.paired), (Some(0.5), 2, false));
}

#[test]
fn bins_without_hits_have_no_t_and_tables_without_errors_no_noise() {
    let (mut a, b) = (table([1.5, 0.0], [0.3, 1.0]), table([1.0, 4.0], [0.4, 0.3]));
    a.hits[1] = 0;
    let found = difference(alone(&a), alone(&b)).expect("one grid");
    assert_eq!((found.bins, found.figures.share_outside_95), (1, Some(0.0)));
    let unknown = table([1.0, 4.0], [-1.0, -1.0]);
    let found = difference(alone(&a), alone(&unknown)).expect("one grid");
    assert!(found.figures.l1.is_some() && found.figures.l1_noise.is_none() && found.figures.max_t.is_none());
}

#[test]
fn tables_of_the_same_patches_are_paired() {
    // Realisations differ by 2 from each other, tables in each by 0.1 and 0.2: se = 0.05, not 1.4.
    let part = |x: f32| RealisationPart { total: vec![vec![x, x]], single: vec![vec![x, x]], schlick: None };
    let parts = |values: [f32; 2]| Realisations { parts: values.map(part).to_vec() };
    let (mut a, mut b) = (table([2.15, 2.15], [1.0, 1.0]), table([2.0, 2.0], [1.0, 1.0]));
    (a.patch_digest, b.patch_digest) = ("same".into(), "same".into());
    let (in_a, in_b) = (parts([1.1, 3.2]), parts([1.0, 3.0]));
    let found = difference(with(&a, &in_a), with(&b, &in_b)).expect("one grid");
    // (0.15)/(0.05), all of it f32.
    assert!(found.paired && (found.figures.max_t.unwrap() - 3.0).abs() < 1e-4, "{found:?}");
    b.patch_digest = "other".into();
    assert!(!difference(with(&a, &in_a), with(&b, &in_b)).expect("one grid").paired);
}

fn side<'a>(measured: &'a Measured, campaign: &'a Campaign) -> Side<'a> {
    Side { table: &measured.table, campaign: Some(campaign), parts: Some(&measured.realisations) }
}

#[test]
fn equal_laws_differ_by_their_noise_alone() {
    let a = measured_one(SMITH);
    let b = measured_one(&SMITH.replace("seed = 1", "seed = 2"));
    let found = difference(side(&a, &a.campaign), side(&b, &b.campaign)).expect("one grid");
    let (l1, noise) = (found.figures.l1.unwrap(), found.figures.l1_noise.unwrap());
    // The mean of |t| over n = 180 counted bins and more scatters by 0.76/sqrt(n) = 6 %: four times that.
    assert!((l1 / noise - 1.0).abs() < 0.24, "{l1} {noise}");
    // 5 % of n bins, binomial: 4 sqrt(0.05 0.95/n) = 0.065; Welch's degrees of freedom are rounded down.
    assert!(found.bins > 150 && found.figures.share_outside_95.unwrap() < 0.05 + 0.065, "{found:?}");
    assert!(found.figures.max_t < found.t_limit, "{found:?}");
    let rougher = measured_one(&SMITH.replace("alpha = 0.5", "alpha = 0.6"));
    let found = difference(side(&rougher, &rougher.campaign), side(&b, &b.campaign)).expect("one grid");
    assert!(found.figures.max_t > found.t_limit, "{found:?}");
}

#[test]
fn the_command_prints_json_or_refuses_in_one_line() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let save = |name: &str, table: &BrdfTable| store::save(&folder.path().join(name), table).expect("saved");
    save("a.exr", &table([1.5, 3.0], [0.3, 0.25]));
    save("b.exr", &table([1.0, 4.0], [0.4, 0.0]));
    let mut other = table([1.0, 4.0], [0.4, 0.0]);
    other.grid.theta_r_edges_deg[1] = 31.0;
    save("c.exr", &other);
    let run = |words: &[&str]| {
        Command::cargo_bin("gonio").expect("built").current_dir(&folder).args(words).output().expect("runs")
    };
    let answer = run(&["compare", "a.exr", "b.exr", "--json"]);
    let json: Value = serde_json::from_slice(&answer.stdout).expect("JSON and nothing else");
    for key in ["bins", "l1", "l1_noise", "max_t", "share_outside_95"] {
        assert!(json[key].is_number(), "{key} of {json}");
    }
    let same = run(&["compare", "a.exr", "a.exr", "--json"]);
    let json: Value = serde_json::from_slice(&same.stdout).expect("JSON");
    assert_eq!((json["l1"].as_f64(), json["max_t"].as_f64()), (Some(0.0), Some(0.0)));
    let refused = run(&["compare", "a.exr", "c.exr"]);
    let said = String::from_utf8(refused.stderr).expect("UTF-8");
    assert_eq!(refused.status.code(), Some(3), "{said}");
    let errors: Vec<&str> = said.lines().filter(|line| line.starts_with("error")).collect();
    assert!(
        errors.len() == 1 && errors[0].contains("theta_r_edges_deg has 31 where the other table has 30"),
        "{said}"
    );
    assert!(fs::read_dir(&folder).expect("a folder").count() == 3);
}

#[test]
fn the_campaign_of_a_table_says_how_many_realisations_there_are() {
    // Two tables of 2 realisations: 2 degrees of freedom, 95 % limit 4.303: |t| = 4 is inside.
    let text = SMITH.replace("realisations = 8", "realisations = 2");
    let parsed = campaign::parse(&text, "c.toml", std::path::Path::new("")).expect("sound").campaign;
    let (a, b) = (table([1.5, 2.4], [0.3, 0.3]), table([1.0, 4.0], [0.3, 0.3]));
    let side = |table| Side { campaign: Some(&parsed), ..alone(table) };
    let found = difference(side(&a), side(&b)).expect("one grid");
    assert!(found.figures.max_t.unwrap() > 3.7 && found.figures.share_outside_95 == Some(0.0), "{found:?}");
}
