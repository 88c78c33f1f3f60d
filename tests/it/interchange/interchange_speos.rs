//! Promise: anisotropic BSDF files of Speos have the rows that Ansys describes, and each value stands at the angles that its
//! definition of them gives. No other program has read one of these files.

use glam::DVec3;
use gonio::interchange::{self, Brdf, Format, Options};
use gonio::sphere;
use gonio::table::BrdfTable;

use crate::support::analytic::{Ggx, hemisphere, steps, table};

fn written(own: &BrdfTable) -> Vec<String> {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("a.anisotropicbsdf");
    let export = interchange::export(own, Format::Speos, &Options::default(), &path).expect("written");
    assert_eq!(export.read_back.expect("light").l1, 0.0);
    std::fs::read_to_string(&path).expect("there").lines().map(String::from).collect()
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().map(|word| word.parse().expect("a number")).collect()
}

/// A table of a file: its azimuths, and each polar angle with its values.
type Block = (Vec<f64>, Vec<(f64, Vec<f64>)>);

/// The incidences of each angle of the vector, and all tables in their order.
fn content(lines: &[String]) -> (Vec<(f64, Vec<f64>)>, Vec<Block>) {
    assert_eq!(lines[0], "OPTIS - Anisotropic BSDF surface file v8.0");
    assert_eq!((&lines[1][..], lines[3].parse()), ("0", Ok(lines[4].len())));
    assert_eq!((&lines[5][..], &lines[6][..], &lines[7][..]), ("1\t0\t0", "1\t0", "1"));
    let angles = numbers(&lines[9]);
    assert_eq!(numbers(&lines[8]), [angles.len() as f64]);
    let mut at = 10;
    let rotations: Vec<(f64, Vec<f64>)> = angles
        .iter()
        .map(|&angle| {
            let thetas = numbers(&lines[at + 1]);
            assert_eq!(numbers(&lines[at]), [thetas.len() as f64]);
            at += 2;
            (angle, thetas)
        })
        .collect();
    assert_eq!(numbers(&lines[at]), [rotations[0].1[0], angles[0]]);
    assert_eq!((&lines[at + 1][..], &lines[at + 2][..]), ("", "2"));
    at += 5;
    let mut blocks = vec![];
    for _ in rotations.iter().flat_map(|(_, thetas)| thetas) {
        let sizes = numbers(&lines[at]);
        let phis = numbers(&lines[at + 1]);
        let rows: Vec<(f64, Vec<f64>)> = lines[at + 2..][..sizes[0] as usize]
            .iter()
            .map(|line| (numbers(line)[0], numbers(line)[1..].to_vec()))
            .collect();
        assert!(sizes[1] as usize == phis.len() && rows.iter().all(|row| row.1.len() == phis.len()));
        assert!(phis.is_sorted_by(|a, b| a < b) && rows.is_sorted_by(|a, b| a.0 < b.0));
        assert_eq!((phis[0], phis[phis.len() - 1]), (0.0, 360.0));
        at += 2 + rows.len();
        blocks.push((phis, rows));
    }
    assert_eq!((&lines[at][..], lines.len()), ("End of file", at + 1));
    (rotations, blocks)
}

/// 0.6/pi, whatever the directions.
struct Lambert;

impl Brdf for Lambert {
    fn colours(&self) -> usize {
        1
    }

    fn brdf(&self, _wi: DVec3, _wo: DVec3) -> [f64; 3] {
        [0.6 / std::f64::consts::PI; 3]
    }
}

#[test]
fn a_lambertian_surface_is_constant_and_reflects_its_albedo() {
    let lines = written(&table(&Lambert, &hemisphere(steps(30.0, 3), None, 6, 12)));
    let (rotations, blocks) = content(&lines);
    assert_eq!(rotations, [(0.0, vec![0.0, 30.0, 60.0])]);
    let wanted = 0.6 / std::f64::consts::PI;
    // f32 of a mean of equal values.
    let near = |value: &f64| (value / wanted - 1.0).abs() < 1e-6;
    assert!(blocks.iter().flat_map(|(_, rows)| rows).flat_map(|(_, values)| values).all(near));
    // The spectrum is flat, in per cent: the albedo is that of the surface.
    for (line, nm) in lines[15..17].iter().zip([350.0, 850.0]) {
        assert!(numbers(line)[0] == nm && (numbers(line)[1] - 60.0).abs() < 1e-4, "{line}");
    }
}

/// For every value of a brushed table the light's and the sensor's directions are made of the four angles by Speos'
/// definition, in the frame of the sample, where the anisotropy vector is x; the entry of the table that is there has
/// the value.
#[test]
fn values_stand_at_the_angles_of_speos() {
    let own = table(&Ggx::new(0.2, 0.5), &hemisphere(steps(30.0, 3), Some(steps(45.0, 8)), 6, 12));
    let (rotations, blocks) = content(&written(&own));
    assert_eq!(rotations.iter().map(|(angle, _)| *angle).collect::<Vec<_>>(), steps(45.0, 8));
    let mut blocks = blocks.iter();
    let mut compared = 0;
    for (angle, thetas) in &rotations {
        for &theta_i in thetas {
            // The light travels along X; from X it is `angle` to x, counter-clockwise: X is at -angle, the lamp opposite.
            let travel = -angle;
            let wi = sphere::direction_deg(theta_i, travel + 180.0);
            let close = |incidence: &usize| own.grid.wi(*incidence).distance(wi) < 1e-9;
            let incidences: Vec<usize> = (0..own.grid.incidences()).filter(close).collect();
            let (phis, rows) = blocks.next().expect("a table");
            for (theta_o, values) in rows {
                // The last column is the first again.
                for (phi_o, value) in phis.iter().zip(values).take(phis.len() - 1) {
                    let wo = sphere::direction_deg(*theta_o, travel + phi_o);
                    let bins: Vec<usize> =
                        (0..own.grid.bins()).filter(|bin| middle(&own, *bin).distance(wo) < 1e-9).collect();
                    let [bin] = bins[..] else { continue };
                    // Light from the pole has every azimuth.
                    let mut all = incidences
                        .iter()
                        .map(|incidence| own.colours[0].total[incidence * own.grid.bins() + bin]);
                    assert!(all.any(|own| own == *value as f32), "{angle} {theta_i} {theta_o} {phi_o}");
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, own.grid.incidences() * own.grid.bins());
}

/// The middle of a bin of absolute azimuths.
fn middle(own: &BrdfTable, bin: usize) -> DVec3 {
    let (thetas, phis) = (&own.grid.theta_r_edges_deg, &own.grid.phi_r_edges_deg);
    let columns = phis.len() - 1;
    let mid = |edges: &[f64], at: usize| 0.5 * (edges[at] + edges[at + 1]);
    sphere::direction_deg(mid(thetas, bin / columns), mid(phis, bin % columns))
}

#[test]
fn the_mirror_direction_is_at_phi_0() {
    let own = table(&Ggx::new(0.1, 0.1), &hemisphere(vec![40.0], None, 18, 36));
    let (_, blocks) = content(&written(&own));
    let (phis, rows) = &blocks[0];
    let all =
        rows.iter().flat_map(|(theta, values)| phis.iter().zip(values).map(move |(p, v)| (*v, *theta, *p)));
    let (_, theta, phi) = all.max_by(|a, b| a.0.total_cmp(&b.0)).expect("values");
    // The bins beside it are 5 degrees wide, and columns 10.
    assert!((theta - 40.0).abs() <= 2.5 + 1e-9 && (phi <= 5.0 || phi >= 355.0), "{theta} {phi}");
}

#[test]
fn what_speos_has_no_place_for_is_refused() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("a");
    let refused = |own: &BrdfTable| {
        interchange::export(own, Format::Speos, &Options::default(), &path).expect_err("refused").to_string()
    };
    let points = crate::support::analytic::points(vec![0.0], vec![0.0], &[0.0, 30.0], &[0.0, 180.0]);
    assert!(refused(&table(&Lambert, &points)).contains("the bins of a hemisphere needed"));
    let mut half = hemisphere(steps(30.0, 3), None, 6, 12);
    half.phi_r_edges_deg.truncate(7);
    let why = refused(&table(&Lambert, &half));
    assert!(why.contains("azimuths of the sensor over 180 degrees: 360 needed"), "{why}");
    let why = Format::Speos.codec().decode(b"", &Options::default()).err().expect("refused").to_string();
    assert!(why.contains("written, not read"), "{why}");
}
