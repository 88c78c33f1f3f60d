//! `[surface.artist]`: roughness, metalness and base colour as artists say them, as a GGX surface and Schlick's F0.

use super::optics::reflectances;
use super::reader::{Bounds, TableReader};
use crate::campaign::schema::Alpha;

/// alpha = roughness^2 within [1e-4, 1].
const ROUGHNESS: Bounds =
    Bounds::closed(0.01, 1.0).advice("a smooth mirror has no lobe to measure", "alpha is its square");
const SHARE: Bounds = Bounds::closed(0.0, 1.0);
/// Reflectance of what is no metal, at normal incidence.
const DIELECTRIC_F0: f64 = 0.04;

/// The roughness and F0 of R, G and B: alpha = roughness^2 and F0 = 0.04 (1 - metalness) + base_color metalness: the
/// one place where they are converted. What is no metal also scatters light below its surface; that part is not a
/// microfacet's and is left out.
pub(crate) fn artist(table: TableReader<'_>) -> Option<(Alpha, [f64; 3])> {
    let [roughness, metalness, base_color] = table.keys(["roughness", "metalness", "base_color"]);
    let rough = roughness.required("such as 0.4; alpha is its square").and_then(|i| i.float(&ROUGHNESS));
    let metal = metalness.or(1.0, |i| i.float(&SHARE));
    let base = base_color.required("[r, g, b], or one number").and_then(reflectances);
    let (rough, metal, base) = (rough?, metal?, base?);
    if metal < 1.0 {
        let given = metalness.given();
        given.inspect(|i| i.note("the diffuse part of what is no metal is not measured: facets are mirrors"));
    }
    let alpha = rough * rough;
    let f0 = base.map(|base| DIELECTRIC_F0 * (1.0 - metal) + base * metal);
    Some((Alpha::isotropic(alpha), f0))
}
