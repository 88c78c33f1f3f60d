//! Promise: tables of different colours, incidences or bins are compared by what they have in common: exactly where bins nest,
//! else by interpolation, and the output says what was done and what its errors are.

use gonio::instrument::{Grid, GridKind};
use gonio::interchange::{foreign_table, spectral_table};
use gonio::measure::Measured;
use gonio::table::{BrdfTable, store};
use gonio::validate::common_grid::{compared, on_common_grid};
use gonio::validate::two_tables::ComparedTable;
use serde_json::Value;

use crate::support::measuring::measured_one;
use crate::support::program::{self, exits, gonio};

/// A statistical surface under light from three angles, bins with edges on multiples of the step.
const SMITH: &str = "\
name = \"smith\"
seed = 1
[surface]
realisations = 4
[surface.smith]
ndf = \"ggx\"
alpha = 0.5
[light]
theta_i_deg = [0, 40, 70]
[sensor.hemisphere]
theta_r_bins = 45
phi_r_bins = 90
bins = \"aligned\"
[stop]
samples = 65_536
";

/// The same rays into bins of 1 x 2 degrees instead of 2 x 4.
fn fine() -> String {
    SMITH.replace("theta_r_bins = 45", "theta_r_bins = 90").replace("phi_r_bins = 90", "phi_r_bins = 180")
}

fn side(measured: &Measured) -> ComparedTable<'_> {
    let (campaign, parts) = (Some(&measured.campaign), Some(&measured.realisations));
    ComparedTable { campaign, parts, ..ComparedTable::of(&measured.table) }
}

#[test]
fn fine_bins_become_the_coarse_ones_of_the_same_rays() {
    let (fine, coarse) = (measured_one(&fine()), measured_one(SMITH));
    let common = on_common_grid(&side(&fine), &side(&coarse)).expect("they nest");
    let [found, kept] = &common.tables;
    assert_eq!((&found.table.grid, &kept.table.grid), (&coarse.table.grid, &coarse.table.grid));
    assert_eq!(
        common.steps,
        ["A's bins (1 x 2 degrees) averaged to 2 x 4 degrees, by projected solid angle"]
    );
    // The same arrivals, counted.
    assert_eq!(found.table.hits, coarse.table.hits);
    assert_eq!(kept.table.colours[0].total, coarse.table.colours[0].total);
    let peak = coarse.table.colours[0].total.iter().copied().fold(0.0, f32::max);
    let of = |table: &BrdfTable| {
        table.colours[0].total.iter().zip(&table.colours[0].stderr).map(|(&a, &b)| [a, b]).collect::<Vec<_>>()
    };
    for (at, (found, coarse)) in of(&found.table).into_iter().zip(of(&coarse.table)).enumerate() {
        // Four values a bin and their mean are f32, each right to 2^-24 of itself and none above four times the mean; an
        // error is off by what its four realisations are, of which none is above 4 of the peak.
        let near = |a: f32, b: f32, size: f32| (a - b).abs() <= 8.0 * f32::EPSILON * size;
        assert!(near(found[0], coarse[0], coarse[0]), "bin {at}: {found:?} {coarse:?}");
        assert!(near(found[1], coarse[1], 4.0 * peak), "bin {at}: {found:?} {coarse:?}");
    }
    // Both ways round, and at half of the incidences.
    let difference = compared(&side(&coarse), &side(&fine)).expect("they nest");
    assert!(
        difference.figures.l1.unwrap() < 1e-6 && !difference.interpolated && !difference.errors_are_bounds
    );
    assert_eq!(difference.incidences.len(), 3);
    let fewer = measured_one(&fine_at("[40, 55]"));
    let difference = compared(&side(&fewer), &side(&coarse)).expect("one in common");
    assert_eq!(difference.made_comparable[0], "1 incidences in common, of 2 in A and 3 in B");
    assert_eq!(
        difference.incidences.iter().map(|incidence| incidence.theta_i_deg).collect::<Vec<_>>(),
        [40.0]
    );
}

fn fine_at(theta_i: &str) -> String {
    fine().replace("[0, 40, 70]", theta_i)
}

fn hemisphere(theta_step: f64, phi_step: f64) -> Grid {
    let edges =
        |step: f64, end: f64| (0..=(end / step).round() as u32).map(|k| step * f64::from(k)).collect();
    Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: vec![30.0],
        phi_i_deg: vec![0.0],
        phi_r_relative: true,
        theta_r_edges_deg: edges(theta_step, 90.0),
        phi_r_edges_deg: edges(phi_step, 360.0),
        ..Grid::default()
    }
}

/// f(theta, phi) = cos theta (1 + sin theta cos(phi)/2): its means over bins in closed form.
fn means(grid: &Grid) -> Vec<f32> {
    let pairs = |edges: &[f64]| {
        edges.windows(2).map(|pair| [pair[0].to_radians(), pair[1].to_radians()]).collect::<Vec<_>>()
    };
    let mut found = Vec::new();
    for [t1, t2] in pairs(&grid.theta_r_edges_deg) {
        // int cos sin = (c1^2 - c2^2)/2, int cos^2 sin = (c1^3 - c2^3)/3, int cos^2 sin^2 = [t/8 - sin(4 t)/32].
        let (c1, c2) = (t1.cos(), t2.cos());
        let size = 0.5 * (c1 * c1 - c2 * c2);
        let along = (c1.powi(3) - c2.powi(3)) / 3.0 / size;
        let of = |t: f64| t / 8.0 - (4.0 * t).sin() / 32.0;
        let tilted = (of(t2) - of(t1)) / size;
        for [p1, p2] in pairs(&grid.phi_r_edges_deg) {
            found.push((along + 0.5 * tilted * (p2.sin() - p1.sin()) / (p2 - p1)) as f32);
        }
    }
    found
}

fn analytic(grid: Grid, scales: &[f32]) -> BrdfTable {
    let total = means(&grid);
    let colours = scales.iter().map(|scale| total.iter().map(|value| scale * value).collect()).collect();
    foreign_table(grid, colours).expect("a table")
}

fn largest_error(found: &BrdfTable, expected: &[f32]) -> f32 {
    let pairs = found.colours[0].total.iter().zip(expected);
    pairs.map(|(found, expected)| (found / expected - 1.0).abs()).fold(0.0, f32::max)
}

#[test]
fn means_of_bins_are_those_of_the_function() {
    let (coarse, fine) = (hemisphere(10.0, 30.0), hemisphere(2.0, 5.0));
    let (a, b) = (analytic(fine, &[1.0]), analytic(coarse.clone(), &[1.0]));
    let common = on_common_grid(&ComparedTable::of(&a), &ComparedTable::of(&b)).expect("they nest");
    // f32 values, summed in f64.
    assert!(largest_error(&common.tables[0].table, &means(&coarse)) < 3.0 * f32::EPSILON);
    // Finer along one angle each: the coarser of both.
    let (rows, columns) = (analytic(hemisphere(2.0, 30.0), &[1.0]), analytic(hemisphere(10.0, 5.0), &[1.0]));
    let common = on_common_grid(&ComparedTable::of(&rows), &ComparedTable::of(&columns)).expect("they nest");
    assert_eq!(common.tables[1].table.grid, coarse);
    assert!(
        common.tables.iter().all(|side| largest_error(&side.table, &means(&coarse)) < 3.0 * f32::EPSILON)
    );
    assert_eq!(common.steps.len(), 2, "{:?}", common.steps);
}

#[test]
fn bins_that_do_not_nest_are_interpolated() {
    let centred = |step: f64| Grid {
        theta_r_edges_deg: std::iter::once(0.0)
            .chain((0..(90.0 / step) as u32).map(|k| step * (f64::from(k) + 0.5)))
            .chain([90.0])
            .collect(),
        ..hemisphere(step, step)
    };
    let (a, b) = (analytic(centred(2.0), &[1.0]), analytic(centred(1.0), &[1.0]));
    let found = on_common_grid(&ComparedTable::of(&a), &ComparedTable::of(&b)).expect("interpolated");
    assert!(
        found.interpolated && found.steps[0].contains("B (1 x 1 degrees) interpolated"),
        "{:?}",
        found.steps
    );
    assert!(found.steps[1].contains("B's errors are n/a"), "{:?}", found.steps);
    // A cubic whose slopes are differences of its neighbours, nodes h = 1 degree apart, is off by h^3/12 of the third derivative,
    // 4e-7 of 1, at most; values are f32, 6e-8.
    let difference = compared(&ComparedTable::of(&a), &ComparedTable::of(&b)).expect("interpolated");
    assert!(difference.figures.l1_noise.is_none() && difference.figures.l1.unwrap() < 1e-6);
}

#[test]
fn colours_meet_as_luminance_or_as_common_wavelengths() {
    let grid = hemisphere(10.0, 30.0);
    let scales = [0.9, 0.6, 0.2];
    let (colour, one) = (analytic(grid.clone(), &scales), analytic(grid.clone(), &[1.0]));
    for (a, b, name) in [(&colour, &one, "A has R, G, B"), (&one, &colour, "B has R, G, B")] {
        let common = on_common_grid(&ComparedTable::of(a), &ComparedTable::of(b)).expect("luminance");
        assert!(common.steps[0].starts_with(name), "{:?}", common.steps);
        let at = usize::from(name.starts_with('B'));
        // ITU-R BT.709: 0.2126 0.9 + 0.7152 0.6 + 0.0722 0.2 = 0.6349.
        let expected: Vec<f32> = means(&grid).iter().map(|value| 0.6349 * value).collect();
        assert!(largest_error(&common.tables[at].table, &expected) < 4.0 * f32::EPSILON);
    }
    let spectral =
        |nm: &[f64]| spectral_table(grid.clone(), vec![means(&grid); nm.len()], nm).expect("a table");
    let (a, b) = (spectral(&[450.0, 550.0, 650.0]), spectral(&[500.0, 550.0, 600.0, 650.0]));
    let common = on_common_grid(&ComparedTable::of(&a), &ComparedTable::of(&b)).expect("two in common");
    assert!(common.tables.iter().all(|side| side.table.wavelengths_nm() == [550.0, 650.0]));
    assert!(common.steps[0].contains("550, 650 nm"), "{:?}", common.steps);
    let refused = |b: &BrdfTable| {
        compared(&ComparedTable::of(&a), &ComparedTable::of(b)).expect_err("nothing in common").to_string()
    };
    assert!(refused(&spectral(&[400.0])).contains("no wavelength in common"));
    assert!(refused(&one).contains("B has Y, A w450 w550 w650"));
}

#[test]
fn errors_without_realisations_are_upper_bounds() {
    let mut fine = analytic(hemisphere(5.0, 30.0), &[1.0]);
    fine.colours[0].stderr = fine.colours[0].total.iter().map(|value| 0.1 * value).collect();
    fine.hits.fill(10);
    let mut coarse = analytic(hemisphere(10.0, 30.0), &[1.0]);
    coarse.colours[0].stderr.fill(0.0);
    let common = on_common_grid(&ComparedTable::of(&fine), &ComparedTable::of(&coarse)).expect("they nest");
    let found = &common.tables[0];
    // A tenth of every value is, of wholly correlated bins, a tenth of their mean.
    let pairs = found.table.colours[0].stderr.iter().zip(&found.table.colours[0].total);
    assert!(pairs.into_iter().all(|(se, value)| (se / (0.1 * value) - 1.0).abs() < 1e-6));
    assert!(found.errors_are_bounds && common.steps[1].contains("upper bounds"), "{:?}", common.steps);
    let difference = compared(&ComparedTable::of(&fine), &ComparedTable::of(&coarse)).expect("they nest");
    assert!(difference.errors_are_bounds && difference.figures.l1_difference.is_none());
}

/// A table over relative azimuths next to one at absolute azimuths of the light: its bins turn with the light.
#[test]
fn an_isotropic_table_has_every_azimuth() {
    let absolute =
        SMITH.replace("[light]\n", "[light]\nphi_i_deg = [0, 8]\n").replace("seed = 1", "seed = 2");
    let (relative, absolute) = (measured_one(SMITH), measured_one(&absolute));
    let difference = compared(&side(&relative), &side(&absolute)).expect("turned by two bins");
    assert_eq!(difference.incidences.len(), 6);
    assert!(
        difference.made_comparable[0].starts_with("A takes every azimuth"),
        "{:?}",
        difference.made_comparable
    );
    assert!(!difference.interpolated && difference.disagreement().is_none(), "{difference:?}");
    // By half a bin nothing nests.
    let turned = measured_one(
        &fine().replace("[light]\n", "[light]\nphi_i_deg = [1]\n").replace("[0, 40, 70]", "[40]"),
    );
    assert!(compared(&side(&relative), &side(&turned)).expect("interpolated").interpolated);
}

#[test]
fn what_has_nothing_in_common_is_refused() {
    let at = |theta: f64| Grid { theta_i_deg: vec![theta], ..hemisphere(10.0, 30.0) };
    let arm = |theta: f64| Grid {
        kind: GridKind::Points,
        theta_i_deg: vec![30.0],
        phi_i_deg: vec![0.0],
        points_deg: vec![[theta, 0.0]],
        ..Grid::default()
    };
    let table = |grid: Grid| {
        let values = vec![1.0; grid.bins()];
        foreign_table(grid, vec![values]).expect("a table")
    };
    let refused = |a: Grid, b: Grid| {
        let (a, b) = (table(a), table(b));
        compared(&ComparedTable::of(&a), &ComparedTable::of(&b)).expect_err("nothing in common").to_string()
    };
    let why = refused(at(30.0), at(40.0));
    assert!(why.contains("no incidence in common") && why.contains("30 to 30"), "{why}");
    let why = refused(arm(10.0), arm(20.0));
    assert!(why.contains("no direction in common"), "{why}");
}

#[test]
fn the_command_says_what_it_did_and_takes_many_tables() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let save = |name: &str, table: &BrdfTable| store::save(&folder.path().join(name), table).expect("saved");
    let with_errors = |grid: Grid, scales: &[f32]| {
        let mut table = analytic(grid, scales);
        table.colours.iter_mut().for_each(|colour| colour.stderr.fill(1e-3));
        table
    };
    save("fine.exr", &with_errors(hemisphere(5.0, 15.0), &[1.0]));
    save("coarse.exr", &with_errors(hemisphere(10.0, 30.0), &[1.0]));
    save("colour.exr", &with_errors(hemisphere(10.0, 30.0), &[0.9, 0.6, 0.2]));
    let run = |words: &[&str]| gonio(folder.path(), words);
    let said = program::stdout(&run(&["compare", "fine.exr", "coarse.exr"]));
    assert!(said.contains("A's bins (5 x 15 degrees) averaged to 10 x 30 degrees"), "{said}");
    assert!(said.contains("upper bounds"), "{said}");
    let json = program::json(&run(&["compare", "fine.exr", "coarse.exr", "--json"]));
    assert!(json["made_comparable"][0].as_str().is_some_and(|step| step.contains("averaged")), "{json}");
    assert_eq!(
        (&json["errors_are_bounds"], &json["interpolated"]),
        (&Value::Bool(true), &Value::Bool(false))
    );
    let many = run(&["compare", "fine.exr", "coarse.exr", "colour.exr"]);
    let text = String::from_utf8_lossy(&many.stdout).into_owned();
    assert!(exits(&many, 1).contains("1 of 2 tables differ from A"), "{text}");
    for words in ["coarse.exr", "differs", "colour.exr: B has R, G, B and A one channel"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let many = run(&["compare", "fine.exr", "coarse.exr", "colour.exr", "--json"]);
    let json: Value = serde_json::from_slice(&many.stdout).expect("JSON");
    assert_eq!(json["tables"][1]["file"], "colour.exr");
    assert!(json["tables"][0]["disagreement"].is_null() && json["tables"][1]["disagreement"].is_string());
    assert!(
        exits(&run(&["compare", "fine.exr", "coarse.exr", "colour.exr", "--richardson"]), 2)
            .contains("two tables")
    );
}
