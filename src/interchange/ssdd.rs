//! SSDD 0.2: an open text form of a 3-D or 4-D table over four lists of angles in degrees.
//!
//! `KEY value` lines, `PARAM0_LIST` .. `PARAM3_LIST` (theta_i, phi_i, theta_o, phi_o), `DATA ascii`, then one colour a
//! line, theta_i fastest, phi_o slowest. Source: the SSDD 0.2 specification.

use std::io::{BufRead, ErrorKind, Write};

use super::lookup::{bin_axes, stop_axes};
use super::named_columns::Columns;
use super::read_back::{Listing, ReadBack};
use super::{Fail, Reason, seam, spectral_table};
use crate::instrument::{Grid, GridKind};
use crate::sphere;
use crate::table::{BrdfTable, check_grid};

/// How the values are meant.
pub const CONVENTION: &str = "spherical coordinates in degrees (theta_i, phi_i, theta_o, phi_o), phi_o = phi_i + 180 is the \
    mirror direction; BRDF in 1/sr, no cosine; the middle of each bin";

/// Writes the totals of a table whose stops and bins are products of angles. Azimuths are put into [0, 360) in increasing
/// order, as the format wants them; of an isotropic table the light has none.
pub fn write(table: &BrdfTable, out: &mut dyn Write) -> Result<(), Fail> {
    let grid = &table.grid;
    if grid.phi_r_relative && !grid.is_isotropic() {
        return Err("phi_r counts from the light at several azimuths; SSDD has absolute ones"
            .to_string()
            .into());
    }
    let ((theta_i, phi_i), (theta_r, phi_r)) = (stop_axes(grid)?, bin_axes(grid)?);
    if theta_r.iter().any(|&theta| theta < 0.0) {
        return Err("an arm with negative polar angles has no list of spherical angles".to_string().into());
    }
    let lists = [
        increasing(&theta_i, false),
        increasing(&phi_i, true),
        increasing(&theta_r, false),
        increasing(&phi_r, true),
    ];
    let model = if table.colours.len() == 1 { "monochrome" } else { "rgb" };
    writeln!(
        out,
        "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL {model}\nPARAM_TYPE spherical_coordinate_system"
    )?;
    for (k, list) in lists.iter().enumerate().filter(|(k, _)| *k != 1 || !grid.is_isotropic()) {
        let list: Vec<String> = list.iter().map(|(angle, _)| angle.to_string()).collect();
        writeln!(out, "PARAM{k}_LIST {}", list.join(" "))?;
    }
    writeln!(out, "SOURCE_TYPE generated\nDATA ascii")?;
    let (bins, [theta_i, phi_i, theta_r, phi_r]) = (theta_r.len() * phi_r.len(), &lists);
    for (_, pr) in phi_r {
        for (_, tr) in theta_r {
            for (_, pi) in phi_i {
                for (_, ti) in theta_i {
                    let at = (ti * phi_i.len() + pi) * bins + tr * phi_r.len() + pr;
                    let values: Vec<String> = table.colours.iter().map(|c| c.total[at].to_string()).collect();
                    writeln!(out, "{}", values.join(" "))?;
                }
            }
        }
    }
    Ok(())
}

/// Angles in increasing order, azimuths in [0, 360), each with its place in the table.
fn increasing(angles: &[f64], azimuths: bool) -> Vec<(f64, usize)> {
    let written = |&angle: &f64| if azimuths { sphere::reduced_deg(angle) } else { angle };
    let mut list: Vec<(f64, usize)> = angles.iter().map(written).zip(0..).collect();
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    list
}

/// The table of points of an ASCII file in spherical coordinates; negative values become 0. Without `PARAM1_LIST` it is
/// isotropic. Azimuths a turn apart are one where their values agree.
///
/// Held by: `ssdd_comes_back`, `damaged_texts_are_refused` (tests/interchange_text.rs), tests/interchange_angles.rs.
pub fn read(bytes: &[u8]) -> Reason<BrdfTable> {
    let mut lines = Lines::of(bytes);
    let (grid, columns) = heading(&mut lines)?;
    let colours = columns.colours();
    let (stops, bins) = check_grid(&grid)?;
    let pixels = stops.checked_mul(bins).filter(|&pixels| pixels <= bytes.len());
    let pixels =
        pixels.ok_or_else(|| format!("{stops} stops of {bins} directions: more than the file holds"))?;
    let mut total = vec![vec![0.0f32; pixels]; colours];
    each_line(&mut lines, &grid, &columns, |stop, bin, values| {
        total.iter_mut().zip(values).for_each(|(total, &value)| total[stop * bins + bin] = value);
    })?;
    seam::dropped(spectral_table(grid, total, &columns.wavelengths_nm)?)
}

/// Holds a file of the table's own angles to the table, line by line, each value at its angles.
pub fn read_back(file: impl BufRead, table: &BrdfTable) -> Reason<Option<ReadBack>> {
    let mut lines = Lines::of(file);
    let (grid, columns) = heading(&mut lines)?;
    let colours = columns.colours();
    let sizes = (grid.stops(), grid.bins(), colours);
    if sizes != (table.grid.stops(), table.grid.bins(), table.colours.len()) {
        return Err(format!("{} stops of {} directions, {} colours", sizes.0, sizes.1, sizes.2));
    }
    let (stops, bins) = seam::places(&grid, &table.grid)?;
    let mut listing = Listing::new(table);
    each_line(&mut lines, &grid, &columns, |stop, bin, values| {
        values.iter().enumerate().for_each(|(c, &value)| listing.add(stops[stop], bins[bin], c, value));
    })?;
    listing.finish()
}

/// The lines of a file that are not empty, without comments and the space round them, and their numbers.
struct Lines<R> {
    lines: std::io::Lines<R>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    fn of(file: R) -> Self {
        Lines { lines: file.lines(), number: 0 }
    }

    fn next(&mut self) -> Reason<Option<(usize, String)>> {
        for line in self.lines.by_ref() {
            self.number += 1;
            let line = line.map_err(|e| match e.kind() {
                ErrorKind::InvalidData => "not a text in UTF-8: only `DATA ascii` is read".to_string(),
                _ => e.to_string(),
            })?;
            let line = without_comment(&line).trim();
            if !line.is_empty() {
                return Ok(Some((self.number, line.to_string())));
            }
        }
        Ok(None)
    }
}

/// What stands before `#` and a space, or before a `#` that begins or ends the line.
fn without_comment(line: &str) -> &str {
    let begins = |&(at, _): &(usize, &str)| {
        let rest = &line[at + 1..];
        line[..at].trim().is_empty() || rest.is_empty() || rest.starts_with(char::is_whitespace)
    };
    line.match_indices('#').find(begins).map_or(line, |(at, _)| &line[..at])
}

/// The geometry, and what a line of values holds.
fn heading(lines: &mut Lines<impl BufRead>) -> Reason<(Grid, Columns)> {
    if lines.next()?.is_none_or(|(_, line)| !line.starts_with("VERSION ")) {
        return Err("no VERSION line: not an SSDD file".into());
    }
    let mut lists: [Vec<f64>; 4] = Default::default();
    let (mut model, mut wavelengths) = (String::new(), Vec::new());
    loop {
        let Some((number, line)) = lines.next()? else { return Err("no DATA line".into()) };
        let (key, value) = line.split_once(char::is_whitespace).unwrap_or((&line, ""));
        let needs = |wanted: &str| {
            if value == wanted { Ok(()) } else { Err(format!("line {number}: {key} {wanted} needed")) }
        };
        match key {
            "DATA" => break needs("ascii")?,
            "DATA_TYPE" => needs("brdf")?,
            "PARAM_TYPE" => needs("spherical_coordinate_system")?,
            "REDUCTION_TYPE" => return Err(format!("line {number}: reduced tables are not read")),
            "COLOR_MODEL" => model = value.to_string(),
            "WAVELENGTH_LIST" => wavelengths = value.split_whitespace().map(|nm| format!("{nm}nm")).collect(),
            _ => {
                let list = key.strip_prefix("PARAM").and_then(|rest| rest.strip_suffix("_LIST"));
                if let Some(k) = list.and_then(|k| k.parse::<usize>().ok()).filter(|&k| k < 4) {
                    let angles = value.split_whitespace().map(str::parse).collect::<Result<_, _>>();
                    lists[k] = angles.map_err(|_| format!("line {number}: {key}: numbers needed"))?;
                }
            }
        }
    }
    let names: Vec<&str> = match model.as_str() {
        "monochrome" => vec!["value"],
        "rgb" => vec!["R", "G", "B"],
        "xyz" => vec!["X", "Y", "Z"],
        "spectrum" => wavelengths.iter().map(String::as_str).collect(),
        _ => return Err(format!("COLOR_MODEL {model}: monochrome, rgb, xyz or spectrum needed")),
    };
    let columns = Columns::of(&names, 0).map_err(|why| format!("COLOR_MODEL {model}: {why}"))?;
    // Azimuths of the light are needed of anisotropic data: without them there is one kind of azimuth, from the light.
    let phi_r_relative = lists[1].is_empty();
    if phi_r_relative {
        lists[1] = vec![0.0];
    }
    let [theta_i_deg, phi_i_deg, theta_r, phi_r] = lists;
    let points_deg = theta_r.iter().flat_map(|&t| phi_r.iter().map(move |&p| [t, p])).collect();
    let kind = GridKind::Points;
    Ok((Grid { kind, theta_i_deg, phi_i_deg, phi_r_relative, points_deg, ..Grid::default() }, columns))
}

/// Visits the lines of values: stop, bin, and a value for each colour; negative ones become 0.
fn each_line(
    lines: &mut Lines<impl BufRead>,
    grid: &Grid,
    colours: &Columns,
    mut visit: impl FnMut(usize, usize, &[f32]),
) -> Reason<()> {
    let (thetas, phis, bins) = (grid.theta_i_deg.len(), grid.phi_i_deg.len(), grid.bins());
    let columns = grid.points_deg.iter().take_while(|point| point[0] == grid.points_deg[0][0]).count();
    let (rows, pixels) = (bins / columns.max(1), thetas * phis * bins);
    let mut count = 0;
    while let Some((number, line)) = lines.next()? {
        let (ti, pi, rest) = (count % thetas, count / thetas % phis, count / (thetas * phis));
        let (tr, pr) = (rest % rows, rest / rows);
        let cell = |cell: &str| cell.parse().map_err(|_| format!("line {number}: `{cell}` is no number"));
        let numbers = line.split_whitespace().map(cell).collect::<Reason<Vec<f64>>>()?;
        if numbers.len() != colours.colours() || count == pixels {
            return Err(format!("line {number}: {pixels} lines of {} values needed", colours.colours()));
        }
        let values: Vec<f32> = colours.values(&numbers).iter().map(|&value| value.max(0.0)).collect();
        visit(ti * phis + pi, tr * columns + pr, &values);
        count += 1;
    }
    if count != pixels {
        return Err(format!("{count} lines of values, {pixels} needed"));
    }
    Ok(())
}
