//! What a facet does to light of one wavelength and polarisation.

use super::fresnel::{FacetAngle, Fresnel};

/// Which light is counted, by its field against the plane of incidence of the facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Field {
    /// Unpolarised: the mean of both.
    Both,
    /// Across the plane: s.
    Across,
    /// In the plane: p.
    Along,
}

/// Reflectance of a facet by its material and the light's polarisation.
///
/// At order 1 the plane of incidence of the facet is the plane of wi and wo: both hold its normal, their half vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflectance {
    /// The material.
    pub fresnel: Fresnel,
    /// The light.
    pub field: Field,
}

impl Reflectance {
    /// Of unpolarised light.
    pub fn unpolarised(fresnel: Fresnel) -> Self {
        Reflectance { fresnel, field: Field::Both }
    }

    /// The reflectance at an angle, [0, 1].
    // Tested by `s_and_p_add_up_to_unpolarised_light`.
    pub fn at(&self, angle: FacetAngle) -> f64 {
        match self.field {
            Field::Both => self.fresnel.reflectance(angle),
            Field::Across => self.fresnel.polarised(angle).s,
            Field::Along => self.fresnel.polarised(angle).p,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::sin_cos_deg;

    #[test]
    fn s_and_p_add_up_to_unpolarised_light() {
        let gold = Fresnel::Conductor { eta: 0.43, k: 2.455 };
        for fresnel in
            [gold, Fresnel::Dielectric { eta: 1.5 }, Fresnel::Schlick { f0: 0.3 }, Fresnel::Perfect]
        {
            for theta in [0.0, 30.0, 60.0, 85.0] {
                let (sin, cos) = sin_cos_deg(theta);
                let angle = FacetAngle { cos, sin2: sin * sin };
                let reflected = |field| Reflectance { fresnel, field }.at(angle);
                assert_eq!(
                    0.5 * (reflected(Field::Across) + reflected(Field::Along)),
                    reflected(Field::Both)
                );
                assert!(reflected(Field::Across) >= reflected(Field::Along));
            }
        }
    }
}
