//! `[optics]`: materials by name, by F0 or by index, the law and the polarisation.

use std::path::Path;

use super::index_file;
use super::index_file::{Dispersion, ETA, K, WAVELENGTH};
use super::reader::{Bounds, GivenValue, Slot, TableReader, plain};
use crate::campaign::materials;
use crate::campaign::schema::{
    Dielectric, FresnelLaw, LightSide, Medium, Optics, Polarisation, RefractiveIndex,
};

const REFLECTANCE: Bounds = Bounds::closed(0.0, 1.0);

/// Words for [`FresnelLaw`].
pub(crate) const LAWS: [(&str, FresnelLaw); 2] =
    [("schlick", FresnelLaw::Schlick), ("exact", FresnelLaw::Exact)];

/// Words for [`Polarisation`].
pub(crate) const POLARISATIONS: [(&str, Polarisation); 3] =
    [("none", Polarisation::None), ("s", Polarisation::S), ("p", Polarisation::P)];

/// What facets do.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Facet {
    Mirror,
    Dielectric,
    Diffuse,
}

/// Words for it.
const FACETS: [(&str, Facet); 3] =
    [("mirror", Facet::Mirror), ("dielectric", Facet::Dielectric), ("diffuse", Facet::Diffuse)];

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

/// Whether `[optics]` asks for facets that let light through.
pub(crate) fn lets_through(slot: &Slot<'_>) -> bool {
    let table = slot.given().filter(|item| item.is_table()).and_then(GivenValue::table);
    table.is_some_and(|table| table.slot("facet").given().and_then(GivenValue::as_text) == Some("dielectric"))
}

/// Reads `[optics]`; `artist_f0` is what the facets of `[surface.artist]` reflect.
pub(crate) fn optics(slot: &Slot<'_>, artist_f0: Option<[f64; 3]>, around: &Around<'_>) -> Option<Optics> {
    match (slot.given(), artist_f0) {
        (Some(item), None) => given(item.table()?, around),
        (Some(item), Some(_)) => {
            item.refuse("[surface.artist] says what the facets reflect; leave out one of the two")
        }
        (None, Some(f0)) => Some(Optics::Schlick { material: None, f0 }),
        (None, None) => Some(Optics::PerfectMirror),
    }
}

/// The keys that say which material.
struct MaterialKeys<'a> {
    material: Slot<'a>,
    materials: Slot<'a>,
    f0: Slot<'a>,
    eta: Slot<'a>,
    k: Slot<'a>,
    file: Slot<'a>,
    wavelength: Slot<'a>,
}

fn given(table: TableReader<'_>, around: &Around<'_>) -> Option<Optics> {
    let [material, materials, f0, eta, k, file, wavelength, fresnel, polarisation, facet, albedo] = table
        .keys([
            "material",
            "materials",
            "f0",
            "eta",
            "k",
            "file",
            "wavelength_nm",
            "fresnel",
            "polarisation",
            "facet",
            "albedo",
        ]);
    let source = MaterialKeys { material, materials, f0, eta, k, file, wavelength };
    match facet.or(Facet::Mirror, |i| i.choice(&FACETS))? {
        Facet::Mirror => albedo.absent("belongs to facet = \"diffuse\"")?,
        Facet::Dielectric => {
            let why = "belongs to facet = \"mirror\": clear facets follow Fresnel's equations, unpolarised";
            let absent = [&fresnel, &polarisation].map(|slot| slot.absent(why));
            let albedo = albedo.absent("belongs to facet = \"diffuse\"");
            return source.clear(around).filter(|_| absent.iter().all(Option::is_some) && albedo.is_some());
        }
        Facet::Diffuse => return source.diffuse(&albedo, &[&fresnel, &polarisation]),
    }
    let law = fresnel.or(FresnelLaw::Schlick, |i| i.choice(&LAWS));
    let polarisations = polarisation.or(vec![Polarisation::None], polarisations);
    // A law that cannot be read leaves the materials as they are: no fault follows from another one.
    let materials = source.read(law.unwrap_or(FresnelLaw::Schlick), around);
    let (law, polarisations) = (law?, polarisations?);
    let polarised = polarisations.iter().any(|p| *p != Polarisation::None);
    if polarised && law == FresnelLaw::Schlick {
        return polarisation
            .refuse("must be \"none\": Schlick's formula knows no polarisation; fresnel = \"exact\" does");
    }
    if let (true, Some(orders @ 2..)) = (polarised, around.orders) {
        return polarisation.refuse(format!(
            "must be \"none\" with bounces = {orders}: after one bounce light is partly polarised, and turned planes mix s and p"
        ));
    }
    let materials = materials?;
    if law == FresnelLaw::Exact && matches!(materials[0], Optics::Schlick { .. }) {
        return source
            .f0
            .refuse("holds no n and k: fresnel = \"exact\" needs a material with an index, or eta and k");
    }
    let polarise = |optics: &Optics, polarisation: Polarisation| match optics {
        Optics::Index(index) => Optics::Index(RefractiveIndex { polarisation, ..index.clone() }),
        other => other.clone(),
    };
    let mut all: Vec<Optics> =
        materials.iter().flat_map(|optics| polarisations.iter().map(|&p| polarise(optics, p))).collect();
    if all.len() == 1 { all.pop() } else { Some(Optics::Several(all)) }
}

/// One word, or several that differ.
fn polarisations(item: &GivenValue<'_>) -> Option<Vec<Polarisation>> {
    if item.list_length().is_none() {
        return item.choice(&POLARISATIONS).map(|one| vec![one]);
    }
    let read = item.each(|i| i.choice(&POLARISATIONS))?;
    if read.is_empty() || (1..read.len()).any(|k| read[..k].contains(&read[k])) {
        return item.refuse("must hold each polarisation once: one table is made for each");
    }
    Some(read)
}

impl MaterialKeys<'_> {
    /// Facets that scatter evenly.
    fn diffuse(&self, albedo: &Slot<'_>, others: &[&Slot<'_>]) -> Option<Optics> {
        let MaterialKeys { material, materials, f0, eta, k, file, wavelength } = self;
        let all =
            [material, materials, f0, eta, k, file, wavelength].into_iter().chain(others.iter().copied());
        let why = "has no meaning with facet = \"diffuse\"; albedo says what its facets reflect";
        let absent: Vec<Option<()>> = all.map(|slot| slot.absent(why)).collect();
        let albedo =
            albedo.required("what a facet reflects, such as 0.8 or [r, g, b]").and_then(reflectances);
        absent.into_iter().collect::<Option<Vec<()>>>()?;
        Some(Optics::Diffuse { albedo: albedo? })
    }

    /// Clear facets, one table for each material and side of the light.
    fn clear(&self, around: &Around<'_>) -> Option<Optics> {
        self.f0.absent("belongs to facet = \"mirror\": give the index, eta or a material")?;
        self.k.absent("belongs to facet = \"mirror\": nothing goes through what absorbs")?;
        let named = |item: &GivenValue<'_>| {
            let name = item.text()?;
            let Some(known) = materials::clear(name) else {
                let names = materials::clear_names().join(", ");
                return item
                    .refuse(format!("is no clear material known here: {names}; or give eta, or a file"));
            };
            let media = self.chosen(&known, Some(&materials::RGB_NM))?;
            Some((Some(name.to_string()), media))
        };
        let given = [&self.material, &self.materials, &self.eta, &self.file];
        let given: Vec<&GivenValue<'_>> = given.into_iter().filter_map(Slot::given).collect();
        let all = match given[..] {
            [] => self
                .eta
                .refuse("required: eta, material or file: the index of the inside over the outside")?,
            [item] => match item.name() {
                "material" => vec![named(item)?],
                "materials" => distinct(item, item.each(named)?, |a, b| a.0 == b.0)?,
                "file" => vec![(None, without_absorption(item, self.file(item, around)?)?)],
                _ => vec![(None, self.listed(item)?)],
            },
            [first, second, ..] => {
                second.refuse(format!("ambiguous: give {} or {}, never both", first.name(), second.name()))?
            }
        };
        let of_side = |light: LightSide| {
            all.iter().map(move |(material, media)| {
                Optics::Dielectric(Dielectric { material: material.clone(), media: media.clone(), light })
            })
        };
        let mut each: Vec<Optics> = around.sides.iter().flat_map(|&side| of_side(side)).collect();
        if each.len() == 1 { each.pop() } else { Some(Optics::Several(each)) }
    }

    /// Every material with a table of its own.
    fn read(&self, law: FresnelLaw, around: &Around<'_>) -> Option<Vec<Optics>> {
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
    fn named(&self, item: &GivenValue<'_>, law: FresnelLaw) -> Option<Optics> {
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

    fn several(&self, item: &GivenValue<'_>, law: FresnelLaw) -> Option<Vec<Optics>> {
        distinct(item, item.each(|i| self.named(i, law))?, |a, b| a.material() == b.material())
    }

    /// `file`: all its lines, or the wavelengths that are asked for.
    fn file(&self, item: &GivenValue<'_>, around: &Around<'_>) -> Option<Vec<Medium>> {
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
    fn chosen(&self, known: &Dispersion, default: Option<&[f64]>) -> Option<Vec<Medium>> {
        let Some(item) = self.wavelength.given() else {
            let Some(default) = default else { return self.all_of(known) };
            return default.iter().map(|&nm| known.at(nm)).collect();
        };
        let nm = increasing(item)?;
        let found = item.list()?.into_iter().zip(nm).map(|(element, nm)| {
            known.at(nm).or_else(|| {
                let [low, high] = known.ends().map(plain);
                element.refuse(format!("must lie in [{low}, {high}]: n and k are not known elsewhere"))
            })
        });
        found.collect::<Vec<_>>().into_iter().collect()
    }

    /// All wavelengths that a file holds.
    fn all_of(&self, known: &Dispersion) -> Option<Vec<Medium>> {
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
    fn listed(&self, eta: &GivenValue<'_>) -> Option<Vec<Medium>> {
        let medium = |wavelength_nm, eta, k| Medium { wavelength_nm, eta, k };
        if eta.list_length().is_none() {
            let clean = self.wavelength.absent("belongs to lists of eta and k");
            let (n, k) = (eta.float(&ETA), self.k.or(0.0, |i| i.float(&K)));
            let (n, k, ()) = (n?, k?, clean?);
            return if n == 1.0 && k == 0.0 {
                eta.refuse(NO_SURFACE)
            } else {
                Some(vec![medium(None, n, k)])
            };
        }
        let count = eta.list_length().unwrap_or_default();
        let n = numbers(eta, &ETA);
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
            return eta.list()?[at].refuse(NO_SURFACE);
        }
        Some((0..count).map(|at| medium(Some(nm[at]), n[at], k[at])).collect())
    }
}

/// At least one material, each once.
fn distinct<T>(item: &GivenValue<'_>, all: Vec<T>, same: impl Fn(&T, &T) -> bool) -> Option<Vec<T>> {
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

/// Largest k of a medium that is clear: over a facet of many wavelengths hardly anything is lost, and F differs by less
/// than 1e-7.
const CLEAR_K: f64 = 1e-6;

/// Media of a file for clear facets: their k must be as good as none.
fn without_absorption(item: &GivenValue<'_>, media: Vec<Medium>) -> Option<Vec<Medium>> {
    if let Some(absorbs) = media.iter().find(|medium| medium.k > CLEAR_K) {
        let (k, nm) = (
            plain(absorbs.k),
            absorbs.wavelength_nm.map_or(String::new(), |nm| format!(" at {} nm", plain(nm))),
        );
        return item.refuse(format!("has k = {k}{nm}; clear facets absorb nothing: k <= {CLEAR_K}"));
    }
    Some(media.into_iter().map(|medium| Medium { k: 0.0, ..medium }).collect())
}

const NO_SURFACE: &str = "eta = 1 with k = 0 is no surface: it reflects nothing";

fn index(material: Option<String>, media: Vec<Medium>, law: FresnelLaw) -> Optics {
    Optics::Index(RefractiveIndex { material, media, law, polarisation: Polarisation::None })
}

/// A list of at least one number and at most as many as a table has colours.
fn numbers(item: &GivenValue<'_>, bounds: &Bounds) -> Option<Vec<f64>> {
    let count = item.list()?.len();
    if !(1..=MOST_COLOURS).contains(&count) {
        return item.refuse(format!("has {count} entries; 1 to {MOST_COLOURS} are allowed"));
    }
    item.each(|i| i.float(bounds))
}

/// Wavelengths, which increase.
fn increasing(item: &GivenValue<'_>) -> Option<Vec<f64>> {
    let nm = numbers(item, &WAVELENGTH)?;
    if let Some(before) = nm.windows(2).position(|pair| pair[0] >= pair[1]) {
        let earlier = plain(nm[before]);
        return item.list()?[before + 1]
            .refuse(format!("comes after {earlier}; wavelengths must increase, each once"));
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

/// The law of some materials, and the polarisations that each of them is measured in.
pub(crate) fn law_of(optics: &Optics) -> (FresnelLaw, Vec<Polarisation>) {
    let mut law = FresnelLaw::Schlick;
    let mut polarisations = Vec::new();
    for one in optics.each() {
        let of_this = match one {
            Optics::Index(index) => {
                law = index.law;
                index.polarisation
            }
            _ => Polarisation::None,
        };
        if !polarisations.contains(&of_this) {
            polarisations.push(of_this);
        }
    }
    (law, polarisations)
}
