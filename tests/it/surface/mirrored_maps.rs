//! Promise: a measured map and its mirror image give mirrored tables: the diagonal along which cells are cut shows in
//! neither.

use gonio::measure::Measured;
use gonio::surface::Heightfield;
use gonio::surface::io::export;

use crate::support::measuring::measured_in;

const ROWS: usize = 18;
const COLUMNS: usize = 36;
const SIDE: usize = 64;

/// Waves across grooves that lie at 30 degrees, 31 and 11 samples long; `mirrored`: at -30 degrees.
fn brushed(mirrored: bool) -> Heightfield {
    let height = |i: usize| {
        let (x, row) = ((i % (SIDE + 1)) as f64, i / (SIDE + 1));
        let y = if mirrored { SIDE - row } else { row } as f64;
        let u = -0.5 * x + 0.75_f64.sqrt() * y;
        (0.2 * u).sin() + 0.3 * (0.55 * u + 1.0).sin()
    };
    Heightfield::new(SIDE, SIDE, false, (0..(SIDE + 1) * (SIDE + 1)).map(height).collect())
}

/// Light along the normal.
fn table(mirrored: bool, seed: u64, refine: &str) -> Measured {
    let folder = tempfile::tempdir().expect("temporary folder");
    let npy = export::encode_npy(&brushed(mirrored)).expect("NPY");
    std::fs::write(folder.path().join("scan.npy"), npy).expect("file");
    let text = format!(
        "name = \"scan\"\nseed = {seed}\n[surface.file]\npath = \"scan.npy\"\npitch_x_um = 1\npitch_y_um = 1\n\
         height_unit_um = 1\ndetrend = \"none\"\ntiles = 2\nrefine = {refine}\n\
         [light]\ntheta_i_deg = [0]\nazimuth = \"absolute\"\nphi_i_deg = [0]\n\
         [sensor.hemisphere]\ntheta_r_bins = {ROWS}\nphi_r_bins = {COLUMNS}\nbins = \"centred\"\n\
         [stop]\nsamples = 65536\n"
    );
    measured_in(folder.path(), &text).pop().expect("one table")
}

/// Sum of the differences of two tables of counts over their mean total, beyond the bins around the pole: there, facets
/// flatter than the lean that the cut leaves have any azimuth. `turned`: the azimuth of `b` is minus that of `a`.
fn l1(a: &Measured, b: &Measured, turned: bool) -> f64 {
    let (a, b) = (&a.table.hits, &b.table.hits);
    assert_eq!(a.len() % COLUMNS, 0);
    let pair = |bin: usize| {
        let (row, column) = (bin / COLUMNS, bin % COLUMNS);
        let column = if turned { (COLUMNS - column) % COLUMNS } else { column };
        (f64::from(a[bin]), f64::from(b[row * COLUMNS + column]))
    };
    let pairs = (COLUMNS..a.len()).map(pair);
    let (difference, total) = pairs.fold((0.0, 0.0), |(d, t), (a, b)| (d + (a - b).abs(), t + 0.5 * (a + b)));
    difference / total
}

/// Tables of two seeds differ by the noise of either; the mirrored one may by no more than three times that (its own
/// noise, and the lean of facets that is left). Power: the map's own cells, cut as they come, differ by more than a
/// quarter of all light.
#[test]
fn a_map_and_its_mirror_image_give_mirrored_tables() {
    let plus = table(false, 1, "\"auto\"");
    let noise = l1(&plus, &table(false, 2, "\"auto\""), false);
    let found = l1(&plus, &table(true, 3, "\"auto\""), true);
    assert!(found < 3.0 * noise + 0.01, "L1 {found}, noise {noise}");
    let old = l1(&table(false, 1, "1"), &table(true, 3, "1"), true);
    assert!(old > 0.25 && old > 20.0 * found, "L1 {old} by the map's own cells, {found} refined");
}
