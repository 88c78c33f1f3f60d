//! `[surface.file]`: a measured height map.

use std::path::{Component, Path, PathBuf};

use super::reader::{Bounds, GivenValue, Slot, TableReader};
use crate::campaign::schema::{Detrend, Gaps, HeightMap, Outliers, Preparation};

/// Words for [`Detrend`]; a polynomial has `degree` besides.
pub(crate) const DETREND: [(&str, Detrend); 5] = [
    ("plane", Detrend::Plane),
    ("none", Detrend::None),
    ("polynomial", Detrend::Polynomial(DEGREE)),
    ("sphere", Detrend::Sphere),
    ("cylinder", Detrend::Cylinder),
];

/// Words for [`Gaps`].
pub(crate) const GAPS: [(&str, Gaps); 3] =
    [("refuse", Gaps::Refuse), ("interpolate", Gaps::Interpolate), ("exclude", Gaps::Exclude)];

/// Words for [`Outliers`].
pub(crate) const OUTLIERS: [(&str, Outliers); 3] =
    [("keep", Outliers::Keep), ("fill", Outliers::Fill), ("exclude", Outliers::Exclude)];

/// Degree of a polynomial where none is given.
const DEGREE: u32 = 2;

/// Endings of the files that may be height maps.
const ENDINGS: [&str; 15] = [
    "exr", "npy", "gsf", "gwy", "x3p", "sur", "sdf", "asc", "xyz", "txt", "csv", "dat", "tif", "tiff", "png",
];
/// Endings of files that hold neither pitches nor a unit.
const BARE: [&str; 4] = ["npy", "tif", "tiff", "png"];

/// Pitches and units of height maps, um.
const LENGTH_UM: Bounds = Bounds::closed(1e-9, 1e9);

/// Reads `[surface.file]`; the map is looked for in `folder`.
pub(crate) fn height_map(table: TableReader<'_>, folder: &Path) -> Option<HeightMap> {
    let [path, channel, pitch_x, pitch_y, height_unit, periodic, detrend, degree, refine, tiles, steps @ ..] =
        table.keys([
            "path",
            "channel",
            "pitch_x_um",
            "pitch_y_um",
            "height_unit_um",
            "periodic",
            "detrend",
            "degree",
            "refine",
            "tiles",
            "gaps",
            "outliers",
            "s_filter_um",
            "l_filter_um",
        ]);
    let path = path.required("the height map, such as scan.x3p").and_then(map_path);
    let channel = channel.or(None, |i| channel_name(i).map(Some));
    let lengths = [&pitch_x, &pitch_y, &height_unit];
    let needed = path.and_then(|path| all_or_none(&lengths, is_bare(path)));
    let lengths = lengths.map(|slot| slot.or(None, |i| i.float(&LENGTH_UM).map(Some)));
    let periodic = periodic.or(false, |i| i.boolean());
    let detrend = form(&detrend, &degree);
    let preparation = preparation(&steps);
    let refine = refine.or(None, steps_between_samples);
    let tiles = tiles.or(4, |i| i.count(1..=64));
    let (path, [x, y, unit], ()) = (path?, lengths, needed?);
    Some(HeightMap {
        path: path.to_string(),
        channel: channel?,
        resolved_path: resolved(folder, path),
        pitch_x_um: x?,
        pitch_y_um: y?,
        height_unit_um: unit?,
        periodic: periodic?,
        detrend: detrend?,
        preparation: preparation?,
        refine: refine?,
        tiles: tiles?,
    })
}

/// `detrend`, with the `degree` of a polynomial.
fn form(detrend: &Slot<'_>, degree: &Slot<'_>) -> Option<Detrend> {
    match detrend.or(Detrend::Plane, |i| i.choice(&DETREND))? {
        Detrend::Polynomial(_) => degree.or(DEGREE, |i| i.count(2..=10)).map(Detrend::Polynomial),
        other => {
            degree.absent("belongs to detrend = \"polynomial\"; leave it out here")?;
            Some(other)
        }
    }
}

/// `gaps`, `outliers`, `s_filter_um` and `l_filter_um`.
fn preparation([gaps, outliers, s_filter, l_filter]: &[Slot<'_>; 4]) -> Option<Preparation> {
    let gaps = gaps.or(Gaps::Refuse, |i| i.choice(&GAPS));
    let outliers = outliers.or(Outliers::Keep, |i| i.choice(&OUTLIERS));
    let [s_filter_um, l_filter_um] =
        [s_filter, l_filter].map(|slot| slot.or(None, |i| i.float(&LENGTH_UM).map(Some)));
    let (s_filter_um, l_filter_um) = (s_filter_um?, l_filter_um?);
    if let (Some(short), Some(long)) = (s_filter_um, l_filter_um)
        && short >= long
    {
        return l_filter
            .refuse(format!("must be above s_filter_um = {short}: nothing would be left between them"));
    }
    Some(Preparation { gaps: gaps?, outliers: outliers?, s_filter_um, l_filter_um })
}

/// `channel`: a title, or a number of either kind.
fn channel_name(item: &GivenValue<'_>) -> Option<String> {
    const ALLOWED: &str = "must be a title, a number or a channel's name without control characters";
    match (item.as_text(), item.as_whole()) {
        (Some(name), _) if !name.is_empty() && !name.chars().any(char::is_control) => Some(name.to_string()),
        (None, Some(number)) => Some(number.to_string()),
        _ => item.refuse(ALLOWED),
    }
}

/// `refine`: "auto" or a power of two.
fn steps_between_samples(item: &GivenValue<'_>) -> Option<Option<u32>> {
    const ALLOWED: &str = "must be \"auto\" or a power of two up to 64 (1: the map's own cells)";
    match (item.as_text(), item.as_whole()) {
        (Some("auto"), _) => Some(None),
        (_, Some(steps @ 1..=64)) if steps.is_power_of_two() => Some(u32::try_from(steps).ok()),
        _ => item.refuse(ALLOWED),
    }
}

/// `path` as seen from where the campaign file lies.
fn resolved(folder: &Path, path: &str) -> PathBuf {
    // Without its `.` parts, so that messages name the file as the user would.
    folder.join(path).components().filter(|part| *part != Component::CurDir).collect()
}

fn is_bare(path: &str) -> bool {
    BARE.contains(&extension(path).as_str())
}

fn extension(path: &str) -> String {
    Path::new(path).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// Whether a file may be a height map by its name.
pub(crate) fn is_map_name(path: &str) -> bool {
    ENDINGS.contains(&extension(path).as_str())
}

fn map_path<'a>(item: &GivenValue<'a>) -> Option<&'a str> {
    let path = item.text()?;
    if path.is_empty() || path.chars().any(char::is_control) {
        return item.refuse("must be a file name without control characters");
    }
    if is_map_name(path) {
        return Some(path);
    }
    item.refuse(
        "must end in .x3p, .sur, .sdf, .gwy, .gsf, .asc (Arc grid), .xyz, .txt or .csv (lines of x y z, or a matrix), .dat \
         (Zygo, or text), .tif, .png, .exr or .npy",
    )
}

/// Pitches and unit: all but bare arrays and pictures may hold their own, and then none of the three is mixed with the file's.
fn all_or_none(lengths: &[&Slot<'_>; 3], required: bool) -> Option<()> {
    let given = lengths.iter().filter(|slot| slot.given().is_some()).count();
    if given == 3 || (given == 0 && !required) {
        return Some(());
    }
    let why = if required {
        "required: arrays and pictures (.npy, .tif, .png) hold no pitches"
    } else {
        "required: give pitch_x_um, pitch_y_um and height_unit_um, or none of them (the file's own then count)"
    };
    for slot in lengths.iter().filter(|slot| slot.given().is_none()) {
        slot.refuse::<()>(why);
    }
    None
}
