//! Promise: a scan whose sensor went to other directions under each light is read as it is. What was not measured is a
//! gap: it is no darkness, comes back from every format that can leave it out, and is filled in on demand alone.

use gonio::fit::{self, FitData, FitLaw, MicrofacetLaw};
use gonio::instrument::Grid;
use gonio::interchange;
use gonio::interchange::text::{csv, samples::one_azimuth};
use gonio::interchange::{Brdf, Format, Options, resample};
use gonio::sphere::direction_deg;
use gonio::table::{BrdfTable, store};
use gonio::theory::{Masking, Ndf};
use gonio::validate::two_tables::{ComparedTable, difference};

use crate::support::analytic::{Ggx, points, steps, table};

/// A list of what `brdf` is at each (theta_i, theta_r, phi_r), the light at azimuth 0.
fn scan(brdf: &dyn Brdf, samples: &[[f64; 3]]) -> String {
    let line = |&[light, theta, phi]: &[f64; 3]| {
        let value = brdf.brdf(direction_deg(light, 0.0), direction_deg(theta, phi))[0];
        format!("{light},0,{theta},{phi},{value}\n")
    };
    "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n".to_string()
        + &samples.iter().map(line).collect::<String>()
}

/// Two lights; the first lacks 30 degrees, the second 20.
fn ragged() -> BrdfTable {
    let samples =
        [[0.0, 10.0], [0.0, 20.0], [40.0, 10.0], [40.0, 30.0]].map(|[light, theta]| [light, theta, 180.0]);
    csv::read(scan(&Ggx::new(0.5, 0.5), &samples).as_bytes()).expect("a scan")
}

fn gaps(table: &BrdfTable) -> Vec<usize> {
    (0..table.hits.len()).filter(|&entry| table.is_gap(entry)).collect()
}

#[test]
fn what_a_light_lacks_is_a_gap() {
    let found = ragged();
    assert_eq!(found.grid.points_deg, [[10.0, 180.0], [20.0, 180.0], [30.0, 180.0]]);
    assert_eq!((found.grid.incidences(), gaps(&found)), (2, vec![2, 4]));
    let ggx = Ggx::new(0.5, 0.5);
    for (incidence, light) in [0.0, 40.0].into_iter().enumerate() {
        for (bin, theta) in [10.0, 20.0, 30.0].into_iter().enumerate() {
            let value = ggx.brdf(direction_deg(light, 0.0), direction_deg(theta, 180.0))[0] as f32;
            let at = incidence * 3 + bin;
            assert_eq!(found.colours[0].total[at], if found.is_gap(at) { 0.0 } else { value });
            assert_eq!(found.hits[at], u32::from(!found.is_gap(at)));
        }
    }
}

/// The azimuths from the light are the same though the absolute ones differ, all but one: no scan of 24 directions.
#[test]
fn a_scan_that_turns_with_the_light_has_the_gaps_of_one_that_does() {
    let line = |light: f64, bin: usize| format!("30,{light},20,{},0.25\n", light + 30.0 * bin as f64);
    let lines = [0.0, 17.0].into_iter().flat_map(|light| (0..12).map(move |bin| line(light, bin)));
    let text: String = lines.take(23).collect();
    let text = format!("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n{text}");
    let found = csv::read(text.as_bytes()).expect("a scan");
    assert!(found.grid.phi_r_relative);
    assert_eq!((found.grid.incidences(), found.grid.bins(), gaps(&found)), (2, 12, vec![23]));
}

#[test]
fn gaps_come_back_from_every_format_that_can_leave_them_out() {
    let folder = tempfile::tempdir().expect("folder");
    let (wanted, stored) = (ragged(), folder.path().join("table.exr"));
    store::save(&stored, &wanted).expect("stored");
    assert_eq!(store::load(&stored).expect("loaded").table, wanted);
    // OpenMATERIAL's rows have a wavelength, and no azimuth of the light; neither have FRED's.
    let options = Options { wavelengths_nm: vec![550.0], ..Options::default() };
    let isotropic = one_azimuth(wanted.clone()).expect("a single azimuth");
    for (name, format) in Format::ALL.map(|format| (format.name(), format)) {
        let path = folder.path().join(name);
        let table = if matches!(format, Format::OpenMaterial | Format::Fred) { &isotropic } else { &wanted };
        let export = interchange::export(table, format, &options, &path);
        if !format.codec().traits().gaps {
            let why = export.expect_err(name).to_string();
            assert!(why.contains("2 of 6 pairs of directions were not measured"), "{name}: {why}");
            continue;
        }
        assert_eq!(export.expect(name).read_back.expect("light").l1, 0.0, "{name}");
        if format == Format::Pabopto {
            let text = std::fs::read_to_string(path.join("stop_0001.txt")).expect("there");
            assert!(text.contains("\n10 180 ") && !text.contains("\n20 180 ") && text.contains("\n30 180 "));
        } else {
            let (found, _) = interchange::import(&path, format, &options, None).expect(name);
            let by_angle = |table: &BrdfTable| {
                let bins = table.grid.bins();
                let mut all: Vec<_> = (0..table.hits.len())
                    .filter(|&at| !table.is_gap(at))
                    .map(|at| {
                        let [theta, phi] = table.grid.points_deg[at % bins];
                        let light = table.grid.incidence_deg(at / bins).0;
                        // ASTM's twelve digits of radians.
                        let angles = [light, theta, phi].map(|deg| (deg * 1e6).round() as i64);
                        (angles, table.colours[0].total[at].to_bits())
                    })
                    .collect();
                all.sort_unstable();
                all
            };
            assert_eq!(by_angle(&found), by_angle(&wanted), "{name}");
            assert_eq!(found.gaps(), 2, "{name}");
        }
    }
}

#[test]
fn gaps_are_no_difference_and_no_darkness() {
    let wanted =
        table(&Ggx::new(0.5, 0.5), &points(vec![0.0, 40.0], vec![0.0], &[10.0, 20.0, 30.0], &[180.0]));
    let mut scanned = wanted.clone();
    scanned.set_gap(2);
    let side = |table| ComparedTable::of(table);
    for (a, b) in [(&wanted, &scanned), (&scanned, &wanted)] {
        assert_eq!(difference(side(a), side(b)).expect("one grid").figures.l1, Some(0.0));
    }
    let law = FitLaw::Microfacet(MicrofacetLaw::new(Ndf::Ggx, Masking::Separable, false));
    let fits = fit::fit(&FitData::new(&ragged(), None, None), &[law]).fits;
    let alpha = fits[0].parameters.get("alpha").expect("alpha");
    // Values are f32 of the law itself.
    assert!((alpha - 0.5).abs() < 1e-4, "{alpha}");
}

/// A list whose directions all differ would make a table of the square of its size.
#[test]
fn a_list_without_common_directions_is_refused() {
    let lines = |count: usize| {
        let line = |k: usize| format!("{},0,{},180,0.25\n", k as f64 * 0.01, k as f64 * 0.01 + 0.005);
        let text: String = (0..count).map(line).collect();
        csv::read(format!("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n{text}").as_bytes())
    };
    assert_eq!(lines(100).expect("small").gaps(), 9900);
    let why = lines(3000).expect_err("8,997,000 gaps").to_string();
    assert!(why.contains("3000 lights") && why.contains("at most 4194304 gaps"), "{why}");
}

/// Each light lacks the directions within 10 degrees of itself, where the lamp is in the sensor's way; the pole is
/// there once.
fn without_the_lamp(ggx: &Ggx) -> BrdfTable {
    let mut samples = Vec::new();
    for light in [0.0, 20.0, 40.0] {
        samples.push([light, 0.0, 0.0]);
        for theta in steps(5.0, 17).into_iter().skip(1) {
            let ring = steps(15.0, 24).into_iter().map(|phi| [light, theta, phi]);
            let free = |s: &[f64; 3]| {
                direction_deg(light, 0.0).dot(direction_deg(s[1], s[2])) < 10f64.to_radians().cos()
            };
            samples.extend(ring.filter(free));
        }
    }
    // Seen from the light itself the pole is in its way too.
    csv::read(scan(ggx, &samples[1..]).as_bytes()).expect("a scan")
}

#[test]
fn a_ragged_scan_is_filled_from_its_own_rows() {
    let ggx = Ggx::new(0.5, 0.5);
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("scan.csv");
    let scanned = without_the_lamp(&ggx);
    assert!(scanned.gaps() > 50, "{}", scanned.gaps());
    interchange::export(&scanned, Format::Csv, &Options::default(), &path).expect("written");
    let like = Grid {
        theta_i_deg: vec![0.0, 20.0, 40.0],
        phi_i_deg: vec![0.0],
        phi_r_relative: true,
        theta_r_edges_deg: steps(5.0, 17),
        phi_r_edges_deg: steps(15.0, 25),
        ..Grid::default()
    };
    let options = Options { isotropic: true, ..Options::default() };
    let (found, notes) = interchange::import(&path, Format::Csv, &options, Some(&like)).expect("filled");
    assert!(notes[0].contains("were not measured: filled in by cubic interpolation"), "{notes:?}");
    let wanted = resample(&ggx, &like).expect("a sound grid");
    // D as a function of the sensor's angle is (1 + theta^2)^-2 for alpha 0.5: its fourth derivative is 72 at most. Over
    // the widest gap, 20 degrees with nodes 5 beyond, the cubic is off by 72/24 * (10 * 15)^2 deg^4 = 0.6 % of the peak;
    // left dark, the gap would be off by the peak itself.
    let peak = wanted.colours[0].total.iter().fold(0f32, |peak, &value| peak.max(value));
    let pairs = found.colours[0].total.iter().zip(&wanted.colours[0].total);
    let worst = pairs.map(|(f, g)| (f - g).abs()).fold(0f32, f32::max);
    assert!(worst < 0.006 * peak, "{worst} of {peak}");
}

#[test]
fn a_scan_of_too_little_is_not_filled() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("scan.csv");
    let like = Grid {
        theta_i_deg: vec![0.0, 40.0],
        phi_i_deg: vec![0.0],
        phi_r_relative: true,
        theta_r_edges_deg: steps(30.0, 4),
        phi_r_edges_deg: steps(90.0, 5),
        ..Grid::default()
    };
    let reason = |samples: &[[f64; 3]]| {
        std::fs::write(&path, scan(&Ggx::new(0.5, 0.5), samples)).expect("written");
        interchange::import(&path, Format::Csv, &Options::default(), Some(&like))
            .expect_err("refused")
            .to_string()
    };
    let mirror = |k: usize| [40.0 * (k % 2) as f64, 10.0 + 7.0 * k as f64, 40.0 + 50.0 * k as f64];
    let why = reason(&(0..8).map(mirror).collect::<Vec<_>>());
    assert!(why.contains("too few to fill in the rest"), "{why}");
    let plane =
        [[0.0, 10.0], [0.0, 20.0], [40.0, 20.0], [40.0, 10.0], [0.0, 30.0]].map(|[i, r]| [i, r, 180.0]);
    let why = reason(&plane);
    assert!(why.contains("gap of 360 degrees"), "{why}");
}
