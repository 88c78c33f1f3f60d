//! Promise: what goes where. `-` is stdin and stdout; a quiet command leaves its exit code, warnings and what was asked for;
//! colours are for terminals; a narrow terminal gets lines that fit it.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

use crate::support::campaign_text::SMALL;
use crate::support::program::{command, exits, folder, gonio, stderr, stdout};

/// A folder with a campaign, and its table in `out`.
fn with_table() -> TempDir {
    let folder = folder(SMALL);
    exits(&gonio(folder.path(), &["measure", "small.toml", "-o", "out"]), 0);
    folder
}

/// Runs the program with these bytes on stdin.
fn fed(at: &Path, words: &[&str], input: &[u8]) -> Output {
    let mut child = command(at, words)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    // A program that refuses its command line reads nothing.
    child.stdin.take().expect("a pipe").write_all(input).ok();
    child.wait_with_output().expect("ends")
}

#[test]
fn a_campaign_and_a_table_are_taken_from_stdin() {
    let folder = with_table();
    let at = folder.path();
    let check = fed(at, &["check", "-"], SMALL.as_bytes());
    exits(&check, 0);
    assert_eq!(stdout(&check), stdout(&gonio(at, &["check", "small.toml"])));
    let faulty = fed(at, &["check", "-"], b"name = \"a\"\nseed = -1\n");
    exits(&faulty, 2);
    assert!(stderr(&faulty).contains("stdin:2:"), "{}", stderr(&faulty));
    exits(&fed(at, &["measure", "-", "-o", "again"], SMALL.as_bytes()), 0);
    let table = fs::read(at.join("out/small.exr")).expect("a table");
    assert!(fs::read(at.join("again/small.exr")).expect("a table") == table);
    let cited = fed(at, &["cite", "-"], &table);
    exits(&cited, 0);
    assert_eq!(stdout(&cited), stdout(&gonio(at, &["cite", "out/small.exr"])));
    exits(&fed(at, &["validate", "-"], &table), 0);
    // What is no table is refused as a file is.
    let wrong = fed(at, &["validate", "-"], b"no table");
    exits(&wrong, 3);
    assert!(stderr(&wrong).starts_with("error: "), "{}", stderr(&wrong));
}

#[test]
fn one_file_goes_to_stdout_and_nothing_else() {
    let folder = with_table();
    let at = folder.path();
    exits(&gonio(at, &["export", "out/small.exr", "--to", "csv", "-o", "small.csv"]), 0);
    let csv = fs::read(at.join("small.csv")).expect("a file");
    let piped = gonio(at, &["export", "out/small.exr", "--to", "csv", "-o", "-"]);
    exits(&piped, 0);
    assert!(piped.stdout == csv);
    let back = fed(at, &["import", "-", "--from", "csv", "-o", "-"], &csv);
    exits(&back, 0);
    exits(&gonio(at, &["import", "small.csv", "--from", "csv", "-o", "back.exr"]), 0);
    assert!(back.stdout == fs::read(at.join("back.exr")).expect("a table"));
    let page = gonio(at, &["report", "out/small.exr", "-o", "-"]);
    exits(&page, 0);
    exits(&gonio(at, &["report", "out/small.exr", "-o", "page.html"]), 0);
    assert!(page.stdout == fs::read(at.join("page.html")).expect("a page"));
    for words in [
        &["measure", "small.toml", "-o", "-"][..],
        &["surface", "small.toml", "-o", "-"],
        &["export", "out/small.exr", "--to", "csv", "-o", "-", "--json"],
        &["export", "out/small.exr", "--to", "pabopto", "-o", "-"],
        &["recolour", "out/small.exr", "--f0", "0.5", "-o", "-"],
        &["render", "out/small.exr", "--scene", "mitsuba", "-o", "-"],
        &["import", "small.csv", "--from", "maps", "-o", "-"],
        &["man", "-"],
    ] {
        let refused = gonio(at, words);
        exits(&refused, 2);
        assert!(refused.stdout.is_empty(), "{words:?}");
    }
    assert!(!at.join("-").exists());
    // A file of that name has nothing to do with it.
    fs::write(at.join("-"), "a year of work").expect("written");
    let table = fs::read(at.join("out/small.exr")).expect("a table");
    for output in [
        fed(at, &["report", "-", "-o", "-"], &table),
        fed(at, &["export", "-", "--to", "csv", "-o", "-"], &table),
    ] {
        exits(&output, 0);
        assert!(!output.stdout.is_empty());
    }
    assert_eq!(fs::read_to_string(at.join("-")).expect("there"), "a year of work");
}

/// Of an endless stream a campaign takes no more than a campaign may have.
#[test]
fn a_campaign_on_stdin_is_no_longer_than_one_in_a_file() {
    let folder = folder(SMALL);
    let refused = fed(folder.path(), &["check", "-"], &vec![b'#'; 17 << 20]);
    exits(&refused, 2);
    assert!(stderr(&refused).contains("larger than 16 MiB; this is no campaign"), "{}", stderr(&refused));
    let endless = command(folder.path(), &["check", "-"])
        .stdin(fs::File::open("/dev/zero").expect("a device"))
        .output()
        .expect("runs");
    exits(&endless, 2);
}

#[test]
fn a_files_name_is_no_formula_of_a_spreadsheet() {
    let folder = with_table();
    let at = folder.path();
    let names = ["=cmd|c.exr", "\u{1b}[31m.exr"];
    for name in names {
        fs::copy(at.join("out/small.exr"), at.join(name)).expect("copied");
    }
    exits(&gonio(at, &["report", names[0], names[1], "-o", "both.csv"]), 0);
    let csv = fs::read_to_string(at.join("both.csv")).expect("figures");
    assert!(csv.contains("\n./=cmd|c,") && csv.contains("\n./ [31m,"), "{csv}");
    assert!(!csv.contains('\u{1b}'), "{csv}");
}

#[test]
fn a_name_with_a_line_break_is_refused_on_one_line() {
    let folder = folder(SMALL);
    for name in ["no\nerror: forged.exr", "no\rforged.exr", "no\u{2028}forged.exr"] {
        let refused = gonio(folder.path(), &["cite", name]);
        exits(&refused, 2);
        let said = stderr(&refused);
        assert!(
            said.lines().count() == 1 && said.contains("a name with a line break is not taken"),
            "{said}"
        );
    }
}

#[test]
fn a_quiet_command_leaves_what_was_asked_for() {
    let folder = folder(SMALL);
    let at = folder.path();
    let run = gonio(at, &["--quiet", "measure", "small.toml", "-o", "out"]);
    exits(&run, 0);
    assert!(run.stdout.is_empty() && run.stderr.is_empty(), "{}{}", stdout(&run), stderr(&run));
    exits(&gonio(at, &["validate", "out/small.exr", "-q"]), 0);
    // A document is printed all the same, and an error is one.
    let json = gonio(at, &["validate", "out/small.exr", "-q", "--json"]);
    assert!(serde_json::from_slice::<serde_json::Value>(&json.stdout).is_ok());
    assert!(stdout(&gonio(at, &["materials", "-q"])).contains("gold"));
    let refused = gonio(at, &["validate", "nothing.exr", "-q"]);
    exits(&refused, 3);
    assert!(stderr(&refused).starts_with("error: nothing.exr"), "{}", stderr(&refused));
}

#[test]
fn colours_are_for_terminals_and_those_who_ask() {
    let folder = folder(SMALL);
    let at = folder.path();
    let missing = ["check", "nothing.toml"];
    assert!(!stderr(&gonio(at, &missing)).contains('\u{1b}'), "a pipe has no colours");
    let always = gonio(at, &["check", "nothing.toml", "--color", "always"]);
    assert!(stderr(&always).starts_with("\u{1b}["), "{:?}", stderr(&always));
    let on_terminal = |variables: &[(&str, &str)]| terminal(at, 100, "check nothing.toml", variables);
    assert!(on_terminal(&[]).contains("\u{1b}["), "{}", on_terminal(&[]));
    assert!(!on_terminal(&[("NO_COLOR", "1")]).contains("\u{1b}["));
}

/// What the program prints on a terminal of so many columns, which does not say how many rows it has.
fn terminal(at: &Path, columns: usize, words: &str, variables: &[(&str, &str)]) -> String {
    let line = format!("stty cols {columns}; '{}' {words}", env!("CARGO_BIN_EXE_gonio"));
    let mut script = Command::new("script");
    script.args(["-qec", &line, "/dev/null"]).current_dir(at).env("TERM", "xterm").env_remove("NO_COLOR");
    script.envs(variables.iter().copied()).stdin(Stdio::null());
    String::from_utf8(script.output().expect("script, of util-linux").stdout)
        .expect("UTF-8")
        .replace('\r', "")
}

#[test]
fn lines_fit_a_narrow_terminal() {
    let folder = with_table();
    let at = folder.path();
    for columns in [60, 80, 100] {
        for words in [
            "check small.toml -v",
            "measure small.toml -o again --force",
            "validate out/small.exr",
            "fit out/small.exr",
            "surface small.toml -o patches --force",
            "materials",
            "formats",
            "presets",
            "measure -h",
        ] {
            let text = terminal(at, columns, words, &[("NO_COLOR", "1")]);
            // What a bar or a spinner draws is taken away again; paths are as long as they are.
            let lines = text.lines().filter(|line| !line.contains(['\u{1b}', '/']));
            let longest = lines.max_by_key(|line| line.chars().count()).unwrap_or_default();
            assert!(longest.chars().count() <= columns, "{columns}: {words}: {longest}");
            assert!(text.lines().count() > 3, "{text}");
        }
    }
}
