//! Promise: a texel of GGX parameter maps becomes a campaign that runs as it is, and damaged maps are refused.

#[path = "common/mutations.rs"]
mod mutations;

use std::path::Path;

use gonio::campaign::{self, Azimuth, SurfaceKind};
use gonio::files::image::{self, Part, Samples};
use gonio::interchange::maps;

fn exr(channels: &[(&str, [f32; 4])]) -> Vec<u8> {
    let mut part = Part { width: 2, height: 2, ..Part::default() };
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
fn damaged_maps_are_refused() {
    let found = maps::read(&alpha(), &f0()).expect("sound");
    for (column, row, word) in [(0, 1, "alpha_x"), (1, 1, "alpha_x"), (2, 0, "outside 2 x 2")] {
        let reason = found.campaign(column, row).expect_err("refused");
        assert!(reason.contains(word) && !reason.contains('\n'), "{reason}");
    }
    assert!(maps::read(&f0(), &alpha()).expect_err("no blue").contains("ps.exr: no channel `B`"));
    let mut small = Part { width: 1, height: 1, ..Part::default() };
    small.channels.insert("R".into(), Samples::F32(vec![1.0]));
    let small = image::encode(vec![small]).expect("encoded");
    assert!(maps::read(&alpha(), &small).expect_err("sizes").contains("one size"));
    let (good, f0) = (alpha(), f0());
    assert!(mutations::survives(&good, 100_000, |bytes| maps::read(bytes, &f0)) > 30_000);
}
