//! Facets that let light through or scatter it evenly.

use super::material_keys::{Around, MaterialKeys, distinct, reflectances};
use crate::campaign::materials;
use crate::campaign::parse::reader::{GivenValue, Slot, plain};
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

    /// Clear facets, one table for each material and side of the light.
    pub fn clear(&self, around: &Around<'_>, polarisation: Polarisation) -> Option<Optics> {
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
                let (material, media) = (material.clone(), media.clone());
                Optics::Dielectric(Dielectric { material, media, light, polarisation })
            })
        };
        let mut each: Vec<Optics> = around.sides.iter().flat_map(|&side| of_side(side)).collect();
        if each.len() == 1 { each.pop() } else { Some(Optics::Several(each)) }
    }
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
