//! `[surface.file]`: a measured height map.

use std::path::{Component, Path, PathBuf};

use super::reader::{Bounds, GivenValue, Slot, TableReader};
use crate::campaign::schema::{Detrend, HeightMap};

/// Words for [`Detrend`].
pub(crate) const DETREND: [(&str, Detrend); 2] = [("plane", Detrend::Plane), ("none", Detrend::None)];

/// Pitches and units of height maps, um.
const LENGTH_UM: Bounds = Bounds::closed(1e-9, 1e9);

/// Reads `[surface.file]`; the map is looked for in `folder`.
pub(crate) fn height_map(table: TableReader<'_>, folder: &Path) -> Option<HeightMap> {
    let [path, pitch_x, pitch_y, height_unit, periodic, detrend, refine, tiles] = table.keys([
        "path",
        "pitch_x_um",
        "pitch_y_um",
        "height_unit_um",
        "periodic",
        "detrend",
        "refine",
        "tiles",
    ]);
    let path = path.required("the height map, .exr, .npy, .gsf or .xyz").and_then(map_path);
    let lengths = [&pitch_x, &pitch_y, &height_unit];
    let needed = path.and_then(|path| all_or_none(&lengths, is_npy(path)));
    let lengths = lengths.map(|slot| slot.or(None, |i| i.float(&LENGTH_UM).map(Some)));
    let periodic = periodic.or(false, |i| i.boolean());
    let detrend = detrend.or(Detrend::Plane, |i| i.choice(&DETREND));
    let refine = refine.or(None, steps_between_samples);
    let tiles = tiles.or(4, |i| i.count(1..=64));
    let (path, [x, y, unit], ()) = (path?, lengths, needed?);
    Some(HeightMap {
        path: path.to_string(),
        resolved_path: resolved(folder, path),
        pitch_x_um: x?,
        pitch_y_um: y?,
        height_unit_um: unit?,
        periodic: periodic?,
        detrend: detrend?,
        refine: refine?,
        tiles: tiles?,
    })
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

fn is_npy(path: &str) -> bool {
    extension(path) == "npy"
}

fn extension(path: &str) -> String {
    Path::new(path).extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

fn map_path<'a>(item: &GivenValue<'a>) -> Option<&'a str> {
    let path = item.text()?;
    if path.is_empty() || path.chars().any(char::is_control) {
        return item.refuse("must be a file name without control characters");
    }
    match extension(path).as_str() {
        "exr" | "npy" | "gsf" | "txt" | "xyz" | "asc" => Some(path),
        _ => {
            item.refuse(
                "must end in .exr, .npy, .gsf (Gwyddion simple field), .asc (Arc grid), .xyz or .txt (lines of x y z, or \
                 a matrix)",
            )
        }
    }
}

/// Pitches and unit: all but NPY may hold their own, and then none of the three is mixed with the file's.
fn all_or_none(lengths: &[&Slot<'_>; 3], required: bool) -> Option<()> {
    let given = lengths.iter().filter(|slot| slot.given().is_some()).count();
    if given == 3 || (given == 0 && !required) {
        return Some(());
    }
    let why = if required {
        "required: a .npy file holds no pitches"
    } else {
        "required: give pitch_x_um, pitch_y_um and height_unit_um, or none of them (the file's own then count)"
    };
    for slot in lengths.iter().filter(|slot| slot.given().is_none()) {
        slot.refuse::<()>(why);
    }
    None
}
