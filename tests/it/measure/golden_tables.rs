//! Golden: six small campaigns end with the bytes that they ended with before the code was moved about. A change that is
//! meant to change a table changes its line here, and says so.
//!
//! Heights come from Fourier transforms and the C library's functions, whose last bits differ between kinds of processor:
//! the bytes are those of x86-64 with AVX2 and FMA.

use std::fs;
use std::path::Path;

use gonio::files::sha256_hex;

use crate::support::arrays::npy;
use crate::support::program::{exits, gonio};

/// A campaign, and the SHA-256 of its table and of its realisations.
struct Golden {
    name: &'static str,
    text: &'static str,
    table: &'static str,
    realisations: &'static str,
}

const GOLDEN: [Golden; 6] = [
    Golden {
        name: "ggx",
        text: "
            [surface]
            realisations = 4
            cells = 128
            correlation_cells = 8.0
            [surface.ggx]
            alpha = 0.3
            [light]
            theta_i_deg = [0, 45, 75]
            azimuth = \"relative\"
            [sensor.hemisphere]
            theta_r_bins = 18
            phi_r_bins = 36
            [stop]
            samples = 131_072",
        table: "fe679a516b4505604563b26a6e035b43d568d81aa54b1b2e47ea22dc44ea7d77",
        realisations: "766535162cea86483704b0616b8456e94dd57b1fcd6859653d0def5fd27c9f4d",
    },
    Golden {
        name: "brushed",
        text: "
            [surface]
            realisations = 4
            cells = 128
            correlation_cells = 8.0
            [surface.ggx]
            alpha_x = 0.1
            alpha_y = 0.4
            [light]
            theta_i_deg = [30, 60]
            azimuth = \"absolute\"
            phi_i_deg = [0, 30, 200]
            [sensor.hemisphere]
            theta_r_bins = 18
            phi_r_bins = 36
            [optics]
            material = \"gold\"
            [stop]
            samples = 65_536",
        table: "40f17e86a8a796a1d77aafe506fcef6ec2c91785c3d34f07bca05a20756073d5",
        realisations: "24a65306c435c95af5781b5ea60e1c924927868397c549e27834ab5c2b6cf799",
    },
    Golden {
        name: "beckmann",
        text: "
            [surface]
            realisations = 4
            cells = 128
            correlation_cells = 8.0
            [surface.beckmann]
            alpha = 0.6
            [light]
            theta_i_deg = [20, 70]
            azimuth = \"relative\"
            [sensor.hemisphere]
            theta_r_bins = 9
            phi_r_bins = 18
            bins = \"aligned\"
            [optics]
            f0 = [0.9, 0.6, 0.3]
            [trace]
            bounces = 3
            by_order = true
            [stop]
            samples = 131_072",
        table: "7493aae0c347579a3230bb56ee99d07b31c140454774559b5392257d8b105ff2",
        realisations: "b8af267426a4529238f2294ecfaa4ab5e621ff8cd38485e832ca683b4c93704b",
    },
    Golden {
        name: "smith",
        text: "
            [surface]
            realisations = 4
            [surface.smith]
            ndf = \"ggx\"
            heights = \"correlated\"
            alpha = 0.4
            [light]
            theta_i_deg = [10, 80]
            azimuth = \"relative\"
            [sensor.hemisphere]
            theta_r_bins = 9
            phi_r_bins = 18
            [trace]
            bounces = 4
            [stop]
            samples = 65_536",
        table: "ea7a082acec4ddde56e72f88dd221eb87ce3dbe868d1bdd37ac54f961da3b96d",
        realisations: "c246ec2af35f88c6bf0b4c825bf4a1a75eb0d6767d8440dab392ac41989ed9d7",
    },
    Golden {
        name: "arm",
        text: "
            [surface]
            realisations = 4
            cells = 128
            correlation_cells = 8.0
            [surface.ggx]
            alpha = 0.2
            [light]
            theta_i_deg = [45]
            azimuth = \"relative\"
            aperture_deg = 1.0
            [sensor.arm]
            theta_r_deg = { from = -60, to = 60, step = 15 }
            phi_r_deg = [170, 180]
            aperture_deg = 2.0
            [stop]
            samples = 262_144",
        table: "33ebd61af3a2a3abefd6486e37f36cdfcb3a26257ffc0e39668843598d69faaf",
        realisations: "3287d92c0606f16450b155387432bf4a03fb1903c57a5a7bc22dcfee2730a836",
    },
    Golden {
        name: "map",
        text: "
            [surface.file]
            path = \"map.npy\"
            pitch_x_um = 1.0
            pitch_y_um = 1.5
            height_unit_um = 1.0
            periodic = false
            tiles = 2
            [light]
            theta_i_deg = [0, 50]
            azimuth = \"absolute\"
            phi_i_deg = [0, 120]
            [sensor.hemisphere]
            theta_r_bins = 9
            phi_r_bins = 18
            [optics]
            eta = [1.5, 0.9, 0.2]
            k = [1.9, 2.4, 3.9]
            wavelength_nm = [450, 550, 650]
            fresnel = \"exact\"
            [trace]
            bounces = 2
            [stop]
            samples = 65_536",
        table: "b2d4a449077e25438041a5262fce5642bb3a8df31416bfa561b4dcf7a5d675fb",
        realisations: "d87e62a00ed1c8281ed89aaef629a11f4f60c00813fe99b9b4d137282d4f0268",
    },
];

/// Heights of 96 x 96 cells, um: whole numbers of a hash, smoothed by sums, so that no function of a library takes part.
fn heights() -> Vec<f64> {
    const SIDE: usize = 96;
    let cell = |x: usize, y: usize| {
        let hash = ((x % SIDE) * 7919 + (y % SIDE) * 104_729).wrapping_mul(2_654_435_761) >> 7;
        (hash % 1024) as f64 / 1024.0
    };
    let smooth = |x: usize, y: usize| {
        let sum: f64 = (0..36).map(|k| cell(x + k % 6, y + k / 6)).sum();
        sum / 9.0
    };
    (0..SIDE * SIDE).map(|i| smooth(i % SIDE, i / SIDE)).collect()
}

fn digest(path: &Path) -> String {
    sha256_hex(&fs::read(path).unwrap_or_else(|why| panic!("{}: {why}", path.display())))
}

#[cfg(target_arch = "x86_64")]
fn is_known_processor() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

#[cfg(not(target_arch = "x86_64"))]
fn is_known_processor() -> bool {
    false
}

#[test]
fn the_tables_of_six_campaigns_are_what_they_were() {
    if !is_known_processor() {
        println!("skipped: another kind of processor");
        return;
    }
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(folder.path().join("map.npy"), npy(&heights(), 96)).expect("map");
    let mut changed = Vec::new();
    for Golden { name, text, table, realisations } in GOLDEN {
        let campaign = folder.path().join(format!("{name}.toml"));
        fs::write(&campaign, format!("name = \"{name}\"\nseed = 7\n{text}\n")).expect("campaign");
        exits(&gonio(folder.path(), &["measure", &format!("{name}.toml"), "-o", "out"]), 0);
        let out = folder.path().join("out");
        for (file, golden) in
            [(format!("{name}.exr"), table), (format!("{name}.realisations.exr"), realisations)]
        {
            let found = digest(&out.join(&file));
            if found != golden {
                changed.push(format!("{file}: {found}"));
            }
        }
    }
    assert!(changed.is_empty(), "changed:\n{}", changed.join("\n"));
}
