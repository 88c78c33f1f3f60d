//! The whole file, and its small tables: `name`, `seed`, `[optics]`, `[trace]`, `[stop]`, `[expect]`,
//! `[bench]`.

use std::path::Path;

use super::materials::{MATERIALS, f0_of};
use super::reader::{Bounds, Item, Slot, Table};
use super::report::nearest;
use super::schema::{
    Campaign, Expect, ExpectedMasking, Optics, Resolution, Stop, Surface, SurfaceKind, Trace,
};
use super::{arms, surface};

/// Words for [`ExpectedMasking`].
pub(super) const MASKINGS: [(&str, ExpectedMasking); 3] = [
    ("separable", ExpectedMasking::Separable),
    ("height_correlated", ExpectedMasking::HeightCorrelated),
    ("direction_correlated", ExpectedMasking::DirectionCorrelated),
];

/// Longest name: with its endings it stays within what file systems take.
const LONGEST_NAME: usize = 100;

/// Most starts per stop and realisation.
const MOST_SAMPLES: u64 = 1 << 40;

/// What a fast machine traces, to say how long too many starts would take.
const STARTS_PER_SECOND: f64 = 1e7;

const REFLECTANCE: Bounds = Bounds::closed(0.0, 1.0);
const RELATIVE_ERROR: Bounds = Bounds::closed(1e-4, 1.0);
/// Up to eleven days.
const SECONDS: Bounds = Bounds::closed(1.0, 1e6);

/// Reads a whole file; height maps are looked for in `folder`.
pub(super) fn campaign(root: Table<'_>, folder: &Path) -> Option<Campaign> {
    let [name, seed, surface, light, sensor, preset, optics, trace, stop, expect, bench] = root.keys([
        "name", "seed", "surface", "light", "sensor", "preset", "optics", "trace", "stop", "expect", "bench",
    ]);
    let name = name.required("it names the output; letters, digits, _ - .").and_then(valid_name);
    let seed = seed.or(1, |i| i.whole(0..=u64::MAX));
    let surface = surface::surface(&surface, folder);
    let isotropic = surface.as_ref().map(|s| s.kind.is_isotropic());
    let (light, sensor) = match preset.given() {
        // A preset replaces both arms: without it their keys would be reported as missing.
        Some(preset) => (preset.refuse("not yet: give [light] and [sensor] themselves"), None),
        None => {
            let light = arms::light(&light, isotropic);
            let sensor = arms::sensor(&sensor, light.as_ref());
            (light, sensor)
        }
    };
    let optics = optics.or(Optics::PerfectMirror, |i| fresnel(i.table()?));
    let statistical = surface.as_ref().is_some_and(|s| matches!(s.kind, SurfaceKind::Smith(_)));
    let trace = self::trace(&trace, statistical);
    let realisations = surface.as_ref().map_or(u32::MAX, |s| s.realisations);
    let (stop, expect) = (self::stop(&stop, realisations), self::expect(&expect));
    let bench = bench.or(None, |i| resolution(i, surface.as_ref()).map(Some));
    Some(Campaign {
        name: name?.to_string(),
        seed: seed?,
        surface: surface?,
        light: light?,
        sensor: sensor?,
        optics: optics?,
        trace: trace?,
        stop: stop?,
        expect: expect?,
        bench: bench?,
    })
}

fn valid_name<'a>(item: &Item<'a>) -> Option<&'a str> {
    let name = item.text()?;
    let known = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
    let fits = !name.is_empty() && name.len() <= LONGEST_NAME;
    if fits && name.chars().all(known) && !name.starts_with(['.', '-']) {
        return Some(name);
    }
    item.refuse(format!(
        "must be 1 to {LONGEST_NAME} letters (a-z), digits, _ - or . and start with none of . -; it names files"
    ))
}

fn fresnel(table: Table<'_>) -> Option<Optics> {
    let [material, f0, eta, k, wavelength, fresnel, polarisation] =
        table.keys(["material", "f0", "eta", "k", "wavelength_nm", "fresnel", "polarisation"]);
    let named = material.or(None, |i| known_material(i).map(Some));
    let colour = f0.or(None, |i| reflectances(i).map(Some));
    let index = [&eta, &k, &wavelength]
        .map(|slot| slot.absent("not yet: this version knows Schlick's Fresnel; give material or f0"));
    let later = [
        fresnel.or((), |i| only(i, "schlick", &["exact"])),
        polarisation.or((), |i| only(i, "none", &["s", "p"])),
    ];
    let clean = index.iter().chain(&later).all(Option::is_some);
    match (named?, colour?) {
        (Some(_), Some(_)) => f0.refuse("ambiguous: give material or f0, never both"),
        (Some((name, f0)), None) if clean => Some(Optics::Schlick { material: Some(name.to_string()), f0 }),
        (None, Some(f0)) if clean => Some(Optics::Schlick { material: None, f0 }),
        (None, None) if index.iter().all(Option::is_some) => {
            material.refuse("required: material or f0; leave out [optics] altogether for F = 1")
        }
        _ => None,
    }
}

fn known_material<'a>(item: &Item<'a>) -> Option<(&'a str, [f64; 3])> {
    let name = item.text()?;
    if let Some(f0) = f0_of(name) {
        return Some((name, f0));
    }
    let names = MATERIALS.map(|(name, _)| name);
    let guess = nearest(name, &names).map(|n| format!(" did you mean `{n}`?")).unwrap_or_default();
    item.refuse(format!("unknown material;{guess} known: {}", names.join(", ")))
}

/// One reflectance for all colours, or three.
fn reflectances(item: &Item<'_>) -> Option<[f64; 3]> {
    match item.list_length() {
        None => item.float(&REFLECTANCE).map(|gray| [gray; 3]),
        Some(3) => {
            let elements = item.list()?;
            let read: Vec<Option<f64>> = elements.iter().map(|e| e.float(&REFLECTANCE)).collect();
            let read: Vec<f64> = read.into_iter().collect::<Option<_>>()?;
            read.try_into().ok()
        }
        Some(n) => item.refuse(format!("has {n} entries; give [r, g, b] or one number")),
    }
}

/// The one word that is known now; `later` are refused as such.
fn only(item: &Item<'_>, now: &str, later: &[&str]) -> Option<()> {
    match item.text()? {
        word if word == now => Some(()),
        word if later.contains(&word) => item.refuse(format!("not yet: this version knows \"{now}\"")),
        _ => item.refuse(format!("must be \"{now}\"")),
    }
}

fn trace(slot: &Slot<'_>, statistical: bool) -> Option<Trace> {
    let [bounces, visibility, fold] = slot.table()?.keys(["bounces", "visibility", "fold"]);
    let orders = bounces.or(1, |i| i.count(1..=10_000));
    let visible = visibility.or(true, |i| i.boolean());
    let fold = fold.or(true, |i| i.boolean());
    let (bounces, visible) = (orders?, visible?);
    if !visible && statistical {
        return visibility.refuse("must be true: a statistical Smith surface is nothing but its masking");
    }
    if !visible && bounces > 1 {
        return visibility.refuse(format!(
            "must be true with bounces = {bounces}: light that passes through facets has no second bounce"
        ));
    }
    Some(Trace { bounces, visibility: visible, fold: fold? })
}

fn stop(slot: &Slot<'_>, realisations: u32) -> Option<Stop> {
    let [samples, relative_error, seconds] = slot.table()?.keys(["samples", "relative_error", "seconds"]);
    let samples =
        samples.required("start points per stop and realisation, such as 1_000_000").and_then(self::samples);
    let relative_error = relative_error.or(None, |item| {
        let wanted = item.float(&RELATIVE_ERROR)?;
        if realisations < 2 {
            return item.refuse("needs at least 2 realisations: errors come from their spread");
        }
        Some(Some(wanted))
    });
    let seconds = seconds.or(None, |i| i.float(&SECONDS).map(Some));
    Some(Stop { samples: samples?, relative_error: relative_error?, seconds: seconds? })
}

/// Start points per stop and realisation. More than the most is a matter of time; none are no measurement.
fn samples(item: &Item<'_>) -> Option<u64> {
    match item.as_whole().filter(|&samples| samples > MOST_SAMPLES) {
        Some(samples) => {
            let years = samples as f64 / STARTS_PER_SECOND / (365.25 * 86_400.0);
            item.too_large(format!(
                "takes {years:.1e} years for each stop and realisation; must be a whole number in [1, {MOST_SAMPLES}]"
            ))
        }
        None => item.whole(1..=MOST_SAMPLES),
    }
}

fn expect(slot: &Slot<'_>) -> Option<Expect> {
    let [masking, l1_model] = slot.table()?.keys(["masking", "l1_model"]);
    let masking = masking.or(None, |i| i.choice(&MASKINGS).map(Some));
    let l1_model = l1_model.or(None, |i| i.float(&Bounds::closed(0.0, 10.0).low_open()).map(Some));
    Some(Expect { masking: masking?, l1_model: l1_model? })
}

/// Patch sizes and correlation lengths, the surface's own where one list is left out.
fn resolution(item: &Item<'_>, surface: Option<&Surface>) -> Option<Resolution> {
    let [cells, lengths] = item.table()?.keys(["cells", "correlation_cells"]);
    let surface = surface?;
    if !surface.kind.is_random_heights() {
        return item.refuse("varies the cells of a synthesised surface; leave it out here");
    }
    let cells = cells.or(vec![surface.cells], |i| all(i, |i| i.count(8..=16384)));
    let longest = cells.iter().flatten().min().map_or(2048.0, |&cells| f64::from(cells) / 8.0);
    let bounds = Bounds::closed(longest.min(2.0), longest).advice(
        "a shorter correlation is not resolved by the cells",
        "an eighth of the smallest patch at most",
    );
    let own = vec![surface.correlation_cells];
    let correlation_cells = lengths.or(own, |i| all(i, |i| i.float(&bounds)));
    Some(Resolution { cells: cells?, correlation_cells: correlation_cells? })
}

/// Every element of a list that is not empty; faults of all of them are told.
fn all<T>(item: &Item<'_>, read: impl Fn(&Item<'_>) -> Option<T>) -> Option<Vec<T>> {
    let read: Vec<Option<T>> = item.list()?.iter().map(read).collect();
    if read.is_empty() { item.refuse("at least one number") } else { read.into_iter().collect() }
}
