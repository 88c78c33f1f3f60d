//! Materials by name, by F0, by index or from a file.

use std::path::Path;

use crate::campaign::materials;
use crate::campaign::parse::index_file;
use crate::campaign::parse::index_file::{Dispersion, ETA, K, WAVELENGTH};
use crate::campaign::parse::lists::ranges::{self, refuse_at};
use crate::campaign::parse::reader::{Bounds, GivenValue, Slot, plain};
use crate::campaign::schema::{FresnelLaw, LightSide, Medium, Optics, Polarisation, RefractiveIndex};

const REFLECTANCE: Bounds = Bounds::closed(0.0, 1.0);

/// Most colours of a table.
const MOST_COLOURS: usize = 100;

/// What the materials depend on.
pub(crate) struct Around<'a> {
    /// Where files are looked for.
    pub folder: &'a Path,
    /// Highest order, where it is known.
    pub orders: Option<u32>,
    /// Where the light comes from.
    pub sides: Vec<LightSide>,
}

/// The keys that say which material.
pub(super) struct MaterialKeys<'a> {
    pub material: Slot<'a>,
    pub materials: Slot<'a>,
    pub f0: Slot<'a>,
    pub eta: Slot<'a>,
    pub k: Slot<'a>,
    pub file: Slot<'a>,
    pub wavelength: Slot<'a>,
}

impl MaterialKeys<'_> {
    /// Every material with a table of its own.
    pub fn read(&self, law: FresnelLaw, around: &Around<'_>) -> Option<Vec<Optics>> {
        let ways = [&self.material, &self.materials, &self.f0, &self.eta, &self.file];
        let given: Vec<&GivenValue<'_>> = ways.into_iter().filter_map(Slot::given).collect();
        if self.k.given().is_some() && self.eta.given().is_none() {
            return self.k.refuse("belongs to eta; give both");
        }
        match given[..] {
            [] => self
                .material
                .refuse("required: material, f0, eta or file; leave out [optics] altogether for F = 1"),
            [item] => match item.name() {
                "material" => self.named(item, law).map(|one| vec![one]),
                "materials" => self.several(item, law),
                "f0" => {
                    let clean = self.wavelength.absent("belongs to eta, file or fresnel = \"exact\"");
                    let f0 = reflectances(item)?;
                    clean.map(|()| vec![Optics::Schlick { material: None, f0 }])
                }
                "file" => self.file(item, around).map(|media| vec![index(None, media, law)]),
                _ => self.listed(item).map(|media| vec![index(None, media, law)]),
            },
            [first, second, ..] => {
                second.refuse(format!("ambiguous: give {} or {}, never both", first.name(), second.name()))
            }
        }
    }

    /// A material by its name.
    pub fn named(&self, item: &GivenValue<'_>, law: FresnelLaw) -> Option<Optics> {
        let name = item.text()?;
        let f0 = match materials::named(name) {
            Ok(f0) => f0,
            Err(why) => return item.refuse(why),
        };
        if law == FresnelLaw::Schlick {
            self.wavelength
                .absent("belongs to eta, file or fresnel = \"exact\": a name's F0 is that of R, G and B")?;
            return Some(Optics::Schlick { material: Some(name.to_string()), f0 });
        }
        let Some(known) = materials::index_of(name) else {
            let names = materials::names_with_index().join(", ");
            return item.refuse(format!(
                "has no n and k here, which fresnel = \"exact\" needs; known: {names}; or give eta and k, or a file"
            ));
        };
        let media = self.chosen(&Dispersion::of(&known), Some(&materials::RGB_NM))?;
        Some(index(Some(name.to_string()), media, law))
    }

    pub fn several(&self, item: &GivenValue<'_>, law: FresnelLaw) -> Option<Vec<Optics>> {
        distinct(item, item.each(|i| self.named(i, law))?, |a, b| a.material() == b.material())
    }

    /// `file`: all its lines, or the wavelengths that are asked for.
    pub fn file(&self, item: &GivenValue<'_>, around: &Around<'_>) -> Option<Vec<Medium>> {
        let name = item.text()?;
        if name.is_empty() || name.chars().any(char::is_control) {
            return item.refuse("must be a file name without control characters");
        }
        match index_file::read(&around.folder.join(name)) {
            Ok(known) => self.chosen(&known, None),
            Err(why) => item.refuse(why),
        }
    }

    /// The media at `wavelength_nm`; where it is left out at the `default` ones, or at all that are known.
    pub fn chosen(&self, known: &Dispersion, default: Option<&[f64]>) -> Option<Vec<Medium>> {
        let Some(item) = self.wavelength.given() else {
            let Some(default) = default else { return self.all_of(known) };
            return default.iter().map(|&nm| known.at(nm)).collect();
        };
        let nm = increasing(item)?;
        let found = nm.into_iter().enumerate().map(|(at, nm)| {
            known.at(nm).or_else(|| {
                let [low, high] = known.ends().map(plain);
                refuse_at(item, at, format!("must lie in [{low}, {high}]: n and k are not known elsewhere"))
            })
        });
        found.collect::<Vec<_>>().into_iter().collect()
    }

    /// All wavelengths that a file holds.
    pub fn all_of(&self, known: &Dispersion) -> Option<Vec<Medium>> {
        let media = known.points();
        match media.len() {
            0 => self.wavelength.refuse("required: the file holds no wavelengths of its own; choose some"),
            1..=MOST_COLOURS => Some(media),
            count => self.wavelength.refuse(format!(
                "required: the file holds {count} wavelengths and a table at most {MOST_COLOURS}; choose among them"
            )),
        }
    }

    /// `eta` and `k`: one index, or one for each wavelength.
    pub fn listed(&self, eta: &GivenValue<'_>) -> Option<Vec<Medium>> {
        let medium = |wavelength_nm, eta, k| Medium { wavelength_nm, eta, k };
        if eta.list_length().is_none() && !eta.is_table() && self.wavelength.given().is_none() {
            let (n, k) = (eta.float(&ETA), self.k.or(0.0, |i| i.float(&K)));
            let (n, k) = (n?, k?);
            return if n == 1.0 && k == 0.0 {
                eta.refuse(NO_SURFACE)
            } else {
                Some(vec![medium(None, n, k)])
            };
        }
        let n = numbers(eta, &ETA);
        let count = n.as_ref().map_or(eta.list_length().unwrap_or(1), Vec::len);
        let k = self.k.or(vec![0.0; count], |i| numbers(i, &K));
        let nm = self.wavelength.required("a wavelength for each entry of eta").and_then(increasing);
        let (n, k, nm) = (n?, k?, nm?);
        for (slot, length) in [(&self.k, k.len()), (&self.wavelength, nm.len())] {
            if length != count {
                return slot
                    .refuse(format!("has {length} entries, eta has {count}: one for each wavelength"));
            }
        }
        if let Some(at) = (0..count).find(|&at| n[at] == 1.0 && k[at] == 0.0) {
            return refuse_at(eta, at, NO_SURFACE);
        }
        Some((0..count).map(|at| medium(Some(nm[at]), n[at], k[at])).collect())
    }
}

/// At least one material, each once.
pub(super) fn distinct<T>(
    item: &GivenValue<'_>,
    all: Vec<T>,
    same: impl Fn(&T, &T) -> bool,
) -> Option<Vec<T>> {
    for (k, one) in all.iter().enumerate() {
        if all[..k].iter().any(|other| same(other, one)) {
            return item.list()?[k].refuse("is there already: one table is made for each material");
        }
    }
    if all.is_empty() {
        return item.refuse("must not be empty; one table is made for each material");
    }
    Some(all)
}

const NO_SURFACE: &str = "eta = 1 with k = 0 is no surface: it reflects nothing";

fn index(material: Option<String>, media: Vec<Medium>, law: FresnelLaw) -> Optics {
    Optics::Index(RefractiveIndex { material, media, law, polarisation: Polarisation::None })
}

/// A number, a list or a range: at least one number and at most as many as a table has colours.
fn numbers(item: &GivenValue<'_>, bounds: &Bounds) -> Option<Vec<f64>> {
    let count = item.list_length().unwrap_or(1);
    if !(1..=MOST_COLOURS).contains(&count) {
        return item.refuse(format!("has {count} entries; 1 to {MOST_COLOURS} are allowed"));
    }
    ranges::numbers(item, bounds, MOST_COLOURS)
}

/// Wavelengths, which increase.
fn increasing(item: &GivenValue<'_>) -> Option<Vec<f64>> {
    let nm = numbers(item, &WAVELENGTH)?;
    if let Some(before) = nm.windows(2).position(|pair| pair[0] >= pair[1]) {
        let earlier = plain(nm[before]);
        let fault = format!("comes after {earlier}; wavelengths must increase, each once");
        return refuse_at(item, before + 1, fault);
    }
    Some(nm)
}

/// One reflectance for all colours, or three.
pub(crate) fn reflectances(item: &GivenValue<'_>) -> Option<[f64; 3]> {
    match item.list_length() {
        None => item.float(&REFLECTANCE).map(|gray| [gray; 3]),
        Some(3) => item.each(|i| i.float(&REFLECTANCE))?.try_into().ok(),
        Some(n) => item.refuse(format!("has {n} entries; give [r, g, b] or one number")),
    }
}
