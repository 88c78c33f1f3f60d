//! The microfacet models over the bins of one incidence, for every colour of a table.

use glam::DVec3;

use super::bin_mean::{BinMean, BinMeans, MASKINGS};
use super::bin_mean_diffuse::diffuse_means;
use super::formulas::{DiffuseModel, formula_means};
use crate::instrument::Region;
use crate::optics::Fresnel;
use crate::optics::layered::Interface;
use crate::optics::reflectance::Reflectance;
use crate::theory::{Masking, Microfacet};

/// The means of at most `MASKINGS` maskings: \[masking\]\[colour\]\[bin\]. Below the horizon: of what clear facets let
/// through.
pub(super) fn microfacet_means(
    surface: &Microfacet,
    maskings: &[Masking],
    source: &[(DVec3, f64)],
    regions: &[Region],
    colours: &[Reflectance],
) -> Vec<Vec<Vec<f64>>> {
    let means = BinMeans::new(maskings.to_vec());
    let (below, above): (Vec<usize>, Vec<usize>) =
        (0..regions.len()).partition(|&bin| regions[bin].is_below());
    let [regions_below, regions_above] =
        [&below, &above].map(|bins| bins.iter().map(|&bin| regions[bin]).collect::<Vec<_>>());
    let schlick = means.evaluate(surface, source, &regions_above);
    let mut all = vec![vec![vec![0.0; regions.len()]; colours.len()]; maskings.len()];
    for (colour, &reflectance) in colours.iter().enumerate() {
        let reflected = reflected_means(&means, surface, source, &regions_above, reflectance, &schlick);
        for (&bin, values) in above.iter().zip(reflected) {
            (0..maskings.len()).for_each(|k| all[k][colour][bin] = values[k]);
        }
        let Fresnel::Dielectric { eta } = reflectance.fresnel else { continue };
        let through = means.evaluate_through(surface, source, &regions_below, eta);
        for (&bin, mean) in below.iter().zip(through) {
            (0..maskings.len()).for_each(|k| all[k][colour][bin] = mean.values[k]);
        }
    }
    all
}

/// The means of one colour over the regions, in the order of the maskings; `schlick`: those with (1 - c)^5.
fn reflected_means(
    means: &BinMeans,
    surface: &Microfacet,
    source: &[(DVec3, f64)],
    regions: &[Region],
    colour: Reflectance,
    schlick: &[BinMean],
) -> Vec<[f64; MASKINGS]> {
    let of = |bins: &[BinMean], value: &dyn Fn(usize, &BinMean) -> f64| {
        bins.iter().map(|bin| std::array::from_fn(|k| value(k, bin))).collect()
    };
    match colour.fresnel {
        Fresnel::Perfect => of(schlick, &|k, bin| bin.unit[k]),
        Fresnel::Schlick { f0 } => of(schlick, &|k, bin| bin.with_f0(k, f0)),
        _ => {
            let means = BinMeans { reflectance: Some(colour), ..means.clone() };
            of(&means.evaluate(surface, source, regions), &|k, bin| bin.schlick[k])
        }
    }
}

/// The means of matt facets, under an interface where there is one (without its mirror term): \[masking\]\[colour\]\[bin\].
pub(super) fn diffuse_means_by_colour(
    surface: &Microfacet,
    maskings: &[Masking],
    source: &[(DVec3, f64)],
    regions: &[Region],
    (colours, interface): (&[Reflectance], Option<Interface>),
) -> Vec<Vec<Vec<f64>>> {
    let unit = diffuse_means(surface, maskings, source, regions, interface);
    coloured(&unit, maskings.len(), colours)
}

/// The means of the models that know no masking: \[formula\]\[colour\]\[bin\].
pub(super) fn formula_means_by_colour(
    surface: &Microfacet,
    source: &[(DVec3, f64)],
    regions: &[Region],
    colours: &[Reflectance],
) -> Vec<Vec<Vec<f64>>> {
    coloured(&formula_means(surface, source, regions), DiffuseModel::ALL.len(), colours)
}

/// Means for an albedo of 1, \[bin\]\[model\], as \[model\]\[colour\]\[bin\]; of the first `models`.
fn coloured<const N: usize>(unit: &[[f64; N]], models: usize, colours: &[Reflectance]) -> Vec<Vec<Vec<f64>>> {
    let of = |model: usize, albedo: f64| unit.iter().map(|values| albedo * values[model]).collect();
    let of_model = |model| colours.iter().map(|colour| of(model, albedo_of(colour))).collect();
    (0..models).map(of_model).collect()
}

/// What a matt facet reflects, or leaves one under an interface again, whatever the angle.
pub(super) fn albedo_of(colour: &Reflectance) -> f64 {
    match colour.fresnel {
        Fresnel::Diffuse { albedo } => albedo,
        _ => unreachable!("matt facets have one albedo"),
    }
}
