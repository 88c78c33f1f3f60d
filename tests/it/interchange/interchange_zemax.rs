//! Promise: Zemax files are read as their angles are meant, in every spelling that is about, and those that are written
//! integrate to the albedo that they name.

use std::f64::consts::PI;

use gonio::interchange::text::zemax;
use gonio::interchange::{Brdf, Format, Lookup, Options, import};
use gonio::sphere::direction_deg;

use crate::support::analytic::{Ggx, hemisphere, table};
use crate::support::mutations;

/// A file of these lists, whose blocks are (TIS, values).
fn file(symmetry: &str, lists: [&str; 4], blocks: &[(f64, String)]) -> String {
    let keys = ["SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial"];
    let listed =
        keys.iter().zip(lists).map(|(key, list)| format!("{key} {}\n{list}\n", list.split(' ').count()));
    let data = blocks.iter().map(|(tis, values)| format!("TIS {tis}\n{values}\n"));
    format!(
        "# a sample\nSource  Measured\nSymmetry  {symmetry}\nSpectralContent  Monochrome\nScatterType  BRDF\n{}\n\
         Monochrome\nDataBegin\n{}DataEnd\n",
        listed.collect::<String>(),
        data.collect::<String>()
    )
}

/// Rows of equal values, one for each azimuth.
fn rows(values: &[f64], radials: usize) -> String {
    values.iter().map(|value| format!("{value} ").repeat(radials) + "\n").collect()
}

fn read(text: &str) -> (zemax::Zemax, Vec<String>) {
    zemax::read_with_notes(text.as_bytes()).expect("readable")
}

/// With the light at the normal and azimuth 0 the angles about the mirror direction are those of the sensor.
fn at(file: &zemax::Zemax, theta: f64, phi: f64) -> f64 {
    file.brdf(direction_deg(0.0, 0.0), direction_deg(theta, phi))[0]
}

/// Linear interpolation by hand: 2, 1, 0, 1 at 0, 90, 180, 270 is 1.5 at 45 and at 315, 0.5 at 135 and at 225. The values
/// are multiples of 1/2: exact but for the rounding of the angle.
#[test]
fn azimuths_go_round() {
    let lists = |azimuths| ["0", "0", azimuths, "0 30 60 90 180"];
    let open = file("Asymmetrical", lists("0 90 180 270"), &[(0.5, rows(&[2.0, 1.0, 0.0, 1.0], 5))]);
    let closed =
        file("Asymmetrical", lists("0 90 180 270 360"), &[(0.5, rows(&[2.0, 1.0, 0.0, 1.0, 2.0], 5))]);
    let signed =
        file("Asymmetrical", lists("-180 -90 0 90 180"), &[(0.5, rows(&[0.0, 1.0, 2.0, 1.0, 0.0], 5))]);
    let shifted = file("Asymmetrical", lists("-90 0 90 180"), &[(0.5, rows(&[1.0, 2.0, 1.0, 0.0], 5))]);
    for text in [open, closed, signed, shifted] {
        let (found, notes) = read(&text);
        for (azimuth, wanted) in
            [(315.0, 1.5), (45.0, 1.5), (225.0, 0.5), (135.0, 0.5), (270.0, 1.0), (0.0, 2.0)]
        {
            for theta in [10.0, 45.0, 80.0] {
                assert!((at(&found, theta, azimuth) - wanted).abs() < 1e-12, "{azimuth} {text}");
            }
        }
        assert!(!notes.iter().any(|note| note.contains("whole turn")), "{notes:?}");
    }
    // A plane of incidence that is a mirror reflects at 0 and at 180: 135 stands between 90 and its image at 270.
    let half = file("PlaneSymmetrical", lists("0 90"), &[(0.5, rows(&[2.0, 1.0], 5))]);
    for (azimuth, wanted) in [(315.0, 1.5), (45.0, 1.5), (135.0, 1.0), (225.0, 1.0), (180.0, 1.0)] {
        assert!((at(&read(&half).0, 40.0, azimuth) - wanted).abs() < 1e-12, "{azimuth}");
    }
    // Half a turn without any azimuth is no whole one.
    let forgotten = file("Asymmetrical", lists("0 60 120 180"), &[(0.5, rows(&[1.0; 4], 5))]);
    assert!(zemax::read(forgotten.as_bytes()).expect_err("half").to_string().contains("PlaneSymmetrical"));
}

#[test]
fn keywords_are_read_in_any_case_and_a_closed_seam_is_dropped() {
    // Ten rotations, the last that of the first; each block has its rotation as its value.
    let turns: Vec<f64> = (0..10).map(|k| 40.0 * f64::from(k)).collect();
    let listed = turns.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let block = |&turn: &f64| (0.1, rows(&[turn % 360.0 / 360.0; 5], 3));
    let blocks: Vec<_> = turns.iter().map(block).collect();
    let text = file("asymmetrical4D", [&listed, "0", "0 90 180 270 360", "0 90 180"], &blocks);
    let text = text.replace("SampleRotation", "SAMPLEROTATION").replace("DataBegin", "databegin");
    // ISO/IEC 8859-1: a degree sign is the byte 0xb0.
    let latin = [b"# 25 \xb0C\n", text.as_bytes()].concat();
    let (found, notes) = zemax::read_with_notes(&latin).expect("readable");
    assert!(!notes.iter().any(|note| note.contains("whole turn")), "{notes:?}");
    // Light at azimuth 40 sees the sample turned by 320.
    assert_eq!(found.phi_i_deg(), (0..9).map(|k| 40.0 * f64::from(k)).collect::<Vec<_>>());
    let value = |phi: f64| found.brdf(direction_deg(1e-3, phi), direction_deg(40.0, 77.0))[0];
    // The values are f32.
    assert!((value(40.0) - 320.0 / 360.0).abs() < 1e-7 && (value(0.0) - 0.0).abs() < 1e-7);
    assert!((value(20.0) - 160.0 / 360.0).abs() < 1e-7, "halfway between rotation 320 and 0 (the first)");
    // Where the ends differ, their mean is taken, and it is said.
    let differs = text.replacen("TIS 0.1\n0 0 0", "TIS 0.1\n0.2 0 0", 1);
    let (found, notes) = read(&differs);
    // One of the four corners of the seams of rotation and azimuth.
    assert!((found.values[0][0] - 0.05).abs() < 1e-7);
    assert!(notes.iter().any(|note| note.contains("whole turn apart differ")), "{notes:?}");
    assert!(mutations::survives(&latin, 20_000, zemax::read) > 5_000);
}

#[test]
fn three_channels_are_x_y_and_z_by_their_names() {
    let rgb = [0.9, 0.5, 0.2];
    // IEC 61966-2-1.
    let xyz = [
        0.4124 * rgb[0] + 0.3576 * rgb[1] + 0.1805 * rgb[2],
        0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2],
        0.0193 * rgb[0] + 0.1192 * rgb[1] + 0.9505 * rgb[2],
    ];
    let mono = file("PlaneSymmetrical", ["0", "0 60", "0 180", "0 90 180"], &[]);
    let head = mono.replace("SpectralContent  Monochrome", "SpectralContent  XYZ");
    let head = head.split("\nMonochrome\n").next().expect("a heading");
    let channel = |name: &str, value: f64| {
        let block = format!("TIS {}\n{}", value * PI, rows(&[value; 2], 3));
        format!("\nTristimulus{name}\nDataBegin\n{block}{block}DataEnd\n")
    };
    let [x, y, z] = [("X", 0), ("Y", 1), ("Z", 2)].map(|(name, k)| channel(name, xyz[k]));
    for text in [[head, &x, &y, &z].concat(), [head, &z, &x, &y].concat()] {
        let (found, notes) = read(&text);
        assert_eq!(found.colours(), 3);
        let value = found.brdf(direction_deg(30.0, 0.0), direction_deg(20.0, 100.0));
        // f32 values through a matrix with a condition number below 5.
        assert!(value.iter().zip(rgb).all(|(a, b)| (a - b).abs() < 1e-6), "{value:?}");
        assert!(!notes.iter().any(|note| note.contains("BT.709")), "{notes:?}");
    }
    // A spectral green lies outside the primaries; it is said.
    let green = [head, &channel("X", 0.0), &channel("Y", 0.1), &channel("Z", 0.0)].concat();
    assert!(read(&green).1.iter().any(|note| note.contains("outside R, G, B")));
    let twice = [head, &x, &y, &y].concat();
    assert!(zemax::read(twice.as_bytes()).expect_err("Y twice").to_string().contains("TristimulusY"));
    assert!(zemax::read([head, &x, &y].concat().as_bytes()).is_err());
}

/// 0.3/pi above the horizon and 0 below, as such files are written: the albedo is 0.3 under any incidence.
#[test]
fn a_lambertian_file_of_few_radials_is_lambertian() {
    let f = 0.3 / PI;
    let radials = [0.0f64, 20.0, 40.0, 60.0, 80.0, 90.0, 110.0, 130.0, 150.0, 180.0];
    let azimuths = [0.0f64, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0];
    let block = |theta: f64| {
        let height = |a: f64, r: f64| {
            r.to_radians().cos() * theta.to_radians().cos()
                + r.to_radians().sin() * a.to_radians().cos() * theta.to_radians().sin()
        };
        let row = |a: &f64| {
            radials
                .iter()
                .map(|&r| if height(*a, r) > 1e-12 { format!("{f} ") } else { "0 ".into() })
                .collect::<String>()
        };
        (0.3, azimuths.iter().map(row).collect::<Vec<_>>().join("\n"))
    };
    let listed = |list: &[f64]| list.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let lists = ["0", "0 30 60 80", &listed(&azimuths), &listed(&radials)];
    let (found, notes) = read(&file("PlaneSymmetrical", lists, &[0.0, 30.0, 60.0, 80.0].map(block)));
    for theta_i in [0.0, 15.0, 30.0, 45.0, 60.0, 75.0] {
        for (theta, phi) in (0..90).flat_map(|t| (0..36).map(move |p| (f64::from(t), f64::from(10 * p)))) {
            let value = found.brdf(direction_deg(theta_i, 0.0), direction_deg(theta, phi))[0];
            // f32 values.
            assert!((value / f - 1.0).abs() < 1e-6, "{theta_i}: {theta} {phi}: {value}");
        }
    }
    assert_eq!(notes, Vec::<String>::new(), "TIS 0.3 is what the values integrate to");
}

/// The sum of a table over its bins by projected solid angle, at each incidence.
fn albedos(table: &gonio::table::BrdfTable) -> Vec<f64> {
    let bins = table.grid.bins();
    let incidence = |incidence: usize| {
        let regions = table.grid.regions(incidence);
        let pairs = regions.iter().zip(&table.colours[0].total[incidence * bins..]);
        pairs.map(|(region, &f)| region.projected_solid_angle() * f64::from(f)).sum()
    };
    (0..table.grid.incidences()).map(incidence).collect()
}

#[test]
fn tis_is_the_albedo_of_the_table() {
    for alpha in [0.03, 0.3] {
        let own = table(&Ggx::new(alpha, alpha), &hemisphere(vec![0.0, 30.0, 60.0], None, 90, 72));
        let (text, _) = zemax::write(&own, false, &Lookup::new(&own).expect("a product")).expect("written");
        let file = zemax::read(text.as_bytes()).expect("readable");
        for (theta, wanted) in [0.0, 30.0, 60.0].into_iter().zip(albedos(&own)) {
            let place = file.light.iter().position(|&light| light == theta).expect("every stop is there");
            let found = file.tis[0][place];
            // Six digits after the point.
            assert!((found - wanted).abs() <= 0.51e-6, "{alpha}: {found} {wanted}");
        }
    }
}

/// Straight lines from 30 to 60 degrees made 9 % of light at 45. Places that are no halves of halves.
#[test]
fn the_albedo_holds_between_incidences() {
    // Bins that hold the lobe.
    for alpha in [0.1, 0.3] {
        let own = table(&Ggx::new(alpha, alpha), &hemisphere(vec![0.0, 30.0, 60.0, 80.0], None, 90, 180));
        let lookup = Lookup::new(&own).expect("a product");
        let (text, _) = zemax::write(&own, false, &lookup).expect("written");
        let file = zemax::read(text.as_bytes()).expect("readable");
        assert!(file.light.len() <= 60, "{} incidences", file.light.len());
        for theta in [10.0, 40.0, 50.0, 65.0, 73.0, 78.0] {
            let (found, wanted) = (integral(&file, theta), integral(&lookup, theta));
            // What is promised, and 1e-3 of this rule.
            assert!((found / wanted - 1.0).abs() < 0.011, "{alpha} {theta}: {found} {wanted}");
        }
    }
}

/// A rule of its own: midpoints in azimuth and in the root of the radial, dense about the mirror direction.
fn integral(brdf: &dyn Brdf, theta_i: f64) -> f64 {
    let (rows, columns) = (750, 90);
    let (sin_i, cos_i) = theta_i.to_radians().sin_cos();
    let mut sum = 0.0;
    for row in 0..rows {
        let u = (f64::from(row) + 0.5) / f64::from(rows);
        let (sin_r, cos_r) = (PI * u * u).sin_cos();
        for column in 0..columns {
            let (sin_a, cos_a) = (2.0 * PI * (f64::from(column) + 0.5) / f64::from(columns)).sin_cos();
            let mirror = glam::DVec3::new(-sin_i, 0.0, cos_i);
            let up = glam::DVec3::new(cos_i, 0.0, sin_i);
            let wo = cos_r * mirror + sin_r * (cos_a * up + sin_a * glam::DVec3::Y);
            if wo.z > 0.0 {
                let size = 2.0 * PI * u * sin_r / f64::from(rows) * 2.0 * PI / f64::from(columns);
                sum += size * wo.z * brdf.brdf(direction_deg(theta_i, 0.0), wo)[0];
            }
        }
    }
    sum
}

#[test]
fn the_values_of_a_file_integrate_to_its_tis() {
    // Bins of 1 x 5 degrees are wider than the lobe of alpha 0.03 at 60 degrees; those of 0.3 are not.
    for alpha in [0.03, 0.3] {
        let own = table(&Ggx::new(alpha, alpha), &hemisphere(vec![0.0, 30.0, 60.0], None, 90, 72));
        let (text, notes) =
            zemax::write(&own, false, &Lookup::new(&own).expect("a product")).expect("written");
        let (back, said) = read(&text);
        for (theta, wanted) in [0.0, 30.0, 60.0].into_iter().zip(albedos(&own)) {
            let found = integral(&back, theta);
            // What is promised is 1 %; this rule is good to 1e-3 on piecewise linear functions of these steps.
            assert!((found / wanted - 1.0).abs() < 0.011, "{alpha} {theta}: {found} {wanted}");
            assert!(found < 1.011, "light is made: {found}");
        }
        assert!(!said.iter().any(|note| note.contains("TIS")), "{said:?}");
        assert_eq!(notes.is_empty(), alpha == 0.3, "{notes:?}");
    }
}

#[test]
fn a_tis_that_is_not_the_integral_is_said_to_be_so() {
    // 0.3/pi everywhere integrates to 0.3; 0.5 is not that, and 1/pi and more makes light.
    let lists = ["0", "0", "0 90 180", "0 30 60 90 180"];
    let note =
        |tis: f64, value: f64| read(&file("PlaneSymmetrical", lists, &[(tis, rows(&[value; 3], 5))])).1;
    assert_eq!(note(0.3, 0.3 / PI), Vec::<String>::new());
    assert_eq!(note(0.302, 0.3 / PI), Vec::<String>::new());
    let said = note(0.5, 0.3 / PI).concat();
    assert!(said.contains("TIS 0.5000, integral 0.3000") && said.contains("2 %"), "{said}");
    assert!(note(1.0, 0.4).concat().contains("more light than comes in"));
    // Radials that end early, and negative values.
    let short = file("PlaneSymmetrical", ["0", "60", "0 180", "0 60"], &[(0.3, "0.1 -0.1\n0.1 -0.2".into())]);
    let said = read(&short).1.join("; ");
    assert!(
        said.contains("ScatterRadial ends at 60") && said.contains("2 of 4 values are negative"),
        "{said}"
    );
}

#[test]
fn what_a_reader_says_reaches_the_user() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("a.bsdf");
    let lists = ["0", "0", "0 90 180", "0 30 60 90 180"];
    std::fs::write(&path, file("PlaneSymmetrical", lists, &[(0.5, rows(&[0.1; 3], 5))])).expect("written");
    let (_, notes) = import(&path, Format::Zemax, &Options::default(), None).expect("readable");
    assert!(notes.iter().any(|note| note.contains("TIS 0.5000")), "{notes:?}");
}
