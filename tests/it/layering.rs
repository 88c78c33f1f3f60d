//! Promise: the measuring side never sees the theory, and lower layers never import higher ones.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The measuring side in the order of the data: a layer may import only what stands before it, or itself.
const LAYERS: [&[&str]; 9] = [
    &["error", "lanes", "psd", "rng", "sphere", "stats", "text_decoding", "files"],
    &["campaign"],
    &["surface"],
    &["instrument"],
    &["optics"],
    &["trace"],
    &["table"],
    &["interchange"],
    &["measure"],
];

/// Modules that may import nothing but these.
const NARROW: [(&str, &[&str]); 9] = [
    ("error", &[]),
    ("lanes", &[]),
    ("psd", &[]),
    ("rng", &[]),
    ("sphere", &[]),
    ("stats", &[]),
    ("text_decoding", &[]),
    ("campaign", &["error", "files", "psd", "sphere", "text_decoding"]),
    ("optics", &["sphere"]),
];

const OTHER_SIDE: [&str; 5] = ["theory", "validate", "study", "fit", "bench"];

/// What the ladders of run time against error are built of, and the scenes of the ray kernels.
const UNDER_BENCH: [&str; 10] =
    ["error", "files", "rng", "stats", "campaign", "surface", "trace", "measure", "table", "validate"];

fn rank(module: &str) -> Option<usize> {
    LAYERS.iter().position(|layer| layer.contains(&module))
}

/// All Rust files of a module: `src/name.rs` and everything below `src/name/`. None if it does not exist (yet).
fn sources(module: &str) -> Vec<PathBuf> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files: Vec<PathBuf> = vec![src.join(format!("{module}.rs"))];
    let mut folders = vec![src.join(module)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten() {
            let path = entry.expect("a readable folder").path();
            if path.is_dir() { folders.push(path) } else { files.push(path) }
        }
    }
    files.retain(|path| path.is_file() && path.extension().is_some_and(|end| end == "rs"));
    files
}

/// The text without comments.
pub fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a readable source");
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

fn identifier(text: &str) -> String {
    text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// The modules that follow `crate::`, also in groups: `use crate::{a, b::{c, d}}` names a and b.
fn imports(code: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (at, prefix) in code.match_indices("crate::") {
        let rest = &code[at + prefix.len()..];
        let Some(group) = rest.strip_prefix('{') else {
            found.insert(identifier(rest));
            continue;
        };
        let mut depth = 1;
        found.insert(identifier(group));
        for (k, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => drop(found.insert(identifier(&group[k + 1..]))),
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
    }
    found.remove("");
    found
}

#[test]
fn lower_layers_never_import_higher_ones() {
    let mut faults = vec![];
    for module in LAYERS.concat() {
        for path in sources(module) {
            // Tests inside a file may draw random numbers or angles from where they like; the program may not.
            let code = code(&path);
            let program = code.split("#[cfg(test)]").next().unwrap_or_default();
            for import in imports(program) {
                let narrow = NARROW.iter().find(|(name, _)| *name == module);
                let below = rank(&import).is_some_and(|lower| lower < rank(module).expect("a layer"));
                let base = rank(module) == Some(0) && rank(&import) == Some(0);
                let allowed = import == module
                    || narrow.map_or(below || base, |(_, names)| names.contains(&import.as_str()));
                if !allowed {
                    faults.push(format!("{} imports {import}", path.display()));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_measuring_side_never_names_the_theory() {
    let mut files = 0;
    for module in LAYERS.concat() {
        for path in sources(module) {
            files += 1;
            let code = code(&path);
            for other in OTHER_SIDE {
                // By any road: `crate::theory`, `super::super::theory`, a group, a re-export; tests included.
                let named = imports(&code).contains(other)
                    || code.contains(&format!("{other}::")) && !code.contains(&format!("_{other}::"));
                assert!(!named, "{} names {other}", path.display());
            }
        }
    }
    assert!(files >= 8, "the sources are where this test looks: {files}");
}

#[test]
fn the_theory_never_sees_a_measurement() {
    for path in sources("theory") {
        let code = code(&path);
        let program = code.split("#[cfg(test)]").next().unwrap_or_default();
        for import in imports(program) {
            assert!(
                ["optics", "sphere", "theory"].contains(&import.as_str()),
                "{}: {import}",
                path.display()
            );
        }
    }
}

#[test]
fn the_ladders_rest_on_the_measurement_and_its_validation_alone() {
    let files = sources("bench");
    assert!(!files.is_empty());
    for path in files {
        let code = code(&path);
        let program = code.split("#[cfg(test)]").next().unwrap_or_default();
        for import in imports(program) {
            let allowed = import == "bench" || UNDER_BENCH.contains(&import.as_str());
            assert!(allowed, "{} imports {import}", path.display());
        }
    }
}

#[test]
fn grouped_imports_are_read() {
    let found = imports("use crate::{a::{b, c}, d};\nlet x = crate::e::f();");
    assert_eq!(found.into_iter().collect::<Vec<_>>(), ["a", "d", "e"]);
}
