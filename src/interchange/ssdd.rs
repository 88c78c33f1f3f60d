//! SSDD 0.2: an open text form of a 3-D or 4-D table over four lists of angles in degrees.
//!
//! `KEY value` lines, `PARAM0_LIST` .. `PARAM3_LIST` (theta_i, phi_i, theta_o, phi_o), `DATA ascii`, then one colour a
//! line, theta_i fastest, phi_o slowest. Source: the SSDD 0.2 specification.

use std::io::{BufRead, Write};

use super::lookup::{bin_axes, stop_axes};
use super::read_back::{Listing, ReadBack};
use super::{Fail, Reason, colour, seam, spectral_table};
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
    let nm: Vec<String> =
        table.colours.iter().filter_map(|colour| colour.wavelength_nm).map(|nm| nm.to_string()).collect();
    let model = match table.colours.len() {
        _ if !nm.is_empty() => format!("spectrum\nWAVELENGTH_LIST {}", nm.join(" ")),
        1 => "monochrome".into(),
        _ => "rgb".into(),
    };
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

/// The table of points of a file in spherical coordinates; negative values become 0, X, Y, Z linear R, G, B. Without `PARAM1_LIST` it is
/// isotropic. Azimuths a turn apart are one where their values agree.
///
/// Held by: `ssdd_comes_back`, `damaged_texts_are_refused` (tests/interchange_text.rs), tests/interchange_angles.rs.
pub fn read(bytes: &[u8]) -> Reason<BrdfTable> {
    let mut lines = Lines::of(bytes);
    let heading = heading(&mut lines)?;
    let (colours, (stops, bins)) = (heading.colours, check_grid(&heading.grid)?);
    let values = stops.checked_mul(bins).and_then(|pixels| pixels.checked_mul(colours));
    let pixels = values.filter(|&values| values <= bytes.len()).map(|values| values / colours);
    let pixels =
        pixels.ok_or_else(|| format!("{stops} stops of {bins} directions: more than the file holds"))?;
    let mut total = vec![vec![0.0f32; pixels]; colours];
    each_value(&mut lines, &heading, |stop, bin, colour, value| {
        total[colour][stop * bins + bin] = value;
    })?;
    if heading.xyz {
        to_rgb(&mut total);
    }
    let grid = if heading.bilateral { mirrored(heading.grid, &mut total) } else { heading.grid };
    seam::dropped(spectral_table(grid, total, &heading.wavelengths_nm)?)
}

/// X, Y, Z as linear R, G, B.
fn to_rgb(total: &mut [Vec<f32>]) {
    let [x, y, z] = total else { return };
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        [*x, *y, *z] = colour::rgb([*x, *y, *z].map(f64::from)).map(|value| value as f32);
    }
}

/// Holds a file of the table's own angles to the table, line by line, each value at its angles.
pub fn read_back(file: impl BufRead, table: &BrdfTable) -> Reason<Option<ReadBack>> {
    let mut lines = Lines::of(file);
    let heading = heading(&mut lines)?;
    let grid = &heading.grid;
    let sizes = (grid.stops(), grid.bins(), heading.colours);
    if sizes != (table.grid.stops(), table.grid.bins(), table.colours.len()) {
        return Err(format!("{} stops of {} directions, {} colours", sizes.0, sizes.1, sizes.2));
    }
    let (stops, bins) = seam::places(grid, &table.grid)?;
    let mut listing = Listing::new(table);
    each_value(&mut lines, &heading, |stop, bin, colour, value| {
        listing.add(stops[stop], bins[bin], colour, value)
    })?;
    listing.finish()
}

/// The lines of a file that are not empty, without comments and the space round them, and their numbers.
struct Lines<R> {
    file: R,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    fn of(file: R) -> Self {
        Lines { file, number: 0 }
    }

    fn next(&mut self) -> Reason<Option<(usize, String)>> {
        let mut bytes = Vec::new();
        while self.file.read_until(b'\n', &mut bytes).map_err(|e| e.to_string())? > 0 {
            self.number += 1;
            let line = std::str::from_utf8(&bytes)
                .map_err(|_| format!("line {}: not a text in UTF-8", self.number))?;
            let line = without_comment(line).trim();
            if !line.is_empty() {
                return Ok(Some((self.number, line.to_string())));
            }
            bytes.clear();
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

/// What stands before the values.
#[derive(Default)]
struct Heading {
    grid: Grid,
    colours: usize,
    /// X, Y, Z instead of R, G, B.
    xyz: bool,
    wavelengths_nm: Vec<f64>,
    /// f32, little-endian, instead of text.
    binary: bool,
    /// The sensor's azimuths beyond half a turn are those before, mirrored at the plane of incidence.
    bilateral: bool,
}

fn heading(lines: &mut Lines<impl BufRead>) -> Reason<Heading> {
    if lines.next()?.is_none_or(|(_, line)| !line.starts_with("VERSION ")) {
        return Err("no VERSION line: not an SSDD file".into());
    }
    let mut lists: [Vec<f64>; 4] = Default::default();
    let mut found = Heading::default();
    loop {
        let Some((number, line)) = lines.next()? else { return Err("no DATA line".into()) };
        let (key, value) = line.split_once(char::is_whitespace).unwrap_or((&line, ""));
        let value = value.trim();
        let needs = |wanted: &str| Err(format!("line {number}: {key} {value}: {wanted} needed"));
        let numbers = || {
            let numbers = value.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>();
            numbers.map_err(|_| format!("line {number}: {key}: numbers needed"))
        };
        match (key, value) {
            ("DATA", "ascii") => break,
            ("DATA", "binary") => {
                found.binary = true;
                break;
            }
            ("DATA", _) => return needs("ascii or binary"),
            ("DATA_TYPE", "brdf") | ("PARAM_TYPE", "spherical_coordinate_system") => {}
            ("DATA_TYPE", _) => return needs("brdf"),
            ("PARAM_TYPE", _) => return needs("spherical_coordinate_system"),
            ("REDUCTION_TYPE", "bilateral_symmetry") => found.bilateral = true,
            ("REDUCTION_TYPE", _) => return needs("bilateral_symmetry"),
            ("COLOR_MODEL", "monochrome") => found.colours = 1,
            ("COLOR_MODEL", "rgb" | "xyz") => (found.colours, found.xyz) = (3, value == "xyz"),
            ("COLOR_MODEL", "spectrum") => {}
            ("COLOR_MODEL", _) => return needs("monochrome, rgb, xyz or spectrum"),
            ("WAVELENGTH_LIST", _) => found.wavelengths_nm = numbers()?,
            _ => {
                let list = key.strip_prefix("PARAM").and_then(|rest| rest.strip_suffix("_LIST"));
                if let Some(k) = list.and_then(|k| k.parse::<usize>().ok()).filter(|&k| k < 4) {
                    lists[k] = numbers()?;
                }
            }
        }
    }
    let nm = &found.wavelengths_nm;
    if !nm.windows(2).all(|pair| pair[0] < pair[1]) || !nm.iter().all(|nm| *nm > 0.0 && nm.is_finite()) {
        return Err("WAVELENGTH_LIST: increasing positive numbers needed".into());
    }
    match (found.colours, nm.len()) {
        (0, 0) => return Err("COLOR_MODEL spectrum needs a WAVELENGTH_LIST".into()),
        (0, count) => found.colours = count,
        _ => found.wavelengths_nm.clear(),
    }
    found.grid = grid(lists, found.bilateral)?;
    Ok(found)
}

fn grid([theta_i_deg, mut phi_i_deg, theta_r, phi_r]: [Vec<f64>; 4], bilateral: bool) -> Reason<Grid> {
    // Azimuths of the light are needed of anisotropic data: without them there is one kind of azimuth, from the light.
    let phi_r_relative = phi_i_deg.is_empty();
    if phi_r_relative {
        phi_i_deg.push(0.0);
    }
    if bilateral && (phi_i_deg != [0.0] || phi_r.iter().any(|phi| !(0.0..=180.0).contains(phi))) {
        return Err("bilateral_symmetry: PARAM3_LIST in [0, 180] and no azimuths of the light needed".into());
    }
    let points_deg = theta_r.iter().flat_map(|&t| phi_r.iter().map(move |&p| [t, p])).collect();
    let kind = GridKind::Points;
    Ok(Grid { kind, theta_i_deg, phi_i_deg, phi_r_relative, points_deg, ..Grid::default() })
}

/// The other half of a table that is its own mirror image at the plane of incidence.
fn mirrored(grid: Grid, total: &mut [Vec<f32>]) -> Grid {
    let (bins, points) = (grid.bins(), &grid.points_deg);
    let half: Vec<usize> = (0..bins).filter(|&bin| points[bin][1] > 0.0 && points[bin][1] < 180.0).collect();
    // Azimuths run fastest and up within a polar angle: the mirrored ones follow, down from 360.
    let rows = points.chunk_by(|a, b| a[0] == b[0]).scan(0, |first, row| {
        let begin = *first;
        *first += row.len();
        Some(begin..*first)
    });
    let order: Vec<(usize, bool)> = rows
        .flat_map(|row| {
            let back = row.clone().rev().filter(|bin| half.contains(bin)).map(|bin| (bin, true));
            row.map(|bin| (bin, false)).chain(back.collect::<Vec<_>>())
        })
        .collect();
    for values in total.iter_mut() {
        *values = values.chunks(bins).flat_map(|stop| order.iter().map(|(bin, _)| stop[*bin])).collect();
    }
    let point = |&(bin, back): &(usize, bool)| {
        let [theta, phi] = points[bin];
        [theta, if back { 360.0 - phi } else { phi }]
    };
    Grid { points_deg: order.iter().map(point).collect(), ..grid }
}

/// Visits the values: stop, bin, colour.
fn each_value(
    lines: &mut Lines<impl BufRead>,
    heading: &Heading,
    mut visit: impl FnMut(usize, usize, usize, f32),
) -> Reason<()> {
    let (grid, colours) = (&heading.grid, heading.colours);
    let (thetas, phis, bins) = (grid.theta_i_deg.len(), grid.phi_i_deg.len(), grid.bins());
    let columns = grid.points_deg.iter().take_while(|point| point[0] == grid.points_deg[0][0]).count();
    let (rows, pixels) = (bins / columns.max(1), thetas * phis * bins);
    let mut count = 0;
    let place = |count: usize| {
        let (ti, pi, rest) = (count % thetas, count / thetas % phis, count / (thetas * phis));
        (ti * phis + pi, rest % rows * columns + rest / rows)
    };
    let positive = |value: f32| if value < 0.0 { 0.0 } else { value };
    if heading.binary {
        let mut bytes = [0; 4];
        for at in 0..pixels * colours {
            let short = |_| format!("{} values of 4 bytes needed after `DATA binary`", pixels * colours);
            lines.file.read_exact(&mut bytes).map_err(short)?;
            let (stop, bin) = place(at / colours);
            visit(stop, bin, at % colours, positive(f32::from_le_bytes(bytes)));
        }
        return Ok(());
    }
    while let Some((number, line)) = lines.next()? {
        let (stop, bin) = place(count);
        let mut found = 0;
        for cell in line.split_whitespace() {
            let value: f32 = cell.parse().map_err(|_| format!("line {number}: no number"))?;
            if found == colours || count == pixels {
                return Err(format!("line {number}: {pixels} lines of {colours} values needed"));
            }
            visit(stop, bin, found, positive(value));
            found += 1;
        }
        if found != colours {
            return Err(format!("line {number}: {pixels} lines of {colours} values needed"));
        }
        count += 1;
    }
    if count != pixels {
        return Err(format!("{count} lines of values, {pixels} needed"));
    }
    Ok(())
}
