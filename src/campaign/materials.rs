//! Materials by name: reflectance at normal incidence for Schlick's Fresnel, n and k over wavelengths where they are
//! published.

use serde::Serialize;

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

/// The names whose n and k are known, and rows of [wavelength_nm, n, k] at increasing wavelengths about the visible ones.
///
/// From measured tables: P. B. Johnson, R. W. Christy, Phys. Rev. B 6, 4370 (1972) and 9, 5056 (1974); A. D. Rakic, Appl.
/// Opt. 34, 4755 (1995); G. M. Hale, M. R. Querry, Appl. Opt. 12, 555 (1973); rows as the refractiveindex.info database
/// (CC0) has them. Glass, plastic, skin, hair and stone are families without one index.
// Tested by `indices_reflect_as_the_names_do`.
const INDICES: [(&str, &[[f64; 3]]); 8] = [
    ("gold", &GOLD),
    ("silver", &SILVER),
    ("copper", &COPPER),
    ("nickel", &NICKEL),
    ("chromium", &CHROMIUM),
    ("iron", &IRON),
    ("aluminum", &ALUMINUM),
    ("water", &WATER),
];

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

/// Warren and Brandt 2008 (J. Geophys. Res. 113, D14220): nm, n, and no k.
const ICE: [[f64; 3]; 7] = [
    [400.0, 1.3194, 0.0],
    [450.0, 1.3157, 0.0],
    [500.0, 1.3130, 0.0],
    [550.0, 1.3110, 0.0],
    [600.0, 1.3094, 0.0],
    [650.0, 1.3080, 0.0],
    [700.0, 1.3069, 0.0],
];

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

/// Johnson and Christy 1972.
const GOLD: [[f64; 3]; 16] = [
    [367.9, 1.48, 1.895],
    [381.5, 1.46, 1.933],
    [397.4, 1.47, 1.952],
    [413.3, 1.46, 1.958],
    [430.5, 1.45, 1.948],
    [450.9, 1.38, 1.914],
    [471.4, 1.31, 1.849],
    [495.9, 1.04, 1.833],
    [520.9, 0.62, 2.081],
    [548.6, 0.43, 2.455],
    [582.1, 0.29, 2.863],
    [616.8, 0.21, 3.272],
    [659.5, 0.14, 3.697],
    [704.5, 0.13, 4.103],
    [756.0, 0.14, 4.542],
    [821.1, 0.16, 5.083],
];

/// Johnson and Christy 1972.
const SILVER: [[f64; 3]; 16] = [
    [367.9, 0.07, 1.657],
    [381.5, 0.05, 1.864],
    [397.4, 0.05, 2.07],
    [413.3, 0.05, 2.275],
    [430.5, 0.04, 2.462],
    [450.9, 0.04, 2.657],
    [471.4, 0.05, 2.869],
    [495.9, 0.05, 3.093],
    [520.9, 0.05, 3.324],
    [548.6, 0.06, 3.586],
    [582.1, 0.05, 3.858],
    [616.8, 0.06, 4.152],
    [659.5, 0.05, 4.483],
    [704.5, 0.04, 4.838],
    [756.0, 0.03, 5.242],
    [821.1, 0.04, 5.727],
];

/// Johnson and Christy 1972.
const COPPER: [[f64; 3]; 16] = [
    [367.9, 1.36, 1.975],
    [381.5, 1.33, 2.045],
    [397.4, 1.32, 2.116],
    [413.3, 1.28, 2.207],
    [430.5, 1.25, 2.305],
    [450.9, 1.24, 2.397],
    [471.4, 1.25, 2.483],
    [495.9, 1.22, 2.564],
    [520.9, 1.18, 2.608],
    [548.6, 1.02, 2.577],
    [582.1, 0.7, 2.704],
    [616.8, 0.3, 3.205],
    [659.5, 0.22, 3.747],
    [704.5, 0.21, 4.205],
    [756.0, 0.24, 4.665],
    [821.1, 0.26, 5.18],
];

/// Johnson and Christy 1974.
const NICKEL: [[f64; 3]; 16] = [
    [368.0, 1.7, 2.4],
    [381.0, 1.72, 2.48],
    [397.0, 1.72, 2.57],
    [413.0, 1.7, 2.69],
    [431.0, 1.71, 2.82],
    [451.0, 1.73, 2.95],
    [471.0, 1.78, 3.09],
    [496.0, 1.82, 3.25],
    [521.0, 1.85, 3.42],
    [549.0, 1.92, 3.61],
    [582.0, 1.96, 3.8],
    [617.0, 1.99, 4.02],
    [659.0, 1.99, 4.26],
    [704.0, 2.06, 4.5],
    [756.0, 2.13, 4.73],
    [821.0, 2.26, 4.97],
];

/// Johnson and Christy 1974.
#[allow(clippy::approx_constant)] // 3.14 is a k.
const CHROMIUM: [[f64; 3]; 16] = [
    [368.0, 1.87, 2.69],
    [381.0, 1.92, 2.74],
    [397.0, 2.0, 2.83],
    [413.0, 2.08, 2.93],
    [431.0, 2.19, 3.04],
    [451.0, 2.33, 3.14],
    [471.0, 2.51, 3.24],
    [496.0, 2.75, 3.3],
    [521.0, 2.94, 3.33],
    [549.0, 3.18, 3.33],
    [582.0, 3.22, 3.3],
    [617.0, 3.17, 3.3],
    [659.0, 3.09, 3.34],
    [704.0, 3.05, 3.39],
    [756.0, 3.08, 3.42],
    [821.0, 3.2, 3.48],
];

/// Johnson and Christy 1974.
const IRON: [[f64; 3]; 16] = [
    [368.0, 2.02, 2.43],
    [381.0, 2.12, 2.5],
    [397.0, 2.24, 2.58],
    [413.0, 2.35, 2.65],
    [431.0, 2.48, 2.71],
    [451.0, 2.59, 2.77],
    [471.0, 2.67, 2.82],
    [496.0, 2.74, 2.88],
    [521.0, 2.86, 2.91],
    [549.0, 2.95, 2.93],
    [582.0, 2.94, 2.99],
    [617.0, 2.88, 3.05],
    [659.0, 2.92, 3.1],
    [704.0, 2.86, 3.19],
    [756.0, 2.87, 3.28],
    [821.0, 2.94, 3.39],
];

/// Rakic 1995.
const ALUMINUM: [[f64; 3]; 13] = [
    [364.66, 0.39877, 4.3957],
    [413.28, 0.52135, 5.0008],
    [442.8, 0.6079, 5.3676],
    [476.87, 0.7278, 5.7781],
    [516.6, 0.8734, 6.2418],
    [563.57, 1.0728, 6.7839],
    [619.93, 1.366, 7.4052],
    [652.25, 1.5724, 7.7354],
    [688.81, 1.8301, 8.0601],
    [729.32, 2.1606, 8.3565],
    [774.91, 2.6154, 8.4914],
    [794.78, 2.7675, 8.3866],
    [815.69, 2.7668, 8.2573],
];

/// Hale and Querry 1973; what water absorbs over a wavelength is below 2e-7 and left out.
const WATER: [[f64; 3]; 19] = [
    [375.0, 1.341, 0.0],
    [400.0, 1.339, 0.0],
    [425.0, 1.338, 0.0],
    [450.0, 1.337, 0.0],
    [475.0, 1.336, 0.0],
    [500.0, 1.335, 0.0],
    [525.0, 1.334, 0.0],
    [550.0, 1.333, 0.0],
    [575.0, 1.333, 0.0],
    [600.0, 1.332, 0.0],
    [625.0, 1.332, 0.0],
    [650.0, 1.331, 0.0],
    [675.0, 1.331, 0.0],
    [700.0, 1.331, 0.0],
    [725.0, 1.33, 0.0],
    [750.0, 1.33, 0.0],
    [775.0, 1.33, 0.0],
    [800.0, 1.329, 0.0],
    [825.0, 1.329, 0.0],
];

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
