//! Anisotropic BSDF files of Ansys Speos (`.anisotropicbsdf`), text mode, written only: a table of polar angles and azimuths
//! for each angle of the anisotropy vector and each incidence.
//!
//! phi_o counts counter-clockwise from the direction in which the light's own travels along the surface: the mirror direction
//! is at (theta_i, 0). phi_i is the angle from there to the anisotropy vector, here x. Source: Ansys' page on the structure of
//! these files (rows 1 to 8, angles) and Ansys' own converter, which is public (the rows that follow).

use std::io::{BufRead, Write};
use std::path::Path;

use super::zemax::energy::albedo;
use crate::error::wrong;
use crate::instrument::{Grid, GridKind};
use crate::interchange::codec::{self, Codec, Encoded, FileContent, FormatTraits};
use crate::interchange::read_back::{Listing, ReadBack, digits, middles_deg};
use crate::interchange::{Checked, Imported, Options};
use crate::sphere;
use crate::table::BrdfTable;

/// How the values are meant.
const CONVENTION: &str = "degrees; theta_o from the normal, phi_o counter-clockwise from the mirror direction's azimuth; phi_i from \
    there to the anisotropy vector, the sample's x; BSDF in 1/sr, no cosine; the middle of each bin";
const HEAD: &str = "OPTIS - Anisotropic BSDF surface file v8.0";
const END: &str = "End of file";
/// The ends of the flat spectrum, nm.
const SPECTRUM_NM: [u32; 2] = [350, 850];

/// The format.
pub struct Speos;

impl Codec for Speos {
    fn traits(&self) -> FormatTraits {
        FormatTraits { colours: false, ..FormatTraits::totals("speos") }
    }

    fn decode(&self, _bytes: &[u8], _options: &Options) -> Checked<(Imported, Vec<String>)> {
        Err("is written, not read: import another export of the same data".into())
    }

    fn encode<'a>(&self, table: &'a BrdfTable, _options: &Options) -> Checked<Encoded<'a>> {
        let grid = &table.grid;
        if grid.kind != GridKind::Hemisphere {
            return Err(
                "an arm, points or patches: the bins of a hemisphere needed, which have polar angles times azimuths".into()
            );
        }
        let edges = &grid.phi_r_edges_deg;
        let around = edges[edges.len() - 1] - edges[0];
        if (around - 360.0).abs() > 1e-9 {
            return Err(wrong!("azimuths of the sensor over {around} degrees: 360 needed"));
        }
        let mut notes = vec!["a flat spectrum: the file has one colour".to_string()];
        if grid.azimuths() == 1 && !grid.is_isotropic() {
            notes.push("the light has one azimuth, which stands for all".into());
        }
        Ok(Encoded {
            content: FileContent::Stream(Box::new(move |out| write(table, out))),
            convention: CONVENTION.into(),
            notes,
        })
    }

    fn read_back(&self, path: &Path, table: &BrdfTable, _options: &Options) -> Checked<Option<ReadBack>> {
        let mut lines = codec::open(path)?.lines();
        let mut listing = Listing::new(table);
        let mut next = || lines.next().ok_or("the file ends early")?.map_err(|e| e.to_string());
        let rotations = rotations(&table.grid);
        for _ in 0..header_lines(&rotations) {
            next()?;
        }
        for (_, incidences) in &rotations {
            for &incidence in incidences {
                let block = Block::of(&table.grid, incidence);
                let (_, _) = (next()?, next()?);
                for row in &block.rows {
                    let line = next()?;
                    let mut cells = line.split('\t').skip(1);
                    for bin in &row.bins {
                        let cell = cells.next().and_then(|cell| cell.parse().ok());
                        let value: f32 = cell.ok_or_else(|| wrong!("no number in `{line:.60}`"))?;
                        if let Column::Bin(bin) = bin {
                            listing.add(incidence, *bin, 0, value);
                        }
                    }
                }
            }
        }
        listing.finish()
    }
}

/// Angles from the light's azimuth of travel to x, increasing, each with its incidences.
fn rotations(grid: &Grid) -> Vec<(f64, Vec<usize>)> {
    let mut rotations: Vec<(f64, Vec<usize>)> = Vec::new();
    let isotropic = grid.is_isotropic();
    for incidence in 0..grid.incidences() {
        let phi = if isotropic { 0.0 } else { sphere::reduced_deg(180.0 - grid.incidence_deg(incidence).1) };
        match rotations.iter_mut().find(|(angle, _)| *angle == phi) {
            Some((_, incidences)) => incidences.push(incidence),
            None => rotations.push((phi, vec![incidence])),
        }
    }
    rotations.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, incidences) in &mut rotations {
        incidences.sort_by(|a, b| grid.incidence_deg(*a).0.total_cmp(&grid.incidence_deg(*b).0));
    }
    rotations
}

/// Lines before the first table: see [`header`].
fn header_lines(rotations: &[(f64, Vec<usize>)]) -> usize {
    10 + 2 * rotations.len() + 3 + SPECTRUM_NM.len()
}

/// What a column of a table holds.
enum Column {
    Bin(usize),
    /// At the seam: the values of two bins, and how far it is from the first to the second.
    Between(usize, usize, f64),
}

/// A polar angle and its columns.
struct Row {
    theta: f64,
    bins: Vec<Column>,
}

/// The table of an incidence.
struct Block {
    phis: Vec<f64>,
    rows: Vec<Row>,
}

impl Block {
    fn of(grid: &Grid, incidence: usize) -> Self {
        let from = grid.incidence_deg(incidence).1 + 180.0;
        let middles = middles_deg(grid, incidence);
        let columns = grid.phi_r_edges_deg.len() - 1;
        let phi_o = |phi: f64| digits(sphere::reduced_deg(phi - from)) % 360.0;
        let mut order: Vec<(f64, usize)> =
            middles[..columns].iter().map(|(_, phi)| phi_o(*phi)).zip(0..).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        // A reader goes straight between azimuths: the seam has a column on both sides, what a straight line has there.
        let ((first_phi, first), (last_phi, last)) = (order[0], order[columns - 1]);
        let share = (360.0 - last_phi) / (first_phi + 360.0 - last_phi);
        let open = first_phi > 0.0;
        let row = |(row, middles): (usize, &[(f64, f64)])| {
            let at = |column: usize| row * columns + column;
            let seam = || Column::Between(at(last), at(first), share);
            let inner = order.iter().map(|(_, column)| Column::Bin(at(*column)));
            let bins = open.then(seam).into_iter().chain(inner).chain([seam()]).collect();
            Row { theta: middles[0].0, bins }
        };
        let before = open.then_some(0.0);
        Block {
            phis: before.into_iter().chain(order.iter().map(|(phi, _)| *phi)).chain([360.0]).collect(),
            rows: middles.chunks(columns).enumerate().map(row).collect(),
        }
    }
}

fn write(table: &BrdfTable, out: &mut dyn Write) -> Checked<()> {
    let rotations = rotations(&table.grid);
    header(table, &rotations, out)?;
    let bins = table.grid.bins();
    for incidence in rotations.iter().flat_map(|(_, incidences)| incidences) {
        let block = Block::of(&table.grid, *incidence);
        let values = &table.colours[0].total[incidence * bins..][..bins];
        writeln!(out, "{} {}", block.rows.len(), block.phis.len())?;
        for phi in &block.phis {
            write!(out, "\t{phi}")?;
        }
        writeln!(out)?;
        for row in &block.rows {
            write!(out, "{}", row.theta)?;
            for column in &row.bins {
                let value = match *column {
                    Column::Bin(bin) => values[bin],
                    Column::Between(a, b, share) => {
                        (f64::from(values[a]) * (1.0 - share) + f64::from(values[b]) * share) as f32
                    }
                };
                write!(out, "\t{value:e}")?;
            }
            writeln!(out)?;
        }
    }
    writeln!(out, "{END}")?;
    Ok(())
}

/// The rows before the tables: what the file is, its angles, and the spectrum of the reflectance at its first incidence.
fn header(table: &BrdfTable, rotations: &[(f64, Vec<usize>)], out: &mut dyn Write) -> Checked<()> {
    let description = format!("gonio {}", table.version);
    // Text mode, a comment, the description with its length, the anisotropy vector; reflection alone; values of the BSDF.
    writeln!(
        out,
        "{HEAD}\n0\nBRDF of a table of gonio\n{}\n{description}\n1\t0\t0\n1\t0\n1",
        description.len()
    )?;
    let list = |angles: Vec<f64>| angles.iter().map(f64::to_string).collect::<Vec<_>>().join("\t");
    writeln!(out, "{}\n{}", rotations.len(), list(rotations.iter().map(|(angle, _)| *angle).collect()))?;
    for (_, incidences) in rotations {
        let thetas = incidences.iter().map(|incidence| table.grid.incidence_deg(*incidence).0).collect();
        writeln!(out, "{}\n{}", incidences.len(), list(thetas))?;
    }
    let (angle, incidences) = &rotations[0];
    let (theta, phi) = table.grid.incidence_deg(incidences[0]);
    let percent = 100.0 * albedo(table, theta.to_radians(), phi.to_radians()).unwrap_or_default();
    // The incidence of the spectrum, its name, its wavelengths and the reflectance in per cent.
    writeln!(out, "{theta}\t{angle}\n\n{}", SPECTRUM_NM.len())?;
    for nm in SPECTRUM_NM {
        writeln!(out, "{nm}\t{percent}")?;
    }
    Ok(())
}
