//! Reflectance at normal incidence of materials by name, for Schlick's Fresnel.
//!
//! Linear R, G, B: the usual rounded values of rendering courses and engines. Metals are coloured, the others gray.

/// Name and F0 of every known material.
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

/// F0 of a material by its name.
pub fn f0_of(name: &str) -> Option<[f64; 3]> {
    MATERIALS.iter().find(|(known, _)| *known == name).map(|(_, f0)| *f0)
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
    }
}
