//! Promise: MERL files have the layout that their readers expect, and the values of the table.

use std::sync::OnceLock;

use gonio::instrument::{Grid, GridKind};
use gonio::interchange::content::half_difference;
use gonio::interchange::content::half_difference::HalfDifference;
use gonio::interchange::merl::{self, Sampling};
use gonio::interchange::{self, Brdf, Format, Lookup, Options};
use gonio::sphere;
use gonio::table::{BrdfTable, store};

use super::interchange_albedo::albedo;
use crate::support::analytic::{Ggx, hemisphere, l1, steps, table};
use crate::support::mutations;
use crate::support::program::{exits, gonio, json};

/// The file of alpha 0.1 itself: a formula takes a tenth of the time of a table between its bins.
fn tenth() -> &'static [u8] {
    static TENTH: OnceLock<Vec<u8>> = OnceLock::new();
    TENTH.get_or_init(|| merl::write(&Ggx::new(0.1, 0.1), Sampling::Node))
}

/// A table of it under incidences of 15 degrees.
fn table_of_a_tenth(rows: usize, columns: usize) -> BrdfTable {
    table(&Ggx::new(0.1, 0.1), &hemisphere(steps(15.0, 6), None, rows, columns))
}

/// The value of a raw index as the layout says it, colour after colour.
fn raw(bytes: &[u8], c: usize, ih: usize, id: usize, ip: usize) -> f64 {
    let at = 12 + 8 * (c * 1_458_000 + (ih * 90 + id) * 180 + ip);
    f64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes"))
}

#[test]
fn every_cell_lies_where_the_layout_says() {
    let bytes = tenth();
    assert_eq!(bytes.len(), 34_992_012);
    assert_eq!(bytes[..12], [90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0]);
    // theta_h = 0: light and sensor at theta_d on both sides of the normal, whatever phi_d.
    let ggx = Ggx::new(0.1, 0.1);
    let (wi, wo) = (sphere::direction_deg(30.0, 0.0), sphere::direction_deg(30.0, 180.0));
    let mirror = ggx.brdf(wi, wo)[0];
    for (c, scale) in [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0].into_iter().enumerate() {
        for ip in [0, 57, 179] {
            let value = raw(bytes, c, 0, 30, ip) * scale;
            assert!((value / mirror - 1.0).abs() < 1e-3, "{value} {mirror}");
        }
    }
    // theta_h = 90 (12/90)^2 = 1.6 degrees, theta_d = 0: light and sensor together at 1.6 degrees.
    let both = sphere::direction_deg(1.6, 0.0);
    assert!((raw(bytes, 0, 12, 0, 44) / 1500.0 / ggx.brdf(both, both)[0] - 1.0).abs() < 1e-3);
    // theta_h = 45.5 degrees with theta_d = 60 in the plane of the half vector (phi_d 0): one arm at 105 degrees.
    assert_eq!(raw(bytes, 0, 64, 60, 0), -1.0);
}

/// L1 of a file of alpha 0.1 against the formula, light off the incidences, sensor up to 80 degrees.
fn off_at_alpha_a_tenth(found: &dyn Brdf) -> f64 {
    let light: Vec<(f64, f64)> = [0.0, 14.0, 31.0, 44.0, 61.0, 73.0].map(|t| (t, 0.0)).to_vec();
    l1(found, &Ggx::new(0.1, 0.1), &light, 80.0)
}

fn function(table: &BrdfTable) -> HalfDifference {
    HalfDifference::new(table).expect("cells")
}

#[test]
fn a_reader_that_interpolates_is_within_five_thousandths() {
    let found = merl::read(tenth(), Sampling::Node).expect("sound");
    let invalid = found.gaps() as f64 / found.hits.len() as f64;
    assert!((0.2..0.3).contains(&invalid), "a quarter of the cells is below the horizon: {invalid}");
    let off = off_at_alpha_a_tenth(&function(&found));
    // Bins of 2 degrees of azimuth are the limit, not the file: at theta_i 73 degrees the lobe's azimuth has a half-width
    // of 2 alpha/tan(73) = 3.5 degrees. A file is linear in its function: that of the table is off by both together at most.
    let of_table = off_at_alpha_a_tenth(&Lookup::new(&table_of_a_tenth(90, 180)).expect("a product"));
    assert!(off + of_table <= 0.005, "{off} {of_table}");
    let centre = merl::read(&merl::write(&Ggx::new(0.1, 0.1), Sampling::Centre), Sampling::Centre);
    let off = off_at_alpha_a_tenth(&function(&centre.expect("sound")));
    // As dense as the nodes, but theta_d and phi_d hold their value over the first half cell.
    assert!(off + of_table <= 0.006, "{off} {of_table}");
}

#[test]
fn of_a_table_that_holds_the_lobe_it_is_within_three_thousandths() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("tenth.binary");
    // Bins of 1.5 x 1 degrees.
    let own = table_of_a_tenth(60, 360);
    let written = interchange::export(&own, Format::Merl, &Options::default(), &path).expect("written");
    let found = merl::read(&std::fs::read(&path).expect("there"), Sampling::Node).expect("sound");
    let (found, lookup) = (function(&found), Lookup::new(&own).expect("a product"));
    let (off, of_table) = (off_at_alpha_a_tenth(&found), off_at_alpha_a_tenth(&lookup));
    // The bar of the issue. Straight lines between values of the formula alone are off by 0.0024 here, on one side; with
    // values that keep the means, by 0.0009 (both by NumPy, without this program). The rest is the table between its bins.
    assert!(off <= 0.003, "{off}; of the interpolated table alone {of_table}");
    // The means over its bins, by the same bar.
    let l1 = written.read_back.expect("light").l1;
    assert!(l1 > 0.0 && l1 <= 0.003, "{l1}");
    // The light of the table, between its incidences too: the bar of the issue, and 0.1 % of the rule.
    for theta_i in [10.0, 40.0, 72.0] {
        let [found, wanted]: [f64; 2] =
            [&found as &dyn Brdf, &lookup].map(|brdf| albedo(brdf, theta_i, 10.0));
        assert!((found / wanted - 1.0).abs() <= 0.011, "{theta_i}: {found} {wanted}");
    }
}

#[test]
fn arms_and_half_difference_angles_agree() {
    let angles = [
        [10.0, 0.0, 20.0, 30.0],
        [0.4, 77.0, 44.5, 100.5],
        [40.0, 350.0, 10.0, 179.0],
        [6.0, 200.0, 30.0, 0.5],
    ];
    for [theta_h, phi_h, theta_d, phi_d] in angles {
        let grid = Grid {
            kind: GridKind::HalfDifference,
            theta_h_deg: vec![theta_h],
            phi_h_deg: vec![phi_h],
            theta_d_deg: vec![theta_d],
            phi_d_deg: vec![phi_d],
            ..Grid::default()
        };
        let (wi, wo) = grid.arms_of_half(0, 0);
        for found in [half_difference::angles_deg(wi, wo), half_difference::angles_deg(wo, wi)] {
            let wanted = [theta_h, phi_h, theta_d, phi_d];
            // Angles to a few ulp of 360; the azimuths of small polar angles lose a factor 1/sin(0.4) = 140.
            assert!(found.iter().zip(wanted).all(|(f, w)| (f - w).abs() < 1e-10), "{found:?} {wanted:?}");
        }
    }
}

#[test]
fn the_cells_of_a_file_are_a_table() {
    let bytes = merl::write(&Ggx::new(0.3, 0.3), Sampling::Node);
    let folder = tempfile::tempdir().expect("folder");
    let [file, exr, again] = ["f.binary", "f.exr", "again.binary"].map(|name| folder.path().join(name));
    std::fs::write(&file, &bytes).expect("written");
    let (table, _) = interchange::import(&file, Format::Merl, &Options::default(), None).expect("read");
    assert_eq!(
        (table.grid.kind, table.grid.incidences(), table.grid.bins()),
        (GridKind::HalfDifference, 90, 16_200)
    );
    // Written again, every cell has its value to f32, and the same cells are marked.
    let export = interchange::export(&table, Format::Merl, &Options::default(), &again).expect("written");
    assert_eq!(export.read_back.expect("not zero").l1, 0.0);
    let back = merl::read(&std::fs::read(&again).expect("there"), Sampling::Node).expect("sound");
    assert!(back == table);
    // A table's file holds such cells; fewer of them show it.
    let few = half_difference_table();
    store::save(&exr, &few).expect("saved");
    let stored = store::load(&exr).expect("loaded").table;
    assert!(stored == few);
    // As incidences and bins it is the function that the cells are.
    let arms = half_difference::as_arms(&stored, None).expect("a function").expect("not yet arms");
    assert_eq!((arms.grid.kind, arms.grid.incidences()), (GridKind::Hemisphere, 18));
    let (brdf, wi, region) =
        (HalfDifference::new(&stored).expect("cells"), arms.grid.wi(6), arms.grid.regions(6)[900]);
    let wanted = interchange::resample::mean(&brdf, wi, &region)[0];
    assert_eq!(arms.colours[0].total[6 * arms.grid.bins() + 900], wanted as f32);
    // And goes out in other formats as such.
    let out = folder.path().join("f.csv");
    let export = interchange::export(&stored, Format::Csv, &Options::default(), &out).expect("written");
    assert!(export.notes.iter().any(|note| note.contains("half/difference")), "{:?}", export.notes);
    assert_eq!(export.read_back.expect("not zero").l1, 0.0);
}

/// A table of half/difference angles of GGX, alpha 0.4.
fn half_difference_table() -> BrdfTable {
    let grid = Grid {
        kind: GridKind::HalfDifference,
        theta_h_deg: (0..40).map(|k| 89.0 * f64::from(k * k) / 1521.0).collect(),
        phi_h_deg: vec![0.0],
        theta_d_deg: steps(3.0, 30),
        phi_d_deg: steps(10.0, 18),
        ..Grid::default()
    };
    let (ggx, bins) = (Ggx::new(0.4, 0.4), grid.bins());
    let pair =
        |k: usize| Some(grid.arms_of_half(k / bins, k % bins)).filter(|(wi, wo)| wi.z > 0.0 && wo.z > 0.0);
    let values: Vec<Option<f32>> =
        (0..grid.incidences() * bins).map(|k| pair(k).map(|(wi, wo)| ggx.brdf(wi, wo)[0] as f32)).collect();
    let total = values.iter().map(|value| value.unwrap_or(0.0)).collect();
    let hits = values.iter().map(|value| u32::from(value.is_some())).collect();
    BrdfTable { hits, ..interchange::foreign_table(grid, vec![total]).expect("sound") }
}

#[test]
fn every_verb_takes_half_difference_angles() {
    let folder = tempfile::tempdir().expect("folder");
    let here = folder.path();
    store::save(&here.join("half.exr"), &half_difference_table()).expect("saved");
    let gonio = |words: &[&str]| gonio(here, words);
    for words in [
        vec!["validate", "half.exr"],
        vec!["compare", "half.exr", "half.exr"],
        vec!["fit", "half.exr", "--model", "ggx"],
        vec!["report", "half.exr", "-o", "half.html"],
        vec!["export", "half.exr", "--to", "npz", "-o", "half.npz"],
        vec!["import", "half.npz", "--from", "npz", "-o", "again.exr"],
    ] {
        let err = exits(&gonio(&words), 0);
        assert!(["export", "import"].contains(&words[0]) || err.contains("half/difference angles"), "{err}");
    }
    let [half, again] =
        ["half.exr", "again.exr"].map(|name| store::load(&here.join(name)).expect("stored").table);
    assert!(half.colours == again.colours && half.grid == again.grid && half.hits == again.hits);
    // Against a table of incidences and bins it is seen at those.
    let arms = hemisphere(steps(20.0, 4), None, 30, 36);
    store::save(&here.join("arms.exr"), &table(&Ggx::new(0.4, 0.4), &arms)).expect("saved");
    let compared = gonio(&["compare", "half.exr", "arms.exr", "--json"]);
    // They differ by an interpolation, and neither has errors to explain it.
    let err = exits(&compared, 1);
    assert!(err.contains("no errors are known"), "{err}");
    let l1 = json(&compared)["l1"].as_f64().expect("a number");
    // Straight lines over steps of 3 degrees of theta_d and up to 4 of theta_h, of a lobe of 20.
    assert!(l1 < 0.02, "{l1}");
    let refused = gonio(&["import", "half.npz", "--from", "npz", "-o", "x.exr", "--like", "half.exr"]);
    let err = exits(&refused, 3);
    assert!(err.contains("--like needs"), "{err}");
}

#[test]
fn grids_of_half_and_difference_angles_are_checked() {
    let grid = merl::grid(Sampling::Node);
    assert_eq!(gonio::table::check_grid(&grid).expect("sound"), (90, 16_200));
    let reason = |change: fn(&mut Grid)| {
        let mut grid = grid.clone();
        change(&mut grid);
        gonio::table::check_grid(&grid).expect_err("refused").to_string()
    };
    assert!(reason(|g| g.theta_h_deg[3] = f64::NAN).contains("theta_h_deg = NaN"));
    assert!(reason(|g| g.phi_d_deg.clear()).contains("phi_d_deg has 0 values"));
    assert!(reason(|g| g.theta_d_deg.swap(0, 1)).contains("does not increase"));
    assert!(reason(|g| g.theta_i_deg.push(1.0)).contains("only one is allowed"));
    assert!(reason(|g| g.phi_h_deg = vec![0.0, 360.0]).contains("already exists"));
}

#[test]
fn damaged_files_are_refused() {
    let reason = |bytes: &[u8]| merl::read(bytes, Sampling::Node).expect_err("must be refused");
    let header: Vec<u8> = [90i32, 90, 180].iter().flat_map(|side| side.to_le_bytes()).collect();
    assert!(reason(b"").to_string().contains("too few"));
    assert!(reason(&[0; 12]).to_string().contains("0 x 0 x 0"));
    assert!(reason(&header).to_string().contains("34992012"));
    let mut whole = [header.clone(), vec![0; 34_992_000]].concat();
    whole[12 + 8 * 7..12 + 8 * 8].copy_from_slice(&f64::NAN.to_le_bytes());
    assert!(reason(&whole).to_string().contains("value 7 is NaN"));
    whole.push(0);
    assert!(reason(&whole).to_string().contains("34992013 bytes"));
    let negative: Vec<u8> = std::iter::repeat_n((-1.0f64).to_le_bytes(), 4_374_000).flatten().collect();
    assert!(reason(&[header.clone(), negative].concat()).to_string().contains("every value"));
    let short = [header, vec![0x3f; 500]].concat();
    assert_eq!(mutations::refused(&short, |bytes| merl::read(bytes, Sampling::Node)), 1.0);
}
