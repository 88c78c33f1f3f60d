//! Beyond the list: what an attacker tries, and what happens late in the evening.

use std::path::Path;
use std::process::Command;

use super::commands::measure;
use super::files::table_bytes;
use super::row::{Row, command, refused, taken};
use crate::support::campaign_text::{GOOD, SMALL, with};

pub fn rows() -> Vec<Row> {
    [names(), texts(), special_files(), mixed_up()].into_iter().flatten().collect()
}

/// The name of a campaign becomes part of a path.
fn names() -> Vec<Row> {
    let name = |toml: &str| with("\"good\"", toml);
    let wrong =
        |toml: &str| refused("campaign name", name(toml), &["c.toml:1:1: name", "letters (a-z), digits"]);
    vec![
        wrong("\"../x\""),
        wrong("\"a/b\""),
        wrong("\"/etc/x\""),
        wrong("\"a\\\\b\""),
        wrong("\".\""),
        wrong("\"..\""),
        wrong("\".hidden\""),
        wrong("\"-o\""),
        wrong("\"\""),
        wrong("\" \""),
        wrong("\"a\\nb\""),
        wrong("\"a\\u0000b\""),
        wrong("\"a\\u001b[31mb\""),
        wrong("\"gr\u{f6}\u{df}e\""),
        wrong("\"\u{202e}rxe.elbat\""),
        wrong(&format!("\"{}\"", "x".repeat(101))),
        wrong(&format!("\"{}\"", "x".repeat(1_000_000))),
        taken("campaign name", name("'''a'''"), &["incidences"]),
        taken("campaign name", name(&format!("\"{}\"", "x".repeat(100))), &["incidences"]),
    ]
}

fn texts() -> Vec<Row> {
    let key = "k".repeat(1 << 20);
    let many: String = (0..200_000).map(|k| format!("k{k} = {k}\n")).collect();
    let control = with("alpha = 0.2", "alpha = 0.2\n\"a\\u001b[2Jb\\n\" = 3");
    let right_to_left = with("seed = 7", "\"se\u{202e}ed\" = 7");
    let angles: String = (0..100_001).map(|k| format!("{},", f64::from(k) * 8e-4)).collect();
    let wide = format!("seed = [{}]", "[1],".repeat(300_000));
    vec![
        refused("hostile text", format!("{key} = 1\n{GOOD}"), &["c.toml:1:1: kkk", "unknown key"]),
        refused("hostile text", format!("{many}{GOOD}"), &["unknown key; known here"])
            .and_somewhere(&["further faults are not listed"]),
        refused("hostile text", control, &["surface.ggx.a", "unknown key"]),
        refused("hostile text", right_to_left, &["unknown key"]),
        refused(
            "hostile text",
            with("[0, 15, 30]", &format!("[{angles}]")),
            &["light.theta_i_deg", "at most 100000"],
        ),
        refused("hostile text", wide, &["seed", "must be a whole number; this is an array"]),
        refused(
            "hostile text",
            with("cells = 256", "cells = 99999999999999999999999"),
            &["surface.cells", "whole number"],
        ),
        refused("hostile text", with("cells = 256", "cells = 0xffff_ffff_ffff"), &["surface.cells"])
            .exits(4, &["surface.cells"]),
        refused("hostile text", with("seed = 7", "seed = 1979-05-27"), &["seed = 1979-05-27"]),
        refused(
            "hostile text",
            with("[light]", "[[light]]"),
            &["light", "must be a table; this is an array"],
        ),
        refused(
            "hostile text",
            with("aperture_deg = 0.0", "aperture_deg = \"1 deg\""),
            &["light.aperture_deg = \"1 deg\""],
        ),
        refused("hostile text", "name = \"x\"\r\rseed = 1", &["c.toml:1:"]),
        refused("hostile text", "{\"name\": \"x\"}", &["c.toml:1:"]),
        refused("hostile text", "<xml/>", &["c.toml:1:"]),
    ]
}

fn fifo(folder: &Path, name: &str) {
    let made = Command::new("mkfifo").arg(folder.join(name)).status().expect("mkfifo");
    assert!(made.success());
}

fn link(folder: &Path, to: &str, name: &str) {
    #[cfg(unix)]
    std::os::unix::fs::symlink(to, folder.join(name)).expect("a link");
}

/// Files that never end, and files that never begin.
fn special_files() -> Vec<Row> {
    let special = "is not a regular file";
    vec![
        command("special file", "check c.toml")
            .prepared(|f| fifo(f, "c.toml"))
            .exits(3, &["error: c.toml: ", special]),
        command("special file", "measure /dev/zero").exits(3, &["error: /dev/zero: ", special]),
        command("special file", "measure /dev/null").exits(3, &["error: /dev/null: ", special]),
        command("special file", "check c.toml")
            .prepared(|f| link(f, "/dev/zero", "c.toml"))
            .exits(3, &["error: c.toml: ", special]),
        command("special file", "validate t.exr")
            .prepared(|f| fifo(f, "t.exr"))
            .exits(3, &["error: t.exr: ", special]),
        command("special file", "validate /dev/zero").exits(3, &["error: /dev/zero: ", special]),
        command("special file", "import x --from npz -o t.exr")
            .prepared(|f| fifo(f, "x"))
            .exits(3, &["error: x: ", special]),
        command("special file", "import /dev/zero --from csv -o t.exr")
            .exits(3, &["error: /dev/zero: ", special]),
        measure("special file", "-o out").prepared(|f| fifo(f, "out")).exits(3, &["error: out: "]),
        measure("special file", "-o .").prepared(|f| fifo(f, "small.exr")).exits(3, &["small.exr", special]),
        measure("special file", "--patches none").exits(3, &["error: none"]),
        measure("special file", "--patches small.toml").exits(3, &["error: small.toml/patch_000.exr"]),
    ]
}

/// One file taken for another.
fn mixed_up() -> Vec<Row> {
    let exr = |words: &str| command("one file for another", words).file("t.exr", table_bytes());
    vec![
        exr("check t.exr").exits(2, &["t.exr", "a campaign, a TOML file, is needed"]),
        exr("measure t.exr").exits(2, &["t.exr", "a campaign, a TOML file, is needed"]),
        measure("one file for another", "").file("x", "x").exits(0, &["verdict"]),
        command("one file for another", "validate small.toml")
            .file("small.toml", SMALL)
            .exits(3, &["small.toml: not an EXR file"]),
        exr("import t.exr --from npz -o u.exr").exits(3, &["error: t.exr: npz: "]),
        exr("import t.exr --from csv -o u.exr").exits(3, &["error: t.exr: csv: "]),
        exr("import t.exr --from rgl -o u.exr").exits(3, &["error: t.exr: rgl: "]),
        exr("import t.exr --from klems -o u.exr").exits(3, &["error: t.exr: klems: "]),
        exr("import t.exr --from tensor_tree -o u.exr").exits(3, &["error: t.exr: tensor_tree: "]),
        exr("import t.exr --from zemax -o u.exr").exits(3, &["error: t.exr: zemax: "]),
        exr("import t.exr --from astm -o u.exr").exits(3, &["error: t.exr: astm: "]),
        exr("import t.exr --from ssdd -o u.exr").exits(3, &["error: t.exr: ssdd: "]),
        exr("import t.exr --from utia -o u.exr").exits(3, &["error: t.exr: utia: "]),
        exr("import t.exr --from exr_parts -o u.exr").exits(3, &["error: t.exr: exr_parts: "]),
        exr("import t.exr --from csv -o t.exr").exits(3, &["t.exr: is the file that is read"]),
        exr("import t.exr --from maps --texel 0,0 -o m").exits(3, &["error: t.exr/ax_ay.exr: "]),
        exr("compare t.exr t.exr").exits(0, &[]),
        exr("report t.exr -o t.exr").exits(3, &["error: t.exr"]),
        exr("report t.exr -o .").exits(3, &["error: .: "]),
        exr("report t.exr -o t.pdf").exits(2, &["error: t.pdf: a page is .html", "prints the page as a PDF"]),
    ]
}
