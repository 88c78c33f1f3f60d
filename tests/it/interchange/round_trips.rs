//! Promise: what becomes of every kind of table in every format: it comes back exactly, or within what the directions of
//! the format allow, or is refused with the reason. `--nocapture` prints the matrix.

use gonio::campaign::SensorSide;
use gonio::instrument::klems::Basis;
use gonio::instrument::{Grid, GridKind};
use gonio::interchange::{self, Brdf, Format, Options, TwoSided};
use gonio::table::BrdfTable;

/// What is to become of a table.
#[derive(Clone, Copy)]
enum Fate {
    Exact,
    /// The read-back's L1 at most.
    Within(f64),
    /// A phrase of the reason.
    Refused(&'static str),
}

use Fate::{Exact, Refused, Within};

use crate::support::analytic::{Ggx, hemisphere, points, steps, table};

const ANISOTROPIC: Fate = Refused("MERL files have no azimuth of the half vector");
const ARM: Fate = Refused("an arm in one plane does not see the hemisphere");
const WAVELENGTHS: Fate = Refused("holds Y or R G B, the table has 4 wavelengths");
const GAPS: Fate = Refused("pairs of directions were not measured");

/// How far means over the table's bins may be off, where a format has a value every `step` degrees and is read linearly:
/// a straight line lies step^2/8 f'' off, and ln f of GGX with alpha 0.4 has, along the sensor's angle (half of which is
/// the half vector's), a second derivative of 1/alpha^2 = 6 at most.
fn linear(step_deg: f64) -> Fate {
    Within(step_deg.to_radians().powi(2) / 8.0 * 6.0)
}

/// The same of values constant in cells so wide: a quarter of the width, for a slope of ln f of 2.6 at most (at tan = alpha/
/// sqrt 3 of the half vector).
fn constant(width_deg: f64) -> Fate {
    Within(width_deg.to_radians() / 4.0 * 2.6)
}

const BOTH: Fate = Refused("--side reflection writes what comes back alone");
const THROUGH: Fate = Refused("has no place for light that has gone through");
const ONE: Fate = Refused("--side reflection or --side transmission");

/// By format: isotropic, brushed, arm, spectral, a scan with gaps, both sides, light that has gone through alone.
fn fates(format: Format) -> [Fate; 7] {
    let arm_of_ssdd = Refused("an arm with negative polar angles has no list of spherical angles");
    match format {
        Format::Npz | Format::Csv | Format::ExrParts | Format::Astm => [Exact; 7],
        Format::Npy => [Exact, Exact, Exact, Exact, GAPS, Exact, Exact],
        Format::Ssdd => [Exact, Exact, arm_of_ssdd, Exact, GAPS, Exact, Exact],
        Format::Pabopto => [Exact, Exact, Exact, WAVELENGTHS, Exact, Exact, Exact],
        Format::Merl => [Exact, ANISOTROPIC, ANISOTROPIC, WAVELENGTHS, GAPS, BOTH, THROUGH],
        // Its cells follow the lobe; 5 degrees of the sensor's angle for the table's own bins.
        Format::Rgl => [linear(5.0), linear(10.0), ARM, WAVELENGTHS, GAPS, BOTH, THROUGH],
        Format::Utia => [linear(15.0), linear(15.0), ARM, WAVELENGTHS, GAPS, BOTH, THROUGH],
        Format::Klems => {
            [constant(24.0), constant(24.0), ARM, WAVELENGTHS, GAPS, constant(24.0), constant(24.0)]
        }
        // Divided until the cells' steps make one to two per cent of the sum.
        Format::TensorTree => {
            [Within(0.02), Within(0.02), ARM, WAVELENGTHS, GAPS, Within(0.02), Within(0.02)]
        }
        Format::OpenMaterial => {
            let bare = Refused("OpenMATERIAL's rows have a wavelength");
            [bare, bare, bare, Exact, bare, BOTH, THROUGH]
        }
        Format::Bird => [Exact, Exact, Exact, Exact, Exact, BOTH, THROUGH],
        Format::Fred => {
            let turned = Refused("FRED's tables are isotropic");
            [Exact, turned, turned, WAVELENGTHS, Exact, BOTH, THROUGH]
        }
        Format::Speos => {
            let arm = Refused("the bins of a hemisphere needed");
            [Exact, Exact, arm, WAVELENGTHS, GAPS, BOTH, THROUGH]
        }
        Format::Zemax => [linear(5.0), linear(10.0), ARM, WAVELENGTHS, GAPS, ONE, linear(5.0)],
    }
}

fn kinds() -> [(&'static str, BrdfTable); 7] {
    let isotropic = table(&Ggx::new(0.5, 0.5), &hemisphere(steps(28.0, 4), None, 18, 36));
    let brushed = table(&Ggx::new(0.4, 0.6), &hemisphere(steps(48.0, 2), Some(steps(45.0, 8)), 9, 18));
    // What comes back, and the same below: what goes through, straight on.
    let below = isotropic.mirrored().expect("bins");
    let both = table(&TwoSided([of_ggx(), of_ggx()]), &isotropic.grid.clone().of_side(SensorSide::Both));
    let arm = Grid {
        kind: GridKind::Arm,
        theta_i_deg: steps(20.0, 4),
        phi_i_deg: vec![0.0],
        theta_r_deg: (-16..=16).map(|k| 5.0 * f64::from(k)).collect(),
        phi_r_deg: vec![180.0],
        aperture_deg: Some(0.0),
        ..Grid::default()
    };
    let mut spectral = table(&Ggx { tint: vec![0.2, 0.5, 0.9], ..Ggx::new(0.5, 0.5) }, &isotropic.grid);
    spectral.colours.push(spectral.colours[0].clone());
    for (colour, nm) in spectral.colours.iter_mut().zip([450.0, 550.0, 632.8, 700.0]) {
        colour.wavelength_nm = Some(nm);
    }
    let scan = points(steps(20.0, 4), vec![0.0], &steps(10.0, 8), &steps(30.0, 12));
    let mut gaps = table(&Ggx::new(0.5, 0.5), &scan);
    (0..gaps.hits.len()).filter(|entry| entry % 7 == 3).for_each(|entry| gaps.set_gap(entry));
    [
        ("isotropic", isotropic),
        ("brushed", brushed),
        ("arm", table(&Ggx::new(0.5, 0.5), &arm)),
        ("spectral", spectral),
        ("gaps", gaps),
        ("both", both),
        ("through", below),
    ]
}

fn of_ggx() -> Option<Box<dyn Brdf>> {
    Some(Box::new(Ggx::new(0.5, 0.5)))
}

/// Totals of all colours, and what was not measured.
fn content(table: &BrdfTable) -> (Vec<&[f32]>, usize) {
    (table.colours.iter().map(|colour| colour.total.as_slice()).collect(), table.gaps())
}

#[test]
fn every_kind_of_table_in_every_format() {
    let folder = tempfile::tempdir().expect("folder");
    // Klems patches are wider than these lobes, and four dimensions of cells many: what they lose is in their L1. A quarter of
    // the patches are 18 to 24 degrees wide; the full basis has its tests in `interchange_radiance`.
    let options = |format: Format| {
        let albedo_error = Some(if format == Format::Klems { 0.08 } else { 0.05 });
        Options { albedo_error, klems: Some(Basis::Quarter), ..Options::default() }
    };
    for (index, (kind, table)) in kinds().into_iter().enumerate() {
        for (name, format) in Format::ALL.map(|format| (format.name(), format)) {
            // Trees have their tests in `interchange_albedo` (rank 3), `interchange_radiance` and `through`, MERL's million cells in
            // `interchange_merl`, brushed samples in RGL files in `interchange_rgl`, in Klems matrices and Zemax files in `through`
            // and `interchange_text`, both halves in one file in `through`.
            if matches!(
                (kind, format),
                ("isotropic" | "brushed" | "both" | "through", Format::TensorTree)
                    | ("brushed" | "both", Format::Klems)
                    | ("brushed", Format::Rgl | Format::Zemax)
                    | ("isotropic", Format::Merl)
            ) {
                continue;
            }
            let path = folder.path().join(format!("{kind}.{name}"));
            let options = options(format);
            let written = interchange::export(&table, format, &options, &path);
            let case = format!("{kind} as {name}");
            match (fates(format)[index], written) {
                (Refused(phrase), written) => {
                    let why = written.expect_err(&case).to_string();
                    println!("{case}: refused, {phrase}");
                    assert!(why.contains(phrase), "{case}: {why}");
                }
                (Exact, written) => {
                    println!("{case}: exact");
                    let back = written.expect(&case).read_back.expect("light");
                    assert_eq!((back.l1, back.worst), (0.0, 0.0), "{case}");
                    // An array and a folder of scans have no axes or files of their own to be read by; Speos is only written.
                    if format.is_read() {
                        let found = interchange::import(&path, format, &options, None).expect(&case).0;
                        if format != Format::Ssdd && kind != "gaps" {
                            assert_eq!(content(&found), content(&table), "{case}");
                        }
                        assert_eq!(found.gaps(), table.gaps(), "{case}");
                        assert_eq!(found.is_spectral(), table.is_spectral(), "{case}");
                    }
                }
                (Within(limit), written) => {
                    let l1 = written.expect(&case).read_back.expect("light").l1;
                    println!("{case}: L1 {l1:.4}, limit {limit:.4}");
                    assert!(l1 > 0.0 && l1 <= limit, "{case}: {l1}");
                }
            }
        }
    }
}
