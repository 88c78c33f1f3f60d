//! Promise: the page of a table is one file that asks for nothing, follows from the table and its summary alone, and
//! says the same numbers.

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gonio::bench::BenchAnswer;
use gonio::campaign::{self, Campaign};
use gonio::instrument::Grid;
use gonio::instrument::grid::GridKind;
use gonio::report::page;
use gonio::report::plot::plots;
use gonio::report::{IncidenceSummary, Page, Scene, Summary};
use gonio::table::{BrdfTable, ColourChannels};
use gonio::validate::prediction::bin_mean::MASKINGS;
use gonio::validate::prediction::model::{IncidenceMeans, Model};
use gonio::validate::{Prediction, examine_against};
use half::f16;
use serde_json::{Value, json};

use crate::support::campaign_text::SMALL;
use crate::support::program::{done, exits, gonio};

/// Two orders of scattering.
fn small() -> String {
    SMALL.replace("[stop]", "[trace]\nbounces = 2\n[stop]")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The page without the one paragraph that says what the run cost.
fn without_cost(page: &str) -> String {
    let lines: Vec<&str> = page.lines().filter(|line| !line.contains("id=\"cost\"")).collect();
    assert_eq!(lines.len() + 1, page.lines().count(), "the cost is one line");
    lines.join("\n")
}

/// The data that the page's script reads.
pub(crate) fn data_of(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"data\">").expect("data");
    serde_json::from_str(rest.split_once("</script>").expect("an end").0).expect("JSON")
}

/// Numbers of one key in the order of the page.
fn cells(page: &str, table: &str, key: &str) -> Vec<String> {
    let (_, rest) = page.split_once(&format!("<table id=\"{table}\">")).expect("a table");
    let table = rest.split_once("</table>").expect("an end").0;
    let mark = format!("data-key=\"{key}\">");
    table.split(&mark).skip(1).map(|rest| rest.split('<').next().unwrap_or_default().to_string()).collect()
}

#[test]
fn the_page_follows_from_the_table_and_its_summary() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let at = |name: &str| folder.path().join(name);
    fs::write(at("small.toml"), small()).expect("campaign");
    done(&gonio(folder.path(), &["measure", "small.toml", "-o", "one", "--threads", "1"]));
    let text = done(&gonio(folder.path(), &["measure", "small.toml", "-o", "two", "--threads", "2"]));
    let (one, two) = (read(&at("one/small.html")), read(&at("two/small.html")));
    assert_eq!(without_cost(&one), without_cost(&two));
    done(&gonio(folder.path(), &["report", "one/small.exr", "-o", "again.html"]));
    assert!(read(&at("again.html")) == one, "the stored table gives another page than the measured one");
    done(&gonio(folder.path(), &["report", "one/small.exr", "-o", "again.md"]));
    let card = read(&at("one/small.card.md"));
    assert!(read(&at("again.md")) == card, "the stored table gives another card than the measured one");
    let campaign = fs::read_to_string(at("small.toml")).expect("the campaign");
    let name = campaign.lines().find(|line| line.starts_with("name")).expect("a name");
    for wanted in
        [name, "| seed |", "| table SHA-256 |", "| samples |", "| time |", "| quality |", "## What it is not"]
    {
        assert!(card.contains(wanted), "{wanted}: {card}");
    }
    says_the_numbers(&one, &serde_json::from_str(&read(&at("one/small.json"))).expect("JSON"));
    fits_a_terminal(&text);
    // Without its summary the same figures are found anew; the cost is not known.
    fs::remove_file(at("one/small.json")).expect("removed");
    done(&gonio(folder.path(), &["report", "one/small.exr", "-o", "alone.html"]));
    let alone = read(&at("alone.html"));
    for key in ["l1_noise", "l1_model"] {
        assert_eq!(cells(&alone, "comparisons", key), cells(&one, "comparisons", key));
    }
    assert!(alone.contains("which is not next to the table"));
    let same = gonio(folder.path(), &["report", "one/small.exr", "-o", "one/small.exr"]);
    exits(&same, 3);
}

/// What the page prints is the summary's, rounded.
fn says_the_numbers(page: &str, summary: &Value) {
    let rounded =
        |value: &Value, decimals: usize| format!("{:.decimals$}", value.as_f64().expect("a number"));
    for key in ["albedo_single", "albedo_single_se", "albedo_total"] {
        let wanted: Vec<String> =
            (0..2).map(|incidence| rounded(&summary["stops"][incidence][key], 5)).collect();
        assert_eq!(cells(page, "albedos", key), wanted, "{key}");
    }
    let comparisons = summary["comparisons"].as_array().expect("comparisons");
    let of =
        |incidence: usize| comparisons.iter().map(move |c| rounded(&c["stops"][incidence]["l1_model"], 4));
    let means = comparisons.iter().map(|c| rounded(&c["l1_model"], 4));
    assert_eq!(cells(page, "comparisons", "l1_model"), of(0).chain(of(1)).chain(means).collect::<Vec<_>>());
    // Where no masking can be told from the table, none is nearest.
    match summary["nearest_masking"].as_str() {
        Some(nearest) => assert!(page.contains(&format!("{} is nearest", nearest.replace('_', "-")))),
        None => assert!(!page.contains("is nearest")),
    }
}

/// The lobes and the comparison stay within 80 columns.
fn fits_a_terminal(text: &str) {
    let (_, rest) = text.split_once("order 1 against").expect("a comparison");
    let table: Vec<&str> = rest.lines().skip(1).take_while(|line| !line.is_empty()).collect();
    let plot: Vec<&str> = text.lines().filter(|line| line.get(8..10) == Some(" |")).collect();
    assert!(table.len() == 4 && plot.len() >= 18, "{text}");
    for line in table.iter().chain(&plot) {
        assert!(line.chars().count() <= 80, "{line}");
    }
    assert!(text.contains("* measured   - model, height-correlated   + both"), "{text}");
}

/// A table of made-up values that are no round numbers, with a campaign and a prediction of its size.
struct Made {
    table: BrdfTable,
    campaign: Campaign,
    prediction: Prediction,
}

fn made(colours: usize, angles: usize, azimuths: usize, bins: [usize; 2]) -> Made {
    let steps =
        |count: usize, whole: f64| (0..=count).map(|k| whole * k as f64 / count as f64).collect::<Vec<_>>();
    let grid = Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: (0..angles).map(|k| 80.0 * k as f64 / angles as f64).collect(),
        phi_i_deg: (0..azimuths).map(|k| 360.0 * k as f64 / azimuths as f64).collect(),
        phi_r_relative: azimuths == 1,
        theta_r_edges_deg: steps(bins[0], 90.0),
        phi_r_edges_deg: steps(bins[1], 360.0),
        ..Grid::default()
    };
    let (incidences, bins) = (grid.incidences(), grid.bins());
    let value = |seed: usize, k: usize| (1.0 + ((k * 7919 + seed * 104_729) % 9973) as f32).sqrt();
    let channels = |colour: usize| {
        let ramp =
            |seed: usize| (0..incidences * bins).map(|k| value(seed + colour, k)).collect::<Vec<f32>>();
        ColourChannels {
            total: ramp(1),
            single: ramp(1),
            multiple: vec![0.0; incidences * bins],
            stderr: vec![0.01; incidences * bins],
            stderr_single: vec![0.01; incidences * bins],
            ..ColourChannels::default()
        }
    };
    let optics = if colours == 3 { "[optics]\nmaterial = \"gold\"\n" } else { "" };
    let text = format!("{}{optics}", small());
    let campaign = campaign::parse(&text, "c.toml", Path::new("")).expect("sound").campaign;
    let table = BrdfTable {
        grid,
        campaign: text,
        version: "0.0.0".into(),
        seed: 5,
        patch_digest: String::new(),
        colours: (0..colours).map(channels).collect(),
        hits: vec![9; incidences * bins],
        schlick: None,
    };
    let means = |incidence: usize| {
        let bins =
            |seed: usize| (0..bins).map(|k| f64::from(value(seed, incidence * bins + k))).collect::<Vec<_>>();
        IncidenceMeans { values: vec![(0..colours).map(bins).collect(); MASKINGS] }
    };
    let model = Model::of(&campaign).expect("GGX has a model");
    Made { prediction: Prediction { model, means: (0..incidences).map(means).collect() }, table, campaign }
}

/// What a table without a campaign says of itself.
fn summary_of(name: &str, table: &BrdfTable) -> Summary {
    Summary::of_table(name, table, None, None, IncidenceSummary::of_bins(table)).expect("a summary")
}

/// A document of `gonio bench`.
fn bench_of(rows: Value, ladders: Value) -> BenchAnswer {
    let document = json!({ "schema": 1, "name": "b", "seed": 1, "version": "0.0.0", "error_measure": "", "truth": "model",
        "truth_name": "ggx", "rows": rows, "fit": null, "ladders": ladders, "campaign": "" });
    serde_json::from_value(document).expect("a document")
}

/// The page of a made table under a name.
fn page_of(made: &Made, name: &str, benches: &[BenchAnswer]) -> String {
    let Made { table, campaign, prediction } = made;
    let verdict = examine_against(table, campaign, None, Some(prediction));
    let incidences = IncidenceSummary::of_bins(table);
    let summary = Summary::of_table(name, table, Some(&campaign.surface), Some(&verdict), incidences);
    page(&Page {
        scene: Scene { table, prediction: Some(prediction), realisations: 4 },
        whole: &table.grid,
        campaign: Some(campaign),
        masking: Some("direction_correlated"),
        summary: &summary.expect("a summary"),
        best: None,
        specimen: Err("no patch: <none>".into()),
        benches,
        appearance: None,
    })
}

#[test]
fn a_page_asks_for_nothing_and_is_well_formed() {
    let page = page_of(&made(1, 2, 1, [6, 12]), "plain", &[]);
    for word in ["http:", "https:", "src=", "<link", "@import", "url(", "fetch(", "XMLHttp", "import("] {
        assert!(!page.contains(word), "{word}");
    }
    assert!(page.contains("default-src 'none'"), "the page forbids itself to ask");
    let count = |word: &str| page.matches(word).count();
    for element in ["svg", "figure", "table", "section", "script", "canvas", "select", "label", "g"] {
        let opened = count(&format!("<{element} ")) + count(&format!("<{element}>"));
        assert_eq!(opened, count(&format!("</{element}>")), "{element}");
    }
    assert!(!page.contains("{{") && !page.contains("NaN") && !page.contains("inf\""));
    // Two lobes, two ratios, a polar plot, the albedo.
    assert_eq!(count("class=\"chart\""), 6);
}

#[test]
fn names_are_text_wherever_they_stand() {
    let page = page_of(&made(1, 2, 1, [6, 12]), "</script><script>alert(1)</script>&\"'", &[]);
    assert!(!page.contains("alert(1)</script>") && !page.contains("<none>"));
    assert_eq!(data_of(&page)["name"], "</script><script>alert(1)</script>&\"'");
}

#[test]
fn the_inlined_values_are_the_tables_to_half_precision() {
    let made = made(3, 2, 1, [6, 12]);
    let data = data_of(&page_of(&made, "halves", &[]));
    let layers = data["table"]["layers"].as_array().expect("layers");
    let names: Vec<&str> = layers.iter().filter_map(|layer| layer["name"].as_str()).collect();
    let models = ["model, separable", "model, height-correlated", "model, direction-correlated"];
    assert_eq!(names, [&["measured"][..], &models].concat());
    assert_eq!((&data["table"]["scale"], &data["table"]["chosen"]), (&json!(1.0), &json!(models[2])));
    let bytes = STANDARD.decode(layers[0]["data"].as_str().expect("text")).expect("base64");
    let found: Vec<f64> = bytes.chunks_exact(2).map(|b| f16::from_le_bytes([b[0], b[1]]).to_f64()).collect();
    let wanted: Vec<f64> = made.table.colours.iter().flat_map(|c| &c.single).map(|&v| f64::from(v)).collect();
    assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.iter().zip(&wanted) {
        // Half floats have 11 binary digits: half a unit of the last is 2^-11; these values are far from subnormal.
        // A bin's mean over itself alone may differ from its value by a rounding of f64.
        assert!((found - wanted).abs() <= wanted * (2f64.powi(-11) + 1e-15), "{found} {wanted}");
    }
}

#[test]
fn six_incidences_of_90_by_360_bins_stay_below_6_mb() {
    for colours in [1, 3] {
        let page = page_of(&made(colours, 6, 1, [90, 360]), "large", &[]);
        assert!(page.len() < 6_000_000, "{colours} colours: {} bytes", page.len());
        let table = &data_of(&page)["table"];
        assert_eq!(table["theta_edges"].as_array().map(Vec::len), Some(91));
        assert_eq!(table["phi_edges"].as_array().map(Vec::len), Some(361));
        // In colour there is room for one model, and the page says so.
        assert_eq!(page.contains("only the model with direction-correlated masking"), colours == 3);
    }
}

#[test]
fn a_larger_table_is_reduced_and_the_page_says_so() {
    let made = made(3, 6, 12, [45, 180]);
    let page = page_of(&made, "huge", &[]);
    assert!(page.len() < 6_000_000, "{} bytes", page.len());
    let table = &data_of(&page)["table"];
    let edges = |key: &str| table[key].as_array().expect("edges").len() - 1;
    let (rows, columns) = (edges("theta_edges"), edges("phi_edges"));
    assert!(rows * columns < 45 * 180 && page.contains("bins merged into one"));
    assert_eq!((&table["theta_edges"][rows], &table["phi_edges"][columns]), (&json!(90.0), &json!(360.0)));
    // Merged bins hold the flux of all: sum of value times projected solid angle, to half precision.
    let bytes = STANDARD.decode(table["layers"][0]["data"].as_str().expect("text")).expect("base64");
    let edge = |key: &str, k: usize| table[key][k].as_f64().expect("an edge").to_radians();
    let merged: f64 = (0..rows * columns)
        .map(|bin| {
            let (row, column) = (bin / columns, bin % columns);
            let size = 0.5
                * (edge("phi_edges", column + 1) - edge("phi_edges", column))
                * (edge("theta_edges", row + 1).sin().powi(2) - edge("theta_edges", row).sin().powi(2));
            size * f16::from_le_bytes([bytes[2 * bin], bytes[2 * bin + 1]]).to_f64()
        })
        .sum();
    let whole = made.table.colours[0].single.iter().zip(made.table.grid.regions(0));
    let flux: f64 = whole.map(|(&value, region)| f64::from(value) * region.projected_solid_angle()).sum();
    assert!((merged - flux).abs() <= flux * 2f64.powi(-11), "{merged} {flux}");
}

#[test]
fn what_a_table_lacks_is_said() {
    let mut arm = made(1, 2, 1, [1, 2]);
    let grid = &mut arm.table.grid;
    grid.kind = GridKind::Arm;
    (grid.theta_r_deg, grid.phi_r_deg, grid.aperture_deg) = (vec![-30.0, 40.0], vec![180.0], Some(1.0));
    let bare = Page {
        scene: Scene { table: &arm.table, prediction: None, realisations: 0 },
        whole: &arm.table.grid,
        campaign: None,
        masking: None,
        summary: &summary_of("imported", &arm.table),
        best: None,
        specimen: Err("The table holds no campaign.".into()),
        benches: &[bench_of(json!([]), json!([]))],
        appearance: None,
    };
    let text = page(&bare);
    for words in [
        "A table without a campaign; light at theta_i 0, 40 degrees (azimuth relative); 2 positions of a sensor arm, \
         aperture ±1°.",
        "Nothing is known that this table should agree with.",
        "No model speaks of this surface",
        "The table holds no campaign.",
        "too few to make a hemisphere",
        "only the measurement of a surface knows its facets",
        "Error against samples: the bench holds no rung",
        "In-plane lobe, theta_i 40°",
    ] {
        assert!(text.contains(words), "{words}");
    }
    let spots = &data_of(&text)["table"]["spots"];
    // A negative polar angle lies on the other side: azimuth 180 + 180.
    let turned = spots["directions"][0][1].as_f64().expect("an azimuth");
    assert!((turned - 360.0 * (turned / 360.0).round()).abs() < 1e-9, "{spots}");
    assert_eq!((&spots["aperture"], spots["directions"].as_array().map(Vec::len)), (&json!(1.0), Some(2)));
}

/// The page of a table of values from 1 on, on a grid of another kind and without a campaign.
fn page_on(grid: Grid) -> String {
    let count = grid.incidences() * grid.bins();
    let values: Vec<f32> = (0..count).map(|k| 1.0 + k as f32).collect();
    let zero = vec![0.0; count];
    let table = BrdfTable {
        grid,
        campaign: String::new(),
        version: String::new(),
        seed: 0,
        patch_digest: String::new(),
        colours: vec![ColourChannels {
            total: values.clone(),
            single: values,
            multiple: zero,
            stderr: vec![-1.0; count],
            stderr_single: vec![-1.0; count],
            ..ColourChannels::default()
        }],
        hits: vec![1; count],
        schlick: None,
    };
    page(&Page {
        scene: Scene { table: &table, prediction: None, realisations: 0 },
        whole: &table.grid,
        campaign: None,
        masking: None,
        summary: &summary_of("other", &table),
        best: None,
        specimen: Err("The table holds no campaign.".into()),
        benches: &[],
        appearance: None,
    })
}

fn values_of(page: &str) -> Vec<f64> {
    let bytes = STANDARD.decode(data_of(page)["table"]["layers"][0]["data"].as_str().expect("text"));
    let halfs = bytes.expect("base64");
    halfs.as_chunks::<2>().0.iter().map(|&half| f16::from_le_bytes(half).to_f64()).collect()
}

#[test]
fn patches_and_points_get_pictures_and_a_viewer() {
    let quarter = |k: u32| [20.0, 90.0, 90.0 * f64::from(k) - 45.0, 90.0 * f64::from(k) + 45.0];
    let patches: Vec<[f64; 4]> =
        [[0.0, 20.0, -180.0, 180.0]].into_iter().chain((0..4).map(quarter)).collect();
    let klems = page_on(Grid {
        kind: GridKind::Patches,
        incidences_deg: vec![[0.0, 0.0], [55.0, 0.0], [55.0, 180.0]],
        patches_deg: patches,
        ..Grid::default()
    });
    let table = &data_of(&klems)["table"];
    assert_eq!((&table["theta_i"], &table["phi_i"]), (&json!([0.0, 55.0]), &json!([0.0, 180.0])));
    // At normal light both azimuths show incidence 0; rows of the pole and of the quarters, columns from 45 degrees on.
    assert_eq!(&values_of(&klems)[..10], [1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 4.0, 4.0, 5.0, 2.0]);
    for words in ["light at theta_i 0, 55 degrees in 3 directions; 5 patches", "Polar plot", "Albedo against"]
    {
        assert!(klems.contains(words), "{words}");
    }
    let ring = |t: f64| (0..8).map(move |k| [t, 45.0 * f64::from(k)]);
    let points = page_on(Grid {
        kind: GridKind::Points,
        theta_i_deg: vec![10.0],
        phi_i_deg: vec![0.0],
        points_deg: [0.0, 30.0, 60.0].into_iter().flat_map(ring).collect(),
        ..Grid::default()
    });
    assert_eq!(data_of(&points)["table"]["theta_nodes"], json!([0.0, 30.0, 60.0]));
    assert_eq!(values_of(&points), (1..=24).map(f64::from).collect::<Vec<_>>());
    assert!(
        points.contains("24 single directions of the sensor")
            && points.contains("In-plane lobe, theta_i 10°")
    );
}

#[test]
fn a_run_that_looks_at_its_error_is_plotted_against_samples_with_its_masking() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let at = |name: &str| folder.path().join(name);
    let text = small().replace("samples = 65_536", "samples = 262_144\nrelative_error = 1e-4");
    fs::write(at("small.toml"), text).expect("campaign");
    done(&gonio(folder.path(), &["measure", "small.toml", "-o", "out"]));
    let summary: Value = serde_json::from_str(&read(&at("out/small.json"))).expect("JSON");
    let incidence = &summary["stops"][1];
    let looked: Vec<u64> = incidence["looks"]
        .as_array()
        .expect("looks")
        .iter()
        .filter_map(|look| look["samples"].as_u64())
        .collect();
    assert!(looked.len() > 1 && looked.iter().enumerate().all(|(k, &n)| n == 65_536 << k), "{looked:?}");
    // The last look is the error at which the incidence ended, and all starts are in the classes.
    assert_eq!(incidence["looks"][looked.len() - 1]["relative_error"], incidence["relative_error"]);
    let classes = incidence["seen_by_slope"].as_array().expect("classes");
    let starts: u64 = classes.iter().filter_map(|class| class["starts"].as_u64()).sum();
    assert_eq!(starts, 4 * incidence["samples"].as_u64().expect("samples"));
    let page = read(&at("out/small.html"));
    for words in [
        "Error against samples, as the run looked at it",
        "Masking given the normal: facets",
        "Smith&#39;s G1",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn the_answer_of_a_bench_is_plotted_as_it_is() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let at = |name: &str| folder.path().join(name);
    fs::write(at("small.toml"), small().replace("bounces = 2", "bounces = 1")).expect("campaign");
    done(&gonio(folder.path(), &["measure", "small.toml", "-o", "out"]));
    let rungs = [
        "bench",
        "small.toml",
        "--from",
        "2^8",
        "--to",
        "2^12",
        "--replicates",
        "2",
        "--json",
        "-o",
        "bench",
    ];
    fs::write(at("bench.json"), done(&gonio(folder.path(), &rungs))).expect("an answer");
    done(&gonio(folder.path(), &["report", "out/small.exr", "--bench", "bench.json", "-o", "page.html"]));
    let (page, answer) = (read(&at("page.html")), read(&at("bench.json")));
    let answer: Value = serde_json::from_str(&answer).expect("JSON");
    for ladder in answer["ladders"].as_array().expect("ladders") {
        let slope = ladder["fit"]["slope"].as_f64().expect("a slope");
        assert!(page.contains(&format!(", slope {slope:.3}")), "{ladder}");
    }
    assert!(!page.contains("Error against samples:"), "it is plotted, and the page says that it is not");
}

#[test]
fn the_ladders_of_a_bench_are_plotted() {
    let row = |n: u64, error: f64| {
        json!({ "varies": "samples", "samples": n, "realisations": 1, "seconds": 1.0, "rays_per_s": 1.0,
            "error": error, "efficiency": 1.0, "errors": [error], "closure": null })
    };
    let fit = json!({ "a": 4.0, "a_low": 3.0, "a_high": 5.0, "b": 0.01, "b_low": 0.0, "b_high": 0.02,
        "slope": -0.47, "slope_se": 0.01 });
    let bench =
        bench_of(json!([row(100, 0.2), row(10_000, 0.022)]), json!([{ "varies": "samples", "fit": fit }]));
    let page = page_of(&made(1, 2, 1, [6, 12]), "bench", std::slice::from_ref(&bench));
    assert!(page.contains("Error: more samples in each, slope -0.470"));
    // The figures stand last; several benches share a plot.
    assert!(page.find("slope -0.470") < page.find("id=\"comparisons\""));
    assert!(!page.contains("Distance from the formula"));
    let two = page_of(&made(1, 2, 1, [6, 12]), "bench", &[bench.clone(), bench]);
    let drawn = |line: &&str| line.contains("<text") && line.contains("b within [0, 2.0e-2]");
    assert_eq!(two.lines().filter(drawn).count(), 2);
    assert!(two.find("Distance from the formula") < two.find("slope -0.470"));
}

/// Of constants 0.3, 0.6 and 0.9 over a hemisphere, whose projected solid angles add up to pi.
#[test]
fn albedos_of_colours_are_means_in_measurement_and_model() {
    let mut made = made(3, 2, 1, [6, 12]);
    for incidence in &mut made.prediction.means {
        for (colour, means) in incidence.values[0].iter_mut().enumerate() {
            means.fill(0.3 * (colour + 1) as f64);
        }
    }
    let scene = Scene { table: &made.table, prediction: Some(&made.prediction), realisations: 4 };
    let albedo = scene.model_albedo(0, 1).expect("a model");
    assert!((albedo - 0.6 * std::f64::consts::PI).abs() < 1e-12, "{albedo}");
}

#[test]
fn bars_of_the_albedo_are_intervals_of_95_percent() {
    let made = made(1, 2, 1, [6, 12]);
    let scene = Scene { table: &made.table, prediction: None, realisations: 4 };
    let incidence = IncidenceSummary {
        albedo_single: Some(0.9),
        albedo_single_se: Some(0.001),
        ..IncidenceSummary::default()
    };
    let chart = plots::albedo(&scene, &[incidence.clone(), incidence], &plots::shown_sweeps(&scene)[0])
        .expect("a chart");
    assert_eq!(chart.series[0].error.len(), 2);
    // Student's t of 3 degrees of freedom is 3.1824 in tables; to their last digit.
    assert!(chart.series[0].error.iter().all(|bar| (bar / 0.001 - 3.1824).abs() < 5e-5), "{chart:?}");
}
