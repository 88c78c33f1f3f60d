//! Promise: every file of an albedo table holds the table: NumPy's, text, images, and constants that a C compiler takes.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::Command;

use gonio::files::image;
use gonio::files::npy::{self, NpyValues};
use serde_json::Value;

use crate::support::campaign_text::SMALL;
use crate::support::outputs::digests;
use crate::support::program::{done, exits, folder, gonio, json};

const FILES: [&str; 4] = ["t.npz", "t.csv", "t.exr", "t.h"];
const GRID: [&str; 9] = ["albedo", "--grid", "--mu", "3", "--alpha", "0.1,0.5", "--eta", "1.5,2", "--json"];

/// Runs the words with all files.
fn with_files(folder: &Path, words: &[&str]) -> Value {
    let files = FILES.iter().flat_map(|file| ["-o", *file]);
    let words: Vec<&str> = words.iter().copied().chain(files).collect();
    let output = gonio(folder, &words);
    exits(&output, 0);
    json(&output)
}

/// Values of a quantity or of its averages (`cells`, `averages`), with errors: -1 where there is none.
fn values(answer: &Value, quantity: usize, part: &str) -> Vec<[f64; 2]> {
    let cells = answer["quantities"][quantity][part].as_array().expect("cells");
    cells
        .iter()
        .map(|cell| [cell["value"].as_f64().expect("a value"), cell["error"].as_f64().unwrap_or(-1.0)])
        .collect()
}

fn names(answer: &Value) -> Vec<String> {
    let all = answer["quantities"].as_array().expect("quantities");
    all.iter().map(|quantity| quantity["name"].as_str().expect("a name").to_string()).collect()
}

#[test]
fn every_file_holds_the_table() {
    let folder = folder(SMALL);
    let answer = with_files(folder.path(), &GRID);
    assert_eq!(names(&answer).len(), 6);
    npz_holds(&folder.path().join("t.npz"), &answer);
    csv_holds(&folder.path().join("t.csv"), &answer);
    exr_holds(&folder.path().join("t.exr"), &answer);
    header_holds(folder.path(), &answer);
}

fn npz_holds(path: &Path, answer: &Value) {
    let mut zip = zip::ZipArchive::new(fs::File::open(path).expect("there")).expect("a zip");
    let mut array = |name: &str| {
        let mut bytes = Vec::new();
        zip.by_name(&format!("{name}.npy")).expect(name).read_to_end(&mut bytes).expect("read");
        npy::decode(&bytes).expect("an array")
    };
    let floats = |values: NpyValues| match values {
        NpyValues::F64(values) => values,
        _ => panic!("f8"),
    };
    for (k, name) in names(answer).iter().enumerate() {
        for (end, part, shape) in [("", "cells", vec![2, 2, 3]), ("_avg", "averages", vec![2, 2])] {
            let found = [array(&format!("{name}{end}")), array(&format!("{name}{end}_error"))];
            assert!(found.iter().all(|array| array.shape == shape));
            let found = found.map(|array| floats(array.values));
            let expected = values(answer, k, part);
            // Bit for bit.
            assert!(
                (0..2).all(|e| expected.iter().map(|pair| pair[e]).eq(found[e].iter().copied())),
                "{name}{end}"
            );
        }
    }
    assert_eq!(floats(array("mu").values), [1.0 / 6.0, 0.5, 2.5 / 3.0]);
    assert_eq!(
        (floats(array("alpha").values), floats(array("eta").values)),
        (vec![0.1, 0.5], vec![1.5, 2.0])
    );
    for name in ["convention", "errors", "digest"] {
        let NpyValues::Text(text) = array(name).values else { panic!("a text") };
        assert_eq!(answer["texts"][name], text[0]);
    }
}

fn csv_holds(path: &Path, answer: &Value) {
    let text = fs::read_to_string(path).expect("there");
    assert!(text.contains(&format!("# digest: {}", answer["texts"]["digest"].as_str().expect("a digest"))));
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).expect("there");
    let rows: Vec<BTreeMap<String, f64>> = reader.deserialize().map(|row| row.expect("numbers")).collect();
    assert_eq!(rows.len(), 12);
    for (k, name) in names(answer).iter().enumerate() {
        let (cells, averages) = (values(answer, k, "cells"), values(answer, k, "averages"));
        for (cell, row) in rows.iter().enumerate() {
            let ends = ["", "_error", "_avg", "_avg_error"].map(|end| row[&format!("{name}{end}")]);
            assert_eq!(ends, [cells[cell][0], cells[cell][1], averages[cell / 3][0], averages[cell / 3][1]]);
        }
    }
    assert_eq!([rows[7]["eta"], rows[7]["alpha"], rows[7]["mu"]], [2.0, 0.1, 0.5]);
}

fn exr_holds(path: &Path, answer: &Value) {
    let mut parts = image::load(path).expect("an image");
    assert_eq!(parts.len(), 12);
    assert_eq!(parts[0].text("gonio.alpha"), Some("0.1, 0.5"));
    assert_eq!(parts[0].text("gonio.digest"), answer["texts"]["digest"].as_str());
    for (k, name) in names(answer).iter().enumerate() {
        for slab in 0..2 {
            let part = &mut parts[slab * 6 + k];
            assert_eq!((part.text("gonio.quantity"), part.width, part.height), (Some(name.as_str()), 3, 2));
            let channels = ["Y", "error", "average"].map(|channel| part.take_floats(channel).expect(channel));
            let (cells, averages) = (values(answer, k, "cells"), values(answer, k, "averages"));
            for pixel in 0..6 {
                let wanted = [
                    cells[6 * slab + pixel][0],
                    cells[6 * slab + pixel][1],
                    averages[2 * slab + pixel / 3][0],
                ];
                // The nearest f32.
                assert_eq!(
                    channels.each_ref().map(|channel| channel[pixel]),
                    wanted.map(|value| value as f32),
                    "{name}"
                );
            }
        }
    }
}

/// At nodes, between them and beyond.
const PLACES: [[f64; 3]; 4] = [[1.5, 0.1, 0.5], [1.75, 0.3, 0.4], [3.0, 1.0, 1.0], [1.0, 0.01, 0.01]];

fn header_holds(folder: &Path, answer: &Value) {
    let call = |[eta, alpha, mu]: [f64; 3]| {
        format!(
            "    printf(\"%.9g %.9g\\n\", (double)t_lookup(t_T_inside, {eta:?}f, {alpha:?}f, {mu:?}f),\n\
             \x20       (double)t_lookup_avg(t_R_outside_avg, {eta:?}f, {alpha:?}f));\n"
        )
    };
    let calls: String = PLACES.into_iter().map(call).collect();
    let program =
        format!("#include <stdio.h>\n#include \"t.h\"\nint main(void)\n{{\n{calls}    return 0;\n}}\n");
    fs::write(folder.join("main.c"), &program).expect("written");
    fs::write(folder.join("main.cpp"), &program).expect("written");
    let (inside, outside) = (values(answer, 4, "cells"), values(answer, 0, "averages"));
    for (compiler, standard, source) in [("cc", "-std=c99", "main.c"), ("c++", "-std=c++11", "main.cpp")] {
        let words = [standard, "-Wall", "-Wextra", "-pedantic", "-Werror", source, "-o", "main"];
        let Ok(compiled) = Command::new(compiler).args(words).current_dir(folder).output() else {
            println!("no {compiler} here: the header is not compiled");
            continue;
        };
        assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
        let output = Command::new(folder.join("main")).output().expect("runs");
        let text = String::from_utf8(output.stdout).expect("text");
        for (line, [eta, alpha, mu]) in text.lines().zip(PLACES) {
            let found: Vec<f64> = line.split(' ').map(|word| word.parse().expect("a number")).collect();
            let place = |x: f64, nodes: &[f64]| {
                let k = nodes.partition_point(|node| *node <= x).clamp(1, nodes.len() - 1) - 1;
                (k, ((x - nodes[k]) / (nodes[k + 1] - nodes[k])).clamp(0.0, 1.0))
            };
            let (h, r) = place(eta, &[1.5, 2.0]);
            let (i, s) = place(alpha, &[0.1, 0.5]);
            let (j, t) = place(mu, &[1.0 / 6.0, 0.5, 2.5 / 3.0]);
            let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
            let row =
                |h: usize, i: usize| mix(inside[6 * h + 3 * i + j][0], inside[6 * h + 3 * i + j + 1][0], t);
            let slab = |h: usize| mix(row(h, i), row(h, i + 1), s);
            let average = |h: usize| mix(outside[2 * h + i][0], outside[2 * h + i + 1][0], s);
            // Values of f32 and ten operations: 2^-24 each.
            for (found, wanted) in
                found.iter().zip([mix(slab(h), slab(h + 1), r), mix(average(h), average(h + 1), r)])
            {
                assert!((found - wanted).abs() < 1e-6, "{compiler} {eta} {alpha} {mu}: {found} {wanted}");
            }
        }
    }
}

#[test]
fn a_table_has_the_same_bytes_for_any_number_of_threads() {
    // Of clear facets, whose averages cost most: one roughness and one index.
    let runs = [
        &["albedo", "--grid", "--mu", "3", "--alpha", "0.5", "--eta", "1.5", "--json"][..],
        &["albedo", "small.toml", "--mu", "0.5,1", "--json"],
    ];
    for words in runs {
        let [one, two] = ["1", "2"].map(|threads| {
            let folder = folder(SMALL);
            with_files(folder.path(), &[words, &["--threads", threads]].concat());
            FILES.map(|file| fs::read(folder.path().join(file)).expect("there"))
        });
        assert!(one == two, "{words:?}");
    }
}

#[test]
fn files_that_are_there_stay() {
    let folder = folder(SMALL);
    fs::write(folder.path().join("t.csv"), "of somebody").expect("written");
    let before = digests(folder.path());
    let words = ["albedo", "--grid", "--mu", "2", "--alpha", "0.5", "-o", "t.h", "-o", "t.csv"];
    let said = exits(&gonio(folder.path(), &words), 3);
    assert!(said.contains("t.csv: is there already; --force replaces it"), "{said}");
    assert_eq!(digests(folder.path()), before);
    let said = exits(&gonio(folder.path(), &["albedo", "small.toml", "-o", "small.toml", "--force"]), 2);
    assert!(said.contains("must end in .npz, .csv, .exr or .h"), "{said}");
    let text = done(&gonio(folder.path(), &[&words[..], &["--force"]].concat()));
    assert!(text.lines().all(|line| line.chars().count() <= 100) && text.contains("file  t.csv"), "{text}");
}
