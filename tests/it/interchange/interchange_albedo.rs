//! Promise: an export sends back as much light as its table, between the measured directions of the light too.

use gonio::interchange::albedo::AlbedoPoint;
use gonio::interchange::mitsuba::rgl;
use gonio::interchange::radiance::tensor_tree;
use gonio::interchange::text::zemax;
use gonio::interchange::{AlbedoCurve, Brdf, Format, Lookup, Options, export};
use gonio::sphere;
use gonio::table::BrdfTable;

use crate::support::analytic::{Ggx, Painted, hemisphere, steps, table};

/// Incidences of `[preset] name = "rgl"`.
fn of_the_preset() -> Vec<f64> {
    (0..8).map(|k| 80.0 * (f64::from(k) / 7.0).powi(2)).collect()
}

/// Integral of f cos, midpoints in steps of 0.25 and 1 degrees: an eighth of a lobe of alpha 0.1 as it is seen at
/// grazing light. Off by 0.1 % at most for what is integrated here.
pub fn albedo(brdf: &dyn Brdf, theta_i: f64, phi_i: f64) -> f64 {
    // Up to 60 degrees its half-widths are 2 alpha = 11 degrees and, in azimuth, 2 alpha/tan(60) = 6.6 or more: steps of
    // 0.5 and 2 are a third of them at most.
    let rough = if theta_i < 60.0 { 2.0 } else { 1.0 };
    albedo_by(brdf, theta_i, phi_i, 0.25 * rough, rough)
}

/// The same by midpoints in such steps, degrees.
fn albedo_by(brdf: &dyn Brdf, theta_i: f64, phi_i: f64, step_theta: f64, step_phi: f64) -> f64 {
    let wi = sphere::direction_deg(theta_i, phi_i);
    let mut sum = 0.0;
    for row in 0..(90.0 / step_theta) as u32 {
        let theta = step_theta * (f64::from(row) + 0.5);
        for column in 0..(360.0 / step_phi) as u32 {
            let wo = sphere::direction_deg(theta, phi_i + step_phi * (f64::from(column) + 0.5));
            sum += brdf.brdf(wi, wo)[0] * wo.z * theta.to_radians().sin();
        }
    }
    sum * step_theta.to_radians() * step_phi.to_radians()
}

/// theta_i and the albedo of GGX 0.1, F = 1, separable masking: 30 to 85 by adaptive quadrature of the formula; 50 and 70
/// by integrating Mitsuba's roughconductor.
const TENTH: [(f64, f64); 6] = [
    (30.0, 0.986_085),
    (45.0, 0.981_673),
    (50.0, 0.978_8),
    (70.0, 0.945_7),
    (75.0, 0.923_240),
    (85.0, 0.873_130),
];

#[test]
fn rgl_neither_makes_nor_loses_light_between_incidences() {
    for incidences in [of_the_preset(), steps(15.0, 6)] {
        let own = table(&Ggx::new(0.1, 0.1), &hemisphere(incidences, None, 90, 180));
        let lookup = Lookup::new(&own).expect("a product");
        let file = rgl::read(&rgl::write(&lookup, None, "").expect("written")).expect("sound");
        for (theta_i, wanted) in TENTH {
            let found = albedo(&lookup, theta_i, 10.0);
            // The bar of the issue.
            assert!((found / wanted - 1.0).abs() <= 0.01, "{theta_i}: {found} {wanted}");
        }
        for (theta_i, wanted) in [TENTH[2], TENTH[3], TENTH[5]] {
            let found = albedo(&file, theta_i, 10.0);
            assert!((found / wanted - 1.0).abs() <= 0.01, "{theta_i}: {found} {wanted} in the file");
        }
    }
}

#[test]
fn a_brushed_table_keeps_its_albedo_between_azimuths() {
    let ggx = Ggx::new(0.1, 0.3);
    let own = table(&ggx, &hemisphere(steps(15.0, 6), Some(steps(45.0, 8)), 45, 90));
    let lookup = Lookup::new(&own).expect("a product");
    for (theta_i, phi_i) in [(20.0, 15.0), (52.5, 0.0), (67.0, 75.0), (80.0, 10.0)] {
        let (found, wanted) = (albedo(&lookup, theta_i, phi_i), albedo(&ggx, theta_i, phi_i));
        // The bar of the issue; bins of 2 x 4 degrees keep their means.
        assert!((found / wanted - 1.0).abs() <= 0.01, "{theta_i} {phi_i}: {found} {wanted}");
    }
}

#[test]
fn paint_stays_even_between_and_beyond_the_incidences() {
    let own = table(&Painted { paint: 0.3, lobe: None }, &hemisphere(steps(25.0, 4), None, 18, 36));
    let lookup = Lookup::new(&own).expect("a product");
    for theta_i in [10.0, 40.0, 60.0, 84.0] {
        for (theta, phi) in [(5.0, 20.0), (60.0, 170.0), (85.0, 90.0)] {
            let f = lookup.brdf(sphere::direction_deg(theta_i, 33.0), sphere::direction_deg(theta, phi))[0];
            // A constant in f32, through weights that add up to 1.
            assert!((f * std::f64::consts::PI / 0.3 - 1.0).abs() < 1e-5, "{theta_i} {theta} {phi}: {f}");
        }
    }
}

#[test]
fn a_lobe_on_paint_keeps_its_albedo() {
    let painted = Painted { paint: 0.4, lobe: Some((0.5, Ggx::new(0.1, 0.1))) };
    let own = table(&painted, &hemisphere(steps(15.0, 6), None, 90, 180));
    let lookup = Lookup::new(&own).expect("a product");
    for (theta_i, lobe) in TENTH {
        let (found, wanted) = (albedo(&lookup, theta_i, 10.0), 0.4 + 0.5 * lobe);
        assert!((found / wanted - 1.0).abs() <= 0.01, "{theta_i}: {found} {wanted}");
    }
}

/// A quarter of the azimuths, and a campaign that made it.
fn quarter(campaign: &str) -> BrdfTable {
    let grid = hemisphere(steps(15.0, 6), Some(steps(22.5, 5)), 30, 72);
    BrdfTable { campaign: campaign.into(), ..table(&Ggx::new(0.2, 0.5), &grid) }
}

const BRUSHED: &str = "name = \"brushed\"\nseed = 1\n[surface]\nrealisations = 4\ncells = 64\n[surface.ggx]\nalpha_x = 0.2\n\
    alpha_y = 0.5\n[light]\ntheta_i_deg = { from = 0, to = 75, step = 15 }\nazimuth = \"absolute\"\n\
    phi_i_deg = [0, 22.5, 45, 67.5, 90]\n[sensor.hemisphere]\ntheta_r_bins = 30\nphi_r_bins = 72\n[stop]\nsamples = 4096\n";

#[test]
fn a_quarter_of_the_azimuths_is_unfolded() {
    let ggx = Ggx::new(0.2, 0.5);
    let lookup = Lookup::new(&quarter(BRUSHED)).expect("symmetric");
    assert_eq!(lookup.phi_i().len(), 16);
    for phi_i in [22.5, 157.5, 202.5, 337.5] {
        let wi = sphere::direction_deg(30.0, phi_i);
        for turn in [140.0, 180.0, 205.0] {
            let wo = sphere::direction_deg(35.0, phi_i + turn);
            let (found, wanted) = (lookup.brdf(wi, wo)[0], ggx.brdf(wi, wo)[0]);
            // Bins of 3 x 5 degrees through a cubic: of fourth order in a fifth of the lobe's slope.
            assert!((found / wanted - 1.0).abs() < 5e-3, "{phi_i} {turn}: {found} {wanted}");
        }
    }
}

#[test]
fn an_imported_quarter_is_refused() {
    let why = Lookup::new(&quarter("")).err().expect("its other azimuths are not known");
    assert!(why.to_string().contains("gap of 270"), "{why}");
}

#[test]
fn exports_say_their_albedo_beside_the_tables() {
    let folder = tempfile::tempdir().expect("folder");
    let own = table(&Ggx::new(0.3, 0.3), &hemisphere(steps(15.0, 6), None, 45, 90));
    let written =
        export(&own, Format::Rgl, &Options::default(), &folder.path().join("f.bsdf")).expect("written");
    let curve = written.albedo.expect("light");
    assert!(curve.worst <= 0.01, "{}", curve.worst);
    let thetas: Vec<f64> = curve.by_theta().iter().map(|row| row[0]).collect();
    // Incidences, a place between two of them (0.381966 of the way), and the end of the hemisphere.
    assert!(thetas.contains(&15.0) && thetas.contains(&20.7295) && thetas.contains(&85.0), "{thetas:?}");
}

/// A curve of two points, light from the normal and from 70 degrees.
fn curve(table: f64, files: [f64; 2], theta_i_last_deg: f64) -> AlbedoCurve {
    let point = |theta_i_deg, file: f64| AlbedoPoint {
        theta_i_deg,
        phi_i_deg: 0.0,
        table: vec![table],
        file: vec![file],
    };
    let points = vec![point(0.0, files[0]), point(70.0, files[1])];
    let worst = (files[1] / table - 1.0).abs();
    AlbedoCurve { points, theta_i_last_deg, theta_r_up_to_deg: 90.0, through: false, worst, worst_point: 1 }
}

#[test]
fn an_export_that_makes_light_is_refused() {
    // Whatever is allowed otherwise.
    let check = |table: f64, file: f64| curve(table, [table, file], 80.0).check_no_gain();
    assert!(
        check(0.95, 1.339).expect_err("makes light").to_string().contains("1.3390 under light from 70.00")
    );
    // Two hundredths are allowed above 1, and above a table that has more itself.
    assert!(check(0.95, 1.019).is_ok() && check(1.3, 1.32).is_ok());
    assert!(check(0.95, 1.021).is_err() && check(1.3, 1.33).is_err());
}

#[test]
fn an_export_with_another_albedo_is_refused_unless_allowed() {
    let off = curve(0.8, [0.8, 0.82], 80.0);
    let why = off.check(0.01).expect_err("2.5 % off").to_string();
    assert!(why.contains("0.8200 where the table's is 0.8000 (2.5 % off), light 70.00 0.00"), "{why}");
    assert!(why.ends_with("--allow-albedo-error 3") && !why.contains('\n'), "{why}");
    assert!(off.check(0.03).is_ok() && off.note().expect("is said").contains("do not hold the lobe"));
    assert!(curve(0.8, [0.8, 0.8079], 80.0).check(0.01).is_ok());
    // Beyond the table's incidences there is no albedo to be held to.
    let beyond = curve(0.8, [0.8, 0.82], 60.0);
    assert!(beyond.check(0.01).is_ok() && beyond.note().expect("is said").contains("both are guesses"));
}

/// What an export promises, by a rule of this file: half-way places are what formats that halve gaps are good at, so the
/// light comes from others. Held to the interpolant, whose own distance from the formula has its tests above.
#[test]
fn every_resampled_file_has_the_albedo_of_its_table() {
    let folder = tempfile::tempdir().expect("folder");
    // A tree of a lobe twice as wide has a tenth of the cells. MERL's million cells are in `interchange_merl`.
    for (format, alpha) in [(Format::Rgl, 0.3), (Format::Zemax, 0.3), (Format::TensorTree, 0.6)] {
        let own = table(&Ggx::new(alpha, alpha), &hemisphere(vec![0.0, 30.0, 60.0, 80.0], None, 45, 90));
        let path = folder.path().join(format.name());
        let written = export(&own, format, &Options::default(), &path).unwrap_or_else(|why| panic!("{why}"));
        let bytes = std::fs::read(&path).expect("written");
        let file: Box<dyn Brdf> = match format {
            Format::Rgl => Box::new(rgl::read(&bytes).expect("sound")),
            Format::Zemax => Box::new(zemax::read(&bytes).expect("sound")),
            _ => Box::new(tensor_tree::read(&bytes).expect("sound")),
        };
        if format == Format::TensorTree {
            // Divided until the cells' steps make one to two per cent of the sum.
            let l1 = written.read_back.expect("light").l1;
            assert!(l1 > 0.0 && l1 <= 0.02, "{l1}");
        }
        let lookup = Lookup::new(&own).expect("a product");
        for theta_i in [10.0, 40.0, 72.0] {
            // Three times as wide a lobe as above, and wider: steps twice as long.
            let [found, wanted] =
                [file.as_ref(), &lookup].map(|brdf| albedo_by(brdf, theta_i, 10.0, 0.5, 2.0));
            // The bar of the issue, and this rule's 0.1 %.
            assert!((found / wanted - 1.0).abs() <= 0.011, "{}, {theta_i}: {found} {wanted}", format.name());
        }
    }
}
