//! Materials by name: reflectance at normal incidence for Schlick's Fresnel, n and k over wavelengths where they are
//! published, from `optical_constants`.

use serde::Serialize;

use super::optical_constants::{ICE, INDICES};
use super::parse::faults::nearest;
use super::parse::index_file::Dispersion;
use super::schema::Medium;

/// Name and F0 of every known material: linear R, G, B, the usual rounded values of rendering courses and engines.
/// Metals are coloured, the others gray.
pub const MATERIALS: [(&str, [f64; 3]); 13] = [
    ("gold", [1.0, 0.782, 0.344]),
    ("silver", [0.972, 0.960, 0.915]),
    ("aluminum", [0.913, 0.922, 0.924]),
    ("copper", [0.955, 0.638, 0.538]),
    ("nickel", [0.660, 0.609, 0.526]),
    ("chromium", [0.549, 0.556, 0.554]),
    ("iron", [0.562, 0.565, 0.578]),
    ("water", [0.02; 3]),
    ("glass", [0.04; 3]),
    ("plastic", [0.045; 3]),
    ("skin", [0.028; 3]),
    ("hair", [0.046; 3]),
    ("stone", [0.045; 3]),
];

/// What is known of a material, for a list of all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MaterialEntry {
    /// Its name.
    pub name: &'static str,
    /// F0, linear R, G, B.
    pub f0: Option<[f64; 3]>,
    /// Where n and k are known, nm.
    pub index_nm: Option<[f64; 2]>,
    /// Where n of a clear facet is known, nm.
    pub clear_nm: Option<[f64; 2]>,
    /// n of a clear facet at 550 nm.
    pub clear_n_550: Option<f64>,
}

/// Every material that has a name.
pub fn all() -> Vec<MaterialEntry> {
    let names = MATERIALS.iter().map(|(name, _)| *name);
    let others = clear_names().into_iter().filter(|name| f0_of(name).is_none());
    let range = |rows: Vec<Medium>| Some([rows.first()?.wavelength_nm?, rows.last()?.wavelength_nm?]);
    let entry = |name| MaterialEntry {
        name,
        f0: f0_of(name),
        index_nm: index_of(name).and_then(range),
        clear_nm: CLEAR
            .iter()
            .find(|(known, ..)| *known == name)
            .map(|(.., nm)| *nm)
            .or_else(|| (name == "ice").then(|| range(media(&ICE))).flatten()),
        clear_n_550: clear(name).and_then(|known| known.at(550.0)).map(|medium| medium.eta),
    };
    names.chain(others).map(entry).collect()
}

/// The name by which a material is known here: British and American spellings are one.
fn spelled(name: &str) -> &str {
    if name == "aluminium" { "aluminum" } else { name }
}

/// F0 of a material by its name.
pub fn f0_of(name: &str) -> Option<[f64; 3]> {
    let name = spelled(name);
    MATERIALS.iter().find(|(known, _)| *known == name).map(|(_, f0)| *f0)
}

/// F0 of a material by its name, or what is wrong with the name.
pub fn named(name: &str) -> Result<[f64; 3], String> {
    let names = MATERIALS.map(|(name, _)| name);
    f0_of(name).ok_or_else(|| {
        let guess = nearest(name, &names).map(|n| format!(" did you mean `{n}`?")).unwrap_or_default();
        format!("unknown material;{guess} known: {}", names.join(", "))
    })
}

/// The names whose n and k are known.
pub fn names_with_index() -> [&'static str; 8] {
    INDICES.map(|(name, _)| name)
}

/// n and k of a material by its name, at increasing wavelengths.
pub fn index_of(name: &str) -> Option<Vec<Medium>> {
    let name = spelled(name);
    let (_, rows) = INDICES.iter().find(|(known, _)| *known == name)?;
    Some(media(rows))
}

fn media(rows: &[[f64; 3]]) -> Vec<Medium> {
    rows.iter().map(|&[nm, eta, k]| Medium { wavelength_nm: Some(nm), eta, k }).collect()
}

/// Clear materials: n^2 - 1 = sum b l^2/(l^2 - c) with (b, c) for l in um, over these wavelengths in nm.
///
/// Glass: BK7 of the Schott catalogue. Plastic: PMMA, Sultanova, Kasarova, Nikolov 2009 (Acta Phys. Pol. A 116, 585).
/// Diamond: Peter 1923 (Z. Phys. 15, 358). Water: Daimon and Masumura 2007 (Appl. Opt. 46, 3811), 20 degrees C.
// Tested by `clear_materials_have_the_published_indices`.
pub const CLEAR: [ClearMaterial; 4] = [
    (
        "glass",
        &[(1.03961212, 0.00600069867), (0.231792344, 0.0200179144), (1.01046945, 103.560653)],
        [310.0, 2500.0],
    ),
    ("plastic", &[(1.1819, 0.011313)], [436.8, 1052.0]),
    ("diamond", &[(4.3356, 0.011236), (0.3306, 0.030625)], [226.0, 10_000.0]),
    (
        "water",
        &[
            (0.5684027565, 0.005101829712),
            (0.1726177391, 0.01821153936),
            (0.02086189578, 0.02620722293),
            (0.1130748688, 10.69792721),
        ],
        [182.0, 1129.0],
    ),
];

/// Its name, its terms, and where they hold.
pub type ClearMaterial = (&'static str, &'static [(f64, f64)], [f64; 2]);

/// The names of clear materials.
pub(crate) fn clear_names() -> Vec<&'static str> {
    CLEAR.iter().map(|(name, ..)| *name).chain(["ice"]).collect()
}

/// The index of a clear material by its name.
pub(crate) fn clear(name: &str) -> Option<Dispersion> {
    if name == "ice" {
        return Some(Dispersion::of(&media(&ICE)));
    }
    let (_, terms, range) = CLEAR.iter().find(|(known, ..)| *known == name)?;
    Some(Dispersion::sellmeier(terms.to_vec(), *range))
}

/// n of a clear material at the wavelengths that stand for B, G and R.
pub fn clear_rgb_of(name: &str) -> Option<Vec<Medium>> {
    let known = clear(name)?;
    RGB_NM.iter().map(|&nm| known.at(nm)).collect()
}

/// The wavelengths that stand for B, G and R, nm.
pub const RGB_NM: [f64; 3] = [450.0, 550.0, 650.0];

/// n and k for R, G and B, in this order.
pub fn rgb_of(name: &str) -> Option<Vec<Medium>> {
    let known = Dispersion::of(&index_of(name)?);
    RGB_NM.iter().rev().map(|&nm| known.at(nm)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_material_has_its_own_name_and_a_reflectance() {
        for (i, (name, f0)) in MATERIALS.iter().enumerate() {
            assert!(f0.iter().all(|f| (0.0..=1.0).contains(f)), "{name}");
            assert!(MATERIALS[..i].iter().all(|(other, _)| other != name), "{name}");
            assert_eq!(f0_of(name), Some(*f0));
        }
        assert_eq!(f0_of("unobtainium"), None);
        assert_eq!((f0_of("aluminium"), index_of("aluminium")), (f0_of("aluminum"), index_of("aluminum")));
    }

    #[test]
    fn indices_reflect_as_the_names_do() {
        for (name, f0) in MATERIALS {
            let Some(media) = index_of(name) else { continue };
            assert!(media.windows(2).all(|pair| pair[0].wavelength_nm < pair[1].wavelength_nm), "{name}");
            for (f0, nm) in f0.into_iter().zip([650.0, 550.0, 450.0]) {
                let Medium { eta, k, .. } = Dispersion::of(&media).at(nm).expect("visible");
                let found = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
                // Single wavelengths stand for broad R, G and B, and names for samples of other makers: both move a
                // metal's reflectance by up to a tenth.
                assert!((found - f0).abs() < 0.1, "{name} at {nm} nm: {found} for {f0}");
            }
        }
    }
}
