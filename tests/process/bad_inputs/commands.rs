//! Command lines, output folders, environments.

use std::fs;

use super::row::{Row, command, refused};
use crate::support::campaign_text::SMALL;

pub fn rows() -> Vec<Row> {
    [campaigns(), folders(), surroundings(), words(), albedos()].into_iter().flatten().collect()
}

/// A row that measures the small campaign.
pub fn measure(name: &'static str, more: &str) -> Row {
    command(name, &format!("measure small.toml {more}")).file("small.toml", SMALL)
}

fn campaigns() -> Vec<Row> {
    let single = SMALL.replace("realisations = 4", "realisations = 1");
    let small = |name: &'static str, text: String| command(name, "measure c.toml").file("c.toml", text);
    vec![
        command("no such campaign", "measure missing.toml")
            .exits(3, &["error: missing.toml: ", "No such file"]),
        command("no such campaign", "check .").exits(3, &["error: .: ", "is not a regular file"]),
        command("no such campaign", "check c.toml/x.toml")
            .file("c.toml", SMALL)
            .exits(3, &["error: c.toml/x.toml: "]),
        // Nearly along the surface a ray would cross more cells than there is time for.
        // Cheap by now, but the sums of flux would not hold it.
        small("theta so grazing that rays never end", SMALL.replace("[0, 50]", "[89.99999999999]"))
            .exits(4, &["small: light.theta_i_deg = 89.99999999999", "samples"]),
        small("normal incidence", SMALL.replace("[0, 50]", "[0]")).exits(0, &["verdict"]),
        small("one realisation", single).exits(0, &["+- n/a"]),
        // Less address space than the patches need, in KiB: refused before an allocation can fail.
        small("little memory", SMALL.replace("cells = 32", "cells = 4096"))
            .limited("-v 1000000")
            .exits(4, &["needs about", "MiB"]),
        small("little memory", SMALL.into()).limited("-v 1000000").exits(0, &["verdict"]),
        small("little memory", format!("{SMALL}x = [{}]\n", "1,".repeat(1 << 20)))
            .limited("-v 500000")
            .exits(4, &["c.toml: reading it takes up to", "MiB may be used"]),
        // One start is rounded up to a block, and said to be one.
        small("one sample", SMALL.replace("65_536", "1")).exits(0, &["samples", "65,536"]),
    ]
}

fn folders() -> Vec<Row> {
    vec![
        measure("output folder", "-o new/deep").exits(0, &["new/deep/small.exr"]),
        measure("output folder", "-o taken").file("taken", "").exits(3, &["error: taken: "]),
        measure("output folder", "-o small.toml/out").exits(3, &["error: small.toml/out: "]),
        // Nobody may write there, not even the superuser.
        measure("output folder", "-o /proc/gonio").exits(3, &["error: /proc/gonio"]),
        measure("files of somebody at the output", "-o .")
            .file("small.exr", "notes of somebody")
            .exits(3, &["small.exr", "--force"]),
        measure("files of somebody at the output", "-o .")
            .file("small.json", "{}")
            .exits(3, &["small.json", "--force"]),
        command("output is the input", "export t.exr --to csv -o t.exr")
            .file("t.exr", "x")
            .exits(3, &["t.exr: is the file that is read"]),
        measure("strange paths", "-o")
            .word("a folder \u{e9}\u{4e2d}")
            .exits(0, &["a folder \u{e9}\u{4e2d}/small.exr"]),
        measure("strange paths", "-o").word("x".repeat(300)).exits(3, &["error: xxx", "name too long"]),
        command("strange paths", "check loop.toml")
            .prepared(|folder| {
                #[cfg(unix)]
                std::os::unix::fs::symlink("loop.toml", folder.join("loop.toml")).expect("a link");
            })
            .exits(3, &["error: loop.toml: "]),
        measure("disk full", "-o /dev/full").exits(3, &["error: /dev/full: "]),
        command("disk full", "export t.exr --to csv -o /dev/full --force")
            .prepared(|folder| fs::write(folder.join("t.exr"), super::files::table_bytes()).expect("file"))
            .exits(3, &["error: /dev/full: is not a regular file"]),
    ]
}

fn surroundings() -> Vec<Row> {
    vec![
        measure("threads", "--threads 0").exits(0, &["verdict"]),
        measure("threads", "--threads 3").exits(0, &["3 threads"]),
        measure("threads", "--threads 100000").exits(0, &["--threads 100000", "are used, 4 for each core"]),
        measure("threads in the environment", "")
            .environment("RAYON_NUM_THREADS", "abc")
            .exits(0, &["verdict"]),
        measure("time zone", "").environment("TZ", "Asia/Kathmandu").exits(0, &["verdict"]),
        measure("colours of the terminal", "")
            .environment("NO_COLOR", "1")
            .environment("TERM", "dumb")
            .exits(0, &["verdict"]),
        measure("colours of the terminal", "--nonsense")
            .environment("CLICOLOR_FORCE", "1")
            .environment("NO_COLOR", "1")
            .exits(2, &["error: unexpected argument"]),
        measure("locale", "").environment("LC_ALL", "de_DE.UTF-8").exits(0, &["0.86"]),
    ]
}

fn words() -> Vec<Row> {
    let wrong = |words: &str, says: &[&'static str]| {
        command("command line wrong", words).file("small.toml", SMALL).exits(2, says)
    };
    vec![
        command("command line wrong", "--help").exits(0, &["measure"]),
        command("command line wrong", "--version").exits(0, &["gonio "]),
        wrong("measure small.toml --fast", &["error: unexpected argument '--fast'"]),
        wrong("mesure small.toml", &["error: unrecognized subcommand 'mesure'"]),
        wrong("measure small.toml --seed -1", &["error: "]),
        wrong("measure small.toml --seed 1e3", &["error: invalid value '1e3' for '--seed <N>'"]),
        wrong("measure small.toml --seed 18446744073709551616", &["error: invalid value", "--seed"]),
        wrong("measure small.toml --threads two", &["error: invalid value 'two' for '--threads <N>'"]),
        wrong("measure small.toml small.toml", &["error: unexpected argument 'small.toml'"]),
        wrong("export small.toml --to gif -o x", &["error: --to gif: known formats are npz"]),
        wrong("export small.toml --to csv --half -o x", &["error: unexpected argument '--half'"]),
        wrong("export small.toml --to csv --side both -o x", &["error: invalid value 'both' for '--side"]),
        wrong(
            "import small.toml --from klems --side up -o x",
            &["error: invalid value 'up'", "front or back needed"],
        ),
        command("value beyond the format", "export t.exr --to csv --f16 -o x")
            .exits(2, &["error: unexpected argument '--f16'"]),
        refused("output is the input", SMALL, &["error: a value is required for '--output <DIR>'"])
            .word("-o")
            .word(""),
    ]
}

fn albedos() -> Vec<Row> {
    let matt = format!("{SMALL}[optics]\nfacet = \"diffuse\"\nalbedo = 0.5\n");
    let layered = format!("{SMALL}[optics]\nfacet = \"layered\"\neta = 1.5\nalbedo = 0.5\n");
    let flat =
        SMALL.replace("cells = 32\ncorrelation_cells = 4.0\n[surface.ggx]\nalpha = 0.3", "[surface.mirror]");
    let wrong = |words: &str, exit: i32, says: &[&'static str]| {
        let row = command("axis of an albedo table", &format!("albedo {words}"));
        let row =
            row.file("small.toml", SMALL).file("matt.toml", matt.clone()).file("flat.toml", flat.clone());
        row.file("layered.toml", layered.clone()).file("t.csv", "of somebody").exits(exit, says)
    };
    vec![
        wrong("--grid --alpha 0", 2, &["error: invalid value '0' for '--alpha <AXIS>'", "[1e-4, 10]"]),
        wrong("--grid --alpha nan", 2, &["'--alpha <AXIS>'", "must be finite and lie in [1e-4, 10]"]),
        wrong("--grid --alpha 0.5,0.1", 2, &["'--alpha <AXIS>'", "0.1 comes after 0.5; nodes must increase"]),
        wrong("--grid --mu 1.2", 2, &["error: invalid value '1.2' for '--mu <AXIS>'", "[1e-4, 1]"]),
        wrong("--grid --mu 0.1:0.5", 2, &["'--mu <AXIS>'", "FROM:TO:N"]),
        wrong("--grid --mu 99999", 2, &["'--mu <AXIS>'", "99999 nodes; 2 to 4096 are allowed"]),
        wrong("--grid --eta 1", 2, &["error: invalid value '1' for '--eta <AXIS>'", "[1.0001, 10]"]),
        wrong("--grid --mu 4096 --alpha 4096", 4, &["error: 16777216 cells; a table has at most 1048576"]),
        wrong("--grid --law gxx", 2, &["error: invalid value 'gxx' for '--law <NAME>'", "student_t:GAMMA"]),
        wrong("--grid --law student_t:1", 2, &["'--law <NAME>'", "gamma 1 must lie in [2, 100]"]),
        wrong("--grid --masking grains", 2, &["'--masking <NAME>'", "height_correlated"]),
        wrong("--grid -o t.txt", 2, &["error: -o t.txt: the name must end in .npz, .csv, .exr or .h"]),
        wrong("--grid -o a.csv -o a.csv", 2, &["error: -o a.csv: is given twice"]),
        wrong("--grid -o t.csv", 3, &["error: t.csv: is there already", "--force"]),
        wrong("", 2, &["error: a campaign that is measured, or --grid"]),
        wrong("small.toml --grid", 2, &["error: the argument", "--grid"]),
        wrong(
            "small.toml --eta 1.5",
            2,
            &["error: --eta: facets of small are mirrors", "facet = \"dielectric\""],
        ),
        wrong("flat.toml --alpha 0.5", 2, &["error: --alpha: [surface.mirror] of small has no roughness"]),
        wrong("matt.toml", 2, &["error: small: optics.facet = \"diffuse\"", "mirror and of clear facets"]),
        wrong("layered.toml", 2, &["error: small: optics.facet = \"layered\"", "mirror and of clear facets"]),
        wrong("small.toml --law ggx", 2, &["error: the argument", "cannot be used with", "--law <NAME>"]),
    ]
}
