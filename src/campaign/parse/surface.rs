//! `[surface]`: the sample and its one kind.

use std::path::Path;

use super::angles::AZIMUTH;
use super::artist;
use super::grains::grains;
use super::height_map::height_map;
use super::lists::ranges;
use super::lists::run_lists::{MOST_RUNS, RunLists};
use super::psd;
use super::reader::{Bounds, GivenValue, Slot, TableReader, plain};
use super::roughness::{alphas, alphas_of};
use crate::campaign::schema::{Alpha, HeightSpectrum, Smith, SmithHeights, SmithNdf, Surface, SurfaceKind};
use crate::sphere::reduced_deg;

/// Words for [`HeightSpectrum`].
pub(crate) const SPECTRA: [(&str, HeightSpectrum); 2] =
    [("gaussian", HeightSpectrum::Gaussian), ("exponential", HeightSpectrum::Exponential)];

/// Words for [`SmithNdf`].
pub(crate) const SMITH_NDF: [(&str, SmithNdf); 2] =
    [("ggx", SmithNdf::Ggx), ("beckmann", SmithNdf::Beckmann)];

/// Words for [`SmithHeights`].
pub(crate) const SMITH_HEIGHTS: [(&str, SmithHeights); 2] =
    [("correlated", SmithHeights::Correlated), ("independent", SmithHeights::Independent)];

/// Cells per side where nothing is given.
const CELLS: u32 = 1024;

/// Most cells per side: heights of 2 GiB.
const MOST_CELLS: u32 = 16384;

/// Correlation length where nothing is given and the patch is large enough, in cells.
const CORRELATION_CELLS: f64 = 8.0;

/// Below, a slope is no slope; above, nothing was tested.
const SLOPE: Bounds = Bounds::closed(1e-4, 10.0).advice("a flat surface is [surface.mirror]", "");

/// Student's gamma: from GGX, beyond which no grid holds the needles, to what Beckmann is to a hundredth.
const GAMMA: Bounds =
    Bounds::closed(2.0, 100.0).advice("2 is ggx, the longest tails that a grid holds", "use beckmann");

/// Blinn and Phong's exponent: at 20,000 alpha is 0.01.
const EXPONENT: Bounds = Bounds::closed(0.0, 20_000.0).advice("0 is ggx with alpha = 1", "use beckmann");

const KINDS: &str = "[surface.ggx], [surface.beckmann], [surface.student_t], [surface.blinn_phong], [surface.psd], \
     [surface.smith], [surface.grains], [surface.mirror], [surface.v_groove] or [surface.file]";

/// Keys of `[surface]` that describe a patch of any kind.
struct PatchKeys<'a> {
    realisations: Slot<'a>,
    cells: Slot<'a>,
    correlation_cells: Slot<'a>,
    mirror_images: Slot<'a>,
}

/// Reads `[surface]`; height maps are looked for in `folder`. `artist_f0` gets the reflectance of
/// `[surface.artist]`.
pub(crate) fn surface(
    slot: &Slot<'_>,
    folder: &Path,
    artist_f0: &mut Option<[f64; 3]>,
    lists: &RunLists,
) -> Option<Surface> {
    let [realisations, cells, correlation_cells, rotation, mirror_images, kinds @ ..] = slot.table()?.keys([
        "realisations",
        "cells",
        "correlation_cells",
        "rotation_deg",
        "mirror_images",
        "ggx",
        "beckmann",
        "mirror",
        "v_groove",
        "file",
        "smith",
        "artist",
        "student_t",
        "blinn_phong",
        "grains",
        "psd",
    ]);
    let given: Vec<&GivenValue<'_>> = kinds.iter().filter_map(Slot::given).collect();
    if let [one] = given[..]
        && one.name() == "psd"
    {
        let rotation_deg = rotation.or(0.0, rotation_deg);
        let keys = PatchKeys { realisations, cells, correlation_cells, mirror_images };
        return of_psd(&keys, one, folder, rotation_deg);
    }
    let mut read: Vec<Option<SurfaceKind>> = given.iter().map(|item| kind(item, folder, artist_f0)).collect();
    let rotation_deg = rotation.or(0.0, rotation_deg);
    let keys = PatchKeys { realisations, cells, correlation_cells, mirror_images };
    let kind = match given[..] {
        [] if kinds.iter().any(Slot::is_misspelt) => None,
        [] => slot.refuse(format!("exactly one kind is required: {KINDS}")),
        [_] => read.pop().flatten(),
        [first, second, ..] => second.refuse(format!(
            "exactly one kind is allowed, and [surface.{}] is there as well: keep one of {KINDS}",
            first.name()
        )),
    };
    match given[..] {
        [one] if matches!(one.name(), "smith" | "mirror" | "v_groove" | "file") => {
            made_or_measured(&keys, one.name() == "file", kind, rotation_deg)
        }
        [one] if one.name() == "grains" && !kind.as_ref().is_some_and(SurfaceKind::is_random_heights) => {
            of_grains(&keys, kind, rotation_deg)
        }
        _ => synthesised(&keys, kind, rotation_deg, lists),
    }
}

fn rotation_deg(item: &GivenValue<'_>) -> Option<f64> {
    let given = item.float(&AZIMUTH)?;
    let rotation = reduced_deg(given);
    if rotation != given {
        item.note(format!("reduced to {}: rotations lie in [0, 360)", plain(rotation)));
    }
    Some(rotation)
}

/// The keys of a random patch.
fn synthesised(
    keys: &PatchKeys<'_>,
    kind: Option<SurfaceKind>,
    rotation_deg: Option<f64>,
    lists: &RunLists,
) -> Option<Surface> {
    let realisations = keys.realisations.or(16, |i| i.count(1..=4096));
    let cells = keys.cells.or(CELLS, cells);
    // With faulty cells the longest correlation of all applies: no fault follows from another one.
    let correlation_cells = correlation(&keys.correlation_cells, cells.unwrap_or(MOST_CELLS), lists);
    let mirror_images = keys.mirror_images.or(true, |i| i.boolean());
    Some(Surface {
        realisations: realisations?,
        cells: cells?,
        correlation_cells: correlation_cells?,
        rotation_deg: rotation_deg?,
        mirror_images: mirror_images?,
        kind: kind?,
    })
}

/// Cells per side. More than the most is a matter of memory; fewer than the least are no patch.
fn cells(item: &GivenValue<'_>) -> Option<u32> {
    match item.as_whole().filter(|&cells| cells > u64::from(MOST_CELLS)) {
        Some(cells) => {
            let gib = 8.0 * (cells as f64).powi(2) / f64::from(1u32 << 30);
            item.too_large(format!(
                "heights of {cells} x {cells} cells take {gib:.0} GiB; must be a whole number in [8, {MOST_CELLS}]"
            ))
        }
        None => item.count(8..=MOST_CELLS),
    }
}

/// Correlation length in cells: long enough to be resolved, short enough for many bumps on a patch.
/// A patch of fewer than 16 cells takes an eighth of its side, whatever that is.
fn correlation(slot: &Slot<'_>, cells: u32, lists: &RunLists) -> Option<f64> {
    let longest = f64::from(cells) / 8.0;
    let bounds = Bounds::closed(longest.min(2.0), longest).advice(
        "a shorter correlation is not resolved by the cells",
        "a longer correlation leaves too few bumps on the patch",
    );
    let numbers = |i: &GivenValue<'_>| {
        ranges::numbers(i, &bounds, MOST_RUNS).map(|all| all.into_iter().map(ranges::rounded).collect())
    };
    slot.or(longest.min(CORRELATION_CELLS), |i| lists.value(i, |i| i.float(&bounds), numbers))
}

/// A surface by its power spectral density, from which the correlation length follows.
fn of_psd(
    keys: &PatchKeys<'_>,
    item: &GivenValue<'_>,
    folder: &Path,
    rotation_deg: Option<f64>,
) -> Option<Surface> {
    let absent = keys.correlation_cells.absent("follows from the power spectral density; leave it out here");
    let realisations = keys.realisations.or(16, |i| i.count(1..=4096));
    let mirror_images = keys.mirror_images.or(true, |i| i.boolean());
    // What a wave is depends on the cells: no fault follows from faulty ones.
    let cells = keys.cells.or(CELLS, cells)?;
    let (psd, correlation_cells) = psd::psd(item, cells, folder)?;
    absent?;
    Some(Surface {
        realisations: realisations?,
        cells,
        correlation_cells,
        rotation_deg: rotation_deg?,
        mirror_images: mirror_images?,
        kind: SurfaceKind::Psd(psd),
    })
}

/// The keys of grains, which have cells only as heights.
fn of_grains(keys: &PatchKeys<'_>, kind: Option<SurfaceKind>, rotation_deg: Option<f64>) -> Option<Surface> {
    let absent =
        keys.correlation_cells.absent("belongs to heights on a grid; grains have a size of their own");
    let cells = keys.cells.or(CELLS, cells);
    let realisations = keys.realisations.or(16, |i| i.count(1..=4096));
    let mirror_images = keys.mirror_images.or(true, |i| i.boolean());
    absent?;
    Some(Surface {
        realisations: realisations?,
        cells: cells?,
        correlation_cells: CORRELATION_CELLS,
        rotation_deg: rotation_deg?,
        mirror_images: mirror_images?,
        kind: kind?,
    })
}

/// A surface without random heights: the keys of a random patch have no meaning there.
fn made_or_measured(
    keys: &PatchKeys<'_>,
    measured: bool,
    kind: Option<SurfaceKind>,
    rotation_deg: Option<f64>,
) -> Option<Surface> {
    let why = "belongs to a synthesised surface; leave it out here";
    let absent = [&keys.cells, &keys.correlation_cells, &keys.mirror_images].map(|slot| slot.absent(why));
    let given = if measured {
        let why = "belongs to a synthesised surface; the groups of a height map are its tiles";
        keys.realisations.absent(why).map(|()| 1)
    } else {
        // Groups of paths stand for the realisations of a statistical surface.
        let default = if matches!(kind, Some(SurfaceKind::Smith(_))) { 16 } else { 1 };
        keys.realisations.or(default, |i| i.count(1..=4096))
    };
    absent.into_iter().collect::<Option<Vec<()>>>()?;
    let (given, kind) = (given?, kind?);
    let realisations = match &kind {
        SurfaceKind::File(map) => map.tiles * map.tiles,
        _ => given,
    };
    Some(Surface {
        realisations,
        cells: CELLS,
        correlation_cells: CORRELATION_CELLS,
        rotation_deg: rotation_deg?,
        mirror_images: false,
        kind,
    })
}

fn kind(item: &GivenValue<'_>, folder: &Path, artist_f0: &mut Option<[f64; 3]>) -> Option<SurfaceKind> {
    match item.name() {
        "artist" => {
            let (alpha, f0) = artist::artist(item.table()?)?;
            *artist_f0 = Some(f0);
            Some(SurfaceKind::Ggx(vec![alpha]))
        }
        "ggx" => alphas(item.table()?).map(SurfaceKind::Ggx),
        "beckmann" => beckmann(item.table()?),
        "student_t" => student_t(item.table()?),
        "blinn_phong" => blinn_phong(item.table()?),
        "smith" => smith(item.table()?).map(SurfaceKind::Smith),
        "grains" => grains(item.table()?).map(SurfaceKind::Grains),
        "mirror" => {
            let [] = item.table()?.keys([]);
            Some(SurfaceKind::Mirror)
        }
        "v_groove" => {
            let [slope] = item.table()?.keys(["slope"]);
            let slope = slope.required("the slope of both sides, such as 0.5")?.float(&SLOPE)?;
            Some(SurfaceKind::VGroove { slope })
        }
        "file" => height_map(item.table()?, folder).map(SurfaceKind::File),
        // Next to another kind, which is a fault already.
        "psd" => psd::psd(item, CELLS, folder).map(|(psd, _)| SurfaceKind::Psd(psd)),
        other => item.refuse(format!("not yet: {other} is not measured by this version; use {KINDS}")),
    }
}

fn beckmann(table: TableReader<'_>) -> Option<SurfaceKind> {
    let [spectrum, slopes @ ..] = table.keys(["spectrum", "alpha", "alpha_x", "alpha_y"]);
    let spectrum = spectrum.or(HeightSpectrum::Gaussian, |i| i.choice(&SPECTRA));
    let alphas = alphas_of(slopes);
    Some(SurfaceKind::Beckmann { alphas: alphas?, spectrum: spectrum? })
}

fn student_t(table: TableReader<'_>) -> Option<SurfaceKind> {
    let [gamma, slopes @ ..] = table.keys(["gamma", "alpha", "alpha_x", "alpha_y"]);
    let gamma = gamma.required("half the power of the tails, such as 3").and_then(|i| i.float(&GAMMA));
    let alphas = alphas_of(slopes);
    Some(SurfaceKind::StudentT { alphas: alphas?, gamma: gamma? })
}

/// D = (n + 2)/(2 pi) cos^n is Student's law with gamma = n/2 + 2 and alpha = sqrt(2/(n + 2)): for each n another law.
fn blinn_phong(table: TableReader<'_>) -> Option<SurfaceKind> {
    let [exponent] = table.keys(["exponent"]);
    let exponent = exponent.required("n of cos^n; 2/alpha^2 - 2 for the width of alpha")?.float(&EXPONENT)?;
    let alpha = (2.0 / (exponent + 2.0)).sqrt();
    Some(SurfaceKind::BlinnPhong { exponent, alphas: vec![Alpha::isotropic(alpha)] })
}

fn smith(table: TableReader<'_>) -> Option<Smith> {
    let [ndf, heights, slopes @ ..] = table.keys(["ndf", "heights", "alpha", "alpha_x", "alpha_y"]);
    let ndf = ndf.or(SmithNdf::Ggx, |i| i.choice(&SMITH_NDF));
    let heights = heights.or(SmithHeights::Correlated, |i| i.choice(&SMITH_HEIGHTS));
    let alphas = alphas_of(slopes);
    Some(Smith { ndf: ndf?, alphas: alphas?, heights: heights? })
}
