//! A stored table as arrays, the means of its models, and its picture.

use std::path::{Path, PathBuf};

use gonio::campaign::{self, Campaign};
use gonio::error::{Error, Result};
use gonio::files::memory;
use gonio::interchange::numpy::npz;
use gonio::report::Scene;
use gonio::report::plot::plots::shown_sweeps;
use gonio::report::plot::polar::polar;
use gonio::table::{BrdfTable, RealisationPart, TableRows, header, realisations, store};
use gonio::validate::{Prediction, expect};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::failure::on_threads;

/// Copies of a table that its arrays take on their way.
const COPIES: u64 = 4;

/// A table with what lies next to it.
struct Stored {
    table: BrdfTable,
    /// An NPZ archive of every channel.
    npz: Vec<u8>,
    parts: Vec<RealisationPart>,
    /// Realisations in each part.
    group_size: usize,
    warnings: Vec<String>,
}

/// The arrays of the table at `path` as a dictionary: `npz`, an archive as `gonio export --to npz` writes; `sizes`, the
/// bins' projected solid angles, f8; `total` and `single` of the realisations, f4, [part, incidence, bin, colour]; and
/// what they mean.
#[pyfunction]
pub fn load<'py>(py: Python<'py>, path: PathBuf, with_realisations: bool) -> PyResult<Bound<'py, PyDict>> {
    let stored = on_threads(py, 0, || stored(&path, with_realisations))?;
    let table = &stored.table;
    let answer = PyDict::new(py);
    answer.set_item("npz", PyBytes::new(py, &stored.npz))?;
    answer.set_item("sizes", doubles(py, &table.grid.sizes(0)))?;
    answer.set_item("colours", table.colour_names())?;
    answer.set_item("convention", header::convention(&table.grid))?;
    answer.set_item("parts", stored.parts.len())?;
    answer.set_item("group_size", stored.group_size)?;
    let of = |pick: fn(&RealisationPart) -> &Vec<Vec<f32>>| floats(py, stored.parts.iter().map(pick));
    answer.set_item("total", of(|part| &part.total))?;
    answer.set_item("single", of(|part| &part.single))?;
    answer.set_item("warnings", stored.warnings)?;
    Ok(answer)
}

fn stored(path: &Path, with_realisations: bool) -> Result<Stored> {
    let table = whole(path)?;
    let mut npz = Vec::new();
    npz::write(&table, &mut npz).map_err(|why| Error::format(path, why))?;
    let (mut parts, mut group_size, mut warnings) = (Vec::new(), 1, Vec::new());
    let beside = realisations_path(path);
    if with_realisations && beside.is_file() {
        let file = realisations::load(&beside)?;
        if file.is_of(&store::digest(&table)?) {
            (parts, group_size) = (file.realisations.parts, file.group_size);
        } else {
            warnings.push(format!("{} belongs to another table and is not used", beside.display()));
        }
    }
    Ok(Stored { table, npz, parts, group_size, warnings })
}

/// A table that fits the memory.
fn whole(path: &Path) -> Result<BrdfTable> {
    memory::check_file(path, COPIES.saturating_mul(TableRows::open(path)?.bytes()))?;
    Ok(store::load(path)?.table)
}

fn realisations_path(table: &Path) -> PathBuf {
    let stem = table.file_stem().unwrap_or_default().to_string_lossy();
    table.with_file_name(format!("{stem}.realisations.exr"))
}

/// The model of the table's surface: its name, and the means over the bins with each masking, f8, [incidence, bin,
/// colour]. `None` where theory has nothing to say.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "a tuple for Python")]
pub fn model_means<'py>(
    py: Python<'py>,
    path: PathBuf,
) -> PyResult<Option<(String, Vec<(&'static str, Bound<'py, PyBytes>)>)>> {
    let found = on_threads(py, 0, || whole(&path).and_then(|table| prediction(&path, &table)))?;
    let Some((_, prediction)) = found else { return Ok(None) };
    let of_masking = |(masking, name): (usize, &'static str)| {
        let mut values = Vec::new();
        for incidence in &prediction.means {
            let colours = &incidence.values[masking];
            (0..colours[0].len()).for_each(|bin| values.extend(colours.iter().map(|colour| colour[bin])));
        }
        (name, doubles(py, &values))
    };
    let means = prediction.model.maskings().into_iter().enumerate().map(of_masking).collect();
    Ok(Some((prediction.model.name(), means)))
}

/// The lobes of a table in the plane of incidence, with their model, as SVG; `None` where no bins lie in the plane.
#[pyfunction]
pub fn picture(py: Python<'_>, path: PathBuf) -> PyResult<Option<String>> {
    let drawn = || {
        let table = whole(&path)?;
        let of_campaign = prediction(&path, &table)?;
        let realisations = of_campaign.as_ref().map_or(0, |(campaign, _)| campaign.surface.realisations);
        let prediction = of_campaign.as_ref().map(|(_, prediction)| prediction);
        let masking = of_campaign.as_ref().map(|(campaign, _)| expect::masking(campaign));
        let index = prediction.map_or(0, |prediction| prediction.model.masking_index(masking));
        let scene = Scene { table: &table, prediction, realisations: realisations as usize };
        Ok(shown_sweeps(&scene).first().and_then(|sweep| polar(&scene, &sweep.incidences, index)))
    };
    on_threads(py, 0, drawn)
}

/// The campaign of a table, and what theory says of it.
fn prediction(path: &Path, table: &BrdfTable) -> Result<Option<(Campaign, Prediction)>> {
    if table.campaign.is_empty() {
        return Ok(None);
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let parsed = campaign::parse(&table.campaign, "campaign", folder)
        .map_err(|error| Error::format(path, error.to_string()))?;
    let prediction = Prediction::of(&parsed.campaign, &table.grid);
    Ok(prediction.map(|prediction| (parsed.campaign, prediction)))
}

fn doubles<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyBytes> {
    PyBytes::new(py, &values.iter().flat_map(|value| value.to_ne_bytes()).collect::<Vec<u8>>())
}

/// Channels of some parts, the colours side by side.
fn floats<'a, 'py>(py: Python<'py>, parts: impl Iterator<Item = &'a Vec<Vec<f32>>>) -> Bound<'py, PyBytes> {
    let mut bytes = Vec::new();
    for colours in parts {
        for pixel in 0..colours.first().map_or(0, Vec::len) {
            colours.iter().for_each(|values| bytes.extend(values[pixel].to_ne_bytes()));
        }
    }
    PyBytes::new(py, &bytes)
}
