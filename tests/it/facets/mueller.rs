//! Promise: Mueller matrices are those of the electric field itself, facet by facet and over whole paths; every matrix that
//! is measured is one that a real surface may have; at order 1 m00 is the table's own value.
//!
//! The rows are made by tests/data/mueller.py.

use glam::DVec3;
use gonio::campaign;
use gonio::instrument::Sensor;
use gonio::measure::Measured;
use gonio::optics::mueller::{Frame, MuellerPath, PolarisedFacet};
use gonio::optics::{FacetAngle, Fresnel};
use gonio::sphere::sin_cos_deg;
use gonio::table::store;
use rustfft::num_complex::Complex64;

use crate::support::arrays;
use crate::support::measuring::{measured, measured_in, measured_one};

/// Numbers given and expected in the rows of a kind.
fn rows(kind: &str) -> Vec<[Vec<f64>; 2]> {
    let mut reader = csv::Reader::from_path("tests/data/mueller.csv").expect("the reference file");
    let all = reader.deserialize().map(|row| row.expect("a row"));
    let numbers = |text: &str| text.split(' ').map(|n| n.parse().expect("a number")).collect();
    all.filter(|(row, _, _): &(String, String, String)| row == kind)
        .map(|(_, given, expected)| [numbers(&given), numbers(&expected)])
        .collect()
}

fn fresnel(eta: f64, k: f64) -> Fresnel {
    if k == 0.0 { Fresnel::Dielectric { eta } } else { Fresnel::Conductor { eta, k } }
}

fn polarised(angle: FacetAngle, eta: f64, k: f64, through: bool) -> PolarisedFacet {
    if through {
        PolarisedFacet::transmission(angle, eta)
    } else {
        PolarisedFacet::reflection(&fresnel(eta, k), angle)
    }
}

#[test]
fn facets_turn_polarised_light_as_reference_values_say() {
    let mut worst = 0.0f64;
    let rows = rows("facet");
    for [given, expected] in &rows {
        let [eta, k, theta, through] = given[..] else { panic!("{given:?}") };
        let (sin, cos) = sin_cos_deg(theta);
        let found = polarised(FacetAngle { cos, sin2: sin * sin }, eta, k, through == 1.0);
        for (found, expected) in [found.a, found.b, found.c].iter().zip(expected) {
            worst = worst.max((found - expected).abs());
        }
    }
    // The angle rounds by 1 ulp, which sqrt(m + c^2) magnifies by c/g, 40 at 0.01 degrees from the critical angle and
    // 89 at 1.0001 and 89 degrees; a dozen roundings more. Relative to r_p near Brewster's angle nothing is promised.
    assert!(worst < 100.0 * 16.0 * f64::EPSILON, "{worst:e}");
    assert!(rows.len() > 100, "{}", rows.len());
}

#[test]
fn paths_over_several_facets_keep_the_field() {
    let rows = rows("path");
    for [given, expected] in &rows {
        let (eta, k, wi) = (given[0], given[1], DVec3::from_slice(&given[3..]));
        let across = |w: DVec3| DVec3::new(-w.y, w.x, 0.0);
        let mut path = MuellerPath::new(Frame::near(across(wi), -wi));
        let (mut ray, mut below) = (-wi, false);
        for facet in given[6..].chunks(4) {
            let (normal, through) = (DVec3::from_slice(facet), facet[3] == 1.0);
            let normal = if ray.dot(normal) > 0.0 { -normal } else { normal };
            let here = if below { 1.0 / eta } else { eta };
            let c = -ray.dot(normal);
            // Snell's law as the textbook has it.
            let root = (here * here - 1.0 + c * c).max(0.0).sqrt();
            ray = if through { (ray + (c - root) * normal) / here } else { ray + 2.0 * c * normal };
            let angle = FacetAngle { cos: c, sin2: 1.0 - c * c };
            path.meet(normal, ray, polarised(angle, here, k, through));
            below ^= through;
        }
        assert!(ray.distance(DVec3::from_slice(expected)) < 1e-12, "{ray} {expected:?}");
        for (found, expected) in path.seen(across(ray)).iter().zip(&expected[3..]) {
            // Four facets of a dozen roundings each, some near the critical angle.
            assert!((found - expected).abs() < 1e-11, "{found} {expected}: {given:?}");
        }
    }
    assert!(rows.len() >= 32);
}

/// The 16 elements of a colour in a bin, and the bin's value.
fn matrix(measured: &Measured, colour: usize, entry: usize) -> ([f64; 16], f64) {
    let channels = &measured.table.colours[colour];
    (std::array::from_fn(|e| f64::from(channels.mueller[e][entry])), f64::from(channels.total[entry]))
}

const METAL: &str = "[optics]\neta = 0.2\nk = 3.4\nfresnel = \"exact\"\npolarisation = \"mueller\"\n";
const GLASS: &str = "[optics]\nfacet = \"dielectric\"\neta = 1.5\npolarisation = \"mueller\"\n";

#[test]
fn a_mirror_has_the_matrix_of_its_facet() {
    for (side, eta) in [("front", 1.5), ("back", 1.0 / 1.5)] {
        let glass = format!(
            "name = \"m\"\n[surface.mirror]\n{GLASS}[light]\ntheta_i_deg = [20, 33]\nazimuth = \"absolute\"\n\
             phi_i_deg = [0, 77]\nside = \"{side}\"\n[sensor.hemisphere]\nside = \"both\"\n[stop]\nsamples = 64\n"
        );
        let table = measured_one(&glass);
        let grid = &table.table.grid;
        for incidence in 0..grid.incidences() {
            let (sin, cos) = sin_cos_deg(grid.incidence_deg(incidence).0);
            let angle = FacetAngle { cos, sin2: sin * sin };
            let mut found = 0;
            for bin in 0..grid.bins() {
                let (elements, value) = matrix(&table, 0, incidence * grid.bins() + bin);
                if value == 0.0 {
                    assert_eq!(elements, [0.0; 16]);
                    continue;
                }
                let below = grid.regions(incidence)[bin].is_below();
                let PolarisedFacet { a, b, c } = polarised(angle, eta, 0.0, below);
                let rows = [1.0, a, 0.0, 0.0, a, 1.0, 0.0, 0.0, 0.0, 0.0, b, -c, 0.0, 0.0, c, b];
                for (found, expected) in elements.iter().zip(rows) {
                    // f32 values; a plane turned by 77 degrees and back rounds to 1e-16.
                    assert!(
                        (found / value - expected).abs() < 2e-7,
                        "{side} {incidence} {bin}: {elements:?} {value}"
                    );
                }
                found += 1;
            }
            assert_eq!(found, 2, "{side} {incidence}");
        }
    }
}

#[test]
fn light_between_the_sides_of_a_groove_has_both_reflections() {
    let folder = tempfile::tempdir().expect("temporary folder");
    // Ridges along x, one sample apart from 8 below them: slope 1 on both sides.
    let heights: Vec<f64> = (0..256).map(|i| f64::from((i / 16 - 8i32).abs())).collect();
    std::fs::write(folder.path().join("groove.npy"), arrays::npy(&heights, 16)).expect("file");
    for [given, expected] in rows("groove") {
        let [eta, k, theta] = given[..] else { panic!("{given:?}") };
        let tables = measured_in(
            folder.path(),
            &format!(
                "name = \"g\"\n[surface.file]\npath = \"groove.npy\"\npitch_x_um = 1\npitch_y_um = 1\n\
                 height_unit_um = 1\nperiodic = true\ndetrend = \"none\"\nrefine = 1\n\
                 [optics]\neta = {eta}\nk = {k}\nfresnel = \"exact\"\npolarisation = \"mueller\"\n\
                 [light]\ntheta_i_deg = [{theta}]\nazimuth = \"absolute\"\nphi_i_deg = [0]\n\
                 [sensor.hemisphere]\ntheta_r_bins = 18\nphi_r_bins = 24\nbins = \"centred\"\n[trace]\nbounces = 3\n\
                 [stop]\nsamples = 256\n"
            ),
        );
        let grid = &tables[0].table.grid;
        let mut bin = 0;
        Sensor::new(grid).each_bin(DVec3::new(-grid.wi(0).x, 0.0, grid.wi(0).z), |found| bin = found);
        let size = grid.sizes(0)[bin];
        let (elements, _) = matrix(&tables[0], 0, bin);
        for (found, expected) in elements.iter().zip(&expected) {
            // f32 values of a share below 1.
            assert!((found * size - expected).abs() < 2e-7, "{found} {expected}: {given:?}");
        }
    }
}

/// Whether a matrix is a sum of ones that keep light polarised (Cloude 1986): its coherency matrix, with `slack` times m00
/// on its diagonal, has a Cholesky factor.
fn is_physical(m: &[f64; 16], slack: f64) -> bool {
    let i = Complex64::i();
    let one = Complex64::ONE;
    let zero = Complex64::ZERO;
    // V = 2 Im(E_s conj(E_p)): minus the usual third matrix.
    let sigma =
        [[one, zero, zero, one], [one, zero, zero, -one], [zero, one, one, zero], [zero, i, -i, zero]];
    let mut h = [[zero; 4]; 4];
    for (e, value) in m.iter().enumerate() {
        let (a, b) = (sigma[e / 4], sigma[e % 4]);
        for (row, line) in h.iter_mut().enumerate() {
            for (column, entry) in line.iter_mut().enumerate() {
                let left = a[row / 2 * 2 + column / 2];
                let right = b[row % 2 * 2 + column % 2].conj();
                *entry += left * right * *value / 4.0;
            }
        }
    }
    let mut l = [[zero; 4]; 4];
    for row in 0..4 {
        for column in 0..=row {
            let known: Complex64 = (0..column).map(|k| l[row][k] * l[column][k].conj()).sum();
            let rest = h[row][column] - known;
            if row == column {
                let square = rest.re + slack * m[0];
                if square <= 0.0 {
                    return false;
                }
                l[row][row] = Complex64::from(square.sqrt());
            } else {
                l[row][column] = rest / l[column][column];
            }
        }
    }
    true
}

#[test]
fn the_measure_of_what_is_physical_tells_good_from_bad() {
    let diagonal = |d: [f64; 4]| std::array::from_fn(|e| if e / 4 == e % 4 { d[e / 4] } else { 0.0 });
    assert!(is_physical(&diagonal([1.0, 1.0, -1.0, -1.0]), 1e-9));
    assert!(is_physical(&diagonal([1.0, 0.0, 0.0, 0.0]), 1e-9));
    // The transpose of polarised light alone is no surface: all four with one sign turned.
    assert!(!is_physical(&diagonal([1.0, 1.0, 1.0, -1.0]), 1e-9));
    assert!(!is_physical(&diagonal([1.0, 0.9, 0.9, -0.9]), 1e-3));
}

#[test]
fn every_measured_matrix_is_physical() {
    for (surface, optics, trace) in [
        ("cells = 64\ncorrelation_cells = 4\n[surface.ggx]\nalpha = 0.6", METAL, "bounces = 4"),
        ("[surface.smith]\nalpha = 0.5", GLASS, "bounces = 12"),
        ("cells = 64\ncorrelation_cells = 4\n[surface.beckmann]\nalpha = 0.5", GLASS, "bounces = 1"),
    ] {
        let glass = if optics == GLASS { "side = \"both\"\n" } else { "" };
        let tables = measured(&format!(
            "name = \"p\"\n[surface]\nrealisations = 3\n{surface}\n{optics}[light]\ntheta_i_deg = [0, 35, 75]\n\
             azimuth = \"relative\"\n{glass}[sensor.hemisphere]\n{glass}theta_r_bins = 9\nphi_r_bins = 12\n\
             [trace]\n{trace}\n[stop]\nsamples = 16_384\n"
        ));
        assert_eq!(tables.len(), if optics == GLASS { 2 } else { 1 });
        for table in &tables {
            let (mut seen, mut turned) = (0, 0.0f64);
            for entry in 0..table.table.hits.len() {
                let (elements, _) = matrix(table, 0, entry);
                if elements[0] == 0.0 {
                    continue;
                }
                seen += 1;
                turned = turned.max(elements[14].abs() / elements[0]);
                // Sixteen f32 values, each rounded to 6e-8 of m00 or less.
                assert!(is_physical(&elements, 16.0 * 6e-8), "{surface} {trace}: {elements:?}");
            }
            assert!(seen > 100, "{seen}");
            // Metal, and glass from inside, turn linear light into circular.
            assert!(optics == GLASS || turned > 0.01, "{turned}");
        }
    }
}

#[test]
fn at_order_1_m00_is_the_scalar_runs_value_to_the_byte() {
    for (optics, plain) in [
        (METAL, METAL.replace("mueller", "none")),
        (GLASS, GLASS.replace("polarisation = \"mueller\"\n", "")),
    ] {
        let text = |optics: &str| {
            format!(
                "name = \"b\"\n[surface]\nrealisations = 3\ncells = 64\ncorrelation_cells = 4\n[surface.ggx]\n\
                 alpha = 0.4\n{optics}[light]\ntheta_i_deg = [0, 50]\nazimuth = \"relative\"\n[sensor.hemisphere]\n{}\
                 [stop]\nsamples = 16_384\n",
                if optics.contains("dielectric") { "side = \"both\"\n" } else { "" }
            )
        };
        let (with, without) = (measured_one(&text(optics)), measured_one(&text(&plain)));
        let (with, without) = (&with.table.colours[0], &without.table.colours[0]);
        assert_eq!(with.total, without.total);
        assert_eq!(with.stderr, without.stderr);
        assert_eq!(with.mueller[0], without.total);
        assert_eq!(with.stderr_mueller[0], without.stderr);
        assert!(without.mueller.is_empty());
    }
}

/// Under relative azimuths each arrival counts on both sides of the plane of incidence: elements that mix linear light along
/// and across the plane with the rest are opposite on both sides, to the bit.
#[test]
fn both_sides_of_the_plane_of_incidence_mirror_each_other() {
    let table = measured_one(&format!(
        "name = \"s\"\n[surface]\nrealisations = 2\ncells = 64\ncorrelation_cells = 4\n[surface.ggx]\nalpha = 0.5\n\
         {METAL}[light]\ntheta_i_deg = [40]\nazimuth = \"relative\"\n[sensor.hemisphere]\ntheta_r_bins = 6\nphi_r_bins = 8\n\
         bins = \"centred\"\n[trace]\nbounces = 3\n[stop]\nsamples = 8_192\n"
    ));
    assert!(
        (table.table.grid.phi_r_edges_deg[0] + 22.5).abs() < 1e-12,
        "the first column is centred on the light"
    );
    let mut mixed = 0.0f64;
    for row in 0..6 {
        for column in 0..8 {
            let [(here, _), (there, _)] = [column, (8 - column) % 8].map(|c| matrix(&table, 0, row * 8 + c));
            for element in 0..16 {
                let mixes = (element / 4 < 2) != (element % 4 < 2);
                assert_eq!(here[element], if mixes { -there[element] } else { there[element] });
                mixed = mixed.max(if mixes { here[element].abs() / here[0].max(1e-9) } else { 0.0 });
            }
        }
    }
    assert!(mixed > 0.1, "{mixed}");
}

#[test]
fn matrices_come_back_from_the_tables_file_and_their_campaign_from_its_text() {
    let text = format!(
        "name = \"f\"\n[surface]\nrealisations = 2\n[surface.smith]\nalpha = 0.5\n{GLASS}[light]\ntheta_i_deg = [40]\n\
         [sensor.hemisphere]\nside = \"transmission\"\ntheta_r_bins = 6\nphi_r_bins = 8\n[stop]\nsamples = 4_096\n"
    );
    let table = measured_one(&text).table;
    assert!(table.campaign.contains("polarisation = \"mueller\""));
    assert!(
        campaign::parse(&table.campaign, "c", "".as_ref())
            .expect("its own text")
            .campaign
            .optics
            .has_mueller()
    );
    let loaded = store::decode("t.exr".as_ref(), &store::encode(&table).expect("bytes")).expect("sound");
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    assert_eq!(loaded.table, table);
}

/// Light the other way round has the transposed matrix, with the signs of what mixes +-45 degrees turned (Sekera 1966): from the
/// front and from the back, whose frame is a mirror's.
#[test]
fn light_the_other_way_round_has_the_transposed_matrix() {
    let through = |side: &str, [theta_i, theta_r, phi_r]: [f64; 3]| {
        let table = measured_one(&format!(
            "name = \"r\"\n[surface]\nrealisations = 2\n[surface.smith]\nalpha = 0.5\n{GLASS}[light]\n\
             theta_i_deg = [{theta_i}]\nside = \"{side}\"\n[sensor.arm]\ntheta_r_deg = [{theta_r}]\n\
             phi_r_deg = [{phi_r}]\naperture_deg = 2\n[stop]\nsamples = 1_048_576\n"
        ));
        let (elements, _) = matrix(&table, 0, 0);
        assert!(table.table.hits[0] > 500, "{:?}", table.table.hits);
        elements.map(|element| element / elements[0])
    };
    // 40 degrees outside, 30 inside, 20 off the plane.
    let (front, back) = (through("front", [40.0, 150.0, 160.0]), through("back", [30.0, 140.0, -160.0]));
    let mut mixed = 0.0f64;
    for row in 0..4 {
        for column in 0..4 {
            let sign = if (row == 2) == (column == 2) { 1.0 } else { -1.0 };
            let (found, expected) = (back[4 * row + column], sign * front[4 * column + row]);
            // One facet decides for both directions, but for where in the apertures, 2 degrees wide, they lie: elements change
            // by 0.3 a radian at most, their means by a tenth of that of the half-angle where light is uneven.
            assert!((found - expected).abs() < 0.004, "{row} {column}: {found} {expected}");
            mixed = mixed.max(if (row < 2) != (column < 2) { expected.abs() } else { 0.0 });
        }
    }
    assert!(mixed > 0.015, "{mixed}");
}
