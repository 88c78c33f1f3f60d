//! Promise: a texel of GGX parameter maps becomes a campaign that runs as it is, and damaged maps are refused.

use std::path::Path;

use gonio::campaign::{self, Azimuth, SurfaceKind};
use gonio::files::image::{self, ImagePart, Samples};
use gonio::interchange::maps;

use crate::support::mutations;
use crate::support::program::{exits, gonio, stdout};

fn exr(channels: &[(&str, [f32; 4])]) -> Vec<u8> {
    let mut part = ImagePart { width: 2, height: 2, ..ImagePart::default() };
    for (name, values) in channels {
        part.channels.insert(name.to_string(), Samples::F32(values.to_vec()));
    }
    image::encode(vec![part]).expect("encoded")
}

fn alpha() -> Vec<u8> {
    exr(&[("R", [0.25, 0.125, 0.0, f32::NAN]), ("G", [0.25, 0.5, 0.5, 0.5])])
}

fn f0() -> Vec<u8> {
    exr(&[("R", [0.5, 0.75, 0.5, 0.5]), ("G", [0.25; 4]), ("B", [0.125; 4])])
}

#[test]
fn a_texel_becomes_a_campaign() {
    let found = maps::read(&alpha(), &f0()).expect("sound");
    let parse = |text: &str| campaign::parse(text, "c.toml", Path::new("")).expect("runs").campaign;
    let isotropic = parse(&found.campaign(0, 0).expect("in range"));
    assert_eq!((isotropic.name.as_str(), &isotropic.light.azimuth), ("texel_0_0", &Azimuth::Relative));
    let anisotropic = parse(&found.campaign(1, 0).expect("in range"));
    let SurfaceKind::Ggx(alphas) = &anisotropic.surface.kind else { panic!("GGX") };
    assert_eq!((alphas[0].x, alphas[0].y), (0.125, 0.5));
    assert!(matches!(&anisotropic.light.azimuth, Azimuth::Absolute(phi) if phi.len() == 24));
    assert!(found.campaign(1, 0).expect("in range").contains("f0 = [0.75, 0.25, 0.125]"));
}

#[test]
fn a_grid_of_texels_becomes_a_row_of_campaigns() {
    let folder = tempfile::tempdir().expect("folder");
    let here = folder.path();
    std::fs::create_dir(here.join("maps")).expect("folder");
    std::fs::write(here.join("maps/ax_ay.exr"), alpha()).expect("written");
    std::fs::write(here.join("maps/ps.exr"), f0()).expect("written");
    let import =
        |words: &[&str]| gonio(here, &[&["import", "maps", "--from", "maps", "-o", "row"], words].concat());
    // Two of the four texels have no roughness: of a grid they are left out, one that was asked for is a fault.
    let made = import(&["--every", "1"]);
    let err = exits(&made, 0);
    assert_eq!(stdout(&made), "row/texel_0_0.toml\nrow/texel_1_0.toml\n");
    assert!(err.contains("2 of 4 texels left out") && err.trim_end().lines().count() == 1, "{err}");
    exits(&gonio(here, &["check", "row/texel_1_0.toml"]), 0);
    for (words, code, reason) in [
        (vec!["--every", "1"], 3, "is there already"),
        (vec!["--texel", "0,1", "--force"], 3, "alpha_x"),
        (vec!["--texel", "5,0", "--force"], 3, "outside 2 x 2"),
        (vec!["--texel", "five"], 2, "COLUMN,ROW"),
        (vec!["--every", "0"], 2, "1 or more"),
        (vec![], 2, "either --texel X,Y or --every N"),
        (vec!["--texel", "0,0", "--every", "1"], 2, "either --texel X,Y or --every N"),
        (vec!["--texel", "0,0", "--merl-centre"], 2, "say nothing"),
    ] {
        let err = exits(&import(&words), code);
        assert!(err.contains(reason) && err.trim_end().lines().count() == 1, "{words:?}: {err}");
    }
    let wrong = gonio(here, &["import", "x.csv", "--from", "csv", "-o", "t.exr", "--every", "1"]);
    let err = exits(&wrong, 2);
    assert!(err.contains("choose texels of maps"), "{err}");
}

#[test]
fn damaged_maps_are_refused() {
    let found = maps::read(&alpha(), &f0()).expect("sound");
    for (column, row, word) in [(0, 1, "alpha_x"), (1, 1, "alpha_x"), (2, 0, "outside 2 x 2")] {
        let reason = found.campaign(column, row).expect_err("refused").to_string();
        assert!(reason.contains(word) && !reason.contains('\n'), "{reason}");
    }
    assert!(maps::read(&f0(), &alpha()).expect_err("no blue").to_string().contains("ps.exr: no channel `B`"));
    let mut small = ImagePart { width: 1, height: 1, ..ImagePart::default() };
    small.channels.insert("R".into(), Samples::F32(vec![1.0]));
    let small = image::encode(vec![small]).expect("encoded");
    assert!(maps::read(&alpha(), &small).expect_err("sizes").to_string().contains("one size"));
    let (good, f0) = (alpha(), f0());
    assert!(mutations::refused(&good, |bytes| maps::read(bytes, &f0)) > 0.3);
}
