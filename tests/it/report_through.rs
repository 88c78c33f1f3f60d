//! Promise: where light goes through the surface the page shows both half-spheres as they were measured, says from which side
//! the light comes and how it is refracted, and plots what comes back, what goes through and their sum.

use std::fs;
use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gonio::measure::{self, Patches};
use gonio::report::plot::plots::{shares, shown_sweeps};
use gonio::report::{IncidenceSummary, Scene, Summary};
use gonio::table::{BrdfTable, store};
use gonio::validate::Verdict;
use half::f16;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::report::data_of;
use crate::support::campaign_text::{self, SMALL};
use crate::support::program::{self, done, gonio};

/// The marks of what a page has beyond others where light goes through: the view, the hint, the plot.
const VIEW: &str = "<canvas id=\"refraction\"";
const HINT: &str = "id=\"through-hint\"";
const PLOT: &str = "What comes back (R) and goes through (T)";

/// Clear facets, light and sensor on these sides.
fn clear(surface: &str, light: &str, sensor: &str) -> String {
    let text = SMALL
        .replace("theta_i_deg = [0, 50]", &format!("theta_i_deg = [0, 60]\nside = \"{light}\""))
        .replace("r_bins = 6\nphi_r_bins = 12", &format!("r_bins = 3\nphi_r_bins = 6\nside = \"{sensor}\""))
        .replace("[light]", "[optics]\nfacet = \"dielectric\"\neta = 1.5\n[light]");
    if surface == "rough" { text } else { flat(&text) }
}

/// Measured; the results lie in `out`.
fn measured(surface: &str, light: &str, sensor: &str) -> TempDir {
    let folder = program::folder(&clear(surface, light, sensor));
    done(&gonio(folder.path(), &["measure", "small.toml", "-o", "out"]));
    folder
}

/// The same on a flat interface.
fn flat(text: &str) -> String {
    text.replace("realisations = 4\ncells = 32\ncorrelation_cells = 4.0\n", "realisations = 1\n")
        .replace("[surface.ggx]\nalpha = 0.3", "[surface.mirror]")
}

fn page_of(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(format!("out/{name}.html"))).expect("a page")
}

fn table_of(folder: &TempDir, name: &str) -> BrdfTable {
    store::load(&folder.path().join(format!("out/{name}.exr"))).expect("a table").table
}

fn values_of(table: &Value) -> Vec<f64> {
    let bytes = STANDARD.decode(table["layers"][0]["data"].as_str().expect("text")).expect("base64");
    bytes.chunks_exact(2).map(|b| f16::from_le_bytes([b[0], b[1]]).to_f64()).collect()
}

/// Rough clear facets under light from above and from below, measured once.
static FRONT: LazyLock<TempDir> = LazyLock::new(|| measured("rough", "front", "both"));
static BACK: LazyLock<TempDir> = LazyLock::new(|| measured("rough", "back", "both"));

#[test]
fn both_halves_are_on_the_page_as_they_were_measured() {
    for (name, folder, eta, inside) in [("front", &*FRONT, 1.5, false), ("back", &*BACK, 1.0 / 1.5, true)] {
        let (page, table) = (page_of(folder, "small"), table_of(folder, "small"));
        for mark in [VIEW, HINT, PLOT, "class RefractionView", "id=\"through\""] {
            // The title of a plot is its label as well.
            assert_eq!(page.matches(mark).count(), if mark == PLOT { 2 } else { 1 }, "{name}: {mark}");
        }
        let data = data_of(&page);
        assert_eq!(data["interface"]["inside"], json!(inside));
        let found = data["interface"]["eta"].as_f64().expect("an index");
        // A quotient of two numbers of 53 digits.
        assert!((found - eta).abs() <= eta * f64::EPSILON, "{found}");
        let columns = table.grid.phi_r_edges_deg.len() - 1;
        let rows = table.grid.theta_r_edges_deg.len() - 1;
        let above = table.grid.theta_r_edges_deg.iter().filter(|&&edge| edge < 90.0).count();
        let single = &table.colours[0].single;
        // The row that lies `k` rows from the pole of its side.
        let row = |incidence: usize, row: usize| {
            single[(incidence * rows + row) * columns..][..columns].iter().map(|&value| f64::from(value))
        };
        let back: Vec<f64> =
            (0..2).flat_map(|incidence| (0..above).flat_map(move |k| row(incidence, k))).collect();
        let through: Vec<f64> =
            (0..2).flat_map(|incidence| (above..rows).rev().flat_map(move |k| row(incidence, k))).collect();
        for (half, wanted) in [("table", back), ("through", through)] {
            let found = values_of(&data[half]);
            assert_eq!(found.len(), wanted.len(), "{name}: {half}");
            assert!(wanted.iter().any(|&value| value > 0.0));
            for (found, wanted) in found.iter().zip(&wanted) {
                // Half floats have 11 binary digits, of which those below 2^-14 lose some: half a unit of 2^-24.
                let tolerance = wanted * (2f64.powi(-11) + 1e-15) + 2f64.powi(-25);
                assert!((found - wanted).abs() <= tolerance, "{name}: {half}: {found} {wanted}");
            }
        }
    }
}

#[test]
fn a_page_has_no_view_of_what_its_table_does_not_hold() {
    let folder = measured("rough", "front", "transmission");
    let page = page_of(&folder, "small");
    let data = data_of(&page);
    assert!(data["table"].is_null() && data["through"]["layers"].is_array());
    assert!(page.contains(VIEW) && page.contains(HINT) && !page.contains(PLOT));
    let clear = SMALL.replace("[light]", "[optics]\nfacet = \"dielectric\"\neta = 1.5\n[light]");
    for (side, text) in [("clear facets, what comes back", &clear[..]), ("mirrors", SMALL)] {
        let folder = program::folder(text);
        done(&gonio(folder.path(), &["measure", "small.toml", "-o", "out"]));
        let page = page_of(&folder, "small");
        let data = data_of(&page);
        assert!(data["table"]["layers"].is_array() && data.get("through").is_none(), "{side}");
        assert!(data.get("interface").is_none(), "{side}");
        for mark in [VIEW, HINT, PLOT, "class RefractionView", "id=\"through\""] {
            assert!(!page.contains(mark), "{side}: {mark}");
        }
    }
}

/// R and T of a flat interface by Fresnel's equations: index 1.5 at 0 and 60 degrees,
/// ((n - 1)/(n + 1))^2 and (r_s^2 + r_p^2)/2 in arithmetic of 20 digits.
const FRESNEL: [f64; 2] = [0.04, 0.089_186_712_802_212_82];

#[test]
fn shares_of_the_light_add_up() {
    // By the library: a page of its own, with the fit of a mirror, is not looked at here.
    let campaign = campaign_text::accepted(&clear("flat", "front", "both")).campaign;
    let plan = measure::plan(&campaign).expect("it fits");
    let patches = Patches::prepare(&campaign, &mut Vec::new()).expect("nothing to load");
    let (tables, cost) = measure::measure(&campaign, &plan, &patches, &|_| ()).expect("measured");
    let summary = Summary::measured(&tables[0], (&plan, &cost), &Verdict::default(), None, String::new());
    let (table, mut incidences) = (&tables[0].table, summary.expect("a summary").incidences);
    let [back, through] = [false, true].map(|below| table.half(below).expect("a half"));
    let scenes = [&back, &through].map(|table| Scene { table, prediction: None, realisations: 4 });
    let sweep = shown_sweeps(&scenes[0]).remove(0);
    let chart = |incidences: &[IncidenceSummary]| {
        shares([&scenes[0], &scenes[1]], incidences, &sweep, 0).expect("a chart")
    };
    let parts: [fn(f64) -> f64; 3] = [|r| r, |r| 1.0 - r, |_| 1.0];
    let series = chart(&incidences).series.split_off(1);
    assert_eq!(series.iter().map(|series| &series.label[..]).collect::<Vec<_>>(), ["R", "T", "R + T"]);
    for (series, part) in series.iter().zip(parts) {
        assert!(series.error.is_empty(), "nothing is known of their errors");
        for ((point, theta), fresnel) in series.points.iter().zip([0.0, 60.0]).zip(FRESNEL) {
            // A few roundings of numbers below 1.
            assert!(
                (point[0] - theta).abs() < 1e-12 && (point[1] - part(fresnel)).abs() < 1e-14,
                "{point:?}"
            );
        }
    }
    for incidence in &mut incidences {
        (incidence.albedo_total_se, incidence.transmittance_total_se) = (Some(0.001), Some(0.002));
    }
    // Student's t for 95 % of 3 degrees of freedom is 3.1824 in tables; of a sum as much as both may have.
    for (series, se) in chart(&incidences).series[1..].iter().zip([0.001, 0.002, 0.003]) {
        assert_eq!(series.error.len(), 2);
        // The table's last digit.
        assert!(series.error.iter().all(|error| (error / se - 3.1824).abs() < 5e-5), "{:?}", series.error);
    }
    // One of them alone makes no sum.
    incidences[1].transmittance_total = None;
    assert!(shares([&scenes[0], &scenes[1]], &incidences, &sweep, 0).is_none());
}

#[test]
fn a_table_with_both_halves_gets_its_page_anew_from_its_file() {
    let folder = &*FRONT;
    done(&gonio(folder.path(), &["report", "out/small.exr", "-o", "again.html"]));
    let again = fs::read_to_string(folder.path().join("again.html")).expect("a page");
    assert!(again == page_of(folder, "small"), "the stored table gives another page than the measured one");
}
