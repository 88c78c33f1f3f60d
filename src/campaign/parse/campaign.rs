//! The whole file, and its small tables: `name`, `seed`, `[trace]`, `[stop]`, `[expect]`,
//! `[scale]`, `[bench]`, `[uncertainty]`.

use std::path::Path;

use super::index_file::WAVELENGTH;
use super::lists::ranges::{self, whole_numbers};
use super::lists::run_lists::{MOST_RUNS, RunLists};
use super::psd::PITCH_UM;
use super::reader::{Bounds, GivenValue, Slot, TableReader, plain};
use super::{arms, optics, surface, uncertainty};
use crate::campaign::presets;
use crate::campaign::presets::Preset;
use crate::campaign::schema::{
    Campaign, Expect, ExpectedMasking, Optics, PhysicalScale, Resolution, Stop, Surface, SurfaceKind, Trace,
    Uncertainty,
};

/// Words for [`ExpectedMasking`].
pub(crate) const MASKINGS: [(&str, ExpectedMasking); 3] = [
    ("separable", ExpectedMasking::Separable),
    ("height_correlated", ExpectedMasking::HeightCorrelated),
    ("direction_correlated", ExpectedMasking::DirectionCorrelated),
];

/// Longest name: with its endings it stays within what file systems take.
const LONGEST_NAME: usize = 100;

/// Most surface samples per incidence and realisation.
const MOST_SAMPLES: u64 = 1 << 40;

/// What a fast machine traces, to say how long too many surface samples would take.
const SAMPLES_PER_SECOND: f64 = 1e7;

const RELATIVE_ERROR: Bounds = Bounds::closed(1e-4, 1.0);
/// Most entries of a list of `[bench]`.
const MOST_LADDER: usize = 1000;
/// Most orders with channels of their own.
const MOST_APART: u32 = 16;
/// Up to eleven days.
const SECONDS: Bounds = Bounds::closed(1.0, 1e6);

/// What a campaign file holds.
pub(crate) struct CampaignFile {
    pub campaign: Campaign,
    /// The instrument that the arms are taken from.
    pub preset: Option<Preset>,
    /// What a budget is made of: no part of what is measured.
    pub uncertainty: Option<Uncertainty>,
}

/// Reads a whole file; height maps are looked for in `folder`.
pub(crate) fn campaign(root: TableReader<'_>, folder: &Path, lists: &RunLists) -> Option<CampaignFile> {
    let [name, seed, surface, light, sensor, preset, optics, trace, stop, expect, scale, bench, uncertainty] =
        root.keys([
            "name",
            "seed",
            "surface",
            "light",
            "sensor",
            "preset",
            "optics",
            "trace",
            "stop",
            "expect",
            "scale",
            "bench",
            "uncertainty",
        ]);
    let name = name.required("it names the output; letters, digits, _ - .").and_then(valid_name);
    let seed = seed.or(1, |i| {
        let numbers = |i: &GivenValue<'_>| whole_numbers(i, 0..=u64::MAX, MOST_RUNS);
        lists.value(i, |i| i.whole(0..=u64::MAX), numbers)
    });
    let through = optics::lets_through(&optics);
    let sides = match preset.given() {
        Some(_) => arms::light_sides(&preset, "light_side", through),
        None => arms::light_sides(&light, "side", through),
    };
    let mut artist_f0 = None;
    let surface = surface::surface(&surface, folder, &mut artist_f0, lists);
    let isotropic = surface.as_ref().map(|s| s.kind.is_isotropic());
    let (light, sensor, preset) = match preset.given() {
        Some(_) => {
            let why = "a [preset] is there and replaces [light] and [sensor]: keep the one or the others";
            let alone = [&light, &sensor].map(|slot| slot.absent(why));
            let arms =
                presets::arms(&preset, isotropic, through).filter(|_| alone.iter().all(Option::is_some));
            let (preset, light, sensor) = arms.map_or((None, None, None), |(p, l, s)| (Some(p), l, s));
            (light, sensor, preset)
        }
        None => {
            let light = arms::light(&light, isotropic);
            let sensor = arms::sensor(&sensor, light.as_ref(), through);
            (light, sensor, None)
        }
    };
    let statistical = surface.as_ref().is_some_and(|s| matches!(s.kind, SurfaceKind::Smith(_)));
    let trace = self::trace(&trace, statistical);
    let orders = trace.as_ref().map(|trace| trace.bounces);
    let optics = optics::optics(
        &optics,
        artist_f0,
        &optics::Around { folder, orders, sides: sides.clone().unwrap_or_default() },
    );
    let realisations = surface.as_ref().map_or(u32::MAX, |s| s.realisations);
    let (stop, expect) = (self::stop(&stop, realisations), self::expect(&expect));
    let scale = self::scale(&scale, surface.as_ref(), optics.as_ref());
    let bench = bench.or(None, |i| resolution(i, surface.as_ref()).map(Some));
    let uncertainty = match (&surface, &light, &sensor, sides.as_ref().and(optics.as_ref())) {
        (Some(surface), Some(light), Some(sensor), Some(optics)) => {
            let around = uncertainty::Around { surface, light, sensor, optics };
            uncertainty.or(None, |i| uncertainty::uncertainty(i, &around).map(Some))
        }
        // Their faults come first: what a budget may ask depends on all of them.
        _ => None,
    };
    let campaign = Campaign {
        name: name?.to_string(),
        seed: seed?,
        surface: surface?,
        light: light?,
        sensor: sensor?,
        optics: sides.and(optics)?,
        trace: trace?,
        stop: stop?,
        expect: expect?,
        scale: scale?,
        bench: bench?,
    };
    Some(CampaignFile { campaign, preset, uncertainty: uncertainty? })
}

fn valid_name<'a>(item: &GivenValue<'a>) -> Option<&'a str> {
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

fn trace(slot: &Slot<'_>, statistical: bool) -> Option<Trace> {
    let [bounces, visibility, fold, by_order] =
        slot.table()?.keys(["bounces", "visibility", "fold", "by_order"]);
    let orders = bounces.or(1, |i| i.count(1..=10_000));
    let visible = visibility.or(true, |i| i.boolean());
    let fold = fold.or(true, |i| i.boolean());
    let apart = by_order.or(false, |i| i.boolean());
    let (bounces, visible, apart) = (orders?, visible?, apart?);
    if apart && !(2..=MOST_APART).contains(&bounces) {
        return by_order.refuse(format!(
            "must be false with bounces = {bounces}: 2 to {MOST_APART} orders can be kept apart"
        ));
    }
    if !visible && statistical {
        return visibility.refuse("must be true: a statistical Smith surface is nothing but its masking");
    }
    if !visible && bounces > 1 {
        return visibility.refuse(format!(
            "must be true with bounces = {bounces}: light that passes through facets has no second bounce"
        ));
    }
    Some(Trace { bounces, visibility: visible, fold: fold?, by_order: apart })
}

fn stop(slot: &Slot<'_>, realisations: u32) -> Option<Stop> {
    let [samples, relative_error, seconds] = slot.table()?.keys(["samples", "relative_error", "seconds"]);
    let samples = samples
        .required("surface samples per incidence and realisation, such as 1_000_000")
        .and_then(self::samples);
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

/// Surface samples per incidence and realisation. More than the most is a matter of time; none are no measurement.
fn samples(item: &GivenValue<'_>) -> Option<u64> {
    match item.as_whole().filter(|&samples| samples > MOST_SAMPLES) {
        Some(samples) => {
            let years = samples as f64 / SAMPLES_PER_SECOND / (365.25 * 86_400.0);
            item.too_large(format!(
                "takes {years:.1e} years for each incidence and realisation; must be a whole number in [1, {MOST_SAMPLES}]"
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

/// Lengths that neither surface nor optics say. Unknown ones blame nobody.
fn scale(slot: &Slot<'_>, surface: Option<&Surface>, optics: Option<&Optics>) -> Option<PhysicalScale> {
    let [pitch, wavelength] = slot.table()?.keys(["pitch_um", "wavelength_nm"]);
    let pitch_um = pitch.or(None, |item| {
        match surface.map(|surface| &surface.kind) {
            Some(SurfaceKind::Psd(_) | SurfaceKind::File(_)) => {
                return item.refuse("the surface has a pitch of its own; leave it out here");
            }
            Some(kind) if !kind.is_random_heights() => {
                return item.refuse("belongs to random heights on a grid; leave it out here");
            }
            _ => {}
        }
        item.float(&PITCH_UM).map(Some)
    });
    let wavelength_nm = wavelength.or(None, |item| {
        if optics.is_some_and(|optics| optics.media().iter().any(|medium| medium.wavelength_nm.is_some())) {
            return item.refuse("[optics] has wavelengths of its own; leave it out here");
        }
        item.float(&WAVELENGTH).map(Some)
    });
    Some(PhysicalScale { pitch_um: pitch_um?, wavelength_nm: wavelength_nm? })
}

/// Patch sizes and correlation lengths, the surface's own where one list is left out.
fn resolution(item: &GivenValue<'_>, surface: Option<&Surface>) -> Option<Resolution> {
    let [cells, lengths] = item.table()?.keys(["cells", "correlation_cells"]);
    let surface = surface?;
    if matches!(surface.kind, SurfaceKind::Psd(_)) {
        return item.refuse(
            "varies cells without a size; those of [surface.psd] have pitch_um: change it in the campaign",
        );
    }
    if !surface.kind.has_random_patches() {
        return item.refuse("varies the cells of a synthesised surface; leave it out here");
    }
    if !surface.kind.is_random_heights() {
        lengths.absent("belongs to heights on a grid; grains have a size of their own")?;
    }
    let sizes: Option<Vec<u32>> = cells.or(vec![surface.cells], |i| {
        let all = not_empty(i, whole_numbers(i, 8..=16384, MOST_LADDER)?)?;
        all.into_iter().map(|n| u32::try_from(n).ok()).collect()
    });
    let longest = sizes.iter().flatten().min().map_or(2048.0, |&cells| f64::from(cells) / 8.0);
    let bounds = Bounds::closed(longest.min(2.0), longest).advice(
        "a shorter correlation is not resolved by the cells",
        "an eighth of the smallest patch at most",
    );
    let own = surface.correlation_cells;
    let too_long = surface.kind.is_random_heights() && own > longest;
    if let (true, None, Some(cells)) = (too_long, lengths.given(), cells.given()) {
        return cells.refuse(format!(
            "the smallest patch has no room for the surface's correlation_cells = {}: an eighth of its cells at most; \
             take larger patches, or list bench.correlation_cells",
            plain(own)
        ));
    }
    let correlation_cells =
        lengths.or(vec![own], |i| not_empty(i, ranges::numbers(i, &bounds, MOST_LADDER)?));
    Some(Resolution { cells: sizes?, correlation_cells: correlation_cells? })
}

fn not_empty<T>(item: &GivenValue<'_>, all: Vec<T>) -> Option<Vec<T>> {
    if all.is_empty() { item.refuse("at least one number") } else { Some(all) }
}
