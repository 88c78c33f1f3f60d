//! The sums that tables are made of, as BRDF values.

use super::fresnel_sums::{ColourSource, ELEMENTS};
use super::tally_flux::TallyFlux;
use crate::measure::plan::Plan;
use crate::stats;
use crate::table::gaps::NOT_KNOWN;
use crate::table::{RealisationPart, SchlickSums};

/// What tables are made of: [realisation][incidence], and the bins' projected solid angles, [incidence][bin].
pub(crate) struct TableSource<'a> {
    pub plan: &'a Plan,
    pub flux: &'a [Vec<TallyFlux<'a>>],
    pub sizes: &'a [Vec<f64>],
}

impl TableSource<'_> {
    /// BRDF values of one realisation: flux over projected solid angle.
    pub fn realisation(&self, incidences: &[TallyFlux], colours: &[ColourSource]) -> RealisationPart {
        let mut part = RealisationPart {
            total: vec![Vec::new(); colours.len()],
            single: vec![Vec::new(); colours.len()],
            schlick: self.schlick(std::slice::from_ref(&incidences)),
        };
        for (flux, sizes) in incidences.iter().zip(self.sizes) {
            for (bin, size) in sizes.iter().enumerate() {
                for (place, &colour) in colours.iter().enumerate() {
                    let single = flux.single(colour, bin) / size;
                    let multiple = flux.multiple(&self.plan.sums, colour, bin) / size;
                    part.single[place].push(single as f32);
                    part.total[place].push((single + multiple) as f32);
                }
            }
        }
        part
    }

    /// Mean over some realisations of a flux, as a BRDF in every bin.
    pub fn brdf<'b>(
        &self,
        realisations: &[impl AsRef<[TallyFlux<'b>]>],
        flux: impl Fn(&TallyFlux<'b>, usize) -> f64,
    ) -> Vec<f32> {
        let count = realisations.len() as f64;
        entries(self.plan, |incidence, bin| {
            let sum: f64 =
                realisations.iter().map(|incidences| flux(&incidences.as_ref()[incidence], bin)).sum();
            (sum / count / self.sizes[incidence][bin]) as f32
        })
    }

    /// The sums of Schlick's formula over some realisations, where they serve any F0.
    pub fn schlick<'b>(&self, realisations: &[impl AsRef<[TallyFlux<'b>]>]) -> Option<SchlickSums> {
        let sums = &self.plan.sums;
        let group = |group: usize| {
            let sums = sums.group(group);
            sums.map(|sum| self.brdf(realisations, |flux, bin| flux.of(flux.tally.multiple[sum][bin])))
                .collect()
        };
        sums.serves_any_f0().then(|| SchlickSums {
            unit: self.brdf(realisations, |flux, bin| flux.of(flux.tally.single[bin])),
            first: self.brdf(realisations, |flux, bin| flux.of(flux.tally.first[0][bin])),
            further: (0..sums.groups()).map(group).collect(),
        })
    }

    /// The elements of a colour's Mueller matrix and their standard errors, where they are measured: of the very f32 values
    /// that realisations hold. `empty` is the error of a bin without light.
    pub fn mueller(&self, colour: ColourSource, empty: &[f32]) -> [Vec<Vec<f32>>; 2] {
        let (ColourSource::Traced { place } | ColourSource::Followed { place }) = colour else {
            return [vec![], vec![]];
        };
        if self.plan.sums.mueller_sums() == 0 {
            return [vec![], vec![]];
        }
        let [mut values, mut errors] = [vec![Vec::new(); ELEMENTS], vec![Vec::new(); ELEMENTS]];
        for (incidence, sizes) in self.sizes.iter().enumerate() {
            for (bin, size) in sizes.iter().enumerate() {
                let of = |element: usize| {
                    let one = |incidences: &Vec<TallyFlux>| {
                        (incidences[incidence].mueller(place, element, bin) / size) as f32
                    };
                    stats::mean_and_se(self.flux.iter().map(one).map(f64::from))
                };
                let no_light = of(0).0 == 0.0;
                for (element, (values, errors)) in values.iter_mut().zip(&mut errors).enumerate() {
                    let (mean, se) = of(element);
                    let se = se.map_or(NOT_KNOWN, |se| se as f32);
                    values.push(mean as f32);
                    errors.push(if no_light && se >= 0.0 {
                        empty[incidence * self.plan.bins + bin]
                    } else {
                        se
                    });
                }
            }
        }
        [values, errors]
    }

    /// Orders 2, 3, ... of a colour, where they are kept apart.
    pub fn orders(&self, colour: ColourSource) -> Vec<Vec<f32>> {
        let sums = &self.plan.sums;
        let groups = if sums.by_order() { sums.groups() } else { 0 };
        let order = |group| self.brdf(self.flux, |flux, bin| flux.group(sums, group, colour, bin));
        (0..groups).map(order).collect()
    }
}

/// A value for each bin of each incidence.
pub(crate) fn entries<T>(plan: &Plan, of: impl Fn(usize, usize) -> T) -> Vec<T> {
    (0..plan.incidences)
        .flat_map(|incidence| (0..plan.bins).map(move |bin| (incidence, bin)))
        .map(|(s, b)| of(s, b))
        .collect()
}
