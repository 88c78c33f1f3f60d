//! Promise: `gonio fit --surface` finds the law of a map's slopes, measures a surface of it beside the map, and says how far
//! one BRDF is the other's.

use std::fs;

use crate::support::outputs::digests;
use crate::support::program::{exits, gonio, json, stdout};

const PATCH: &str = "name = \"ggx\"\nseed = 5\n[surface]\nrealisations = 1\ncells = 96\ncorrelation_cells = 2\n\
                     [surface.ggx]\nalpha_x = 0.2\nalpha_y = 0.4\n[light]\ntheta_i_deg = [0]\nazimuth = \"absolute\"\n\
                     phi_i_deg = [0]\n[sensor.hemisphere]\n[stop]\nsamples = 4096\n";
const SCAN: &str = "name = \"scan\"\n[surface.file]\npath = \"patches/patch_000.exr\"\nperiodic = true\n\
                    detrend = \"none\"\nrefine = 1\ntiles = 3\n[light]\ntheta_i_deg = [40]\nazimuth = \"absolute\"\n\
                    phi_i_deg = [0, 90]\n[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 12\n[stop]\nsamples = 16_384\n";

#[test]
fn a_scan_is_measured_beside_its_law() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let here = folder.path();
    fs::write(here.join("ggx.toml"), PATCH).expect("campaign");
    fs::write(here.join("scan.toml"), SCAN).expect("campaign");
    exits(&gonio(here, &["surface", "ggx.toml", "-o", "patches"]), 0);
    let words = ["fit", "--surface", "scan.toml", "-o", "out"];
    let answer = json(&gonio(here, &[&words[..], &["--json"]].concat()));
    let taken = &answer["fits"][answer["taken"].as_u64().expect("a place") as usize];
    assert_eq!((&taken["law"], &taken["anisotropic"]), (&"ggx".into(), &true.into()), "{answer}");
    for (name, truth) in [("alpha_x", 0.2), ("alpha_y", 0.4)] {
        let [value, se] = ["parameters", "standard_errors"].map(|key| taken[key][name].as_f64().expect(name));
        // A patch of 48 x 48 correlation lengths, by 9 tiles of it: Student's t of 8 degrees, 1.1e-3.
        assert!((value - truth).abs() < 5.0 * se && se < 0.1 * truth, "{name} {value} +- {se}");
    }
    let l1 = |key: &str| answer["difference"][key].as_f64().expect(key);
    // The law is the patch's own: what is left is its being one patch. A law with twice the roughness is off by half the light.
    assert!(l1("l1_difference") < 0.1 && l1("l1_noise") < 0.2, "{}", answer["difference"]);
    let page = fs::read_to_string(here.join("out/scan.law.html")).expect("a page");
    for part in [
        "id=\"verdict\"",
        "Quantiles of the slopes",
        "Light at theta_i 40.0",
        "ggx with two roughnesses",
        "<svg",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // Once more: nothing is measured again, and the bytes are the same.
    let before = digests(&here.join("out"));
    let text = stdout(&gonio(here, &words));
    assert!(text.contains("measured beside the scan: ggx with two roughnesses"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    assert_eq!(digests(&here.join("out")), before);
    // What lies there and is not ours stays.
    fs::write(here.join("out/scan.law.html"), "mine").expect("written");
    assert!(exits(&gonio(here, &words), 3).contains("scan.law.html"));
    let said = exits(&gonio(here, &["fit", "--surface", "ggx.toml", "-o", "out"]), 2);
    assert!(said.contains("--surface is for a measured map"), "{said}");
}
