//! Promise: a test that the sources or the documents name is there, under that name.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// What a comment says before the names of the tests that hold what it claims.
const MARKS: [&str; 2] = ["Held by", "Tested by"];
/// Where tests are named, and how a command says which.
const DOCUMENTS: [&str; 6] = ["src", "tests", "docs", "fuzz", ".ci", "benches"];
const PROGRAMS: [&str; 2] = ["it", "process"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All files below a folder whose names end in one of these words, or that have no ending.
fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let (mut found, mut folders) = (vec![], vec![folder.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten() {
            let path = entry.expect("a readable folder").path();
            let ending = path.extension().map(|ending| ending.to_string_lossy().into_owned());
            if path.is_dir() && !path.ends_with("fuzz/target") && !path.ends_with("fuzz/corpus") {
                folders.push(path);
            } else if path.is_file() && ending.is_none_or(|ending| endings.contains(&ending.as_str())) {
                found.push(path);
            }
        }
    }
    found
}

fn text(path: &Path) -> String {
    String::from_utf8_lossy(&fs::read(path).expect("readable")).into_owned()
}

fn word(text: &str, more: &[char]) -> String {
    text.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_' || more.contains(c)).collect()
}

/// Names in backquotes behind a mark, up to the end of the sentence or the comment.
fn claimed(code: &str) -> Vec<String> {
    let mut names = vec![];
    let comment = |line: &&str| line.trim_start().starts_with("//");
    for (at, _) in MARKS.iter().flat_map(|mark| code.match_indices(mark)) {
        let mut lines = code[at..].lines();
        let first = lines.next().unwrap_or_default();
        let rest = lines.take_while(comment).map(|line| line.trim_start().trim_start_matches(['/', '!']));
        let whole = rest.take_while(|line| !line.trim().is_empty() && !line.trim_start().starts_with("- "));
        let whole = [first].into_iter().chain(whole).collect::<Vec<_>>().join(" ");
        let sentence = whole.split_once(". ").map_or(whole.as_str(), |(sentence, _)| sentence);
        let quoted = sentence.split('`').skip(1).step_by(2);
        // A test's name is several words; what it looks at may stand beside it.
        let is_test = |name: &&str| name.contains('_') && word(name, &[]) == **name;
        names.extend(quoted.filter(is_test).filter(|name| **name == name.to_lowercase()).map(String::from));
    }
    names
}

#[test]
fn tests_that_comments_name_are_there() {
    let sources = ["src", "tests"].map(|folder| files(&root().join(folder), &["rs"])).concat();
    let texts: Vec<(PathBuf, String)> = sources.into_iter().map(|path| (path.clone(), text(&path))).collect();
    let functions: BTreeSet<String> = texts
        .iter()
        .flat_map(|(_, code)| {
            code.match_indices("fn ").map(|(at, prefix)| word(&code[at + prefix.len()..], &[]))
        })
        .collect();
    let of_src = texts.iter().filter(|(path, _)| path.starts_with(root().join("src")));
    let claims: Vec<(&PathBuf, String)> =
        of_src.flat_map(|(path, code)| claimed(code).into_iter().map(move |name| (path, name))).collect();
    assert!(claims.len() > 100, "comments are read: {}", claims.len());
    let missing: Vec<String> = claims
        .iter()
        .filter(|(_, name)| !functions.contains(name))
        .map(|(path, name)| format!("{}: no test `{name}`", path.display()))
        .collect();
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn files_and_commands_of_tests_that_documents_name_are_there() {
    let mut documents: Vec<PathBuf> = DOCUMENTS
        .iter()
        .flat_map(|folder| files(&root().join(folder), &["rs", "md", "toml", "py", "mjs"]))
        .collect();
    documents.extend(["README.md", "SECURITY.md"].map(|name| root().join(name)));
    let (mut missing, mut seen) = (vec![], 0);
    for path in documents.iter().filter(|path| !path.ends_with("mentions.rs")) {
        let text = text(path);
        for (at, _) in text.match_indices("tests/") {
            let named = word(&text[at..], &['/', '.']);
            if named.ends_with(".rs") || named.ends_with(".rs.") {
                seen += 1;
                let file = root().join(named.trim_end_matches('.'));
                // A pattern in a path, and the folders of other crates, are no mention.
                if !file.is_file() {
                    missing.push(format!("{}: no file {named}", path.display()));
                }
            }
        }
        for (at, command) in
            text.match_indices("cargo test ").chain(text.match_indices("cargo +nightly test "))
        {
            let line = text[at + command.len()..].split(['`', '"', '\n']).next().unwrap_or_default();
            let words: Vec<&str> = line.split_whitespace().collect();
            let Some(at) = words.iter().position(|word| *word == "--test") else { continue };
            seen += 1;
            let program = words.get(at + 1).copied().unwrap_or_default();
            let filter = words.get(at + 2).filter(|word| **word != "--").copied().unwrap_or_default();
            let code: String = files(&root().join("tests").join(program), &["rs"])
                .iter()
                .map(|path| format!("{}\n{}", path.display(), self::text(path)))
                .collect();
            if filter != "NAME" && !(PROGRAMS.contains(&program) && code.contains(filter)) {
                missing.push(format!("{}: cargo test {line}", path.display()));
            }
        }
    }
    assert!(seen > 80, "documents are read: {seen}");
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn names_are_read_to_the_end_of_the_sentence() {
    let code =
        "/// One. Held by: `a_b`, `Two::c_d`,\n/// `e_f` (tests/g.rs). See `h_i`.\nfn j() {}\n// `k_l`\n";
    assert_eq!(claimed(code), ["a_b", "e_f"]);
    assert_eq!(claimed("/// - Tested by: `a_b`.\n/// - `c_d`\n"), ["a_b"]);
}
