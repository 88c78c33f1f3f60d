//! Promise: areal parameters are those that an independent package (`surfalize` 0.19.2) has of the same heights.

use std::fs;
use std::path::Path;

use gonio::surface::areal::Roughness;
use gonio::surface::io::map_file;
use gonio::surface::io::prepare::MapGrid;

/// Moments and slopes have one definition (ISO 25178-2:2021): eight digits of the file, and sums in another order. Sal and Str
/// do not say how to interpolate between samples: surfalize takes the nearest of 1000 places on a cubic spline, here it is a
/// polynomial of degree 5. Where the autocorrelation falls within one sample, either is a guess.
#[test]
fn ten_maps_have_the_parameters_of_an_independent_package() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/maps");
    let text = fs::read_to_string(folder.join("areal/areal.csv")).expect("readable");
    let mut compared = 0;
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let (file, number) = (fields[0], |k: usize| fields[k].parse::<f64>().ok());
        let map = map_file::read(&fs::read(folder.join(file)).expect("a map")).expect("readable");
        let pitch = [number(1).expect("x"), number(2).expect("y")];
        let unit = map.unit_um.unwrap_or(1.0);
        let mean = map.heights.iter().sum::<f64>() / map.heights.len() as f64;
        let heights: Vec<f64> = map.heights.iter().map(|height| unit * (height - mean)).collect();
        let grid = MapGrid { columns: map.columns, pitch, periodic: false };
        let found = Roughness::of(&heights, &grid).expect("room").parameters;
        let same =
            [Some(found.sa), Some(found.sq), found.ssk, found.sku, Some(found.sdq), Some(100.0 * found.sdr)];
        for (k, found) in same.into_iter().enumerate() {
            let (found, wanted) = (found.expect("rough"), number(3 + k).expect("a number"));
            // Skewness is a difference of large sums: absolute.
            assert!(
                (found - wanted).abs() < 2e-6 * wanted.abs().max(0.01),
                "{file}: parameter {k}: {found} {wanted}"
            );
        }
        let pitch = pitch[0].max(pitch[1]);
        let (sal, wanted) = (found.sal.expect("falls"), number(9).expect("falls"));
        let off = if wanted < 2.0 * pitch { 0.05 } else { 0.02 } * pitch;
        assert!((sal - wanted).abs() < off, "{file}: Sal {sal} {wanted}");
        match (found.str, number(10)) {
            (Some(found), Some(wanted)) => {
                assert!((found / wanted - 1.0).abs() < 0.06, "{file}: Str {found} {wanted}")
            }
            (found, wanted) => assert_eq!(found, wanted, "{file}: Str"),
        }
        compared += 1;
    }
    assert_eq!(compared, 10);
}
