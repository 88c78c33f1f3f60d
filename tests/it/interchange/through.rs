//! Promise: light that has gone through goes out and comes back on its own side, at its own azimuth, by each format's own
//! convention; what a format cannot hold is refused, or left out where the user says so. (Radiance reads the files in
//! tests/interop.)

use std::f64::consts::{FRAC_1_PI, PI};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use gonio::instrument::klems::{Basis, FULL, middles, patches, patches_of_side};
use gonio::instrument::{Grid, GridKind, Region};
use gonio::interchange::radiance::sample_side::SampleSide;
use gonio::interchange::radiance::xml_writer::{Block, write};
use gonio::interchange::radiance::{klems, tensor_tree};
use gonio::interchange::text::{ssdd, zemax};
use gonio::interchange::{self, Brdf, Colour, Format, Imported, Options};
use gonio::sphere::direction_deg;
use gonio::table::BrdfTable;

use crate::support::analytic::{hemisphere, points, steps, table};

/// Smooth, and its own mirror image about no plane and in no exchange of sides: a turned azimuth shows.
struct Pane;

impl Brdf for Pane {
    fn colours(&self) -> usize {
        1
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let up = 0.05 * (1.0 + 0.3 * wo.x + 0.2 * wo.y + 0.2 * wi.x * wo.y);
        let down = 0.2 * (1.0 + 0.2 * wo.x - 0.3 * wo.y - 0.3 * wi.y * wo.x);
        [if wo.z < 0.0 { down } else { up }, 0.0, 0.0]
    }

    fn sides(&self) -> [bool; 2] {
        [true, true]
    }
}

/// The same with half of its slopes: a tree takes a sixteenth of the cells.
struct Faint;

impl Brdf for Faint {
    fn colours(&self) -> usize {
        1
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let even = if wo.z < 0.0 { 0.2 } else { 0.05 };
        [0.5 * (even + Pane.brdf(wi, wo)[0]), 0.0, 0.0]
    }

    fn sides(&self) -> [bool; 2] {
        [true, true]
    }
}

/// The same everywhere on each side.
struct Even(f64, f64);

impl Brdf for Even {
    fn colours(&self) -> usize {
        1
    }

    fn brdf(&self, _wi: DVec3, wo: DVec3) -> Colour {
        [if wo.z < 0.0 { self.1 } else { self.0 }; 3]
    }

    fn sides(&self) -> [bool; 2] {
        [true, true]
    }
}

/// Rows of 5 degrees above and below, as many columns.
fn both_sides(phi_i_deg: Option<Vec<f64>>) -> Grid {
    let above = hemisphere(steps(20.0, 5), phi_i_deg, 18, 24);
    let below = above.theta_r_edges_deg.iter().rev().skip(1).map(|edge| 180.0 - edge);
    Grid { theta_r_edges_deg: above.theta_r_edges_deg.iter().copied().chain(below).collect(), ..above }
}

/// Light from few directions: `Pane` is as smooth as the formats' interpolation is right for.
fn pane() -> BrdfTable {
    table(&Pane, &Grid { theta_i_deg: steps(30.0, 3), ..both_sides(Some(steps(45.0, 8))) })
}

fn file(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("file");
    std::fs::write(&path, text).expect("written");
    path
}

#[test]
fn both_sides_are_put_together() {
    let grid = points(steps(30.0, 3), vec![0.0, 90.0], &[10.0, 50.0, 100.0, 170.0], &steps(45.0, 8));
    let whole = table(&Pane, &grid);
    let [above, below] = [false, true].map(|below| whole.half(below).expect("a side"));
    assert_eq!(below.grid.points_deg[8], [10.0, 0.0], "170 degrees as the mirror shows it");
    assert_eq!(below.colours, whole.side(true).expect("a side").colours);
    assert_eq!(above.joined(&below.mirrored().expect("points")), Some(whole.clone()));
    let other = Grid { theta_i_deg: vec![1.0], ..grid };
    assert_eq!(above.joined(&table(&Pane, &other)), None, "another light");
    // A hemisphere's rows run from the pole above in a mirror, too.
    let whole = pane();
    let image = whole.mirrored().expect("bins");
    assert_eq!(image.mirrored().as_ref(), Some(&whole));
    assert_eq!(image.half(false), whole.half(true));
}

/// Formats that list the table's own directions.
#[test]
fn lists_come_back_exactly_on_both_sides() {
    let folder = tempfile::tempdir().expect("folder");
    for isotropic in [true, false] {
        let wanted = if isotropic { table(&Pane, &both_sides(None)) } else { pane() };
        for through in [None, Some(false), Some(true)] {
            let options = Options { through, ..Options::default() };
            let kept = through.map_or(Some(wanted.clone()), |below| wanted.side(below)).expect("there");
            for format in [Format::Npz, Format::Csv, Format::ExrParts, Format::Astm, Format::Ssdd] {
                let path = folder.path().join(format!("{isotropic}_{through:?}.{}", format.name()));
                let case = path.display();
                let written = interchange::export(&wanted, format, &options, &path).expect("written");
                assert_eq!(written.read_back.expect("light").worst, 0.0, "{case}");
                let (found, notes) = interchange::import(&path, format, &options, None).expect("read");
                assert!(notes.is_empty(), "{case}: {notes:?}");
                let sides = |grid: &Grid| (grid.looks_above(), grid.looks_below(), grid.is_isotropic());
                assert_eq!(sides(&found.grid), sides(&kept.grid), "{case}");
                // By angles: SSDD lists azimuths by their number.
                let wi = found.grid.wi(1);
                for (bin, region) in found.grid.regions(1).iter().enumerate() {
                    let value = f64::from(found.colours[0].total[found.grid.bins() + bin]);
                    let wanted = Pane.brdf(wi, region.middle())[0];
                    // Means next to the pole lie at two thirds of their 5 degrees, not half: 0.0145 of a slope of 0.36 at
                    // most; elsewhere (0.09^2 + 0.26^2)/24 of that.
                    assert!((value / wanted - 1.0).abs() < 6e-3, "{case}: {region:?} {value} {wanted}");
                }
            }
        }
    }
}

#[test]
fn texts_say_which_light_they_hold() {
    let folder = tempfile::tempdir().expect("folder");
    let own = table(&Pane, &Grid { theta_i_deg: vec![0.0], ..both_sides(Some(steps(45.0, 8))) });
    let text = |format: Format, through| {
        let path = folder.path().join(format!("{through:?}.{}", format.name()));
        interchange::export(&own, format, &Options { through, ..Options::default() }, &path)
            .expect("written");
        let path = if format == Format::Pabopto { path.join("stop_0000.txt") } else { path };
        std::fs::read_to_string(path).expect("text")
    };
    for (through, name) in [(None, "BSDF"), (Some(false), "BRDF"), (Some(true), "BTDF")] {
        assert!(text(Format::Astm, through).contains(&format!("MEAS_NAME {name}\n")));
    }
    // theta_s counts from the normal on the light's side: the last row, 177.5 degrees, in radians.
    assert!(text(Format::Astm, None).lines().last().expect("lines").contains(",3.097959422290,"));
    let blocks = |text: &str| ["brdf", "btdf"].map(|kind| text.contains(&format!("DATA_TYPE {kind}\n")));
    for (through, wanted) in [(None, [true, true]), (Some(false), [true, false]), (Some(true), [false, true])]
    {
        let text = text(Format::Ssdd, through);
        assert_eq!(blocks(&text), wanted);
        assert!(text.contains("\nPARAM2_LIST 2.5 7.5 "), "angles of the btdf are those of a brdf");
        assert_eq!(text.matches("VERSION").count(), 1);
    }
    assert!(text(Format::Zemax, Some(true)).contains("ScatterType  BTDF\n"));
    assert!(text(Format::Pabopto, None).lines().last().expect("lines").starts_with("177.5 "));
}

/// Formats of other directions, by their own readers: both sides at their own azimuths.
#[test]
fn resampled_formats_hold_what_goes_through() {
    let folder = tempfile::tempdir().expect("folder");
    // Two polar angles of the light are enough for what is linear in its direction.
    let grid = Grid { theta_i_deg: vec![0.0, 50.0], ..both_sides(Some(steps(45.0, 8))) };
    // Patches of the quarter basis are 45 degrees wide: half of that, times the slope of ln f, 0.5 along the sensor's azimuth
    // and 0.3 along the light's at most. Turned azimuths or exchanged sides are up to 100 % off. Half of the slopes for the
    // tree, of which that is 40 %.
    let wide = 0.8 * 22.5f64.to_radians();
    let cases: [(Format, &dyn Brdf, f64); 3] = [
        (Format::Klems, &Pane, wide),
        (Format::TensorTree, &Faint, 0.5 * wide),
        (Format::Zemax, &Pane, 0.02),
    ];
    for (format, brdf, limit) in cases {
        let own = table(brdf, &grid);
        let through = (format == Format::Zemax).then_some(true);
        let path = folder.path().join(format.name());
        let options = Options { through, klems: Some(Basis::Quarter), ..Options::default() };
        let written = interchange::export(&own, format, &options, &path).expect("written");
        let kept = if through.is_some() { own.side(true).expect("there") } else { own.clone() };
        let (found, _) =
            interchange::import(&path, format, &Options::default(), Some(&kept.grid)).expect("read");
        let (a, b) = (&found.colours[0].total, &kept.colours[0].total);
        let off = (0..a.len()).filter(|&entry| within_60_degrees(&kept.grid, entry));
        let off = off.map(|k| f64::from((a[k] - b[k]).abs() / b[k])).fold(0.0, f64::max);
        assert!(off < limit, "{}: {off}", format.name());
        let l1 = written.read_back.as_ref().expect("light").l1;
        assert!(l1 > 0.0 && l1 < limit, "{}: {l1}", format.name());
        let curves = [&written.albedo, &written.transmittance].map(|curve| curve.as_ref().map(|c| c.through));
        assert_eq!(curves, [through.is_none().then_some(false), Some(true)], "{}", format.name());
        assert!(written.transmittance.expect("a curve").worst < 0.01, "{}", format.name());
    }
}

/// Whether light and sensor are so near to the normal, on either side.
fn within_60_degrees(grid: &Grid, entry: usize) -> bool {
    let (incidence, bin) = (entry / grid.bins(), entry % grid.bins());
    let Region::Rectangle { theta: [low, high], .. } = grid.regions(incidence)[bin] else { return false };
    grid.wi(incidence).z > 0.499 && (0.5 * (low + high)).cos().abs() > 0.5
}

/// Radiance's frame, from its source: `Back` is light from +z; x and y of a patch of the light are those of -wi, of the
/// sensor's those of wo, on either side.
#[test]
fn the_four_blocks_of_a_matrix_are_read_by_their_names() {
    let basis = "<AngleBasis><AngleBasisName>B</AngleBasisName><AngleBasisBlock><nPhis>2</nPhis><ThetaBounds>\
        <LowerTheta>0</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";
    let block = |light, through, data: &str| Block {
        light,
        through,
        bases: "<ColumnAngleBasis>B</ColumnAngleBasis><RowAngleBasis>B</RowAngleBasis>".into(),
        wavelength: "Visible",
        data: data.into(),
    };
    let text = write(
        "Columns",
        basis,
        &[
            block(SampleSide::Back, false, "1, 2, 3, 4"),
            block(SampleSide::Back, true, "5, 6, 7, 8"),
            block(SampleSide::Front, true, "13, 14, 15, 16"),
            block(SampleSide::Front, false, "9, 10, 11, 12"),
        ],
    );
    for (side, first) in [(None, 1.0f32), (Some(SampleSide::Back), 1.0), (Some(SampleSide::Front), 9.0)] {
        let (found, _) = klems::read_side(text.as_bytes(), side).expect("sound");
        // Column 0: light that travels towards +x comes from -x.
        assert_eq!(found.grid.incidences_deg, [[45.0, 180.0], [45.0, 0.0]]);
        let sensor = [0.0, 90.0].map(|low| [[low, low + 90.0, -90.0, 90.0], [low, low + 90.0, 90.0, 270.0]]);
        assert_eq!(found.grid.patches_deg, sensor.concat());
        let rows = [0.0, 2.0, 4.0, 6.0, 1.0, 3.0, 5.0, 7.0].map(|more| first + more);
        assert_eq!(found.colours[0].total, rows);
    }
    // A file that lets light through from the back alone.
    let alone = write("Columns", basis, &[block(SampleSide::Front, true, "5, 6, 7, 8")]);
    let (found, notes) = klems::read_side(alone.as_bytes(), None).expect("sound");
    assert_eq!((found.grid.looks_above(), found.grid.looks_below()), (false, true));
    assert!(notes.concat().contains("light from the side -z"), "{notes:?}");
    let why = klems::read_side(alone.as_bytes(), Some(SampleSide::Back)).expect_err("not there").to_string();
    assert!(
        why.contains("`Reflection Back` or `Transmission Back`") && why.contains("Transmission Front"),
        "{why}"
    );
    let other = basis.replace("<nPhis>2", "<nPhis>4").replace(">B<", ">C<");
    let mixed = text.replacen("<ColumnAngleBasis>B", "<ColumnAngleBasis>C", 1);
    let mixed = mixed
        .replacen("1, 2, 3, 4", "1, 2, 3, 4, 1, 2, 3, 4", 1)
        .replace("<AngleBasis>", &format!("{other}<AngleBasis>"));
    let why = klems::read_side(mixed.as_bytes(), None).expect_err("two lights").to_string();
    assert!(why.contains("different bases of the light"), "{why}");
}

/// The squares of light that goes through are those of light that comes back: only z differs.
#[test]
fn a_tree_of_light_that_goes_through_is_read_below_the_horizon() {
    // Rank 4, two cells an axis: 1, 3 by the half of the light's y, times 1, 5 by that of the sensor's y.
    let cell = |k: usize| [1.0, 3.0][k >> 2 & 1] * [1.0, 5.0][k & 1];
    let data = format!("{{{}}}", (0..16).map(|k| format!(" {}", cell(k))).collect::<String>());
    let block = |through, data| Block {
        light: SampleSide::Back,
        through,
        bases: "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>".into(),
        wavelength: "Visible",
        data,
    };
    let text = write("TensorTree4", "", &[block(true, data.clone())]);
    let tree = tensor_tree::read(text.as_bytes()).expect("sound");
    assert_eq!(tree.sides(), [false, true]);
    let value = |tree: &tensor_tree::TensorTree, phi_i: f64, theta: f64, phi: f64| {
        tree.brdf(direction_deg(40.0, phi_i), direction_deg(theta, phi))[0]
    };
    // Light from +y travels towards -y, the lower half.
    assert_eq!(value(&tree, 90.0, 130.0, 90.0), 5.0);
    assert_eq!(value(&tree, 270.0, 130.0, 90.0), 15.0);
    assert_eq!(value(&tree, 270.0, 130.0, 270.0), 3.0);
    assert_eq!(value(&tree, 270.0, 50.0, 270.0), 0.0, "no light comes back");
    let text = write("TensorTree4", "", &[block(true, data), block(false, "{ 0.25 }".into())]);
    let tree = tensor_tree::read(text.as_bytes()).expect("sound");
    assert_eq!((value(&tree, 270.0, 50.0, 270.0), value(&tree, 270.0, 130.0, 270.0)), (0.25, 3.0));
}

/// Even surfaces of other shares from each side: four blocks, each with its own.
#[test]
fn tables_of_both_lights_make_four_blocks() {
    let folder = tempfile::tempdir().expect("folder");
    let grid = Grid {
        kind: GridKind::Patches,
        incidences_deg: middles(&patches(&FULL)),
        patches_deg: patches_of_side(&FULL, gonio::campaign::SensorSide::Both),
        ..Grid::default()
    };
    let of = |reflected: f64, through: f64| table(&Even(reflected * FRAC_1_PI, through * FRAC_1_PI), &grid);
    let (front, back) = (of(0.1, 0.6), of(0.3, 0.5));
    let path = folder.path().join("four.xml");
    let options = Options { back: Some(Arc::new(back)), ..Options::default() };
    let written = interchange::export(&front, Format::Klems, &options, &path).expect("written");
    // Nine digits are written, f32 has seven.
    let exact = |read_back: &Option<interchange::ReadBack>| read_back.as_ref().expect("light").worst < 1e-6;
    assert!(exact(&written.read_back) && exact(&written.back.expect("a back").0));
    assert!(written.notes.concat().contains("as they are"), "{:?}", written.notes);
    let text = std::fs::read_to_string(&path).expect("text");
    for name in ["Reflection Back", "Transmission Back", "Reflection Front", "Transmission Front"] {
        assert!(text.contains(&format!("<WavelengthDataDirection>{name}</WavelengthDataDirection>")));
    }
    assert_eq!(text.matches("<ScatteringDataType>BTDF<").count(), 2);
    assert!(text.contains("no factor n^2; Back is light from +z"));
    for (side, shares) in [(SampleSide::Back, [0.1, 0.6]), (SampleSide::Front, [0.3, 0.5])] {
        let options = Options { side: Some(side), ..Options::default() };
        let (found, _) = interchange::import(&path, Format::Klems, &options, None).expect("read");
        assert_eq!(found.grid, grid);
        let (sizes, values) = (found.grid.sizes(7), &found.colours[0].total[7 * 290..]);
        for (half, share) in shares.into_iter().enumerate() {
            let flux: f64 =
                (145 * half..145 * (half + 1)).map(|bin| sizes[bin] * f64::from(values[bin])).sum();
            assert!((flux - share).abs() < 1e-6, "{side:?} {half}: {flux}");
        }
    }
    let why = interchange::export(&front, Format::Npz, &options, &path).expect_err("one table").to_string();
    assert!(why.contains("klems and tensor_tree take one under light from the back"), "{why}");
}

/// Zemax: about the direction of direct transmission, azimuth 0 towards the normal.
#[test]
fn a_btdf_of_zemax_stands_about_the_straight_direction() {
    let text = "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BTDF\n\
        SampleRotation 1\n0\nAngleOfIncidence 1\n40\nScatterAzimuth 2\n0 180\nScatterRadial 2\n0 90\n\nMonochrome\n\
        DataBegin\nTIS 0.9\n1 10\n1 19\nDataEnd\n";
    assert!(zemax::read(text.as_bytes()).expect("sound").through);
    let folder = tempfile::tempdir().expect("folder");
    let path = file(folder.path(), text);
    let wi = [[40.0, 0.0], [40.0, 70.0]];
    // Straight on, 20 degrees towards the normal on that side, and 20 away from it.
    let seen = [[140.0, 180.0], [160.0, 180.0], [120.0, 180.0]];
    let like = Grid {
        kind: GridKind::Points,
        incidences_deg: wi.to_vec(),
        phi_r_relative: true,
        points_deg: seen.to_vec(),
        ..Grid::default()
    };
    let (found, _) =
        interchange::import(&path, Format::Zemax, &Options::default(), Some(&like)).expect("read");
    for (value, wanted) in found.colours[0].total.iter().zip([1.0, 3.0, 5.0].repeat(2)) {
        // Straight lines 1 + 9 r/90 and 1 + 18 r/90; f32.
        assert!((value - wanted).abs() < 1e-5, "{value} {wanted}");
    }
    let (own, _) = interchange::import(&path, Format::Zemax, &Options::default(), None).expect("read");
    assert_eq!((own.grid.looks_above(), own.grid.looks_below()), (false, true));
    let above = Grid { points_deg: vec![[20.0, 180.0]], ..like };
    let why = interchange::import(&path, Format::Zemax, &Options::default(), Some(&above));
    assert!(why.expect_err("no reflection").to_string().contains("nothing of light that comes back"));
}

/// The specification's own material, and a block whose lights are others.
#[test]
fn blocks_of_different_angles_become_one_function() {
    let brdf = "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n\
        PARAM0_LIST 0 60\nPARAM2_LIST 0 90\nPARAM3_LIST 0 45 90 135 180 225 270 315\nDATA ascii\n";
    let btdf = "DATA_TYPE btdf\nCOLOR_MODEL monochrome\nPARAM_TYPE specular_coordinate_system\n\
        REDUCTION_TYPE bilateral_symmetry\nPARAM0_LIST 0 90\nPARAM2_LIST 0 180\nPARAM3_LIST 0 180\nDATA ascii\n";
    let text = format!("{brdf}{}{btdf}{}", "0.1\n".repeat(32), "0.2\n".repeat(8));
    let (imported, notes) = ssdd::read_with_notes(text.as_bytes()).expect("sound");
    assert!(notes.is_empty(), "{notes:?}");
    let Imported::Function { parts, grid, .. } = imported else { panic!("a table") };
    assert_eq!((parts[0].sides(), grid.looks_below()), ([true, true], true));
    // f32 decimals of 0.1 and 0.2.
    let value = |theta| parts[0].brdf(direction_deg(20.0, 0.0), direction_deg(theta, 130.0))[0];
    assert!((value(50.0) - 0.1).abs() < 1e-6 && (value(130.0) - 0.2).abs() < 1e-6);
    let twice = text.replace("DATA_TYPE btdf", "DATA_TYPE brdf");
    let why = ssdd::read_with_notes(twice.as_bytes()).err().expect("refused").to_string();
    assert!(why.contains("two data blocks `brdf`"), "{why}");
    let coloured =
        text.replace("btdf\nCOLOR_MODEL monochrome", "btdf\nCOLOR_MODEL rgb").replace("0.2\n", "1 1 1\n");
    let why = ssdd::read_with_notes(coloured.as_bytes()).err().expect("refused").to_string();
    assert!(why.contains("different colours"), "{why}");
}

#[test]
fn what_a_format_cannot_hold_is_left_out_where_the_user_says_so() {
    let folder = tempfile::tempdir().expect("folder");
    let both = table(&Even(0.3 * FRAC_1_PI, 0.6 * FRAC_1_PI), &both_sides(None));
    let [alone, through] = [false, true].map(|below| both.side(below).expect("there"));
    let export = |table: &BrdfTable, format: Format, through: Option<bool>| {
        let path = folder.path().join("out");
        let options = Options { through, albedo_error: Some(0.05), ..Options::default() };
        interchange::export(table, format, &options, &path).map_err(|why| why.to_string())
    };
    for format in [Format::Merl, Format::Rgl, Format::Utia] {
        let why = export(&both, format, None).expect_err("both");
        assert!(why.contains("no place for light that has gone through the surface; npz, npy"), "{why}");
        assert!(
            why.ends_with("--side reflection writes what comes back alone") && !why.contains('\n'),
            "{why}"
        );
        assert!(!why.contains(&format!(", {},", format.name())), "{why}");
        for (table, side) in [(&through, None), (&both, Some(true)), (&through, Some(true))] {
            let why = export(table, format, side).expect_err("no place");
            assert!(why.contains("no place for light") && !why.contains("--side reflection"), "{why}");
        }
        // MERL's million cells and UTIA's 80,000 pairs would show no more.
        if format == Format::Rgl {
            let [asked, only] =
                [(&both, Some(false)), (&alone, None)].map(|(table, side)| export(table, format, side));
            assert_eq!(asked.expect("written").read_back, only.expect("written").read_back);
        }
    }
    let why = export(&both, Format::Zemax, None).expect_err("one of them");
    assert!(why.contains("--side reflection or --side transmission"), "{why}");
    for (table, side, phrase) in
        [(&through, false, "no light that comes back"), (&alone, true, "no light that has gone through")]
    {
        let why = export(table, Format::Csv, Some(side)).expect_err("not there");
        assert!(why.contains("--side: the table holds") && why.contains(phrase), "{why}");
    }
    // A tree of light that has gone through alone: its one block is read on that side, every value the table's to the five
    // digits of the text.
    let tree = folder.path().join("through.xml");
    interchange::export(&through, Format::TensorTree, &Options::default(), &tree).expect("written");
    let (found, _) = interchange::import(&tree, Format::TensorTree, &Options::default(), Some(&through.grid))
        .expect("read");
    let wanted = 0.6 * FRAC_1_PI as f32;
    assert!(found.colours[0].total.iter().all(|value| (value / wanted - 1.0).abs() < 5e-5));
    // What comes back and what goes through may not be more than all light, each by itself near enough.
    let bright = table(&Even(0.6 * FRAC_1_PI, 0.6 * FRAC_1_PI), &both.grid);
    let sum = export(&bright, Format::TensorTree, None).expect("no more than the table's own").albedo;
    assert!((sum.expect("a curve").points[0].file[0] - 0.6).abs() < 0.01, "0.6 of 2 pi {PI}");
}
