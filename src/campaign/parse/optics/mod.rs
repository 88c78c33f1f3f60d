//! `[optics]`: what facets do, materials by name, by F0 or by index, the law and the polarisation.

mod facets;
mod material_keys;

use super::reader::{GivenValue, Slot, TableReader};
use crate::campaign::schema::{FresnelLaw, Optics, Polarisation, RefractiveIndex};
use material_keys::MaterialKeys;

pub(crate) use material_keys::{Around, reflectances};

/// Words for [`FresnelLaw`].
pub(crate) const LAWS: [(&str, FresnelLaw); 2] =
    [("schlick", FresnelLaw::Schlick), ("exact", FresnelLaw::Exact)];

/// Words for [`Polarisation`].
pub(crate) const POLARISATIONS: [(&str, Polarisation); 4] = [
    ("none", Polarisation::None),
    ("s", Polarisation::S),
    ("p", Polarisation::P),
    ("mueller", Polarisation::Mueller),
];

/// Words for it at clear facets, where light is followed on both sides.
const CLEAR_POLARISATIONS: [(&str, Polarisation); 2] =
    [("none", Polarisation::None), ("mueller", Polarisation::Mueller)];

/// What facets do.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Facet {
    Mirror,
    Dielectric,
    Diffuse,
    Layered,
}

/// Words for it.
const FACETS: [(&str, Facet); 4] = [
    ("mirror", Facet::Mirror),
    ("dielectric", Facet::Dielectric),
    ("diffuse", Facet::Diffuse),
    ("layered", Facet::Layered),
];

/// Where `albedo` belongs.
const SCATTERING: &str = "belongs to facet = \"diffuse\" or \"layered\"";

/// Whether `[optics]` asks for facets that let light through. A word that cannot be read may have meant them: no fault
/// follows from another one.
pub(crate) fn lets_through(slot: &Slot<'_>) -> bool {
    let table = slot.given().filter(|item| item.is_table()).and_then(GivenValue::table);
    let opaque = |word: &str| FACETS.iter().any(|(known, kind)| *known == word && *kind != Facet::Dielectric);
    table.is_some_and(|table| {
        table.slot("facet").given().and_then(GivenValue::as_text).is_some_and(|word| !opaque(word))
    })
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
        Facet::Mirror => albedo.absent(SCATTERING)?,
        Facet::Dielectric => {
            let absent = [
                fresnel.absent("belongs to facet = \"mirror\": clear facets follow Fresnel's equations"),
                albedo.absent(SCATTERING),
            ];
            let polarisation = polarisation.or(Polarisation::None, |i| i.choice(&CLEAR_POLARISATIONS));
            let clear = source.clear(around, polarisation.unwrap_or(Polarisation::None));
            return clear.filter(|_| absent.iter().all(Option::is_some) && polarisation.is_some());
        }
        Facet::Diffuse => return source.diffuse(&albedo, &[&fresnel, &polarisation]),
        Facet::Layered => return source.layered(&albedo, &[&fresnel, &polarisation]),
    }
    let law = fresnel.or(FresnelLaw::Schlick, |i| i.choice(&LAWS));
    let polarisations = polarisation.or(vec![Polarisation::None], polarisations);
    // A law that cannot be read leaves the materials as they are: no fault follows from another one.
    let materials = source.read(law.unwrap_or(FresnelLaw::Schlick), around);
    let (law, polarisations) = (law?, polarisations?);
    let polarised = polarisations.iter().any(|p| *p != Polarisation::None);
    let by_plane = polarisations.iter().any(|p| matches!(p, Polarisation::S | Polarisation::P));
    if polarised && law == FresnelLaw::Schlick {
        return polarisation
            .refuse("must be \"none\": Schlick's formula knows no polarisation; fresnel = \"exact\" does");
    }
    if let (true, Some(orders @ 2..)) = (by_plane, around.orders) {
        return polarisation.refuse(format!(
            "must be \"none\" or \"mueller\" with bounces = {orders}: after one bounce light is partly polarised, and turned planes mix s and p"
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
    if read.len() > 1 && read.contains(&Polarisation::Mueller) {
        return item.refuse("must be \"mueller\" alone: its matrices hold unpolarised, s and p light");
    }
    Some(read)
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
