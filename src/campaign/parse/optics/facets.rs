//! Facets that let light through, scatter it evenly, or do so below an interface.

use super::material_keys::{Around, MaterialKeys, distinct, reflectances};
use crate::campaign::materials;
use crate::campaign::parse::index_file::Dispersion;
use crate::campaign::parse::reader::{Bounds, GivenValue, Slot, plain};
use crate::campaign::schema::{Dielectric, LightSide, Medium, Optics, Polarisation};

impl MaterialKeys<'_> {
    /// Facets that scatter evenly.
    pub fn diffuse(&self, albedo: &Slot<'_>, others: &[&Slot<'_>]) -> Option<Optics> {
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

    /// A matt base under a clear interface: one index for all colours.
    pub fn layered(&self, albedo: &Slot<'_>, others: &[&Slot<'_>]) -> Option<Optics> {
        let MaterialKeys { material, materials, f0, eta, k, file, wavelength } = self;
        let why = "has no meaning with facet = \"layered\": eta or a clear material is its interface, albedo its base";
        let all = [materials, f0, k, file].into_iter().chain(others.iter().copied());
        let absent: Vec<Option<()>> = all.map(|slot| slot.absent(why)).collect();
        let interface = match (material.given(), eta.given()) {
            (Some(name), None) => self.interface_of(name),
            (Some(_), Some(eta)) => eta.refuse("ambiguous: give material or eta, never both"),
            (None, _) => {
                let clean = wavelength.absent("belongs to material: eta is one index for all colours");
                let eta = eta.required("the index of the interface, such as 1.5, or a clear material");
                eta.and_then(|item| item.float(&LAYER_ETA)).and_then(|eta| clean.map(|()| eta))
            }
        };
        let albedo =
            albedo.required("what the base reflects, such as 0.8 or [r, g, b]").and_then(reflectances);
        absent.into_iter().collect::<Option<Vec<()>>>()?;
        Some(Optics::Layered { albedo: albedo?, eta: interface? })
    }

    /// The index of a clear material at the one wavelength that is given, or at the green one.
    fn interface_of(&self, name: &GivenValue<'_>) -> Option<f64> {
        match self.chosen(&clear_material(name, "")?, Some(&materials::RGB_NM[1..2]))?[..] {
            [medium] => Some(medium.eta),
            _ => {
                self.wavelength.refuse("must hold one wavelength: an interface has one index for all colours")
            }
        }
    }

    /// Clear facets, one table for each material and side of the light.
    pub fn clear(&self, around: &Around<'_>, polarisation: Polarisation) -> Option<Optics> {
        self.f0.absent("belongs to facet = \"mirror\": give the index, eta or a material")?;
        self.k.absent("belongs to facet = \"mirror\": nothing goes through what absorbs")?;
        let named = |item: &GivenValue<'_>| {
            let media = self.chosen(&clear_material(item, ", or a file")?, Some(&materials::RGB_NM))?;
            Some((Some(item.text()?.to_string()), media))
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
                let (material, media) = (material.clone(), media.clone());
                Optics::Dielectric(Dielectric { material, media, light, polarisation })
            })
        };
        let mut each: Vec<Optics> = around.sides.iter().flat_map(|&side| of_side(side)).collect();
        if each.len() == 1 { each.pop() } else { Some(Optics::Several(each)) }
    }
}

/// The index of a layered facet's interface.
const LAYER_ETA: Bounds = Bounds::closed(1.0, 4.0)
    .low_open()
    .advice("the interface is denser than what lies above it", "nothing clear is as dense");

/// A clear material by its name; `besides`: what else may be given, next to eta.
fn clear_material(item: &GivenValue<'_>, besides: &str) -> Option<Dispersion> {
    let known = materials::clear(item.text()?);
    known.or_else(|| {
        let names = materials::clear_names().join(", ");
        item.refuse(format!("is no clear material known here: {names}; or give eta{besides}"))
    })
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
