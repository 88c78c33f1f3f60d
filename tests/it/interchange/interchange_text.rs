//! Promise: ASTM, SSDD, Zemax and pab-opto texts hold the table's values, and damaged ones are refused.

use std::f64::consts::{FRAC_PI_2, PI};

use gonio::interchange;
use gonio::interchange::text::{astm, pabopto, ssdd, zemax};
use gonio::interchange::{Brdf, Format, Lookup, Options};
use gonio::table::BrdfTable;

use crate::support::analytic::{Ggx, hemisphere, l1, steps, table};
use crate::support::mutations;

fn anisotropic() -> BrdfTable {
    let mut ggx = Ggx::new(0.4, 0.7);
    ggx.tint = vec![1.0, 0.5, 0.25];
    table(&ggx, &hemisphere(vec![0.0, 40.0], Some(steps(90.0, 4)), 3, 4))
}

fn text(write: impl Fn(&mut dyn std::io::Write) -> interchange::Checked<()>) -> String {
    let mut bytes = Vec::new();
    write(&mut bytes).expect("written");
    String::from_utf8(bytes).expect("text")
}

#[test]
fn astm_comes_back() {
    let wanted = anisotropic();
    let text = text(|out| astm::write(&wanted, out));
    assert!(text.contains("NUM_POINTS 96\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n"), "{text}");
    // The second incidence, first bin: light from azimuth 90, the bin's middle at (15, 45) degrees, in radians.
    let line = text.lines().skip_while(|line| !line.starts_with("VARS")).nth(13).expect("there");
    let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
    for (found, wanted) in numbers.iter().zip([0.0, FRAC_PI_2, PI / 12.0, PI / 4.0]) {
        assert!((found - wanted).abs() < 1e-11, "{line}");
    }
    let back = astm::read(text.as_bytes()).expect("readable");
    assert_eq!(
        (back.grid.theta_i_deg, back.grid.phi_i_deg),
        (wanted.grid.theta_i_deg, wanted.grid.phi_i_deg)
    );
    assert_eq!(back.grid.points_deg[1], [15.0, 135.0]);
    assert!(back.colours.iter().zip(&wanted.colours).all(|(a, b)| a.total == b.total));
}

#[test]
fn ssdd_comes_back() {
    let wanted = anisotropic();
    let text = text(|out| ssdd::write(&wanted, out));
    let heading = "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL rgb\nPARAM_TYPE spherical_coordinate_system\nPARAM0_LIST 0 40\n\
        PARAM1_LIST 0 90 180 270\nPARAM2_LIST 15 45 75\nPARAM3_LIST 45 135 225 315\nSOURCE_TYPE generated\nDATA ascii\n";
    assert!(text.starts_with(heading), "{text}");
    // theta_i runs fastest: the second line is the incidence (40, 0), incidence 4, in its first bin.
    let second = text.lines().nth(11).expect("there").split(' ').next().expect("red");
    assert_eq!(second.parse::<f32>().expect("a number"), wanted.colours[0].total[4 * 12]);
    let back = ssdd::read(text.as_bytes()).expect("readable");
    assert!(back.colours.iter().zip(&wanted.colours).all(|(a, b)| a.total == b.total));
    assert_eq!(back.grid.points_deg[11], [75.0, 315.0]);
}

#[test]
fn spectral_tables_come_back_from_lists() {
    let nm = [405.0, 450.5, 546.1, 632.8, 1064.0];
    let mut wanted = table(&Ggx::new(0.4, 0.7), &hemisphere(vec![0.0, 40.0], Some(steps(90.0, 4)), 3, 4));
    let first = wanted.colours.remove(0);
    wanted.colours = (1u8..)
        .zip(nm)
        .map(|(k, nm)| {
            let mut colour = first.clone();
            colour.wavelength_nm = Some(nm);
            // No two values of a direction are alike.
            colour.total.iter_mut().for_each(|value| *value /= f32::from(k) + 0.3);
            colour.stderr = colour.total.iter().map(|value| value * 0.01).collect();
            colour
        })
        .collect();
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("spectral");
    for (format, heading) in [
        (Format::Csv, ",405nm,450.5nm,546.1nm,632.8nm,1064nm,stderr.405nm,"),
        (Format::Astm, "phi_s,405nm,450.5nm,546.1nm,632.8nm,1064nm\n"),
        (Format::Ssdd, "COLOR_MODEL spectrum\nWAVELENGTH_LIST 405 450.5 546.1 632.8 1064\n"),
    ] {
        let export = interchange::export(&wanted, format, &Options::default(), &path).expect("written");
        assert_eq!(export.read_back.expect("not zero").worst, 0.0, "{format:?}");
        assert!(std::fs::read_to_string(&path).expect("text").contains(heading), "{format:?}");
        let (back, _) = interchange::import(&path, format, &Options::default(), None).expect("read");
        for (k, (found, wanted)) in back.colours.iter().zip(&wanted.colours).enumerate() {
            assert_eq!(found.wavelength_nm, Some(nm[k]), "{format:?}");
            assert!(found.total == wanted.total, "{format:?} {k}");
            assert!(format != Format::Csv || found.stderr == wanted.stderr, "{k}");
        }
        assert_eq!(back.colours.len(), nm.len());
    }
    let refused =
        interchange::export(&wanted, Format::Zemax, &Options::default(), &path).expect_err("no room");
    assert!(refused.to_string().contains("astm, ssdd, openmaterial and bird hold them"), "{refused}");
}

#[test]
fn zemax_tables_stand_about_the_mirror_direction() {
    let ggx = Ggx::new(0.3, 0.3);
    let own = table(&ggx, &hemisphere(steps(5.0, 18), None, 90, 120));
    let (text, _) = zemax::write(&own, false, &Lookup::new(&own).expect("a product")).expect("isotropic");
    let line =
        |k: usize| text.lines().skip_while(|line| !line.starts_with("DataBegin")).nth(k).expect("there");
    // Behind DataBegin: TIS and 37 lines for each incidence. TIS of that of 25 degrees: GGX 0.3, separable, between
    // 0.86 and 0.89 (0.88244 and 0.87344 measured at 0 and 30 degrees; docs/guide.md).
    let back = zemax::read(text.as_bytes()).expect("readable");
    let place = back.light.iter().position(|&light| light == 25.0).expect("a stop");
    let tis: f64 = line(1 + place * 38).strip_prefix("TIS ").expect("TIS").parse().expect("a number");
    assert!((0.84..0.9).contains(&tis), "{tis}");
    // Radial 0 is the mirror direction whatever the azimuth.
    let first =
        |k: usize| line(k).split_whitespace().next().expect("a value").parse::<f64>().expect("a number");
    let wi = gonio::sphere::direction_deg(25.0, 0.0);
    let wanted = interchange::Brdf::brdf(&ggx, wi, gonio::sphere::direction_deg(25.0, 180.0))[0];
    for k in [2, 20, 38] {
        let found = first(place * 38 + k);
        assert!((found / wanted - 1.0).abs() < 1e-3, "{found} {wanted}");
    }
    let light: Vec<(f64, f64)> = [10.0, 35.0, 60.0].map(|t| (t, 2.0 * t)).to_vec();
    let off = l1(&back, &ggx, &light, 80.0);
    // Radials up to 4 degrees apart, a twelfth of the lobe's square: 1 % is what another reader of this format reached.
    assert!(off <= 0.01, "{off}");
}

#[test]
fn zemax_has_a_table_for_each_rotation_of_an_anisotropic_sample() {
    let ggx = Ggx::new(0.4, 0.7);
    let own = table(&ggx, &hemisphere(steps(20.0, 4), Some(steps(30.0, 12)), 45, 72));
    let (text, _) = zemax::write(&own, false, &Lookup::new(&own).expect("a product")).expect("written");
    assert!(text.contains("Symmetry  ASymmetrical4D\n") && text.contains("SampleRotation  12\n0 30 60 "));
    // Turned by 330 counter-clockwise, the sample has the lamp at its azimuth 30: 11 blocks of all incidences before; that
    // of 20 degrees, azimuth 90 (row 18), radial 180 (30/90)^2 = 20 degrees (column 30).
    let back = zemax::read(text.as_bytes()).expect("readable");
    let place = back.light.iter().position(|&light| light == 20.0).expect("a stop");
    let block = text.split("TIS ").nth(1 + 11 * back.light.len() + place).expect("there");
    let row = block.lines().nth(1 + 18).expect("there");
    let found: f64 = row.split_whitespace().nth(30).expect("there").parse().expect("a number");
    let (sin, cos) = 20f64.to_radians().sin_cos();
    // From the mirror direction (-sin, 0, cos) by 20 degrees towards +y, then all by 30 degrees about z.
    let out = glam::DVec3::new(-sin * cos, sin, cos * cos);
    let turned = gonio::sphere::turned(out, 30f64.to_radians().sin_cos());
    let wanted = ggx.brdf(gonio::sphere::direction_deg(20.0, 30.0), turned)[0];
    // Bins of 2 x 5 degrees through a cubic, of fourth order in the step over the lobe.
    assert!((found / wanted - 1.0).abs() < 2e-3, "{found} {wanted}");
    assert_eq!(back.phi_i_deg(), steps(30.0, 12));
    let light: Vec<(f64, f64)> = [10.0, 35.0, 60.0].map(|t| (t, 2.0 * t)).to_vec();
    let off = l1(&back, &ggx, &light, 80.0);
    // As the isotropic file, and straight lines between incidences of 10 (those that the file adds) and rotations of 30 degrees beside.
    assert!(off <= 0.03, "{off}");
}

#[test]
fn pabopto_has_a_file_for_each_incidence() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("mountain");
    let wanted = table(&Ggx::new(0.4, 0.7), &hemisphere(vec![0.0, 40.0], Some(steps(90.0, 4)), 3, 4));
    let export = interchange::export(&wanted, Format::Pabopto, &Options::default(), &path).expect("written");
    assert_eq!(export.read_back.expect("not zero").l1, 0.0);
    let bytes = std::fs::read(path.join("stop_0005.txt")).expect("there");
    assert!(
        bytes.starts_with(
            b"#sample_name \"gonio\"\n#format: theta phi BSDF\n#incident_angle 40 90\n#upphi 0\n"
        )
    );
    let (light, values) = pabopto::read(&bytes).expect("readable");
    assert_eq!((light, values.as_slice()), ([40.0, 90.0], &wanted.colours[0].total[60..72]));
}

#[test]
fn damaged_texts_are_refused() {
    let wanted = table(&Ggx::new(0.5, 0.5), &hemisphere(vec![0.0, 40.0], None, 2, 2));
    let astm_text = text(|out| astm::write(&wanted, out));
    let reason = |text: &str| astm::read(text.as_bytes()).expect_err("must be refused").to_string();
    assert!(reason("").contains("VARS"));
    assert!(reason(&astm_text.replace("phi_s,Y", "phi_s,Y,Z")).contains("nor X Y Z"));
    assert!(reason(&astm_text.replacen("0.000000000000,", "nan,", 1)).contains("line 7"));
    assert!(reason(astm_text.trim_end().rsplit_once('\n').expect("lines").0).contains("cut short"));
    let ssdd_text = text(|out| ssdd::write(&wanted, out));
    let reason = |text: &str| ssdd::read(text.as_bytes()).expect_err("must be refused").to_string();
    assert!(reason("").contains("VERSION"));
    assert!(reason(&ssdd_text.replace("brdf", "brtf")).contains("brdf or btdf needed"));
    assert!(reason(&ssdd_text.replace("PARAM0_LIST 0", "PARAM0_LIST 0 1 2 3 4")).contains("needed"));
    assert!(reason(&ssdd_text.replace("ascii", "hex")).contains("ascii or binary"));
    assert!(mutations::refused(astm_text.as_bytes(), astm::read) > 0.2);
    assert!(mutations::refused(ssdd_text.as_bytes(), ssdd::read) > 0.2);
    let zemax_text = "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n\
        SampleRotation 1\n0\nAngleOfIncidence 1\n0\nScatterAzimuth 2\n0 180\nScatterRadial 2\n0 90\n\nMonochrome\n\
        DataBegin\nTIS 0.9\n1 2\n3 4\nDataEnd\n";
    assert!(zemax::read(zemax_text.as_bytes()).is_ok());
    assert!(zemax::read(zemax_text.replace("3 4", "3").as_bytes()).is_err());
    assert!(zemax::read(zemax_text.replace("3 4", "3 nan").as_bytes()).is_err());
    assert!(mutations::refused(zemax_text.as_bytes(), zemax::read) > 0.2);
    let rotated = zemax_text
        .replace("PlaneSymmetrical", "ASymmetrical4D")
        .replace("SampleRotation 1\n0", "SampleRotation 2\n0 180");
    assert!(
        zemax::read(rotated.as_bytes()).expect_err("a gap of half a turn").to_string().contains("go round")
    );
    let turns = (0..8).map(|k| (45 * k).to_string()).collect::<Vec<_>>().join(" ");
    let rotated = rotated.replace("SampleRotation 2\n0 180", &format!("SampleRotation 8\n{turns}"));
    let rotated = rotated.replace("TIS 0.9\n1 2\n3 4\n", &"TIS 0.9\n1 2\n3 4\n".repeat(8));
    assert!(zemax::read(rotated.as_bytes()).is_ok());
    assert!(mutations::refused(rotated.as_bytes(), zemax::read) > 0.2);
    let pabopto_text = pabopto::text(&wanted, 1);
    assert!(mutations::refused(pabopto_text.as_bytes(), pabopto::read) > 0.1);
}

/// Two incidences of two directions, the last numbers of each line `values`.
fn astm(names: &str, values: &str) -> String {
    let angles = ["0,0,0.2,0", "0,0,0.4,0", "0.5,0,0.2,0", "0.5,0,0.4,0"];
    let lines: String = angles.iter().map(|angles| format!("{angles},{values}\n")).collect();
    format!("LAB_NAME x\nNUM_POINTS 4\nVARS theta_i,phi_i,theta_s,phi_s,{names}\n{lines}")
}

#[test]
fn channels_of_astm_are_what_they_are_called() {
    let read =
        |names: &str, values: &str| gonio::interchange::text::astm::read(astm(names, values).as_bytes());
    let first = |table: &BrdfTable| table.colours.iter().map(|colour| colour.total[0]).collect::<Vec<f32>>();
    // B, G, R is R, G, B the other way round.
    assert_eq!(first(&read("B,G,R", "0.1,0.2,0.3").expect("read")), [0.3, 0.2, 0.1]);
    // White D65 is X, Y, Z = 0.9505, 1, 1.089 by the matrix of IEC 61966-2-1, and R = G = B = 1.
    let white = first(&read("X,Y,Z", "0.9505,1,1.089").expect("read"));
    assert!(white.iter().all(|value| (value - 1.0).abs() < 1e-6), "{white:?}");
    let counted = read("value,stderr,count", "0.2,0.01,100").expect("read");
    assert_eq!((first(&counted), counted.colours[0].stderr[0], counted.hits[0]), (vec![0.2], 0.01, 100));
    let spectral = read("650nm,450nm", "0.6,0.4").expect("read");
    let found: Vec<_> = spectral.colours.iter().map(|c| (c.wavelength_nm, c.total[0])).collect();
    assert_eq!(found, [(Some(450.0), 0.4), (Some(650.0), 0.6)]);
    assert!(read("Q", "0.1").expect_err("unknown").to_string().contains("the column `Q` is not known"));
    // Blanks between the numbers.
    let blanks = "VARS theta_i,phi_i,theta_s,phi_s,Y\n0.0 0.0 0.1 0.0 0.31\n";
    assert_eq!(first(&gonio::interchange::text::astm::read(blanks.as_bytes()).expect("read")), [0.31]);
}

#[test]
fn csv_of_other_hands_is_read_by_its_headings() {
    let read = |text: &str| gonio::interchange::text::csv::read(text.as_bytes());
    let plain =
        read("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,B,R,G\n0,0,10,20,0.1,0.3,0.2\n").expect("read");
    let of = |table: &BrdfTable| table.colours.iter().map(|colour| colour.total[0]).collect::<Vec<f32>>();
    assert_eq!(of(&plain), [0.3, 0.2, 0.1]);
    let german = "\u{feff}# Messung\nphi_r_deg;theta_r_deg;phi_i_deg;theta_i_deg;Y;stderr.Y;hits\n20,5;10;0;0;0,25;0,5;7\n";
    let german = read(german).expect("read");
    assert_eq!((of(&german), german.colours[0].stderr[0], german.hits[0]), (vec![0.25], 0.5, 7));
    assert_eq!(german.grid.points_deg, [[10.0, 20.5]]);
    let unknown = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y,temperature\n0,0,10,20,0.1,20\n";
    assert!(
        read(unknown).expect_err("unknown").to_string().contains("the column `temperature` is not known")
    );
}

#[test]
fn colours_of_ssdd_are_those_of_its_model() {
    let text = |model: &str, values: &str| {
        format!(
            "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL {model}\nPARAM_TYPE spherical_coordinate_system\nPARAM0_LIST 0\n\
             PARAM2_LIST 0 10\nPARAM3_LIST 0\nDATA ascii\n{values}\n{values}\n"
        )
    };
    let read =
        |model: &str, values: &str| gonio::interchange::text::ssdd::read(text(model, values).as_bytes());
    let white = read("xyz", "0.9505 1 1.089").expect("read");
    assert!(white.colours.iter().all(|colour| (colour.total[0] - 1.0).abs() < 1e-6));
    let spectrum = read("spectrum\nWAVELENGTH_LIST 450 650", "0.4 0.6").expect("read");
    assert_eq!(spectrum.colours[1].wavelength_nm, Some(650.0));
    assert!(read("ycbcr", "1 1 1").expect_err("unknown").to_string().contains("COLOR_MODEL ycbcr"));
}
