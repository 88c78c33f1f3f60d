//! Promise: a newcomer finds their way: no folder of `src` has more than fourteen files, and no two files import each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use crate::layering::code;

const MOST_FILES: usize = 14;

/// Rust files of `src` by their module path; `main.rs` and `lib.rs` are none.
fn modules() -> BTreeMap<Vec<String>, PathBuf> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut found, mut folders) = (BTreeMap::new(), vec![src.clone()]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("readable") {
            let path = entry.expect("readable").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let relative = path.strip_prefix(&src).expect("below src").with_extension("");
            let mut module: Vec<String> =
                relative.iter().map(|part| part.to_string_lossy().into_owned()).collect();
            module.pop_if(|last| last == "mod");
            if path.extension().is_some_and(|end| end == "rs") && relative.as_os_str() != "lib" {
                found.insert(module, path);
            }
        }
    }
    found
}

/// The program of a file: without comments and its tests.
fn program(path: &Path) -> String {
    code(path).split("#[cfg(test)]").next().unwrap_or_default().to_string()
}

/// What a tree of imports names, each with its whole path: `a::{b, c::d}` names a::b and a::c::d.
fn flat(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some((before, group)) = tree.split_once('{') else { return vec![tree.to_string()] };
    let group = group.strip_suffix('}').unwrap_or(group);
    let (mut depth, mut from, mut names) = (0, 0, Vec::new());
    for (at, c) in group.char_indices().chain([(group.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                names.extend(flat(&group[from..at]).into_iter().map(|name| format!("{before}{name}")));
                from = at + 1;
            }
            _ => {}
        }
    }
    names
}

/// The modules that a file imports from, re-exports left out: `mod.rs` may hand on what its children have.
fn imports(module: &[String], code: &str, all: &BTreeMap<Vec<String>, PathBuf>) -> BTreeSet<Vec<String>> {
    let statements = code.split(';').map(str::trim).filter_map(|statement| {
        let at = statement.rfind("use ").filter(|at| statement[..*at].trim_end().is_empty())?;
        Some(&statement[at + 4..])
    });
    let mut found = BTreeSet::new();
    for name in statements.flat_map(flat) {
        let mut path: Vec<&str> = name.split("::").map(str::trim).collect();
        let mut base: Vec<String> = match path[0] {
            "crate" => Vec::new(),
            "self" => module.to_vec(),
            "super" => module[..module.len().saturating_sub(1)].to_vec(),
            _ => continue,
        };
        path.remove(0);
        while path.first() == Some(&"super") {
            base.pop();
            path.remove(0);
        }
        base.extend(path.into_iter().map(String::from));
        while !base.is_empty() && !all.contains_key(&base) {
            base.pop();
        }
        if !base.is_empty() && base != module {
            found.insert(base);
        }
    }
    found
}

#[test]
fn no_two_files_import_each_other() {
    let all = modules();
    let graph: BTreeMap<_, _> =
        all.iter().map(|(module, path)| (module, imports(module, &program(path), &all))).collect();
    assert!(graph.values().map(BTreeSet::len).sum::<usize>() > 500, "imports are found");
    let circles: Vec<_> = graph
        .iter()
        .flat_map(|(from, targets)| targets.iter().map(move |to| (*from, to)))
        .filter(|(from, to)| from < to && graph[to].contains(*from))
        .collect();
    assert!(circles.is_empty(), "{circles:?}");
}

#[test]
fn no_folder_has_more_files_than_a_screen_shows() {
    let mut counts: BTreeMap<PathBuf, usize> = BTreeMap::new();
    for path in modules().into_values() {
        *counts.entry(path.parent().expect("a folder").to_path_buf()).or_default() += 1;
    }
    let large: Vec<_> = counts.iter().filter(|(_, count)| **count > MOST_FILES).collect();
    assert!(counts.len() > 20 && large.is_empty(), "{large:?}");
}

#[test]
fn trees_of_imports_are_read_whole() {
    assert_eq!(
        flat("crate::a::{b, c::{d, e}, f}"),
        ["crate::a::b", "crate::a::c::d", "crate::a::c::e", "crate::a::f"]
    );
    assert_eq!(flat("super::x"), ["super::x"]);
}
