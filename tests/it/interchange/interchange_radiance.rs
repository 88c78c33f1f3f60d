//! Promise: Radiance's matrices and tensor trees hold the table, and damaged XML is refused. (Radiance itself reads them
//! in tests/interop.)

use std::f64::consts::PI;

use gonio::instrument::GridKind;
use gonio::instrument::klems::{Basis, patches};
use gonio::interchange::radiance::klems;
use gonio::interchange::radiance::klems::Patchwise;
use gonio::interchange::radiance::sample_side::SampleSide;
use gonio::interchange::radiance::tensor_tree;
use gonio::interchange::resample::nodes;
use gonio::interchange::{Brdf, Format, Options, import};
use gonio::sphere::{self, direction_deg};

use crate::support::analytic::{Ggx, Painted, hemisphere, l1, steps, table};
use crate::support::{mutations, radiance};

#[test]
fn klems_patches_come_back() {
    let ggx = Ggx::new(0.5, 0.5);
    let own = table(&ggx, &hemisphere(steps(5.0, 18), None, 45, 90));
    let text = klems::write(&own, &Options::default()).expect("written").0;
    assert!(text.contains("<WavelengthDataDirection>Reflection Back</WavelengthDataDirection>"));
    let back = klems::read(text.as_bytes()).expect("readable");
    assert_eq!((back.grid.kind, back.grid.incidences(), back.grid.bins()), (GridKind::Patches, 145, 145));
    // Projected solid angles of the 145 patches add up to pi.
    let sizes: f64 = back.grid.regions(0).iter().map(|region| region.projected_solid_angle()).sum();
    assert!((sizes - std::f64::consts::PI).abs() < 1e-12);
    // Ring 3 begins behind 1 + 8 + 16 patches: light there travels to 30 degrees, azimuth 0, so it comes from 180.
    let incidence = 25;
    assert_eq!(back.grid.incidence_deg(incidence), (30.0, 180.0));
    // The mean over both patches by an independent rule: midpoints in (sin^2 theta, phi) of both, 12 x 12 each.
    let bin = 25;
    let midpoints = |turn: f64| -> Vec<glam::DVec3> {
        let (s0, s1) = (25f64.to_radians().sin().powi(2), 35f64.to_radians().sin().powi(2));
        (0..144)
            .map(|k| {
                let s: f64 = s0 + (s1 - s0) * (0.5 + f64::from(k / 12)) / 12.0;
                sphere::direction(
                    s.sqrt().asin(),
                    (turn - 9.0 + 18.0 * (0.5 + f64::from(k % 12)) / 12.0).to_radians(),
                )
            })
            .collect()
    };
    let (light, sensor) = (midpoints(180.0), midpoints(0.0));
    let sum: f64 = light
        .iter()
        .flat_map(|&wi| sensor.iter().map(move |&wo| (wi, wo)))
        .map(|(wi, wo)| ggx.brdf(wi, wo)[0])
        .sum();
    let (wanted, found) = (sum / 144.0 / 144.0, f64::from(back.colours[0].total[incidence * 145 + bin]));
    // Midpoints: (step/lobe)^2/24, 2e-4; the table between its incidences of 5 degrees: 1e-3.
    assert!((found / wanted - 1.0).abs() < 2e-3, "{found} {wanted}");
    // The matrix itself, written and read again, to the seven digits of its text.
    let again = klems::read(klems::write(&back, &Options::default()).expect("written").0.as_bytes())
        .expect("readable");
    let pairs = back.colours[0].total.iter().zip(&again.colours[0].total);
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() <= 1e-7 * a), "{:?}", pairs.clone().next());
    // And as a function each patch has its value.
    let patchwise = Patchwise::new(back.clone()).expect("the full basis");
    let wo = nodes(&back.grid.regions(incidence)[bin])[5].0;
    assert_eq!(patchwise.brdf(back.grid.wi(incidence), wo)[0], found);
}

#[test]
fn tensor_trees_of_both_ranks_are_within_three_hundredths() {
    let light: Vec<(f64, f64)> = [5.0, 20.0, 40.0, 60.0].map(|t| (t, 3.0 * t)).to_vec();
    let ggx = Ggx::new(0.6, 0.6);
    let isotropic = table(&ggx, &hemisphere(steps(15.0, 6), None, 30, 48));
    let text = tensor_tree::write(&isotropic, &Options::default()).expect("a product").0;
    assert!(text.contains("<IncidentDataStructure>TensorTree3<"));
    let found = tensor_tree::read(text.as_bytes()).expect("readable");
    let off = l1(&found, &ggx, &light, 80.0);
    assert!(off <= 0.03, "rank 3: {off}");
    // As much of a lobe as shows which axis is which: alone it takes thirty times as many cells.
    let painted = |alpha_x, alpha_y| Painted { paint: 0.7, lobe: Some((0.3, Ggx::new(alpha_x, alpha_y))) };
    let grid = hemisphere(steps(20.0, 5), Some(steps(45.0, 8)), 18, 24);
    let text = tensor_tree::write(&table(&painted(0.5, 1.0), &grid), &Options::default());
    let text = text.expect("a product").0;
    assert!(text.contains("<IncidentDataStructure>TensorTree4<"));
    let found = tensor_tree::read(text.as_bytes()).expect("readable");
    let off = l1(&found, &painted(0.5, 1.0), &light, 80.0);
    // Divided until the cells' steps make one to two per cent of the sum.
    assert!(off <= 0.02, "rank 4: {off}");
    let turned = l1(&found, &painted(1.0, 0.5), &light, 80.0);
    assert!(turned > 0.06, "rank 4, with the axes exchanged: {turned}");
}

#[test]
fn colours_of_radiance_files_come_back() {
    let mut ggx = Ggx::new(0.8, 0.8);
    ggx.tint = vec![0.9, 0.5, 0.2];
    let own = table(&ggx, &hemisphere(steps(15.0, 6), None, 18, 36));
    let text = klems::write(&own, &Options::default()).expect("written").0;
    for channel in ["Visible", "CIE-X", "CIE-Z"] {
        assert!(text.contains(&format!("<Wavelength unit=\"Integral\">{channel}</Wavelength>")));
    }
    let back = klems::read(text.as_bytes()).expect("readable");
    assert_eq!(back.colours.len(), 3);
    let [r, g, b] = [0, 1, 2].map(|c| &back.colours[c].total);
    // Eight digits of XYZ, through a matrix with a condition number below 5.
    let off = |k: usize| (g[k] / r[k] - 5.0 / 9.0).abs().max((b[k] / r[k] - 2.0 / 9.0).abs());
    assert!((0..r.len()).all(|k| off(k) < 1e-5));
    let text = tensor_tree::write(&own, &Options::default()).expect("a product").0;
    assert!(text.contains("CIE-u") && text.contains("CIE-v"));
    let found = tensor_tree::read(text.as_bytes()).expect("readable");
    assert_eq!(found.colours(), 3);
    let [r, g, b] = found.brdf(sphere::direction_deg(30.0, 0.0), sphere::direction_deg(35.0, 185.0));
    // u' and v' have five digits; b is a small difference of Y, u' and v'.
    assert!((g / r - 5.0 / 9.0).abs() < 1e-3 && (b / r - 2.0 / 9.0).abs() < 2e-3, "{r} {g} {b}");
    let damaged = text.replacen("CIE-u</", "CIE-w</", 1);
    assert_eq!(tensor_tree::read(damaged.as_bytes()).expect("readable").colours(), 1);
}

/// A tree of rank 3 with 0.3/pi in the used half and 0 in the other, as WINDOW's own tools write it.
const LAMBERT: &str = "{ 0.0954930 0.0954930 0.0954930 0.0954930 0 0 0 0 }";

#[test]
fn light_from_the_normal_is_not_black() {
    let tree = tensor_tree::read(small("TensorTree3", "", LAMBERT).as_bytes()).expect("sound");
    for theta_i in [0.0, 1e-12, 1e-6, 1.0, 15.0, 60.0, 89.0, 90.0 - 1e-12] {
        for (theta, phi) in [(0.0, 0.0), (30.0, 180.0), (60.0, 45.0), (90.0 - 1e-9, 271.0)] {
            let value = tree.brdf(direction_deg(theta_i, 0.0), direction_deg(theta, phi))[0];
            assert_eq!(value as f32, 0.095_493, "light at {theta_i}, sensor at {theta} {phi}");
        }
    }
    // Divided once more: the cells next to the normal, and those of the next half, are told apart.
    let cell = |k: usize| if k % 2 == 1 { "{0 0 0 0 0 0 0 0}" } else { "{1 1 1 1 2 2 2 2}" };
    let text = format!("{{{}}}", (0..8).map(cell).collect::<String>());
    let tree = tensor_tree::read(small("TensorTree3", "", &text).as_bytes()).expect("sound");
    let value = |theta_i: f64| tree.brdf(direction_deg(theta_i, 10.0), direction_deg(40.0, 100.0))[0];
    // 0.5 - 0.5 sin: sines above 1/2 lie in [0, 1/4), those below next to the normal.
    assert_eq!([0.0, 10.0, 29.9, 30.1, 80.0].map(value), [2.0, 2.0, 2.0, 1.0, 1.0]);
}

/// Which side a rounding falls to says nothing of the sample: the mean of both.
#[test]
fn directions_on_a_border_take_both_sides() {
    // Rank 4, two cells an axis: the value is 1, 3 by the half of the light's y, times 1, 5 by that of the sensor's y.
    let cell = |k: usize| [1.0, 3.0][k >> 2 & 1] * [1.0, 5.0][k & 1];
    let text = format!("{{{}}}", (0..16).map(|k| format!(" {}", cell(k))).collect::<String>());
    let tree = tensor_tree::read(small("TensorTree4", "", &text).as_bytes()).expect("sound");
    let value = |phi_i: f64, phi_r: f64| tree.brdf(direction_deg(40.0, phi_i), direction_deg(50.0, phi_r))[0];
    // The light's coordinates are those of -wi.
    assert_eq!((value(90.0, 90.0), value(270.0, 90.0), value(270.0, 270.0)), (5.0, 15.0, 3.0));
    for border in [0.0, 180.0] {
        assert_eq!((value(border, 90.0), value(border, 270.0)), (10.0, 2.0), "light at {border}");
        assert_eq!((value(90.0, border), value(270.0, border)), (3.0, 9.0), "sensor at {border}");
        assert_eq!(value(border, border), 6.0);
    }
    // Light from the normal lies in the corner of four cells.
    assert_eq!(tree.brdf(direction_deg(0.0, 0.0), direction_deg(50.0, 90.0))[0], 10.0);
    // A matrix of two patches, whose borders lie at 90 and 270: [1, 3] under light that travels to 0, [2, 4] to 180.
    let basis = "<AngleBasis><AngleBasisName>B</AngleBasisName><AngleBasisBlock><nPhis>2</nPhis><ThetaBounds>\
        <LowerTheta>0</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";
    let matrix = klems::read(small("Columns", basis, "1, 2, 3, 4").as_bytes()).expect("sound");
    let matrix = Patchwise::new(matrix).expect("a basis");
    let value =
        |phi_i: f64, phi_r: f64| matrix.brdf(direction_deg(30.0, phi_i), direction_deg(30.0, phi_r))[0];
    assert_eq!((value(180.0, 0.0), value(180.0, 180.0), value(0.0, 0.0)), (1.0, 3.0, 2.0));
    assert_eq!((value(180.0, 90.0), value(180.0, 270.0), value(90.0, 0.0)), (2.0, 2.0, 1.5));
    assert_eq!(value(90.0, 270.0), 2.5);
    // Rings meet at 45: values 1 and 2 by the light's ring, times 1 and 3 by the sensor's.
    let rings = basis.replace("<nPhis>2<", "<nPhis>1<").replace("Theta>90<", "Theta>45<");
    let ring = "<AngleBasisBlock><nPhis>1</nPhis><ThetaBounds><LowerTheta>45</LowerTheta><UpperTheta>90</UpperTheta>\
        </ThetaBounds></AngleBasisBlock></AngleBasis>";
    let rings = rings.replace("</AngleBasis>", ring);
    let matrix = klems::read(small("Columns", &rings, "1 2 3 6").as_bytes()).expect("sound");
    // A whole ring has its stop at its upper edge: no basis of WINDOW's has one but at the pole, and it is kept.
    let matrix = Patchwise::new(matrix).expect("a basis");
    let value =
        |theta_i: f64, theta: f64| matrix.brdf(direction_deg(theta_i, 7.0), direction_deg(theta, 7.0))[0];
    assert_eq!(
        (value(44.0, 44.0), value(46.0, 46.0), value(45.0, 44.0), value(45.0, 45.0)),
        (1.0, 6.0, 1.5, 3.0)
    );
    assert_eq!((value(0.0, 0.0), value(90.0 - 1e-12, 90.0 - 1e-12)), (1.0, 6.0));
}

#[test]
fn half_and_quarter_bases_go_out_as_they_came() {
    let ggx = Ggx::new(0.5, 0.5);
    let own = table(&ggx, &hemisphere(steps(10.0, 9), None, 45, 72));
    for (basis, count) in [(Basis::Full, 145), (Basis::Half, 73), (Basis::Quarter, 41)] {
        let (text, notes) = klems::write(&own, &in_basis(basis)).expect("written");
        assert!(text.contains(basis.name()) && notes[0].contains("resampled"), "{notes:?}");
        let back = klems::read(text.as_bytes()).expect("readable");
        assert_eq!((back.grid.incidences(), back.grid.bins()), (count, count));
        let sizes: f64 = back.grid.regions(0).iter().map(|region| region.projected_solid_angle()).sum();
        assert!((sizes - PI).abs() < 1e-12);
        // No basis named: its own, and every value bit for bit.
        let (again, notes) = klems::write(&back, &Options::default()).expect("written");
        assert!(again.contains(basis.name()) && notes[0].contains("as they are"), "{notes:?}");
        assert_eq!(klems::read(again.as_bytes()).expect("readable"), back);
        // A standard name needs no description.
        let bare = text
            .replace(&text[text.find("<AngleBasis>").unwrap()..text.find("</DataDefinition>").unwrap()], "");
        assert_eq!(klems::read(bare.as_bytes()).expect("a known name"), back);
    }
    // From one basis to another, where every value is alike.
    let (mut quarter, _) =
        klems::read_side(klems::write(&own, &in_basis(Basis::Quarter)).expect("written").0.as_bytes(), None)
            .expect("read");
    quarter.colours[0].total.fill(0.25);
    let (text, _) = klems::write(&quarter, &in_basis(Basis::Half)).expect("written");
    let half = klems::read(text.as_bytes()).expect("readable");
    assert!(half.grid.bins() == 73 && half.colours[0].total.iter().all(|&value| value == 0.25));
    // The light's patches may be others than the sensor's.
    let light = patches(Basis::Half.rings()).len();
    let mixed = klems::write(&half, &Options::default()).expect("written").0;
    let [from, to] = [Basis::Half, Basis::Quarter].map(|basis| format!("<RowAngleBasis>{}</", basis.name()));
    let mixed = mixed.replace(&from, &to);
    let numbers = "0.5 ".repeat(light * 41);
    let data =
        mixed.find("<ScatteringData>").expect("data") + 16..mixed.find("</ScatteringData>").expect("data");
    let mixed = klems::read(mixed.replace(&mixed[data], &numbers).as_bytes()).expect("readable");
    assert_eq!((mixed.grid.incidences(), mixed.grid.bins()), (light, 41));
    let again = klems::read(klems::write(&mixed, &Options::default()).expect("written").0.as_bytes())
        .expect("readable");
    assert_eq!(again, mixed);
}

#[test]
fn a_matrix_is_resampled_to_the_grid_of_another_table() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("quarter.xml");
    let own = table(&Ggx::new(0.5, 0.5), &hemisphere(steps(10.0, 9), None, 45, 72));
    std::fs::write(&path, klems::write(&own, &in_basis(Basis::Quarter)).expect("written").0)
        .expect("written");
    // Bins whose edges are those of the patches: means over them are the patches' values, to the sixteen nodes of a bin.
    let mut like = hemisphere(vec![0.0, 18.0, 36.0], Some(vec![0.0]), 2, 24);
    like.theta_r_edges_deg = vec![0.0, 9.0, 27.0, 46.0, 66.0, 90.0];
    like.phi_r_edges_deg = (0..=24).map(|k| 15.0 * f64::from(k) + 7.5).collect();
    let (found, notes) = import(&path, Format::Klems, &Options::default(), Some(&like)).expect("resampled");
    assert!(found.grid == like && notes.iter().any(|note| note.contains("patches")), "{notes:?}");
    let (matrix, _) = import(&path, Format::Klems, &Options::default(), None).expect("read");
    // Ring 2 (9 to 27) has 8 patches of 45 degrees, the first from -22.5 to 22.5. Light at the normal: incidence 0.
    let value = found.colours[0].total[24];
    assert!(
        (value / matrix.colours[0].total[1] - 1.0).abs() < 1e-6,
        "the bin from 7.5 to 22.5 lies in bin 1"
    );
}

#[test]
fn a_missing_block_is_answered_with_those_that_are_there() {
    let text = small("TensorTree3", "", LAMBERT);
    let other = text.replace("Reflection Back", "Absorption Front");
    let reason = |text: &str| tensor_tree::read(text.as_bytes()).err().expect("must be refused");
    assert!(reason(&other).to_string().contains("Absorption Front (Visible)"), "{}", reason(&other));
    let solar = text.replace("Visible</", "Solar</");
    assert!(reason(&solar).to_string().contains("Reflection Back (Solar)"), "{}", reason(&solar));
    // One block more: read, and named.
    let block = &text[text.find("<WavelengthData>").unwrap()..text.find("</Layer>").unwrap()];
    let both = text
        .replace("</Layer>", &format!("{}</Layer>", block.replace("Reflection Back", "Transmission Front")));
    let (_, notes) = tensor_tree::read_side(both.as_bytes(), None).expect("sound");
    assert!(notes.concat().contains("not read: Transmission Front (Visible)"), "{notes:?}");
    assert_eq!(tensor_tree::read_side(text.as_bytes(), None).expect("sound").1, Vec::<String>::new());
}

#[test]
fn the_wanted_side_is_read() {
    let back = small("TensorTree3", "", LAMBERT);
    let block = &back[back.find("<WavelengthData>").unwrap()..back.find("</Layer>").unwrap()];
    let front = block.replace("Reflection Back", "Reflection Front").replace("0.0954930", "0.2");
    let both = back.replace("</Layer>", &format!("{front}</Layer>"));
    let value = |text: &str, side: Option<SampleSide>| {
        let read = tensor_tree::read_side(text.as_bytes(), side);
        let (tree, notes) = read.map_err(|why| why.to_string())?;
        Ok::<_, String>((
            tree.brdf(direction_deg(10.0, 0.0), direction_deg(20.0, 0.0))[0] as f32,
            notes.concat(),
        ))
    };
    for (side, wanted, said) in [
        (None, 0.095_493, "not read: Reflection Front"),
        (Some(SampleSide::Back), 0.095_493, "not read: Reflection Front"),
        (Some(SampleSide::Front), 0.2, "light from the side -z"),
    ] {
        let (found, notes) = value(&both, side).expect("there");
        assert!(found == wanted && notes.contains(said), "{found} {notes}");
    }
    let why = value(&back, Some(SampleSide::Front)).expect_err("not there");
    assert!(
        why.contains("`Reflection Front` or `Transmission Front`")
            && why.contains("Reflection Back (Visible)"),
        "{why}"
    );
    // A file of that side alone is read without being asked.
    let alone = value(&back.replace("Reflection Back", "Reflection Front"), None).expect("there");
    assert!(alone.0 == 0.095_493 && alone.1.contains("light from the side -z"), "{}", alone.1);
}

#[test]
fn xml_of_other_encodings_and_entities_is_read() {
    let plain = small("TensorTree3", "", LAMBERT);
    let wanted = |bytes: &[u8]| {
        tensor_tree::read(bytes)
            .map(|tree| tree.brdf(direction_deg(0.0, 0.0), direction_deg(9.0, 0.0))[0] as f32)
            .map_err(|why| why.to_string())
    };
    let named = plain
        .replace("<Name>gonio", "<Name>Verre d\u{e9}poli &nbsp; AT&T &amp; &#xD;")
        .replace("UTF-8", "ISO-8859-1");
    let latin: Vec<u8> = named.chars().map(|c| c as u8).collect();
    assert_eq!(wanted(&latin), Ok(0.095_493));
    let utf16 = named.replace("ISO-8859-1", "UTF-16");
    let units = |bytes: fn(u16) -> [u8; 2]| utf16.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    assert_eq!(wanted(&[vec![0xff, 0xfe], units(u16::to_le_bytes)].concat()), Ok(0.095_493));
    assert_eq!(wanted(&[vec![0xfe, 0xff], units(u16::to_be_bytes)].concat()), Ok(0.095_493));
    assert_eq!(wanted(format!("\u{feff}{plain}").as_bytes()), Ok(0.095_493));
    // Values may stand in CDATA, but not beside what nobody declared: it splits no number and joins none.
    assert_eq!(wanted(plain.replace(LAMBERT, &format!("<![CDATA[{LAMBERT}]]>")).as_bytes()), Ok(0.095_493));
    let undeclared =
        wanted(plain.replace("0.0954930 0", "0.0954930&nbsp;0").as_bytes()).expect_err("refused").to_string();
    assert!(undeclared.contains("ScatteringData: nothing declares `&nbsp;`"), "{undeclared}");
    assert_eq!(wanted(plain.replace("0.0954930 0", "0.0954930&#32;0").as_bytes()), Ok(0.095_493));
}

#[test]
fn negative_values_are_counted() {
    let tree = small("TensorTree3", "", "{ 1 -0.25 -1e-3 4 0 0 0 0 }");
    let (_, notes) = tensor_tree::read_side(tree.as_bytes(), None).expect("sound");
    assert_eq!(notes, ["2 of 8 values are negative (the least -2.500e-1) and become 0"]);
    let basis = "<AngleBasis><AngleBasisName>B</AngleBasisName><AngleBasisBlock><nPhis>2</nPhis><ThetaBounds>\
        <LowerTheta>0</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";
    let matrix = small("Columns", basis, "1, -0.5, 3, 4");
    let (table, notes) = klems::read_side(matrix.as_bytes(), None).expect("sound");
    assert_eq!(notes, ["1 of 4 values are negative (the least -5.000e-1) and become 0"]);
    assert_eq!(table.colours[0].total, [1.0, 3.0, 0.0, 4.0]);
}

#[test]
fn damaged_xml_is_refused() {
    let tree = small("TensorTree3", "", "{ {1} {2} {3} {4} {5} {6} {7} { 1 2 3 4 5 6 7 8 } }");
    assert!(tensor_tree::read(tree.as_bytes()).is_ok());
    let basis = "<AngleBasis><AngleBasisName>B</AngleBasisName><AngleBasisBlock><nPhis>2</nPhis><ThetaBounds>\
        <LowerTheta>0</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";
    let matrix = small("Columns", basis, "1, 2, 3, 4");
    assert_eq!(klems::read(matrix.as_bytes()).expect("sound").colours[0].total, [1.0, 3.0, 2.0, 4.0]);
    let klems_reason = |text: &str| klems::read(text.as_bytes()).expect_err("must be refused").to_string();
    assert!(klems_reason("").contains("empty"));
    assert!(klems_reason("<html></html>").contains("WindowElement"));
    // Cut between two tags, and inside one.
    assert!(klems_reason(matrix.split("</Optical>").next().expect("text")).contains("cut off"));
    assert!(klems_reason(&matrix[..matrix.len() - 9]).contains("XML at byte"));
    assert!(klems_reason(&matrix.replace("3, 4", "3")).contains("3 values, 2 x 2 needed"));
    assert!(klems_reason(&matrix.replace("3, 4", "3, 4, 5")).contains("more than"));
    assert!(klems_reason(&matrix.replace("3, 4", "3, nan")).contains("NaN"));
    assert!(klems_reason(&tree).contains("TensorTree3"));
    let tree_reason = |text: &str| tensor_tree::read(text.as_bytes()).err().expect("must be refused");
    assert!(tree_reason(&tree.replace("{7}", "")).to_string().contains("brace"));
    assert!(tree_reason(&tree.replace("{7}", "{7 8 9}")).to_string().contains("3 values"));
    assert!(tree_reason(&tree.replace("{7}", "{inf}")).to_string().contains("no finite number"));
    let deep = tree.replace("{7}", &"{".repeat(100_000));
    assert!(tree_reason(&deep).to_string().contains("deep"));
    let coloured = radiance::reflection(
        "TensorTree3",
        "",
        "",
        &[("Visible", "{ 1 }".into()), ("CIE-u", "{ 0.2 }".into()), ("CIE-v", "{ 0 }".into())],
    );
    assert_eq!(tensor_tree::read(coloured.as_bytes()).expect("sound").colours(), 3);
    assert!(mutations::refused(tree.as_bytes(), tensor_tree::read) > 0.2);
    assert!(mutations::refused(coloured.as_bytes(), tensor_tree::read) > 0.1);
    assert!(mutations::refused(matrix.as_bytes(), klems::read) > 0.2);
}

fn in_basis(basis: Basis) -> Options {
    Options { klems: Some(basis), ..Options::default() }
}

fn small(structure: &str, basis: &str, data: &str) -> String {
    let bases = "<ColumnAngleBasis>B</ColumnAngleBasis><RowAngleBasis>B</RowAngleBasis>";
    radiance::reflection(structure, basis, bases, &[("Visible", data.into())])
}
