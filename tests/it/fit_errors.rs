//! Promise: the errors of a fit are what it scatters by, its intervals hold the truth in 95 % of all cases, and models
//! that the realisations do not tell apart are said to be alike.

use gonio::fit::nodes::{IncidenceNodes, Lobe};
use gonio::fit::{self, Fit, FitData, FitLaw, MicrofacetLaw};
use gonio::instrument::{Grid, GridKind};
use gonio::rng;
use gonio::table::{BrdfTable, ColourChannels, RealisationPart, Realisations};
use gonio::theory::{Masking, Ndf};
use rand_pcg::Pcg64Dxsm;
use rayon::prelude::*;

use crate::support::long::or_long;
use crate::support::measuring::{measured_one, test_rng};

const ALPHA: f64 = 0.3;

fn law(masking: Masking, anisotropic: bool) -> FitLaw {
    FitLaw::Microfacet(MicrofacetLaw::new(Ndf::Ggx, masking, anisotropic))
}

fn grid(phi_i_deg: &[f64]) -> Grid {
    Grid {
        kind: GridKind::Hemisphere,
        theta_i_deg: vec![20.0, 60.0],
        phi_i_deg: phi_i_deg.to_vec(),
        phi_r_relative: true,
        theta_r_edges_deg: (0..=9).map(|k| 10.0 * f64::from(k)).collect(),
        phi_r_edges_deg: (0..=12).map(|k| 30.0 * f64::from(k) - 15.0).collect(),
        ..Grid::default()
    }
}

/// Azimuths on one side of the plane of incidence: the other side's bins have the means of these, and twice the hits here
/// say as much.
fn one_side() -> Grid {
    Grid { phi_r_edges_deg: (0..=6).map(|k| 30.0 * f64::from(k)).collect(), ..grid(&[0.0]) }
}

fn normal(rng: &mut Pcg64Dxsm) -> f64 {
    let (u, v) = (1.0 - rng::uniform(rng), rng::uniform(rng));
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// Poisson's law by its waiting times; a normal one of the same moments where it is one.
fn poisson(mean: f64, rng: &mut Pcg64Dxsm) -> f64 {
    if mean > 200.0 {
        return (mean + mean.sqrt() * normal(rng)).round();
    }
    // The sum of the times reaches the mean where the product of the numbers falls to exp(-mean), 1e-87 at least.
    let (mut count, mut product, end) = (-1.0, 1.0, (-mean).exp());
    while product > end {
        product *= 1.0 - rng::uniform(rng);
        count += 1.0;
    }
    count
}

/// Realisations whose own roughness scatters by `patch` of itself along each axis, which all bins see together, and
/// whose bins hold `hits` arrivals an incidence on average, each an independent draw.
fn simulated(
    truth: FitLaw,
    grid: &Grid,
    count: usize,
    patch: f64,
    hits: f64,
    rng: &mut Pcg64Dxsm,
) -> FitData {
    let nodes = IncidenceNodes::of_grid(grid, 0.0, Lobe { alpha: 0.8 * ALPHA, eta: 1.5 });
    let sizes: Vec<f64> =
        (0..grid.incidences()).flat_map(|s| grid.regions(s)).map(|r| r.projected_solid_angle()).collect();
    let means_of = |shape: &[f64]| -> Vec<[f64; 2]> {
        nodes.iter().flat_map(|nodes| truth.means(shape, nodes)).collect()
    };
    // What does not scatter has the same means in every realisation.
    let alike = (patch == 0.0 && !truth.is_anisotropic()).then(|| means_of(&[ALPHA.ln()]));
    let part = |rng: &mut Pcg64Dxsm| {
        let log = ALPHA.ln() + patch * normal(rng);
        let shape = match truth.is_anisotropic() {
            true => vec![log, patch * normal(rng), patch * normal(rng)],
            false => vec![log],
        };
        let means = alike.clone().unwrap_or_else(|| means_of(&shape));
        let drawn =
            means.iter().zip(&sizes).map(|(mean, w)| (poisson(hits * mean[0] * w, rng) / (hits * w)) as f32);
        drawn.collect::<Vec<f32>>()
    };
    let parts: Vec<Vec<f32>> = (0..count).map(|_| part(rng)).collect();
    data_of(grid, &parts)
}

/// The table of these realisations, F = 1.
fn data_of(grid: &Grid, parts: &[Vec<f32>]) -> FitData {
    let entries = parts[0].len();
    let mean =
        |k: usize| (parts.iter().map(|part| f64::from(part[k])).sum::<f64>() / parts.len() as f64) as f32;
    let value: Vec<f32> = (0..entries).map(mean).collect();
    let table = BrdfTable {
        hits: vec![1; entries],
        grid: grid.clone(),
        campaign: String::new(),
        version: "test".into(),
        seed: 1,
        patch_digest: String::new(),
        colours: vec![ColourChannels {
            total: value.clone(),
            single: value,
            multiple: vec![0.0; entries],
            stderr: vec![1e-3; entries],
            stderr_single: vec![1e-3; entries],
            ..ColourChannels::default()
        }],
        schlick: None,
    };
    let part = |values: &Vec<f32>| RealisationPart {
        total: vec![values.clone()],
        single: vec![values.clone()],
        schlick: None,
    };
    let parts = Realisations { parts: parts.iter().map(part).collect() };
    FitData { perfect_mirror: true, ..FitData::new(&table, None, Some(&parts)) }
}

/// Numbers of realisations that intervals are judged for: few and many, with GONIO_LONG=1 those between as well.
fn realisation_counts() -> &'static [usize] {
    or_long(&[4, 16][..], &[4, 8, 16][..])
}

/// What many fits say of one parameter.
struct Shown {
    covered: f64,
    bias: f64,
    sd: f64,
    claimed: f64,
}

/// Coverage, bias, scatter and root mean square of the claimed errors.
fn shown(fits: &[Fit], name: &str, truth: f64) -> Shown {
    let count = fits.len() as f64;
    let values: Vec<f64> = fits.iter().map(|fit| fit.parameters.get(name).expect("fitted")).collect();
    let claimed =
        fits.iter().map(|fit| fit.standard_errors.get(name).expect("known").powi(2)).sum::<f64>() / count;
    let inside = |fit: &&Fit| {
        let [low, high] = fit.intervals_95.as_ref().expect("realisations").get(name).expect("known");
        low <= truth && truth <= high
    };
    let mean = values.iter().sum::<f64>() / count;
    let sd = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    Shown {
        covered: fits.iter().filter(inside).count() as f64 / count,
        bias: mean - truth,
        sd,
        claimed: claimed.sqrt(),
    }
}

impl Shown {
    /// Binomial over `count` cases: four standard errors of the coverage are 4 sqrt(0.95 0.05/count). The mean square
    /// of claims with R - 1 degrees each is right to a few hundredths, the scatter to 1/sqrt(2 count).
    #[track_caller]
    fn holds(&self, count: usize, what: &str) {
        let Shown { covered, bias, sd, claimed } = self;
        println!(
            "{what}: covered {:.1} %, bias {bias:.6}, sd {sd:.6}, claimed {claimed:.6}",
            100.0 * covered
        );
        let tolerance = 4.0 * (0.95 * 0.05 / count as f64).sqrt();
        assert!((covered - 0.95).abs() < tolerance.max(0.04), "{what}: {covered}");
        assert!(bias.abs() < 0.5 * claimed, "{what}: {bias} of {claimed}");
        assert!((claimed / sd - 1.0).abs() < 0.2, "{what}: {claimed} {sd}");
    }
}

#[test]
fn intervals_of_simulated_tables_hold_the_truth_in_95_of_100_cases() {
    // Bins with few hits and none, where weights from the scatter of few realisations pull; patches that are off in
    // all bins together, or not at all.
    let truth = law(Masking::HeightCorrelated, false);
    for &count in realisation_counts() {
        for (patch, hits) in [(0.0, 300.0), (0.02, 6000.0), (0.03, 2e5)] {
            // Coverage to 7 % (GONIO_LONG: 5 %), four standard errors, and the scatter to 6 % (4 %) of itself.
            let cases = or_long(150, 300);
            let fits: Vec<Fit> = (0..cases)
                .into_par_iter()
                .map(|seed| {
                    let data = simulated(truth, &one_side(), count, patch, hits, &mut test_rng(seed as u64));
                    fit::best(&data, &[truth])
                })
                .collect();
            shown(&fits, "alpha", ALPHA).holds(cases, &format!("R {count}, patch {patch}, hits {hits}"));
        }
    }
}

#[test]
fn two_roughnesses_of_a_round_law_come_out_alike_and_their_intervals_hold_it() {
    let truth = law(Masking::HeightCorrelated, true);
    // Half a turn, for the law is the same after it; with the hits of the other half.
    let turns: Vec<f64> = (0..3).map(|k| 60.0 * f64::from(k)).collect();
    for &count in realisation_counts() {
        let cases = 100;
        let fits: Vec<Fit> = (0..cases)
            .into_par_iter()
            .map(|seed| {
                let data =
                    simulated(truth, &grid(&turns), count, 0.03, 6000.0, &mut test_rng(900 + seed as u64));
                fit::best(&data, &[truth])
            })
            .collect();
        for name in ["alpha_x", "alpha_y"] {
            let found = shown(&fits, name, ALPHA);
            println!(
                "{name} R {count}: {:.1} %, {:.5} {:.5} {:.5}",
                100.0 * found.covered,
                found.bias,
                found.sd,
                found.claimed
            );
            // The error is that along any axis, also of a law that is not round after all: of 1 + 1/2 + 1/2 parts in two
            // (here b and c scatter as much as a) one is not in a round law's own scatter: too wide by sqrt 2 at most.
            assert!(
                found.covered >= 0.93 && found.bias.abs() < 0.5 * found.claimed,
                "{name}: {}",
                found.covered
            );
            assert!(found.claimed < 1.6 * found.sd, "{name}: {} {}", found.claimed, found.sd);
        }
        // At 1 %: binomial, 1 +- 1 of 100; five errors.
        let told = fits.iter().filter(|fit| fit.parameters.get("rotation_deg").is_some()).count();
        assert!(told <= 6, "{told} of {cases} round laws are told to have axes");
    }
}

#[test]
fn the_jackknife_is_what_leaving_out_and_fitting_again_gives() {
    // The model is not the truth: the second derivatives are not Fisher's matrix.
    let grid = one_side();
    let data = simulated(law(Masking::DirectionCorrelated, false), &grid, 8, 0.03, 3000.0, &mut test_rng(5));
    for law in [
        law(Masking::Separable, false),
        FitLaw::Microfacet(MicrofacetLaw::new(Ndf::Beckmann, Masking::HeightCorrelated, false)),
        FitLaw::BlinnPhong,
    ] {
        let fit = fit::best(&data, &[law]);
        let without = |k: usize| {
            let others: Vec<&Vec<Vec<f64>>> =
                data.parts.iter().enumerate().filter(|(at, _)| *at != k).map(|(_, part)| part).collect();
            let mean = |at: usize| others.iter().map(|part| part[0][at]).sum::<f64>() / others.len() as f64;
            let value = vec![(0..data.value[0].len()).map(mean).collect::<Vec<f64>>()];
            fit::best(&FitData { value, parts: Vec::new(), ..data.clone() }, &[law])
        };
        let again: Vec<Fit> = (0..8).map(without).collect();
        for (name, _) in &fit.parameters.0 {
            let all: Vec<f64> = again.iter().map(|fit| fit.parameters.get(name).expect("fitted")).collect();
            let mean = all.iter().sum::<f64>() / 8.0;
            let se = (7.0 / 8.0 * all.iter().map(|v| (v - mean).powi(2)).sum::<f64>()).sqrt();
            let found = fit.standard_errors.get(name).expect("known");
            // First order: relative changes of a few hundredths squared.
            assert!((found / se - 1.0).abs() < 0.05, "{law:?} {name}: {found} {se}");
        }
    }
}

#[test]
fn the_true_masking_is_the_best_or_said_to_be_alike() {
    let all: Vec<FitLaw> = Masking::ALL.into_iter().map(|masking| law(masking, false)).collect();
    for count in [4, 8] {
        // Few hits: nothing is told apart. Many: all is.
        for (hits, first) in [(600.0, 0.0), (2e6, 0.95)] {
            let cases = 100;
            let place = |seed: u64| {
                let truth = law(Masking::DirectionCorrelated, false);
                let data = simulated(truth, &one_side(), count, 0.01, hits, &mut test_rng(3000 + seed));
                let fits = fit::fit(&data, &all).fits;
                let at =
                    fits.iter().position(|fit| fit.masking == Some("direction_correlated")).expect("fitted");
                (at == 0, at == 0 || fits[at].alike == Some(true))
            };
            let places: Vec<(bool, bool)> = (0..cases).into_par_iter().map(place).collect();
            let best = places.iter().filter(|place| place.0).count();
            let alike = places.iter().filter(|place| place.1).count();
            println!("R {count}, hits {hits}: best {best}, best or alike {alike} of {cases}");
            // At 95 %: 95 +- 2.2 of a hundred; three errors.
            assert!(best as f64 >= first * cases as f64 && alike >= 88, "{best} {alike}");
        }
    }
}

#[test]
fn an_exact_model_has_a_chi_square_of_one() {
    let truth = law(Masking::HeightCorrelated, false);
    for count in [4, 8, 16] {
        let all: Vec<f64> = (0..100)
            .into_par_iter()
            .map(|seed| {
                let data = simulated(truth, &grid(&[0.0]), count, 0.0, 3000.0, &mut test_rng(7000 + seed));
                fit::best(&data, &[truth]).chi2_per_dof.expect("errors")
            })
            .collect();
        let (mean, se) = gonio::stats::mean_and_se(all.into_iter());
        println!("R {count}: chi2/dof {mean:.4} +- {:.4}", se.expect("many"));
        // A quotient of two means: its expectation exceeds 1 by 2/n of n = 216 (R - 1) squares.
        let bias = 2.0 / (216.0 * (count - 1) as f64);
        assert!((mean - 1.0).abs() < bias + 4.0 * se.expect("many"), "R {count}: {mean}");
    }
}

/// A surface, its cells (none of a statistical one) and the text of it.
const SURFACES: [(&str, u32, &str); 3] = [
    ("smith", 0, "[surface.smith]\nndf = \"ggx\"\nalpha = 0.3"),
    ("64^2", 64, "[surface.ggx]\nalpha = 0.3"),
    ("256^2", 256, "[surface.ggx]\nalpha = 0.3"),
];

fn measured_fit(surface: &str, cells: u32, theta_i_deg: &str, count: usize, seed: u64) -> gonio::fit::Fits {
    let cells = if cells > 0 { format!("cells = {cells}\n") } else { String::new() };
    let measured = measured_one(&format!(
        "name = \"fit\"\nseed = {seed}\n[surface]\nrealisations = {count}\n{cells}{surface}\n\
         [light]\ntheta_i_deg = {theta_i_deg}\n\
         [sensor.hemisphere]\ntheta_r_bins = 12\nphi_r_bins = 24\n[stop]\nsamples = 65536\n"
    ));
    let data = FitData::new(&measured.table, Some(&measured.campaign), Some(&measured.realisations));
    fit::fit(&data, &FitLaw::of_normals(Ndf::Ggx, &data))
}

/// A walk over statistical facets is the model, and the interval has to hold the campaign's roughness. No masking is
/// that of a continuous surface, and no patch has its law to the last facet: the model nearest to its mean BRDF has a
/// roughness of its own (0.1 to 0.3 % more under light from the normal, 0.4 % less with light at 60 degrees as well).
/// Intervals over realisations hold *that*; the mean of all seeds stands for it, whose error of 1/sqrt(60) of an
/// interval's widens the misses to 5.1 %.
#[test]
#[ignore = "takes many minutes: cargo test --release -- --ignored --nocapture"]
fn intervals_of_measured_roughnesses_hold_it_in_95_of_100_seeds() {
    let chosen = std::env::var("GONIO_COVERAGE").unwrap_or_default();
    for (name, cells, surface) in SURFACES.iter().filter(|(name, ..)| name.contains(&chosen)) {
        for (theta_i_deg, count) in
            ["[0]", "[0, 30, 60]"].into_iter().flat_map(|t| [4, 8, 16].map(|r| (t, r)))
        {
            let seeds = 60;
            let all: Vec<gonio::fit::Fits> =
                (1..=seeds).map(|seed| measured_fit(surface, *cells, theta_i_deg, count, seed)).collect();
            // The best model's: which one that is, the realisations decide.
            let best: Vec<Fit> = all.iter().map(|fits| fits.fits[0].clone()).collect();
            let mean = best.iter().map(|fit| fit.parameters.get("alpha").expect("fitted")).sum::<f64>()
                / seeds as f64;
            let own = if *cells == 0 { ALPHA } else { mean };
            let (found, campaigns) = (shown(&best, "alpha", own), shown(&best, "alpha", ALPHA));
            let Shown { covered, bias, sd, claimed } = found;
            println!(
                "{name} {theta_i_deg} R {count}: covered {:.1} % (the campaign's {:.1} %), mean {mean:.5}, sd {sd:.5}, claimed {claimed:.5}",
                100.0 * covered,
                100.0 * campaigns.covered
            );
            for masking in Masking::ALL.map(Masking::name) {
                let of =
                    |fits: &gonio::fit::Fits| fits.fits.iter().position(|fit| fit.masking == Some(masking));
                let alike =
                    |fits: &&gonio::fit::Fits| of(fits).is_some_and(|at| fits.fits[at].alike == Some(true));
                let first = all.iter().filter(|fits| of(fits) == Some(0)).count();
                println!("    {masking}: best in {first}, alike in {}", all.iter().filter(alike).count());
            }
            // 95 +- 4 %, as asked; of 60 cases one standard error is 2.8 %.
            assert!(
                (0.91..=0.99).contains(&covered) || covered == 1.0,
                "{name} {theta_i_deg} R {count}: {covered}"
            );
            assert!(bias.abs() < 0.5 * claimed, "{name} {theta_i_deg} R {count}: {bias} {claimed}");
        }
    }
}
