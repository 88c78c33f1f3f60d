//! `gonio export`: a table in another program's format.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use serde_json::{Value, json};

use super::streams::Place;
use super::table_file::{self, Opened};
use super::text::layout::wrapped;
use super::text::output::{Output, to_json, warn};
use super::text::progress::Stage;
use crate::error::{Error, Result};
use crate::files::{self, STANDARD};
use crate::instrument::GridKind;
use crate::instrument::klems::Basis;
use crate::interchange::merl::Sampling;
use crate::interchange::{self, AlbedoCurve, Export, Format, Options, ReadBack};
use crate::job::paths::already_exists;
use crate::table::TableRows;

/// Write a table in another program's format, and say how far the file is from the table
#[derive(Args)]
#[command(
    after_help = "Formats: npz npy csv merl rgl utia exr_parts klems tensor_tree zemax astm ssdd pabopto openmaterial\n\
    bird fred speos\n\n\
    Example: gonio export out/quickstart/quickstart.exr --to rgl -o quickstart.bsdf"
)]
pub struct Arguments {
    /// The table
    table: PathBuf,
    /// One of the formats below; left out: by FILE's name
    #[arg(long, value_name = "FORMAT")]
    to: Option<String>,
    /// The file, - for stdout (pabopto: a folder; utia: or .exr)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// MERL: values at the cells' centres, for nearest-cell readers
    #[arg(long)]
    merl_centre: bool,
    /// RGL: spectral, wavelengths of B, G, R: 465,532,630
    #[arg(long, value_name = "NM", value_delimiter = ',')]
    wavelengths_nm: Vec<f64>,
    /// Klems: 145, 73 or 41 patches (else the table's own, or full)
    #[arg(long, value_name = "full|half|quarter")]
    klems: Option<Basis>,
    /// Of a table that holds both, the light that is written
    #[arg(long, value_name = "reflection|transmission", value_parser = through)]
    side: Option<bool>,
    /// Klems, tensor tree: the table under light from the back
    #[arg(long, value_name = "TABLE.exr")]
    back: Option<PathBuf>,
    /// How far the file's albedo may be off, instead of 1 %
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    allow_albedo_error: Option<f64>,
    /// Replace the file if it is there
    #[arg(long)]
    force: bool,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> Result<u8> {
    let format = match &arguments.to {
        Some(name) => format_of("--to", name)?,
        None => only("--to", &arguments.output, &Format::of_name(&arguments.output))?,
    };
    if format == Format::Pabopto && arguments.output == Path::new(STANDARD) {
        return Err(Error::Usage("-o -: pabopto is a folder of files; name it".into()));
    }
    let place = Place::of(&arguments.output, arguments.json)?;
    let output = place.path();
    if arguments.klems.is_some() && format != Format::Klems {
        return Err(Error::Usage(format!("--klems chooses a basis of klems, not of {}", format.name())));
    }
    let options = options_of(arguments.merl_centre, &arguments.wavelengths_nm);
    let albedo_error = arguments.allow_albedo_error.map(|percent| 0.01 * percent);
    check_output(&arguments.table, output, arguments.force)?;
    let back = match &arguments.back {
        Some(path) => {
            check_output(path, output, arguments.force)?;
            Some(Arc::new(table_file::load(path)?))
        }
        None => None,
    };
    let (klems, through) = (arguments.klems, arguments.side);
    let options = Options { klems, through, back, albedo_error, ..options };
    let stage = Stage::begin("writing the file, and reading it back");
    let export = match table_file::open_as_stored(&arguments.table, TableRows::row_bytes)? {
        Opened::Whole(table) => {
            let alone = !format.codec().traits().more_than_totals && table.gaps() == 0;
            let table = if alone { table.totals_alone() } else { *table };
            interchange::export_to(&table, format, &options, output)?
        }
        Opened::Rows(mut rows)
            if format.codec().by_bands().is_some()
                && rows.grid().kind != GridKind::HalfDifference
                && options.through.is_none() =>
        {
            interchange::export_rows(&mut rows, format, output, table_file::band_bytes())?
        }
        Opened::Rows(rows) => return Err(table_file::too_large(&rows)),
    };
    drop(stage);
    for note in &export.notes {
        warn(format_args!("{}: {note}", arguments.output.display()));
    }
    let mut out = Output::default();
    if arguments.json {
        let document = json!({
            "file": arguments.output.display().to_string(),
            "format": format.name(),
            "convention": export.convention,
            "notes": export.notes,
            "read_back": to_json(&export.read_back)?,
            "albedo": to_json(&export.albedo)?,
            "transmittance": to_json(&export.transmittance)?,
            "back": match &export.back {
                Some((read_back, albedo, transmittance)) => json!({
                    "read_back": to_json(read_back)?,
                    "albedo": to_json(albedo)?,
                    "transmittance": to_json(transmittance)?,
                }),
                None => Value::Null,
            },
        });
        out.json(&document)?;
    } else {
        out.lines(lines(format, &arguments.output, &export))?;
    }
    place.done().map(|()| 0)
}

/// Whether light that has gone through is meant.
fn through(word: &str) -> std::result::Result<bool, String> {
    match word {
        "reflection" => Ok(false),
        "transmission" => Ok(true),
        _ => Err("reflection or transmission needed".into()),
    }
}

/// A share in percent, 0 to 100.
fn percent(word: &str) -> std::result::Result<f64, String> {
    let known = word.parse::<f64>().ok().filter(|percent| (0.0..=100.0).contains(percent));
    known.ok_or_else(|| "a number from 0 to 100 needed".into())
}

/// What the options say about the file.
pub fn options_of(merl_centre: bool, wavelengths_nm: &[f64]) -> Options {
    let merl_sampling = if merl_centre { Sampling::Centre } else { Sampling::Node };
    Options { merl_sampling, wavelengths_nm: wavelengths_nm.to_vec(), ..Options::default() }
}

/// A format by its name on the command line.
pub fn format_of(option: &str, name: &str) -> Result<Format> {
    name.parse().map_err(|why: String| Error::Usage(format!("{option} {name}: {why}")))
}

/// The one format that a file's name leaves possible.
pub fn only(option: &str, file: &Path, possible: &[Format]) -> Result<Format> {
    match possible {
        [format] => Ok(*format),
        [] => Err(Error::Usage(format!(
            "{}: the name does not say which format; {option} {}",
            file.display(),
            Format::ALL.map(Format::name).join("|")
        ))),
        several => {
            let names: Vec<&str> = several.iter().map(|format| format.name()).collect();
            Err(Error::Usage(format!(
                "{}: {option} {}?",
                file.display(),
                names.join(&format!(" or {option} "))
            )))
        }
    }
}

/// Refuses to write over what is read, and over what is there.
pub fn check_output(input: &Path, output: &Path, force: bool) -> Result<()> {
    let same =
        |a: &Path, b: &Path| a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b);
    if same(input, output) {
        return Err(Error::format(output, "is the file that is read; choose another -o"));
    }
    if files::is_there(output) && !force {
        return Err(already_exists(output, "is there already"));
    }
    Ok(())
}

fn lines(format: Format, output: &Path, export: &Export) -> Vec<String> {
    let mut lines = vec![format!("file        {} ({})", output.display(), format.name())];
    lines.extend(wrapped("convention  ", &export.convention));
    lines.extend(checks((&export.read_back, &export.albedo, &export.transmittance)));
    if let Some((read_back, albedo, transmittance)) = &export.back {
        lines.push("from the back".into());
        lines.extend(checks((read_back, albedo, transmittance)));
    }
    lines
}

/// How far the file is from the table, under the light from one side.
fn checks(
    (read_back, albedo, transmittance): (&Option<ReadBack>, &Option<AlbedoCurve>, &Option<AlbedoCurve>),
) -> Vec<String> {
    let mut lines = vec![match read_back {
        None => "read back   the table holds nothing but zeros".into(),
        Some(back) => format!("read back   L1 {:.3e} over {} bins", back.l1, back.bins),
    }];
    lines.extend(read_back.as_ref().filter(|back| back.worst > 0.0).map(|back| {
        let ((theta_i, phi_i), (theta_r, phi_r)) = (back.worst_incidence_deg, back.worst_bin_deg);
        format!(
            "worst bin   {:.3e} of its incidence's peak, light {theta_i:.2} {phi_i:.2}, sensor {theta_r:.2} {phi_r:.2}",
            back.worst
        )
    }));
    lines.extend(albedo.iter().flat_map(|curve| wrapped("albedo      ", &curve_line(curve))));
    lines.extend(transmittance.iter().flat_map(|curve| wrapped("transmitted ", &curve_line(curve))));
    lines
}

/// The curve of the file next to the table's.
fn curve_line(curve: &AlbedoCurve) -> String {
    let at = &curve.points[curve.worst_point];
    let mut text = format!(
        "within {:.2} % of the table's, at the incidences and between them (worst: light {:.2} {:.2}); ",
        100.0 * curve.worst,
        at.theta_i_deg,
        at.phi_i_deg
    );
    if curve.theta_r_up_to_deg < 90.0 {
        text += &format!("of the light up to theta_r {}; ", curve.theta_r_up_to_deg);
    }
    let row = |[theta, table, file]: [f64; 3]| format!("{theta:.1} {table:.4} {file:.4}");
    text + "theta_i, table, file: " + &curve.by_theta().into_iter().map(row).collect::<Vec<_>>().join("; ")
}
