//! Promise: one pass over the surface serves every material. What is recoloured is what would have been traced, what
//! is traced together is what would have been traced alone, and polarised light adds up.

use std::fs;
use std::path::Path;

use gonio::campaign::{self, Campaign};
use gonio::interchange::{self, Format, Options};
use gonio::measure::Measured;
use gonio::measure::optics::reflectances_of;
use gonio::optics::FacetAngle;
use gonio::sphere::sin_cos_deg;
use gonio::table::recolour::recolour;
use gonio::table::{BrdfTable, Realisations, realisations, store};
use gonio::validate::prediction::schlick_error::SchlickError;
use gonio::validate::{self};

use crate::support::long::or_long;
use crate::support::measuring::{by_few, measured, measured_in, measured_one, measured_with};
use crate::support::program::{exits, gonio, json};

/// What is compared are the same paths: few do.
const SAMPLES: u64 = 4096;

fn rough(alpha: &str, optics: &str, trace: &str) -> String {
    format!(
        "name = \"metal\"\nseed = 5\n[surface]\nrealisations = 4\ncells = 64\ncorrelation_cells = 4\n\
         [surface.ggx]\nalpha = {alpha}\n[light]\ntheta_i_deg = [0, 60]\n\
         [sensor.hemisphere]\ntheta_r_bins = 9\nphi_r_bins = 12\n{optics}\n[trace]\n{trace}\n[stop]\nsamples = {SAMPLES}\n"
    )
}

/// Measured with materials traced along, not put in afterwards.
fn traced(text: &str) -> Measured {
    measured_with(text, |plan| {
        by_few(plan, SAMPLES);
        plan.sums = plan.sums.clone().traced();
    })
}

fn mirror(theta_i_deg: &str, optics: &str) -> String {
    format!(
        "name = \"mirror\"\n[surface]\nrealisations = 2\n[surface.mirror]\n[light]\ntheta_i_deg = {theta_i_deg}\n\
         [sensor.hemisphere]\ntheta_r_bins = 9\nphi_r_bins = 12\n{optics}\n[stop]\nsamples = 65_536\n"
    )
}

fn optics(keys: &str) -> String {
    format!("[optics]\n{keys}\n")
}

/// Every channel of `found` within `relative` of the bin's value in `wanted`: errors of means of f32 values scatter with
/// the values' rounding, not with their own size.
#[track_caller]
fn near(found: &BrdfTable, wanted: &BrdfTable, relative: f64) {
    assert_eq!((&found.campaign, &found.hits), (&wanted.campaign, &wanted.hits));
    assert_eq!(found.colours.len(), wanted.colours.len());
    for (found, wanted) in found.colours.iter().zip(&wanted.colours) {
        let close = |what: &str, found: &[f32], wanted: &[f32], size: &[f32]| {
            assert_eq!(found.len(), wanted.len());
            for (at, (&a, &b)) in found.iter().zip(wanted).enumerate() {
                let allowed = relative * f64::from(size[at].max(b.abs()));
                assert!(
                    (f64::from(a) - f64::from(b)).abs() <= allowed,
                    "{what}, entry {at}: {a} {b} of {}",
                    size[at]
                );
            }
        };
        close("single", &found.single, &wanted.single, &wanted.single);
        close("total", &found.total, &wanted.total, &wanted.total);
        close("multiple", &found.multiple, &wanted.multiple, &wanted.total);
        close("stderr", &found.stderr, &wanted.stderr, &wanted.total);
        close("stderr_single", &found.stderr_single, &wanted.stderr_single, &wanted.total);
        assert_eq!(found.orders.len(), wanted.orders.len());
        for (found, order) in found.orders.iter().zip(&wanted.orders) {
            close("order", found, order, &wanted.total);
        }
    }
}

#[track_caller]
fn parts_near(found: &Realisations, wanted: &Realisations, relative: f32) {
    assert_eq!(found.parts.len(), wanted.parts.len());
    for (found, wanted) in found.parts.iter().zip(&wanted.parts) {
        let pairs = found.total.iter().zip(&wanted.total).chain(found.single.iter().zip(&wanted.single));
        for (&a, &b) in pairs.flat_map(|(found, wanted)| found.iter().zip(wanted)) {
            assert!((a - b).abs() <= relative * b, "{a} {b}");
        }
    }
}

fn f0_of(measured: &Measured) -> [f64; 3] {
    match measured.campaign.optics {
        campaign::Optics::Schlick { f0, .. } => f0,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn a_recoloured_table_is_the_traced_one() {
    let one = |keys: &str| rough("0.2", &optics(keys), "bounces = 1");
    let source = measured_one(&one("material = \"copper\""));
    for keys in ["material = \"gold\"", "f0 = [0.1, 0.55, 0.9]", "material = \"glass\"", "f0 = 0"] {
        let by_sums = measured_one(&one(keys));
        let by_path = traced(&one(keys));
        let text = by_sums.table.campaign.clone();
        let (table, parts) =
            recolour(&source.table, Some(&source.realisations), f0_of(&by_sums), text.clone())
                .expect("has sums");
        let parts = parts.expect("the realisations hold sums");
        for wanted in [&by_sums, &by_path] {
            // f32: one rounding of the two sums, one of each realisation, one of the mean, 6e-8 each.
            near(&table, &wanted.table, 1e-6);
            parts_near(&parts, &wanted.realisations, 1e-6);
            for (incidence, result) in wanted.incidences.iter().enumerate() {
                let albedo =
                    (0..3).map(|c| flux(&table, incidence, &table.colours[c].total)).sum::<f64>() / 3.0;
                let wanted = gonio::stats::mean(&result.albedo_by_order[0]);
                assert!((albedo - wanted).abs() <= 1e-6 * wanted, "{albedo} {wanted}");
            }
        }
        // Without the realisations the values are the same, and no error is made up.
        let (alone, none) = recolour(&source.table, None, f0_of(&by_sums), text).expect("has sums");
        assert!(none.is_none());
        for (alone, with) in alone.colours.iter().zip(&table.colours) {
            assert!(alone.total.iter().zip(&with.total).all(|(a, b)| (a - b).abs() <= 1e-6 * b));
            for ((&error, &known), &hits) in alone.stderr.iter().zip(&with.stderr).zip(&table.hits) {
                assert_eq!(error, if hits == 0 { known } else { -1.0 });
            }
        }
    }
}

fn flux(table: &BrdfTable, incidence: usize, values: &[f32]) -> f64 {
    let regions = table.grid.regions(incidence);
    let here = values[incidence * table.grid.bins()..].iter().zip(&regions);
    here.map(|(&value, region)| f64::from(value) * region.projected_solid_angle()).sum()
}

#[test]
fn orders_follow_from_their_parts() {
    for by_order in [false, true] {
        let trace = format!("bounces = 8\nby_order = {by_order}");
        let one = |keys: &str| rough("1.0", &optics(keys), &trace);
        let source = measured_one(&one("material = \"silver\""));
        for keys in ["material = \"copper\"", "f0 = [0.04, 0.5, 1]"] {
            let wanted = traced(&one(keys));
            let text = wanted.table.campaign.clone();
            let (table, parts) =
                recolour(&source.table, Some(&source.realisations), f0_of(&wanted), text).expect("has sums");
            // Up to 42 sums of f32 rounding 6e-8 each, all positive.
            near(&table, &wanted.table, 1e-5);
            parts_near(&parts.expect("sums"), &wanted.realisations, 1e-5);
            let colour = &table.colours[1];
            assert_eq!(colour.orders.len(), if by_order { 7 } else { 0 });
            for (at, &multiple) in colour.multiple.iter().enumerate().filter(|_| by_order) {
                let sum: f32 = colour.orders.iter().map(|order| order[at]).sum();
                // Differences and sums of f32 values of the total's size.
                assert!((sum - multiple).abs() <= 1e-5 * colour.total[at].max(1e-30), "{sum} {multiple}");
            }
        }
    }
}

#[test]
fn materials_of_one_pass_are_those_of_separate_runs() {
    let bytes = |m: &Measured| {
        let parts = realisations::encode(&m.realisations, &m.table, 1).expect("encodes");
        (store::encode(&m.table).expect("encodes"), parts, format!("{:?}", m.incidences))
    };
    for (law, bounces) in [("exact", 1), ("exact", 3), ("schlick", 2)] {
        let trace = format!("bounces = {bounces}");
        let names = ["gold", "silver", "copper"];
        let all = format!("materials = {names:?}\nfresnel = \"{law}\"");
        let together = measured(&rough("0.5", &optics(&all), &trace));
        assert_eq!(together.len(), 3);
        for (name, together) in names.iter().zip(&together) {
            let keys = format!("material = \"{name}\"\nfresnel = \"{law}\"");
            let alone = measured_one(&rough("0.5", &optics(&keys), &trace));
            assert!(bytes(together) == bytes(&alone), "{name} {law} {bounces}");
        }
    }
}

#[test]
fn a_mirror_reflects_what_fresnels_equations_say() {
    for keys in [
        "eta = 1.5",
        "eta = 0.2\nk = 3.4",
        "material = \"gold\"",
        "eta = [1.5, 0.4]\nk = [0, 2.5]\nwavelength_nm = [500, 600]",
        "eta = 1.5\npolarisation = \"s\"",
        "material = \"copper\"\npolarisation = \"p\"",
    ] {
        let m = measured_one(&mirror("[0, 40, 75, 89]", &optics(&format!("{keys}\nfresnel = \"exact\""))));
        let reflectances = reflectances_of(&m.campaign.optics);
        for (result, theta) in m.incidences.iter().zip([0.0, 40.0, 75.0, 89.0]) {
            let (sin, cos) = sin_cos_deg(theta);
            let at = |r: &gonio::optics::reflectance::Reflectance| r.at(FacetAngle { cos, sin2: sin * sin });
            let wanted = reflectances.iter().map(at).sum::<f64>() / reflectances.len() as f64;
            let found = gonio::stats::mean(&result.albedo_by_order[0]);
            // Directions to 1e-16, 1 - c to a few ulp; at 89 degrees c = 0.017 moves F by up to 100 of them.
            assert!((found - wanted).abs() < 1e-12, "{keys} {theta}: {found} {wanted}");
        }
    }
}

#[test]
fn s_and_p_tables_add_up_to_the_unpolarised_one() {
    let keys = |polarisation: &str| {
        optics(&format!("eta = 1.5\nfresnel = \"exact\"\npolarisation = {polarisation}"))
    };
    let both = measured(&rough("0.5", &keys("[\"s\", \"p\"]"), "bounces = 1"));
    let plain = measured_one(&rough("0.5", &keys("\"none\""), "bounces = 1"));
    let [s, p] = [&both[0].table, &both[1].table].map(|table| &table.colours[0].single);
    for ((&s, &p), &plain) in s.iter().zip(p).zip(&plain.table.colours[0].single) {
        // Three values rounded twice to f32.
        assert!((0.5 * (s + p) - plain).abs() <= 3e-7 * plain && s >= p, "{s} {p} {plain}");
    }
    // Brewster's angle, atan 1.5: R_p = 0 and R_s = ((n^2-1)/(n^2+1))^2, in closed form.
    let brewster = 1.5f64.atan().to_degrees();
    let at_brewster = measured(&mirror(&format!("[{brewster}]"), &keys("[\"s\", \"p\"]")));
    let [s, p] = [0, 1].map(|k| gonio::stats::mean(&at_brewster[k].incidences[0].albedo_by_order[0]));
    assert!((s - (1.25f64 / 3.25).powi(2)).abs() < 1e-12 && p < 1e-24, "{s} {p}");
}

fn model_of(measured: &Measured, campaign: &Campaign) -> validate::Verdict {
    validate::examine(&measured.table, campaign, Some(&measured.realisations))
}

#[test]
fn the_model_has_the_fresnel_of_the_campaign() {
    let samples = or_long(32_768u32, 131_072);
    let smith = |keys: &str| {
        format!(
            "name = \"smith\"\nseed = 2\n[surface]\nrealisations = 16\n[surface.smith]\nalpha = 0.4\n\
             [light]\ntheta_i_deg = [10, 60]\n[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 12\n\
             [optics]\n{keys}\n[stop]\nsamples = {samples}\n"
        )
    };
    for keys in ["eta = 0.2\nk = 1.1", "eta = 1.5\npolarisation = \"s\"", "eta = 1.5\npolarisation = \"p\""] {
        let m = measured_one(&smith(&format!("{keys}\nfresnel = \"exact\"")));
        // On this surface the formula is exact: every bin is held to Sidak's limit.
        let verdict = model_of(&m, &m.campaign);
        assert!(verdict.ok, "{keys}: {:?}", verdict.failures);
        // The power of it: Schlick's formula for the same index is told from it.
        let schlick = campaign::parse(smith(keys.split('\n').next().unwrap()), "c", Path::new(""));
        let verdict = model_of(&m, &schlick.expect("sound").campaign);
        assert!(!verdict.ok, "{keys}");
    }
}

#[test]
fn wavelengths_name_the_channels() {
    let folder = tempfile::tempdir().expect("temporary folder");
    fs::write(
        folder.path().join("n.csv"),
        "wavelength_nm,n,k\n450,1.4,2\n500.5,1.2,2.2\n600,0.3,2.9\n650,0.2,3.3\n",
    )
    .expect("writes");
    let listed = "eta = [1.4, 1.2, 0.3, 0.2]\nk = [2, 2.2, 2.9, 3.3]\nwavelength_nm = [450, 500.5, 600, 650]";
    let exact = |keys: &str| rough("0.3", &optics(&format!("{keys}\nfresnel = \"exact\"")), "bounces = 2");
    let from_file = measured_in(folder.path(), &exact("file = \"n.csv\"")).pop().expect("one table");
    let from_list = measured_one(&exact(listed));
    assert_eq!(from_file.table.colour_names(), ["w450", "w500_5", "w600", "w650"]);
    let bytes = |m: &Measured| store::encode(&m.table).expect("encodes");
    // The table holds the numbers: it needs no file.
    assert!(bytes(&from_file) == bytes(&from_list));
    let back = store::decode(Path::new("t.exr"), &bytes(&from_file)).expect("decodes");
    assert!(back.table == from_file.table && back.warnings.is_empty(), "{:?}", back.warnings);
    let encoded = realisations::encode(&from_file.realisations, &from_file.table, 1).expect("encodes");
    let parts = realisations::decode(Path::new("t.exr"), &encoded).expect("decodes");
    assert!(parts.realisations == from_file.realisations);
    let to = |format: Format, name: &str| {
        interchange::export(&from_file.table, format, &Options::default(), &folder.path().join(name))
    };
    to(Format::Npz, "t.npz").expect("npz holds wavelengths");
    for (format, name) in [(Format::Merl, "t.binary"), (Format::Zemax, "t.bsdf"), (Format::Rgl, "t.bsdf")] {
        let why = to(format, name).expect_err("must be refused").to_string();
        assert!(why.contains("the table has 4 wavelengths"), "{why}");
    }
    // Three are R, G, B, the longest first; chosen ones lie between the lines.
    let three = measured_in(folder.path(), &exact("file = \"n.csv\"\nwavelength_nm = [450, 625, 650]"));
    assert_eq!(three[0].table.colour_names(), ["R", "G", "B"]);
    assert_eq!(three[0].table.colours[0].single, from_file.table.colours[3].single);
}

#[test]
fn schlick_is_exact_at_normal_and_grazing_incidence_alone() {
    let glass = measured_one(&mirror("[0, 60]", &optics("eta = 1.5\nfresnel = \"exact\"")));
    let error = SchlickError::of(&glass.campaign, &glass.table).expect("an index");
    assert!((error.colours[0].f0 - 0.04).abs() < 1e-15);
    // At 60 degrees g^2 = 3/2; r_s = 1.25/(0.5 + g)^2, r_p = -1.25 x 0.1875/(1.125 + g)^2.
    let g = 1.5f64.sqrt();
    let exact = 0.5 * ((1.25 / (0.5 + g).powi(2)).powi(2) + (1.25 * 0.1875 / (1.125 + g).powi(2)).powi(2));
    let schlick = 0.04 + 0.96 / 32.0;
    let [normal, oblique] = &error.incidences[..] else { panic!() };
    // f32 table: 6e-8 relative, three roundings.
    assert!((normal.albedo_exact - 0.04).abs() < 1e-8 && (normal.albedo_schlick - 0.04).abs() < 1e-8);
    assert!((oblique.albedo_exact - exact).abs() < 3e-8, "{oblique:?}");
    assert!((oblique.albedo_schlick - schlick).abs() < 3e-8, "{oblique:?}");
    assert!((oblique.l1 - (exact - schlick) / exact).abs() < 1e-6, "{oblique:?}");
    // A name under Schlick's formula: only the formulae are compared.
    let gold = measured_one(&mirror("[0]", &optics("material = \"gold\"")));
    assert!(SchlickError::of(&gold.campaign, &gold.table).expect("known").incidences.is_empty());
    let skin = measured_one(&mirror("[0]", &optics("material = \"skin\"")));
    assert!(SchlickError::of(&skin.campaign, &skin.table).is_none());
}

#[test]
fn recolour_says_what_it_cannot_do() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let at = folder.path();
    fs::write(at.join("white.toml"), mirror("[0, 60]", "")).expect("writes");
    fs::write(at.join("gold.toml"), mirror("[0, 60]", &optics("material = \"gold\""))).expect("writes");
    for name in ["white", "gold"] {
        exits(&gonio(at, &["measure", &format!("{name}.toml"), "-o", name]), 0);
    }
    let run = |table: &str, rest: &[&str]| gonio(at, &[&["recolour", table], rest].concat());
    let stderr = exits(&run("white/mirror.exr", &["--material", "gold", "-o", "x.exr"]), 3);
    assert!(stderr.lines().count() == 1 && stderr.contains("no `schlick` sums"), "{stderr}");
    assert!(!at.join("x.exr").exists());
    let stderr = exits(&run("gold/mirror.exr", &["--material", "goldd", "-o", "x.exr"]), 2);
    assert!(stderr.contains("did you mean `gold`?"), "{stderr}");
    let stderr = exits(&run("gold/mirror.exr", &["--f0", "0.5,2,0.5", "-o", "x.exr"]), 2);
    assert!(stderr.contains("must lie in [0, 1]"), "{stderr}");
    exits(&run("gold/mirror.exr", &["-o", "x.exr"]), 2);
    let copper = run("gold/mirror.exr", &["--material", "copper", "-o", "x.exr", "--json"]);
    assert_eq!(exits(&copper, 0), "");
    let json = json(&copper);
    // At normal incidence a mirror's albedo is F0: the mean of 0.955, 0.638 and 0.538; f32.
    let albedo = json["stops"][0]["albedo_total"].as_f64().expect("a number");
    assert!((albedo - 2.131 / 3.0).abs() < 1e-6, "{albedo}");
    exits(&gonio(at, &["validate", "x.exr"]), 0);
    let stderr = exits(&run("gold/mirror.exr", &["--material", "iron", "-o", "x.exr"]), 3);
    assert!(stderr.contains("is there already"), "{stderr}");
    fs::remove_file(at.join("gold/mirror.realisations.exr")).expect("removes");
    let stderr = exits(&run("gold/mirror.exr", &["--f0", "0.04", "-o", "x.exr", "--force"]), 0);
    assert!(stderr.contains("errors of x.exr are not available"), "{stderr}");
    assert!(!at.join("x.realisations.exr").exists());
}
