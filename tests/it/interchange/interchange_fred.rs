//! Promise: FRED's tabulated BSDF texts are written as they are described, and come back; the published example is read.

use gonio::interchange::text::fred;
use gonio::interchange::{self, Format, Options};

use crate::support::analytic::{Ggx, hemisphere, steps, table};
use crate::support::mutations;

/// The example that is published with the format: two mirror directions in one plane, the direction 0 twice.
const EXAMPLE: &str = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n\
    0 0\n-30 0 0.0003\n-20 0 0.0005\n-10 0 0.0015\n0 0 0.1\n10 0 0.0015\n20 0 0.0005\n30 0 0.0003\n0 0 0.1\n\
    15 0\n-30 0 0.0003\n-20 0 0.0005\n-10 0 0.0015\n0 0 0.1\n10 0 0.0015\n20 0 0.0005\n30 0 0.0003\n0 0 0.1\n";

#[test]
fn the_published_example_is_read() {
    let found = fred::read(EXAMPLE.as_bytes()).expect("readable");
    assert!(found.grid.is_isotropic());
    assert_eq!(found.grid.theta_i_deg, [0.0, 15.0]);
    // Positive angles are on the mirror direction's side, half a turn from the light; negative ones on the light's.
    let (far, near) = (180.0, 0.0);
    let wanted =
        [[30.0, near], [20.0, near], [10.0, near], [0.0, far], [10.0, far], [20.0, far], [30.0, far]];
    assert_eq!(found.grid.points_deg, wanted);
    let row = [0.0003, 0.0005, 0.0015, 0.1, 0.0015, 0.0005, 0.0003];
    assert_eq!(found.colours[0].total, [row, row].concat());
    // A factor for all values, and azimuths that begin elsewhere.
    let turned = "type bsdf_data\nformat angles=deg bsdf=value scale=2.5\n15 40\n20 70 0.1\n";
    let found = fred::read(turned.as_bytes()).expect("readable");
    assert_eq!((found.grid.points_deg, &found.colours[0].total), (vec![[20.0, 210.0]], &vec![0.25]));
}

#[test]
fn fred_comes_back() {
    let own = table(&Ggx::new(0.5, 0.5), &hemisphere(steps(30.0, 3), None, 6, 12));
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("a.txt");
    let export = interchange::export(&own, Format::Fred, &Options::default(), &path).expect("written");
    assert_eq!((export.read_back.expect("light").l1, export.notes.len()), (0.0, 0));
    let text = std::fs::read_to_string(&path).expect("there");
    assert!(text.starts_with("type bsdf_data\nformat angles=deg bsdf=value scale=1\n0 0\n"), "{text:.80}");
    let found = interchange::import(&path, Format::Fred, &Options::default(), None).expect("read").0;
    assert_eq!(found.colours[0].total, own.colours[0].total);
    assert!(found.grid.is_isotropic());
    // Under light at 60 degrees the largest value is about the mirror direction: theta 60 and beyond, phi near 0.
    let block = text.split("\n60 0\n").nth(1).expect("the last block");
    let numbers =
        |line: &str| line.split(' ').map(|word| word.parse().expect("a number")).collect::<Vec<f64>>();
    let largest = block.lines().map(numbers).max_by(|a, b| a[2].total_cmp(&b[2])).expect("lines");
    assert!(largest[0] > 50.0 && (largest[1] <= 15.0 || largest[1] >= 345.0), "{largest:?}");
    // Values of 0 are said, an anisotropic table is refused.
    let mut dark = own.clone();
    dark.colours[0].total[3] = 0.0;
    let export = interchange::export(&dark, Format::Fred, &Options::default(), &path).expect("written");
    assert!(export.notes[0].starts_with("1 values are 0"), "{:?}", export.notes);
    let brushed = table(&Ggx::new(0.2, 0.5), &hemisphere(steps(30.0, 3), Some(steps(45.0, 8)), 6, 12));
    let why = interchange::export(&brushed, Format::Fred, &Options::default(), &path).expect_err("refused");
    assert!(why.to_string().contains("FRED's tables are isotropic: measure with azimuth"), "{why}");
}

#[test]
fn damaged_fred_files_are_refused() {
    let head = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n";
    let with = |lines: &str| format!("{head}{lines}");
    for (text, said) in [
        (String::new(), "`type bsdf_data` needed at the beginning"),
        ("type psd_data\n".into(), "`type bsdf_data` needed at the beginning"),
        ("type bsdf_data\n0 0\n".into(), "needed as the second line"),
        ("type bsdf_data\nformat angles=deg\n".into(), "needed as the second line"),
        ("type bsdf_data\nformat angles=sin bsdf=value\n".into(), "angles=sin: degrees needed"),
        ("type bsdf_data\nformat angles=deg bsdf=log\n".into(), "bsdf=log: values needed"),
        ("type bsdf_data\nformat angles=deg bsdf=value scale=-1\n".into(), "scale=-1: a number above 0"),
        (with(""), "no samples"),
        (with("1 2 3\n"), "line 3: a value before `theta phi` of a mirror direction"),
        (with("0 0\n1 2 3 4\n"), "line 4: 4 numbers"),
        (with("0 0\n1\n"), "line 4: 1 numbers"),
        (with("0 0\n1 2 x\n"), "line 4: `x` is no number"),
        (with("0 0\n1 2 nan\n"), "line 4: `nan` is no number"),
        (with("0 0\n1 2 -3\n"), "line 4: BSDF -3 1/sr: 0 or more needed"),
        (with("0 0\n95 0 1\n"), "line 4: theta 95, phi 0: within 90 degrees of the normal needed"),
        (with("0 0\n1 2 3\n1 2 4\n"), "lines 4 and 5: the same light"),
    ] {
        let why = fred::read(text.as_bytes()).expect_err(said).to_string();
        assert!(why.contains(said), "{said}: {why}");
    }
    assert!(mutations::survives(EXAMPLE.as_bytes(), 20_000, fred::read) > 2_000);
}
