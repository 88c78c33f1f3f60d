//! Promise: Radiance's matrices and tensor trees hold the table, and damaged XML is refused. (Radiance itself reads them
//! in tests/interop.)

#[path = "common/analytic.rs"]
mod analytic;
#[path = "common/mutations.rs"]
mod mutations;

use analytic::{Ggx, hemisphere, l1, steps, table};
use gonio::instrument::GridKind;
use gonio::interchange::klems::{self, Patchwise};
use gonio::interchange::{Brdf, Lookup, resample::nodes, tensor_tree};
use gonio::sphere;

#[test]
fn klems_patches_come_back() {
    let ggx = Ggx::new(0.5, 0.5);
    let own = table(&ggx, &hemisphere(steps(5.0, 18), None, 45, 90));
    let text = klems::write(&own).expect("written");
    assert!(text.contains("<WavelengthDataDirection>Reflection Back</WavelengthDataDirection>"));
    let back = klems::read(text.as_bytes()).expect("readable");
    assert_eq!((back.grid.kind, back.grid.stops(), back.grid.bins()), (GridKind::Patches, 145, 145));
    // Projected solid angles of the 145 patches add up to pi.
    let sizes: f64 = back.grid.regions(0).iter().map(|region| region.projected_solid_angle()).sum();
    assert!((sizes - std::f64::consts::PI).abs() < 1e-12);
    // Ring 3 begins behind 1 + 8 + 16 patches: light there travels to 30 degrees, azimuth 0, so it comes from 180.
    let stop = 25;
    assert_eq!(back.grid.stop_deg(stop), (30.0, 180.0));
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
    let (wanted, found) = (sum / 144.0 / 144.0, f64::from(back.colours[0].total[stop * 145 + bin]));
    // Midpoints: (step/lobe)^2/24, 2e-4; the table between its stops of 5 degrees: 1e-3.
    assert!((found / wanted - 1.0).abs() < 2e-3, "{found} {wanted}");
    // The matrix itself, written and read again, to the seven digits of its text.
    let again = klems::read(klems::write(&back).expect("written").as_bytes()).expect("readable");
    let pairs = back.colours[0].total.iter().zip(&again.colours[0].total);
    assert!(pairs.clone().all(|(a, b)| (a - b).abs() <= 1e-7 * a), "{:?}", pairs.clone().next());
    // And as a function each patch has its value.
    let patchwise = Patchwise::new(back.clone()).expect("the full basis");
    let wo = nodes(&back.grid.regions(stop)[bin])[5].0;
    assert_eq!(patchwise.brdf(back.grid.wi(stop), wo)[0], found);
}

#[test]
fn tensor_trees_of_both_ranks_are_within_three_hundredths() {
    let light: Vec<(f64, f64)> = [5.0, 20.0, 40.0, 60.0].map(|t| (t, 3.0 * t)).to_vec();
    let isotropic = Lookup::new(&table(&Ggx::new(0.3, 0.3), &hemisphere(steps(5.0, 18), None, 90, 120)));
    let text = tensor_tree::write(&isotropic.expect("a product"));
    assert!(text.contains("<IncidentDataStructure>TensorTree3<"));
    let found = tensor_tree::read(text.as_bytes()).expect("readable");
    let off = l1(&found, &Ggx::new(0.3, 0.3), &light, 80.0);
    assert!(off <= 0.03, "rank 3: {off}");
    let grid = hemisphere(steps(10.0, 9), Some(steps(15.0, 24)), 30, 48);
    let text = tensor_tree::write(&Lookup::new(&table(&Ggx::new(0.4, 0.7), &grid)).expect("a product"));
    assert!(text.contains("<IncidentDataStructure>TensorTree4<"));
    let found = tensor_tree::read(text.as_bytes()).expect("readable");
    let off = l1(&found, &Ggx::new(0.4, 0.7), &light, 80.0);
    assert!(off <= 0.03, "rank 4: {off}");
}

#[test]
fn colours_of_radiance_files_come_back() {
    let mut ggx = Ggx::new(0.5, 0.5);
    ggx.tint = vec![0.9, 0.5, 0.2];
    let own = table(&ggx, &hemisphere(steps(10.0, 9), None, 30, 60));
    let text = klems::write(&own).expect("written");
    for channel in ["Visible", "CIE-X", "CIE-Z"] {
        assert!(text.contains(&format!("<Wavelength unit=\"Integral\">{channel}</Wavelength>")));
    }
    let back = klems::read(text.as_bytes()).expect("readable");
    assert_eq!(back.colours.len(), 3);
    let [r, g, b] = [0, 1, 2].map(|c| &back.colours[c].total);
    // Eight digits of XYZ, through a matrix with a condition number below 5.
    let off = |k: usize| (g[k] / r[k] - 5.0 / 9.0).abs().max((b[k] / r[k] - 2.0 / 9.0).abs());
    assert!((0..r.len()).all(|k| off(k) < 1e-5));
    let text = tensor_tree::write(&Lookup::new(&own).expect("a product"));
    assert!(text.contains("CIE-u") && text.contains("CIE-v"));
    let found = tensor_tree::read(text.as_bytes()).expect("readable");
    assert_eq!(found.colours(), 3);
    let [r, g, b] = found.brdf(sphere::direction_deg(30.0, 0.0), sphere::direction_deg(35.0, 185.0));
    // u' and v' have five digits; b is a small difference of Y, u' and v'.
    assert!((g / r - 5.0 / 9.0).abs() < 1e-3 && (b / r - 2.0 / 9.0).abs() < 2e-3, "{r} {g} {b}");
    let damaged = text.replacen("CIE-u</", "CIE-w</", 1);
    assert_eq!(tensor_tree::read(damaged.as_bytes()).expect("readable").colours(), 1);
}

#[test]
fn damaged_xml_is_refused() {
    let tree = small("TensorTree3", "", "{ {1} {2} {3} {4} {5} {6} {7} { 1 2 3 4 5 6 7 8 } }");
    assert!(tensor_tree::read(tree.as_bytes()).is_ok());
    let basis = "<AngleBasis><AngleBasisName>B</AngleBasisName><AngleBasisBlock><nPhis>2</nPhis><ThetaBounds>\
        <LowerTheta>0</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";
    let matrix = small("Columns", basis, "1, 2, 3, 4");
    assert_eq!(klems::read(matrix.as_bytes()).expect("sound").colours[0].total, [1.0, 3.0, 2.0, 4.0]);
    let klems_reason = |text: &str| klems::read(text.as_bytes()).expect_err("must be refused");
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
    assert!(tree_reason(&tree.replace("{7}", "")).contains("brace"));
    assert!(tree_reason(&tree.replace("{7}", "{7 8 9}")).contains("3 values"));
    assert!(tree_reason(&tree.replace("{7}", "{inf}")).contains("no finite number"));
    let deep = tree.replace("{7}", &"{".repeat(100_000));
    assert!(tree_reason(&deep).contains("deep"));
    let coloured = gonio::interchange::radiance_xml::write(
        "TensorTree3",
        "",
        "",
        &[("Visible", "{ 1 }".into()), ("CIE-u", "{ 0.2 }".into()), ("CIE-v", "{ 0 }".into())],
    );
    assert_eq!(tensor_tree::read(coloured.as_bytes()).expect("sound").colours(), 3);
    assert!(mutations::survives(tree.as_bytes(), 100_000, tensor_tree::read) > 20_000);
    assert!(mutations::survives(coloured.as_bytes(), 100_000, tensor_tree::read) > 10_000);
    assert!(mutations::survives(matrix.as_bytes(), 100_000, klems::read) > 20_000);
}

fn small(structure: &str, basis: &str, data: &str) -> String {
    let bases = "<ColumnAngleBasis>B</ColumnAngleBasis><RowAngleBasis>B</RowAngleBasis>";
    gonio::interchange::radiance_xml::write(structure, basis, bases, &[("Visible", data.into())])
}
