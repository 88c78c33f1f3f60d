//! `[surface.psd]`: Gaussian heights by their power spectral density.

mod columns;

use std::path::Path;

use super::reader::{Bounds, GivenValue, Slot, plain};
use crate::campaign::schema::PsdSurface;
use crate::psd::{Psd, PsdKind, PsdModel, PsdMoments, PsdTable};

/// Distances of neighbouring heights, um.
pub(crate) const PITCH_UM: Bounds = Bounds::closed(1e-6, 1e6);
/// Root mean square heights, um.
const RMS_UM: Bounds = Bounds::closed(0.0, 1e6).low_open();
/// Hurst's exponent.
const HURST: Bounds = Bounds::closed(0.0, 1.0).low_open().high_open();
const A_UM3: Bounds = Bounds::closed(1e-30, 1e30);
const B_UM: Bounds = Bounds::closed(1e-9, 1e9);
const C: Bounds = Bounds::closed(1.0, 100.0)
    .low_open()
    .advice("at 1 and below the heights have no finite variance", "no rough surface falls as steeply");
/// Slopes as of every other law.
const ALPHA: Bounds = Bounds::closed(1e-4, 10.0);

/// How far the rms height of the patches may be from the one that is given.
const RMS_AGREES: f64 = 0.05;
/// The same of slopes between waves and the facets of cells: beyond, the pitch does not resolve them.
const RESOLVED: f64 = 0.1;

/// Models by name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ModelName {
    KCorrelation,
    SelfAffine,
    Table,
}

const MODELS: [(&str, ModelName); 3] = [
    ("k_correlation", ModelName::KCorrelation),
    ("self_affine", ModelName::SelfAffine),
    ("table", ModelName::Table),
];

/// The keys of the models.
struct ModelKeys<'a> {
    k_correlation: [Slot<'a>; 3],
    hurst: Slot<'a>,
    table: [Slot<'a>; 4],
    rms: Slot<'a>,
    lowest: Slot<'a>,
}

/// The surface, and its correlation length in cells; `cells` a side, files are looked for in `folder`.
pub(super) fn psd(item: &GivenValue<'_>, cells: u32, folder: &Path) -> Option<(PsdSurface, f64)> {
    let [model, pitch, a, b, c, hurst, file, frequency, areal, profile, rms, lowest, highest] =
        item.table()?.keys([
            "model",
            "pitch_um",
            "a_um3",
            "b_um",
            "c",
            "hurst",
            "file",
            "frequency_per_um",
            "psd_um4",
            "psd_um3",
            "rms_um",
            "f_min_per_um",
            "f_max_per_um",
        ]);
    let name =
        model.required("\"k_correlation\", \"self_affine\" or \"table\"").and_then(|i| i.choice(&MODELS));
    let pitch_um = pitch.required("distance of neighbouring heights, um").and_then(|i| i.float(&PITCH_UM));
    let rms_um = rms.or(None, |i| i.float(&RMS_UM).map(Some));
    let band = pitch_um.and_then(|pitch| band(&lowest, &highest, pitch, cells, name));
    let table = [file, frequency, areal, profile];
    let keys = ModelKeys { k_correlation: [a, b, c], hurst, table, rms, lowest };
    let model = name.and_then(|name| keys.model(name, rms_um.flatten(), folder));
    let ([f_min_per_um, f_max_per_um], model, pitch_um) = (band?, model?, pitch_um?);
    let checked = rms_um?.filter(|_| name != Some(ModelName::SelfAffine));
    let psd = Psd { model, f_min_per_um, f_max_per_um };
    let Some((surface, correlation)) = PsdSurface::new(psd, pitch_um, checked, cells) else {
        let [step, nyquist] = [1.0 / (f64::from(cells) * pitch_um), 0.5 / pitch_um].map(plain);
        return item.refuse(format!(
            "has no wave on these patches, which hold {step} to {nyquist} /um: change pitch_um, cells or the frequencies"
        ));
    };
    agrees(item, &keys.rms, &surface, cells)?;
    Some((surface, correlation))
}

/// The limits of the frequencies: below half a wave a cell, and of a self-affine surface on the patch.
fn band(
    lowest: &Slot<'_>,
    highest: &Slot<'_>,
    pitch_um: f64,
    cells: u32,
    name: Option<ModelName>,
) -> Option<[Option<f64>; 2]> {
    let nyquist = 0.5 / pitch_um;
    let patch = 1.0 / (f64::from(cells) * pitch_um);
    let above = Bounds::closed(0.0, nyquist)
        .low_open()
        .advice("", "1/(2 pitch_um) is the most that cells of this pitch hold; take a smaller pitch_um");
    let high = highest.or(None, |i| i.float(&above).map(Some));
    if name == Some(ModelName::SelfAffine) {
        lowest
            .required("1/um, where the power law begins: a self-affine surface has no variance without it")?;
    }
    let low = lowest.or(None, |i| i.float(&above).map(Some))?;
    let high = high?;
    if let Some(low) = low.filter(|low| *low >= high.unwrap_or(nyquist)) {
        let end = high.map_or("1/(2 pitch_um)".into(), |high| format!("f_max_per_um = {}", plain(high)));
        return lowest.refuse(format!("must be below {end}: {} leaves no waves", plain(low)));
    }
    // The rms height is that of the whole power law.
    if let (Some(ModelName::SelfAffine), Some(low)) = (name, low)
        && low < patch * (1.0 - 1e-9)
    {
        return lowest.refuse(format!(
            "must be {} at least: the patch, cells x pitch_um, holds no longer waves; take more cells",
            plain(patch)
        ));
    }
    Some([low, high])
}

impl ModelKeys<'_> {
    fn model(&self, name: ModelName, rms_um: Option<f64>, folder: &Path) -> Option<PsdModel> {
        let absent = |slots: &[&Slot<'_>], of: &str| {
            let why = format!("belongs to model = \"{of}\"; leave it out here");
            slots
                .iter()
                .map(|slot| slot.absent(&why))
                .collect::<Vec<_>>()
                .into_iter()
                .collect::<Option<Vec<()>>>()
        };
        let [a, b, c] = &self.k_correlation;
        let table: Vec<&Slot<'_>> = self.table.iter().collect();
        let others = [
            (ModelName::KCorrelation, "k_correlation", vec![a, b, c]),
            (ModelName::SelfAffine, "self_affine", vec![&self.hurst]),
            (ModelName::Table, "table", table),
        ];
        let alone: Vec<_> = others
            .iter()
            .filter(|(other, ..)| *other != name)
            .map(|(_, of, slots)| absent(slots, of))
            .collect();
        let model = match name {
            ModelName::KCorrelation => {
                let a = a.required("A of A/(1 + (B f)^2)^(C/2), um^3").and_then(|i| i.float(&A_UM3));
                let b = b.required("B of it, um").and_then(|i| i.float(&B_UM));
                let c = c.required("C of it, above 1").and_then(|i| i.float(&C));
                Some(PsdModel::KCorrelation { a_um3: a?, b_um: b?, c: c? })
            }
            ModelName::SelfAffine => {
                let hurst =
                    self.hurst.required("Hurst's exponent, between 0 and 1").and_then(|i| i.float(&HURST));
                self.rms.required("root mean square height, um")?;
                self.lowest.given()?;
                Some(PsdModel::SelfAffine { rms_um: rms_um?, hurst: hurst? })
            }
            ModelName::Table => self.listed(folder).map(PsdModel::Table),
        };
        alone.into_iter().collect::<Option<Vec<_>>>()?;
        model
    }

    /// From a file, or from lists.
    fn listed(&self, folder: &Path) -> Option<PsdTable> {
        let [file, frequency, areal, profile] = &self.table;
        if let Some(item) = file.given() {
            let why = "a file is given as well: keep one of the two";
            [frequency, areal, profile].iter().map(|slot| slot.absent(why)).collect::<Option<Vec<()>>>()?;
            let name = item.text()?;
            if name.is_empty() || name.chars().any(char::is_control) {
                return item.refuse("must be a file name without control characters");
            }
            return match columns::read(&folder.join(name)) {
                Ok(table) => Some(table),
                Err(why) => item.refuse(why),
            };
        }
        let (kind, density) = match (areal.given(), profile.given()) {
            (Some(item), None) => (PsdKind::Areal, item),
            (None, Some(item)) => (PsdKind::Profile, item),
            (Some(_), Some(item)) => return item.refuse("ambiguous: give psd_um4 or psd_um3, never both"),
            (None, None) => {
                return file.refuse(
                    "required: a CSV file, or frequency_per_um with psd_um4 (areal) or psd_um3 (profile)",
                );
            }
        };
        let numbers = |item: &GivenValue<'_>| item.each(|i| i.float(&Bounds::closed(0.0, 1e300).low_open()));
        let frequency = frequency.required("1/um, increasing").and_then(numbers);
        let values = numbers(density);
        match PsdTable::new(kind, frequency?, values?) {
            Ok(table) => Some(table),
            Err(why) => density.refuse(why),
        }
    }
}

/// Whether the patches have the rms height that is given, and slopes that can be measured; notes what they lack.
fn agrees(item: &GivenValue<'_>, rms: &Slot<'_>, surface: &PsdSurface, cells: u32) -> Option<()> {
    let moments = PsdMoments::of(&surface.psd, cells, surface.pitch_um);
    let alpha = surface.alphas[0].x;
    if let Some(fault) = ALPHA.fault(alpha) {
        return item.refuse(format!(
            "has slopes of alpha {} (sqrt 2 times their rms), which {fault}: check the units, um",
            plain(alpha)
        ));
    }
    let asked = match &surface.psd.model {
        PsdModel::SelfAffine { rms_um, .. } => Some(*rms_um),
        _ => surface.rms_um,
    };
    let found = moments.rms_um;
    if let Some(asked) = asked.filter(|asked| (found / asked - 1.0).abs() > RMS_AGREES) {
        return rms.refuse(format!(
            "does not agree with the patches, whose waves have rms {found:.4e} um ({asked} um asked for): check units, \
             one- or two-sided, and that cells x pitch_um is several of the longest waves"
        ));
    }
    let [waves, facets] = [moments.wave_slope, moments.facet_slope];
    if waves > (1.0 + RESOLVED) * facets {
        item.note(format!(
            "rms slope {waves:.4} of the waves, {facets:.4} of the facets: cells do not resolve the shortest waves; take a \
             smaller pitch_um or lower f_max_per_um"
        ));
    }
    if let PsdModel::Table(table) = &surface.psd.model {
        let [_, highest] = table.ends();
        let nyquist = 0.5 / surface.pitch_um;
        if highest > nyquist && surface.psd.f_max_per_um.is_none() {
            item.note(format!("waves above {} /um, half of one a cell, are left out", plain(nyquist)));
        }
    }
    Some(())
}
