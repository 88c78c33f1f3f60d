//! Promise: a campaign that makes several tables ends in one CSV of all their figures and one page of joint plots, which
//! `gonio report` makes of any tables too; nothing foreign is replaced.

use std::fs;

use gonio::report::Summary;
use gonio::report::sweep::{CSV_MARK, FILL};
use serde_json::Value;

use crate::support::campaign_text::SMALL;
use crate::support::program::{exits, folder, gonio, stderr, stdout};

/// Three roughnesses by a range.
fn sweep() -> String {
    SMALL.replace("alpha = 0.3", "alpha = { from = 0.1, to = 0.3, step = 0.1 }").replace("65_536", "16_384")
}

/// The cells of a CSV file under their headings.
fn rows(text: &str) -> Vec<Vec<(String, String)>> {
    let mut lines = text.lines().map(|line| line.split(',').map(String::from).collect::<Vec<_>>());
    let head = lines.next().expect("headings");
    lines.map(|line| head.iter().cloned().zip(line).collect()).collect()
}

#[test]
fn a_sweep_has_its_figures_in_one_file() {
    let folder = folder(&sweep());
    let at = folder.path();
    let said = stdout(&gonio(at, &["measure", "small.toml"]));
    assert!(said.contains("small.sweep.csv") && said.contains("small.sweep.html"), "{said}");
    let text = fs::read_to_string(at.join("out/small/small.sweep.csv")).expect("written");
    assert!(text.starts_with(CSV_MARK), "{text}");
    let rows = rows(&text);
    assert_eq!(rows.len(), 3 * 2, "three roughnesses, two angles");
    for (k, alpha) in ["0.1", "0.2", "0.3"].into_iter().enumerate() {
        let json = fs::read(at.join(format!("out/small/small_alpha_{alpha}.json"))).expect("summary");
        let summary: Summary = serde_json::from_slice(&json).expect("a summary");
        for (row, incidence) in rows[2 * k..2 * k + 2].iter().zip(&summary.incidences) {
            let cell = |name: &str| row.iter().find(|(head, _)| head == name).map(|(_, cell)| cell.as_str());
            assert_eq!(
                (cell("table"), cell("alpha_x")),
                (Some(&*format!("small_alpha_{alpha}")), Some(alpha))
            );
            let number = |name: &str| cell(name).and_then(|cell| cell.parse::<f64>().ok());
            assert_eq!(number("theta_i_deg"), Some(incidence.theta_i_deg));
            assert_eq!(number("albedo_total"), incidence.albedo_total);
            assert_eq!(number("albedo_total_se"), incidence.albedo_total_se);
        }
        let own = &summary.comparisons[0];
        let name = format!("l1_model:{}:{}:{}", own.model, own.masking, own.scope);
        let found = rows[2 * k + 1].iter().find(|(head, _)| *head == name).expect("a column");
        assert_eq!(found.1.parse::<f64>().ok(), own.incidences[1].figures.l1_model);
    }
    let page = fs::read_to_string(at.join("out/small/small.sweep.html")).expect("written");
    for word in
        ["Albedo against the roughness", "theta_i 50\u{b0}", "small_alpha_0.2.html", "3 tables side by side"]
    {
        assert!(page.contains(word), "{word}");
    }
    // Made again of the files alone: the same figures.
    let tables = ["0.1", "0.2", "0.3"].map(|alpha| format!("out/small/small_alpha_{alpha}.exr"));
    let words: Vec<&str> = ["report"].into_iter().chain(tables.iter().map(String::as_str)).collect();
    exits(&gonio(at, &[&words[..], &["-o", "again.csv"]].concat()), 0);
    assert_eq!(fs::read_to_string(at.join("again.csv")).expect("written"), text);
    exits(&gonio(at, &[&words[..], &["-o", "again.html"]].concat()), 0);
    exits(&gonio(at, &[&words[..], &["-o", "again.nc"]].concat()), 0);
    let netcdf = fs::read(at.join("out/small/small.sweep.nc")).expect("written");
    let title = |name: &str| netcdf_of(&fs::read(at.join(name)).expect("written")).1;
    assert_eq!(title("again.nc"), netcdf_of(&netcdf).1);
    // All pages show the heights that were there while the first patch was measured: the last one as if it were alone.
    exits(&gonio(at, &["report", &tables[2], "-o", "alone.html"]), 0);
    let page = |name: &str| fs::read_to_string(at.join(name)).expect("written");
    assert!(page("alone.html") == page("out/small/small_alpha_0.3.html"), "another page than the run's");
    let why = gonio(at, &words);
    exits(&why, 2);
    assert!(stderr(&why).contains("-o FILE.html, or FILE.csv or FILE.nc"), "{}", stderr(&why));
}

#[test]
fn nothing_foreign_is_replaced_and_one_table_has_no_sweep() {
    let folder = folder(&sweep());
    let at = folder.path();
    fs::create_dir_all(at.join("out/small")).expect("folder");
    fs::write(at.join("out/small/small.sweep.csv"), "mine").expect("written");
    let refused = gonio(at, &["measure", "small.toml"]);
    exits(&refused, 3);
    assert!(stderr(&refused).contains("small.sweep.csv"), "{}", stderr(&refused));
    assert_eq!(fs::read_to_string(at.join("out/small/small.sweep.csv")).expect("there"), "mine");
    let one = crate::support::program::folder(SMALL);
    exits(&gonio(one.path(), &["measure", "small.toml", "--json"]), 0);
    let names = fs::read_dir(one.path().join("out/small")).expect("a folder");
    assert!(names.flatten().all(|entry| !entry.file_name().to_string_lossy().contains("sweep")));
    let wrong = crate::support::program::folder(&sweep().replace("step = 0.1", "step = 0"));
    let said: Value = Value::String(stderr(&gonio(wrong.path(), &["check", "small.toml"])));
    assert!(said.as_str().is_some_and(|said| said.contains("surface.ggx.alpha.step")), "{said}");
}

/// A variable's values: numbers, or the words of a list of characters.
#[derive(Debug, PartialEq)]
enum Found {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

/// A variable of a NetCDF file: its name, its attributes and its values.
type Variable = (String, Vec<String>, Found);

/// What is read of a NetCDF file.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn word(&mut self) -> usize {
        self.at += 4;
        u32::from_be_bytes(self.bytes[self.at - 4..self.at].try_into().expect("four bytes")) as usize
    }

    fn text(&mut self) -> String {
        let length = self.word();
        let text = String::from_utf8(self.bytes[self.at..self.at + length].to_vec()).expect("UTF-8");
        self.at += length.next_multiple_of(4);
        text
    }

    /// The number of entries of a list with this tag.
    fn list(&mut self, tag: usize) -> usize {
        let (found, count) = (self.word(), self.word());
        assert_eq!(found, if count == 0 { 0 } else { tag });
        count
    }

    fn attributes(&mut self) -> Vec<String> {
        let one = |reader: &mut Self| {
            let name = reader.text();
            match reader.word() {
                2 => format!("{name} {}", reader.text()),
                6 => {
                    assert_eq!(reader.word(), 1);
                    reader.at += 8;
                    name
                }
                other => panic!("type {other}"),
            }
        };
        (0..self.list(12)).map(|_| one(self)).collect()
    }
}

/// The global attributes and the variables of a file of the classic format, with their attributes, read after the NetCDF
/// User's Guide.
fn netcdf_of(bytes: &[u8]) -> (Vec<String>, Vec<Variable>) {
    assert_eq!(&bytes[..4], b"CDF\x01");
    let mut reader = Reader { bytes, at: 4 };
    assert_eq!(reader.word(), 0, "no records");
    let dimensions: Vec<(String, usize)> =
        (0..reader.list(10)).map(|_| (reader.text(), reader.word())).collect();
    let global = reader.attributes();
    let variable = |reader: &mut Reader<'_>| {
        let name = reader.text();
        let shape: Vec<usize> = (0..reader.word()).map(|_| dimensions[reader.word()].1).collect();
        let attributes = reader.attributes();
        let (kind, size, begin) = (reader.word(), reader.word(), reader.word());
        let values = &bytes[begin..begin + size];
        let found = match (kind, &shape[..]) {
            (6, [rows]) => {
                assert_eq!(size, 8 * rows);
                Found::Numbers(
                    values.chunks(8).map(|b| f64::from_be_bytes(b.try_into().expect("eight"))).collect(),
                )
            }
            (2, [rows, width]) => {
                assert_eq!(size, (rows * width).next_multiple_of(4));
                let word = |b: &[u8]| {
                    String::from_utf8(b.to_vec()).expect("UTF-8").trim_end_matches('\0').to_string()
                };
                Found::Texts(values[..rows * width].chunks(*width).map(word).collect())
            }
            other => panic!("{other:?}"),
        };
        (name, attributes, found)
    };
    let variables = (0..reader.list(11)).map(|_| variable(&mut reader)).collect();
    (global, variables)
}

#[test]
fn a_sweep_is_read_back_as_netcdf() {
    let folder = folder(&sweep());
    let at = folder.path().join("out/small");
    exits(&gonio(folder.path(), &["measure", "small.toml", "--json"]), 0);
    let (global, variables) = netcdf_of(&fs::read(at.join("small.sweep.nc")).expect("written"));
    assert!(
        global.contains(&"Conventions CF-1.11".to_string()) && global.contains(&"title small".to_string())
    );
    let rows = rows(&fs::read_to_string(at.join("small.sweep.csv")).expect("written"));
    assert_eq!(variables.len(), rows[0].len());
    for (k, (name, attributes, found)) in variables.iter().enumerate() {
        assert_eq!(*name, rows[0][k].0.replace(':', "_"));
        assert!(attributes.iter().any(|one| one.starts_with("long_name ")), "{name}: {attributes:?}");
        let cells: Vec<&str> = rows.iter().map(|row| row[k].1.as_str()).collect();
        match found {
            Found::Texts(texts) => assert_eq!(*texts, cells, "{name}"),
            Found::Numbers(numbers) => {
                let fill = |cell: &&str| if cell.is_empty() { FILL } else { cell.parse().expect("a number") };
                assert_eq!(*numbers, cells.iter().map(fill).collect::<Vec<f64>>(), "{name}");
                assert!(attributes.contains(&"_FillValue".to_string()), "{name}: {attributes:?}");
            }
        }
    }
}

/// 6,000 samples for each of the 168 values of a table: a fit of all models takes less than a tenth of the measuring.
fn with_fits() -> String {
    sweep().replace("16_384", "131_072")
}

#[test]
fn fits_stand_next_to_what_the_campaign_says() {
    let folder = folder(&with_fits());
    let at = folder.path();
    exits(&gonio(at, &["measure", "small.toml", "--json"]), 0);
    let tables = ["0.1", "0.2", "0.3"].map(|alpha| format!("out/small/small_alpha_{alpha}.exr"));
    let words: Vec<&str> = ["report"].into_iter().chain(tables.iter().map(String::as_str)).collect();
    exits(&gonio(at, &[&words[..], &["--fit", "-o", "fits.csv"]].concat()), 0);
    let text = fs::read_to_string(at.join("fits.csv")).expect("written");
    assert_eq!(fs::read_to_string(at.join("out/small/small.sweep.csv")).expect("written"), text);
    let rows = rows(&text);
    for (k, table) in tables.iter().enumerate() {
        let json = crate::support::program::json(&gonio(at, &["fit", table, "--json"]));
        let best = &json["fits"][0];
        let cell =
            |name: &str| rows[2 * k].iter().find(|(head, _)| head == name).map(|(_, cell)| cell.clone());
        let number = |name: &str| cell(name).and_then(|cell| cell.parse::<f64>().ok());
        assert!(cell("fit").expect("a column").starts_with(best["model"].as_str().expect("a name")));
        assert_eq!(number("fit_alpha"), best["parameters"]["alpha"].as_f64());
        assert_eq!(number("fit_alpha_se"), best["standard_errors"]["alpha"].as_f64());
        assert_eq!(number("fit_l1"), best["l1"].as_f64());
    }
    exits(&gonio(at, &[&words[..], &["--fit", "-o", "fits.html"]].concat()), 0);
    let page = fs::read_to_string(at.join("fits.html")).expect("written");
    for word in ["Fitted roughness", "fitted = the campaign", "best fit"] {
        assert!(page.contains(word), "{word}");
    }
    assert!(exits(&gonio(at, &["report", &tables[0], "--fit"]), 2).contains("--fit is for several tables"));
}

#[test]
fn lists_of_seeds_and_correlations_make_runs() {
    let seeds = SMALL.replace("65_536", "4096").replace("seed = 5", "seed = { from = 5, to = 7 }");
    assert_ne!(seeds, SMALL.replace("65_536", "4096"), "{SMALL}");
    let folder = folder(&seeds);
    let at = folder.path();
    let planned = stdout(&gonio(at, &["check", "small.toml"]));
    assert!(planned.contains("3, seed_5 to seed_7") && planned.contains("3 tables"), "{planned}");
    let said = gonio(at, &["measure", "small.toml"]);
    exits(&said, 0);
    assert!(stderr(&said).contains("run 3 of 3: seed_7"), "{}", stderr(&said));
    let rows = rows(&fs::read_to_string(at.join("out/small/small.sweep.csv")).expect("written"));
    let seeds: Vec<&str> = rows
        .iter()
        .map(|row| row.iter().find(|cell| cell.0 == "seed").expect("a column").1.as_str())
        .collect();
    assert_eq!(seeds, ["5", "5", "6", "6", "7", "7"]);
    // A run is what its seed alone gives, whatever the names.
    let alone =
        crate::support::program::folder(&SMALL.replace("65_536", "4096").replace("seed = 5", "seed = 6"));
    exits(&gonio(alone.path(), &["measure", "small.toml", "--json"]), 0);
    let bytes = |path: std::path::PathBuf| fs::read(path).expect("a table");
    assert!(bytes(at.join("out/small/small_seed_6.exr")) == bytes(alone.path().join("out/small/small.exr")));
    // Resumed, nothing is measured again; options of one run are refused.
    assert!(stdout(&gonio(at, &["measure", "small.toml"])).contains("nothing to do"));
    for words in [["--seed", "4"], ["--shard", "1/2"]] {
        let refused = gonio(at, &[&["measure", "small.toml"][..], &words].concat());
        assert!(exits(&refused, 2).contains("3 runs"), "{}", stderr(&refused));
    }
}
