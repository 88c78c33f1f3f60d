//! Promise: lists of pairs of directions (CSV, ASTM, SSDD, NPZ) come back at the angles and with the symmetry that was
//! written; one direction under two names must have one value.

use std::collections::HashMap;

use gonio::instrument::{Grid, GridKind};
use gonio::interchange;
use gonio::interchange::numpy::npz;
use gonio::interchange::text::{astm, csv, ssdd};
use gonio::interchange::{Format, Options, merl};
use gonio::table::BrdfTable;

use crate::support::analytic::{Ggx, hemisphere, points, steps, table};

/// The formats that list angles.
const LISTS: [Format; 4] = [Format::Csv, Format::Astm, Format::Ssdd, Format::Npz];

/// Written, held to the table by the exporter, and read.
fn through(table: &BrdfTable, format: Format, options: &Options) -> Result<BrdfTable, String> {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("file");
    let export = interchange::export(table, format, &Options::default(), &path).map_err(|e| e.to_string())?;
    // Totals are f32 and their shortest decimals.
    assert!(export.read_back.is_none_or(|back| back.worst == 0.0), "{format:?}");
    interchange::import(&path, format, options, None).map(|(table, _)| table).map_err(|e| e.to_string())
}

/// (theta_r, phi_r) of the bins with their sign and their azimuth as the grid has it.
fn bins(grid: &Grid) -> Vec<[f64; 2]> {
    let middles = |edges: &[f64]| edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect::<Vec<_>>();
    let over = |rows: &[f64], columns: &[f64]| {
        rows.iter().flat_map(|&t| columns.iter().map(move |&p| [t, p])).collect::<Vec<_>>()
    };
    match grid.kind {
        GridKind::Hemisphere => over(&middles(&grid.theta_r_edges_deg), &middles(&grid.phi_r_edges_deg)),
        GridKind::Arm => over(&grid.theta_r_deg, &grid.phi_r_deg),
        _ => grid.points_deg.clone(),
    }
}

/// Values by angles in millionths of a degree: absolute azimuths in [0, 360), polar angles not negative.
fn by_angles(table: &BrdfTable) -> HashMap<[i64; 4], Vec<u32>> {
    let (grid, bins) = (&table.grid, bins(&table.grid));
    let mut all = HashMap::new();
    for incidence in 0..grid.incidences() {
        let (theta_i, phi_i) = grid.incidence_deg(incidence);
        for (bin, &[theta, phi]) in bins.iter().enumerate() {
            let phi =
                phi + if grid.phi_r_relative { phi_i } else { 0.0 } + if theta < 0.0 { 180.0 } else { 0.0 };
            let turned = |phi: f64| (phi * 1e6).round() as i64 % 360_000_000;
            let whole = |phi: f64| (turned(phi) + 360_000_000) % 360_000_000;
            let polar = |theta: f64| (theta.abs() * 1e6).round() as i64;
            let at = incidence * bins.len() + bin;
            let values = table.colours.iter().map(|colour| colour.total[at].to_bits()).collect();
            assert!(all.insert([polar(theta_i), whole(phi_i), polar(theta), whole(phi)], values).is_none());
        }
    }
    all
}

fn brushed(grid: &Grid) -> BrdfTable {
    table(&Ggx::new(0.1, 0.3), grid)
}

#[test]
fn a_single_azimuth_that_is_not_0_stays_where_it_was() {
    let wanted = brushed(&hemisphere(vec![30.0, 60.0], Some(vec![30.0]), 9, 36));
    for format in LISTS {
        let found = through(&wanted, format, &Options::default()).expect("comes back");
        assert!(by_angles(&found) == by_angles(&wanted), "{format:?}");
        assert!(!found.grid.is_isotropic() && merl::check(&found.grid).is_err(), "{format:?}");
    }
}

#[test]
fn an_isotropic_table_comes_back_as_one() {
    let grid = Grid { phi_i_deg: vec![20.0], ..hemisphere(vec![30.0, 60.0], None, 9, 36) };
    for grid in [hemisphere(vec![30.0, 60.0], None, 9, 36), grid] {
        let wanted = table(&Ggx::new(0.3, 0.3), &grid);
        for format in LISTS {
            let found = through(&wanted, format, &Options::default()).expect("comes back");
            assert!(found.grid.is_isotropic() && merl::check(&found.grid).is_ok(), "{format:?}");
            // SSDD has no azimuth of the light then.
            if format != Format::Ssdd || grid.phi_i_deg == [0.0] {
                assert!(by_angles(&found) == by_angles(&wanted), "{format:?}");
            }
        }
    }
}

#[test]
fn the_users_word_makes_a_single_azimuth_isotropic() {
    let word = Options { isotropic: true, ..Options::default() };
    let wanted = brushed(&hemisphere(vec![30.0, 60.0], Some(vec![30.0]), 9, 36));
    let several = brushed(&hemisphere(vec![30.0], Some(vec![30.0, 60.0]), 3, 4));
    for format in LISTS {
        let found = through(&wanted, format, &word).expect("comes back");
        assert!(found.grid.is_isotropic() && by_angles(&found) == by_angles(&wanted), "{format:?}");
        let why = through(&several, format, &word).expect_err("refused");
        assert!(why.contains("several azimuths"), "{why}");
    }
}

#[test]
fn azimuths_that_count_from_the_light_come_back() {
    let relative = Grid { phi_r_relative: true, ..hemisphere(vec![30.0], Some(vec![0.0, 20.0, 45.0]), 3, 8) };
    let wanted = brushed(&relative);
    for format in [Format::Csv, Format::Astm, Format::Npz] {
        let found = through(&wanted, format, &Options::default()).expect("comes back");
        assert!(found.grid.phi_r_relative && by_angles(&found) == by_angles(&wanted), "{format:?}");
    }
    let why = through(&wanted, Format::Ssdd, &Options::default()).expect_err("absolute");
    assert!(why.contains("absolute"), "{why}");
}

fn arm(phi_i_deg: Vec<f64>, theta_r_deg: Vec<f64>, phi_r_deg: Vec<f64>) -> Grid {
    let aperture_deg = Some(5.0);
    let theta_i_deg = vec![0.0, 30.0];
    Grid {
        kind: GridKind::Arm,
        theta_i_deg,
        phi_i_deg,
        theta_r_deg,
        phi_r_deg,
        aperture_deg,
        ..Grid::default()
    }
}

#[test]
fn an_arm_at_the_pole_keeps_its_azimuths() {
    // At the pole all azimuths are one direction, but a measured arm has other noise at each: values differ.
    let mut wanted = brushed(&arm(steps(90.0, 2), vec![0.0, 30.0, 60.0], steps(90.0, 4)));
    wanted.colours[0].total.iter_mut().zip(1u8..).for_each(|(value, k)| *value *= 1.0 + 0.001 * f32::from(k));
    for format in LISTS {
        let found = through(&wanted, format, &Options::default()).expect("comes back");
        assert!(by_angles(&found) == by_angles(&wanted), "{format:?}");
    }
}

#[test]
fn negative_azimuths_and_polar_angles_come_back() {
    let azimuths = || vec![-90.0, -45.0, 0.0, 45.0, 90.0];
    let centred = Grid {
        phi_r_edges_deg: steps(20.0, 19).iter().map(|phi| phi - 10.0).collect(),
        ..hemisphere(vec![30.0], Some(azimuths()), 9, 18)
    };
    for grid in [centred, arm(azimuths(), vec![10.0, 40.0], vec![-120.0, 0.0, 120.0])] {
        let wanted = brushed(&grid);
        for format in LISTS {
            let found = through(&wanted, format, &Options::default()).expect("comes back");
            assert!(by_angles(&found) == by_angles(&wanted), "{format:?}");
        }
    }
    let wanted = brushed(&arm(vec![0.0], vec![-40.0, -10.0, 10.0, 40.0], vec![0.0, 60.0]));
    for format in [Format::Csv, Format::Astm, Format::Npz] {
        let found = through(&wanted, format, &Options::default()).expect("comes back");
        assert!(by_angles(&found) == by_angles(&wanted), "{format:?}");
    }
    assert!(through(&wanted, Format::Ssdd, &Options::default()).expect_err("refused").contains("negative"));
}

#[test]
fn a_negative_polar_angle_is_the_far_side_of_its_plane() {
    let text = include_bytes!("../../data/astm_inplane_negative.astm");
    let found = astm::read(text).expect("readable");
    // The file's lines: 3 incidences, -80 to 80 degrees in steps of 5; the light at phi = 0.
    assert_eq!((found.grid.theta_i_deg.len(), found.grid.bins()), (3, 33));
    assert_eq!((found.grid.points_deg[0], found.grid.points_deg[17]), ([80.0, 180.0], [5.0, 0.0]));
    assert_eq!(found.colours[0].total[0], 0.127_752_93);
    let csv_text = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n30,0,-30,0,5\n30,0,30,0,1\n";
    let found = csv::read(csv_text.as_bytes()).expect("readable");
    assert_eq!(found.grid.points_deg, [[30.0, 180.0], [30.0, 0.0]]);
    assert_eq!(found.colours[0].total, [5.0, 1.0]);
}

#[test]
fn one_direction_under_two_names_has_one_value() {
    let csv_head = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,Y\n";
    // 0 and 360, -180 and 180, the far side and the azimuth half a turn on.
    for [a, b] in [["10,0", "10,360"], ["10,-180", "10,180"], ["-10,0", "10,180"], ["10,20", "10,20"]] {
        let lines = |value: &str| format!("{csv_head}30,0,{a},1.25\n30,0,{b},{value}\n30,0,50,0,2\n");
        let found = csv::read(lines("1.25").as_bytes()).expect("one value");
        assert_eq!(found.colours[0].total, [1.25, 2.0]);
        let why = csv::read(lines("1.5").as_bytes()).expect_err("two values").to_string();
        assert!(why.contains("lines 2 and 3") && why.contains("1.25") && why.contains("1.5"), "{why}");
    }
    let astm_text = |value: &str| {
        format!("VARS theta_i,phi_i,theta_s,phi_s,Y\n0.1,0,0.2,0,1.25\n0.1,0,0.2,6.283185307179586,{value}\n")
    };
    assert_eq!(astm::read(astm_text("1.25").as_bytes()).expect("one value").colours[0].total, [1.25]);
    assert!(
        astm::read(astm_text("1.5").as_bytes())
            .expect_err("two values")
            .to_string()
            .contains("lines 2 and 3")
    );
}

#[test]
fn an_equal_seam_is_dropped_and_an_unequal_one_refused() {
    let text = include_str!("../../data/ssdd_0_and_360.ssdd");
    let found = ssdd::read(text.as_bytes()).expect("an equal seam");
    assert_eq!((found.grid.incidences(), found.grid.bins()), (3, 9 * 36));
    assert_eq!((found.grid.points_deg[35], found.grid.points_deg[36]), ([0.0, 350.0], [10.0, 0.0]));
    // The file's first line: theta_i 0, theta_r 0, phi_r 0.
    assert_eq!(found.colours[0].total[0], 0.884_194_14);
    // The last line is theta_i 60, theta_r 80, phi_r 360.
    let (head, last) = text.trim_end().rsplit_once('\n').expect("lines");
    let wrong = ssdd::read(format!("{head}\n0.75\n").as_bytes()).expect_err("an unequal seam").to_string();
    assert!(wrong.contains("0.75") && wrong.contains(&last[..6]) && wrong.contains("360"), "{wrong}");
    // The light's azimuths likewise: PARAM1 0 360, values by stop alone.
    let light = |last: &str| {
        format!(
            "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\nPARAM0_LIST 0 30\n\
            PARAM1_LIST -180 180\nPARAM2_LIST 10\nPARAM3_LIST 0\nDATA ascii\n1\n2\n1\n{last}\n"
        )
    };
    let found = ssdd::read(light("2").as_bytes()).expect("an equal seam");
    assert_eq!((found.grid.phi_i_deg, found.colours[0].total.as_slice()), (vec![-180.0], &[1.0, 2.0][..]));
    assert!(ssdd::read(light("3").as_bytes()).expect_err("unequal").to_string().contains("with 2 and 3"));
}

#[test]
fn a_seam_of_an_npz_is_dropped_too() {
    // Axes alone, as another program writes them.
    let table = brushed(&hemisphere(vec![30.0], Some(vec![0.0, 180.0, 360.0]), 2, 3));
    let foreign = |table: &BrdfTable| {
        let mut bytes = Vec::new();
        npz::write(table, &mut bytes).expect("written");
        let mut zip = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("a zip");
        let mut out = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        for name in ["brdf", "theta_i_deg", "phi_i_deg", "theta_r_edges_deg", "phi_r_edges_deg"] {
            out.raw_copy_file(zip.by_name(&format!("{name}.npy")).expect("there")).expect("copied");
        }
        out.finish().expect("finished").into_inner()
    };
    let found = npz::read(&foreign(&table)).expect("an equal seam");
    assert_eq!((found.grid.phi_i_deg.as_slice(), found.grid.phi_r_relative), (&[0.0, 180.0][..], false));
    assert_eq!(found.colours[0].total, table.colours[0].total[..12]);
    let mut wrong = table.clone();
    wrong.colours[0].total[17] = 7.5;
    assert!(npz::read(&foreign(&wrong)).expect_err("unequal").to_string().contains("7.5"));
}

#[test]
fn ssdd_comments_are_passed_over() {
    let plain = ssdd::read(include_bytes!("../../data/ssdd_0_and_360.ssdd")).expect("readable");
    let found = ssdd::read(include_bytes!("../../data/ssdd_comments.ssdd")).expect("readable");
    assert!(found == plain);
    let text = "VERSION 0.2 # first\n#\nDATA_TYPE brdf\n# of a lab\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n\
        PARAM0_LIST 0\nPARAM2_LIST 0 # pole\nPARAM3_LIST 0\nNAME paint#3\nDATA ascii\n0.3125 # 5/16\n";
    assert_eq!(ssdd::read(text.as_bytes()).expect("readable").colours[0].total, [0.3125]);
}

#[test]
fn a_table_of_points_comes_back_from_every_list() {
    let wanted = brushed(&points(vec![10.0, 40.0], vec![0.0, 15.0], &[0.0, 30.0], &[0.0, 90.0, 200.5]));
    for format in LISTS {
        assert!(
            by_angles(&through(&wanted, format, &Options::default()).expect("comes back"))
                == by_angles(&wanted)
        );
    }
}

const SSDD: &str = "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n\
    PARAM0_LIST 0 30\nPARAM2_LIST 10\nPARAM3_LIST 0 90 180\nDATA ascii\n1\n2\n3\n4\n5\n6\n";

#[test]
fn ssdd_half_a_turn_is_mirrored_at_the_plane_of_incidence() {
    let reduced = SSDD.replace("PARAM0", "REDUCTION_TYPE bilateral_symmetry\nPARAM0");
    let found = ssdd::read(reduced.as_bytes()).expect("readable");
    assert_eq!(found.grid.points_deg, [[10.0, 0.0], [10.0, 90.0], [10.0, 180.0], [10.0, 270.0]]);
    // theta_i runs fastest, phi_o slowest: 90 and 270 have 3 under the first light, 4 under the second.
    assert_eq!(found.colours[0].total, [1.0, 3.0, 5.0, 3.0, 2.0, 4.0, 6.0, 4.0]);
    let turned = ssdd::read(reduced.replace("PARAM2", "PARAM1_LIST 30\nPARAM2").as_bytes());
    assert!(turned.expect_err("no plane").to_string().contains("bilateral_symmetry"));
    assert!(ssdd::read(reduced.replace("90 180", "90 270").as_bytes()).is_err());
}

#[test]
fn ssdd_in_binary_is_little_endian_f32() {
    let wanted = ssdd::read(SSDD.as_bytes()).expect("readable");
    let mut bytes = SSDD.split("ascii").next().expect("there").as_bytes().to_vec();
    bytes.extend(b"binary\n");
    (1..=6u8).for_each(|k| bytes.extend(f32::from(k).to_le_bytes()));
    assert!(ssdd::read(&bytes).expect("readable") == wanted);
    assert!(ssdd::read(&bytes[..bytes.len() - 1]).expect_err("cut").to_string().contains("6 values"));
}

#[test]
fn ssdd_colours_go_by_the_model() {
    let of = |model: &str, values: &str| {
        format!(
            "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL {model}\nPARAM_TYPE spherical_coordinate_system\nPARAM0_LIST 0\n\
            PARAM2_LIST 0\nPARAM3_LIST 0\nDATA ascii\n{values}\n"
        )
    };
    // Red of IEC 61966-2-1 is X 0.4124, Y 0.2126, Z 0.0193.
    let red = ssdd::read(of("xyz", "0.4124 0.2126 0.0193").as_bytes()).expect("readable");
    for (colour, wanted) in red.colours.iter().zip([1.0, 0.0, 0.0]) {
        // f32 through a matrix of condition number below 5.
        assert!((colour.total[0] - wanted).abs() < 10.0 * f32::EPSILON);
    }
    let spectrum =
        ssdd::read(of("spectrum\nWAVELENGTH_LIST 450 550", "0.25 0.5").as_bytes()).expect("readable");
    let found: Vec<_> = spectrum.colours.iter().map(|c| (c.wavelength_nm, c.total[0])).collect();
    assert_eq!(found, [(Some(450.0), 0.25), (Some(550.0), 0.5)]);
    assert!(
        ssdd::read(of("spectrum", "1").as_bytes())
            .expect_err("no list")
            .to_string()
            .contains("WAVELENGTH_LIST")
    );
    assert!(ssdd::read(of("lab", "1 2 3").as_bytes()).expect_err("unknown").to_string().contains("xyz"));
}
